//! Functions given by points: of one number ([`curve`]), of time with jumps ([`time_table`]), of two
//! numbers ([`surface`]).
//!
//! A table is made once and evaluated many times, with its derivatives.
pub mod time_table;
pub mod curve;
pub mod surface;

/// What happens beyond the points.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Extrapolation {
    /// The first or last value.
    Hold,
    /// A straight line with the slope at the end.
    Linear,
    /// The points repeat themselves.
    Periodic,
    /// Nothing: the caller sees to it that the argument stays inside. The function goes on as with
    /// [`Extrapolation::Hold`].
    Forbidden,
}

impl Extrapolation {
    /// By its number, counted from 1 in the order of declaration.
    pub fn numbered(number: u32) -> Option<Extrapolation> {
        use Extrapolation::*;
        [Hold, Linear, Periodic, Forbidden].get(number.checked_sub(1)? as usize).copied()
    }
}

/// The position of the interval `x[i] <= u < x[i + 1]`, the first or last one for what is beyond.
fn interval(x: &[f64], u: f64) -> usize {
    let after = x.partition_point(|point| *point <= u);
    after.saturating_sub(1).min(x.len().saturating_sub(2))
}
