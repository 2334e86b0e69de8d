//! A smooth piece of a curve through points that come one after the other.

use std::collections::VecDeque;

/// Part of the last distance at which a further point stands next to the last one: with both, what
/// rounding has made of their values would be a slope.
const NEXT_TO: f64 = 1e-6;

/// Part of its size by which a value differs at the two sides of a jump.
const JUMP: f64 = 1e-10;

/// True if a course jumps between two values at one place.
pub fn jumps(a: f64, b: f64) -> bool {
    (a - b).abs() > JUMP * a.abs().max(b.abs())
}

/// Points of rising abscissa, interpolated by polynomials of third degree through four of them.
#[derive(Clone, Default, Debug)]
pub struct Piece {
    t: VecDeque<f64>,
    value: VecDeque<f64>,
}

/// What a piece does beyond its ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Beyond {
    /// Its last value stays.
    Rests,
    /// It goes on along the straight line through its last two points.
    GoesOn,
}

impl Piece {
    /// A piece of one point.
    pub fn of(t: f64, value: f64) -> Self {
        Piece { t: [t].into(), value: [value].into() }
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

    /// Adds a point behind all others; where it stands next to the last one it takes the place of that.
    pub fn push_last(&mut self, t: f64, value: f64) {
        let n = self.points();
        if n > 1 && t - self.t[n - 1] < NEXT_TO * (self.t[n - 1] - self.t[n - 2]) {
            self.t.pop_back();
            self.value.pop_back();
        }
        self.t.push_back(t);
        self.value.push_back(value);
    }

    /// Adds a point before all others; where it stands next to the first one it takes the place of that.
    pub fn push_first(&mut self, t: f64, value: f64) {
        if self.points() > 1 && self.t[0] - t < NEXT_TO * (self.t[1] - self.t[0]) {
            self.t.pop_front();
            self.value.pop_front();
        }
        self.t.push_front(t);
        self.value.push_front(value);
    }

    /// Drops the points before `t`, but for the few that interpolation there needs.
    pub fn forget_before(&mut self, t: f64) {
        let passed = self.t.partition_point(|x| *x < t).saturating_sub(4);
        self.t.drain(..passed);
        self.value.drain(..passed);
    }

    /// Drops the points after `t`, but for the few that interpolation there needs.
    pub fn forget_after(&mut self, t: f64) {
        let kept = (self.t.partition_point(|x| *x <= t) + 4).min(self.points());
        self.t.truncate(kept);
        self.value.truncate(kept);
    }

    /// Cuts the piece off before `t`, where its value is the first one from then on.
    pub fn cut_before(&mut self, t: f64) {
        let value = self.at(t, 0, Beyond::Rests);
        let passed = self.t.partition_point(|x| *x <= t);
        self.t.drain(..passed);
        self.value.drain(..passed);
        self.push_first(t, value);
    }

    /// Cuts the piece off after `t`, where its value is the last one from then on.
    pub fn cut_after(&mut self, t: f64) {
        let value = self.at(t, 0, Beyond::Rests);
        let kept = self.t.partition_point(|x| *x < t);
        self.t.truncate(kept);
        self.value.truncate(kept);
        self.push_last(t, value);
    }

    /// The value at `t`, or its derivative of this order.
    pub fn at(&self, t: f64, order: u32, beyond: Beyond) -> f64 {
        let (Some((first, first_value)), Some((last, last_value))) = (self.first(), self.last())
        else {
            return 0.0;
        };
        let n = self.points();
        let inside = t > first && t < last;
        let (from, to) = if n > 1 && inside {
            let after = self.t.partition_point(|x| *x <= t);
            let from = after.saturating_sub(2).min(n.saturating_sub(4));
            (from, (from + 4).min(n))
        } else if n == 1 || beyond == Beyond::Rests {
            let end = if t <= first { first_value } else { last_value };
            return if order == 0 { end } else { 0.0 };
        } else if t <= first {
            (0, 2)
        } else {
            (n - 2, n)
        };
        // What rests is met to the bit, so that nothing chatters.
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

/// The polynomial through points, or its derivative of this order, at `t`: Newton's divided differences,
/// which take the place of `y`.
fn through(x: &[f64], y: &mut [f64], t: f64, order: u32) -> f64 {
    let n = x.len();
    for k in 1..n {
        for i in (k..n).rev() {
            y[i] = (y[i] - y[i - 1]) / (x[i] - x[i - k]);
        }
    }
    // Horner's scheme, carried out on the value and on the derivatives divided by the factorials of their order.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_met_with_its_derivatives() {
        let f = |t: f64| 1.0 + t * (2.0 - t * (0.5 + t));
        let mut piece = Piece::default();
        for t in [0.0, 0.3, 0.7, 1.2, 1.5, 2.1] {
            piece.push_last(t, f(t));
        }
        let at = |t, order| piece.at(t, order, Beyond::Rests);
        for u in [0.1, 0.5, 1.3, 2.0] {
            assert!((at(u, 0) - f(u)).abs() < 1e-13);
            assert!((at(u, 1) - (2.0 - u - 3.0 * u * u)).abs() < 1e-12);
            assert!((at(u, 2) - (-1.0 - 6.0 * u)).abs() < 1e-11);
            assert!((at(u, 3) + 6.0).abs() < 1e-10);
        }
        assert_eq!((at(-1.0, 0), at(3.0, 0)), (f(0.0), f(2.1)));
        let slope = (f(0.3) - f(0.0)) / 0.3;
        assert!((piece.at(-1.0, 0, Beyond::GoesOn) - (f(0.0) - slope)).abs() < 1e-13);
    }

    /// Two points of an event that differ by rounding alone would give any slope.
    #[test]
    fn what_rounding_adds_to_a_place_does_no_harm() {
        let mut piece = Piece::default();
        for t in [0.0_f64, 0.25, 0.5, 0.5 + 1e-15, 0.75, 1.0] {
            piece.push_last(t, t.sin() + if t == 0.5 { 1e-14 } else { 0.0 });
        }
        assert_eq!(piece.points(), 5);
        assert!((piece.at(0.6, 0, Beyond::Rests) - f64::sin(0.6)).abs() < 1e-3);
    }

    #[test]
    fn a_piece_is_cut_at_both_ends() {
        let mut piece = Piece::default();
        for k in 0..6 {
            piece.push_last(f64::from(k), f64::from(2 * k));
        }
        piece.cut_before(1.5);
        piece.cut_after(3.5);
        assert_eq!((piece.first(), piece.last()), (Some((1.5, 3.0)), Some((3.5, 7.0))));
        assert_eq!(piece.points(), 4);
    }
}
