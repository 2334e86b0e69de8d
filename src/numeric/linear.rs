//! Linear systems by LU decomposition: dense and sparse, real and complex.
//!
//! The only user of faer. A solver is created once for an order (dense) or a pattern (sparse), owns
//! all the memory it needs, and then factors and solves any number of times. Dense matrices up to
//! [`SMALL`] use the plain loops of `small_lu`, larger ones faer.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor as dense_factor, solve as dense_solve};
use faer::perm::PermRef;
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::traits::ComplexField;
use faer::{Conj, MatMut, MatRef, Par, c64};

use super::panel;
use super::pattern::Pattern;
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
        let blocked = (n > SMALL).then(|| BlockedLu::new::<f64>(n));
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
            Some(blocked) if n > SMALL => blocked.factor(n, lu, |x| x.is_finite() && *x != 0.0),
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

/// LU decomposition of a complex dense matrix, with partial pivoting. Matrices and vectors are
/// stored as two planes, real and imaginary.
pub struct ComplexLu {
    capacity: usize,
    n: usize,
    re: Vec<f64>,
    im: Vec<f64>,
    pivots: Vec<usize>,
    blocked: Option<BlockedComplexLu>,
}

struct BlockedComplexLu {
    lu: Vec<c64>,
    b: Vec<c64>,
    blocked: BlockedLu,
}

