//! The memory of a multistep method: a polynomial through the last points, as its scaled
//! derivatives `h^j y^(j) / j!` at the latest one.
//!
//! A. Nordsieck, *On numerical integration of ordinary differential equations*, Math. Comp. 16
//! (1962), 22-49; Hairer, Nørsett & Wanner I, sec. III.6. Changes of order on a variable grid:
//! Byrne & Hindmarsh 1975 as in `coefficients`.

use crate::integrate::bdf::coefficients::{Coefficients, MAX_ORDER, Steps};

/// Scaled derivatives of one component; zero above the order. Stored contiguously because all
/// operations are component-wise.
type Row = [f64; MAX_ORDER + 1];

/// The array.
#[derive(Clone)]
pub struct Nordsieck {
    /// Order of the polynomial, 1 to 5.
    pub order: usize,
    /// The step that the derivatives are scaled by.
    pub h: f64,
    /// Lengths of the steps between the points on the polynomial.
    pub steps: Steps,
    rows: Vec<Row>,
}

impl Nordsieck {
    /// For `n` components.
    pub fn new(n: usize) -> Self {
        let steps = [1.0; MAX_ORDER + 1];
        Nordsieck { order: 1, h: 1.0, steps, rows: vec![[0.0; MAX_ORDER + 1]; n] }
    }

    /// The straight line through `y` with these slopes, scaled by `h`.
    pub fn start(&mut self, h: f64, y: &[f64], slopes: impl Iterator<Item = f64>) {
        self.order = 1;
        self.h = h;
        self.steps = [h; MAX_ORDER + 1];
        for ((row, y), slope) in self.rows.iter_mut().zip(y).zip(slopes) {
            *row = [0.0; MAX_ORDER + 1];
            row[0] = *y;
            row[1] = h * slope;
        }
    }

    /// The constant `y` at any time.
    pub fn start_constant(&mut self, y: &[f64]) {
        self.start(1.0, y, std::iter::repeat(0.0));
    }

    /// Becomes the straight line that touches the polynomial.
    pub fn flatten(&mut self) {
        self.order = 1;
        self.steps = [self.h; MAX_ORDER + 1];
        for row in &mut self.rows {
            row[2..].fill(0.0);
        }
    }

    /// Becomes the continuation of `from` to the end of a step of length `h`, and writes the values
    /// there to `y`.
    pub fn predict(&mut self, from: &Nordsieck, h: f64, y: &mut [f64]) {
        let ratio = h / from.h;
        self.order = from.order;
        self.h = h;
        self.steps = from.steps;
        for ((to, from), y) in self.rows.iter_mut().zip(&from.rows).zip(y) {
            let mut row = *from;
            if ratio != 1.0 {
                let mut power = ratio;
                for derivative in &mut row[1..] {
                    *derivative *= power;
                    power *= ratio;
                }
            }
            for first in 0..MAX_ORDER {
                for j in (first..MAX_ORDER).rev() {
                    row[j] += row[j + 1];
                }
            }
            *y = row[0];
            *to = row;
        }
    }

    /// The scaled slopes.
    pub fn slopes(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().map(|row| row[1])
    }

