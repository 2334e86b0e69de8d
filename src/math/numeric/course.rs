//! The course of a quantity between the instants at which it was recorded.
//!
//! Sources: F. N. Fritsch, J. Butland, *A method for constructing local monotone piecewise cubic
//! interpolants*, SIAM J. Sci. Stat. Comput. 5, 1984 (slopes that do not overshoot); C. de Boor,
//! *A Practical Guide to Splines*, 2001, ch. IV (the spline with two continuous derivatives, not-a-knot
//! replaced by natural ends); A. Savitzky, M. J. E. Golay, Anal. Chem. 36, 1964 (smoothing by local
//! polynomials, here over a time instead of a count, so that instants need not be equidistant).

use std::sync::Arc;

/// What holds between two instants.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Interpolation {
    /// The value of the instant before: what a digital output does.
    Hold,
    /// A straight line.
    Linear,
    /// A cubic without overshoot, with a continuous slope.
    Monotone,
    /// A cubic with continuous slope and curvature: nearest to a signal without high frequencies.
    Spline,
}

impl Interpolation {
    /// All, with their names in plans.
    pub const ALL: [(&'static str, Interpolation); 4] = [
        ("hold", Interpolation::Hold),
        ("linear", Interpolation::Linear),
        ("monotone", Interpolation::Monotone),
        ("spline", Interpolation::Spline),
    ];
}

/// Values at rising instants, and what lies between; beyond the ends the nearest value stays.
#[derive(Clone, PartialEq, Debug)]
pub struct Course {
    times: Arc<[f64]>,
    values: Vec<f64>,
    /// At each instant, for cubics; empty otherwise.
    slopes: Vec<f64>,
    interpolation: Interpolation,
    spacing: f64,
}

impl Course {
    /// Through `values` at `times`, which rise; at least one of each, all finite.
    pub fn new(times: Arc<[f64]>, values: Vec<f64>, interpolation: Interpolation) -> Self {
        debug_assert!(times.len() == values.len() && !values.is_empty());
        let slopes = match interpolation {
            Interpolation::Hold | Interpolation::Linear => Vec::new(),
            Interpolation::Monotone => monotone_slopes(&times, &values),
            Interpolation::Spline => spline_slopes(&times, &values),
        };
        let mut steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        let spacing = steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY);
        Course { times, values, slopes, interpolation, spacing }
    }

    /// What holds between two instants.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The usual time between two instants.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The interval that `t` is in: 0 before the first instant, `k` from instant `k - 1` on. The search
    /// begins at `near`, where the last one ended.
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

    /// Where an interval ends; infinity for the last.
    pub fn end_of(&self, interval: usize) -> f64 {
        self.times.get(interval).copied().unwrap_or(f64::INFINITY)
    }

    /// The derivative of this order at `t`, 0 for the value, by the formula of an interval.
    #[inline]
    pub fn at(&self, t: f64, interval: usize, order: usize) -> f64 {
        let last = self.times.len() - 1;
        if interval == 0 || interval > last {
            let end = if interval == 0 { 0 } else { last };
            return if order == 0 { self.values[end] } else { 0.0 };
        }
        let (t0, t1) = (self.times[interval - 1], self.times[interval]);
        let (y0, y1) = (self.values[interval - 1], self.values[interval]);
        let h = t1 - t0;
        let (s, chord) = (t - t0, (y1 - y0) / h);
        match (self.interpolation, order) {
            (Interpolation::Hold, 0) => y0,
            (Interpolation::Hold, _) => 0.0,
            (Interpolation::Linear, 0) => y0 + s * chord,
            (Interpolation::Linear, 1) => chord,
            (Interpolation::Linear, _) => 0.0,
            (_, order) => {
                let (d0, d1) = (self.slopes[interval - 1], self.slopes[interval]);
                let c2 = (3.0 * chord - 2.0 * d0 - d1) / h;
                let c3 = (d0 + d1 - 2.0 * chord) / (h * h);
                match order {
                    0 => y0 + s * (d0 + s * (c2 + s * c3)),
                    1 => d0 + s * (2.0 * c2 + 3.0 * s * c3),
                    2 => 2.0 * c2 + 6.0 * s * c3,
                    3 => 6.0 * c3,
                    _ => 0.0,
                }
            }
        }
    }

