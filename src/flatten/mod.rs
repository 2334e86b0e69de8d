//! Instance tree to flat model: scalar variables with their values, equations written out,
//! connections turned into equations (section 5.6 of the specification).
pub mod assembly;
pub mod balance;
pub mod bounds;
pub mod connect;
pub mod equation;
mod history;
pub mod inventory;
pub mod parameter_override;
pub mod print;
pub mod variable;
pub mod when;

use std::rc::Rc;
use std::sync::Arc;

use crate::base::index::FastSet;
use crate::instantiate::Context;
use crate::ir::assembly::Assembly;
use crate::ir::ast::{ArgumentKind, ClassBody, ElementKind, Modification, Path};
use crate::ir::expr::Const;
use crate::ir::flat::{Assert, Equation, EquationKind, Experiment, FlatModel, Origin};
use crate::ir::instance::{ClassId, InstanceId, InstanceKind, Scope};
use crate::ir::modification::Setting;

/// Flattens the model `class` with settings from outside. Problems are left in the context; the value
/// is then of no use for running.
pub fn flatten(cx: &mut Context<'_>, class: ClassId, settings: &[Rc<Setting>]) -> FlatModel {
    flatten_with(cx, class, settings, connect::Connections::default(), |_, _, _, _| ())
}

/// As [`flatten`], and takes the model apart into what can be drawn.
pub fn flatten_with_assembly(
    cx: &mut Context<'_>,
    class: ClassId,
    settings: &[Rc<Setting>],
) -> (FlatModel, Assembly) {
    let mut found = Assembly::default();
    let noting = connect::Connections::noting();
    let flat = flatten_with(cx, class, settings, noting, |cx, root, connections, flat| {
        found = assembly::of(cx, root, connections, flat);
    });
    (flat, found)
}

/// As [`flatten`], and takes stock of what the model is made of.
pub fn flatten_with_inventory(
    cx: &mut Context<'_>,
    class: ClassId,
    settings: &[Rc<Setting>],
) -> (FlatModel, inventory::Inventory) {
    let mut found = inventory::Inventory::default();
    let connections = connect::Connections::default();
    let flat = flatten_with(cx, class, settings, connections, |cx, root, connections, _| {
        found = inventory::of(cx, root, connections);
    });
    (flat, found)
}

/// As [`flatten`], and counts equations and unknowns; nothing is counted if that is not decided by
/// the component alone.
pub fn flatten_with_balance(
    cx: &mut Context<'_>,
    class: ClassId,
    balance: &mut Option<balance::Balance>,
) -> FlatModel {
    let mut root = None;
    let none = connect::Connections::default();
    let flat = flatten_with(cx, class, &[], none, |_, at, _, _| root = Some(at));
    *balance = root.and_then(|root| balance::of(cx, root, &flat));
    flat
}

fn flatten_with(
    cx: &mut Context<'_>,
    class: ClassId,
    settings: &[Rc<Setting>],
    mut connections: connect::Connections,
    look: impl FnOnce(&mut Context<'_>, InstanceId, &mut connect::Connections, &FlatModel),
) -> FlatModel {
    let text = cx.text(class).cloned();
    let full_name = cx.classes[class].full_name.to_string();
    let span = text.as_ref().map_or(crate::base::source::Span::NONE, |t| t.name.span);
    let mut flat = FlatModel::new(full_name, span);
    flat.description = text.as_ref().and_then(|t| t.description.clone());

    let root = cx.instantiate_model(class, settings);
    parameter_override::report_unused(cx, root, settings);
    connect::expandable::elaborate(cx, root);
    connect::cardinality::count(cx, root);
    connect::connector::check(cx, root);
    variable::number(cx, root, &mut flat);
    variable::fill(cx, &mut flat);

    for object in objects(cx, root) {
        equation::of_object(cx, object, &mut flat, &mut connections);
    }
    look(cx, root, &mut connections, &flat);
    connections.equations(cx, &mut flat);
    flat.experiment = inherited_experiment(cx, class, root, 0);
    let structural: FastSet<InstanceId> = cx.evaluation.structural.iter().copied().collect();
    for (v, (instance, _)) in cx.evaluation.instance_of.iter().enumerate() {
        let v = crate::ir::expr::VarId(v as u32);
        flat.variables[v].structural |= structural.contains(instance);
    }
    history::elaborate(cx, &mut flat);
    flat.functions = std::mem::take(&mut cx.evaluation.functions).into_iter().collect();
    // What functions assert that are called in declarations.
    for a in std::mem::take(&mut cx.evaluation.asserts) {
        let origin = Origin { span: a.span, component: "".into() };
        let assert = Assert { condition: a.condition, message: a.message, level: a.level };
        flat.equations.push(Equation { kind: EquationKind::Assert(assert), origin });
    }
    flat.graph = std::mem::take(&mut cx.graph);
    flat
}

/// Components with components, depth first in order of declaration.
fn objects(cx: &Context<'_>, root: InstanceId) -> Vec<InstanceId> {
    let mut found = Vec::new();
    let mut stack = vec![root];
    while let Some(id) = stack.pop() {
        match &cx.instances[id].kind {
            InstanceKind::Object(children) => {
                found.push(id);
                stack.extend(children.iter().rev());
            }
            InstanceKind::Array { elements, .. } => stack.extend(elements.iter().rev()),
            _ => {}
        }
    }
    found
}

/// The experiment of a class, or else of the first of its bases that has one.
fn inherited_experiment(
    cx: &mut Context<'_>,
    class: ClassId,
    root: InstanceId,
    depth: usize,
) -> Experiment {
    let Some(text) = cx.text(class).cloned() else { return Experiment::default() };
    if let Some(annotation) = &text.annotation {
        let own = experiment(cx, annotation, Scope { instance: root, class });
        if own != Experiment::default() {
            return own;
        }
    }
    // Inheritance that goes round is reported elsewhere.
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
        let found = inherited_experiment(cx, base, root, depth + 1);
        if found != Experiment::default() {
            return found;
        }
    }
    Experiment::default()
}

/// `annotation(experiment(...))`
fn experiment(cx: &mut Context<'_>, annotation: &Arc<Modification>, scope: Scope) -> Experiment {
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
