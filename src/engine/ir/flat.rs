//! The flat model: scalar variables and scalar equations, as chapter 5.6 of the Modelica
//! specification describes them.
//!
//! *Holds:* every scalar variable with evaluated structure (dimensions, conditions, `if` on structural
//! parameters), equations of connections written out, calls inlined or their functions listed, every equation
//! with its source position. Expressions still contain `der`, `pre` and relations.
//! *Never holds:* arrays, records, `connect`, `for`, classes, modifications.
//! *Made by:* `flatten`. *Read by:* `lower`, and printed as flat Modelica by `flatten::print`.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::expr::{ExprId, FunctionId, Graph, Type, VarId};
use crate::base::index::{FastSet, IndexVec};
use crate::base::name::Name;
use crate::base::source::Span;

pub use super::ast::{Causality, Variability};
pub use super::function::{Assert, AssertionLevel, Function, LocalId, Statement, StraightLine};

/// A flat model.
#[derive(Clone)]
pub struct FlatModel {
    /// Name of the class that was flattened.
    pub name: String,
    /// Its description string.
    pub description: Option<Arc<str>>,
    /// Position of its name.
    pub span: Span,
    /// All expressions.
    pub graph: Graph,
    /// Variables in order of declaration, depth first.
    pub variables: IndexVec<VarId, Variable>,
    /// `equation` sections, bindings of non-parameters excluded (they stay with the variable).
    pub equations: Vec<Equation>,
    /// `initial equation` sections.
    pub initial_equations: Vec<Equation>,
    /// The functions that calls refer to.
    pub functions: IndexVec<FunctionId, Function>,
    /// `annotation(experiment(...))`.
    pub experiment: Experiment,
    /// Positions of equations and declarations in which constants have lost their units.
    pub unitless_literals: FastSet<Span>,
    /// Arguments of calls, with the units of the inputs that they are given for.
    pub argument_units: Vec<UnitOfArgument>,
    /// Inputs without a value that take theirs from recordings.
    pub recorded: Vec<VarId>,
    /// Variables that `flatten` made for its own purposes.
    pub synthetic: Vec<VarId>,
    /// Delayed expressions.
    pub delays: Vec<Delay>,
    /// Variables whose derivatives are given.
    pub given_derivatives: Vec<GivenDerivative>,
    /// Transport lines.
    pub transports: Vec<Transport>,
    /// Which component must determine which variable.
    pub ownership: Ownership,
    /// `initialState`: dotted names of the states, and the places of the calls. Gone after `clocks`.
    pub initial_states: Vec<(Arc<str>, Span)>,
    /// The transitions of state machines. Gone after `clocks`.
    pub transitions: Vec<Transition>,
    /// Variables of state machines that are `inner outer`, each with the outer one. Gone after `clocks`.
    pub inner_outer: Vec<(VarId, VarId)>,
}

/// An argument of a call, and the unit of the input that it is given for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct UnitOfArgument {
    /// The argument.
    pub value: ExprId,
    /// The unit that the function declares.
    pub unit: Name,
    /// Full name of the function.
    pub function: Name,
    /// Name of the input.
    pub input: Name,
    /// Place of the call.
    pub span: Span,
}

/// `transition(from, to, condition, immediate, reset, synchronize, priority)`
#[derive(Clone, Debug)]
pub struct Transition {
    /// Dotted name of the state that is left.
    pub from: Arc<str>,
    /// Dotted name of the state that is entered.
    pub to: Arc<str>,
    /// When it fires.
    pub condition: ExprId,
    /// At once, or one tick later.
    pub immediate: bool,
    /// Whether the state that is entered starts anew.
    pub reset: bool,
    /// Whether it waits for the final states of the state machines in the state that is left.
    pub synchronize: bool,
    /// Of several that could fire, the one with the lowest number does.
    pub priority: i64,
    /// Where it comes from.
    pub origin: Origin,
}

/// The components that must determine the variables, if each component is balanced.
#[derive(Clone, Debug, Default)]
pub struct Ownership {
    /// Dotted names of the components; the first, empty, is the model itself.
    pub components: Vec<Arc<str>>,
    /// For each variable, by its number, the component that must determine it: that of its
    /// declaration, or for inputs and flows the one around it. Variables that `flatten` adds have none.
    pub owner: Vec<u32>,
    /// For each variable, whether it is a flow.
    pub is_flow: Vec<bool>,
    /// For each variable, whether it is an output of the component that it is declared in.
    pub is_output: Vec<bool>,
}

