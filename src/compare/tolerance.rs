//! How far two runs may differ.

/// The least part of a variable's magnitude that counts as its extent: below it, values are rounding errors.
const LEAST_EXTENT: f64 = 1e-3;
/// The absolute tolerance where nothing else is given: what is smaller in SI units is mostly rounding.
pub const ABSOLUTE: f64 = 1e-12;
/// Time by which events may move, as a part of the simulated time, where nothing else is given.
const TIME: f64 = 1e-4;

/// The tolerances of a comparison.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Tolerance {
    /// Relative to the extent of the variable: its largest value minus its smallest.
    pub relative: f64,
    /// Added to that, in the unit of the variable.
    pub absolute: f64,
    /// Time by which changes may come earlier or later, s; without it a part of the simulated time.
    pub time: Option<f64>,
}

impl Default for Tolerance {
    fn default() -> Self {
        Tolerance { relative: 1e-3, absolute: ABSOLUTE, time: None }
    }
}

impl Tolerance {
    /// Half the width of the tube around the values of a reference.
    pub fn width(&self, reference: &[f64]) -> f64 {
        self.absolute + self.relative * extent(reference)
    }

    /// Time by which changes may come earlier or later in a run with these times, s.
    pub fn shift(&self, time: &[f64]) -> f64 {
        let length = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first);
        self.time.unwrap_or(TIME * length)
    }
}

/// The difference of the largest and the smallest value; a small part of the magnitude where these are nearly equal.
pub fn extent(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if low > high {
        return 0.0;
    }
    (high - low).max(LEAST_EXTENT * high.abs().max(low.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tube_is_as_wide_as_the_tolerances_say() {
        let t = Tolerance { relative: 0.01, absolute: 0.5, time: None };
        // Extent 4: 0.01 * 4 + 0.5.
        assert_eq!(t.width(&[-1.0, 3.0, 0.0]), 0.54);
        // A constant of 293.15 has the extent 0.29315.
        assert!((t.width(&[293.15; 3]) - 0.502_931_5).abs() < 1e-15);
        assert_eq!(Tolerance::default().width(&[0.0, 0.0]), 1e-12);
        assert_eq!(t.shift(&[0.0, 0.5, 2.0]), 2e-4);
        assert_eq!(Tolerance { time: Some(0.1), ..t }.shift(&[0.0, 2.0]), 0.1);
    }
}
