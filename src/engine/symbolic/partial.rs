//! The partial derivatives of each operator at a point: `gradient` gives them as expressions, this as
//! numbers. Both follow the same conventions: relations and integer-valued functions have derivative
//! zero, and at a corner the branch counts that gives the value.

use super::arithmetic::{Arithmetic, Numbers};
use crate::ir::builtin::{binary_builtins, unary_builtins};
use crate::ir::expr::{Binary, Unary};
use crate::ir::external::Externals;

/// `d op(x) / dx`, where `value` is `op(x)`.
pub fn unary(op: Unary, x: f64, value: f64, externals: &Externals) -> f64 {
    macro_rules! derivative {
        (($a:ident, $y:ident, $g:ident) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slope:expr })*) => {
            match op {
                $(Unary::$op => {
                    #[allow(unused_variables)]
                    let ($a, $y, $g) = (x, value, &mut Numbers);
                    let slope: Option<f64> = $slope;
                    slope.unwrap_or(0.0)
                })*
                Unary::Text(_) => 0.0,
                Unary::External(f) => externals.get(f).slope(0, &[x]),
                // A program that reads the past is not differentiated.
                Unary::Carried(_) => f64::NAN,
            }
        };
    }
    unary_builtins!(derivative)
}

/// `(d op(x, y) / dx, d op(x, y) / dy)`, where `value` is `op(x, y)`.
pub fn binary(op: Binary, x: f64, y: f64, value: f64, externals: &Externals) -> (f64, f64) {
    macro_rules! derivatives {
        (($a:ident, $b:ident, $y:ident, $_g:ident, $_seed:ident)
         $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slopes:expr; $chain:expr })*) => {
            match op {
                $(Binary::$op => {
                    #[allow(unused_variables)]
                    let ($a, $b, $y) = (x, y, value);
                    $slopes
                })*
                Binary::External(f) => {
                    let f = externals.get(f);
                    (f.slope(0, &[x, y]), f.slope(1, &[x, y]))
                }
            }
        };
    }
    binary_builtins!(derivatives)
}

/// By the exponent only where the base is positive: elsewhere it must be constant.
fn power_slopes(a: f64, b: f64, value: f64) -> (f64, f64) {
    let by_base = if b == 0.0 { 0.0 } else { b * super::eval::power(a, b - 1.0) };
    let by_exponent = if a > 0.0 { value * a.ln() } else { 0.0 };
    (by_base, by_exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_integral_power_of_a_negative_base_has_a_slope() {
        assert_eq!(binary(Binary::Pow, -2.0, 3.0, -8.0, &Externals::EMPTY), (12.0, 0.0));
        assert_eq!(binary(Binary::Pow, 0.0, 1.0, 0.0, &Externals::EMPTY).0, 1.0);
    }
}
