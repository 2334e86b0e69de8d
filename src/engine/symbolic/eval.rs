//! The values of operators: the one definition that constant folding, the interpreter, the functions that
//! machine code calls, and the tests share. The formulas are in the [table](crate::ir::builtin).

use crate::ir::builtin::{Domain, binary_builtins, unary_builtins};
use crate::ir::expr::{Binary, Unary};
use crate::ir::external::Externals;

/// The value of a unary operator; Boolean values are 0 and 1.
#[inline]
pub fn unary(op: Unary, x: f64, externals: &Externals) -> f64 {
    unary_inlined(op, x, externals)
}

/// The value of a binary operator; Boolean values are 0 and 1.
#[inline]
pub fn binary(op: Binary, x: f64, y: f64, externals: &Externals) -> f64 {
    binary_inlined(op, x, y, externals)
}

/// As [`unary`], for the loop of the interpreter.
#[inline(always)]
pub fn unary_inlined(op: Unary, x: f64, externals: &Externals) -> f64 {
    macro_rules! value {
        (($a:ident, $_y:ident, $_g:ident) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slope:expr })*) => {
            match op {
                $(Unary::$op => { let $a = x; $value })*
                Unary::External(f) => externals.get(f).eval(&[x]),
                // Known at run time only.
                Unary::Carried(_) | Unary::Text(_) => f64::NAN,
            }
        };
    }
    unary_builtins!(value)
}

/// As [`binary`], for the loop of the interpreter.
#[inline(always)]
pub fn binary_inlined(op: Binary, x: f64, y: f64, externals: &Externals) -> f64 {
    macro_rules! value {
        (($a:ident, $b:ident, $_y:ident, $_g:ident, $_seed:ident)
         $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slopes:expr; $chain:expr })*) => {
            match op {
                $(Binary::$op => { let ($a, $b) = (x, y); $value })*
                Binary::External(f) => externals.get(f).eval(&[x, y]),
            }
        };
    }
    binary_builtins!(value)
}

/// `a ^ b`; small integral exponents by multiplication, which is exact where `powf` may not be.
#[inline]
pub fn power(a: f64, b: f64) -> f64 {
    if b == 2.0 {
        a * a
    } else if b.fract() == 0.0 && b.abs() < 64.0 {
        a.powi(b as i32)
    } else {
        a.powf(b)
    }
}

/// The value of a unary operator, with an argument outside of its domain moved to the border: how a
/// branch continues, for a moment, beyond the point at which it will be left.
pub fn unary_inside(op: Unary, a: f64, externals: &Externals) -> f64 {
    let domain = op.facts().map_or(Domain::Everywhere, |row| row.domain);
    unary(op, domain.clamp(a), externals)
}

/// The value of a binary operator, with arguments outside of its domain moved to the border.
pub fn binary_inside(op: Binary, a: f64, b: f64, externals: &Externals) -> f64 {
    match op {
        Binary::Pow if a < 0.0 && b.fract() != 0.0 => power(0.0, b),
        _ => binary(op, a, b, externals),
    }
}

#[inline]
fn truth(b: bool) -> f64 {
    f64::from(u8::from(b))
}

#[inline]
fn sign(a: f64) -> f64 {
    if a > 0.0 {
        1.0
    } else if a < 0.0 {
        -1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values from Abramowitz and Stegun, Handbook of Mathematical Functions, 1964.
    #[test]
    fn functions_have_their_tabulated_values() {
        let unary = [
            (Unary::Sin, 1.0, 0.841_470_984_807_896_5),
            (Unary::Cos, 1.0, 0.540_302_305_868_139_7),
            (Unary::Tan, 1.0, 1.557_407_724_654_902_2),
            (Unary::Asin, 0.5, std::f64::consts::FRAC_PI_6),
            (Unary::Acos, 0.5, std::f64::consts::FRAC_PI_3),
            (Unary::Atan, 1.0, std::f64::consts::FRAC_PI_4),
            (Unary::Sinh, 1.0, 1.175_201_193_643_801_4),
            (Unary::Cosh, 1.0, 1.543_080_634_815_243_7),
            (Unary::Tanh, 1.0, 0.761_594_155_955_764_9),
            (Unary::Exp, 1.0, std::f64::consts::E),
            (Unary::Log, 2.0, std::f64::consts::LN_2),
            (Unary::Log10, 2.0, std::f64::consts::LOG10_2),
            (Unary::Sqrt, 2.0, std::f64::consts::SQRT_2),
            (Unary::Abs, -1.5, 1.5),
            (Unary::Sign, -1.5, -1.0),
            (Unary::Floor, -1.5, -2.0),
            (Unary::Ceil, -1.5, -1.0),
            (Unary::ToInteger, -1.5, -2.0),
            (Unary::Ordinal, 2.0, 2.0),
        ];
        for (op, a, expected) in unary {
            let value = super::unary(op, a, &Externals::EMPTY);
            assert!((value - expected).abs() < 1e-15 * expected.abs().max(1.0), "{op:?}: {value}");
        }
        let binary = [
            (Binary::Atan2, -1.0, -1.0, -3.0 * std::f64::consts::FRAC_PI_4),
            (Binary::Min, 2.0, -3.0, -3.0),
            (Binary::Max, 2.0, -3.0, 2.0),
            (Binary::Quotient, -7.0, 2.0, -3.0),
            (Binary::Mod, -7.0, 2.0, 1.0),
            (Binary::Rem, -7.0, 2.0, -1.0),
        ];
        for (op, a, b, expected) in binary {
            assert_eq!(super::binary(op, a, b, &Externals::EMPTY), expected, "{op:?}");
        }
        let rows = Unary::TABLE.iter().filter(|op| !op.called_names().is_empty()).count();
        assert_eq!(rows, unary.len(), "a function has no test of its value");
    }
}
