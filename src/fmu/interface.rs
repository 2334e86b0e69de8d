//! The variables of a model as FMI sees them.
//!
//! In: a program, and the causality of its top-level variables. Out: one [`Scalar`] for each variable, with its
//! value reference, causality, variability, start value and aliases.

use super::tunable::tunable;
use crate::base::index::{FastMap, FastSet};
use crate::base::name::string_of_id;
use crate::ir::dae::{Variable, VariableKind};
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::Causality;
use crate::ir::program::Program;
use crate::runtime::machine::Machine;
use crate::simulate::columns::{alias, is_constant, is_parameter};

/// Value references from here on are derivatives of states, by the number of the state.
pub const FIRST_DERIVATIVE: u32 = 1 << 30;
/// Value references from here on are event indicators.
pub const FIRST_INDICATOR: u32 = 3 << 29;

/// `causality`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Role {
    Parameter,
    CalculatedParameter,
    Input,
    Output,
    Local,
}

/// `variability`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Varies {
    Constant,
    Fixed,
    Tunable,
    Discrete,
    Continuous,
}

/// `initial`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Initial {
    Exact,
    Approx,
    Calculated,
}

/// A start value.
#[derive(Clone, PartialEq, Debug)]
pub enum Start {
    /// A number; of a Boolean 0 or 1.
    Number(f64),
    /// A string.
    Text(String),
}

/// A further name of a variable.
#[derive(Clone, PartialEq, Debug)]
pub struct Alias {
    /// The name.
    pub name: String,
    /// The description.
    pub description: Option<String>,
    /// The display unit, may be empty.
    pub display_unit: String,
}

/// A variable.
#[derive(Clone, PartialEq, Debug)]
pub struct Scalar {
    /// The value reference.
    pub reference: u32,
    /// The name.
    pub name: String,
    /// The description.
    pub description: Option<String>,
    /// The type.
    pub ty: Type,
    /// The causality.
    pub role: Role,
    /// The variability.
    pub varies: Varies,
    /// How the first value is found; `None` for inputs, whose value is given.
    pub initial: Option<Initial>,
    /// The start value, where FMI asks for one.
    pub start: Option<Start>,
    /// The unit, may be empty.
    pub unit: String,
    /// The unit for display, may be empty.
    pub display_unit: String,
    /// Bounds.
    pub min: Option<f64>,
    /// Bounds.
    pub max: Option<f64>,
    /// Typical size.
    pub nominal: Option<f64>,
    /// The value reference of the state that this is the derivative of.
    pub derivative_of: Option<u32>,
    /// It is a state.
    pub is_state: bool,
    /// Further names.
    pub aliases: Vec<Alias>,
}

/// All variables of a model in the order of declaration; derivatives of states last.
pub fn scalars(program: &Program, causalities: &[(String, Causality)]) -> Vec<Scalar> {
    let dae = &program.blocks.dae;
    let mut machine = Machine::new(program);
    // Without valid parameters, start values are those of the declarations as far as they are known.
    let _ = machine.run(&program.tapes.parameters);
    let builder = Builder {
        program,
        machine,
        causalities: causalities.iter().map(|(name, c)| (name.as_str(), *c)).collect(),
        states: program.blocks.states.iter().map(|s| s.variable).collect(),
        eliminated: dae.eliminated.iter().copied().collect(),
        values: dae.parameters.iter().copied().collect(),
        tunable: tunable(program),
    };
    let derivative_names: FastSet<String> =
        program.blocks.states.iter().map(|s| derivative_name(program, s.variable)).collect();
    let mut all: Vec<Scalar> = Vec::new();
    let mut aliases: Vec<(VarId, Alias)> = Vec::new();
    for (v, variable) in dae.variables.enumerate() {
        let is_state = builder.states.contains(&v);
        if (variable.hidden && !is_state) || derivative_names.contains(&variable.name) {
            continue;
        }
        match builder.alias_root(v, variable) {
            Some(root) => aliases.push((
                root,
                Alias {
                    name: variable.name.clone(),
                    description: variable.description.as_ref().map(ToString::to_string),
                    display_unit: variable.display_unit.to_string(),
                },
            )),
            None => all.push(builder.scalar(v, variable)),
        }
    }
    let places: FastMap<u32, usize> =
        all.iter().enumerate().map(|(at, s)| (s.reference, at)).collect();
    for (root, alias) in aliases {
        if let Some(at) = places.get(&reference(root)) {
            all[*at].aliases.push(alias);
        }
    }
    for (k, state) in program.blocks.states.iter().enumerate() {
        let of = &dae.variables[state.variable];
        all.push(Scalar {
            reference: FIRST_DERIVATIVE + k as u32,
            name: derivative_name(program, state.variable),
            description: None,
            ty: Type::Real,
            role: Role::Local,
            varies: Varies::Continuous,
            initial: Some(Initial::Calculated),
            start: None,
            unit: rate_unit(&of.unit),
            display_unit: String::new(),
            min: None,
            max: None,
            nominal: None,
            derivative_of: Some(reference(state.variable)),
            is_state: false,
            aliases: Vec::new(),
        });
    }
    all
}

