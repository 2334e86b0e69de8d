//! The factors of the matrix of a torn block, which may be singular.

use crate::numeric::linear::DenseLu;
use crate::numeric::pseudo_inverse::PseudoInverse;
use crate::runtime::machine::Fault;

/// Factors of a matrix.
pub(super) enum Factors {
    /// Those of a regular matrix.
    Regular(DenseLu),
    /// What stands for the inverse of a singular one: unknowns that the equations do not determine are constant.
    Singular(PseudoInverse),
}

impl Factors {
    /// Those of an `n` by `n` matrix, column by column, of the block `torn_block`. Errors: an entry that is not finite.
    pub(super) fn of(n: usize, matrix: &[f64], torn_block: usize) -> Result<Factors, Fault> {
        let mut lu = DenseLu::new(n);
        match lu.factor(matrix) {
            Ok(()) => Ok(Factors::Regular(lu)),
            Err(s) => {
                let fault = Fault::Singular { torn_block, unknown: s.column };
                PseudoInverse::new(n, matrix).map(Factors::Singular).ok_or(fault)
            }
        }
    }

    /// Overwrites a right side with the solution. False if there is none; the right side then has that of least squares.
    pub(super) fn solve_in_place(&mut self, right: &mut [f64]) -> bool {
        match self {
            Factors::Regular(lu) => {
                lu.solve_in_place(right);
                true
            }
            Factors::Singular(inverse) => inverse.solve_in_place(right),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_singular_matrix_does_not_determine_is_constant() {
        let mut factors = Factors::of(2, &[4.0, 0.0, 0.0, 0.0], 0).unwrap();
        let mut right = [2.0, 0.0];
        assert!(factors.solve_in_place(&mut right));
        assert_eq!(right, [0.5, 0.0]);
        assert!(!factors.solve_in_place(&mut [2.0, 1.0]));
        assert!(Factors::of(1, &[f64::NAN], 7).is_err());
    }
}