    /// The derivative of this order at `t`, wherever that is.
    pub fn value(&self, t: f64, order: usize) -> f64 {
        self.at(t, self.interval(t, 0), order)
    }
}

/// The weighted harmonic means of the neighbouring chords, 0 where these turn.
fn monotone_slopes(times: &[f64], values: &[f64]) -> Vec<f64> {
    let n = times.len();
    let h: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let chords: Vec<f64> = values.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    let mut slopes = vec![0.0; n];
    if n > 1 {
        (slopes[0], slopes[n - 1]) = (chords[0], chords[n - 2]);
    }
    for k in 1..n.saturating_sub(1) {
        let (a, b) = (chords[k - 1], chords[k]);
        if a * b > 0.0 {
            let weight = (h[k - 1] + 2.0 * h[k]) / (3.0 * (h[k - 1] + h[k]));
            slopes[k] = a * b / (weight * b + (1.0 - weight) * a);
        }
    }
    slopes
}

/// The slopes that make the curvature continuous, with none at the ends: a tridiagonal system.
fn spline_slopes(times: &[f64], values: &[f64]) -> Vec<f64> {
    let n = times.len();
    if n < 3 {
        return monotone_slopes(times, values);
    }
    let h: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let chords: Vec<f64> = values.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    let (mut upper, mut right) = (vec![0.0; n], vec![0.0; n]);
    (upper[0], right[0]) = (0.5, 1.5 * chords[0]);
    for k in 1..n {
        let (below, diagonal, above, r) = if k + 1 < n {
            let r = 3.0 * (h[k] * chords[k - 1] + h[k - 1] * chords[k]);
            (h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1], r)
        } else {
            (1.0, 2.0, 0.0, 3.0 * chords[n - 2])
        };
        let pivot = diagonal - below * upper[k - 1];
        upper[k] = above / pivot;
        right[k] = (r - below * right[k - 1]) / pivot;
    }
    for k in (0..n - 1).rev() {
        right[k] -= upper[k] * right[k + 1];
    }
    right
}

