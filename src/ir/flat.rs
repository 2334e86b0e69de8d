//! The flat model: scalar variables and scalar equations, as chapter 5.6 of the Modelica
//! specification describes them.
//!
//! *Holds:* every scalar variable with evaluated structure (dimensions, conditions, `if` on structural
//! parameters), equations of connections written out, functions inlined or listed, every equation
//! with the place in the text that it comes from. `der`, `pre`, relations still stand in expressions.
//! *Never holds:* arrays, records, `connect`, `for`, classes, modifications.
//! *Made by:* `flatten`. *Read by:* `lower`, and printed as flat Modelica by `flatten::print`.

use std::sync::Arc;

use super::expr::{ExprId, FunctionId, Graph, Type, VarId};
use crate::base::index::{FastSet, IndexVec};
use crate::base::name::Name;
use crate::base::source::Span;

pub use super::ast::{Causality, Variability};

/// A flat model.
#[derive(Clone)]
pub struct FlatModel {
    /// Name of the class that was flattened.
    pub name: String,
    /// Its description string.
    pub description: Option<Arc<str>>,
    /// Where its name stands.
    pub span: Span,
    /// All expressions.
    pub graph: Graph,
    /// Variables in order of declaration, depth first.
    pub variables: IndexVec<VarId, Variable>,
    /// `equation` sections, bindings of non-parameters excluded (they stay with the variable).
    pub equations: Vec<Equation>,
    /// `initial equation` sections.
    pub initial_equations: Vec<Equation>,
    /// Functions that could not be inlined.
    pub functions: IndexVec<FunctionId, Function>,
    /// `annotation(experiment(...))`.
    pub experiment: Experiment,
    /// Places of equations and declarations in which constants with units stand as numbers.
    pub unitless_literals: FastSet<Span>,
    /// Inputs without a value that recordings give one, moving with time.
    pub recorded: Vec<VarId>,
    /// Variables that `flatten` made for its own purposes.
    pub synthetic: Vec<VarId>,
    /// Delayed expressions.
    pub delays: Vec<Delay>,
    /// Lines along which something is carried.
    pub transports: Vec<Transport>,
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
    /// Place in the text.
    pub span: Span,
    /// Dotted name of the component whose class holds it; empty for the model itself.
    pub component: Arc<str>,
}

/// An equation.
#[derive(Clone, Debug)]
pub struct Equation {
    /// What it says.
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
    /// `terminate(message)` outside a when-clause is not allowed, so it stands in [`Action`] only;
    /// an algorithm section: `outputs[i] := values[i]` for all i at once.
    Algorithm {
        /// The variables that the section assigns.
        outputs: Vec<VarId>,
        /// What each holds after the section, in terms of other variables (and of `pre(v)` or the
        /// start value where a variable is read before it is assigned).
        values: Vec<ExprId>,
    },
}

/// One branch of a when-clause.
#[derive(Clone, Debug)]
pub struct WhenBranch {
    /// The scalar conditions; a vector condition `{a, b}` has several: any edge activates.
    pub conditions: Vec<ExprId>,
    /// What happens, in order.
    pub actions: Vec<Action>,
}

/// What a when-clause does.
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
    /// `terminate(message)`
    Terminate(ExprId),
}

/// `assert(condition, message, level)`
#[derive(Clone, Debug)]
pub struct Assert {
    /// Must be true.
    pub condition: ExprId,
    /// A `String` expression.
    pub message: ExprId,
    /// What happens where it is not.
    pub level: AssertionLevel,
}

/// What happens where an assertion is violated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AssertionLevel {
    /// The run fails.
    Error,
    /// The run goes on with a warning.
    Warning,
    /// The message is a line for this file, for the terminal if it has no name: `Streams.print`.
    Print(Name),
}

/// `delay(variable, time)`, read as what is recorded of the variable.
#[derive(Clone, Copy, Debug)]
pub struct Delay {
    /// What is delayed; made by `flatten` for this purpose.
    pub variable: VarId,
    /// By how much, s: a parameter expression.
    pub time: ExprId,
    /// Place of the call.
    pub span: Span,
}

/// A line along which something is carried, and keeps its place on it: `Unary::Carried` reads it.
#[derive(Clone, Debug)]
pub struct Transport {
    /// Places of the low and of the high end of what can be read; made by `flatten` for this purpose, as
    /// all variables here.
    pub ends: [VarId; 2],
    /// What enters where an end moves outwards, if anything does.
    pub entering: [Option<VarId>; 2],
    /// What is on the line in the beginning, if anything is: places from the low end on in ascending
    /// order, and values; parameter expressions.
    pub initial: Vec<(ExprId, ExprId)>,
    /// Where time is the line, how far what is read lies back at most.
    pub longest: Option<ExprId>,
    /// Those who read: of a `spatialDistribution` the low end and the high end.
    pub readers: Vec<TransportReader>,
    /// Place of the call.
    pub span: Span,
}

