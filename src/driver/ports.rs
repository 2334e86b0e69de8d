//! Programs of models with connections to their surroundings: inputs that are driven, outputs that are read.

use super::cause::RequestCause;
use super::compile::{CompileError, Request, Session};

use crate::base::diag::{Diagnostic, did_you_mean};
use crate::base::source::Span;
use crate::fmu::terminals::Connector;
use crate::ir::assembly::{Assembly, Port};
use crate::ir::expr::{Const, Type, VarId};
use crate::ir::flat::{Causality, FlatModel, Variability, Variable};
use crate::ir::program::Program;

/// The connections of a model to its surroundings: Real variables at its top level.
#[derive(Clone, Debug, Default)]
pub struct Ports {
    /// Names of the inputs without a value.
    pub inputs: Vec<String>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
    /// Its inputs that change at events alone: Booleans, Integers, enumerations and discrete Reals. They can be driven,
    /// too.
    pub discrete_inputs: Vec<String>,
}

impl Ports {
    /// The names of all inputs that can be driven.
    pub fn all_inputs(&self) -> Vec<&str> {
        self.inputs.iter().chain(&self.discrete_inputs).map(String::as_str).collect()
    }
}

/// A model for another tool.
pub struct Exportable {
    /// Its program.
    pub program: Program,
    /// The causality of its top-level variables.
    pub causalities: Vec<(String, Causality)>,
    /// Its own connectors.
    pub connectors: Vec<Connector>,
    /// Its components, for a picture.
    pub assembly: Assembly,
}

/// The connectors of the model itself, with their variables.
fn connectors(flat: &FlatModel, assembly: &Assembly) -> Vec<Connector> {
    let ports = assembly.parts.first().map_or(&[][..], |model| &model.ports);
    let of = |port: &Port| {
        let prefix = format!("{}.", port.name);
        let own = flat
            .variables
            .enumerate()
            .filter(|(_, v)| v.name.starts_with(&prefix) && v.variability > Variability::Parameter);
        let is_flow = |k: VarId| flat.ownership.is_flow.get(k.0 as usize) == Some(&true);
        let variables = own.map(|(k, v)| (v.name.clone(), is_flow(k))).collect();
        Connector { name: port.name.clone(), class: port.class.clone(), variables }
    };
    ports.iter().map(of).filter(|c| !c.variables.is_empty()).collect()
}

impl Session {
    /// The program of a request, all of whose top-level inputs are driven, and the names of its inputs and outputs.
    pub fn compile_with_ports(
        &mut self,
        request: &Request,
    ) -> Result<(Program, Ports), CompileError> {
        let mut flat = self.flatten(request)?;
        let is_real = |v: &Variable| v.ty == Type::Real && v.variability == Variability::Continuous;
        let of = |causality: Causality| {
            let all =
                flat.variables.iter().filter(move |v| is_real(v) && v.causality == Some(causality));
            all.map(|v| (v.name.clone(), v.binding.is_none()))
        };
        let inputs = of(Causality::Input).filter(|(_, is_free)| *is_free).map(|(name, _)| name);
        let outputs = of(Causality::Output).map(|(name, _)| name);
        let discrete = flat.variables.iter().filter(|v| v.is_open_input() && is_discrete(v));
        let ports = Ports {
            inputs: inputs.collect(),
            outputs: outputs.collect(),
            discrete_inputs: discrete.map(|v| v.name.clone()).collect(),
        };
        self.drive(&mut flat, &ports.inputs)?;
        for k in flat.variables.ids() {
            if flat.variables[k].is_open_input() && is_discrete(&flat.variables[k]) {
                start(&mut flat, k);
            }
        }
        Ok((self.compile_flat(flat, request.form)?, ports))
    }

    /// A model for another tool: its program, all of whose free inputs may be set while it runs.
    pub fn compile_for_export(&mut self, request: &Request) -> Result<Exportable, CompileError> {
        let (mut flat, assembly) = self.flatten_with_assembly(request)?;
        let known = |v: &Variable| v.causality.map(|causality| (v.name.clone(), causality));
        let is_free = |v: &Variable| v.causality != Some(Causality::Input) || v.binding.is_none();
        let causalities = flat.variables.iter().filter(|v| is_free(v)).filter_map(known).collect();
        let connectors = connectors(&flat, &assembly);
        let mut driven = Vec::new();
        for k in flat.variables.ids() {
            let v = &flat.variables[k];
            if !v.is_open_input() {
                continue;
            }
            if v.ty == Type::Real && v.variability == Variability::Continuous {
                driven.push(v.name.clone());
            } else {
                start(&mut flat, k);
            }
        }
        self.drive(&mut flat, &driven)?;
        let program = self.compile_flat(flat, request.form)?;
        Ok(Exportable { program, causalities, connectors, assembly })
    }

    /// Marks the inputs that recordings drive; each must exist and have no value of its own.
    pub fn drive(&mut self, flat: &mut FlatModel, inputs: &[String]) -> Result<(), CompileError> {
        for input in inputs {
            let found = flat.variables.enumerate().find(|(_, v)| v.name == *input);
            match found {
                Some((id, v)) if v.is_open_input() && is_discrete(v) => start(flat, id),
                Some((id, v)) if v.is_open_input() && v.ty == Type::Real => flat.recorded.push(id),
                Some((_, v)) => {
                    let cause = RequestCause::NotDrivable { name: input.clone() };
                    self.problems.push(Diagnostic::new(cause, v.span));
                }
                None => {
                    let inputs =
                        flat.variables.iter().filter(|v| v.causality == Some(Causality::Input));
                    let names = inputs.map(|v| v.name.as_str());
                    let near = did_you_mean(input, names).map(str::to_owned);
                    let cause = RequestCause::UnknownInput { name: input.clone(), near };
                    self.problems.push(Diagnostic::new(cause, Span::NONE));
                }
            }
        }
        self.checked(CompileError::Request)
    }
}

/// A variable whose values change at events alone, and are numbers in memory.
fn is_discrete(v: &Variable) -> bool {
    match v.ty {
        Type::Real => v.variability == Variability::Discrete,
        Type::Boolean | Type::Integer | Type::Enumeration(_) => {
            v.variability > Variability::Parameter
        }
        Type::String | Type::Clock => false,
    }
}

/// Gives a variable a start value: what can be set has one.
fn start(flat: &mut FlatModel, k: VarId) {
    if flat.variables[k].start.is_none() {
        let ty = flat.variables[k].ty;
        let value = f64::from(u8::from(matches!(ty, Type::Enumeration(_))));
        let start = flat.graph.constant(Const::of_type(ty, value));
        flat.variables[k].start = Some(start);
    }
}
