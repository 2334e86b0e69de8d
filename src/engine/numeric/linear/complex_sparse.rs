//! LU decomposition of complex sparse matrices.
//!
//! Factors with few entries are computed entry by entry. Factors that fill up are computed as those of the real
//! matrix of twice the order, in which a complex number `x + i y` is the block `[x -y; y x]`: its products of dense
//! blocks are real.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::perm::PermRef;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::lu::simplicial::{
    SimplicialLu, factorize_simplicial_numeric_lu, factorize_simplicial_numeric_lu_scratch,
    solve_in_place_scratch,
};
use faer::sparse::linalg::lu::{LuSymbolicParams, SymbolicLu};
use faer::{Conj, MatMut, Par, c64};

use super::Singular;
use super::sparse::{SparseLu, analyzed, singular, view};
use crate::numeric::pattern::Pattern;

/// The complex numbers of [`ComplexSparseLu`].
pub type Complex = c64;

/// Multiplications for each entry of the factors beyond which blocks pay, as faer decides it for real matrices.
const BLOCKS_PAY: usize = 40;

/// LU decomposition of complex sparse matrices with one pattern.
pub struct ComplexSparseLu {
    pattern: Pattern,
    form: Form,
}

enum Form {
    Entries(Box<Entries>),
    Blocks(Box<Blocks>),
}

/// Factors that are computed entry by entry.
struct Entries {
    symbolic: SymbolicLu<usize>,
    factors: SimplicialLu<usize, Complex>,
    rows: Vec<usize>,
    inverse: Vec<usize>,
    probe: Vec<Complex>,
    memory: MemBuffer,
}

/// Factors of the real matrix of twice the order.
struct Blocks {
    lu: SparseLu,
    values: Vec<f64>,
    b: Vec<f64>,
}

impl ComplexSparseLu {
    /// A solver for square matrices with this pattern; a structurally singular pattern is reported
    /// by `factor`.
    pub fn new(pattern: Pattern) -> Result<Self, Singular> {
        let form = Form::Entries(Box::new(Entries::new(&pattern)?));
        Ok(ComplexSparseLu { pattern, form })
    }

    /// The pattern all matrices share.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// True if the factors are those of the real matrix of twice the order.
    pub fn is_by_blocks(&self) -> bool {
        matches!(self.form, Form::Blocks(_))
    }

    /// Decomposes the matrix with these values, one per entry of the pattern.
    pub fn factor(&mut self, values: &[Complex]) -> Result<(), Singular> {
        match &mut self.form {
            Form::Entries(entries) => {
                entries.factor(&self.pattern, values)?;
                if entries.are_many() {
                    let mut blocks = Blocks::new(&self.pattern)?;
                    blocks.factor(&self.pattern, values)?;
                    self.form = Form::Blocks(Box::new(blocks));
                }
                Ok(())
            }
            Form::Blocks(blocks) => blocks.factor(&self.pattern, values),
        }
    }

    /// Overwrites the right-hand side `b` with the solution. Requires a successful factorization.
    pub fn solve_in_place(&mut self, b: &mut [Complex]) {
        match &mut self.form {
            Form::Entries(entries) => entries.solve(b),
            Form::Blocks(blocks) => blocks.solve(b),
        }
    }
}

impl Entries {
    fn new(pattern: &Pattern) -> Result<Entries, Singular> {
        let n = pattern.columns();
        let supernodal_flop_ratio_threshold = SupernodalThreshold::FORCE_SIMPLICIAL;
        let parameters =
            LuSymbolicParams { supernodal_flop_ratio_threshold, ..LuSymbolicParams::default() };
        let factor = factorize_simplicial_numeric_lu_scratch::<usize, Complex>(n, n);
        let solve = solve_in_place_scratch::<usize, Complex>(n, 1, Par::Seq);
        Ok(Entries {
            symbolic: analyzed(pattern, parameters)?,
            factors: SimplicialLu::new(),
            rows: vec![0; n],
            inverse: vec![0; n],
            probe: vec![Complex::new(1.0, 0.0); n],
            memory: MemBuffer::new(StackReq::or(factor, solve)),
        })
    }

