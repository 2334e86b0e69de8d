//! Time series: a quantity recorded at discrete instants and interpolated between them.

use std::sync::Arc;

use crate::base::wire::{wire_enum, wire_struct};

use super::hermite::{Smoothness, hermite, polynomial, slopes, spline_slopes};

/// How values between two instants are interpolated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Interpolation {
    /// The value at the previous instant, like a digital output.
    Hold,
    /// A straight line.
    Linear,
    /// A cubic without overshoot, with a continuous slope.
    Monotone,
    /// A cubic with continuous slope and curvature: closest to a band-limited signal.
    Spline,
}

impl Interpolation {
    /// All variants with their names in plan files.
    pub const ALL: [(&'static str, Interpolation); 4] = [
        ("hold", Interpolation::Hold),
        ("linear", Interpolation::Linear),
        ("monotone", Interpolation::Monotone),
        ("spline", Interpolation::Spline),
    ];
}

/// Values at increasing instants with an interpolation; beyond the ends the nearest value holds.
#[derive(Clone, PartialEq, Debug)]
pub struct TimeSeries {
    times: Arc<[f64]>,
    values: Vec<f64>,
    /// The slope at each instant, for cubics; empty otherwise.
    slopes: Vec<f64>,
    interpolation: Interpolation,
    spacing: f64,
}

wire_enum!(Interpolation { Hold = 0, Linear = 1, Monotone = 2, Spline = 3 });
wire_struct!(TimeSeries { times, values, slopes, interpolation, spacing });

impl TimeSeries {
    /// Interpolates `values` at increasing `times`; at least one of each, all finite.
    pub fn new(times: Arc<[f64]>, values: Vec<f64>, interpolation: Interpolation) -> Self {
        debug_assert!(times.len() == values.len() && !values.is_empty());
        let (times, values) = match interpolation {
            Interpolation::Hold => jumps(&times, &values),
            _ => (times, values),
        };
        let slopes = match interpolation {
            Interpolation::Hold | Interpolation::Linear => Vec::new(),
            Interpolation::Monotone => slopes(Smoothness::FritschButland, &times, &values, false),
            Interpolation::Spline => spline_slopes(&times, &values),
        };
        let mut steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        let spacing = steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY);
        TimeSeries { times, values, slopes, interpolation, spacing }
    }

    /// The interpolation between two instants.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The same instants with other values, each of which is held until the next.
    pub fn held(&self, value: impl Fn(f64) -> f64) -> Self {
        let values = self.values.iter().map(|x| value(*x)).collect();
        TimeSeries::new(Arc::clone(&self.times), values, Interpolation::Hold)
    }

    /// The median time between two instants.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The interval that contains `t`: 0 before the first instant, `k` from instant `k - 1` on. The
    /// search starts at `near`, the result of the previous one.
    #[inline]
    pub fn interval(&self, t: f64, near: usize) -> usize {
        let begins = |k: usize| k == 0 || self.times[k - 1] <= t;
        let ends = |k: usize| k == self.times.len() || t < self.times[k];
        for k in [near, near + 1] {
            if k <= self.times.len() && begins(k) && ends(k) {
                return k;
            }
        }
        self.times.partition_point(|at| *at <= t)
    }

    /// The end of an interval; infinity for the last.
    pub fn end_of(&self, interval: usize) -> f64 {
        self.times.get(interval).copied().unwrap_or(f64::INFINITY)
    }

    /// The derivative of this order at `t` by the formula of an interval; the value for order 0.
    #[inline]
    pub fn at(&self, t: f64, interval: usize, order: u8) -> f64 {
        let last = self.times.len() - 1;
        // At the last instant itself a slope is that before it: nothing was recorded of a corner there.
        let is_last = interval > last && order > 0 && last > 0 && t == self.times[last];
        let interval = if is_last { last } else { interval };
        if interval == 0 || interval > last {
            let end = if interval == 0 { 0 } else { last };
            return if order == 0 { self.values[end] } else { 0.0 };
        }
        let (t0, t1) = (self.times[interval - 1], self.times[interval]);
        let (y0, y1) = (self.values[interval - 1], self.values[interval]);
        let h = t1 - t0;
        let cubic = match self.interpolation {
            Interpolation::Hold => [y0, 0.0, 0.0, 0.0],
            Interpolation::Linear => [y0, (y1 - y0) / h, 0.0, 0.0],
            Interpolation::Monotone | Interpolation::Spline => {
                hermite(h, y0, y1, self.slopes[interval - 1], self.slopes[interval])
            }
        };
        polynomial(&cubic, t - t0, order)
    }

