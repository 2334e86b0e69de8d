//! Instance tree to flat model: scalar variables with their values, expanded equations, connections
//! replaced by equations.
//!
//! *In:* `ir::instance`. *Out:* `ir::flat`. Modelica 3.6, section 5.6 and chapter 9.
mod algorithm;
mod clocked;
pub mod assembly;
mod assigned;
pub mod balance;
pub mod bounds;
pub mod cause;
pub mod connect;
pub mod equation;
mod annotation;
mod experiment;
mod history;
mod if_equation;
mod inline;
pub mod inventory;
pub mod open_equation;
mod ownership;
pub mod parameter_override;
pub mod print;
mod reinit;
pub mod variable;
mod passage;
pub mod start_offset;
mod varying;
pub mod when;

use std::rc::Rc;

use crate::base::index::FastSet;
use crate::evaluate::Evaluator;
use crate::ir::assembly::Assembly;
use crate::ir::flat::{Assert, Equation, EquationKind, FlatModel, Origin};
use crate::ir::instance::{ClassId, InstanceId, InstanceKind};
use crate::ir::modification::ParameterOverride;

/// Flattens the model `class` with parameter overrides from the command line. Problems are
/// collected in the context; if there are errors, the result cannot be simulated.
pub fn flatten(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    overrides: &[Rc<ParameterOverride>],
) -> FlatModel {
    flatten_with(cx, class, overrides, connect::Connections::default(), |_, _, _, _| ())
}

/// Like [`flatten`], and also returns the component diagram of the model.
pub fn flatten_with_assembly(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    overrides: &[Rc<ParameterOverride>],
) -> (FlatModel, Assembly) {
    let mut found = Assembly::default();
    let recording = connect::Connections::recording();
    let flat = flatten_with(cx, class, overrides, recording, |cx, root, connections, flat| {
        found = assembly::of(cx, root, connections, flat);
    });
    (flat, found)
}

/// Like [`flatten`], and also returns an inventory of the components and connectors.
pub fn flatten_with_inventory(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    overrides: &[Rc<ParameterOverride>],
) -> (FlatModel, inventory::Inventory) {
    let mut found = inventory::Inventory::default();
    let connections = connect::Connections::default();
    let flat = flatten_with(cx, class, overrides, connections, |cx, root, connections, flat| {
        found = inventory::of(cx, root, connections, flat);
    });
    (flat, found)
}

/// Like [`flatten`], and also counts equations and unknowns, unless the count depends on the
/// surroundings of the component.
pub fn flatten_with_balance(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    balance: &mut Option<balance::EquationBalance>,
) -> FlatModel {
    let mut root = None;
    let none = connect::Connections::default();
    let flat = flatten_with(cx, class, &[], none, |_, at, _, _| root = Some(at));
    *balance = root.and_then(|root| balance::of(cx, root, &flat));
    flat
}

fn flatten_with(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    overrides: &[Rc<ParameterOverride>],
    mut connections: connect::Connections,
    inspect: impl FnOnce(&mut Evaluator<'_>, InstanceId, &mut connect::Connections, &FlatModel),
) -> FlatModel {
    let errors_before = cx.problems.error_count();
    let text = cx.definition(class).cloned();
    let full_name = cx.classes[class].full_name.to_string();
    let span = text.as_ref().map_or(crate::base::source::Span::NONE, |t| t.name.span);
    let mut flat = FlatModel::new(full_name, span);
    flat.description = text.as_ref().and_then(|t| t.description.clone());

    let root = crate::instantiate::model(cx, class, overrides);
    parameter_override::report_unused(cx, root, overrides);
    connect::expandable::elaborate(cx, root);
    connect::cardinality::count(cx, root);
    connections.break_cycles(cx, root);
    connect::connector::check(cx, root);
    variable::number(cx, root, &mut flat);
    if cx.budget.exhausted {
        return flat;
    }
    variable::fill(cx, &mut flat);

    for object in objects(cx, root) {
        equation::of_object(cx, object, &mut flat, &mut connections);
    }
    inspect(cx, root, &mut connections, &flat);
    reinit::check(cx, &flat);
    connections.equations(cx, root, &mut flat);
    flat.ownership = ownership::of(cx, root, &flat);
    flat.experiment = experiment::inherited(cx, class, root);
    let variations = annotation::pairs(cx, (class, root), "varies");
    let passages = annotation::pairs(cx, (class, root), "through");
    let terms = annotation::pairs(cx, (class, root), "adds");
    let starts = annotation::pairs(cx, (class, root), "starts");
    let structural: FastSet<InstanceId> = cx.parameters.structural.iter().copied().collect();
    for (v, (instance, _)) in cx.instance_of.iter().enumerate() {
        let v = crate::ir::expr::VarId(v as u32);
        flat.variables[v].structural |= structural.contains(instance);
    }
    history::elaborate(cx, &mut flat);
    // Assertions of functions that are called in declarations.
    for a in std::mem::take(&mut cx.assertions.pending) {
        let origin = Origin { span: a.span, component: "".into() };
        let assert = Assert { condition: a.condition, message: a.message, level: a.level };
        flat.equations.push(Equation { kind: EquationKind::Assert(assert), origin });
    }
    inline::calls(cx, &mut flat);
    flat.functions = std::mem::take(&mut cx.loops.functions).into_iter().collect();
    flat.argument_units = std::mem::take(&mut cx.argument_units.noted);
    flat.graph = std::mem::take(&mut cx.graph);
    let mut problems = open_equation::apply(&mut flat, &terms);
    problems.extend(varying::apply(&mut flat, &variations));
    problems.extend(passage::apply(&mut flat, &passages));
    problems.extend(start_offset::apply(&mut flat, &starts));
    if !flat.transitions.is_empty() {
        flat.inner_outer = clocked::inner_outer(cx);
    }
    let about_clocks = crate::clocks::elaborate(&mut flat);
    // After other errors, equations are missing that clocks would follow from.
    if cx.problems.error_count() == errors_before {
        problems.extend(about_clocks);
    }
    for problem in problems {
        cx.class_graph.problems.push(problem);
    }
    flat
}

/// Components that have components, depth first in order of declaration.
fn objects(cx: &Evaluator<'_>, root: InstanceId) -> Vec<InstanceId> {
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
