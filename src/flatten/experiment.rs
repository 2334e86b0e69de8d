//! The `experiment` annotation of a model (Modelica 3.6, section 18.4).

use std::sync::Arc;

use crate::evaluate::Evaluator;
use crate::ir::ast::{ArgumentKind, ClassBody, ElementKind, Modification, Path};
use crate::ir::expr::Const;
use crate::ir::flat::Experiment;
use crate::ir::instance::{ClassId, InstanceId, Scope};

/// The experiment of a class, or else that of the first base class that has one.
pub(super) fn inherited(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    root: InstanceId,
    depth: usize,
) -> Experiment {
    let Some(text) = cx.definition(class).cloned() else { return Experiment::default() };
    if let Some(annotation) = &text.annotation {
        let own = declared(cx, annotation, Scope { instance: root, class });
        if own != Experiment::default() {
            return own;
        }
    }
    // Cyclic inheritance is reported elsewhere.
    if depth > 50 {
        return Experiment::default();
    }
    let bases: Vec<&Path> = match &text.body {
        ClassBody::Short(short) => vec![&short.base],
        ClassBody::Long(composition) => composition
            .elements
            .iter()
            .filter_map(|e| match &e.kind {
                ElementKind::Extends(extends) => Some(&extends.base),
                _ => None,
            })
            .collect(),
        _ => Vec::new(),
    };
    for base in bases {
        let scope = Scope { instance: cx.classes[class].holder, class };
        let Some(base) = cx.find_class(base, scope).filter(|b| *b != class) else { continue };
        let found = inherited(cx, base, root, depth + 1);
        if found != Experiment::default() {
            return found;
        }
    }
    Experiment::default()
}

/// `annotation(experiment(...))`
fn declared(cx: &mut Evaluator<'_>, annotation: &Arc<Modification>, scope: Scope) -> Experiment {
    let mut experiment = Experiment::default();
    for arg in &annotation.args {
        let ArgumentKind::Element { path, modification: Some(inner), .. } = &arg.kind else {
            continue;
        };
        if path.to_string() != "experiment" {
            continue;
        }
        for entry in &inner.args {
            let ArgumentKind::Element { path, modification: Some(m), .. } = &entry.kind else {
                continue;
            };
            let Some(binding) = &m.binding else { continue };
            let slot = match path.to_string().as_str() {
                "StartTime" => &mut experiment.start,
                "StopTime" => &mut experiment.stop,
                "Interval" => &mut experiment.interval,
                "Tolerance" => &mut experiment.tolerance,
                _ => continue,
            };
            let value = cx.fold(binding, scope).and_then(|v| v.scalar());
            *slot = value.and_then(|e| cx.graph.as_const(e)).and_then(Const::number);
        }
    }
    experiment
}