impl Ownership {
    /// True for an output of a component, other than of the model itself.
    pub fn is_output_of_component(&self, v: VarId) -> bool {
        let of = |all: &[bool]| all.get(v.0 as usize).copied().unwrap_or(false);
        of(&self.is_output) && self.owner.get(v.0 as usize).is_some_and(|owner| *owner != 0)
    }
}

/// Defaults of a run from `annotation(experiment(...))`.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Experiment {
    /// `StartTime`, s.
    pub start: Option<f64>,
    /// `StopTime`, s.
    pub stop: Option<f64>,
    /// `Interval`, s.
    pub interval: Option<f64>,
    /// `Tolerance`, relative.
    pub tolerance: Option<f64>,
}

/// `stateSelect`, in rising order of preference.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
#[allow(missing_docs)]
pub enum StateSelect {
    Never,
    Avoid,
    #[default]
    Default,
    Prefer,
    Always,
}

/// A scalar variable.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Full dotted name, array elements as `a[1]`, as the user knows it.
    pub name: String,
    /// Scalar type.
    pub ty: Type,
    /// Constant, parameter, discrete or continuous; never more than what the type allows
    /// (an `Integer` without prefix is `Discrete`).
    pub variability: Variability,
    /// `input` or `output` at the top level.
    pub causality: Option<Causality>,
    /// Declaration equation; for parameters and constants their value.
    pub binding: Option<ExprId>,
    /// `start`.
    pub start: Option<ExprId>,
    /// `fixed`, evaluated; `None` where not written.
    pub fixed: Option<bool>,
    /// `min`.
    pub min: Option<ExprId>,
    /// `max`.
    pub max: Option<ExprId>,
    /// `nominal`.
    pub nominal: Option<ExprId>,
    /// `unit`; empty where not given.
    pub unit: Name,
    /// `displayUnit`; empty where not given.
    pub display_unit: Name,
    /// `stateSelect`.
    pub state_select: StateSelect,
    /// The description string.
    pub description: Option<Arc<str>>,
    /// Declared after `protected`.
    pub protected: bool,
    /// Its value was used to fix the structure (a size, a condition), or it is `final`.
    pub structural: bool,
    /// Place of the declaration.
    pub span: Span,
}

impl Variable {
    /// True for an input of the model itself that nothing in the model determines.
    pub fn is_open_input(&self) -> bool {
        self.causality == Some(Causality::Input) && self.binding.is_none()
    }

    /// A visible variable without attributes, binding or description.
    pub fn bare(name: String, ty: Type, variability: Variability, span: Span) -> Self {
        let nothing = Name::from("");
        Variable {
            name,
            ty,
            variability,
            causality: None,
            binding: None,
            start: None,
            fixed: None,
            min: None,
            max: None,
            nominal: None,
            unit: nothing,
            display_unit: nothing,
            state_select: StateSelect::Default,
            description: None,
            protected: false,
            structural: false,
            span,
        }
    }
}

/// Where an equation comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Source position.
    pub span: Span,
    /// Dotted name of the component whose class holds it; empty for the model itself.
    pub component: Arc<str>,
}

/// An equation.
#[derive(Clone, Debug)]
pub struct Equation {
    /// Its form.
    pub kind: EquationKind,
    /// Where it comes from.
    pub origin: Origin,
}

/// The forms of flat equations.
#[derive(Clone, Debug)]
pub enum EquationKind {
    /// `a = b`, both scalar of one type. `if` equations have become `if` expressions.
    Equal(ExprId, ExprId),
    /// A when-clause: the first branch whose condition becomes true acts.
    When(Vec<WhenBranch>),
    /// `assert(condition, message, level)`.
    Assert(Assert),
    /// `terminate(message)` outside a when-clause is not allowed, so only [`Action`] has it;
    /// an algorithm section: `outputs[i] := values[i]` for all i at once.
    Algorithm {
        /// The variables that the section assigns.
        outputs: Vec<VarId>,
        /// The value of each after the section, in terms of other variables (and of `pre(v)` or the
        /// start value where a variable is read before it is assigned).
        values: Vec<ExprId>,
    },
}

