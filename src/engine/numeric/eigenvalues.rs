//! Eigenvalues of real square matrices: balancing, reduction to Hessenberg form, and the QR iteration with
//! Wilkinson's shifts, in complex arithmetic.
//!
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, sections 7.4.2 (Hessenberg form by elimination
//! is 7.4.7), 7.5.1 (deflation, shifts) and 7.5.7 (balancing). Suited to a few hundred rows.

use std::ops::{Add, Mul, Sub};

/// Iterations for one eigenvalue; about three are typical.
const MAX_ITERATIONS: usize = 100;
/// Iterations after which an exceptional shift breaks a cycle.
const EXCEPTIONAL: usize = 20;
/// Rounds of balancing.
const MAX_ROUNDS: usize = 100;

/// A complex number.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    const ZERO: Complex = Complex { re: 0.0, im: 0.0 };

    fn real(re: f64) -> Self {
        Complex { re, im: 0.0 }
    }

    /// Its modulus.
    pub fn abs(self) -> f64 {
        self.re.hypot(self.im)
    }

    fn conj(self) -> Self {
        Complex { re: self.re, im: -self.im }
    }

    fn scaled(self, factor: f64) -> Self {
        Complex { re: self.re * factor, im: self.im * factor }
    }

    fn sqrt(self) -> Self {
        let size = self.abs();
        if size == 0.0 {
            return Complex::ZERO;
        }
        let re = (0.5 * (size + self.re.abs())).sqrt();
        let im = 0.5 * self.im / re;
        match self.re >= 0.0 {
            true => Complex { re, im },
            false => Complex { re: im.abs(), im: re.copysign(self.im) },
        }
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Complex { re: self.re + b.re, im: self.im + b.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Complex { re: self.re - b.re, im: self.im - b.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Complex { re: self.re * b.re - self.im * b.im, im: self.re * b.im + self.im * b.re }
    }
}

/// The eigenvalues of the matrix `a` of order `n`, column-major, by descending real part; pairs with the positive
/// imaginary part first. `None` if an entry is not finite or the iteration does not converge.
pub fn eigenvalues(n: usize, a: &[f64]) -> Option<Vec<Complex>> {
    if a.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let mut a = a.to_vec();
    balance(n, &mut a);
    hessenberg(n, &mut a);
    let mut h: Vec<Complex> = a.iter().map(|x| Complex::real(*x)).collect();
    let size = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut found = Vec::with_capacity(n);
    let mut end = n;
    let mut iterations = 0;
    while end > 0 {
        let begin = deflate(n, &mut h, end, size);
        if begin + 1 == end {
            found.push(h[begin + n * begin]);
            end = begin;
            iterations = 0;
            continue;
        }
        iterations += 1;
        if iterations > MAX_ITERATIONS {
            return None;
        }
        step(n, &mut h, begin, end, iterations.is_multiple_of(EXCEPTIONAL));
    }
    Some(in_order(found, size))
}

/// Scales rows and columns by powers of two until their norms are about equal.
fn balance(n: usize, a: &mut [f64]) {
    for _ in 0..MAX_ROUNDS {
        let mut is_done = true;
        for i in 0..n {
            let others = || (0..n).filter(|j| *j != i);
            let column: f64 = others().map(|j| a[j + n * i].abs()).sum();
            let row: f64 = others().map(|j| a[i + n * j].abs()).sum();
            if column == 0.0 || row == 0.0 {
                continue;
            }
            let factor = (0.5 * (row / column).log2()).round().exp2();
            if column * factor + row / factor < 0.95 * (column + row) {
                is_done = false;
                for j in 0..n {
                    a[i + n * j] /= factor;
                    a[j + n * i] *= factor;
                }
            }
        }
        if is_done {
            break;
        }
    }
}

/// Reduces a matrix to upper Hessenberg form by elimination with pivoting.
fn hessenberg(n: usize, a: &mut [f64]) {
    for k in 1..n.saturating_sub(1) {
        let size = |i: &usize| a[i + n * (k - 1)].abs();
        let Some(pivot) = (k..n).max_by(|i, j| size(i).total_cmp(&size(j))) else { continue };
        if a[pivot + n * (k - 1)] == 0.0 {
            continue;
        }
        if pivot != k {
            for j in 0..n {
                a.swap(pivot + n * j, k + n * j);
            }
            for i in 0..n {
                a.swap(i + n * pivot, i + n * k);
            }
        }
        for i in k + 1..n {
            let factor = a[i + n * (k - 1)] / a[k + n * (k - 1)];
            if factor == 0.0 {
                continue;
            }
            for j in 0..n {
                a[i + n * j] -= factor * a[k + n * j];
            }
            for j in 0..n {
                a[j + n * k] += factor * a[j + n * i];
            }
            a[i + n * (k - 1)] = 0.0;
        }
    }
}

/// Sets negligible subdiagonal entries above row `end` to zero; the first row of the last unreduced block.
fn deflate(n: usize, h: &mut [Complex], end: usize, size: f64) -> usize {
    for k in (1..end).rev() {
        let mut around = h[k - 1 + n * (k - 1)].abs() + h[k + n * k].abs();
        if around == 0.0 {
            around = size;
        }
        let below = k + n * (k - 1);
        if h[below].abs() <= f64::EPSILON * around {
            h[below] = Complex::ZERO;
            return k;
        }
    }
    0
}

/// One QR step on the rows from `begin` to `end`.
fn step(n: usize, h: &mut [Complex], begin: usize, end: usize, is_exceptional: bool) {
    let at = |i: usize, j: usize| i + n * j;
    let shift = match is_exceptional {
        true => h[at(end - 1, end - 1)] + Complex::real(h[at(end - 1, end - 2)].abs()),
        false => wilkinson(
            [h[at(end - 2, end - 2)], h[at(end - 2, end - 1)]],
            [h[at(end - 1, end - 2)], h[at(end - 1, end - 1)]],
        ),
    };
    for k in begin..end {
        h[at(k, k)] = h[at(k, k)] - shift;
    }
    let mut rotations = Vec::with_capacity(end - begin);
    for k in begin..end - 1 {
        let (a, b) = (h[at(k, k)], h[at(k + 1, k)]);
        let r = a.abs().hypot(b.abs());
        let (c, s) = match r == 0.0 {
            true => (Complex::real(1.0), Complex::ZERO),
            false => (a.scaled(1.0 / r), b.scaled(1.0 / r)),
        };
        for j in k..end {
            let (upper, lower) = (h[at(k, j)], h[at(k + 1, j)]);
            h[at(k, j)] = c.conj() * upper + s.conj() * lower;
            h[at(k + 1, j)] = c * lower - s * upper;
        }
        rotations.push((c, s));
    }
    for (k, (c, s)) in (begin..).zip(rotations) {
        for i in begin..(k + 2).min(end) {
            let (left, right) = (h[at(i, k)], h[at(i, k + 1)]);
            h[at(i, k)] = left * c + right * s;
            h[at(i, k + 1)] = right * c.conj() - left * s.conj();
        }
    }
    for k in begin..end {
        h[at(k, k)] = h[at(k, k)] + shift;
    }
}

/// The eigenvalue of a matrix of order 2, given by rows, that is closer to its last entry.
fn wilkinson([a, b]: [Complex; 2], [c, d]: [Complex; 2]) -> Complex {
    let mean = (a + d).scaled(0.5);
    let half = (a - d).scaled(0.5);
    let root = (half * half + b * c).sqrt();
    let (one, other) = (mean + root, mean - root);
    if (one - d).abs() < (other - d).abs() { one } else { other }
}

/// Removes imaginary parts that are rounding errors, makes pairs exact, and sorts.
fn in_order(mut found: Vec<Complex>, size: f64) -> Vec<Complex> {
    let negligible = 1e2 * f64::EPSILON;
    for x in &mut found {
        if x.im.abs() <= negligible * x.abs().max(f64::EPSILON * size) {
            x.im = 0.0;
        }
    }
    let before = |a: &Complex, b: &Complex| {
        let close = (a.re - b.re).abs() <= negligible * a.abs().max(b.abs());
        match close {
            true => b.im.total_cmp(&a.im),
            false => b.re.total_cmp(&a.re),
        }
    };
    // `close` is not transitive, so no library sort; a few hundred entries at most.
    for i in 1..found.len() {
        let mut k = i;
        while k > 0 && before(&found[k], &found[k - 1]).is_lt() {
            found.swap(k, k - 1);
            k -= 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_rows(rows: &[&[f64]]) -> Vec<Complex> {
        let n = rows.len();
        let a: Vec<f64> = (0..n * n).map(|k| rows[k % n][k / n]).collect();
        eigenvalues(n, &a).unwrap()
    }

    fn assert_close(found: &[Complex], expected: &[(f64, f64)], tolerance: f64) {
        assert_eq!(found.len(), expected.len());
        for (x, (re, im)) in found.iter().zip(expected) {
            let distance = (x.re - re).hypot(x.im - im);
            assert!(distance <= tolerance * re.hypot(*im).max(1.0), "{found:?}");
        }
    }

    #[test]
    fn small_matrices_have_their_closed_forms() {
        assert_close(&of_rows(&[&[-3.0]]), &[(-3.0, 0.0)], 1e-15);
        // An oscillator of 2 rad/s with damping 0.1.
        let im = 2.0 * (1.0_f64 - 0.01).sqrt();
        let found = of_rows(&[&[0.0, 1.0], &[-4.0, -0.4]]);
        assert_close(&found, &[(-0.2, im), (-0.2, -im)], 1e-14);
        assert_close(&of_rows(&[&[0.0, 0.0], &[0.0, 0.0]]), &[(0.0, 0.0), (0.0, 0.0)], 0.0);
        assert!(eigenvalues(1, &[f64::NAN]).is_none());
        assert_eq!(eigenvalues(0, &[]).unwrap(), []);
    }

    /// The roots of unity are the eigenvalues of a cyclic permutation: without shifts QR would stall on it.
    #[test]
    fn cyclic_permutations_have_the_roots_of_unity() {
        let n = 7;
        let mut a = vec![0.0; n * n];
        (0..n).for_each(|i| a[(i + 1) % n + n * i] = 1.0);
        let found = eigenvalues(n, &a).unwrap();
        for k in 0..n {
            let angle = std::f64::consts::TAU * k as f64 / n as f64;
            let near = |x: &Complex| (x.re - angle.cos()).hypot(x.im - angle.sin()) < 1e-13;
            assert_eq!(found.iter().filter(|x| near(x)).count(), 1, "{found:?}");
        }
    }

    /// The second difference on n points has the eigenvalues -4 sin²(k pi / (2 n + 2)).
    #[test]
    fn a_chain_has_its_known_spectrum() {
        let n = 40;
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            a[i + n * i] = -2.0;
            if i > 0 {
                a[i + n * (i - 1)] = 1.0;
                a[i - 1 + n * i] = 1.0;
            }
        }
        let angle = |k: usize| std::f64::consts::PI * k as f64 / (2 * n + 2) as f64;
        let expected: Vec<_> = (1..=n).map(|k| (-4.0 * angle(k).sin().powi(2), 0.0)).collect();
        assert_close(&eigenvalues(n, &a).unwrap(), &expected, 1e-13);
    }

    /// Rows of very different sizes, as states in SI units have: pressures next to positions.
    #[test]
    fn scales_do_not_matter() {
        let found = of_rows(&[&[-1.0, 1e12], &[1e-14, -2.0]]);
        let root = (0.25_f64 + 0.01).sqrt();
        assert_close(&found, &[(-1.5 + root, 0.0), (-1.5 - root, 0.0)], 1e-13);
    }
}
