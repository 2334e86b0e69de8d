//! Eigenvalues of symmetric matrices, by Jacobi's rotations.
//!
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, section 8.5 (cyclic by row).
//! For positive definite matrices the small eigenvalues have a small relative error (J. Demmel, K.
//! Veselić, *Jacobi's method is more accurate than QR*, SIAM J. Matrix Anal. Appl. 13, 1992); the
//! callers need exactly these. Suited to a few dozen rows.

/// Maximum number of sweeps over all pairs; convergence is quadratic, about six are typical.
const SWEEPS: usize = 60;

/// Eigenvalues in increasing order, each with its unit eigenvector, of the symmetric matrix `a` of
/// order `n`, column-major. Empty if an entry is not finite.
pub fn symmetric(n: usize, a: &[f64]) -> Vec<(f64, Vec<f64>)> {
    if a.iter().any(|x| !x.is_finite()) {
        return Vec::new();
    }
    let mut a = a.to_vec();
    let mut v = vec![0.0; n * n];
    (0..n).for_each(|i| v[i + n * i] = 1.0);
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                let (app, aqq, apq) = (a[p + n * p], a[q + n * q], a[p + n * q]);
                let negligible = f64::EPSILON * (app.abs() * aqq.abs()).sqrt();
                if apq == 0.0 || apq.abs() <= negligible {
                    continue;
                }
                rotated = true;
                let tau = (aqq - app) / (2.0 * apq);
                let t = tau.signum() / (tau.abs() + tau.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                rotate(n, &mut a, &mut v, (p, q), (c, t * c));
            }
        }
        if !rotated {
            break;
        }
    }
    let mut pairs: Vec<(f64, Vec<f64>)> =
        (0..n).map(|i| (a[i + n * i], v[n * i..n * i + n].to_vec())).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs
}

/// `a = J' a J` and `v = v J` with the rotation `J` in the plane `(p, q)`.
fn rotate(n: usize, a: &mut [f64], v: &mut [f64], (p, q): (usize, usize), (c, s): (f64, f64)) {
    let rotate_pair = |matrix: &mut [f64], i: usize, j: usize| {
        let (x, y) = (matrix[i], matrix[j]);
        (matrix[i], matrix[j]) = (c * x - s * y, s * x + c * y);
    };
    for k in 0..n {
        rotate_pair(a, k + n * p, k + n * q);
    }
    for k in 0..n {
        rotate_pair(a, p + n * k, q + n * k);
    }
    for k in 0..n {
        rotate_pair(v, k + n * p, k + n * q);
    }
    (a[p + n * q], a[q + n * p]) = (0.0, 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second difference of a chain: `2 - 2 cos(k pi / (n + 1))`.
    #[test]
    fn second_difference() {
        let n = 9;
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            a[i + n * i] = 2.0;
            if i + 1 < n {
                (a[i + n * (i + 1)], a[i + 1 + n * i]) = (-1.0, -1.0);
            }
        }
        let pairs = symmetric(n, &a);
        for (k, (value, vector)) in pairs.iter().enumerate() {
            let angle = (k + 1) as f64 * std::f64::consts::PI / (n + 1) as f64;
            assert!((value - (2.0 - 2.0 * angle.cos())).abs() < 1e-14, "{value}");
            for i in 0..n {
                let product: f64 = (0..n).map(|j| a[i + n * j] * vector[j]).sum();
                assert!((product - value * vector[i]).abs() < 1e-13);
            }
        }
    }

    /// A badly scaled matrix `D A D` with `A = [1 c; c 1]` and `D = diag(1, 1e-6)`; the determinant
    /// gives the small eigenvalue to all digits.
    #[test]
    fn a_small_eigenvalue_is_accurate() {
        let (c, d) = (0.75, 1e-6);
        let pairs = symmetric(2, &[1.0, c * d, c * d, d * d]);
        let large = 1.0 + c * c * d * d;
        let small = d * d * (1.0 - c * c) / large;
        assert!((pairs[0].0 / small - 1.0).abs() < 1e-11, "{}", pairs[0].0 / small);
        assert!(symmetric(1, &[f64::NAN]).is_empty());
    }
}
