//! The matrix of a large linear block, stored and decomposed by its entries.

use crate::ir::program::Entry;
use crate::numeric::linear::Singular;
use crate::numeric::linear::sparse::SparseLu;
use crate::numeric::pattern::Pattern;

/// Smaller matrices are dense: plain loops are faster than the lists of a sparse matrix.
const SPARSE_ORDER: usize = 100;

/// A matrix with more than one entry in this many positions is dense.
const SPARSE_SHARE: usize = 20;

/// A sparse matrix with its factors.
pub struct SparseBlock {
    lu: SparseLu,
    /// For each entry of the block, its position in the values of the pattern.
    positions: Vec<usize>,
    values: Vec<f64>,
}

impl SparseBlock {
    /// Memory for a matrix of order `n` with these entries; `None` if a dense one is faster.
    pub fn new(n: usize, entries: &[Entry]) -> Option<Self> {
        if n < SPARSE_ORDER || entries.len() > n * n / SPARSE_SHARE {
            return None;
        }
        let places: Vec<(usize, usize)> =
            entries.iter().map(|e| (e.row as usize, e.column as usize)).collect();
        let pattern = Pattern::from_entries(n, n, &places);
        let positions: Option<Vec<usize>> =
            places.iter().map(|&(i, j)| pattern.position(i, j)).collect();
        let values = vec![0.0; pattern.entries()];
        Some(SparseBlock { lu: SparseLu::new(pattern).ok()?, positions: positions?, values })
    }

    /// Decomposes the matrix with these values of the entries.
    pub fn factor(&mut self, entries: &[f64]) -> Result<(), Singular> {
        for (position, value) in self.positions.iter().zip(entries) {
            self.values[*position] = *value;
        }
        self.lu.factor(&self.values)
    }

    /// Overwrites a right-hand side with the solution. Requires a successful factorization.
    pub fn solve_in_place(&mut self, b: &mut [f64]) {
        self.lu.solve_in_place(b);
    }
}
