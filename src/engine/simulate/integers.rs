//! Integers and strings without a value: numbers of a run are doubles, which count up to 2^53, and strings are as long as
//! `external::string_operator` allows.

use crate::base::diag::Diagnostic;
use crate::ir::dae::VariableKind;
use crate::ir::expr::{Type, VarId};
use crate::ir::program::{Program, Slot};

use super::cause::RunCause;
use super::failure::Failure;
use super::run::Simulation;

/// From here on `n` and `n + 1` may be the same number.
const TOO_LARGE: f64 = 9_007_199_254_740_992.0;

/// The Integer and String variables of a program that a run computes, with their slots.
pub fn integers(program: &Program) -> Vec<(VarId, Slot)> {
    let variables = program.blocks.dae.variables.enumerate();
    let is_computed = |kind| matches!(kind, VariableKind::Discrete | VariableKind::Parameter);
    variables
        .filter(|(_, v)| matches!(v.ty, Type::Integer | Type::String))
        .filter(|(_, v)| is_computed(v.kind) && !v.hidden)
        .map(|(id, _)| (id, program.layout.variables[id.0 as usize]))
        .collect()
}

impl Simulation<'_, '_> {
    /// Fails if an Integer is so large that its value may be wrong, or a string so long that it has none.
    pub(super) fn check_integers(&self, time: f64) -> Result<(), Failure> {
        let value = |slot: Slot| self.system.machine.get(slot);
        // No number stands for a string that is too long.
        let is_string = |v: VarId| self.program.blocks.dae.variables[v].ty == Type::String;
        let is_wrong = |x: f64, v| x.abs() >= TOO_LARGE || x.is_nan() && is_string(v);
        let found = self.integers.iter().find(|(v, slot)| is_wrong(value(*slot), *v));
        let Some(&(v, slot)) = found else { return Ok(()) };
        let variable = &self.program.blocks.dae.variables[v];
        let name = variable.name.clone();
        let cause = match variable.ty {
            Type::String => RunCause::StringTooLong { time, name },
            _ => RunCause::IntegerTooLarge { time, name, value: value(slot) },
        };
        Err(Failure::numerics(time, Diagnostic::new(cause, variable.span)))
    }
}
