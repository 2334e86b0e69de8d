//! The coefficients of the three-stage Radau IIA method (order 5).
//!
//! Hairer & Wanner II, table IV.5.6 for `A` and `c`, and sec. IV.8: with `A^-1 = T L T^-1`, where
//! `L` is real block-diagonal with blocks `gamma` and `[alpha -beta; beta alpha]`, the stage
//! equations decouple into one real and one complex system. The tests derive every number here from
//! `A`.
#![allow(clippy::excessive_precision, reason = "all digits of the source are kept")]

/// sqrt(6).
const S6: f64 = 2.449489742783178;

/// First abscissa, `(4 - sqrt 6) / 10`.
pub const C1: f64 = (4.0 - S6) / 10.0;
/// Second abscissa, `(4 + sqrt 6) / 10`.
pub const C2: f64 = (4.0 + S6) / 10.0;

/// Real eigenvalue of `A^-1`.
pub const GAMMA: f64 = 3.637_834_252_744_495_7;
/// Real part of the complex eigenvalues of `A^-1`.
pub const ALPHA: f64 = 2.681_082_873_627_752_1;
/// Imaginary part of the complex eigenvalues of `A^-1`.
pub const BETA: f64 = 3.050_430_199_247_410_5;

/// The transformation from `W` to the stage increments `Z = T W`.
pub const T: [[f64; 3]; 3] = [
    [9.123_239_487_089_294_3e-2, -1.412_552_950_209_542e-1, -3.002_919_410_514_742_4e-2],
    [2.417_179_327_071_070_2e-1, 2.041_293_522_937_999_3e-1, 3.829_421_127_572_619_4e-1],
    [9.660_481_826_150_929_3e-1, 1.0, 0.0],
];

/// The inverse of [`T`].
pub const T_INVERSE: [[f64; 3]; 3] = [
    [4.325_579_890_063_155, 3.391_992_518_158_098_7e-1, 5.417_705_399_358_748_7e-1],
    [-4.178_718_591_551_904_7, -3.276_828_207_610_623_9e-1, 4.766_235_545_005_504_5e-1],
    [-5.028_726_349_457_868_8e-1, 2.571_926_949_855_605_4, -5.960_392_048_282_249_2e-1],
];

/// Weights of the stage increments in the error estimate, eq. (8.19), times `gamma`.
pub const ERROR: [f64; 3] = [-(13.0 + 7.0 * S6) / 3.0, (-13.0 + 7.0 * S6) / 3.0, -1.0 / 3.0];

#[cfg(test)]
mod tests {
    use super::*;

    /// Table IV.5.6.
    fn a() -> [[f64; 3]; 3] {
        let s = 6.0_f64.sqrt();
        [
            [(88.0 - 7.0 * s) / 360.0, (296.0 - 169.0 * s) / 1800.0, (-2.0 + 3.0 * s) / 225.0],
            [(296.0 + 169.0 * s) / 1800.0, (88.0 + 7.0 * s) / 360.0, (-2.0 - 3.0 * s) / 225.0],
            [(16.0 - s) / 36.0, (16.0 + s) / 36.0, 1.0 / 9.0],
        ]
    }

    fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    }

    fn assert_close(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) {
        for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((a - b).abs() < 2e-14, "{a} {b}");
        }
    }

    const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn transformation_diagonalises_the_inverse_of_a() {
        assert_close(product(T, T_INVERSE), IDENTITY);
        let blocks = [[GAMMA, 0.0, 0.0], [0.0, ALPHA, -BETA], [0.0, BETA, ALPHA]];
        let inverse = product(product(T, blocks), T_INVERSE);
        assert_close(product(inverse, a()), IDENTITY);
    }

    #[test]
    fn rows_of_a_sum_to_the_abscissae() {
        for (row, c) in a().iter().zip([C1, C2, 1.0]) {
            assert!((row.iter().sum::<f64>() - c).abs() < 1e-15);
        }
    }

    /// With `e = ERROR / gamma` the estimate is `h f0 / gamma + e Z` before the filter; it must
    /// vanish for polynomials up to degree three, where `Z = h^k c^k` and `f0` only sees degree
    /// one.
    #[test]
    fn error_weights_annihilate_cubics() {
        for k in 1..=3 {
            let slope = if k == 1 { 1.0 } else { 0.0 };
            let sum: f64 =
                ERROR.iter().zip([C1, C2, 1.0]).map(|(e, c)| e * c.powi(k)).sum::<f64>() + slope;
            assert!(sum.abs() < 1e-14, "degree {k}: {sum}");
        }
    }
}
