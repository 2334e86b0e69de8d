//! Large complex dense matrices: LU decomposition by halves, so that nearly all of the work is products of blocks.
//!
//! In: a column-major matrix as two planes. Out: the factors in the form of `small_lu::factor_complex`, by which it
//! is solved. A product of complex blocks is four products of real ones.
//!
//! S. Toledo, "Locality of Reference in LU Decomposition with Partial Pivoting", SIAM J. Matrix Anal. Appl. 18
//! (1997), section 2.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, Par};

use super::Singular;
use crate::numeric::small_lu::{reciprocal, subtract_multiple};

/// Most columns, or rows of a triangle, that plain loops take.
const NARROW: usize = 8;

/// A block of a matrix: its real and its imaginary plane.
struct Block<'a> {
    re: MatMut<'a, f64>,
    im: MatMut<'a, f64>,
}

/// Overwrites the matrix `re + i im` of order `n` with its factors; the diagonal holds the *reciprocals* of the
/// pivots. `pivots[k]` is the row that was exchanged with row `k`.
pub fn factor(
    n: usize,
    re: &mut [f64],
    im: &mut [f64],
    pivots: &mut [usize],
) -> Result<(), Singular> {
    let re = MatMut::from_column_major_slice_mut(re, n, n);
    let im = MatMut::from_column_major_slice_mut(im, n, n);
    decompose(Block { re, im }, pivots)
}

/// Decomposes a block of at least as many rows as columns, the left half first.
fn decompose(mut block: Block<'_>, pivots: &mut [usize]) -> Result<(), Singular> {
    let width = block.re.ncols();
    if width <= NARROW {
        return decompose_narrow(&mut block, pivots);
    }
    let half = (width / 2).next_multiple_of(NARROW);
    let (first, second) = pivots.split_at_mut(half);
    let (mut left, mut right) = block.split_columns(half);
    decompose(left.by_reference(), first)?;
    right.exchange(first);
    let (mut triangle, mut lower) = left.split_rows(half);
    let (mut top, mut bottom) = right.split_rows(half);
    solve_triangle(&mut triangle, &mut top);
    bottom.subtract_product(&lower, &top);
    decompose(bottom, second).map_err(|e| Singular { column: half + e.column })?;
    lower.exchange(second);
    second.iter_mut().for_each(|row| *row += half);
    Ok(())
}

/// Decomposes a block of few columns by plain loops.
fn decompose_narrow(block: &mut Block<'_>, pivots: &mut [usize]) -> Result<(), Singular> {
    for k in 0..block.re.ncols() {
        let (re, im) = block.column(k);
        let size = |i: usize| re[i].abs() + im[i].abs();
        let larger = |best: usize, i: usize| if size(i) > size(best) { i } else { best };
        let pivot = (k + 1..re.len()).fold(k, larger);
        // Written so that a NaN, for which every comparison is false, counts as singular.
        if !(size(pivot) > 0.0 && size(pivot) < f64::INFINITY) {
            return Err(Singular { column: k });
        }
        pivots[k] = pivot;
        block.exchange_rows(k, pivot);
        let (mut left, mut right) = block.by_reference().split_columns(k + 1);
        let (re, im) = left.column(k);
        let (r, i) = reciprocal(re[k], im[k]);
        (re[k], im[k]) = (r, i);
        for (x, y) in re[k + 1..].iter_mut().zip(&mut im[k + 1..]) {
            (*x, *y) = (*x * r - *y * i, *x * i + *y * r);
        }
        for j in 0..right.re.ncols() {
            let (next_re, next_im) = right.column(j);
            let factor = (next_re[k], next_im[k]);
            let (tail_re, tail_im) = (&mut next_re[k + 1..], &mut next_im[k + 1..]);
            subtract_multiple(tail_re, tail_im, &re[k + 1..], &im[k + 1..], factor);
        }
    }
    Ok(())
}

/// Overwrites `b` with the solution of `L x = b`, where `L` is the unit lower triangle of a square block.
fn solve_triangle(triangle: &mut Block<'_>, b: &mut Block<'_>) {
    let order = triangle.re.ncols();
    if order <= NARROW {
        for j in 0..b.re.ncols() {
            let (b_re, b_im) = b.column(j);
            for k in 0..order {
                let (re, im) = triangle.column(k);
                let factor = (b_re[k], b_im[k]);
                let (tail_re, tail_im) = (&mut b_re[k + 1..], &mut b_im[k + 1..]);
                subtract_multiple(tail_re, tail_im, &re[k + 1..], &im[k + 1..], factor);
            }
        }
        return;
    }
    let half = (order / 2).next_multiple_of(NARROW);
    let (left, right) = triangle.by_reference().split_columns(half);
    let ((mut first, lower), (_, mut second)) = (left.split_rows(half), right.split_rows(half));
    let (mut top, mut bottom) = b.by_reference().split_rows(half);
    solve_triangle(&mut first, &mut top);
    bottom.subtract_product(&lower, &top);
    solve_triangle(&mut second, &mut bottom);
}

impl<'a> Block<'a> {
    fn by_reference(&mut self) -> Block<'_> {
        Block { re: self.re.as_mut(), im: self.im.as_mut() }
    }

    fn split_columns(self, at: usize) -> (Block<'a>, Block<'a>) {
        let (left_re, right_re) = self.re.split_at_col_mut(at);
        let (left_im, right_im) = self.im.split_at_col_mut(at);
        (Block { re: left_re, im: left_im }, Block { re: right_re, im: right_im })
    }

    fn split_rows(self, at: usize) -> (Block<'a>, Block<'a>) {
        let (top_re, bottom_re) = self.re.split_at_row_mut(at);
        let (top_im, bottom_im) = self.im.split_at_row_mut(at);
        (Block { re: top_re, im: top_im }, Block { re: bottom_re, im: bottom_im })
    }

    /// Both planes of a column.
    fn column(&mut self, k: usize) -> (&mut [f64], &mut [f64]) {
        (contiguous(self.re.as_mut(), k), contiguous(self.im.as_mut(), k))
    }

    /// Exchanges row `k` with row `rows[k]`, for each `k` in turn.
    fn exchange(&mut self, rows: &[usize]) {
        for j in 0..self.re.ncols() {
            let (re, im) = self.column(j);
            for (k, row) in rows.iter().enumerate() {
                re.swap(k, *row);
                im.swap(k, *row);
            }
        }
    }

    fn exchange_rows(&mut self, a: usize, b: usize) {
        for j in 0..self.re.ncols() {
            let (re, im) = self.column(j);
            re.swap(a, b);
            im.swap(a, b);
        }
    }

    /// `self -= a b`.
    fn subtract_product(&mut self, a: &Block<'_>, b: &Block<'_>) {
        add_product(&mut self.re, &a.re, &b.re, -1.0);
        add_product(&mut self.re, &a.im, &b.im, 1.0);
        add_product(&mut self.im, &a.re, &b.im, -1.0);
        add_product(&mut self.im, &a.im, &b.re, -1.0);
    }
}

/// `to += factor a b`.
fn add_product(to: &mut MatMut<'_, f64>, a: &MatMut<'_, f64>, b: &MatMut<'_, f64>, factor: f64) {
    matmul(to.as_mut(), Accum::Add, a.as_ref(), b.as_ref(), factor, Par::Seq);
}

/// A column of a block of a column-major matrix.
fn contiguous(matrix: MatMut<'_, f64>, k: usize) -> &mut [f64] {
    matrix.col_mut(k).try_as_col_major_mut().map_or(&mut [], |column| column.as_slice_mut())
}
