//! Square systems whose matrix is singular: the solution nearest to zero, where there is one.
//!
//! Singular value decomposition by one-sided Jacobi rotations: M. R. Hestenes, "Inversion of matrices
//! by biorthogonalization and related results", J. SIAM 6, 1958; Golub & Van Loan, *Matrix
//! Computations*, 4th ed. 2013, sections 5.5.2 (pseudo-inverse) and 8.6.3. Rows and columns are scaled
//! first, so that units do not decide what counts as nothing: nearest means nearest in these scales.

/// Singular values below this part of the largest count as zero, times the order.
const NOTHING: f64 = 1e-13;
/// Residuals up to this part of the largest term count as zero.
const CONSISTENT: f64 = 1e-9;
/// Sweeps of rotations; a handful is enough for convergence, which is quadratic.
const SWEEPS: usize = 60;

/// The pseudo-inverse of a square matrix.
#[derive(Clone, Debug)]
pub struct PseudoInverse {
    n: usize,
    /// The scaled matrix, column-major, for the test of consistency.
    scaled: Vec<f64>,
    inverse: Vec<f64>,
    rows: Vec<f64>,
    columns: Vec<f64>,
    rank: usize,
}

impl PseudoInverse {
    /// Of the column-major matrix `a` of order `n`; `None` if one of its entries is not finite.
    pub fn new(n: usize, a: &[f64]) -> Option<PseudoInverse> {
        if !a.iter().all(|x| x.is_finite()) {
            return None;
        }
        let unit = |values: &mut dyn Iterator<Item = f64>| {
            let m = values.fold(0.0, |m, x| largest(m, &x));
            if m > 0.0 { 1.0 / m } else { 1.0 }
        };
        let rows: Vec<f64> = (0..n).map(|i| unit(&mut (0..n).map(|j| a[i + n * j]))).collect();
        let mut scaled: Vec<f64> = (0..n * n).map(|k| a[k] * rows[k % n]).collect();
        let columns: Vec<f64> =
            (0..n).map(|j| unit(&mut scaled[n * j..n * (j + 1)].iter().copied())).collect();
        for (k, x) in scaled.iter_mut().enumerate() {
            *x *= columns[k / n];
        }
        // U S = scaled V
        let (mut us, mut v) = (scaled.clone(), vec![0.0; n * n]);
        (0..n).for_each(|i| v[i + n * i] = 1.0);
        for _ in 0..SWEEPS {
            if !rotate_all(n, &mut us, &mut v) {
                break;
            }
        }
        let squares: Vec<f64> =
            us.chunks_exact(n).map(|c| c.iter().map(|x| x * x).sum::<f64>()).collect();
        let most = squares.iter().fold(0.0, |m: f64, s| m.max(*s)).sqrt();
        let mut inverse = vec![0.0; n * n];
        let mut rank = 0;
        for (k, square) in squares.iter().enumerate() {
            if square.sqrt() <= NOTHING * n as f64 * most {
                continue;
            }
            rank += 1;
            // v_k u_k^T / s_k, where column k of `us` is u_k s_k.
            for j in 0..n {
                let part = us[j + n * k] / square;
                for i in 0..n {
                    inverse[i + n * j] += v[i + n * k] * part;
                }
            }
        }
        Some(PseudoInverse { n, scaled, inverse, rows, columns, rank })
    }

    /// How many equations are independent.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Overwrites the right side `b` by the solution nearest to `last`; false if no vector satisfies all
    /// equations, and `b` is then one that does as well as can be.
    pub fn solve_near(&self, b: &mut [f64], last: &[f64]) -> bool {
        let n = self.n;
        let before: Vec<f64> = last.iter().zip(&self.columns).map(|(x, c)| x / c).collect();
        let mut right: Vec<f64> = b.iter().zip(&self.rows).map(|(b, r)| b * r).collect();
        let mut size = [&before, &right].iter().flat_map(|v| v.iter()).fold(0.0, largest);
        for j in 0..n {
            for i in 0..n {
                right[i] -= self.scaled[i + n * j] * before[j];
            }
        }
        let mut x = vec![0.0; n];
        for j in 0..n {
            for i in 0..n {
                x[i] += self.inverse[i + n * j] * right[j];
            }
        }
        size = x.iter().fold(size, largest);
        let solved = (0..n).all(|i| {
            let sum: f64 = (0..n).map(|j| self.scaled[i + n * j] * x[j]).sum();
            (sum - right[i]).abs() <= CONSISTENT * size
        });
        for (j, b) in b.iter_mut().enumerate() {
            *b = (before[j] + x[j]) * self.columns[j];
        }
        solved
    }