impl ComplexLu {
    /// A solver for matrices of order `n`.
    pub fn new(n: usize) -> Self {
        let blocked = (n > SMALL).then(|| BlockedComplexLu {
            lu: vec![c64::new(0.0, 0.0); n * n],
            b: vec![c64::new(0.0, 0.0); n],
            blocked: BlockedLu::new::<c64>(n),
        });
        let (re, im) = (vec![0.0; n * n], vec![0.0; n * n]);
        ComplexLu { capacity: n, n, re, im, pivots: vec![0; n], blocked }
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

    /// Decomposes the column-major matrix `re + i im`, both of length `n * n`.
    pub fn factor(&mut self, re: &[f64], im: &[f64]) -> Result<(), Singular> {
        self.factor_with(|to_re, to_im| {
            to_re.copy_from_slice(re);
            to_im.copy_from_slice(im);
        })
    }

    /// Decomposes the matrix that `fill` writes to the real and the imaginary plane, column-major
    /// and completely, in place.
    pub fn factor_with(
        &mut self,
        fill: impl FnOnce(&mut [f64], &mut [f64]),
    ) -> Result<(), Singular> {
        let n = self.n;
        let (re, im) = (&mut self.re[..n * n], &mut self.im[..n * n]);
        fill(re, im);
        match &mut self.blocked {
            Some(large) if n > SMALL => {
                let lu = &mut large.lu[..n * n];
                for (z, (x, y)) in lu.iter_mut().zip(re.iter().zip(im.iter())) {
                    *z = c64::new(*x, *y);
                }
                let usable = |z: &c64| z.is_finite() && (z.re != 0.0 || z.im != 0.0);
                large.blocked.factor(n, lu, usable)
            }
            _ => small_lu::factor_complex(n, re, im, &mut self.pivots),
        }
    }

    /// Overwrites the right-hand side with the solution. Requires a successful factorization.
    pub fn solve_in_place(&mut self, b_re: &mut [f64], b_im: &mut [f64]) {
        let n = self.n;
        match &mut self.blocked {
            Some(large) if n > SMALL => {
                let b = &mut large.b[..n];
                for (z, (x, y)) in b.iter_mut().zip(b_re.iter().zip(b_im.iter())) {
                    *z = c64::new(*x, *y);
                }
                large.blocked.solve(n, &large.lu[..n * n], b);
                for (z, (x, y)) in b.iter().zip(b_re.iter_mut().zip(b_im.iter_mut())) {
                    (*x, *y) = (z.re, z.im);
                }
            }
            _ => {
                let planes = (&self.re[..n * n], &self.im[..n * n]);
                small_lu::solve_complex(n, planes, &self.pivots, b_re, b_im);
            }
        }
    }

    /// The same for a [`panel`] of right-hand sides; false, with nothing done, for orders beyond [`SMALL`].
    pub fn solve_panel(&self, b_re: &mut [f64], b_im: &mut [f64], width: usize) -> bool {
        let n = self.n;
        let is_small = self.blocked.is_none() || n <= SMALL;
        if is_small {
            let planes = (&self.re[..n * n], &self.im[..n * n]);
            panel::solve_complex(n, planes, &self.pivots, b_re, b_im, width);
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
    fn new<T: ComplexField>(n: usize) -> Self {
        let factor =
            dense_factor::lu_in_place_scratch::<usize, T>(n, n, Par::Seq, Default::default());
        let solve = dense_solve::solve_in_place_scratch::<usize, T>(n, 1, Par::Seq);
        BlockedLu {
            permutation: vec![0; n],
            inverse: vec![0; n],
            memory: MemBuffer::new(StackReq::or(factor, solve)),
        }
    }

    fn factor<T: ComplexField>(
        &mut self,
        n: usize,
        lu: &mut [T],
        usable: impl Fn(&T) -> bool,
    ) -> Result<(), Singular> {
        dense_factor::lu_in_place(
            MatMut::from_column_major_slice_mut(lu, n, n),
            &mut self.permutation[..n],
            &mut self.inverse[..n],
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        match (0..n).find(|&k| !usable(&lu[k * n + k])) {
            Some(column) => Err(Singular { column }),
            None => Ok(()),
        }
    }

    fn solve<T: ComplexField>(&mut self, n: usize, lu: &[T], b: &mut [T]) {
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

/// LU decomposition of real matrices with one sparsity pattern: the ordering is computed once.
pub type SparseLu = SparseLuOf<f64>;
/// LU decomposition of complex matrices with one sparsity pattern.
pub type ComplexSparseLu = SparseLuOf<Complex>;
/// The complex numbers of [`ComplexSparseLu`].
pub type Complex = c64;

/// LU decomposition of sparse matrices with one pattern, over the reals or the complex numbers.
///
/// `new` computes the column ordering (COLAMD) and chooses the algorithm. The memory of the factors
/// may grow in the first factorizations and is reused afterwards.
pub struct SparseLuOf<T: SparseScalar> {
    pattern: Pattern,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, T>,
    probe: Vec<T>,
    memory: MemBuffer,
}

/// A scalar of [`SparseLuOf`]: `f64` or [`Complex`].
pub trait SparseScalar: ComplexField + Copy {
    /// The number one.
    const ONE: Self;
    /// True if the number is neither infinite nor NaN.
    fn finite(&self) -> bool;
}

impl SparseScalar for f64 {
    const ONE: f64 = 1.0;
    fn finite(&self) -> bool {
        self.is_finite()
    }
}

impl SparseScalar for Complex {
    const ONE: Complex = Complex::new(1.0, 0.0);
    fn finite(&self) -> bool {
        self.is_finite()
    }
}

impl<T: SparseScalar> SparseLuOf<T> {
    /// A solver for square matrices with this pattern; a structurally singular pattern is reported
    /// by `factor`.
    pub fn new(pattern: Pattern) -> Result<Self, Singular> {
        let n = pattern.columns();
        assert_eq!(pattern.rows(), n, "a linear system is square");
        let symbolic = factorize_symbolic_lu(view(&pattern), LuSymbolicParams::default())
            .map_err(|_| Singular { column: 0 })?;
        let factor = symbolic.factorize_numeric_lu_scratch::<T>(Par::Seq, Default::default());
        let solve = symbolic.solve_in_place_scratch::<T>(1, Par::Seq);
        Ok(SparseLuOf {
            symbolic,
            numeric: NumericLu::new(),
            probe: vec![T::ONE; n],
            memory: MemBuffer::new(StackReq::or(factor, solve)),
            pattern,
        })
    }

    /// The pattern all matrices share.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Decomposes the matrix with these values, one per entry of the pattern.
    pub fn factor(&mut self, values: &[T]) -> Result<(), Singular> {
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                SparseColMatRef::new(view(&self.pattern), values),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|error| match error {
                faer::sparse::linalg::LuError::SymbolicSingular { index } => {
                    Singular { column: self.symbolic.col_perm().arrays().0[index] }
                }
                faer::sparse::linalg::LuError::Generic(_) => Singular { column: 0 },
            })?;
        // faer divides by a zero pivot without reporting it, so solve once to detect it.
        let mut probe = std::mem::take(&mut self.probe);
        probe.fill(T::ONE);
        self.solve_in_place(&mut probe);
        let broken = probe.iter().position(|x| !x.finite());
        self.probe = probe;
        broken.map_or(Ok(()), |column| Err(Singular { column }))
    }

    /// Overwrites the right-hand side `b` with the solution. Requires a successful factorization.
    pub fn solve_in_place(&mut self, b: &mut [T]) {
        let n = b.len();
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

fn view(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.columns();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.column_starts(), None, pattern.row_indices())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Orders around the switch from plain loops to faer.
    const ORDERS: [usize; 7] = [1, 2, 3, 13, SMALL, SMALL + 1, 70];

    /// Entries in (-1, 1) from the linear congruential generator of Knuth's MMIX.
    fn scatter(count: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..count)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
            })
            .collect()
    }

    fn product(n: usize, a: &[f64], x: &[f64]) -> Vec<f64> {
        (0..n).map(|i| (0..n).map(|j| a[j * n + i] * x[j]).sum()).collect()
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn dense_solution_has_a_small_residual() {
        for n in ORDERS {
            let (a, b) = (scatter(n * n, 1), scatter(n, 2));
            let mut lu = DenseLu::new(n);
            lu.factor(&a).unwrap();
            let mut x = b.clone();
            lu.solve_in_place(&mut x);
            let size = x.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
            let residual = largest_difference(&product(n, &a, &x), &b);
            assert!(residual < 1e-14 * n as f64 * size, "n = {n}: {residual}");
        }
    }

    #[test]
    fn complex_solution_has_a_small_residual() {
        for n in ORDERS {
            let (re, im) = (scatter(n * n, 3), scatter(n * n, 4));
            let (b, c) = (scatter(n, 5), scatter(n, 6));
            let mut lu = ComplexLu::new(n);
            lu.factor(&re, &im).unwrap();
            let (mut x, mut y) = (b.clone(), c.clone());
            lu.solve_in_place(&mut x, &mut y);
            let size = x.iter().chain(&y).fold(1.0_f64, |m, x| m.max(x.abs()));
            let real: Vec<f64> =
                product(n, &re, &x).iter().zip(product(n, &im, &y)).map(|(p, q)| p - q).collect();
            let imaginary: Vec<f64> =
                product(n, &re, &y).iter().zip(product(n, &im, &x)).map(|(p, q)| p + q).collect();
            let residual = largest_difference(&real, &b).max(largest_difference(&imaginary, &c));
            assert!(residual < 2e-14 * n as f64 * size, "n = {n}: {residual}");
        }
    }

    /// The matrix [0 2; 3 0] needs the exchange; [1 2; 2 4] has rank one.
    #[test]
    fn exchanges_rows_and_names_the_singular_column() {
        let mut lu = DenseLu::new(2);
        lu.factor(&[0.0, 3.0, 2.0, 0.0]).unwrap();
        let mut b = [4.0, 9.0];
        lu.solve_in_place(&mut b);
        assert_eq!(b, [3.0, 2.0]);
        assert_eq!(lu.factor(&[1.0, 2.0, 2.0, 4.0]), Err(Singular { column: 1 }));
        assert_eq!(lu.factor(&[f64::NAN, 0.0, 0.0, 1.0]), Err(Singular { column: 0 }));
        let mut complex = ComplexLu::new(2);
        // [i 1; -1 i] has determinant -1 + 1 = 0.
        let singular = complex.factor(&[0.0, -1.0, 1.0, 0.0], &[1.0, 0.0, 0.0, 1.0]);
        assert_eq!(singular, Err(Singular { column: 1 }));
    }

    #[test]
    fn large_singular_matrix_is_found() {
        let n = SMALL + 8;
        let mut a = scatter(n * n, 7);
        a[5 * n..6 * n].fill(0.0);
        assert!(DenseLu::new(n).factor(&a).is_err());
    }

    /// The second difference matrix: its solution for b = 1 is i (n + 1 - i) / 2.
    #[test]
    fn sparse_second_difference() {
        let n = 50;
        let entries: Vec<_> = (0..n)
            .flat_map(|j: usize| (j.saturating_sub(1)..(j + 2).min(n)).map(move |i| (i, j)))
            .collect();
        let pattern = Pattern::from_entries(n, n, &entries);
        let mut values = Vec::new();
        for j in 0..n {
            values.extend(pattern.column(j).iter().map(|&i| if i == j { 2.0 } else { -1.0 }));
        }
        let exact: Vec<f64> = (1..=n).map(|i| (i * (n + 1 - i)) as f64 / 2.0).collect();

        let mut lu = SparseLu::new(pattern.clone()).unwrap();
        for scale in [1.0, 4.0] {
            let scaled: Vec<f64> = values.iter().map(|v| v * scale).collect();
            lu.factor(&scaled).unwrap();
            let mut b = vec![scale; n];
            lu.solve_in_place(&mut b);
            assert!(largest_difference(&b, &exact) < 1e-10);
        }

        let mut complex = ComplexSparseLu::new(pattern).unwrap();
        let rotated: Vec<Complex> = values.iter().map(|&v| Complex::new(0.0, v)).collect();
        complex.factor(&rotated).unwrap();
        let mut b = vec![Complex::new(0.0, 1.0); n];
        complex.solve_in_place(&mut b);
        let real: Vec<f64> = b.iter().map(|z| z.re).collect();
        assert!(largest_difference(&real, &exact) < 1e-10);
    }

    #[test]
    fn sparse_singular_matrix_is_found() {
        let pattern = Pattern::from_entries(2, 2, &[(0, 0), (1, 0), (0, 1), (1, 1)]);
        let mut lu = SparseLu::new(pattern).unwrap();
        assert!(lu.factor(&[1.0, 2.0, 2.0, 4.0]).is_err());
        assert!(lu.factor(&[1.0, 2.0, 2.0, 5.0]).is_ok());
    }
}
