//! Points of a fitted curve with the covariance of their values.
//!
//! The values at neighbouring knots are fitted together and have errors that belong together: what one gains, the next may
//! lose. A formula is fitted to them by generalized least squares, which are least squares after a transformation that turns
//! the errors into independent ones (whitening: Aitken 1935).

use super::formula::FreeCurve;
use super::hypothesis::{ChosenEffect, Hypothesis};
use super::regrid::ends;
use super::study::Study;

/// Points of a curve.
pub struct Points {
    /// Places and values.
    pub at: Vec<(f64, f64)>,
    /// The covariance of the values, row by row; empty if nothing is known of it.
    pub covariance: Vec<f64>,
}

impl Points {
    /// Adds a point without error.
    pub fn add_known(&mut self, point: (f64, f64)) {
        let n = self.at.len();
        self.at.push(point);
        if !self.covariance.is_empty() {
            let of = |k: usize| {
                let (row, column) = (k / (n + 1), k % (n + 1));
                if row == n || column == n { 0.0 } else { self.covariance[row * n + column] }
            };
            self.covariance = (0..(n + 1) * (n + 1)).map(of).collect();
        }
    }

    /// The inverse of the Cholesky factor of the covariance, row by row, where every value has a further error of its own.
    pub fn whitening(&self, error: f64) -> Vec<f64> {
        let n = self.at.len();
        let covariance = |i: usize, j: usize| {
            let known = self.covariance.get(i * n + j).filter(|c| c.is_finite());
            known.copied().unwrap_or(0.0) + if i == j { error * error } else { 0.0 }
        };
        let (mut factor, mut inverse) = (vec![0.0; n * n], vec![0.0; n * n]);
        for i in 0..n {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
                let left = covariance(i, j) - known;
                factor[i * n + j] =
                    if i == j { left.max(error * error).sqrt() } else { left / factor[j * n + j] };
            }
            for j in 0..=i {
                let own = if i == j { 1.0 } else { 0.0 };
                let known: f64 = (j..i).map(|k| factor[i * n + k] * inverse[k * n + j]).sum();
                inverse[i * n + j] = (own - known) / factor[i * n + i];
            }
        }
        inverse
    }
}

/// The covariance of some parameters of an effect, row by row; 0 where it is not known.
pub fn covariance(hypothesis: &Hypothesis, chosen: &ChosenEffect, names: &[&str]) -> Vec<f64> {
    let full: Vec<String> = names.iter().map(|name| chosen.full_name(name)).collect();
    let of = |(i, j): (usize, usize)| hypothesis.covariance_of(&full[i], &full[j]).unwrap_or(0.0);
    let n = names.len();
    (0..n * n).map(|k| of((k / n, k % n))).collect()
}

/// Points in a range of a fitted curve, twice as many as it has knots.
pub fn points_on_curve(
    study: &Study,
    hypothesis: &Hypothesis,
    chosen: &ChosenEffect,
    curve: &FreeCurve,
    (from, to): (f64, f64),
) -> Option<Points> {
    let names: Vec<&str> =
        study.effects[chosen.effect].amplitudes.iter().map(|a| a.name.as_str()).collect();
    let (low, high) = ends(&chosen.fixed, curve)?;
    let fixed = curve.fixed_point(low).map(|(_, y)| y);
    let estimate = |name: &&str| Some(hypothesis.estimate(&chosen.full_name(name))?.0);
    let estimates = names.iter().map(estimate);
    let knots: Vec<f64> = fixed.into_iter().map(Some).chain(estimates).collect::<Option<_>>()?;
    let (n, free) = (knots.len(), names.len());
    let spacing = (high - low) / (n - 1) as f64;
    let (first, last) = (from.max(low), to.min(high));
    if spacing <= 0.0 || first >= last {
        return None;
    }
    let number = FINER_POINTS * n;
    let place = |k: usize| first + (last - first) * k as f64 / (number - 1) as f64;
    let weights: Vec<Vec<f64>> =
        (0..number).map(|k| knot_weights((place(k) - low) / spacing, n)).collect();
    let value = |k: usize| weights[k].iter().zip(&knots).map(|(w, y)| w * y).sum();
    let of_knots = covariance(hypothesis, chosen, &names);
    let between = |(i, j): (usize, usize)| -> f64 {
        let [one, other] = [&weights[i][n - free..], &weights[j][n - free..]];
        let row = |(k, w): (usize, &f64)| -> f64 {
            w * other.iter().zip(&of_knots[k * free..]).map(|(v, c)| v * c).sum::<f64>()
        };
        one.iter().enumerate().map(row).sum()
    };
    Some(Points {
        at: (0..number).map(|k| (place(k), value(k))).collect(),
        covariance: (0..number * number).map(|k| between((k / number, k % number))).collect(),
    })
}

