//! The hybrid differential-algebraic system of appendix B of the Modelica specification.
//!
//! *Holds:* variables by kind; continuous equations `residual = 0`; discrete equations `v := value`;
//! relations collected and numbered, each read as [`Node::Relation`](super::expr::Node::Relation);
//! when-clauses turned into discrete equations, reinits and their activation; alias variables
//! eliminated but remembered. Derivatives are variables of their own.
//! *Never holds:* `der()`, `sample()`, `homotopy()`, `edge`, when-clauses, relations between continuous
//! operands outside the list (those under `noEvent` excepted), `connect`.
//! *Made by:* `lower`. *Read by:* `structure`, which appends differentiated equations.

use std::sync::Arc;

use super::expr::{Binary, ExprId, FunctionId, Graph, Type, VarId};
use super::flat::{Assert, Experiment, Function, Origin, Ownership, StateSelect, Transport};
use crate::base::index::{FastSet, IndexVec};
use crate::base::name::Name;
use crate::base::source::Span;

crate::define_id! {
    /// A continuous equation.
    pub struct EqId
}

/// The system.
#[derive(Clone)]
pub struct Dae {
    /// Name of the model.
    pub name: String,
    /// All expressions.
    pub graph: Graph,
    /// All variables; ids of the flat model are kept, derivatives and event flags are appended.
    pub variables: IndexVec<VarId, Variable>,
    /// Parameters and constants with a value, in order of evaluation: each value reads only
    /// earlier ones. Parameters with `fixed = false` are absent: initialisation determines them.
    pub parameters: Vec<(VarId, ExprId)>,
    /// Continuous equations `residual = 0`.
    pub equations: IndexVec<EqId, Equation>,
    /// Equations of discrete variables, one each.
    pub discrete: Vec<DiscreteEquation>,
    /// Initial equations `residual = 0` (of any type: for Boolean and Integer, `lhs == rhs`).
    pub initial: Vec<Equation>,
    /// Relations that change only at events.
    pub relations: Vec<Relation>,
    /// `sample(start, interval)` clocks.
    pub samples: Vec<Sample>,
    /// `reinit`s, in order.
    pub reinits: Vec<Reinit>,
    /// Assertions outside when-clauses, and those inside with their activation.
    pub asserts: Vec<GuardedAssert>,
    /// `terminate`s.
    pub terminates: Vec<Terminate>,
    /// Eliminated variables: `variable = value`, where `value` reads only variables that are kept.
    pub eliminated: Vec<(VarId, ExprId)>,
    /// Run-time functions.
    pub functions: IndexVec<FunctionId, Function>,
    /// Delayed expressions.
    pub delays: Vec<Delay>,
    /// Transport lines.
    pub transports: Vec<Transport>,
    /// The equations as they were before aliases were eliminated.
    pub stated: Stated,
    /// Defaults of the run.
    pub experiment: Experiment,
}

/// `delay(variable, time)`.
#[derive(Clone, Copy, Debug)]
pub struct Delay {
    /// The variable.
    pub variable: VarId,
    /// The delay, s.
    pub time: ExprId,
    /// The input that takes its values from recordings, if the variable equals one.
    pub input: Option<VarId>,
}

/// The equations of the flat model, for messages about singular systems: the equation that is wrong
/// may be one that alias elimination has consumed.
#[derive(Clone, Debug, Default)]
pub struct Stated {
    /// `lhs = rhs` in variables of the flat model, with `der`: equations, declarations, connections.
    pub equations: Vec<StatedEquation>,
    /// Variables that when-clauses determine.
    pub by_when: FastSet<VarId>,
    /// Which component must determine which variable.
    pub ownership: Ownership,
}

/// An equation of the flat model.
#[derive(Clone, Debug)]
pub struct StatedEquation {
    /// Left-hand side.
    pub lhs: ExprId,
    /// Right-hand side.
    pub rhs: ExprId,
    /// Its source.
    pub origin: Origin,
}

/// How the names of variables begin that hold a rounded value.
pub const ROUNDED: &str = "$whole";

/// The role of a variable for the solver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum VariableKind {
    /// A constant, or a parameter with a value.
    Parameter,
    /// A parameter with `fixed = false`, determined by initialisation.
    InitialParameter,
    /// Continuous, appears differentiated: `derivative` holds its rate.
    Differentiated {
        /// The variable that is `der(this)`.
        derivative: VarId,
    },
    /// Continuous, not differentiated. Derivative variables are of this kind or `Differentiated`.
    Algebraic,
    /// Changes at events only.
    Discrete,
    /// A top-level input without a value: held at its start value.
    Input,
    /// Replaced by an expression, see [`Dae::eliminated`].
    Eliminated,
}