    fn factor(&mut self, pattern: &Pattern, values: &[Complex]) -> Result<(), Singular> {
        factorize_simplicial_numeric_lu(
            &mut self.rows,
            &mut self.inverse,
            &mut self.factors,
            SparseColMatRef::new(view(pattern), values),
            self.symbolic.col_perm(),
            MemStack::new(&mut self.memory),
        )
        .map_err(|error| singular(error, &self.symbolic))?;
        // faer divides by a zero pivot without reporting it, so solve once to detect it.
        let mut probe = std::mem::take(&mut self.probe);
        probe.fill(Complex::new(1.0, 0.0));
        self.solve(&mut probe);
        let broken = probe.iter().position(|x| !x.is_finite());
        self.probe = probe;
        broken.map_or(Ok(()), |column| Err(Singular { column }))
    }

    /// True if there are many multiplications for each entry of the factors.
    fn are_many(&self) -> bool {
        let (lower, upper) = (self.factors.l_factor_unsorted(), self.factors.u_factor_unsorted());
        let below = |k: usize| lower.symbolic().row_idx_of_col_raw(k).len();
        let n = self.rows.len();
        let entries: usize =
            (0..n).map(|j| below(j) + upper.symbolic().row_idx_of_col_raw(j).len()).sum();
        let products: usize =
            (0..n).flat_map(|j| upper.symbolic().row_idx_of_col_raw(j)).map(|k| below(*k)).sum();
        products > BLOCKS_PAY * entries
    }

    fn solve(&mut self, b: &mut [Complex]) {
        let n = b.len();
        self.factors.solve_in_place_with_conj(
            PermRef::new_checked(&self.rows, &self.inverse, n),
            self.symbolic.col_perm(),
            Conj::No,
            MatMut::from_column_major_slice_mut(b, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

impl Blocks {
    fn new(pattern: &Pattern) -> Result<Blocks, Singular> {
        let n = pattern.columns();
        let mut entries = Vec::with_capacity(4 * pattern.entries());
        for j in 0..n {
            for &i in pattern.column(j) {
                let (i, j) = (2 * i, 2 * j);
                entries.extend([(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]);
            }
        }
        let lu = SparseLu::new(Pattern::from_entries(2 * n, 2 * n, &entries))
            .map_err(|e| Singular { column: e.column / 2 })?;
        Ok(Blocks { lu, values: vec![0.0; 4 * pattern.entries()], b: vec![0.0; 2 * n] })
    }

    fn factor(&mut self, pattern: &Pattern, values: &[Complex]) -> Result<(), Singular> {
        // Each column of the pattern is two of the real one, both with two rows for each of its own.
        let mut from = values.iter();
        let mut to = self.values.as_mut_slice();
        for j in 0..pattern.columns() {
            let count = pattern.column(j).len();
            let (left, rest) = to.split_at_mut(2 * count);
            let (right, rest) = rest.split_at_mut(2 * count);
            for ((x, y), z) in
                left.chunks_exact_mut(2).zip(right.chunks_exact_mut(2)).zip(&mut from)
            {
                x.copy_from_slice(&[z.re, z.im]);
                y.copy_from_slice(&[-z.im, z.re]);
            }
            to = rest;
        }
        self.lu.factor(&self.values).map_err(|e| Singular { column: e.column / 2 })
    }

    fn solve(&mut self, b: &mut [Complex]) {
        for (to, z) in self.b.chunks_exact_mut(2).zip(b.iter()) {
            to.copy_from_slice(&[z.re, z.im]);
        }
        self.lu.solve_in_place(&mut self.b);
        for (z, from) in b.iter_mut().zip(self.b.chunks_exact(2)) {
            *z = Complex::new(from[0], from[1]);
        }
    }
}