    /// The values.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().map(|row| row[0])
    }

    /// The highest scaled derivative of the order.
    pub fn highest(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().map(|row| row[self.order])
    }

    /// Adds the corrections of a step and counts it. `y` is the solution at its end.
    pub fn correct(&mut self, c: &Coefficients, corrections: &[f64], y: &[f64]) {
        for ((row, correction), y) in self.rows.iter_mut().zip(corrections).zip(y) {
            for (derivative, l) in row.iter_mut().zip(&c.l) {
                *derivative += l * correction;
            }
            row[0] = *y;
        }
        self.steps.copy_within(..MAX_ORDER, 1);
        self.steps[0] = self.h;
    }

    /// Raises the order by one, by the corrections of the last step.
    pub fn raise(&mut self, corrections: &[f64]) {
        let q = self.order;
        let mut l = [0.0; MAX_ORDER + 2];
        l[2] = 1.0;
        let (mut alpha0, mut alpha1, mut product, mut last) = (-1.0, 1.0, 1.0, 1.0);
        let mut distance = self.h;
        for j in 1..q {
            distance += self.steps[j];
            let xi = distance / self.h;
            product *= xi;
            alpha0 -= 1.0 / (j as f64 + 1.0);
            alpha1 += 1.0 / xi;
            for i in (2..=j + 2).rev() {
                l[i] = l[i] * last + l[i - 1];
            }
            last = xi;
        }
        let factor = (-alpha0 - alpha1) / product;
        for (row, correction) in self.rows.iter_mut().zip(corrections) {
            let highest = factor * correction;
            row[q + 1] = highest;
            for (derivative, l) in row[2..=q].iter_mut().zip(&l[2..]) {
                *derivative += l * highest;
            }
        }
        self.order += 1;
    }

    /// Lowers the order by one: drops the oldest point.
    pub fn lower(&mut self) {
        let q = self.order;
        let mut l = [0.0; MAX_ORDER + 2];
        l[2] = 1.0;
        let mut distance = 0.0;
        for j in 1..q - 1 {
            distance += self.steps[j - 1];
            let xi = distance / self.h;
            for i in (2..=j + 2).rev() {
                l[i] = l[i] * xi + l[i - 1];
            }
        }
        for row in &mut self.rows {
            let highest = std::mem::replace(&mut row[q], 0.0);
            for (derivative, l) in row[2..q].iter_mut().zip(&l[2..]) {
                *derivative -= l * highest;
            }
        }
        self.order -= 1;
    }

    /// Writes the values at a distance from the latest point to `out`.
    pub fn evaluate(&self, distance: f64, out: &mut [f64]) {
        let s = distance / self.h;
        for (row, out) in self.rows.iter().zip(out) {
            *out = row.iter().rev().fold(0.0, |sum, derivative| sum * s + derivative);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::bdf::coefficients::coefficients;

    /// Distances of earlier points from the latest one, with unequal steps.
    const STEPS: Steps = [0.1, 0.15, 0.08, 0.2, 0.1, 0.12];

    /// The array of `1 + t + ... + t^q` at zero.
    fn polynomial(q: usize) -> (Nordsieck, impl Fn(f64) -> f64) {
        let mut array = Nordsieck::new(1);
        (array.order, array.h, array.steps) = (q, STEPS[0], STEPS);
        for j in 0..=q {
            array.rows[0][j] = array.h.powi(j as i32);
        }
        (array, move |t: f64| (0..=q).map(|j| t.powi(j as i32)).sum())
    }

    fn value(array: &Nordsieck, t: f64) -> f64 {
        let mut out = [0.0];
        array.evaluate(t, &mut out);
        out[0]
    }

    /// The prediction extrapolates the polynomial. A correction moves the latest point and, after
    /// the order is raised, none of the `q` points before it.
    #[test]
    fn the_raised_polynomial_goes_through_the_points() {
        for q in 1..MAX_ORDER {
            let (array, p) = polynomial(q);
            let (h, mut next, mut y) = (0.13, Nordsieck::new(1), [0.0]);
            next.predict(&array, h, &mut y);
            assert!((y[0] - p(h)).abs() < 1e-14);
            assert!((value(&next, -0.3 * h) - p(0.7 * h)).abs() < 1e-14);
            let formula = coefficients(q, h, &array.steps);
            next.correct(&formula, &[0.5], &[y[0] + 0.5]);
            next.raise(&[0.5]);
            assert!((value(&next, 0.0) - p(h) - 0.5).abs() < 1e-14);
            let mut t = 0.0;
            for step in &STEPS[..q] {
                assert!((value(&next, t - h) - p(t)).abs() < 1e-13, "order {q}, t = {t}");
                t -= step;
            }
        }
    }

    /// The oldest point is dropped; the others, and the latest slope, remain.
    #[test]
    fn the_lowered_polynomial_goes_through_the_other_points() {
        for q in 2..=MAX_ORDER {
            let (mut array, p) = polynomial(q);
            let slope = array.rows[0][1];
            array.lower();
            assert_eq!((array.order, array.rows[0][1]), (q - 1, slope));
            let mut t = 0.0;
            for step in &STEPS[..q - 1] {
                assert!((value(&array, t) - p(t)).abs() < 1e-14, "order {q}, t = {t}");
                t -= step;
            }
        }
    }
}
