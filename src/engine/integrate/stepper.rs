//! The interface of all integration methods.

use crate::integrate::outcome::{Failure, Step};
use crate::integrate::stats::Stats;
use crate::integrate::system::System;

/// A one-step or multistep method, positioned at an accepted point.
///
/// Usage: `restart`, then `step` until it returns `Reached`; `interpolate` within the last step.
/// After a failure the stepper remains at the last accepted point. Nothing allocates after
/// construction, and equal inputs give equal bits.
pub trait Stepper {
    /// Moves to `(t, y)` and discards the history: at the start and after every discontinuity.
    ///
    /// Algebraic components must satisfy their equations. With [`JacobianMemory::Keep`] the last
    /// Jacobian is used until the iteration converges slowly.
    fn restart(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
        jacobian: JacobianMemory,
    ) -> Result<(), Failure>;

    /// Advances by one accepted step that does not pass `t_stop`; the last one ends at exactly
    /// `t_stop`. Without effect if `t_stop` is not after `t()`.
    fn step(&mut self, system: &mut dyn System, t_stop: f64) -> Result<Step, Failure>;

    /// Repeats the last step so that it ends at `t` in `(t_previous(), t())`, with the accuracy of
    /// a step end rather than that of the interpolation: for the state at an event within the step.
    ///
    /// Without effect for other `t`, or if `step` has failed since. After a failure the stepper is
    /// at `t_previous()`, and `interpolate` still covers the whole last step.
    fn shorten(&mut self, system: &mut dyn System, t: f64) -> Result<(), Failure>;

    /// Says that a derivative of the right side jumps at the accepted point: the solution and its slope are continuous
    /// there, its curvature is not, so an interpolation in the next step must not rely on the step before.
    fn pass_kink(&mut self) {}

    /// Time of the accepted point.
    fn t(&self) -> f64;

    /// The accepted point.
    fn y(&self) -> &[f64];

    /// Start of the last step; equals `t()` after a restart.
    fn t_previous(&self) -> f64;

    /// Writes the solution at `t` in `[t_previous(), t()]` to `out`. Between the ends the error is
    /// of the size of the tolerances, for stiff components up to about ten times that.
    fn interpolate(&self, t: f64, out: &mut [f64]);

    /// The next step size if no stop interferes.
    fn next_step(&self) -> f64;

    /// Work done so far.
    fn stats(&self) -> &Stats;
}

/// Treatment of the Jacobian in a restart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum JacobianMemory {
    /// The equations have changed: evaluate it again.
    Forget,
    /// The equations are the same and the point has changed little.
    Keep,
}
