//! The collocation polynomial of the last step: dense output, and the guess for the next stages.

use crate::integrate::radau::tableau::{C1, C2};
use crate::numeric::norm::weighted_rms;

/// The polynomial through the start and the three stages of a step, in Newton's form on the nodes
/// `1, c2, c1, 0` (Hairer & Wanner II, sec. IV.8, starting values), raised by one degree with the
/// second stage of the step before.
///
/// The fifth node is needed because the error estimate bounds the cubic for non-stiff components
/// only. The stages of a stiff component are on its slow manifold, far more accurate than the cubic
/// between them, whose error of order `h^4` is not seen by the filtered estimate. With the extra
/// node it is of order `h^5`. Linear invariants hold everywhere on the polynomial, and a component
/// whose stages all equal the start is constant to the bit.
pub struct Polynomial {
    h: f64,
    end: f64,
    /// Divided differences; `c[0]` is the solution at the end.
    c: [Vec<f64>; 4],
    /// Divided difference with the fifth node; zeros without one.
    fifth: Vec<f64>,
}

/// Largest value between the nodes of the product of the distances to the four nodes of the cubic.
const LARGEST_PRODUCT: f64 = 0.018;

impl Polynomial {
    /// A constant polynomial for `n` components.
    pub fn new(n: usize) -> Self {
        let c = std::array::from_fn(|_| vec![0.0; n]);
        Polynomial { h: 1.0, end: 0.0, c, fifth: vec![0.0; n] }
    }

    /// Length of the step.
    pub fn length(&self) -> f64 {
        self.h
    }

    /// The constant `y` around `t`: after a restart.
    pub fn set_constant(&mut self, t: f64, y: &[f64]) {
        self.end = t;
        self.h = 1.0;
        self.c[0].copy_from_slice(y);
        for c in self.c[1..].iter_mut().chain([&mut self.fifth]) {
            c.fill(0.0);
        }
    }

    /// The polynomial of a step of length `h` to `(end, y)`, from the stage increments `z`.
    /// `continued`: the last polynomial belongs to the preceding step.
    pub fn set(&mut self, h: f64, end: f64, y: &[f64], z: &[Vec<f64>; 3], continued: bool) {
        let node = -1.0 - (1.0 - C2) * self.h / h;
        let product = node * (node - (C2 - 1.0)) * (node - (C1 - 1.0)) * (node + 1.0);
        self.end = end;
        self.h = h;
        let n = y.len();
        let [c0, c1, c2, c3] = self.c.each_mut().map(|c| &mut c[..n]);
        let fifth = &mut self.fifth[..n];
        let [z1, z2, z3] = z.each_ref().map(|z| &z[..n]);
        c0.copy_from_slice(y);
        for i in 0..n {
            let (z1, z2, z3) = (z1[i], z2[i], z3[i]);
            // From the end of the last step back to its second stage.
            let before = (C2 - 1.0) * c1[i];
            let last = (z2 - z3) / (C2 - 1.0);
            let middle = (z1 - z2) / (C1 - C2);
            let first = (middle - z1 / C1) / C2;
            c1[i] = last;
            c2[i] = (middle - last) / (C1 - 1.0);
            c3[i] = c2[i] - first;
            fifth[i] = if continued {
                let inner = c2[i] + (node - (C1 - 1.0)) * c3[i];
                let cubic = z3 + node * (c1[i] + (node - (C2 - 1.0)) * inner);
                (before - cubic) / product
            } else {
                0.0
            };
        }
    }

    /// The weighted error of the cubic between its nodes; zero without a fifth node.
    pub fn error_between_nodes(&self, weights: &[f64]) -> f64 {
        LARGEST_PRODUCT * weighted_rms(&self.fifth, weights)
    }

    /// Writes the value at `t` to `out`; at the end it is the solution to the bit.
    pub fn evaluate(&self, t: f64, out: &mut [f64]) {
        self.evaluate_from(0, t, out);
    }

    /// As [`Polynomial::evaluate`], for as many components as `out` has, from `first` on.
    pub fn evaluate_from(&self, first: usize, t: f64, out: &mut [f64]) {
        let s = (t - self.end) / self.h;
        let range = first..first + out.len();
        let [c0, c1, c2, c3] = self.c.each_ref().map(|c| &c[range.clone()]);
        let fifth = &self.fifth[range];
        for (i, out) in out.iter_mut().enumerate() {
            let top = c3[i] + (s + 1.0) * fifth[i];
            *out = c0[i] + s * (c1[i] + (s - (C2 - 1.0)) * (c2[i] + (s - (C1 - 1.0)) * top));
        }
    }

    /// Writes the increments from the end to the stages of a next step of length `h` to `z`, by the
    /// cubic: a higher degree would amplify more outside the step.
    pub fn extrapolate(&self, h: f64, z: &mut [Vec<f64>; 3]) {
        let ratio = h / self.h;
        let [_, c1, c2, c3] = &self.c;
        for (z, c) in z.iter_mut().zip([C1, C2, 1.0]) {
            let s = c * ratio;
            let n = z.len();
            let [c1, c2, c3] = [&c1[..n], &c2[..n], &c3[..n]];
            for (i, z) in z.iter_mut().enumerate() {
                *z = s * (c1[i] + (s - (C2 - 1.0)) * (c2[i] + (s - (C1 - 1.0)) * c3[i]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is reproduced inside the step and beyond it.
    #[test]
    fn reproduces_a_cubic() {
        let p = |t: f64| 1.0 - 2.0 * t + 3.0 * t * t - 0.5 * t * t * t;
        let (start, h) = (0.5, 0.4);
        let end = start + h;
        let z = [C1, C2, 1.0].map(|c| vec![p(start + c * h) - p(start)]);
        let mut polynomial = Polynomial::new(1);
        polynomial.set(h, end, &[p(end)], &z, false);
        let mut out = [0.0];
        for t in [start, 0.6, 0.77, end] {
            polynomial.evaluate(t, &mut out);
            assert!((out[0] - p(t)).abs() < 1e-14, "t = {t}");
        }
        let mut next = std::array::from_fn(|_| vec![0.0]);
        polynomial.extrapolate(0.3, &mut next);
        for (z, c) in next.iter().zip([C1, C2, 1.0]) {
            assert!((z[0] - (p(end + 0.3 * c) - p(end))).abs() < 1e-13);
        }
    }

    /// Two steps over a quartic: the second polynomial reproduces it.
    #[test]
    fn two_steps_reproduce_a_quartic() {
        let p = |t: f64| 1.0 + t - 2.0 * t * t + 3.0 * t.powi(3) - 0.5 * t.powi(4);
        let mut polynomial = Polynomial::new(1);
        for (start, h, continued) in [(0.2, 0.3, false), (0.5, 0.4, true)] {
            let end = start + h;
            let z = [C1, C2, 1.0].map(|c| vec![p(start + c * h) - p(start)]);
            polynomial.set(h, end, &[p(end)], &z, continued);
        }
        let mut out = [0.0];
        for t in [0.5, 0.6, 0.77, 0.9] {
            polynomial.evaluate(t, &mut out);
            assert!((out[0] - p(t)).abs() < 1e-14, "t = {t}: {}", out[0] - p(t));
        }
    }
}
