//! The constant signals that drive the inputs of a model at an operating point.

use crate::base::name::without_spaces;
use std::sync::Arc;

use crate::ir::expr::{Type, VarId};
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

/// Drives inputs by constants: those given, in SI units, and the start values of the others. Discrete inputs are driven if
/// they are given.
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
    let begin = settings.start;
    let constant =
        |value: f64| Arc::new(TimeSeries::new([begin].into(), vec![value], Interpolation::Linear));
    for (v, value) in given.iter().filter(|(v, _)| !inputs.contains(v)) {
        settings.courses.push((*v, constant(*value)));
    }
    for v in inputs {
        let value = given.iter().find(|(g, _)| g == v).map_or_else(|| start(*v), |(_, x)| *x);
        settings.courses.push((*v, constant(value)));
    }
}

/// A value for a discrete input. Errors: it is none of its type.
pub fn discrete_value(program: &Program, v: VarId, value: f64) -> Result<f64, String> {
    let variable = &program.blocks.dae.variables[v];
    match variable.ty {
        Type::Boolean if value != 0.0 && value != 1.0 => {
            Err(format!("`{}` is a Boolean; give true or false, or 1 or 0", variable.name))
        }
        Type::Integer | Type::Enumeration(_) if value.fract() != 0.0 => {
            Err(format!("`{}` is an Integer, and {value} is none", variable.name))
        }
        _ => Ok(value),
    }
}