/// How many times as many points as knots show a curve.
const FINER_POINTS: usize = 2;

/// Weights of `n` equally spaced knots in a smooth curve through their values at a place between 0 and `n - 1`: those of
/// `Effects.knotWeights`, which has the source.
fn knot_weights(place: f64, n: usize) -> Vec<f64> {
    let kernel = |distance: f64| match distance.abs() {
        x if x < 1.0 => 1.0 - x * x * (2.5 - 1.5 * x),
        x if x < 2.0 => 2.0 - x * (4.0 - x * (2.5 - 0.5 * x)),
        _ => 0.0,
    };
    let place = place.clamp(0.0, (n - 1) as f64);
    let mut weights: Vec<f64> = (0..n).map(|k| kernel(place - k as f64)).collect();
    let (before, after) = (kernel(place + 1.0), kernel(place - n as f64));
    weights[0] += 2.0 * before;
    weights[1] -= before;
    weights[n - 1] += 2.0 * after;
    weights[n - 2] -= after;
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitened_errors_are_independent() {
        let covariance = vec![4.0, 1.0, 0.5, 1.0, 9.0, -2.0, 0.5, -2.0, 1.0];
        let at = vec![(0.0, 0.0); 3];
        let points = Points { at, covariance: covariance.clone() };
        let error = 0.1;
        let w = points.whitening(error);
        let total =
            |i: usize, j: usize| covariance[3 * i + j] + if i == j { error * error } else { 0.0 };
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            let pairs = (0..9).map(|k| (k / 3, k % 3));
            let whitened: f64 = pairs.map(|(k, l)| w[3 * i + k] * total(k, l) * w[3 * j + l]).sum();
            assert!((whitened - f64::from(i == j)).abs() < 1e-12, "{i} {j}: {whitened}");
        }
    }

    #[test]
    fn a_point_without_error_weighs_more_than_the_others() {
        let mut points = Points { at: vec![(1.0, 2.0)], covariance: vec![4.0] };
        points.add_known((0.0, 0.0));
        assert_eq!(points.covariance, [4.0, 0.0, 0.0, 0.0]);
        let w = points.whitening(0.5);
        assert!((w[3] - 2.0).abs() < 1e-12 && (w[0] - 1.0 / 4.25f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_curve_through_knots_meets_them_and_keeps_a_line() {
        for (place, n) in [(0.0, 5), (0.3, 5), (2.0, 5), (3.9, 5), (4.0, 5), (0.5, 3), (9.7, 11)] {
            let weights = knot_weights(place, n);
            let of = |f: &dyn Fn(f64) -> f64| -> f64 {
                weights.iter().enumerate().map(|(k, w)| w * f(k as f64)).sum()
            };
            assert!((of(&|_| 1.0) - 1.0).abs() < 1e-12);
            assert!((of(&|k| 3.0 * k - 1.0) - (3.0 * place - 1.0)).abs() < 1e-12);
        }
        assert_eq!(knot_weights(2.0, 4), [0.0, 0.0, 1.0, 0.0]);
    }
}
