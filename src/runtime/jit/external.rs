//! The functions that machine code calls: those of [`eval`], which the interpreter calls too.

use crate::ir::builtin::{binary_builtins, unary_builtins};
use crate::ir::expr::{Binary, Unary};
use crate::ir::native::Native;
use crate::symbolic::eval;

/// Address of a function `extern "C" fn(f64) -> f64` that computes a unary operator.
pub fn unary(op: Unary) -> usize {
    macro_rules! address {
        (($($_:ident),*) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slope:expr })*) => {
            match op {
                // Has a different signature.
                Unary::Native(_) => native_unary(),
                // Interpreted between fragments, or used in messages only.
                Unary::Carried(_) | Unary::Text(_) => native_unary(),
                $(Unary::$op => {
                    extern "C" fn compute(a: f64) -> f64 {
                        eval::unary(Unary::$op, a)
                    }
                    compute as *const () as usize
                })*
            }
        };
    }
    unary_builtins!(address)
}

/// Address of a function `extern "C" fn(f64, f64) -> f64` that calls a function made of data, by
/// its number and its argument.
pub fn native_unary() -> usize {
    extern "C" fn compute(number: f64, a: f64) -> f64 {
        Native::numbered(number as u32).unary(a)
    }
    compute as *const () as usize
}

/// Address of a function `extern "C" fn(f64, f64, f64) -> f64` that calls a function made of data, by
/// its number and its arguments.
pub fn native_binary() -> usize {
    extern "C" fn compute(number: f64, a: f64, b: f64) -> f64 {
        Native::numbered(number as u32).binary(a, b)
    }
    compute as *const () as usize
}

/// Address of a function `extern "C" fn(f64, f64) -> f64` that computes a binary operator.
pub fn binary(op: Binary) -> usize {
    macro_rules! address {
        (($($_:ident),*) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slopes:expr; $chain:expr })*) => {
            match op {
                // Has a different signature.
                Binary::Native(_) => native_binary(),
                $(Binary::$op => {
                    extern "C" fn compute(a: f64, b: f64) -> f64 {
                        eval::binary(Binary::$op, a, b)
                    }
                    compute as *const () as usize
                })*
            }
        };
    }
    binary_builtins!(address)
}
