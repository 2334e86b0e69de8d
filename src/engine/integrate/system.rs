//! The system to integrate.

use crate::numeric::pattern::Pattern;

/// A semi-explicit system `M y' = f(t, y)` whose `M` is diagonal with entries one and zero.
///
/// A row with entry zero is an algebraic equation `0 = f_i(t, y)`. With such rows the system must
/// have index 1: the Jacobian of the algebraic rows with respect to the algebraic components is
/// regular. Both functions may use internal memory; for equal arguments they must give equal bits.
pub trait System {
    /// Number of components of `y`.
    fn dim(&self) -> usize;

    /// The diagonal of `M`, length `dim`: true where the row is a differential equation.
    fn differential(&self) -> &[bool];

    /// Writes `f(t, y)` to all entries of `f`. Slices have length `dim`.
    fn rhs(&mut self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError>;

    /// Writes the nonzero `df_i/dy_j (t, y)` to `j[i + dim * j]`; `j` arrives filled with zeros.
    fn jacobian(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError>;

    /// Which entries of the Jacobian can be nonzero; `None` if not provided.
    fn pattern(&self) -> Option<&Pattern> {
        None
    }

    /// True if the Jacobian has entries outside of the pattern at present, which `jacobian` writes.
    fn leaves_pattern(&self) -> bool {
        false
    }

    /// Writes `df_i/dy_j (t, y)` for all entries `(i, j)` of `pattern`, in its order. Called only
    /// for systems that provide a pattern.
    fn jacobian_entries(&mut self, t: f64, y: &[f64], values: &mut [f64]) -> Result<(), EvalError> {
        let _ = (t, y, values);
        Err(EvalError::Fatal(u32::MAX))
    }
}

/// A right side or Jacobian that could not be evaluated. The code is defined by the system and
/// returned unchanged in the failure if no smaller step helps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum EvalError {
    /// Outside the domain here (the root of a negative number, an inner iteration that does not
    /// converge): a shorter step may stay inside.
    Recoverable(u32),
    /// No step can help: the integration ends.
    Fatal(u32),
}