/// A scalar variable.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Full dotted name; `der(x)` for derivatives; `$when1` and the like for event flags.
    pub name: String,
    /// Scalar type.
    pub ty: Type,
    /// Its role for the solver.
    pub kind: VariableKind,
    /// For a derivative, the variable that it is the derivative of.
    pub derivative_of: Option<VarId>,
    /// Start value; merged over aliases.
    pub start: Option<ExprId>,
    /// `fixed`; merged over aliases.
    pub fixed: Option<bool>,
    /// Bounds.
    pub min: Option<ExprId>,
    /// Bounds.
    pub max: Option<ExprId>,
    /// Typical size.
    pub nominal: Option<ExprId>,
    /// Wish of the modeller.
    pub state_select: StateSelect,
    /// SI unit, may be empty.
    pub unit: Name,
    /// For display, may be empty.
    pub display_unit: Name,
    /// The description string.
    pub description: Option<Arc<str>>,
    /// A parameter whose declared value is 0: it must not become a divisor.
    pub vanishes: bool,
    /// Made by the compiler: not written to results.
    pub hidden: bool,
    /// Declared `protected`.
    pub protected: bool,
    /// A constant, or a parameter whose value fixed the structure.
    pub structural: bool,
    /// Place of the declaration.
    pub span: Span,
}

impl Variable {
    /// True for an input that the surroundings of the model set.
    pub fn is_input(&self) -> bool {
        self.kind == VariableKind::Input
    }

    /// True for such an input of the model itself.
    pub fn is_open_input(&self) -> bool {
        self.is_input() && !self.name.contains(['.', '[']) && !self.hidden
    }

    /// A variable about which nothing more is known.
    pub fn new(name: impl Into<String>, ty: Type, kind: VariableKind, span: Span) -> Variable {
        Variable {
            name: name.into(),
            ty,
            kind,
            derivative_of: None,
            start: None,
            fixed: None,
            min: None,
            max: None,
            nominal: None,
            state_select: StateSelect::Default,
            unit: Name::from(""),
            display_unit: Name::from(""),
            description: None,
            vanishes: false,
            hidden: false,
            protected: false,
            structural: false,
            span,
        }
    }

    /// The variable `der(integral)`, where `of` is the id of `integral`.
    pub fn derivative(of: VarId, integral: &Variable, kind: VariableKind) -> Variable {
        let name = format!("der({})", integral.name);
        Variable {
            derivative_of: Some(of),
            protected: integral.protected,
            hidden: integral.hidden,
            ..Variable::new(name, integral.ty, kind, integral.span)
        }
    }
}

/// A continuous equation.
#[derive(Clone, Debug)]
pub struct Equation {
    /// Left side as written.
    pub lhs: ExprId,
    /// Right side as written.
    pub rhs: ExprId,
    /// `lhs - rhs`.
    pub residual: ExprId,
    /// Where it comes from.
    pub origin: Origin,
    /// The equation of which this is the derivative by time.
    pub derivative_of: Option<EqId>,
}

/// `variable := value`, evaluated at events. `value` may read `pre`, relations, `initial()` and
/// continuous variables. For a when-clause it is `if active then e else pre(variable)`.
#[derive(Clone, Debug)]
pub struct DiscreteEquation {
    /// Of kind `Discrete`.
    pub variable: VarId,
    /// Its value.
    pub value: ExprId,
    /// Where it comes from.
    pub origin: Origin,
}

/// `a OP b`, held between events.
#[derive(Clone, Debug)]
pub struct Relation {
    /// `<`, `<=`, `>`, `>=`.
    pub op: Binary,
    /// Left operand.
    pub lhs: ExprId,
    /// Right operand.
    pub rhs: ExprId,
    /// The kind of event that flips it.
    pub trigger: Trigger,
    /// Where it comes from.
    pub origin: Origin,
}

/// The event that flips a relation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Trigger {
    /// `lhs - rhs` passes zero.
    State,
    /// The relation is equivalent to comparing `time` with `instant`, which reads only parameters
    /// and discrete variables; the event is hit exactly.
    Time {
        /// When, s.
        instant: ExprId,
    },
    /// Reads discrete variables and parameters only: it needs no search, event iteration sees it.
    Discrete,
}

/// `sample(start, interval)`: true in the event iteration at `start + k * interval`.
#[derive(Clone, Debug)]
pub struct Sample {
    /// First instant, s; a parameter expression.
    pub start: ExprId,
    /// Period, s; a parameter expression.
    pub interval: ExprId,
    /// The Boolean variable that is true at the instants.
    pub flag: VarId,
}

/// `when active: reinit(state, value)`.
#[derive(Clone, Debug)]
pub struct Reinit {
    /// True in the event iteration in which it acts.
    pub active: ExprId,
    /// A differentiated variable.
    pub state: VarId,
    /// Its new value.
    pub value: ExprId,
    /// Where it comes from.
    pub origin: Origin,
}

/// An assertion, checked where `active` (always, if absent).
#[derive(Clone, Debug)]
pub struct GuardedAssert {
    /// Activation of its when-clause.
    pub active: Option<ExprId>,
    /// The assertion.
    pub assert: Assert,
    /// Where it comes from.
    pub origin: Origin,
}

/// `terminate(message)` in a when-clause.
#[derive(Clone, Debug)]
pub struct Terminate {
    /// Activation.
    pub active: ExprId,
    /// A `String` expression.
    pub message: ExprId,
    /// Where it comes from.
    pub origin: Origin,
}