/// One branch of a when-clause.
#[derive(Clone, Debug)]
pub struct WhenBranch {
    /// The scalar conditions; a vector condition `{a, b}` has several: any edge activates.
    pub conditions: Vec<ExprId>,
    /// The actions, in order.
    pub actions: Vec<Action>,
}

impl WhenBranch {
    /// The variables that actions assign.
    pub fn assigned(actions: &[Action]) -> BTreeSet<VarId> {
        let variable = |action: &Action| match action {
            Action::Assign(v, _) => Some(*v),
            _ => None,
        };
        actions.iter().filter_map(variable).collect()
    }
}

/// An action of a when-clause.
#[derive(Clone, Debug)]
pub enum Action {
    /// `v = value`
    Assign(VarId, ExprId),
    /// `reinit(state, value)`, only if `guard` (from an `if` inside the when-clause) is true.
    Reinit {
        /// The state.
        state: VarId,
        /// Its new value.
        value: ExprId,
        /// Extra condition, if any.
        guard: Option<ExprId>,
    },
    /// `assert(...)`
    Assert(Assert),
    /// `terminate(message)`, only if `guard` is true.
    Terminate {
        /// The reason.
        message: ExprId,
        /// Extra condition, if any.
        guard: Option<ExprId>,
    },
}

/// A variable with an equation of its own that is never differentiated, as another equation determines the derivative.
#[derive(Clone, Copy, Debug)]
pub struct GivenDerivative {
    /// The variable, which `flatten` adds.
    pub variable: VarId,
    /// Its derivative, which is another one of these; the highest derivative that is given has none.
    pub derivative: Option<VarId>,
}

/// `delay(variable, time)`, read as a recorded signal of the variable.
#[derive(Clone, Copy, Debug)]
pub struct Delay {
    /// The delayed variable, which `flatten` adds.
    pub variable: VarId,
    /// By how much, s: a parameter expression.
    pub time: ExprId,
    /// Place of the call.
    pub span: Span,
}

/// A transport line: a profile that moves along a coordinate. `Unary::Carried` reads it.
#[derive(Clone, Debug)]
pub struct Transport {
    /// Coordinates of the low and of the high end of the readable part. `flatten` adds these variables, and
    /// all others here.
    pub ends: [VarId; 2],
    /// The value that enters where an end moves outwards, if any.
    pub entering: [Option<VarId>; 2],
    /// The initial profile, if any: coordinates from the low end in ascending order, and values; parameter
    /// expressions.
    pub initial: Vec<(ExprId, ExprId)>,
    /// If the coordinate is time, the longest delay.
    pub longest: Option<ExprId>,
    /// The reads: of a `spatialDistribution` at the low end and at the high end.
    pub readers: Vec<TransportReader>,
    /// Place of the call.
    pub span: Span,
}

/// A read of a transport line.
#[derive(Clone, Copy, Debug)]
pub struct TransportReader {
    /// The place that it reads.
    pub place: VarId,
    /// Coordinate at which the smooth piece around the read begins: a recorded signal that the simulation
    /// sets.
    pub from: VarId,
    /// Where it ends.
    pub to: VarId,
    /// True when the read reaches the end of its piece: triggers the event.
    pub arrives: VarId,
}

impl FlatModel {
    /// An empty model.
    pub fn new(name: impl Into<String>, span: Span) -> Self {
        FlatModel {
            name: name.into(),
            description: None,
            span,
            graph: Graph::new(),
            variables: IndexVec::new(),
            equations: Vec::new(),
            initial_equations: Vec::new(),
            functions: IndexVec::new(),
            experiment: Experiment::default(),
            unitless_literals: FastSet::default(),
            argument_units: Vec::new(),
            recorded: Vec::new(),
            synthetic: Vec::new(),
            delays: Vec::new(),
            given_derivatives: Vec::new(),
            transports: Vec::new(),
            ownership: Ownership::default(),
            initial_states: Vec::new(),
            transitions: Vec::new(),
            inner_outer: Vec::new(),
        }
    }

    /// The expression that reads `v`.
    pub fn read(&mut self, v: VarId) -> ExprId {
        let ty = self.variables[v].ty;
        self.graph.var(v, ty)
    }
}