    /// Overwrites the right side `b` by the solution nearest to zero, as [`PseudoInverse::solve_near`].
    pub fn solve_in_place(&self, b: &mut [f64]) -> bool {
        self.solve_near(b, &vec![0.0; self.n])
    }
}

fn largest(m: f64, x: &f64) -> f64 {
    m.max(x.abs())
}

/// Makes all pairs of columns of `us` orthogonal; false if they were.
fn rotate_all(n: usize, us: &mut [f64], v: &mut [f64]) -> bool {
    let mut turned = false;
    for p in 0..n {
        for q in p + 1..n {
            let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
            for i in 0..n {
                let (x, y) = (us[i + n * p], us[i + n * q]);
                (aa, bb, ab) = (aa + x * x, bb + y * y, ab + x * y);
            }
            if !(ab.abs() > f64::EPSILON * (aa * bb).sqrt()) || ab.abs() < f64::MIN_POSITIVE {
                continue;
            }
            turned = true;
            let zeta = (bb - aa) / (2.0 * ab);
            let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = c * t;
            for m in [&mut *us, &mut *v] {
                for i in 0..n {
                    let (x, y) = (m[i + n * p], m[i + n * q]);
                    m[i + n * p] = c * x - s * y;
                    m[i + n * q] = s * x + c * y;
                }
            }
        }
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_matrix_is_inverted() {
        // Columns (2, 1) and (1, 3): the inverse is (3, -1; -1, 2) / 5.
        let inverse = PseudoInverse::new(2, &[2.0, 1.0, 1.0, 3.0]).unwrap();
        let mut b = [5.0, 10.0];
        assert!(inverse.solve_in_place(&mut b));
        assert!((b[0] - 1.0).abs() < 1e-14 && (b[1] - 3.0).abs() < 1e-14);
        assert_eq!(inverse.rank(), 2);
    }

    #[test]
    fn of_many_solutions_the_shortest() {
        // x + y = 2 twice: (1, 1) is nearest to zero.
        let inverse = PseudoInverse::new(2, &[1.0, 1.0, 1.0, 1.0]).unwrap();
        let mut b = [2.0, 2.0];
        assert!(inverse.solve_in_place(&mut b));
        assert!((b[0] - 1.0).abs() < 1e-14 && (b[1] - 1.0).abs() < 1e-14);
        assert_eq!(inverse.rank(), 1);
    }

    #[test]
    fn contradictions_are_seen() {
        let inverse = PseudoInverse::new(2, &[1.0, 1.0, 1.0, 1.0]).unwrap();
        assert!(!inverse.solve_in_place(&mut [2.0, 3.0]));
        // What is left open stays: of x + y = 2 that is x - y = 4.
        let mut b = [2.0, 2.0];
        assert!(inverse.solve_near(&mut b, &[5.0, 1.0]));
        assert!((b[0] - 3.0).abs() < 1e-14 && (b[1] + 1.0).abs() < 1e-14);
        let nothing = PseudoInverse::new(1, &[0.0]).unwrap();
        assert!(!nothing.solve_in_place(&mut [1.0]));
        assert!(nothing.solve_in_place(&mut [0.0]));
    }

    #[test]
    fn units_do_not_decide_the_rank() {
        // 1e-12 A/V beside 1e9 V/A is as good an equation as any.
        let inverse = PseudoInverse::new(2, &[1e-12, 0.0, 0.0, 1e9]).unwrap();
        assert_eq!(inverse.rank(), 2);
        let mut b = [3e-12, 2e9];
        assert!(inverse.solve_in_place(&mut b));
        assert!((b[0] - 3.0).abs() < 1e-13 && (b[1] - 2.0).abs() < 1e-13);
    }

    /// The four conditions of Penrose, of which two are enough here, for the matrix of rank 2 with the
    /// rows (1 2 3; 4 5 6; 7 8 9).
    #[test]
    fn what_is_left_is_orthogonal() {
        let a = [1.0, 4.0, 7.0, 2.0, 5.0, 8.0, 3.0, 6.0, 9.0];
        let inverse = PseudoInverse::new(3, &a).unwrap();
        assert_eq!(inverse.rank(), 2);
        let mut b = [6.0, 15.0, 24.0];
        assert!(inverse.solve_in_place(&mut b));
        let row = |i: usize| (0..3).map(|j| a[i + 3 * j] * b[j]).sum::<f64>();
        for (i, wanted) in [6.0, 15.0, 24.0].into_iter().enumerate() {
            assert!((row(i) - wanted).abs() < 1e-12);
        }
    }
}
