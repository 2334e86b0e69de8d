//! Signals within a model that may reach what reads them changed: what a controller asks for, the force of a magnet, the
//! reading of a sensor in a loop.
//!
//! An actuator acts between a signal and those that read it. Beside the inputs of the model, signals are the outputs of its
//! components and the variables that an equation in its own source is solved for, if something else reads them.

use crate::base::index::FastSet;
use crate::calibrate::plan::Plan;
use crate::flatten::open_equation::{OpenEquation, explicit_equation};
use crate::ir::expr::{ExprId, Type, VarId};
use crate::ir::flat::{EquationKind, FlatModel, Variability, Variable};

use super::equal_variables::EqualVariables;

/// Most signals that actuators are hypotheses at.
const MAX_SIGNALS: usize = 6;

/// The signals of a flat model, by their names, in order of declaration. Inputs, and what equals one, are not among them.
///
/// A model around an FMU has none: its variables are those of the FMU.
pub fn inner_signals(flat: &FlatModel, plan: &Plan) -> Vec<String> {
    if plan.fmu.is_some() {
        return Vec::new();
    }
    let inputs = aliases_of_inputs(flat, plan);
    let read = read_elsewhere(flat);
    let is_signal = |(v, x): &(VarId, &Variable)| {
        let is_plain = x.ty == Type::Real
            && x.variability == Variability::Continuous
            && !x.is_open_input()
            && !x.protected
            && !x.name.contains(['[', '$']);
        is_plain && read.contains(v) && !inputs.contains(v) && is_determined(flat, *v)
    };
    let found = flat.variables.enumerate().filter(is_signal);
    found.map(|(_, x)| x.name.clone()).take(MAX_SIGNALS).collect()
}

/// True for an output of a component of the model, and for a variable of the model that an equation of its own source is
/// solved for.
fn is_determined(flat: &FlatModel, v: VarId) -> bool {
    let name = &flat.variables[v].name;
    let is_own = |e: OpenEquation| e.span.file == flat.span.file && !e.has_rate;
    match name.matches('.').count() {
        0 => explicit_equation(flat, v).is_some_and(is_own),
        1 => flat.ownership.is_output_of_component(v),
        _ => false,
    }
}

/// The inputs that recordings drive, and the variables that equal one of them.
fn aliases_of_inputs(flat: &FlatModel, plan: &Plan) -> FastSet<VarId> {
    let is_driven = |name: &str| plan.inputs.iter().any(|driven| driven.input == name);
    let driven = flat.variables.enumerate().filter(|(_, x)| is_driven(&x.name));
    EqualVariables::new(flat).of(driven.map(|(v, _)| v))
}

/// The variables that are read by an equation or binding other than that which determines them.
fn read_elsewhere(flat: &FlatModel) -> FastSet<VarId> {
    let mut readers: Vec<u32> = vec![0; flat.variables.len()];
    let mut count = |expressions: &[ExprId]| {
        let mut read: Vec<VarId> =
            expressions.iter().flat_map(|e| flat.graph.variables(*e)).collect();
        read.sort_unstable();
        read.dedup();
        read.into_iter().for_each(|v| readers[v.0 as usize] += 1);
    };
    for equation in &flat.equations {
        if let EquationKind::Equal(a, b) = equation.kind {
            count(&[a, b]);
        }
    }
    flat.variables.iter().filter_map(|x| x.binding).for_each(|bound| count(&[bound]));
    let is_read =
        |(v, x): &(VarId, &Variable)| readers[v.0 as usize] > u32::from(x.binding.is_none());
    flat.variables.enumerate().filter(is_read).map(|(v, _)| v).collect()
}
