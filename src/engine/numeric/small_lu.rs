//! In-place LU decomposition of the small dense matrices of models: plain loops over columns.
//!
//! Golub & Van Loan, *Matrix Computations*, alg. 3.4.1 (outer product form, partial pivoting). At
//! the order of a typical model (n about 10), a library call costs more than the arithmetic; these
//! loops have no set-up cost, and the compiler vectorizes the updates of contiguous columns.
//! Complex matrices are stored as two planes, real and imaginary, for the same reason.
//!
//! All matrices are column-major `n x n`. `pivots[k]` is the row that was exchanged with row `k`.

use super::linear::Singular;

/// Overwrites `a` with its factors: the unit lower triangle below the diagonal, the upper triangle
/// above, and on the diagonal the *reciprocals* of the pivots.
pub fn factor(n: usize, a: &mut [f64], pivots: &mut [usize]) -> Result<(), Singular> {
    for k in 0..n {
        let (left, right) = a.split_at_mut((k + 1) * n);
        let column = &mut left[k * n..];
        let mut pivot = k;
        let mut largest = column[k].abs();
        for (i, value) in column.iter().enumerate().skip(k + 1) {
            if value.abs() > largest {
                largest = value.abs();
                pivot = i;
            }
        }
        // Written so that a NaN, for which every comparison is false, counts as singular.
        if !(largest > 0.0 && largest < f64::INFINITY) {
            return Err(Singular { column: k });
        }
        pivots[k] = pivot;
        column.swap(k, pivot);
        let reciprocal = 1.0 / column[k];
        column[k] = reciprocal;
        let multipliers = &mut column[k + 1..n];
        for value in multipliers.iter_mut() {
            *value *= reciprocal;
        }
        for next in right.chunks_exact_mut(n) {
            next.swap(k, pivot);
            let factor = next[k];
            // Jacobians of models are mostly zeros, and a skipped column is n flops saved.
            if factor != 0.0 {
                for (value, m) in next[k + 1..].iter_mut().zip(multipliers.iter()) {
                    *value -= m * factor;
                }
            }
        }
    }
    // The multipliers to the left of each later exchange move with their rows.
    for k in 1..n {
        let pivot = pivots[k];
        if pivot != k {
            for column in a[..k * n].chunks_exact_mut(n) {
                column.swap(k, pivot);
            }
        }
    }
    Ok(())
}

/// Solves with the factors of [`factor`], overwriting the right-hand side `b` with the solution.
pub fn solve(n: usize, lu: &[f64], pivots: &[usize], b: &mut [f64]) {
    match n {
        0 => {}
        1 => solve_fixed::<1>(lu, pivots, b),
        2 => solve_fixed::<2>(lu, pivots, b),
        3 => solve_fixed::<3>(lu, pivots, b),
        4 => solve_fixed::<4>(lu, pivots, b),
        5 => solve_fixed::<5>(lu, pivots, b),
        6 => solve_fixed::<6>(lu, pivots, b),
        7 => solve_fixed::<7>(lu, pivots, b),
        8 => solve_fixed::<8>(lu, pivots, b),
        9 => solve_fixed::<9>(lu, pivots, b),
        10 => solve_fixed::<10>(lu, pivots, b),
        11 => solve_fixed::<11>(lu, pivots, b),
        12 => solve_fixed::<12>(lu, pivots, b),
        _ => solve_any(n, lu, pivots, b),
    }
}

/// [`solve`] for a constant order: the loops are unrolled and the right-hand side stays in
/// registers.
fn solve_fixed<const N: usize>(lu: &[f64], pivots: &[usize], b: &mut [f64]) {
    for (k, &pivot) in pivots[..N].iter().enumerate() {
        b.swap(k, pivot);
    }
    let (columns, _) = lu.as_chunks::<N>();
    let (Some(columns), Some(b)) = (columns.first_chunk::<N>(), b.first_chunk_mut::<N>()) else {
        return;
    };
    let mut x = *b;
    for k in 0..N {
        for i in k + 1..N {
            x[i] -= columns[k][i] * x[k];
        }
    }
    for k in (0..N).rev() {
        x[k] *= columns[k][k];
        for i in 0..k {
            x[i] -= columns[k][i] * x[k];
        }
    }
    *b = x;
}

