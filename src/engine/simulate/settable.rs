//! Names of parameters and start values to the inputs of a program that a run may set.

use crate::ir::expr::Type;
use crate::ir::program::Program;

use super::sensitivity::Input;

/// The Real parameter `x`, or the start value of a Real `x.start`, if a run may set it. Without one, the program itself may
/// depend on the value, so the model has to be compiled with it.
pub fn settable(program: &Program, name: &str) -> Option<Input> {
    let variables = &program.blocks.dae.variables;
    let mut parameters = program.layout.parameter_inputs.iter().map(|(v, _)| *v);
    let parameter = parameters.find(|v| program.name(*v) == name && !variables[*v].structural);
    let start = || {
        let variable = name.strip_suffix(".start")?;
        let mut starts = program.layout.starts.iter().map(|(v, ..)| *v);
        starts.find(|v| program.name(*v) == variable)
    };
    let found = match parameter {
        Some(v) if variables[v].ty == Type::Real => Some(Input::Parameter(v)),
        _ => start().map(Input::Start),
    };
    found.filter(|input| variables[input.variable()].ty == Type::Real)
}
