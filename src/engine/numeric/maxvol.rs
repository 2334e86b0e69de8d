//! The maxvol algorithm: a well-conditioned square submatrix of a wide matrix.
//!
//! S. A. Goreinov, I. V. Oseledets, D. V. Savostyanov, E. E. Tyrtyshnikov, N. L. Zamarashkin, "How
//! to find a good submatrix", in: Matrix Methods: Theory, Algorithms and Applications, 2010: `m`
//! columns `B` of an `m x n` matrix `G` are a good choice if no entry of `B^-1 G` is much larger
//! than one. Exchanging the chosen column of the row of such an entry for the column of the entry
//! multiplies the volume `|det B|` by the entry.

/// Exchanges continue until no entry of `B^-1 G` is larger than this.
const GOOD: f64 = 1.1;
/// Pivots smaller than this, relative to the largest entry of their row, are zero.
const SINGULAR: f64 = 1e-10;

/// A choice of columns and the matrix reduced by it.
#[derive(Clone, Debug)]
pub struct Basis {
    rows: usize,
    columns: usize,
    /// The chosen column of each row.
    chosen: Vec<usize>,
    /// `B^-1 G`, row by row.
    reduced: Vec<f64>,
}

impl Basis {
    /// For matrices of this size, `rows <= columns`, with a choice of `rows` columns.
    pub fn new(rows: usize, columns: usize, chosen: Vec<usize>) -> Basis {
        Basis { rows, columns, chosen, reduced: vec![0.0; rows * columns] }
    }

    /// The chosen columns.
    pub fn chosen(&self) -> &[usize] {
        &self.chosen
    }

    /// Evaluates the choice for the matrix `g`, given row by row, and improves it if an entry of
    /// `B^-1 G` exceeds `limit`. True if the choice changed; it stays if `g` is rank-deficient.
    pub fn improve(&mut self, g: &[f64], limit: f64) -> bool {
        let before = self.chosen.clone();
        if !self.reduce(g, Some(&before)) && !self.reduce(g, None) {
            self.chosen = before;
            return false;
        }
        if self.largest().2 > limit {
            // Each exchange enlarges the volume, so no choice repeats.
            while let (row, column, size) = self.largest()
                && size > GOOD
            {
                self.pivot(row, column);
            }
        }
        let mut new = self.chosen.clone();
        let mut old = before;
        new.sort_unstable();
        old.sort_unstable();
        new != old
    }

    /// Gauss-Jordan elimination with full pivoting among the columns `within`; false if singular.
    fn reduce(&mut self, g: &[f64], within: Option<&[usize]>) -> bool {
        self.reduced.copy_from_slice(g);
        for row in self.reduced.chunks_exact_mut(self.columns) {
            let largest = row.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            if !(largest > 0.0 && largest.is_finite()) {
                return false;
            }
            row.iter_mut().for_each(|x| *x /= largest);
        }
        let mut done = vec![false; self.rows];
        for _ in 0..self.rows {
            let mut best = (0, 0, SINGULAR);
            for row in (0..self.rows).filter(|row| !done[*row]) {
                for column in 0..self.columns {
                    let size = self.reduced[row * self.columns + column].abs();
                    if size > best.2 && within.is_none_or(|within| within.contains(&column)) {
                        best = (row, column, size);
                    }
                }
            }
            let (row, column, size) = best;
            if size <= SINGULAR {
                return false;
            }
            done[row] = true;
            self.pivot(row, column);
        }
        true
    }

    /// Makes `column` the chosen one of `row`.
    fn pivot(&mut self, row: usize, column: usize) {
        let n = self.columns;
        let pivot = self.reduced[row * n + column];
        for x in &mut self.reduced[row * n..(row + 1) * n] {
            *x /= pivot;
        }
        for other in (0..self.rows).filter(|other| *other != row) {
            let factor = self.reduced[other * n + column];
            for j in 0..n {
                self.reduced[other * n + j] -= factor * self.reduced[row * n + j];
            }
        }
        self.chosen[row] = column;
    }

    /// The entry of largest absolute value: row, column, absolute value.
    fn largest(&self) -> (usize, usize, f64) {
        let mut best = (0, 0, 0.0);
        for (i, x) in self.reduced.iter().enumerate() {
            let (row, column) = (i / self.columns, i % self.columns);
            // The chosen columns are those of the identity.
            if x.abs() > best.2 && !self.chosen.contains(&column) {
                best = (row, column, x.abs());
            }
        }
        best
    }
}

crate::base::wire::wire_struct!(Basis { rows, columns, chosen, reduced });

#[cfg(test)]
mod tests {
    use super::*;

    /// The pendulum: x dx + y dy = 0. The coordinate with the larger coefficient becomes dependent.
    #[test]
    fn of_two_columns_the_larger_is_chosen_with_hysteresis() {
        let mut basis = Basis::new(1, 2, vec![0]);
        let at = |angle: f64| [angle.cos(), angle.sin()];
        assert!(!basis.improve(&at(0.0), 2.0));
        assert!(!basis.improve(&at(1.1), 2.0));
        assert!(basis.improve(&at(1.11), 2.0));
        assert_eq!(basis.chosen(), [1]);
        assert!(!basis.improve(&at(0.5), 2.0));
        assert!(basis.improve(&at(0.46), 2.0));
        assert_eq!(basis.chosen(), [0]);
    }

    #[test]
    fn a_singular_choice_is_replaced_by_a_regular_one() {
        let mut basis = Basis::new(2, 3, vec![0, 1]);
        // Columns 0 and 1 are parallel.
        assert!(basis.improve(&[1.0, 2.0, 0.0, 2.0, 4.0, 1.0], 2.0));
        let mut chosen = basis.chosen().to_vec();
        chosen.sort_unstable();
        assert_eq!(chosen, [1, 2]);
    }

    #[test]
    fn without_full_rank_the_choice_stays() {
        let mut basis = Basis::new(2, 3, vec![0, 2]);
        assert!(!basis.improve(&[1.0, 2.0, 3.0, 2.0, 4.0, 6.0], 2.0));
        assert!(!basis.improve(&[0.0; 6], 2.0));
        assert!(!basis.improve(&[f64::NAN; 6], 2.0));
        assert_eq!(basis.chosen(), [0, 2]);
    }

    /// |det| of the chosen columns is the largest of all three, found by hand: 1, 4, 11 of
    /// (0 1), (0 2), (1 2).
    #[test]
    fn the_volume_grows() {
        let mut basis = Basis::new(2, 3, vec![0, 1]);
        assert!(basis.improve(&[1.0, 3.0, 1.0, 0.0, 1.0, 4.0], 2.0));
        let mut chosen = basis.chosen().to_vec();
        chosen.sort_unstable();
        assert_eq!(chosen, [1, 2]);
    }
}
