//! Outcomes of a step.

use crate::integrate::options::OptionError;
use crate::integrate::system::EvalError;

/// A step that succeeded.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Step {
    /// The solution advanced to `t`, before the stop.
    Advanced {
        /// Current time.
        t: f64,
    },
    /// The solution is at the stop: `t` has the bits of `t_stop`, or was already beyond it.
    Reached {
        /// Current time.
        t: f64,
    },
}

/// An integration that cannot continue from the current point. `component` is the index in `y` that
/// is most likely the cause, so that the caller can name the variable.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum Failure {
    /// An option is out of its range.
    #[error(transparent)]
    Options(#[from] OptionError),
    /// The start vector has a wrong length, or a value that is not finite.
    #[error("the start value of component {component} is missing or not finite")]
    Start {
        /// First component without a usable value.
        component: usize,
    },
    /// The error test fails down to the minimum step: usually a jump or a pole of the solution.
    #[error("at t = {t} the step {h:e} is too small; component {component} has the largest error")]
    StepTooSmall {
        /// Time before the failed step.
        t: f64,
        /// The next step that would have been tried.
        h: f64,
        /// Component with the largest weighted error.
        component: usize,
    },
    /// The stage equations have no solution near the start down to the minimum step.
    #[error(
        "at t = {t} the stage equations do not converge with step {h:e}; \
         component {component} changes most"
    )]
    NewtonFailed {
        /// Time before the failed step.
        t: f64,
        /// The next step that would have been tried.
        h: f64,
        /// Component with the largest weighted correction.
        component: usize,
    },
    /// The matrix of the stage equations is singular for every step tried: the algebraic rows do
    /// not determine the algebraic components.
    #[error("at t = {t} the iteration matrix is singular at component {component}")]
    Singular {
        /// Time before the failed step.
        t: f64,
        /// Component of the column without pivot.
        component: usize,
    },
    /// The right side or the Jacobian is infinite or NaN for every step tried.
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
        /// The error of the system.
        error: EvalError,
    },
    /// The limit of `Options::max_steps`.
    #[error("at t = {t} the limit of {steps} steps is exhausted")]
    TooManySteps {
        /// Current time.
        t: f64,
        /// The limit.
        steps: u64,
    },
}
