//! The free parameters of a fit: their inputs in the program, and their coordinates in the search.

use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::source::Span;
use crate::ir::expr::{Type, VarId};
use crate::ir::program::Program;
use crate::runtime::machine::Machine;
use crate::simulate::sensitivity::Input;

use super::cause::PlanCause;
use super::data::{Recording, Split};
use super::plan::Free;

/// The coordinate of a parameter in the search.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Scale {
    /// Positive parameters: `value = size * x` below `x = 1`, so that the data still have an influence on a
    /// value close to zero, and `value = size * exp(x - 1)` above.
    Positive {
        /// Value at `x = 1`.
        size: f64,
    },
    /// `value = size * x`
    Linear {
        /// Value at `x = 1`.
        size: f64,
    },
}

impl Scale {
    /// The value at `x`.
    pub fn value(self, x: f64) -> f64 {
        match self {
            Scale::Positive { size } if x > 1.0 => size * (x - 1.0).exp(),
            Scale::Positive { size } | Scale::Linear { size } => size * x,
        }
    }

    /// The coordinate of a value.
    pub fn place(self, value: f64) -> f64 {
        match self {
            Scale::Positive { size } if value > size => 1.0 + (value / size).ln(),
            Scale::Positive { size } | Scale::Linear { size } => value / size,
        }
    }

    /// Derivative of the value by its coordinate, at this value.
    pub fn slope(self, value: f64) -> f64 {
        match self {
            Scale::Positive { size } if value > size => value,
            Scale::Positive { size } | Scale::Linear { size } => size,
        }
    }
}

/// A free parameter in the search.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its unit, as the model declares it.
    pub unit: String,
    /// Inputs of the program that take its value.
    pub targets: Vec<Input>,
    /// Its coordinate in the search.
    pub scale: Scale,
    /// Its start.
    pub start: f64,
    /// Its bounds.
    pub bounds: (f64, f64),
    /// The only signal that it acts on, and the position of the recorded variable through which it does.
    pub acts_on: Option<(usize, usize)>,
    /// The only recording that takes its value, if it is not the same for all.
    pub only: Option<String>,
}

impl Parameter {
    /// True if the runs of a recording take its value.
    pub fn acts_in(&self, recording: &Recording) -> bool {
        let is_only = |of: &String| *of == recording.of && recording.split == Split::Train;
        self.only.as_ref().is_none_or(is_only)
    }

    /// Its bounds in coordinates of the search.
    pub fn range(&self) -> (f64, f64) {
        (self.scale.place(self.bounds.0), self.scale.place(self.bounds.1))
    }
}

/// The input of the program that a name in the plan refers to.
pub fn input(
    program: &Program,
    wanted: &str,
    span: Span,
    problems: &mut Problems,
) -> Option<Input> {
    let start = wanted.strip_prefix("start(").and_then(|rest| rest.strip_suffix(')'));
    let name = start.unwrap_or(wanted).trim();
    let layout = &program.layout;
    let variables = &program.blocks.dae.variables;
    let parameters = || layout.parameter_inputs.iter().map(|(v, _)| *v);
    let starts = || layout.starts.iter().map(|(v, ..)| *v);
    let found = match start {
        None => parameters().find(|v| program.name(*v) == name).map(Input::Parameter),
        Some(_) => starts().find(|v| program.name(*v) == name).map(Input::Start),
    };
    if found.is_none() {
        let exists = variables.iter().any(|v| v.name == name);
        let kind = if start.is_some() { "start value" } else { "parameter" };
        let names: Vec<&str> = match start {
            None => parameters().map(|v| program.name(v)).collect(),
            Some(_) => starts().map(|v| program.name(v)).collect(),
        };
        let of_variable = start.is_none() && starts().any(|v| program.name(v) == name);
        let near = match of_variable {
            true => Some(format!("start({name})")),
            false => did_you_mean(name, names).map(str::to_owned),
        };
        let name = name.to_owned();
        let cause = match exists {
            true => PlanCause::NotSettable { kind, name, near },
            false => PlanCause::UnknownParameter { kind, name, near },
        };
        problems.push(Diagnostic::new(cause, span));
    }
    found
}

/// Why a parameter cannot be varied continuously.
fn unfittable(program: &Program, v: VarId) -> Option<&'static str> {
    let variable = &program.blocks.dae.variables[v];
    match variable.ty {
        Type::Integer => Some("it is an Integer"),
        Type::Boolean | Type::Clock => Some("it is a Boolean"),
        Type::Enumeration(_) => Some("it is an enumeration"),
        Type::String => Some("it is a String"),
        Type::Real if variable.structural => {
            Some("it is a constant, `final`, or decides the structure of the model")
        }
        Type::Real => None,
    }
}

/// A free parameter of the plan, with the coordinate in which it is searched.
pub fn parameter(
    program: &Program,
    machine: &Machine<'_>,
    free: &Free,
    problems: &mut Problems,
) -> Option<Parameter> {
    let targets: Option<Vec<Input>> =
        free.targets.iter().map(|t| input(program, t, free.span, problems)).collect();
    let targets = targets?;
    let of_parameter = |input: &Input| match input {
        Input::Parameter(v) => Some(*v),
        Input::Start(_) => None,
    };
    for v in targets.iter().filter_map(of_parameter) {
        if let Some(why) = unfittable(program, v) {
            let name = program.name(v).to_owned();
            problems.push(Diagnostic::new(PlanCause::NotFittable { name, why }, free.span));
            return None;
        }
    }
    let (v, declared) = match targets.first()? {
        Input::Parameter(v) => (*v, machine.value(*v)),
        Input::Start(v) => {
            let starts = &program.layout.starts;
            let (.., cell) = starts.iter().find(|(s, ..)| s == v)?;
            (*v, machine.get(*cell))
        }
    };
    let start = free.start.unwrap_or(declared);
    let positive = start > 0.0 && free.min.is_none_or(|m| m >= 0.0);
    let scale = if positive {
        Scale::Positive { size: start }
    } else {
        let span = free.max.zip(free.min).map_or(1.0, |(a, b)| 0.25 * (a - b));
        let size = if start == 0.0 { span } else { start.abs() };
        Scale::Linear { size }
    };
    let wide = match free.around.filter(|_| positive) {
        Some(factor) => (start / factor, start * factor),
        None => (f64::NEG_INFINITY, f64::INFINITY),
    };
    let bounds = (free.min.unwrap_or(wide.0), free.max.unwrap_or(wide.1));
    let unit = program.blocks.dae.variables[v].unit.to_string();
    let acts_on = free.acts_on.as_ref().and_then(|(signal, variable)| {
        let column = program.recorded.iter().position(|v| program.name(*v) == variable)?;
        Some((*signal, column))
    });
    let (name, only) = (free.name.clone(), free.only.clone());
    Some(Parameter { name, unit, targets, scale, start, bounds, acts_on, only })
}
