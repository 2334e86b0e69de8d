//! Many right-hand sides of one small matrix: a *panel*.
//!
//! A panel has a row for each component of a system and a column for each right-hand side, and is stored row by
//! row, `width` numbers each. The same operation on neighbours is what processors do fastest: a panel of 64 columns
//! takes a fifth of the time of 64 vectors. The factors are those of [`super::small_lu`].

/// Columns that are processed together; the width of a panel is a multiple of it.
pub const LANES: usize = 4;

/// Smallest width of a panel with so many columns; never zero.
pub fn width(columns: usize) -> usize {
    columns.max(1).div_ceil(LANES) * LANES
}

/// Exchanges the rows `a` and `b`.
fn swap(panel: &mut [f64], width: usize, a: usize, b: usize) {
    if a != b {
        let (low, high) = panel.split_at_mut(a.max(b) * width);
        low[a.min(b) * width..][..width].swap_with_slice(&mut high[..width]);
    }
}

#[inline]
fn lanes(panel: &[f64], at: usize) -> [f64; LANES] {
    std::array::from_fn(|l| panel[at + l])
}

/// `target -= factor * x` on the lanes that begin at `at`.
#[inline]
fn subtract(target: &mut [f64], at: usize, factor: f64, x: &[f64; LANES]) {
    for (t, x) in target[at..at + LANES].iter_mut().zip(x) {
        *t -= factor * x;
    }
}

/// Solves with the factors of [`super::small_lu::factor`] of a matrix of order `n`, overwriting the panel `b` with the
/// solutions.
pub fn solve(n: usize, lu: &[f64], pivots: &[usize], b: &mut [f64], width: usize) {
    for (k, &pivot) in pivots[..n].iter().enumerate() {
        swap(b, width, k, pivot);
    }
    for first in (0..width).step_by(LANES) {
        let at = |row: usize| row * width + first;
        for k in 0..n {
            let x = lanes(b, at(k));
            for (i, factor) in lu[k * n..(k + 1) * n].iter().enumerate().skip(k + 1) {
                if *factor != 0.0 {
                    subtract(b, at(i), *factor, &x);
                }
            }
        }
        for k in (0..n).rev() {
            let x = lanes(b, at(k)).map(|x| x * lu[k * n + k]);
            b[at(k)..at(k) + LANES].copy_from_slice(&x);
            for (i, factor) in lu[k * n..k * n + k].iter().enumerate() {
                if *factor != 0.0 {
                    subtract(b, at(i), *factor, &x);
                }
            }
        }
    }
}

/// The same with the factors of [`super::small_lu::factor_complex`], for a real and an imaginary plane.
pub fn solve_complex(
    n: usize,
    (lu_re, lu_im): (&[f64], &[f64]),
    pivots: &[usize],
    b_re: &mut [f64],
    b_im: &mut [f64],
    width: usize,
) {
    for (k, &pivot) in pivots[..n].iter().enumerate() {
        swap(b_re, width, k, pivot);
        swap(b_im, width, k, pivot);
    }
    for first in (0..width).step_by(LANES) {
        let at = |row: usize| row * width + first;
        for k in 0..n {
            let (x, y) = (lanes(b_re, at(k)), lanes(b_im, at(k)));
            for i in k + 1..n {
                let factor = (lu_re[k * n + i], lu_im[k * n + i]);
                subtract_complex(b_re, b_im, at(i), factor, (&x, &y));
            }
        }
        for k in (0..n).rev() {
            let (re, im) = (lu_re[k * n + k], lu_im[k * n + k]);
            let (s, t) = (lanes(b_re, at(k)), lanes(b_im, at(k)));
            let x: [f64; LANES] = std::array::from_fn(|l| s[l] * re - t[l] * im);
            let y: [f64; LANES] = std::array::from_fn(|l| s[l] * im + t[l] * re);
            b_re[at(k)..at(k) + LANES].copy_from_slice(&x);
            b_im[at(k)..at(k) + LANES].copy_from_slice(&y);
            for i in 0..k {
                let factor = (lu_re[k * n + i], lu_im[k * n + i]);
                subtract_complex(b_re, b_im, at(i), factor, (&x, &y));
            }
        }
    }
}

/// `target -= (re + i im) * (x + i y)` on the lanes that begin at `at`.
#[inline]
fn subtract_complex(
    target_re: &mut [f64],
    target_im: &mut [f64],
    at: usize,
    (re, im): (f64, f64),
    (x, y): (&[f64; LANES], &[f64; LANES]),
) {
    if re == 0.0 && im == 0.0 {
        return;
    }
    let planes = target_re[at..at + LANES].iter_mut().zip(&mut target_im[at..at + LANES]);
    for ((r, i), (x, y)) in planes.zip(x.iter().zip(y)) {
        *r -= re * x - im * y;
        *i -= re * y + im * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::small_lu;

    /// A matrix without structure, and right-hand sides, of order `n`.
    fn numbers(count: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        (0..count).map(|_| next()).collect()
    }

    /// Every column of a panel is the solution of its own right-hand side, to the bit.
    #[test]
    fn a_panel_solves_each_column() {
        for (n, columns) in [(1, 1), (3, 5), (9, 20), (15, 64)] {
            let width = width(columns);
            let (mut re, mut im) = (numbers(n * n, 1), numbers(n * n, 2));
            let (mut real, mut pivots) = (re.clone(), vec![0; n]);
            small_lu::factor(n, &mut real, &mut pivots).unwrap();
            let panel = numbers(n * width, 3);
            let column = |panel: &[f64], d: usize| -> Vec<f64> {
                (0..n).map(|i| panel[i * width + d]).collect()
            };
            let mut solved = panel.clone();
            solve(n, &real, &pivots, &mut solved, width);
            for d in 0..columns {
                let mut b = column(&panel, d);
                small_lu::solve(n, &real, &pivots, &mut b);
                assert_eq!(b, column(&solved, d));
            }
            small_lu::factor_complex(n, &mut re, &mut im, &mut pivots).unwrap();
            let (mut x, mut y) = (panel.clone(), numbers(n * width, 4));
            let other = y.clone();
            solve_complex(n, (&re, &im), &pivots, &mut x, &mut y, width);
            for d in 0..columns {
                let (mut b, mut c) = (column(&panel, d), column(&other, d));
                small_lu::solve_complex(n, (&re, &im), &pivots, &mut b, &mut c);
                assert_eq!((b, c), (column(&x, d), column(&y, d)));
            }
        }
    }
}
