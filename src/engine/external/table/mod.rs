//! Interpolated tables: functions of one argument ([`curve`]), of time with jumps ([`time_table`]),
//! and of two arguments ([`surface`]).
//!
//! A table is created once and evaluated many times, with its derivatives.
pub mod time_table;
pub mod curve;
mod curve_text;
pub mod operator;
pub mod surface;

/// Extrapolation beyond the points.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Extrapolation {
    /// The first or last value.
    Hold,
    /// The tangent at the end.
    Linear,
    /// Periodic repetition.
    Periodic,
    /// Not allowed: the caller keeps the argument within the range. The function evaluates as with
    /// [`Extrapolation::Hold`].
    Forbidden,
}

impl Extrapolation {
    /// The variant with this number, counted from 1 in order of declaration.
    pub fn numbered(number: u32) -> Option<Extrapolation> {
        use Extrapolation::*;
        [Hold, Linear, Periodic, Forbidden].get(number.checked_sub(1)? as usize).copied()
    }
}

/// Position `i` of the interval `x[i] <= u < x[i + 1]`, clamped to the first or last one.
fn interval(x: &[f64], u: f64) -> usize {
    let after = x.partition_point(|point| *point <= u);
    after.saturating_sub(1).min(x.len().saturating_sub(2))
}

crate::base::wire::wire_enum!(Extrapolation { Hold = 0, Linear = 1, Periodic = 2, Forbidden = 3 });