fn solve_any(n: usize, lu: &[f64], pivots: &[usize], b: &mut [f64]) {
    for (k, &pivot) in pivots[..n].iter().enumerate() {
        b.swap(k, pivot);
    }
    for (k, column) in lu.chunks_exact(n).enumerate() {
        let (head, tail) = b.split_at_mut(k + 1);
        let x = head[k];
        if x != 0.0 {
            for (value, m) in tail.iter_mut().zip(&column[k + 1..]) {
                *value -= m * x;
            }
        }
    }
    for (k, column) in lu.chunks_exact(n).enumerate().rev() {
        let x = b[k] * column[k];
        b[k] = x;
        if x != 0.0 {
            for (value, u) in b[..k].iter_mut().zip(column) {
                *value -= u * x;
            }
        }
    }
}

/// [`factor`] for the complex matrix `re + i im`. Pivots are chosen by `|re| + |im|`, which is
/// within a factor of sqrt(2) of the modulus and needs no root.
pub fn factor_complex(
    n: usize,
    re: &mut [f64],
    im: &mut [f64],
    pivots: &mut [usize],
) -> Result<(), Singular> {
    for k in 0..n {
        let (left_re, right_re) = re.split_at_mut((k + 1) * n);
        let (left_im, right_im) = im.split_at_mut((k + 1) * n);
        let (column_re, column_im) = (&mut left_re[k * n..], &mut left_im[k * n..]);
        let mut pivot = k;
        let mut largest = column_re[k].abs() + column_im[k].abs();
        for i in k + 1..n {
            let size = column_re[i].abs() + column_im[i].abs();
            if size > largest {
                largest = size;
                pivot = i;
            }
        }
        if !(largest > 0.0 && largest < f64::INFINITY) {
            return Err(Singular { column: k });
        }
        pivots[k] = pivot;
        column_re.swap(k, pivot);
        column_im.swap(k, pivot);
        let (r, i) = reciprocal(column_re[k], column_im[k]);
        column_re[k] = r;
        column_im[k] = i;
        let (lower_re, lower_im) = (&mut column_re[k + 1..n], &mut column_im[k + 1..n]);
        for (x, y) in lower_re.iter_mut().zip(lower_im.iter_mut()) {
            (*x, *y) = (*x * r - *y * i, *x * i + *y * r);
        }
        for (next_re, next_im) in right_re.chunks_exact_mut(n).zip(right_im.chunks_exact_mut(n)) {
            next_re.swap(k, pivot);
            next_im.swap(k, pivot);
            let (r, i) = (next_re[k], next_im[k]);
            if r != 0.0 || i != 0.0 {
                subtract_multiple(
                    &mut next_re[k + 1..],
                    &mut next_im[k + 1..],
                    lower_re,
                    lower_im,
                    (r, i),
                );
            }
        }
    }
    for k in 1..n {
        let pivot = pivots[k];
        if pivot != k {
            for plane in [&mut *re, &mut *im] {
                for column in plane[..k * n].chunks_exact_mut(n) {
                    column.swap(k, pivot);
                }
            }
        }
    }
    Ok(())
}

/// Solves with the factors of [`factor_complex`], overwriting the right-hand side with the
/// solution.
pub fn solve_complex(
    n: usize,
    (lu_re, lu_im): (&[f64], &[f64]),
    pivots: &[usize],
    b_re: &mut [f64],
    b_im: &mut [f64],
) {
    let lu = (lu_re, lu_im);
    match n {
        0 => {}
        1 => solve_complex_fixed::<1>(lu, pivots, b_re, b_im),
        2 => solve_complex_fixed::<2>(lu, pivots, b_re, b_im),
        3 => solve_complex_fixed::<3>(lu, pivots, b_re, b_im),
        4 => solve_complex_fixed::<4>(lu, pivots, b_re, b_im),
        5 => solve_complex_fixed::<5>(lu, pivots, b_re, b_im),
        6 => solve_complex_fixed::<6>(lu, pivots, b_re, b_im),
        7 => solve_complex_fixed::<7>(lu, pivots, b_re, b_im),
        8 => solve_complex_fixed::<8>(lu, pivots, b_re, b_im),
        9 => solve_complex_fixed::<9>(lu, pivots, b_re, b_im),
        10 => solve_complex_fixed::<10>(lu, pivots, b_re, b_im),
        11 => solve_complex_fixed::<11>(lu, pivots, b_re, b_im),
        12 => solve_complex_fixed::<12>(lu, pivots, b_re, b_im),
        _ => solve_complex_any(n, lu, pivots, b_re, b_im),
    }
}