/// Values and rates of a recording without its noise: at each instant those of the parabola that fits
/// what was recorded within `half` of it best, weighted less towards the ends (by the tricube weights of
/// W. S. Cleveland, J. Am. Stat. Assoc. 74, 1979). Instants whose neighbourhood holds too little keep the
/// value, with the slope to their neighbour.
pub fn smoothed(times: &[f64], values: &[f64], half: f64) -> (Vec<f64>, Vec<f64>) {
    let n = times.len();
    let (mut smooth, mut rates) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let mut first = 0;
    for k in 0..n {
        let t = times[k];
        while times[first] < t - half {
            first += 1;
        }
        let (mut s, mut r) = ([0.0; 5], [0.0; 3]);
        let near =
            times[first..].iter().zip(&values[first..]).take_while(|(at, _)| **at <= t + half);
        let mut count = 0;
        for (at, y) in near {
            let x = (at - t) / half;
            let w = (1.0 - x.abs().powi(3)).max(0.0).powi(3);
            count += usize::from(w > 0.0);
            let mut power = w;
            for (j, s) in s.iter_mut().enumerate() {
                *s += power;
                if let Some(r) = r.get_mut(j) {
                    *r += power * y;
                }
                power *= x;
            }
        }
        let det = s[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (s[1] * s[4] - s[3] * s[2])
            + s[2] * (s[1] * s[3] - s[2] * s[2]);
        if count < 4 || !(det > 1e-12 * s[0] * s[2] * s[4]) {
            let other = if k > 0 { k - 1 } else { (k + 1).min(n - 1) };
            let way = t - times[other];
            smooth.push(values[k]);
            rates.push(if way == 0.0 { 0.0 } else { (values[k] - values[other]) / way });
            continue;
        }
        let value = r[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (r[1] * s[4] - s[3] * r[2])
            + s[2] * (r[1] * s[3] - s[2] * r[2]);
        let rate = s[0] * (r[1] * s[4] - r[2] * s[3]) - r[0] * (s[1] * s[4] - s[3] * s[2])
            + s[2] * (s[1] * r[2] - r[1] * s[2]);
        smooth.push(value / det);
        rates.push(rate / det / half);
    }
    (smooth, rates)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(n: usize) -> Arc<[f64]> {
        (0..n).map(|k| 0.1 * k as f64 + 0.01 * ((k * k) % 3) as f64).collect()
    }

    fn course(interpolation: Interpolation, f: impl Fn(f64) -> f64) -> Course {
        let times = times(40);
        let values = times.iter().map(|t| f(*t)).collect();
        Course::new(times, values, interpolation)
    }

    #[test]
    fn each_passes_through_what_was_recorded() {
        for (name, interpolation) in Interpolation::ALL {
            let c = course(interpolation, f64::sin);
            for t in times(40).iter().take(39) {
                assert!((c.value(*t, 0) - t.sin()).abs() < 1e-14, "{name}");
            }
            assert_eq!((c.value(-1.0, 0), c.value(-1.0, 1)), (0.0, 0.0));
        }
    }

    #[test]
    fn a_line_is_a_line() {
        for interpolation in [Interpolation::Linear, Interpolation::Monotone, Interpolation::Spline]
        {
            let c = course(interpolation, |t| 2.0 - 3.0 * t);
            for k in 0..300 {
                let t = 0.012 * k as f64;
                assert!((c.value(t, 0) - (2.0 - 3.0 * t)).abs() < 1e-12);
                assert!((c.value(t, 1) + 3.0).abs() < 1e-11);
            }
        }
    }

    /// The error of a cubic spline is of order h^4 away from its ends.
    #[test]
    fn a_spline_is_near_a_smooth_signal() {
        let c = course(Interpolation::Spline, f64::sin);
        for k in 100..250 {
            let t = 0.012 * k as f64;
            assert!((c.value(t, 0) - t.sin()).abs() < 2e-6);
            assert!((c.value(t, 1) - t.cos()).abs() < 1e-4);
        }
    }

    #[test]
    fn a_monotone_cubic_does_not_overshoot() {
        let c = course(Interpolation::Monotone, |t| f64::from(t > 2.0));
        assert!((0..400).map(|k| c.value(0.01 * k as f64, 0)).all(|y| (0.0..=1.0).contains(&y)));
    }

    #[test]
    fn a_step_is_held() {
        let c = Course::new(Arc::new([0.0, 1.0, 2.0]), vec![5.0, 6.0, 7.0], Interpolation::Hold);
        assert_eq!([0.0, 0.99, 1.0, 1.5, 2.5].map(|t| c.value(t, 0)), [5.0, 5.0, 6.0, 6.0, 7.0]);
        assert_eq!((c.end_of(0), c.end_of(1), c.end_of(3)), (0.0, 1.0, f64::INFINITY));
    }

    #[test]
    fn the_interval_is_found_from_anywhere() {
        let c = course(Interpolation::Linear, f64::sin);
        for near in 0..41 {
            assert_eq!(c.interval(1.234, near), c.interval(1.234, 0));
        }
    }

    #[test]
    fn a_parabola_is_smooth_already() {
        let times = times(60);
        let f = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t;
        let values: Vec<f64> = times.iter().map(|t| f(*t)).collect();
        let (smooth, rates) = smoothed(&times, &values, 0.5);
        for ((t, y), v) in times.iter().zip(smooth).zip(rates) {
            assert!((y - f(*t)).abs() < 1e-11 && (v - (t - 2.0)).abs() < 1e-9, "{t} {y} {v}");
        }
    }
}
