//! The null space of a square matrix whose entries are exact: which unknowns a singular system of
//! equations leaves undetermined, and which combinations of its equations vanish.
//!
//! Gaussian elimination with complete pivoting (Golub & Van Loan, *Matrix Computations*, 4th ed.
//! 2013, section 3.4.8). Differences that are within rounding of their terms count as zero, so the
//! rank depends neither on units nor on a tolerance.

/// Differences below this fraction of the larger term are rounding errors.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Bases of both null spaces.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct NullSpace {
    /// Vectors `x` with `A x = 0`.
    pub right: Vec<Vec<f64>>,
    /// Vectors `w` with `w A = 0`.
    pub left: Vec<Vec<f64>>,
}

impl NullSpace {
    /// The null spaces of a matrix, given by rows; both are empty if it is regular.
    pub fn of(matrix: &[Vec<f64>]) -> NullSpace {
        let mut elimination = Elimination::new(matrix);
        let rank = elimination.eliminate();
        NullSpace { right: elimination.right(rank), left: elimination.left(rank) }
    }
}

struct Elimination {
    n: usize,
    /// The scaled matrix, followed in each row by the combination of rows that it is.
    rows: Vec<Vec<f64>>,
    /// The column of the matrix at each position.
    order: Vec<usize>,
    row_scale: Vec<f64>,
    column_scale: Vec<f64>,
}

impl Elimination {
    fn new(matrix: &[Vec<f64>]) -> Elimination {
        let n = matrix.len();
        let scale = |values: &mut dyn Iterator<Item = f64>| {
            let largest = values.fold(0.0, |m: f64, x| m.max(x.abs()));
            // A power of two scales without rounding.
            if largest > 0.0 { (-largest.log2().round()).exp2() } else { 1.0 }
        };
        let row_scale: Vec<f64> =
            matrix.iter().map(|row| scale(&mut row.iter().copied())).collect();
        let scaled = |i: usize, j: usize| matrix[i][j] * row_scale[i];
        let column_scale: Vec<f64> =
            (0..n).map(|j| scale(&mut (0..n).map(|i| scaled(i, j)))).collect();
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let row = |i: usize| {
            let entries = (0..n).map(|j| scaled(i, j) * column_scale[j]);
            entries.chain((0..n).map(|j| unit(i, j))).collect()
        };
        let rows = (0..n).map(row).collect();
        Elimination { n, rows, order: (0..n).collect(), row_scale, column_scale }
    }

    /// Brings the matrix to upper triangular form and returns its rank.
    fn eliminate(&mut self) -> usize {
        for k in 0..self.n {
            let (i, j) = self.largest(k);
            if self.rows[i][j] == 0.0 {
                return k;
            }
            self.rows.swap(k, i);
            self.order.swap(k, j);
            for row in &mut self.rows {
                row.swap(k, j);
            }
            let (above, below) = self.rows.split_at_mut(k + 1);
            let pivot = &above[k];
            for row in below {
                let factor = row[k] / pivot[k];
                if factor == 0.0 {
                    continue;
                }
                row[k] = 0.0;
                for (x, p) in row[k + 1..].iter_mut().zip(&pivot[k + 1..]) {
                    *x = difference(*x, factor * p);
                }
            }
        }
        self.n
    }

    /// The place of the largest entry that is not eliminated yet.
    fn largest(&self, k: usize) -> (usize, usize) {
        let mut best = (k, k);
        for i in k..self.n {
            for j in k..self.n {
                if self.rows[i][j].abs() > self.rows[best.0][best.1].abs() {
                    best = (i, j);
                }
            }
        }
        best
    }

    fn right(&self, rank: usize) -> Vec<Vec<f64>> {
        let vector = |free: usize| {
            let mut x = vec![0.0; self.n];
            x[free] = 1.0;
            for i in (0..rank).rev() {
                let row = &self.rows[i];
                let sum = (i + 1..self.n).fold(0.0, |sum, j| difference(sum, row[j] * x[j]));
                x[i] = sum / row[i];
            }
            let mut placed = vec![0.0; self.n];
            for (position, &column) in self.order.iter().enumerate() {
                placed[column] = x[position] * self.column_scale[column];
            }
            placed
        };
        (rank..self.n).map(vector).collect()
    }

    fn left(&self, rank: usize) -> Vec<Vec<f64>> {
        let scaled = |row: &Vec<f64>| {
            row[self.n..].iter().zip(&self.row_scale).map(|(w, scale)| w * scale).collect()
        };
        self.rows[rank..].iter().map(scaled).collect()
    }
}

/// `a - b`, where the rounding errors of equal terms are zero.
fn difference(a: f64, b: f64) -> f64 {
    let d = a - b;
    if d.abs() <= ROUNDING * a.abs().max(b.abs()) { 0.0 } else { d }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_matrix_has_no_null_space() {
        assert_eq!(NullSpace::of(&[vec![1.0, 2.0], vec![3.0, 4.0]]), NullSpace::default());
        let ill_scaled = [vec![1e-9, 1.0], vec![-1.0, 1e9 + 1.0]];
        assert_eq!(NullSpace::of(&ill_scaled), NullSpace::default());
    }

    #[test]
    fn null_vectors_solve_the_equations() {
        let a = [vec![1.0, 1.0, 0.0], vec![0.3, 0.3, 0.0], vec![0.0, 2.0, 1e6]];
        let found = NullSpace::of(&a);
        let (x, w) = (&found.right[0], &found.left[0]);
        assert_eq!((found.right.len(), found.left.len()), (1, 1));
        for row in &a {
            let product: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
            assert!(product.abs() < 1e-12, "{x:?}");
        }
        for j in 0..3 {
            let product: f64 = a.iter().zip(w).map(|(row, w)| row[j] * w).sum();
            assert!(product.abs() < 1e-12, "{w:?}");
        }
        assert!(x.iter().all(|x| *x != 0.0) && w[2] == 0.0);
    }

    #[test]
    fn rounding_errors_do_not_make_a_matrix_regular() {
        // 0.1*3 is not 0.3.
        let found = NullSpace::of(&[vec![0.1, 0.3], vec![1.0, 3.0]]);
        assert_eq!(found.right.len(), 1);
        assert_eq!(NullSpace::of(&[vec![0.0]]).right, [vec![1.0]]);
    }
}
