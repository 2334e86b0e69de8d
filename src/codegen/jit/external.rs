//! The functions that machine code calls: those of [`eval`], which the interpreter calls too.

use crate::ir::expr::{Binary, Unary};
use crate::symbolic::eval;

/// Address of a function `extern "C" fn(f64) -> f64` that computes a unary operator.
pub fn unary(op: Unary) -> usize {
    macro_rules! addresses {
        ($($name:ident)*) => {
            match op {
                $(Unary::$name => {
                    extern "C" fn compute(a: f64) -> f64 {
                        eval::unary(Unary::$name, a)
                    }
                    compute as *const () as usize
                })*
            }
        };
    }
    addresses! {
        Neg Not Sin Cos Tan Asin Acos Atan Sinh Cosh Tanh Exp Log Log10 Sqrt Abs Sign Floor Ceil
        ToInteger Ordinal
    }
}

/// Address of a function `extern "C" fn(f64, f64) -> f64` that computes a binary operator.
pub fn binary(op: Binary) -> usize {
    macro_rules! addresses {
        ($($name:ident)*) => {
            match op {
                $(Binary::$name => {
                    extern "C" fn compute(a: f64, b: f64) -> f64 {
                        eval::binary(Binary::$name, a, b)
                    }
                    compute as *const () as usize
                })*
            }
        };
    }
    addresses! {
        Add Sub Mul Div Pow Less LessEqual Greater GreaterEqual Equal NotEqual And Or Atan2 Min Max
        Quotient Mod Rem
    }
}
