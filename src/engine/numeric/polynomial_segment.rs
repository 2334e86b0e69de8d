//! A smooth segment of a curve that grows point by point.

use std::collections::VecDeque;

/// A new point closer to the last one than this fraction of the last distance replaces it: between
/// two points so close, rounding errors of the values would become a slope.
const COINCIDENT: f64 = 1e-6;

/// Relative difference between the values at the two sides of a jump.
const JUMP: f64 = 1e-10;

/// True if a curve jumps between two values at the same abscissa.
pub fn jumps(a: f64, b: f64) -> bool {
    (a - b).abs() > JUMP * a.abs().max(b.abs())
}

/// Points of increasing abscissa, interpolated by cubic polynomials through four of them.
#[derive(Clone, Default, Debug)]
pub struct PolynomialSegment {
    t: VecDeque<f64>,
    value: VecDeque<f64>,
    /// Abscissas of points at which the slope may jump: no polynomial goes through points on both sides.
    corners: VecDeque<f64>,
}

/// The value of a segment beyond its ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Extrapolation {
    /// The value at the end.
    Constant,
    /// The straight line through the last two points.
    Linear,
}

impl PolynomialSegment {
    /// A segment of one point.
    pub fn of(t: f64, value: f64) -> Self {
        PolynomialSegment { t: [t].into(), value: [value].into(), corners: VecDeque::new() }
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.t.len()
    }

    /// The first point; `None` without points.
    pub fn first(&self) -> Option<(f64, f64)> {
        Some((*self.t.front()?, *self.value.front()?))
    }

    /// The last point; `None` without points.
    pub fn last(&self) -> Option<(f64, f64)> {
        Some((*self.t.back()?, *self.value.back()?))
    }

    /// Appends a point; replaces the last one if both nearly coincide.
    pub fn push_last(&mut self, t: f64, value: f64) {
        let n = self.points();
        if n > 1 && t - self.t[n - 1] < COINCIDENT * (self.t[n - 1] - self.t[n - 2]) {
            self.t.pop_back();
            self.value.pop_back();
        }
        self.t.push_back(t);
        self.value.push_back(value);
    }

    /// The last point is one at which the slope may jump.
    pub fn mark_corner(&mut self) {
        if let Some((t, _)) = self.last()
            && self.corners.back() != Some(&t)
        {
            self.corners.push_back(t);
        }
    }

    /// Prepends a point; replaces the first one if both nearly coincide.
    pub fn push_first(&mut self, t: f64, value: f64) {
        if self.points() > 1 && self.t[0] - t < COINCIDENT * (self.t[1] - self.t[0]) {
            self.t.pop_front();
            self.value.pop_front();
        }
        self.t.push_front(t);
        self.value.push_front(value);
    }

    /// Drops the points before `t` except the few that interpolation at `t` needs.
    pub fn discard_before(&mut self, t: f64) {
        let passed = self.t.partition_point(|x| *x < t).saturating_sub(4);
        self.t.drain(..passed);
        self.value.drain(..passed);
        let first = self.t.front().copied().unwrap_or(t);
        let passed = self.corners.partition_point(|x| *x <= first);
        self.corners.drain(..passed);
    }

    /// Drops the points after `t` except the few that interpolation at `t` needs.
    pub fn discard_after(&mut self, t: f64) {
        let kept = (self.t.partition_point(|x| *x <= t) + 4).min(self.points());
        self.t.truncate(kept);
        self.value.truncate(kept);
    }

    /// Cuts the segment off before `t`; the value at `t` becomes its first point.
    pub fn cut_before(&mut self, t: f64) {
        let value = self.at(t, 0, Extrapolation::Constant);
        let passed = self.t.partition_point(|x| *x <= t);
        self.t.drain(..passed);
        self.value.drain(..passed);
        self.push_first(t, value);
    }

    /// Cuts the segment off after `t`; the value at `t` becomes its last point.
    pub fn cut_after(&mut self, t: f64) {
        let value = self.at(t, 0, Extrapolation::Constant);
        let kept = self.t.partition_point(|x| *x < t);
        self.t.truncate(kept);
        self.value.truncate(kept);
        self.push_last(t, value);
    }

    /// The positions of the points between the corners around `t`: the first, and one more than the last.
    fn piece(&self, t: f64) -> (usize, usize) {
        if self.corners.is_empty() {
            return (0, self.points());
        }
        let next = self.corners.partition_point(|x| *x <= t);
        let low = next.checked_sub(1).map_or(0, |k| {
            let corner = self.corners[k];
            self.t.partition_point(|x| *x < corner)
        });
        let high = self
            .corners
            .get(next)
            .map_or(self.points(), |corner| self.t.partition_point(|x| x <= corner));
        (low, high)
    }

