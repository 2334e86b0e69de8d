//! The sparsity pattern of a matrix in compressed columns.

/// Positions of the entries of a matrix that may be nonzero, column by column.
///
/// Rows ascend strictly within a column. Column `j` owns the entries
/// `column_starts()[j] .. column_starts()[j + 1]` of `row_indices()`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Pattern {
    rows: usize,
    starts: Vec<usize>,
    row_indices: Vec<usize>,
}

impl Pattern {
    /// The pattern of a `rows` x `columns` matrix with the given `(row, column)` entries, in any
    /// order; duplicates count once.
    ///
    /// Panics on an entry outside the matrix, which is a bug of the caller.
    pub fn from_entries(rows: usize, columns: usize, entries: &[(usize, usize)]) -> Self {
        let mut by_column: Vec<(usize, usize)> = entries.iter().map(|&(i, j)| (j, i)).collect();
        by_column.sort_unstable();
        by_column.dedup();
        let mut starts = vec![0; columns + 1];
        let mut row_indices = Vec::with_capacity(by_column.len());
        for (j, i) in by_column {
            assert!(
                i < rows && j < columns,
                "entry ({i}, {j}) is outside a {rows} x {columns} matrix"
            );
            starts[j + 1] += 1;
            row_indices.push(i);
        }
        for j in 0..columns {
            starts[j + 1] += starts[j];
        }
        Pattern { rows, starts, row_indices }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of entries.
    pub fn entries(&self) -> usize {
        self.row_indices.len()
    }

    /// Start of each column in `row_indices`, and one past the last entry; length `columns + 1`.
    pub fn column_starts(&self) -> &[usize] {
        &self.starts
    }

    /// Row of each entry, column after column.
    pub fn row_indices(&self) -> &[usize] {
        &self.row_indices
    }

    /// Rows of column `j`, ascending.
    pub fn column(&self, j: usize) -> &[usize] {
        &self.row_indices[self.starts[j]..self.starts[j + 1]]
    }

    /// Position of entry `(i, j)` in the array of values, if it is in the pattern.
    pub fn position(&self, i: usize, j: usize) -> Option<usize> {
        self.column(j).binary_search(&i).ok().map(|k| self.starts[j] + k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_sorted_and_counted_once() {
        // The matrix  [x . x]
        //             [. x x]
        let p = Pattern::from_entries(2, 3, &[(1, 2), (0, 0), (1, 1), (0, 2), (0, 0)]);
        assert_eq!(p.column_starts(), &[0, 1, 2, 4]);
        assert_eq!(p.row_indices(), &[0, 1, 0, 1]);
        assert_eq!(p.position(1, 2), Some(3));
        assert_eq!(p.position(1, 0), None);
        assert_eq!((p.rows(), p.columns(), p.entries()), (2, 3, 4));
    }
}
