//! How a solution varies with something that it depends on.

use crate::integrate::system::EvalError;

/// The equations `M s' = J(t) s + b(t)` that hold along a solution `y` of `M y' = f(t, y, p)` for its
/// derivatives `s = dy/dp`, one `b = df/dp` for each direction `p`, with `J = df/dy`.
///
/// A step of a method looks at them at several points at once: its stages.
pub trait Variational {
    /// Evaluates `J` and all `b` at the point `(t, y)` of the solution, and keeps them for `stage`.
    fn linearise(&mut self, stage: usize, t: f64, y: &[f64]) -> Result<(), EvalError>;

    /// Writes `J s + b` of one direction at a stage to `out`. Slices have the length of `y`.
    fn slope(&self, stage: usize, direction: usize, s: &[f64], out: &mut [f64]);
}