    /// The derivative of this order at `t`; the value for order 0.
    pub fn at(&self, t: f64, order: u32, beyond: Extrapolation) -> f64 {
        let (Some((first, first_value)), Some((last, last_value))) = (self.first(), self.last())
        else {
            return 0.0;
        };
        let n = self.points();
        let inside = t > first && t < last;
        let (from, to) = if n > 1 && inside {
            let after = self.t.partition_point(|x| *x <= t);
            let (low, high) = self.piece(t);
            let from = after.saturating_sub(2).min(high.saturating_sub(4)).max(low);
            (from, (from + 4).min(high))
        } else if n == 1 || beyond == Extrapolation::Constant {
            let end = if t <= first { first_value } else { last_value };
            return if order == 0 { end } else { 0.0 };
        } else if t <= first {
            (0, 2)
        } else {
            (n - 2, n)
        };
        // Constant values are reproduced exactly, so that no relation chatters.
        if (from + 1..to).all(|k| self.value[k - 1] == self.value[k]) {
            return if order == 0 { self.value[from] } else { 0.0 };
        }
        let (mut x, mut y) = ([0.0; 4], [0.0; 4]);
        let count = to - from;
        for k in 0..count {
            (x[k], y[k]) = (self.t[from + k], self.value[from + k]);
        }
        through(&x[..count], &mut y[..count], t, order)
    }
}

/// The polynomial through points, or its derivative of this order, at `t`: Newton's divided
/// differences, which overwrite `y`.
fn through(x: &[f64], y: &mut [f64], t: f64, order: u32) -> f64 {
    let n = x.len();
    for k in 1..n {
        for i in (k..n).rev() {
            y[i] = (y[i] - y[i - 1]) / (x[i] - x[i - k]);
        }
    }
    // Horner's scheme, applied to the value and to the derivatives divided by their factorials.
    let mut p = [0.0; 4];
    for i in (0..n).rev() {
        for k in (1..4).rev() {
            p[k] = p[k] * (t - x[i]) + p[k - 1];
        }
        p[0] = p[0] * (t - x[i]) + y[i];
    }
    match order {
        0 => p[0],
        1 => p[1],
        2 => 2.0 * p[2],
        3 => 6.0 * p[3],
        _ => 0.0,
    }
}

crate::base::wire::wire_struct!(PolynomialSegment { t, value, corners });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_reproduced_with_its_derivatives() {
        let f = |t: f64| 1.0 + t * (2.0 - t * (0.5 + t));
        let mut segment = PolynomialSegment::default();
        for t in [0.0, 0.3, 0.7, 1.2, 1.5, 2.1] {
            segment.push_last(t, f(t));
        }
        let at = |t, order| segment.at(t, order, Extrapolation::Constant);
        for u in [0.1, 0.5, 1.3, 2.0] {
            assert!((at(u, 0) - f(u)).abs() < 1e-13);
            assert!((at(u, 1) - (2.0 - u - 3.0 * u * u)).abs() < 1e-12);
            assert!((at(u, 2) - (-1.0 - 6.0 * u)).abs() < 1e-11);
            assert!((at(u, 3) + 6.0).abs() < 1e-10);
        }
        assert_eq!((at(-1.0, 0), at(3.0, 0)), (f(0.0), f(2.1)));
        let slope = (f(0.3) - f(0.0)) / 0.3;
        assert!((segment.at(-1.0, 0, Extrapolation::Linear) - (f(0.0) - slope)).abs() < 1e-13);
    }

    /// The absolute value from straight lines on both sides, where a cubic through both would swing.
    #[test]
    fn a_corner_stays_one() {
        let mut segment = PolynomialSegment::of(-1.0, 1.0);
        for k in -9..=10 {
            let t = 0.1 * f64::from(k);
            segment.push_last(t, t.abs());
            if k == 0 {
                segment.mark_corner();
            }
        }
        for t in [-0.14, -0.06, -0.01, 0.0, 0.03, 0.08, 0.17, 0.95] {
            assert!((segment.at(t, 0, Extrapolation::Constant) - f64::abs(t)).abs() < 1e-15);
        }
        segment.discard_before(0.5);
        assert!(segment.corners.is_empty());
    }

    /// Two points of an event whose abscissas differ only by rounding would give an arbitrary
    /// slope.
    #[test]
    fn coincident_points_are_merged() {
        let mut segment = PolynomialSegment::default();
        for t in [0.0_f64, 0.25, 0.5, 0.5 + 1e-15, 0.75, 1.0] {
            segment.push_last(t, t.sin() + if t == 0.5 { 1e-14 } else { 0.0 });
        }
        assert_eq!(segment.points(), 5);
        assert!((segment.at(0.6, 0, Extrapolation::Constant) - f64::sin(0.6)).abs() < 1e-3);
    }

    #[test]
    fn a_segment_is_cut_at_both_ends() {
        let mut segment = PolynomialSegment::default();
        for k in 0..6 {
            segment.push_last(f64::from(k), f64::from(2 * k));
        }
        segment.cut_before(1.5);
        segment.cut_after(3.5);
        assert_eq!((segment.first(), segment.last()), (Some((1.5, 3.0)), Some((3.5, 7.0))));
        assert_eq!(segment.points(), 4);
    }
}
