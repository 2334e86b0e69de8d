//! Linear systems by LU decomposition: dense and sparse, real and complex.
//!
//! The only user of faer. A solver is created once for an order (dense) or a pattern (sparse), owns
//! all the memory it needs, and then factors and solves any number of times. Dense matrices up to
//! [`SMALL`] use the plain loops of `small_lu`, larger ones faer.
//!
//! Complex matrices are decomposed by products of real ones: faer's own kernels for complex numbers
//! would be a third of the library that runs an exported FMU.

pub mod complex;
mod complex_blocks;
pub mod complex_sparse;
pub mod sparse;
#[cfg(test)]
mod tests;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor as dense_factor, solve as dense_solve};
use faer::perm::PermRef;
use faer::{Conj, MatMut, MatRef, Par};

use super::panel;
use super::small_lu;

/// Largest order handled by `small_lu`; beyond it faer's blocking and wide registers win
/// (`benches/integrate.rs` has the comparison).
pub const SMALL: usize = 24;

/// The matrix is singular to working precision, or holds a value that is not finite.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("the matrix is singular at column {column}")]
pub struct Singular {
    /// The column in which no usable pivot was found.
    pub column: usize,
}

/// LU decomposition of a real dense matrix, with partial pivoting.
pub struct DenseLu {
    capacity: usize,
    n: usize,
    lu: Vec<f64>,
    pivots: Vec<usize>,
    blocked: Option<BlockedLu>,
}

impl DenseLu {
    /// A solver for matrices of order `n`.
    pub fn new(n: usize) -> Self {
        let blocked = (n > SMALL).then(|| BlockedLu::new(n));
        DenseLu { capacity: n, n, lu: vec![0.0; n * n], pivots: vec![0; n], blocked }
    }

    /// The order of the matrices.
    pub fn order(&self) -> usize {
        self.n
    }

    /// Changes the order to `n`, at most the order given to `new`; discards the factors.
    pub fn set_order(&mut self, n: usize) {
        assert!(n <= self.capacity, "order {n} exceeds the capacity {}", self.capacity);
        self.n = n;
    }

    /// Decomposes the column-major matrix `a` of length `n * n`.
    pub fn factor(&mut self, a: &[f64]) -> Result<(), Singular> {
        self.factor_with(|matrix| matrix.copy_from_slice(a))
    }

    /// Decomposes the matrix that `fill` writes, column-major and completely, in place.
    pub fn factor_with(&mut self, fill: impl FnOnce(&mut [f64])) -> Result<(), Singular> {
        let n = self.n;
        let lu = &mut self.lu[..n * n];
        fill(lu);
        match &mut self.blocked {
            Some(blocked) if n > SMALL => blocked.factor(n, lu),
            _ => small_lu::factor(n, lu, &mut self.pivots),
        }
    }

    /// The smallest pivot, relative to the largest entry of its column in the matrix `a` that was
    /// factored. A pivot that is left by cancellation alone is of the size of the rounding unit.
    pub fn weakest_pivot(&self, a: &[f64]) -> f64 {
        let n = self.n;
        let small = self.blocked.is_none() || n <= SMALL;
        let ratio = |k: usize| {
            let diagonal = self.lu[k * n + k].abs();
            let pivot = if small { 1.0 / diagonal } else { diagonal };
            let size = a[k * n..(k + 1) * n].iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            pivot / size
        };
        (0..n).map(ratio).fold(f64::INFINITY, f64::min)
    }

    /// Overwrites the right-hand side `b` with the solution. Requires a successful factorization.
    pub fn solve_in_place(&mut self, b: &mut [f64]) {
        let n = self.n;
        let lu = &self.lu[..n * n];
        match &mut self.blocked {
            Some(blocked) if n > SMALL => blocked.solve(n, lu, b),
            _ => small_lu::solve(n, lu, &self.pivots, b),
        }
    }

    /// The same for a [`panel`] of right-hand sides; false, with nothing done, for orders beyond [`SMALL`].
    pub fn solve_panel(&self, b: &mut [f64], width: usize) -> bool {
        let n = self.n;
        let is_small = self.blocked.is_none() || n <= SMALL;
        if is_small {
            panel::solve(n, &self.lu[..n * n], &self.pivots, b, width);
        }
        is_small
    }
}

/// The permutation and the work space of faer's dense LU.
struct BlockedLu {
    permutation: Vec<usize>,
    inverse: Vec<usize>,
    memory: MemBuffer,
}

impl BlockedLu {
    fn new(n: usize) -> Self {
        let factor =
            dense_factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default());
        let solve = dense_solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq);
        BlockedLu {
            permutation: vec![0; n],
            inverse: vec![0; n],
            memory: MemBuffer::new(StackReq::or(factor, solve)),
        }
    }

    fn factor(&mut self, n: usize, lu: &mut [f64]) -> Result<(), Singular> {
        dense_factor::lu_in_place(
            MatMut::from_column_major_slice_mut(lu, n, n),
            &mut self.permutation[..n],
            &mut self.inverse[..n],
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        let is_usable = |x: f64| x.is_finite() && x != 0.0;
        match (0..n).find(|&k| !is_usable(lu[k * n + k])) {
            Some(column) => Err(Singular { column }),
            None => Ok(()),
        }
    }

    fn solve(&mut self, n: usize, lu: &[f64], b: &mut [f64]) {
        let lu = MatRef::from_column_major_slice(lu, n, n);
        dense_solve::solve_in_place_with_conj(
            lu,
            lu,
            PermRef::new_checked(&self.permutation[..n], &self.inverse[..n], n),
            Conj::No,
            MatMut::from_column_major_slice_mut(b, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}