/// [`solve_complex`] for a constant order.
fn solve_complex_fixed<const N: usize>(
    (lu_re, lu_im): (&[f64], &[f64]),
    pivots: &[usize],
    b_re: &mut [f64],
    b_im: &mut [f64],
) {
    for (k, &pivot) in pivots[..N].iter().enumerate() {
        b_re.swap(k, pivot);
        b_im.swap(k, pivot);
    }
    let ((re, _), (im, _)) = (lu_re.as_chunks::<N>(), lu_im.as_chunks::<N>());
    let (Some(re), Some(im)) = (re.first_chunk::<N>(), im.first_chunk::<N>()) else { return };
    let (b_re, b_im) = (b_re.first_chunk_mut::<N>(), b_im.first_chunk_mut::<N>());
    let (Some(b_re), Some(b_im)) = (b_re, b_im) else { return };
    let (mut x, mut y) = (*b_re, *b_im);
    for k in 0..N {
        for i in k + 1..N {
            x[i] -= re[k][i] * x[k] - im[k][i] * y[k];
            y[i] -= re[k][i] * y[k] + im[k][i] * x[k];
        }
    }
    for k in (0..N).rev() {
        let (r, i) = (re[k][k], im[k][k]);
        (x[k], y[k]) = (x[k] * r - y[k] * i, x[k] * i + y[k] * r);
        for i in 0..k {
            x[i] -= re[k][i] * x[k] - im[k][i] * y[k];
            y[i] -= re[k][i] * y[k] + im[k][i] * x[k];
        }
    }
    (*b_re, *b_im) = (x, y);
}

fn solve_complex_any(
    n: usize,
    (lu_re, lu_im): (&[f64], &[f64]),
    pivots: &[usize],
    b_re: &mut [f64],
    b_im: &mut [f64],
) {
    for (k, &pivot) in pivots[..n].iter().enumerate() {
        b_re.swap(k, pivot);
        b_im.swap(k, pivot);
    }
    let columns = lu_re.chunks_exact(n).zip(lu_im.chunks_exact(n)).enumerate();
    for (k, (column_re, column_im)) in columns.clone() {
        let (head_re, tail_re) = b_re.split_at_mut(k + 1);
        let (head_im, tail_im) = b_im.split_at_mut(k + 1);
        let (x, y) = (head_re[k], head_im[k]);
        if x != 0.0 || y != 0.0 {
            subtract_multiple(tail_re, tail_im, &column_re[k + 1..], &column_im[k + 1..], (x, y));
        }
    }
    for (k, (column_re, column_im)) in columns.rev() {
        let (r, i) = (column_re[k], column_im[k]);
        let (x, y) = (b_re[k] * r - b_im[k] * i, b_re[k] * i + b_im[k] * r);
        b_re[k] = x;
        b_im[k] = y;
        if x != 0.0 || y != 0.0 {
            subtract_multiple(
                &mut b_re[..k],
                &mut b_im[..k],
                &column_re[..k],
                &column_im[..k],
                (x, y),
            );
        }
    }
}

/// `target -= source * (x + i y)` on the two planes.
#[inline]
pub fn subtract_multiple(
    target_re: &mut [f64],
    target_im: &mut [f64],
    source_re: &[f64],
    source_im: &[f64],
    (x, y): (f64, f64),
) {
    let targets = target_re.iter_mut().zip(target_im.iter_mut());
    for ((r, i), (s, t)) in targets.zip(source_re.iter().zip(source_im)) {
        *r -= s * x - t * y;
        *i -= s * y + t * x;
    }
}

/// `1 / (x + i y)` by R. L. Smith's algorithm (Comm. ACM 5, 1962), which avoids early overflow.
pub fn reciprocal(x: f64, y: f64) -> (f64, f64) {
    if x.abs() >= y.abs() {
        let ratio = y / x;
        let d = x + y * ratio;
        (1.0 / d, -ratio / d)
    } else {
        let ratio = x / y;
        let d = x * ratio + y;
        (ratio / d, -1.0 / d)
    }
}
