//! All problems of a file at once: its syntax, then every class in it.
//!
//! A class with connectors or inputs is a component: it is flattened and its equations are counted;
//! anything that depends on its surroundings (values of parameters, the source of its potentials) is left
//! open. A class without them is a system: it goes through all stages before simulation. Since each
//! component is counted by itself, a file is checked locally and globally (MLS 3.6, section 4.7). Of a class that does
//! not run by itself (a partial one, a record, a connector, a package, one inside another class) names and types are
//! checked.

use super::compile::{CompileError, Request, Session};
use super::subject::{find_in, model, models};
use crate::base::activity;
use crate::base::diag::{Diagnostic, Problems, Severity};
use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::classes::cause::ClassCause;
use crate::evaluate::Evaluator;
use crate::evaluate::cause::call::CallCause;
use crate::evaluate::cause::holds_for_all_arguments;
use crate::evaluate::cause::value::ValueCause;
use crate::ir::ast::{self, ClassBody, ClassKind, ElementKind};
use crate::ir::instance::{ClassId, EntryKind, Scope};
use crate::lower::error::LoweringCause;
use crate::resolve::library::Library;
use crate::rules::{ineffective_modifiers, shadowing};
use crate::units::cause::UnitCause;

/// Steps of work (`evaluate::budget`) that a component takes in all stages.
const STEPS_PER_COMPONENT: u64 = 20;
/// Steps of work that the execution of a function takes in all stages, in addition to its expressions.
const STEPS_PER_CALL: u64 = 800;
/// Classes of a file that are copied, for the next one to be checked, in the time of a step.
const CLASSES_PER_STEP: usize = 4;

impl Session {
    /// Collects the problems of a request in [`Session::problems`].
    /// Mismatched units have the severity `units`.
    pub fn check(&mut self, request: &Request, units: Severity) -> Result<(), CompileError> {
        let checked = self.check_classes(request);
        if units == Severity::Error {
            self.problems.raise::<UnitCause>();
        }
        checked?;
        if self.problems.has_errors() { Err(CompileError::Model) } else { Ok(()) }
    }

    /// Adds the problems of a class. A component that is checked by itself has the units of its
    /// instances.
    fn add(&mut self, problems: Problems) {
        let is_unit = |d: &Diagnostic| d.is(|_: &UnitCause| true);
        for d in problems.iter() {
            let is_known = |known: &Diagnostic| is_unit(known) && known.primary.0 == d.primary.0;
            if !(is_unit(d) && self.problems.iter().any(is_known)) {
                self.problems.push(d.clone());
            }
        }
    }

    fn check_classes(&mut self, request: &Request) -> Result<(), CompileError> {
        let mut library = Library::new(super::files::folders(request));
        let file = self.read(request, &mut library)?;
        if self.problems.has_errors() {
            return Err(CompileError::Model);
        }
        let Some(file) = file.as_deref().filter(|_| request.model.is_none()) else {
            let mut problems = Problems::new();
            let mut cx =
                Evaluator::new(ClassGraph::new(&mut self.sources, &mut problems, &mut library));
            cx.budget = request.budget();
            let found = model(&mut cx, request, file.as_deref());
            if let Ok(class) = found {
                one(&mut cx, class);
            }
            self.problems.extend(problems);
            found?;
            return if self.problems.has_errors() { Err(CompileError::Model) } else { Ok(()) };
        };
        let runs: FastSet<String> = models(file).into_iter().collect();
        let mut problems = Problems::new();
        let mut cx =
            Evaluator::new(ClassGraph::new(&mut self.sources, &mut problems, &mut library));
        let mut found = Vec::new();
        for name in classes(file) {
            let Some(class) = find_in(&mut cx, file, &name) else { continue };
            // For every class: what it extends, and the restrictions of its kind.
            cx.table(class);
            shadowing::report_shadowed(&mut cx, class);
            ineffective_modifiers::report_each_of_one(&mut cx, class);
            found.push((name, class));
        }
        let copied = (cx.classes.len() / CLASSES_PER_STEP) as u64;
        let snapshot = cx.class_graph.into_snapshot();
        self.problems.extend(problems);
        let (all, most) = (found.len(), request.budget().most_work());
        let mut work = 0_u64;
        for (checked, (name, class)) in found.into_iter().enumerate() {
            let mut problems = Problems::new();
            let mut cx = Evaluator::new(ClassGraph::from_snapshot(
                &mut self.sources,
                &mut problems,
                &mut library,
                snapshot.clone(),
            ));
            activity::note(format!("checking `{name}`"));
            cx.budget = request.budget();
            if work > most {
                let span = cx.definition(class).map_or(Span::NONE, |d| d.name.span);
                let cause = ValueCause::TooManyClasses { most, checked, all };
                self.problems.push(Diagnostic::new(cause, span).label("the first that is not"));
                break;
            }
            if runs.contains(&name) {
                one(&mut cx, class);
            } else if is_function(&cx, class) {
                names_and_types(&mut cx, |cx| cx.read_function(class));
            } else if has_components(&cx, class) {
                cx.surrounded = true;
                names_and_types(&mut cx, |cx| drop(crate::flatten::flatten(cx, class, &[])));
            }
            let components = STEPS_PER_COMPONENT * cx.instances.len() as u64;
            work += copied + cx.budget.work + STEPS_PER_CALL * cx.budget.calls + components;
            // The classes that contain this one would take as long to refuse.
            if cx.budget.exhausted || problems.iter().any(calls_too_much) {
                self.add(problems);
                break;
            }
            match problems.iter().any(lacks_inner) {
                // Others may follow from the missing outer component.
                true => self.add(those_of_names_and_types(&problems)),
                false => self.add(problems),
            }
        }
        if self.problems.has_errors() { Err(CompileError::Model) } else { Ok(()) }
    }
}

