//! Tests against residuals, closed forms and each other.

use super::complex::ComplexLu;
use super::complex_sparse::{Complex, ComplexSparseLu};
use super::sparse::SparseLu;
use super::*;
use crate::numeric::pattern::Pattern;

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
}

#[test]
fn large_singular_matrix_is_found() {
    let n = SMALL + 8;
    let mut a = scatter(n * n, 7);
    a[5 * n..6 * n].fill(0.0);
    assert!(DenseLu::new(n).factor(&a).is_err());
}

/// [i 1; -1 i] has determinant -1 + 1 = 0. A column of zeros is met in the second half of the columns.
#[test]
fn singular_complex_matrix_is_found() {
    let mut complex = ComplexLu::new(2);
    let singular = complex.factor(&[0.0, -1.0, 1.0, 0.0], &[1.0, 0.0, 0.0, 1.0]);
    assert_eq!(singular, Err(Singular { column: 1 }));
    let n = 70;
    let (mut re, mut im) = (scatter(n * n, 7), scatter(n * n, 8));
    re[51 * n..52 * n].fill(0.0);
    im[51 * n..52 * n].fill(0.0);
    assert_eq!(ComplexLu::new(n).factor(&re, &im), Err(Singular { column: 51 }));
    (re, im) = (scatter(n * n, 7), scatter(n * n, 8));
    re[60] = f64::NAN;
    assert!(ComplexLu::new(n).factor(&re, &im).is_err());
    re[0] = f64::NAN;
    assert_eq!(ComplexLu::new(n).factor(&re, &im), Err(Singular { column: 0 }));
}

/// Both ways to decompose choose the same pivots: their factors differ by rounding alone.
#[test]
fn complex_blocks_agree_with_plain_loops() {
    let n = 70;
    let (re, im) = (scatter(n * n, 3), scatter(n * n, 4));
    let decompose = |by: fn(usize, &mut [f64], &mut [f64], &mut [usize]) -> _| {
        let (mut re, mut im, mut pivots) = (re.clone(), im.clone(), vec![0; n]);
        let done: Result<(), Singular> = by(n, &mut re, &mut im, &mut pivots);
        done.unwrap();
        (re, im, pivots)
    };
    let (a, b) = (decompose(small_lu::factor_complex), decompose(complex_blocks::factor));
    assert_eq!(a.2, b.2);
    assert!(largest_difference(&a.0, &b.0).max(largest_difference(&a.1, &b.1)) < 1e-11);
}

/// A full matrix is decomposed by blocks, a chain entry by entry; both solve what a dense decomposition solves.
#[test]
fn complex_sparse_solution_agrees_with_dense() {
    for (n, reach) in [(80, 1), (160, 160)] {
        let near = |j: usize| (0..n).filter(move |i| j.abs_diff(*i) <= reach);
        let entries: Vec<(usize, usize)> =
            (0..n).flat_map(|j| near(j).map(move |i| (i, j))).collect();
        let pattern = Pattern::from_entries(n, n, &entries);
        let (re, im) = (scatter(pattern.entries(), 9), scatter(pattern.entries(), 10));
        let values: Vec<Complex> = re.iter().zip(&im).map(|(x, y)| Complex::new(*x, *y)).collect();
        let (mut dense_re, mut dense_im) = (vec![0.0; n * n], vec![0.0; n * n]);
        for j in 0..n {
            for &i in pattern.column(j) {
                let k = pattern.position(i, j).unwrap();
                (dense_re[j * n + i], dense_im[j * n + i]) = (re[k], im[k]);
            }
        }
        let mut dense = ComplexLu::new(n);
        dense.factor(&dense_re, &dense_im).unwrap();
        let (mut x, mut y) = (scatter(n, 11), scatter(n, 12));
        let mut b: Vec<Complex> = x.iter().zip(&y).map(|(x, y)| Complex::new(*x, *y)).collect();
        dense.solve_in_place(&mut x, &mut y);
        let mut sparse = ComplexSparseLu::new(pattern).unwrap();
        // The second decomposition has the form that the first has chosen.
        for _ in 0..2 {
            sparse.factor(&values).unwrap();
            assert_eq!(sparse.is_by_blocks(), reach > 1);
        }
        sparse.solve_in_place(&mut b);
        let size = x.iter().chain(&y).fold(1.0_f64, |m, x| m.max(x.abs()));
        for (z, (x, y)) in b.iter().zip(x.iter().zip(&y)) {
            assert!((z - Complex::new(*x, *y)).norm() < 1e-8 * size, "{z} {x} {y}");
        }
        let zeros = vec![Complex::new(0.0, 0.0); values.len()];
        assert!(sparse.factor(&zeros).is_err());
    }
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