/// A reader of what is carried along a line.
#[derive(Clone, Copy, Debug)]
pub struct TransportReader {
    /// The place that it reads.
    pub place: VarId,
    /// Where the smooth piece begins in which that is. Only the run knows: the 0th derivative of what is
    /// recorded of it.
    pub from: VarId,
    /// Where it ends.
    pub to: VarId,
    /// It has come to the end of its piece: makes the event.
    pub arrives: VarId,
}

/// A function that is called at run time: loops whose length is known only then.
#[derive(Clone, Debug)]
pub struct Function {
    /// Full name.
    pub name: String,
    /// Place of its definition.
    pub span: Span,
    /// Scalar inputs.
    pub inputs: Vec<LocalId>,
    /// Scalar outputs.
    pub outputs: Vec<LocalId>,
    /// Names of all scalar locals, inputs and outputs included.
    pub locals: IndexVec<LocalId, String>,
    /// The body; expressions read locals as `Node::Var(VarId(local))`.
    pub body: Vec<Statement>,
}

impl Function {
    /// The expressions of the statements, but for messages.
    pub fn values(&self) -> Vec<ExprId> {
        let mut out = Vec::new();
        values_of(&self.body, &mut out);
        out
    }
}

fn values_of(body: &[Statement], out: &mut Vec<ExprId>) {
    for statement in body {
        match statement {
            Statement::Assign(_, value) => out.push(*value),
            Statement::If(c, a, b) => {
                out.push(*c);
                values_of(a, out);
                values_of(b, out);
            }
            Statement::While(c, a) => {
                out.push(*c);
                values_of(a, out);
            }
            Statement::Assert(a, _) => out.push(a.condition),
            Statement::Break | Statement::Return => {}
        }
    }
}

crate::define_id! {
    /// A scalar local of a [`Function`].
    pub struct LocalId
}

/// A statement of a [`Function`].
#[derive(Clone, Debug)]
pub enum Statement {
    /// `local := value`
    Assign(LocalId, ExprId),
    /// `if`
    If(ExprId, Vec<Statement>, Vec<Statement>),
    /// `while`
    While(ExprId, Vec<Statement>),
    /// `break`
    Break,
    /// `return`
    Return,
    /// `assert(...)`, and where it stands.
    Assert(Assert, Span),
}

impl FlatModel {
    /// Calls `visit` with every expression of the model but those of its functions.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        for v in self.variables.iter() {
            let attributes = [v.binding, v.start, v.min, v.max, v.nominal];
            attributes.into_iter().flatten().for_each(&mut *visit);
        }
        let assert = |a: &Assert, visit: &mut dyn FnMut(ExprId)| {
            [a.condition, a.message].into_iter().for_each(visit);
        };
        for e in self.equations.iter().chain(&self.initial_equations) {
            match &e.kind {
                EquationKind::Equal(a, b) => [*a, *b].into_iter().for_each(&mut *visit),
                EquationKind::Algorithm { values, .. } => {
                    values.iter().copied().for_each(&mut *visit);
                }
                EquationKind::Assert(a) => assert(a, visit),
                EquationKind::When(branches) => {
                    for branch in branches {
                        branch.conditions.iter().copied().for_each(&mut *visit);
                        for action in &branch.actions {
                            match action {
                                Action::Assign(_, e) | Action::Terminate(e) => visit(*e),
                                Action::Reinit { value, guard, .. } => {
                                    visit(*value);
                                    guard.iter().copied().for_each(&mut *visit);
                                }
                                Action::Assert(a) => assert(a, visit),
                            }
                        }
                    }
                }
            }
        }
        self.delays.iter().for_each(|d| visit(d.time));
        for line in &self.transports {
            line.initial.iter().flat_map(|(p, v)| [*p, *v]).for_each(&mut *visit);
            line.longest.iter().copied().for_each(&mut *visit);
        }
    }

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
            recorded: Vec::new(),
            synthetic: Vec::new(),
            delays: Vec::new(),
            transports: Vec::new(),
        }
    }

    /// The expression that reads `v`.
    pub fn read(&mut self, v: VarId) -> ExprId {
        let ty = self.variables[v].ty;
        self.graph.var(v, ty)
    }
}
