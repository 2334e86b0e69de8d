//! Every way out of a step.

use crate::integrate::options::OptionError;
use crate::integrate::system::EvalError;

/// A step that succeeded.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Step {
    /// The solution advanced to `t`, before the stop.
    Advanced {
        /// Time now.
        t: f64,
    },
    /// The solution is at the stop: `t` has the bits of the `t_stop` given, or was beyond it already.
    Reached {
        /// Time now.
        t: f64,
    },
}

/// An integration that can not go on from the point where the stepper stands. `component` is the
/// index in `y` that troubles most, so that the caller can name the variable.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum Failure {
    /// An option is out of its range.
    #[error(transparent)]
    Options(#[from] OptionError),
    /// The start vector has another length than the system, or a value that is not finite.
    #[error("the start value of component {component} is missing or not finite")]
    Start {
        /// First component without a usable value.
        component: usize,
    },
    /// The error test fails down to the shortest step: most often a jump or a pole of the solution.
    #[error("at t = {t} the step {h:e} is too small; component {component} has the largest error")]
    StepTooSmall {
        /// Time before the failed step.
        t: f64,
        /// The step that would have been next.
        h: f64,
        /// Component with the largest weighted error.
        component: usize,
    },
    /// The stage equations have no solution near the start down to the shortest step.
    #[error(
        "at t = {t} the stage equations do not converge with step {h:e}; \
         component {component} changes most"
    )]
    NewtonFailed {
        /// Time before the failed step.
        t: f64,
        /// The step that would have been next.
        h: f64,
        /// Component with the largest weighted correction.
        component: usize,
    },
    /// The matrix of the stage equations is singular for every step tried: the algebraic rows do not
    /// determine the algebraic components.
    #[error("at t = {t} the iteration matrix is singular at component {component}")]
    Singular {
        /// Time before the failed step.
        t: f64,
        /// Component of the column without pivot.
        component: usize,
    },
    /// The right side or the Jacobian gives infinity or not-a-number for every step tried.
    #[error("at t = {t} component {component} is not finite")]
    NonFinite {
        /// Time before the failed step.
        t: f64,
        /// First component that is not finite.
        component: usize,
    },
    /// The system could not be evaluated: fatally, or recoverably for every step tried.
    #[error("at t = {t} the system could not be evaluated")]
    Eval {
        /// Time before the failed step.
        t: f64,
        /// What the system said.
        error: EvalError,
    },
    /// The limit of `Options::max_steps`.
    #[error("at t = {t} the limit of {steps} steps is exhausted")]
    TooManySteps {
        /// Time now.
        t: f64,
        /// The limit.
        steps: u64,
    },
}