/// The value reference of a variable.
pub fn reference(v: VarId) -> u32 {
    v.0 + 1
}

fn derivative_name(program: &Program, state: VarId) -> String {
    format!("der({})", program.name(state))
}

/// The unit of a rate.
fn rate_unit(unit: &str) -> String {
    match unit {
        "" => String::new(),
        "1" => "1/s".to_owned(),
        "m/s" => "m/s2".to_owned(),
        "rad/s" => "rad/s2".to_owned(),
        unit if unit.contains('/') => format!("({unit})/s"),
        unit => format!("{unit}/s"),
    }
}

struct Builder<'p> {
    program: &'p Program,
    machine: Machine<'p>,
    causalities: FastMap<&'p str, Causality>,
    states: FastSet<VarId>,
    eliminated: FastMap<VarId, ExprId>,
    values: FastMap<VarId, ExprId>,
    tunable: FastSet<VarId>,
}

impl Builder<'_> {
    /// The variable of which this is another name.
    fn alias_root(&self, v: VarId, variable: &Variable) -> Option<VarId> {
        let dae = &self.program.blocks.dae;
        if self.causalities.contains_key(variable.name.as_str()) {
            return None;
        }
        let (root, negated) = alias(dae, *self.eliminated.get(&v)?)?;
        let other = &dae.variables[root];
        let is_listed = !other.hidden && !self.eliminated.contains_key(&root);
        let is_like = other.ty == variable.ty && other.unit == variable.unit;
        let is_derivative = self
            .program
            .blocks
            .states
            .iter()
            .any(|s| other.name == derivative_name(self.program, s.variable));
        let is_port = self.causalities.contains_key(other.name.as_str());
        let is_own = is_port
            || is_parameter(dae, root)
            || is_derivative
            || other.kind == VariableKind::Input;
        (!negated && is_listed && is_like && !is_own).then_some(root)
    }

    fn scalar(&self, v: VarId, variable: &Variable) -> Scalar {
        let graph = &self.program.blocks.dae.graph;
        let number =
            |e: Option<ExprId>| e.and_then(|e| graph.as_number(e)).filter(|x| x.is_finite());
        let (role, varies, initial) = self.classified(v, variable);
        let is_string = variable.ty == Type::String;
        let needs_start = role == Role::Input
            || varies == Varies::Constant
            || matches!(initial, Some(Initial::Exact | Initial::Approx));
        let start = needs_start.then(|| {
            let value = self.start(v, variable);
            match is_string {
                true => Start::Text(string_of_id(value as u32).to_string()),
                false => Start::Number(value),
            }
        });
        Scalar {
            reference: reference(v),
            name: variable.name.clone(),
            description: variable.description.as_ref().map(ToString::to_string),
            ty: variable.ty,
            role,
            varies,
            initial,
            start,
            unit: variable.unit.to_string(),
            display_unit: variable.display_unit.to_string(),
            min: number(variable.min),
            max: number(variable.max),
            nominal: number(variable.nominal).map(f64::abs).filter(|x| *x > 0.0),
            derivative_of: None,
            is_state: self.states.contains(&v),
            aliases: Vec::new(),
        }
    }

    fn classified(&self, v: VarId, variable: &Variable) -> (Role, Varies, Option<Initial>) {
        let dae = &self.program.blocks.dae;
        let layout = &self.program.layout;
        let causality = self.causalities.get(variable.name.as_str());
        let role = if causality == Some(&Causality::Output) { Role::Output } else { Role::Local };
        let is_real = variable.ty == Type::Real;
        let has_start = layout.starts.iter().any(|(s, ..)| *s == v);
        let exact = |is_exact: bool| match (is_exact && has_start, has_start) {
            (true, _) => Some(Initial::Exact),
            (false, true) => Some(Initial::Approx),
            (false, false) => Some(Initial::Calculated),
        };
        if causality == Some(&Causality::Input) {
            let varies = if is_real { Varies::Continuous } else { Varies::Discrete };
            return (Role::Input, varies, None);
        }
        match variable.kind {
            VariableKind::Parameter => {
                let settable = layout.parameter_inputs.iter().any(|(p, _)| *p == v);
                if variable.structural || !settable || variable.ty == Type::String {
                    return (role, Varies::Constant, Some(Initial::Exact));
                }
                let value = self.values.get(&v).and_then(|e| dae.graph.as_const(*e));
                let varies =
                    if self.tunable.contains(&v) { Varies::Tunable } else { Varies::Fixed };
                match value {
                    Some(_) => (Role::Parameter, varies, Some(Initial::Exact)),
                    None => (Role::CalculatedParameter, varies, Some(Initial::Calculated)),
                }
            }
            VariableKind::InitialParameter => {
                (Role::CalculatedParameter, Varies::Fixed, Some(Initial::Calculated))
            }
            _ if self.states.contains(&v) => {
                let assumed = self.program.blocks.assumed_starts.contains(&v);
                (role, Varies::Continuous, exact(assumed || variable.fixed == Some(true)))
            }
            VariableKind::Discrete | VariableKind::Input => {
                let initial = match variable.fixed == Some(true) && has_start {
                    true => Initial::Exact,
                    false => Initial::Calculated,
                };
                (role, Varies::Discrete, Some(initial))
            }
            VariableKind::Eliminated => {
                let value = self.eliminated.get(&v).copied();
                let is_fixed = value.is_some_and(|value| {
                    is_constant(dae, value)
                        || matches!(dae.graph.node(value), Node::Var(p) if is_parameter(dae, p))
                });
                let varies = match (is_fixed && role == Role::Local, is_real) {
                    (true, _) => Varies::Fixed,
                    (false, true) => Varies::Continuous,
                    (false, false) => Varies::Discrete,
                };
                (role, varies, Some(Initial::Calculated))
            }
            VariableKind::Differentiated { .. } | VariableKind::Algebraic => {
                let varies = if is_real { Varies::Continuous } else { Varies::Discrete };
                (role, varies, Some(Initial::Calculated))
            }
        }
    }

    /// The start value of a variable, or the value of a parameter.
    fn start(&self, v: VarId, variable: &Variable) -> f64 {
        let starts = &self.program.layout.starts;
        let slot = starts.iter().find(|(s, ..)| *s == v).map(|(.., slot)| *slot);
        let value = match (variable.kind, slot) {
            (VariableKind::Parameter, _) | (_, None) => self.machine.value(v),
            (_, Some(slot)) => self.machine.get(slot),
        };
        let graph = &self.program.blocks.dae.graph;
        let declared = variable.start.and_then(|e| graph.as_number(e));
        match value.is_finite() {
            true if slot.is_none() && variable.kind != VariableKind::Parameter => {
                declared.unwrap_or(value)
            }
            true => value,
            false => declared.unwrap_or(0.0),
        }
    }
}
