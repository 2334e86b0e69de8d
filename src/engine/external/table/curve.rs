//! Interpolation of a function of one argument.

use super::{Extrapolation, interval};
use crate::base::wire::wire_struct;
use crate::numeric::hermite::{Smoothness, hermite, polynomial, slopes};

/// A piecewise polynomial through points, with its derivatives.
#[derive(Clone, PartialEq, Debug)]
pub struct Curve {
    x: Vec<f64>,
    /// For each interval the polynomial in `u - x[i]`, lowest power first.
    segments: Vec<[f64; 4]>,
    last: f64,
    end_slopes: [f64; 2],
    extrapolation: Extrapolation,
}

impl Curve {
    /// Interpolates points with increasing abscissae. A single point gives a constant; `None` if
    /// there are no points, if the abscissae do not increase, or if a number is not finite.
    pub fn new(
        x: &[f64],
        y: &[f64],
        smoothness: Smoothness,
        extrapolation: Extrapolation,
    ) -> Option<Curve> {
        let n = x.len();
        let fine = n > 0 && y.len() == n && x.iter().chain(y).all(|v| v.is_finite());
        if !fine || x.windows(2).any(|p| p[0] >= p[1]) {
            return None;
        }
        let secant = |i: usize| (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
        let segments: Vec<[f64; 4]> = match smoothness {
            Smoothness::Constant => y[..n - 1].iter().map(|y| [*y, 0.0, 0.0, 0.0]).collect(),
            Smoothness::Linear => (0..n - 1).map(|i| [y[i], secant(i), 0.0, 0.0]).collect(),
            _ => {
                let s = slopes(smoothness, x, y, extrapolation == Extrapolation::Periodic);
                (0..n - 1)
                    .map(|i| hermite(x[i + 1] - x[i], y[i], y[i + 1], s[i], s[i + 1]))
                    .collect()
            }
        };
        let end_slopes = match (n, smoothness) {
            (1, _) => [0.0; 2],
            // The line through the two outermost points.
            (_, Smoothness::Constant) => [secant(0), secant(n - 2)],
            _ => {
                let last = &segments[n - 2];
                let h = x[n - 1] - x[n - 2];
                [segments[0][1], last[1] + h * (2.0 * last[2] + 3.0 * h * last[3])]
            }
        };
        Some(Curve { x: x.to_vec(), segments, last: y[n - 1], end_slopes, extrapolation })
    }

    /// The minimum and the maximum abscissa.
    pub fn range(&self) -> (f64, f64) {
        (self.x[0], self.x[self.x.len() - 1])
    }

    /// The points between which it is a polynomial, increasing.
    pub fn points(&self) -> &[f64] {
        &self.x
    }

    /// For each interval the polynomial in the distance from its lower point, lowest power first.
    pub fn pieces(&self) -> &[[f64; 4]] {
        &self.segments
    }

    /// The value at the first or the last point.
    pub fn end(&self, point: f64) -> f64 {
        if point == self.x[0] {
            self.segments.first().map_or(self.last, |p| p[0])
        } else {
            self.last
        }
    }

    /// Extrapolation beyond the points.
    pub fn extrapolation(&self) -> Extrapolation {
        self.extrapolation
    }

    /// The derivative of this order at `u`; the value for order 0.
    pub fn at(&self, u: f64, order: u8) -> f64 {
        if self.segments.is_empty() {
            return if order == 0 { self.last } else { 0.0 };
        }
        let (first, last) = self.range();
        let inside = match self.extrapolation {
            Extrapolation::Periodic => wrapped(u, first, last),
            _ => u,
        };
        if inside < first {
            return self.beyond(self.segments[0][0], self.end_slopes[0], u - first, order);
        }
        // The last point belongs to the last interval, except for piecewise constant curves.
        let level = inside == last && self.segments.last().is_some_and(|p| p[0] != self.last);
        if inside > last || (level && self.extrapolation != Extrapolation::Periodic && order == 0) {
            return self.beyond(self.last, self.end_slopes[1], u - last, order);
        }
        let i = interval(&self.x, inside);
        polynomial(&self.segments[i], inside - self.x[i], order)
    }

    /// As [`Curve::at`], but the left limit at `u`.
    pub fn before(&self, u: f64, order: u8) -> f64 {
        let i = self.x.partition_point(|x| *x < u);
        match self.x.get(i) {
            Some(x) if i > 0 && *x == u => {
                polynomial(&self.segments[i - 1], u - self.x[i - 1], order)
            }
            _ => self.at(u, order),
        }
    }

    fn beyond(&self, value: f64, slope: f64, distance: f64, order: u8) -> f64 {
        let linear = self.extrapolation == Extrapolation::Linear;
        match order {
            0 if linear => value + slope * distance,
            0 => value,
            1 if linear => slope,
            _ => 0.0,
        }
    }
}

/// `u` shifted by a multiple of the period into `[first, last)`.
pub fn wrapped(u: f64, first: f64, last: f64) -> f64 {
    let period = last - first;
    if (first..last).contains(&u) || period <= 0.0 {
        return u;
    }
    let shifted = u - period * ((u - first) / period).floor();
    if shifted < last { shifted.max(first) } else { first }
}

wire_struct!(Curve { x, segments, last, end_slopes, extrapolation });

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 5] = [0.0, 1.0, 2.0, 4.0, 5.0];
    const Y: [f64; 5] = [0.0, 2.0, 1.0, 1.0, 3.0];
    const ALL: [Smoothness; 6] = [
        Smoothness::Linear,
        Smoothness::Akima,
        Smoothness::Constant,
        Smoothness::FritschButland,
        Smoothness::Steffen,
        Smoothness::ModifiedAkima,
    ];

    fn curve(smoothness: Smoothness, extrapolation: Extrapolation) -> Curve {
        Curve::new(&X, &Y, smoothness, extrapolation).unwrap()
    }

    #[test]
    fn every_curve_interpolates_its_points() {
        for smoothness in ALL {
            let c = curve(smoothness, Extrapolation::Hold);
            for (x, y) in X.iter().zip(Y) {
                assert!((c.at(*x, 0) - y).abs() < 1e-14, "{smoothness:?} at {x}");
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let h = 1e-6;
        for smoothness in ALL {
            for extrapolation in
                [Extrapolation::Hold, Extrapolation::Linear, Extrapolation::Periodic]
            {
                let c = curve(smoothness, extrapolation);
                for u in [-0.3, 0.4, 1.7, 3.1, 4.6, 5.4, 11.3] {
                    for order in 0..3 {
                        let slope = (c.at(u + h, order) - c.at(u - h, order)) / (2.0 * h);
                        let exact = c.at(u, order + 1);
                        assert!(
                            (slope - exact).abs() < 1e-6,
                            "{smoothness:?} {extrapolation:?} {u}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn beyond_the_points() {
        let line = |e| curve(Smoothness::Linear, e);
        assert_eq!(line(Extrapolation::Hold).at(7.0, 0), 3.0);
        assert_eq!(line(Extrapolation::Linear).at(7.0, 0), 7.0);
        assert_eq!(line(Extrapolation::Linear).at(-1.0, 0), -2.0);
        assert_eq!(line(Extrapolation::Periodic).at(5.5, 0), 1.0);
        assert_eq!(line(Extrapolation::Periodic).at(-4.5, 0), 1.0);
        // Lines through the outermost points also for piecewise constant curves.
        assert_eq!(curve(Smoothness::Constant, Extrapolation::Linear).at(6.0, 0), 5.0);
    }

    #[test]
    fn splines_are_smooth_at_period_boundaries() {
        let y = [1.0, 2.0, 1.0, 0.5, 1.0];
        for smoothness in [Smoothness::Akima, Smoothness::Steffen, Smoothness::ModifiedAkima] {
            let c = Curve::new(&X, &y, smoothness, Extrapolation::Periodic).unwrap();
            let (before, after) = (c.at(5.0 - 1e-9, 1), c.at(5.0 + 1e-9, 1));
            assert!((before - after).abs() < 1e-6, "{smoothness:?}: {before} {after}");
        }
    }

    #[test]
    fn one_point_is_a_constant_and_none_is_rejected() {
        let one = Curve::new(&[2.0], &[7.0], Smoothness::Akima, Extrapolation::Linear).unwrap();
        assert_eq!((one.at(-9.0, 0), one.at(9.0, 1)), (7.0, 0.0));
        assert!(Curve::new(&[], &[], Smoothness::Linear, Extrapolation::Hold).is_none());
        let twice = [1.0, 1.0];
        assert!(Curve::new(&twice, &twice, Smoothness::Linear, Extrapolation::Hold).is_none());
    }
}
