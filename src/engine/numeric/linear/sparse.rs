//! LU decomposition of real sparse matrices.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};

use super::Singular;
use crate::numeric::pattern::Pattern;

/// LU decomposition of real sparse matrices with one pattern.
///
/// `new` computes the column ordering (COLAMD) and chooses the algorithm. The memory of the factors
/// may grow in the first factorizations and is reused afterwards.
pub struct SparseLu {
    pattern: Pattern,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    probe: Vec<f64>,
    memory: MemBuffer,
}

impl SparseLu {
    /// A solver for square matrices with this pattern; a structurally singular pattern is reported
    /// by `factor`.
    pub fn new(pattern: Pattern) -> Result<Self, Singular> {
        let n = pattern.columns();
        let symbolic = analyzed(&pattern, LuSymbolicParams::default())?;
        let factor = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default());
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Ok(SparseLu {
            symbolic,
            numeric: NumericLu::new(),
            probe: vec![1.0; n],
            memory: MemBuffer::new(StackReq::or(factor, solve)),
            pattern,
        })
    }

    /// The pattern all matrices share.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Decomposes the matrix with these values, one per entry of the pattern.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                SparseColMatRef::new(view(&self.pattern), values),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|error| singular(error, &self.symbolic))?;
        // faer divides by a zero pivot without reporting it, so solve once to detect it.
        let mut probe = std::mem::take(&mut self.probe);
        probe.fill(1.0);
        self.solve_in_place(&mut probe);
        let broken = probe.iter().position(|x| !x.is_finite());
        self.probe = probe;
        broken.map_or(Ok(()), |column| Err(Singular { column }))
    }

    /// Overwrites the right-hand side `b` with the solution. Requires a successful factorization.
    pub fn solve_in_place(&mut self, b: &mut [f64]) {
        let n = b.len();
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

/// The column ordering of a square pattern, and the algorithm for it.
pub(super) fn analyzed(
    pattern: &Pattern,
    parameters: LuSymbolicParams<'_>,
) -> Result<SymbolicLu<usize>, Singular> {
    assert_eq!(pattern.rows(), pattern.columns(), "a linear system is square");
    factorize_symbolic_lu(view(pattern), parameters).map_err(|_| Singular { column: 0 })
}

/// The column that has no pivot.
pub(super) fn singular(error: LuError, symbolic: &SymbolicLu<usize>) -> Singular {
    match error {
        LuError::SymbolicSingular { index } => {
            Singular { column: symbolic.col_perm().arrays().0[index] }
        }
        LuError::Generic(_) => Singular { column: 0 },
    }
}

/// A pattern as faer sees it.
pub(super) fn view(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.columns();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.column_starts(), None, pattern.row_indices())
}