    /// The derivative of this order at `t`, in whichever interval that lies.
    pub fn value(&self, t: f64, order: u8) -> f64 {
        self.at(t, self.interval(t, 0), order)
    }
}

/// The instants at which a held value changes, and the first and last one.
fn jumps(times: &Arc<[f64]>, values: &[f64]) -> (Arc<[f64]>, Vec<f64>) {
    let last = values.len() - 1;
    let jump = |k: &usize| *k == 0 || *k == last || values[*k] != values[*k - 1];
    let kept: Vec<usize> = (0..values.len()).filter(jump).collect();
    (kept.iter().map(|k| times[*k]).collect(), kept.iter().map(|k| values[*k]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(n: usize) -> Arc<[f64]> {
        (0..n).map(|k| 0.1 * k as f64 + 0.01 * ((k * k) % 3) as f64).collect()
    }

    fn series(interpolation: Interpolation, f: impl Fn(f64) -> f64) -> TimeSeries {
        let times = times(40);
        let values = times.iter().map(|t| f(*t)).collect();
        TimeSeries::new(times, values, interpolation)
    }

    #[test]
    fn each_interpolation_passes_through_the_samples() {
        for (name, interpolation) in Interpolation::ALL {
            let c = series(interpolation, f64::sin);
            for t in times(40).iter().take(39) {
                assert!((c.value(*t, 0) - t.sin()).abs() < 1e-14, "{name}");
            }
            assert_eq!((c.value(-1.0, 0), c.value(-1.0, 1)), (0.0, 0.0));
            // At the last instant the slope is that before it, and afterwards zero.
            let last = times(40)[39];
            let expected = if interpolation == Interpolation::Hold { 0.0 } else { last.cos() };
            assert!((c.value(last, 1) - expected).abs() < 0.1, "{name}: {}", c.value(last, 1));
            assert_eq!(c.value(last + 1e-9, 1), 0.0);
        }
    }

    #[test]
    fn a_line_is_reproduced() {
        for interpolation in [Interpolation::Linear, Interpolation::Monotone, Interpolation::Spline]
        {
            let c = series(interpolation, |t| 2.0 - 3.0 * t);
            for k in 0..300 {
                let t = 0.012 * k as f64;
                assert!((c.value(t, 0) - (2.0 - 3.0 * t)).abs() < 1e-12);
                assert!((c.value(t, 1) + 3.0).abs() < 1e-11);
            }
        }
    }

    /// The error of a cubic spline is of order h^4 away from its ends.
    #[test]
    fn a_spline_is_close_to_a_smooth_signal() {
        let c = series(Interpolation::Spline, f64::sin);
        for k in 100..250 {
            let t = 0.012 * k as f64;
            assert!((c.value(t, 0) - t.sin()).abs() < 2e-6);
            assert!((c.value(t, 1) - t.cos()).abs() < 1e-4);
        }
    }

    #[test]
    fn a_monotone_cubic_does_not_overshoot() {
        let c = series(Interpolation::Monotone, |t| f64::from(t > 2.0));
        assert!((0..400).map(|k| c.value(0.01 * k as f64, 0)).all(|y| (0.0..=1.0).contains(&y)));
    }

    #[test]
    fn a_step_is_held() {
        let c =
            TimeSeries::new(Arc::new([0.0, 1.0, 2.0]), vec![5.0, 6.0, 7.0], Interpolation::Hold);
        assert_eq!([0.0, 0.99, 1.0, 1.5, 2.5].map(|t| c.value(t, 0)), [5.0, 5.0, 6.0, 6.0, 7.0]);
        assert_eq!((c.end_of(0), c.end_of(1), c.end_of(3)), (0.0, 1.0, f64::INFINITY));
    }

    #[test]
    fn the_interval_is_found_from_anywhere() {
        let c = series(Interpolation::Linear, f64::sin);
        for near in 0..41 {
            assert_eq!(c.interval(1.234, near), c.interval(1.234, 0));
        }
    }
}
