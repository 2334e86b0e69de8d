//! Right eigenvectors of real square matrices whose eigenvalues are known, by inverse iteration.
//!
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, section 7.6.1. The vectors of equal eigenvalues
//! are made orthogonal to each other, as far as the matrix has so many.

use super::eigenvalues::Complex;
use super::linear::complex::ComplexLu;

/// Iterations for one vector; the first one is usually enough.
const ITERATIONS: usize = 4;
/// Eigenvalues that differ by less, relative to the matrix, are equal.
const EQUAL: f64 = 1e-9;
/// Distance of the shift from the eigenvalue, relative to the matrix: the shifted matrix has an inverse.
const SHIFT: f64 = 4.0 * f64::EPSILON;

/// A complex vector.
#[derive(Clone, PartialEq, Debug)]
pub struct Eigenvector {
    /// Real parts.
    pub re: Vec<f64>,
    /// Imaginary parts; zero for a real eigenvalue.
    pub im: Vec<f64>,
}

impl Eigenvector {
    fn norm(&self) -> f64 {
        self.re.iter().chain(&self.im).map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Takes away the part along another vector of length 1.
    fn remove(&mut self, other: &Eigenvector) {
        let pairs = || other.re.iter().zip(&other.im).zip(self.re.iter().zip(&self.im));
        let re: f64 = pairs().map(|((a, b), (x, y))| a * x + b * y).sum();
        let im: f64 = pairs().map(|((a, b), (x, y))| a * y - b * x).sum();
        for (k, (a, b)) in other.re.iter().zip(&other.im).enumerate() {
            self.re[k] -= re * a - im * b;
            self.im[k] -= re * b + im * a;
        }
    }

    /// Scales to length 1, with the largest component real and positive.
    fn normalize(&mut self) {
        let size = |k: usize| self.re[k].hypot(self.im[k]);
        let largest = (0..self.re.len()).fold(0, |m, k| if size(k) > size(m) { k } else { m });
        let (norm, most) = (self.norm(), size(largest));
        if norm == 0.0 || most == 0.0 {
            return;
        }
        let (c, s) = (self.re[largest] / (most * norm), -self.im[largest] / (most * norm));
        for (x, y) in self.re.iter_mut().zip(&mut self.im) {
            (*x, *y) = (c * *x - s * *y, c * *y + s * *x);
        }
    }
}

/// The eigenvectors of length 1 of the column-major matrix `a` of order `n`, one for each of its eigenvalues; `None` if
/// a vector is not finite.
pub fn eigenvectors(n: usize, a: &[f64], values: &[Complex]) -> Option<Vec<Eigenvector>> {
    let size = a.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    let mut found: Vec<Eigenvector> = Vec::with_capacity(values.len());
    for (k, value) in values.iter().enumerate() {
        let equal: Vec<usize> =
            (0..k).filter(|j| (values[*j] - *value).abs() <= EQUAL * size).collect();
        let others: Vec<Eigenvector> = equal.iter().map(|j| found[*j].clone()).collect();
        found.push(eigenvector(n, a, *value, size, &others)?);
    }
    Some(found)
}

fn eigenvector(
    n: usize,
    a: &[f64],
    value: Complex,
    size: f64,
    others: &[Eigenvector],
) -> Option<Eigenvector> {
    let mut lu = ComplexLu::new(n);
    let mut shift = SHIFT * size;
    loop {
        let mut re = a.to_vec();
        let mut im = vec![0.0; n * n];
        (0..n).for_each(|k| {
            re[k + n * k] -= value.re + shift;
            im[k + n * k] -= value.im;
        });
        match lu.factor(&re, &im) {
            Ok(()) => break,
            Err(_) if shift < size => shift *= 16.0,
            Err(_) => return None,
        }
    }
    // A start that is not orthogonal to any vector that a model is likely to have.
    let seed = others.len() as f64;
    let mut x = Eigenvector {
        re: (0..n).map(|k| 1.0 + 0.1 * (1.7 * k as f64 + 2.3 * seed).sin()).collect(),
        im: vec![0.0; n],
    };
    for _ in 0..ITERATIONS {
        lu.solve_in_place(&mut x.re, &mut x.im);
        others.iter().for_each(|other| x.remove(other));
        x.normalize();
        if x.re.iter().chain(&x.im).any(|x| !x.is_finite()) {
            return None;
        }
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::super::eigenvalues::eigenvalues;
    use super::*;

    /// The largest entry of `A x - lambda x`.
    fn error(n: usize, a: &[f64], value: Complex, x: &Eigenvector) -> f64 {
        let row = |i: usize, v: &[f64]| (0..n).map(|j| a[i + n * j] * v[j]).sum::<f64>();
        (0..n).fold(0.0, |most: f64, i| {
            let re = row(i, &x.re) - value.re * x.re[i] + value.im * x.im[i];
            let im = row(i, &x.im) - value.re * x.im[i] - value.im * x.re[i];
            most.max(re.hypot(im))
        })
    }

    #[test]
    fn vectors_satisfy_the_definition() {
        // Rows (4 1; 2 3): values 5 and 2, vectors (1, 1) and (1, -2).
        let a = [4.0, 2.0, 1.0, 3.0];
        let values = eigenvalues(2, &a).unwrap();
        let vectors = eigenvectors(2, &a, &values).unwrap();
        assert!((values[0].re - 5.0).abs() < 1e-12);
        assert!((vectors[0].re[0] - vectors[0].re[1]).abs() < 1e-12);
        assert!((vectors[1].re[1] / vectors[1].re[0] + 2.0).abs() < 1e-12);
        // A rotation by 90 degrees has i and -i.
        let turn = [0.0, 1.0, -1.0, 0.0];
        let values = eigenvalues(2, &turn).unwrap();
        for (value, vector) in values.iter().zip(eigenvectors(2, &turn, &values).unwrap()) {
            assert!(error(2, &turn, *value, &vector) < 1e-12);
            assert!((vector.norm() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn equal_values_have_independent_vectors() {
        // The matrix of ones and the identity: 4, 1, 1.
        let a = [2.0, 1.0, 1.0, 1.0, 2.0, 1.0, 1.0, 1.0, 2.0];
        let values = eigenvalues(3, &a).unwrap();
        let vectors = eigenvectors(3, &a, &values).unwrap();
        for (value, vector) in values.iter().zip(&vectors) {
            assert!(error(3, &a, *value, vector) < 1e-12);
        }
        let dot: f64 = vectors[1].re.iter().zip(&vectors[2].re).map(|(x, y)| x * y).sum();
        assert!(dot.abs() < 1e-12);
    }
}
