//! What every integration method offers to the simulation loop.

use crate::integrate::outcome::{Failure, Step};
use crate::integrate::stats::Stats;
use crate::integrate::system::System;

/// A one-step or multistep method that stands at an accepted point and can advance it.
///
/// Usage: `restart`, then `step` until it reports `Reached`; within the last step `interpolate`.
/// After a failure the stepper still stands at the last accepted point. Nothing allocates after
/// construction, and equal inputs give equal bits.
pub trait Stepper {
    /// Stands at `(t, y)` and forgets the history: at the start and after every discontinuity.
    ///
    /// Algebraic components must satisfy their equations. With [`JacobianMemory::Keep`] the last
    /// Jacobian serves on until it converges badly.
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

    /// Redoes the last step so that it ends at `t` in `(t_previous(), t())`, to the accuracy of the
    /// step's end rather than that of the interpolation: for the state at an event inside the step.
    ///
    /// Without effect for other `t`, or if `step` failed since. After a failure the stepper stands at
    /// `t_previous()`, and `interpolate` still serves the whole last step.
    fn shorten(&mut self, system: &mut dyn System, t: f64) -> Result<(), Failure>;

    /// Time of the accepted point.
    fn t(&self) -> f64;

    /// The accepted point.
    fn y(&self) -> &[f64];

    /// Where the last step began; equals `t()` after a restart.
    fn t_previous(&self) -> f64;

    /// Writes the solution at `t` in `[t_previous(), t()]` to `out`. Between the ends the error is of
    /// the size of the tolerances, for stiff components up to some ten times that.
    fn interpolate(&self, t: f64, out: &mut [f64]);

    /// The step the method would try next, if no stop interferes.
    fn next_step(&self) -> f64;

    /// Work done so far.
    fn stats(&self) -> &Stats;
}

/// What a restart does with the Jacobian of the last steps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum JacobianMemory {
    /// The equations changed: evaluate it anew.
    Forget,
    /// The same equations hold and the point moved little.
    Keep,
}
