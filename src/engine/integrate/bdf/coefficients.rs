//! Coefficients of the formula of a given order on a variable grid: the corrector polynomial and
//! the constants of the error tests.
//!
//! K. R. Jackson, R. Sacks-Davis, *An alternative implementation of variable step-size multistep
//! formulas for stiff ODEs*, ACM Trans. Math. Softw. 6 (1980), 295-318 (fixed leading coefficient);
//! G. D. Byrne, A. C. Hindmarsh, *A polyalgorithm for the numerical solution of ordinary
//! differential equations*, same journal 1 (1975), 71-96 (error constants on a variable grid, eq.
//! (2.19) ff.); A. C. Hindmarsh et al., *SUNDIALS*, same journal 31 (2005), 363-396, sec. 2.1.

/// Highest order: the formula of order 6 is hardly stable.
pub const MAX_ORDER: usize = 5;

/// The lengths of the last steps, latest first.
pub type Steps = [f64; MAX_ORDER + 1];

/// The formula of one step.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Coefficients {
    /// The corrector polynomial in `(t - t_n) / h`, one at zero: the change of each scaled
    /// derivative per correction.
    pub l: [f64; MAX_ORDER + 1],
    /// Local error per correction.
    pub error: f64,
    /// Local error of the next lower order per highest scaled derivative.
    pub error_lower: f64,
    /// Local error of the next higher order per difference of two corrections.
    pub error_higher: f64,
    /// Scale factor that makes corrections of different steps comparable.
    pub comparison: f64,
}

/// Cache of the last formula, valid while order and step are unchanged.
#[derive(Clone, Copy, Default)]
pub struct Formula {
    last: Option<((usize, f64, Steps), Coefficients)>,
}

impl Formula {
    /// As [`coefficients`].
    pub fn of(&mut self, q: usize, h: f64, steps: &Steps) -> Coefficients {
        let wanted = (q, h, *steps);
        match self.last {
            Some((key, formula)) if key == wanted => formula,
            _ => {
                let formula = coefficients(q, h, steps);
                self.last = Some((wanted, formula));
                formula
            }
        }
    }
}

/// The formula of order `q` (1 to 5) for a step of length `h` after these steps. `l` has the roots
/// `-1` and the distances of the earlier points, except for the oldest, which is moved so that
/// `l_1` is that of equal steps: `1 + 1/2 + ... + 1/q`.
pub fn coefficients(q: usize, h: f64, steps: &Steps) -> Coefficients {
    let mut l = [0.0; MAX_ORDER + 1];
    (l[0], l[1]) = (1.0, 1.0);
    let (mut xi_inverse, mut last_inverse) = (1.0, 1.0);
    let (mut alpha, mut alpha_hat) = (-1.0, -1.0);
    let mut distance = h;
    if q > 1 {
        for j in 2..q {
            distance += steps[j - 2];
            xi_inverse = h / distance;
            alpha -= 1.0 / j as f64;
            raise(&mut l, j, xi_inverse);
        }
        alpha -= 1.0 / q as f64;
        last_inverse = -l[1] - alpha;
        distance += steps[q - 2];
        xi_inverse = h / distance;
        alpha_hat = -l[1] - xi_inverse;
        raise(&mut l, q, last_inverse);
    }
    let order = q as f64;
    let a1 = 1.0 - alpha_hat + alpha;
    let a2 = 1.0 + order * a1;
    let error_lower = if q > 1 {
        let (a3, a4) = (alpha + 1.0 / order, alpha_hat + xi_inverse);
        (last_inverse / l[q] * (1.0 - a4 + a3) / a3).abs()
    } else {
        1.0
    };
    let comparison = (a2 * last_inverse / (l[q] * xi_inverse)).abs();
    let next_inverse = h / (distance + steps[q - 1]);
    let (a5, a6) = (alpha - 1.0 / (order + 1.0), alpha_hat - next_inverse);
    let error_higher = ((1.0 - a6 + a5) / a2 / (next_inverse * (order + 2.0) * a5)).abs();
    Coefficients { l, error: (a1 / (alpha * a2)).abs(), error_lower, error_higher, comparison }
}

/// Multiplies the polynomial of degree `j - 1` by `1 + x * root_inverse`.
fn raise(l: &mut [f64; MAX_ORDER + 1], j: usize, root_inverse: f64) {
    for i in (1..=j).rev() {
        l[i] += l[i - 1] * root_inverse;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a grid of equal steps these are the formulas of Gear, in scaled derivatives; Hairer,
    /// Nørsett & Wanner I, sec. III.6, table 6.2, divided by its second column.
    #[test]
    fn equal_steps_give_the_classical_formulas() {
        let gear = [
            vec![1.0, 1.0],
            vec![2.0 / 3.0, 1.0, 1.0 / 3.0],
            vec![6.0 / 11.0, 1.0, 6.0 / 11.0, 1.0 / 11.0],
            vec![24.0 / 50.0, 1.0, 35.0 / 50.0, 10.0 / 50.0, 1.0 / 50.0],
            vec![120.0 / 274.0, 1.0, 225.0 / 274.0, 85.0 / 274.0, 15.0 / 274.0, 1.0 / 274.0],
        ];
        for (q, expected) in (1..).zip(gear) {
            let c = coefficients(q, 0.3, &[0.3; 6]);
            for (l, expected) in c.l.iter().zip(&expected) {
                assert!((l / c.l[1] - expected).abs() < 1e-14, "order {q}: {:?}", c.l);
            }
            // The error constant 1/(q+1), sec. III.2, table 2.2 of the same, for a correction that
            // is the difference of order q+1 divided by l_1.
            let constant = 1.0 / (q as f64 + 1.0) / c.l[1];
            assert!((c.error - constant).abs() < 1e-14, "order {q}: {}", c.error);
        }
    }

    /// The leading coefficient does not depend on the grid, and `l` vanishes at the point before.
    #[test]
    fn the_leading_coefficient_is_fixed() {
        let steps = [0.1, 0.4, 0.2, 0.3, 0.7, 0.1];
        for q in 1..=MAX_ORDER {
            let l = coefficients(q, 0.25, &steps).l;
            let harmonic: f64 = (1..=q).map(|j| 1.0 / j as f64).sum();
            assert!((l[1] - harmonic).abs() < 1e-14);
            let before: f64 = l.iter().rev().fold(0.0, |sum, l| l - sum);
            assert!(before.abs() < 1e-14, "order {q}: {before}");
        }
    }
}
