//! LU decomposition of complex dense matrices.

use super::{SMALL, Singular, complex_blocks};
use crate::numeric::{panel, small_lu};

/// LU decomposition of a complex dense matrix, with partial pivoting. Matrices and vectors are
/// stored as two planes, real and imaginary.
pub struct ComplexLu {
    capacity: usize,
    n: usize,
    re: Vec<f64>,
    im: Vec<f64>,
    pivots: Vec<usize>,
}

impl ComplexLu {
    /// A solver for matrices of order `n`.
    pub fn new(n: usize) -> Self {
        let (re, im) = (vec![0.0; n * n], vec![0.0; n * n]);
        ComplexLu { capacity: n, n, re, im, pivots: vec![0; n] }
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
        let pivots = &mut self.pivots[..n];
        match n > SMALL {
            true => complex_blocks::factor(n, re, im, pivots),
            false => small_lu::factor_complex(n, re, im, pivots),
        }
    }

    /// Overwrites the right-hand side with the solution. Requires a successful factorization.
    pub fn solve_in_place(&mut self, b_re: &mut [f64], b_im: &mut [f64]) {
        let n = self.n;
        let planes = (&self.re[..n * n], &self.im[..n * n]);
        small_lu::solve_complex(n, planes, &self.pivots, b_re, b_im);
    }

    /// The same for a [`panel`] of right-hand sides; false, with nothing done, for orders beyond [`SMALL`].
    pub fn solve_panel(&self, b_re: &mut [f64], b_im: &mut [f64], width: usize) -> bool {
        let n = self.n;
        let is_small = n <= SMALL;
        if is_small {
            let planes = (&self.re[..n * n], &self.im[..n * n]);
            panel::solve_complex(n, planes, &self.pivots, b_re, b_im, width);
        }
        is_small
    }
}
