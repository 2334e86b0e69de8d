//! The variational equations: derivatives of a solution with respect to inputs.

use crate::integrate::system::EvalError;

/// The equations `M s' = J(t) s + b(t)` for the derivatives `s = dy/dp` along a solution `y` of
/// `M y' = f(t, y, p)`, with `J = df/dy` and one `b = df/dp` for each direction `p`.
///
/// A step evaluates them at several points: its stages.
pub trait Variational {
    /// Evaluates `J` and all `b` at the point `(t, y)` of the solution, and stores them for
    /// `stage`.
    fn linearise(&mut self, stage: usize, t: f64, y: &[f64]) -> Result<(), EvalError>;

    /// Writes `J s + b` of all directions at a stage to `out`. Both are panels ([`crate::numeric::panel`]) with a row
    /// for each component of `y` and a column for each direction.
    fn slopes(&self, stage: usize, width: usize, s: &[f64], out: &mut [f64]);

    /// The entries of `J` at a stage, in the order of the pattern of the system; `None` if they are not at hand.
    fn jacobian(&self, stage: usize) -> Option<&[f64]> {
        let _ = stage;
        None
    }
}
