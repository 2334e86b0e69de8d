//! The constant signals that drive the inputs of a model at an operating point.

use crate::base::name::without_spaces;
use std::sync::Arc;

use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::numeric::time_series::{Interpolation, TimeSeries};
use crate::runtime::machine::Machine;

use super::settings::Settings;

/// The variables of these names. Errors: the first name that no variable has.
pub fn named(program: &Program, names: &[String]) -> Result<Vec<VarId>, String> {
    let variables = &program.blocks.dae.variables;
    let find = |name: &String| {
        let plain = without_spaces(name);
        let found = variables.enumerate().find(|(_, v)| v.name == plain && !v.hidden);
        found.map(|(id, _)| id).ok_or_else(|| name.clone())
    };
    names.iter().map(find).collect()
}

/// Drives inputs by constants: those given, in SI units, and the start values of the others.
pub fn hold(program: &Program, inputs: &[VarId], given: &[(VarId, f64)], settings: &mut Settings) {
    let mut machine = Machine::new(program);
    for &(v, value) in &settings.starts {
        machine.set_start(v, value);
    }
    for &(v, value) in &settings.parameters {
        machine.set_parameter(v, value);
    }
    let is_known = machine.run(&program.tapes.parameters).is_ok();
    let start = |v: VarId| {
        let starts = &program.layout.starts;
        let slot = starts.iter().find(|(s, ..)| *s == v).map(|(.., slot)| *slot);
        slot.filter(|_| is_known).map_or(0.0, |slot| machine.get(slot))
    };
    for v in inputs {
        let value = given.iter().find(|(g, _)| g == v).map_or_else(|| start(*v), |(_, x)| *x);
        let series = TimeSeries::new([settings.start].into(), vec![value], Interpolation::Linear);
        settings.courses.push((*v, Arc::new(series)));
    }
}
