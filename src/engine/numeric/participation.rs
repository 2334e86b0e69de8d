//! How much each state takes part in each eigenvalue of a linear system.
//!
//! I. J. Pérez-Arriaga, G. C. Verghese, F. C. Schweppe, Selective modal analysis, *IEEE Trans. Power Apparatus and
//! Systems* 101 (1982) 3117-3125: the products of the components of left and right eigenvectors, which do not depend on
//! the units of the states. Where the right vectors do not span the space, as for a double integrator, the squares of
//! their own components take the place of the products.

use super::eigenvalues::Complex;
use super::eigenvectors::{Eigenvector, eigenvectors};
use super::linear::complex::ComplexLu;

/// Left and right vectors whose products are greater than this belong to an eigenvalue without enough vectors.
const DEFECTIVE: f64 = 1e6;

/// For each eigenvalue of the column-major matrix `a` of order `n` the parts of the states, which sum to 1; `None` if a
/// vector is not finite.
pub fn participation(n: usize, a: &[f64], values: &[Complex]) -> Option<Vec<Vec<f64>>> {
    let right = eigenvectors(n, a, values)?;
    let left = inverse(n, &right);
    let parts = |k: usize, vector: &Eigenvector| -> Vec<f64> {
        let size = |i: usize| vector.re[i].hypot(vector.im[i]);
        // Row k of the inverse holds the components of the left vector.
        let product = |i: usize| left.as_ref().map(|all| size(i) * all[i][k]);
        let products: Option<Vec<f64>> = (0..n).map(product).collect();
        let usable = products.filter(|all| all.iter().all(|p| *p < DEFECTIVE));
        normalized(usable.unwrap_or_else(|| (0..n).map(|i| size(i) * size(i)).collect()))
    };
    Some(right.iter().enumerate().map(|(k, vector)| parts(k, vector)).collect())
}

/// The moduli of the inverse of the matrix of these columns, by columns; `None` if it is singular.
fn inverse(n: usize, columns: &[Eigenvector]) -> Option<Vec<Vec<f64>>> {
    let plane = |part: fn(&Eigenvector) -> &Vec<f64>| -> Vec<f64> {
        columns.iter().flat_map(|v| part(v).clone()).collect()
    };
    let mut lu = ComplexLu::new(n);
    lu.factor(&plane(|v| &v.re), &plane(|v| &v.im)).ok()?;
    let column = |i: usize| {
        let (mut re, mut im) = (vec![0.0; n], vec![0.0; n]);
        re[i] = 1.0;
        lu.solve_in_place(&mut re, &mut im);
        re.iter().zip(&im).map(|(x, y)| x.hypot(*y)).collect::<Vec<f64>>()
    };
    let all: Vec<Vec<f64>> = (0..n).map(column).collect();
    all.iter().flatten().all(|x| x.is_finite()).then_some(all)
}

fn normalized(parts: Vec<f64>) -> Vec<f64> {
    let sum: f64 = parts.iter().sum();
    match sum > 0.0 {
        true => parts.iter().map(|p| p / sum).collect(),
        false => parts,
    }
}

#[cfg(test)]
mod tests {
    use super::super::eigenvalues::eigenvalues;
    use super::*;

    fn of(n: usize, a: &[f64]) -> Vec<Vec<f64>> {
        participation(n, a, &eigenvalues(n, a).unwrap()).unwrap()
    }

    /// Rows (4 1; 2 3): right vectors (1, 1) and (1, -2), left vectors (2, 1) and (1, -1).
    #[test]
    fn parts_are_products_of_left_and_right_vectors() {
        let found = of(2, &[4.0, 2.0, 1.0, 3.0]);
        for (parts, expected) in found.iter().zip([[2.0 / 3.0, 1.0 / 3.0], [1.0 / 3.0, 2.0 / 3.0]])
        {
            for (part, value) in parts.iter().zip(expected) {
                assert!((part - value).abs() < 1e-12, "{found:?}");
            }
        }
    }

    /// States in other units: the diagonal scaling of a matrix changes its vectors, not the parts.
    #[test]
    fn units_of_states_do_not_matter() {
        let (plain, scaled) = (of(2, &[-1.0, -9.0, 4.0, -2.0]), of(2, &[-1.0, -9e-6, 4e6, -2.0]));
        for (x, y) in plain.iter().flatten().zip(scaled.iter().flatten()) {
            assert!((x - y).abs() < 1e-9, "{plain:?} {scaled:?}");
        }
    }

    #[test]
    fn a_state_on_its_own_takes_all_and_a_double_integrator_has_its_first() {
        let parts = of(2, &[-1.0, 0.0, 0.0, -7.0]);
        let own = |k: usize| (parts[k][k] - 1.0).abs() < 1e-12 && parts[k][1 - k] < 1e-12;
        assert!(own(0) && own(1), "{parts:?}");
        // der(x) = v, der(v) = 0: one vector for both eigenvalues.
        let parts = of(2, &[0.0, 0.0, 1.0, 0.0]);
        assert!(parts.iter().all(|p| (p.iter().sum::<f64>() - 1.0).abs() < 1e-12), "{parts:?}");
    }
}
