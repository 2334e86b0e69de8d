//! Square systems with a singular matrix: the solution nearest to the previous one, if there is
//! any.
//!
//! Complete orthogonal decomposition: Householder reflections from the left with column exchanges
//! reveal the rank, reflections from the right eliminate the remainder of the dependent columns.
//! Golub & Van Loan, *Matrix Computations*, 4th ed. 2013, algorithm 5.4.1 and section 5.4.7. Rows
//! and columns are scaled first, so that the rank does not depend on units; distances are measured
//! in these scales.

/// Relative size, per order of the matrix, below which a pivot counts as zero.
const ZERO_PIVOT: f64 = 1e-13;
/// Residuals up to this fraction of the largest term count as zero.
const CONSISTENT: f64 = 1e-9;
/// Terms smaller than this are the rounding of larger terms that were eliminated before.
const SMALLEST_TERM: f64 = 1e-3;

/// The decomposition of a square matrix.
#[derive(Clone, Debug)]
pub struct PseudoInverse {
    n: usize,
    /// The scaled matrix, column-major, for the test of consistency.
    scaled: Vec<f64>,
    /// The triangle, and below it the vectors of the reflections from the left.
    factors: Vec<f64>,
    left: Vec<f64>,
    /// Vectors of the reflections from the right, each of the length `n - rank`.
    tails: Vec<f64>,
    right: Vec<f64>,
    /// The column of the matrix at each position.
    order: Vec<usize>,
    rows: Vec<f64>,
    columns: Vec<f64>,
    rank: usize,
}

impl PseudoInverse {
    /// Decomposes the column-major matrix `a` of order `n`; `None` if an entry is not finite.
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
        let mut inverse = PseudoInverse {
            n,
            factors: scaled.clone(),
            scaled,
            left: vec![0.0; n],
            tails: Vec::new(),
            right: Vec::new(),
            order: (0..n).collect(),
            rows,
            columns,
            rank: 0,
        };
        inverse.reflect_from_left();
        inverse.reflect_from_right();
        Some(inverse)
    }

    fn reflect_from_left(&mut self) {
        let n = self.n;
        let a = &mut self.factors;
        for k in 0..n {
            let size = |a: &[f64], j: usize| norm(&a[k + n * j..n * (j + 1)]);
            let pivot = (k..n).fold(k, |p, j| if size(a, j) > size(a, p) { j } else { p });
            if pivot != k {
                for i in 0..n {
                    a.swap(i + n * k, i + n * pivot);
                }
                self.order.swap(k, pivot);
            }
            let length = size(a, k);
            if length <= ZERO_PIVOT * n as f64 * a[0].abs() && k > 0 || length == 0.0 {
                return;
            }
            self.rank = k + 1;
            // v = x - beta e, scaled to v_k = 1; H = I - tau v v^T.
            let alpha = a[k + n * k];
            let beta = -alpha.signum() * length;
            self.left[k] = (beta - alpha) / beta;
            for i in k + 1..n {
                a[i + n * k] /= alpha - beta;
            }
            a[k + n * k] = beta;
            for j in k + 1..n {
                let along: f64 = (k + 1..n).map(|i| a[i + n * k] * a[i + n * j]).sum();
                let t = self.left[k] * (a[k + n * j] + along);
                a[k + n * j] -= t;
                for i in k + 1..n {
                    a[i + n * j] -= t * a[i + n * k];
                }
            }
        }
    }

    fn reflect_from_right(&mut self) {
        let (n, r) = (self.n, self.rank);
        let m = n - r;
        self.tails = vec![0.0; r * m];
        self.right = vec![0.0; r];
        if m == 0 {
            return;
        }
        let a = &mut self.factors;
        for i in (0..r).rev() {
            let tail: Vec<f64> = (r..n).map(|j| a[i + n * j]).collect();
            let rest = norm(&tail);
            if rest == 0.0 {
                continue;
            }
            let alpha = a[i + n * i];
            let beta = -alpha.signum() * alpha.hypot(rest);
            self.right[i] = (beta - alpha) / beta;
            let v = &mut self.tails[m * i..m * (i + 1)];
            for (v, x) in v.iter_mut().zip(&tail) {
                *v = x / (alpha - beta);
            }
            a[i + n * i] = beta;
            for row in 0..i {
                let along: f64 = (0..m).map(|j| a[row + n * (r + j)] * v[j]).sum();
                let t = self.right[i] * (a[row + n * i] + along);
                a[row + n * i] -= t;
                for j in 0..m {
                    a[row + n * (r + j)] -= t * v[j];
                }
            }
        }
    }

    /// Number of independent equations.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// The shortest vector that minimizes the residual of the scaled equations.
    fn shortest(&self, right: &[f64]) -> Vec<f64> {
        let (n, r, a) = (self.n, self.rank, &self.factors);
        let mut w = right.to_vec();
        for k in 0..r {
            let along: f64 = (k + 1..n).map(|i| a[i + n * k] * w[i]).sum();
            let t = self.left[k] * (w[k] + along);
            w[k] -= t;
            for i in k + 1..n {
                w[i] -= t * a[i + n * k];
            }
        }
        for k in (0..r).rev() {
            let known: f64 = (k + 1..r).map(|j| a[k + n * j] * w[j]).sum();
            w[k] = (w[k] - known) / a[k + n * k];
        }
        w[r..].fill(0.0);
        let m = n - r;
        for i in 0..r {
            let v = &self.tails[m * i..m * (i + 1)];
            let along: f64 = v.iter().zip(&w[r..]).map(|(v, w)| v * w).sum();
            let t = self.right[i] * (w[i] + along);
            w[i] -= t;
            for (w, v) in w[r..].iter_mut().zip(v) {
                *w -= t * v;
            }
        }
        let mut x = vec![0.0; n];
        for (w, at) in w.iter().zip(&self.order) {
            x[*at] = *w;
        }
        x
    }

    /// Overwrites the right-hand side `b` with the solution nearest to `last`; false if no vector
    /// satisfies all equations, in which case `b` is a least-squares solution.
    pub fn solve_near(&self, b: &mut [f64], last: &[f64]) -> bool {
        let n = self.n;
        let before: Vec<f64> = last.iter().zip(&self.columns).map(|(x, c)| x / c).collect();
        let mut right: Vec<f64> = b.iter().zip(&self.rows).map(|(b, r)| b * r).collect();
        let mut size = [&before, &right].iter().flat_map(|v| v.iter()).fold(SMALLEST_TERM, largest);
        for (column, before) in self.scaled.chunks_exact(n.max(1)).zip(&before) {
            for (right, a) in right.iter_mut().zip(column) {
                *right -= a * before;
            }
        }
        let x = self.shortest(&right);
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

    /// Overwrites the right-hand side `b` with the solution nearest to zero, like
    /// [`PseudoInverse::solve_near`].
    pub fn solve_in_place(&self, b: &mut [f64]) -> bool {
        self.solve_near(b, &vec![0.0; self.n])
    }
}

