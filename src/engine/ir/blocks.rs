//! The sorted system: the order in which variables are solved, and from which equations.
//!
//! *Holds:* the [`Dae`] with differentiated equations, the selected states, and three sequences of
//! blocks: initialisation, events, and continuous phases.
//! *Never holds:* a sequence that solves an unknown twice, or reads it before it is solved.
//! *Made by:* `structure`. *Read by:* `codegen`, `driver` (`mocc structure`).

use super::dae::{Dae, EqId};
use super::expr::{ExprId, VarId};

/// The sorted system.
#[derive(Clone)]
pub struct Blocks {
    /// The system, with differentiated equations and derivative variables appended.
    pub dae: Dae,
    /// Selected states with their derivatives, in order of declaration.
    pub states: Vec<State>,
    /// Differentiated variables that are never states: their derivatives are dummy derivatives.
    pub dummies: Vec<VarId>,
    /// States that are selected during the simulation.
    pub state_sets: Vec<StateSet>,
    /// Determines every variable at the start: states (fixed or not), derivatives, algebraic,
    /// discrete variables and parameters with `fixed = false`.
    pub initial: Vec<Block>,
    /// The same with loops torn at states where they can be, for starts from which `initial` does not converge: the
    /// start values of states are better known than those of other variables. Empty if it would be the same.
    pub initial_by_states: Vec<Block>,
    /// At an event: derivatives, algebraic and discrete variables from states, `pre` values and time.
    pub event: Vec<Block>,
    /// Between events: derivatives and algebraic variables from states, discrete variables and time.
    pub continuous: Vec<Block>,
    /// Starts that initialisation had to choose because the model leaves them open.
    pub assumed_starts: Vec<VarId>,
    /// Unknowns that their equations do not determine, and that nothing else depends on.
    pub undetermined: Vec<VarId>,
}

/// A selected state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct State {
    /// The state.
    pub variable: VarId,
    /// Its derivative.
    pub derivative: VarId,
}

/// Variables among which the states are chosen while the model runs: `states = selection *
/// candidates`, where each row of `selection` has a single one. The other candidates follow from
/// the constraints, as long as their derivatives by it stay regular.
///
/// S. E. Mattsson, H. Olsson, H. Elmqvist, "Dynamic Selection of States in Dymola", Modelica
/// Workshop 2000.
#[derive(Clone, Debug)]
pub struct StateSet {
    /// The candidates for states.
    pub candidates: Vec<VarId>,
    /// Positions of the candidates that are not states if the constraints can be solved for them at
    /// the start.
    pub dependent: Vec<usize>,
    /// The weights of the candidates, from `stateSelect`, relative to their nominal values.
    pub wishes: Vec<f64>,
    /// The states, as variables of their own: as many as candidates less constraints.
    pub states: Vec<VarId>,
    /// The coefficients, state by state, `candidates.len()` each. Held between selections.
    pub selection: Vec<VarId>,
    /// The constraints.
    pub constraints: Vec<EqId>,
    /// Derivatives of the constraints by the candidates: constraint, candidate, value.
    pub jacobian: Vec<(usize, usize, ExprId)>,
}

/// Which equation a block comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Source {
    /// `dae.equations[i]`
    Continuous(EqId),
    /// `dae.discrete[i]`
    Discrete(usize),
    /// `dae.initial[i]`
    Initial(usize),
    /// `variable = start`, from `fixed = true` or assumed.
    Start(VarId),
}

/// A step of a sequence.
#[derive(Clone, Debug)]
pub enum Block {
    /// `variable := value`
    Assign(Assignment),
    /// Equations to be solved together.
    Torn(Torn),
    /// Discrete and continuous equations that depend on each other: the parts are repeated in order
    /// until no discrete variable changes any more.
    Mixed(Vec<Block>),
}

/// `variable := value`
#[derive(Clone, Copy, Debug)]
pub struct Assignment {
    /// The unknown.
    pub variable: VarId,
    /// Reads only variables that are solved before.
    pub value: ExprId,
    /// Where it comes from.
    pub source: Source,
}

/// Simultaneous equations, torn: given the tearing variables, `explicit` follows in order, and the
/// residuals must vanish.
#[derive(Clone, Debug)]
pub struct Torn {
    /// Tearing variables.
    pub unknowns: Vec<VarId>,
    /// Assignments in order.
    pub explicit: Vec<Assignment>,
    /// As many as tearing variables.
    pub residuals: Vec<Residual>,
    /// The residuals, after the explicit part is put in, are linear in the tearing variables.
    pub linear: bool,
}

/// `value = 0`
#[derive(Clone, Copy, Debug)]
pub struct Residual {
    /// Must vanish.
    pub value: ExprId,
    /// Where it comes from.
    pub source: Source,
}