/// Whether a function was refused for the number of its calls.
fn calls_too_much(d: &Diagnostic) -> bool {
    d.is(|cause: &CallCause| matches!(cause, CallCause::TooManyCalls { .. }))
}

/// Whether an `inner` component is missing: a component checked alone has none.
fn lacks_inner(d: &Diagnostic) -> bool {
    d.is(|cause: &ClassCause| {
        matches!(cause, ClassCause::NoInner { .. } | ClassCause::InnerAdded { .. })
    })
}

/// A function with a body that could be called.
fn is_function(cx: &Evaluator<'_>, class: ClassId) -> bool {
    let Some(text) = cx.definition(class) else { return false };
    let ClassBody::Long(composition) = &text.body else { return false };
    matches!(text.kind, ClassKind::Function { .. })
        && !text.partial
        && composition.external.is_none()
        && !composition.algorithms.is_empty()
}

/// Any other class than a function and a short one; a package only if it has constants.
fn has_components(cx: &Evaluator<'_>, class: ClassId) -> bool {
    let Some(text) = cx.definition(class) else { return false };
    let ClassBody::Long(composition) = &text.body else { return false };
    let is_component = |e: &ast::Element| matches!(e.kind, ElementKind::Components(_));
    match text.kind {
        ClassKind::Function { .. } | ClassKind::Type => false,
        ClassKind::Package => composition.elements.iter().any(is_component),
        _ => true,
    }
}

/// Checks names and types in what holds for any arguments, or for any surroundings. Other diagnostics may hold only for the
/// sizes and values assumed here, and are dropped.
fn names_and_types(cx: &mut Evaluator<'_>, read: impl FnOnce(&mut Evaluator<'_>)) {
    let before = std::mem::replace(cx.problems, Problems::new());
    read(cx);
    let reported = those_of_names_and_types(cx.problems);
    *cx.problems = before;
    cx.problems.extend(reported);
}

/// The problems that hold for all arguments and surroundings.
fn those_of_names_and_types(problems: &Problems) -> Problems {
    let mut own = Problems::new();
    problems.iter().filter(|d| holds_for_all_arguments(d)).for_each(|d| own.push(d.clone()));
    own
}

/// Full names of the classes of a file, including those in other classes.
fn classes(file: &ast::File) -> Vec<String> {
    let mut out = Vec::new();
    let mut stack: Vec<(String, &ast::Class)> =
        file.classes.iter().rev().map(|c| (c.name.name.to_string(), &**c)).collect();
    while let Some((name, class)) = stack.pop() {
        if let ClassBody::Long(composition) = &class.body {
            for element in composition.elements.iter().rev() {
                if let ElementKind::Class(c) = &element.kind {
                    stack.push((format!("{name}.{}", c.name.name), c));
                }
            }
        }
        out.push(name);
    }
    out
}

/// A component or a system.
fn one(cx: &mut Evaluator<'_>, class: ClassId) {
    if is_component(cx, class) {
        component(cx, class);
    } else {
        whole(cx, class);
    }
}

/// Whether a class has connectors or inputs, inherited ones too.
fn is_component(cx: &mut Evaluator<'_>, class: ClassId) -> bool {
    let table = cx.table(class);
    table.entries.iter().any(|entry| {
        let EntryKind::Component(declaration) = &entry.kind else { return false };
        if entry.protected {
            return false;
        }
        let clause = declaration.clause();
        if clause.prefix.causality.is_some() || declaration.element.outer {
            return true;
        }
        let scope = Scope { instance: cx.classes[entry.class].holder, class: entry.class };
        let Some(class) = cx.find_class(&clause.type_name, scope) else { return false };
        matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector)
    })
}

fn component(cx: &mut Evaluator<'_>, class: ClassId) {
    let mut balance = None;
    cx.surrounded = true;
    let mut flat = crate::flatten::flatten_with_balance(cx, class, &mut balance);
    ineffective_modifiers::report_modified_absent(cx, class);
    if !cx.problems.has_errors() {
        crate::units::check(&mut flat, cx.problems);
        crate::flatten::bounds::check(&flat, cx.problems);
    }
    if !cx.problems.has_errors()
        && let Some(balance) = balance
    {
        balance.report(&flat, cx.problems);
    }
}

fn whole(cx: &mut Evaluator<'_>, class: ClassId) {
    let mut flat = crate::flatten::flatten(cx, class, &[]);
    ineffective_modifiers::report_modified_absent(cx, class);
    let problems = &mut *cx.class_graph.problems;
    if problems.has_errors() {
        return;
    }
    crate::units::check(&mut flat, problems);
    crate::flatten::bounds::check(&flat, problems);
    let mut own = Problems::new();
    let dae = crate::lower::lower(flat, &mut own);
    for d in own.iter() {
        // A component of this class may still give the parameter a value.
        let is_open = d.is(|cause| matches!(cause, LoweringCause::NoValue { .. }));
        let severity = if is_open { Severity::Warning } else { d.severity };
        problems.push(d.clone().with_severity(severity));
    }
    if own.has_errors() {
        return;
    }
    let Some(blocks) = dae.and_then(|dae| crate::structure::structure(dae, problems)) else {
        return;
    };
    if problems.has_errors() {
        return;
    }
    if let Err(more) = crate::codegen::compile(blocks) {
        problems.extend(more);
    }
}