fn largest(m: f64, x: &f64) -> f64 {
    m.max(x.abs())
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
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
    fn the_shortest_of_many_solutions_is_found() {
        // x + y = 2 twice: (1, 1) is nearest to zero.
        let inverse = PseudoInverse::new(2, &[1.0, 1.0, 1.0, 1.0]).unwrap();
        let mut b = [2.0, 2.0];
        assert!(inverse.solve_in_place(&mut b));
        assert!((b[0] - 1.0).abs() < 1e-14 && (b[1] - 1.0).abs() < 1e-14);
        assert_eq!(inverse.rank(), 1);
    }

    #[test]
    fn contradictions_are_detected() {
        let inverse = PseudoInverse::new(2, &[1.0, 1.0, 1.0, 1.0]).unwrap();
        assert!(!inverse.solve_in_place(&mut [2.0, 3.0]));
        // Undetermined components stay: for x + y = 2 this is x - y = 4.
        let mut b = [2.0, 2.0];
        assert!(inverse.solve_near(&mut b, &[5.0, 1.0]));
        assert!((b[0] - 3.0).abs() < 1e-14 && (b[1] + 1.0).abs() < 1e-14);
        let zero = PseudoInverse::new(1, &[0.0]).unwrap();
        assert!(!zero.solve_in_place(&mut [1.0]));
        assert!(zero.solve_in_place(&mut [0.0]));
    }

    #[test]
    fn units_do_not_decide_the_rank() {
        // An equation in 1e-12 A/V counts as much as one in 1e9 V/A.
        let inverse = PseudoInverse::new(2, &[1e-12, 0.0, 0.0, 1e9]).unwrap();
        assert_eq!(inverse.rank(), 2);
        let mut b = [3e-12, 2e9];
        assert!(inverse.solve_in_place(&mut b));
        assert!((b[0] - 3.0).abs() < 1e-13 && (b[1] - 2.0).abs() < 1e-13);
    }

    /// Two of the four Penrose conditions, which suffice here, for the matrix of rank 2 with the
    /// rows (1 2 3; 4 5 6; 7 8 9).
    #[test]
    fn the_residual_is_orthogonal() {
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
