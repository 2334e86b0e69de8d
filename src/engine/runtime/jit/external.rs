//! The functions that machine code calls: those of [`eval`], which the interpreter calls too.

use crate::ir::builtin::{binary_builtins, unary_builtins};
use crate::ir::expr::{Binary, Unary};
use std::sync::Arc;

use crate::external::External;
use crate::ir::external::Externals;
use crate::symbolic::eval;

/// No external functions: a static, since a temporary would be dropped with each call.
static NONE: Externals = Externals::EMPTY;

/// Address of a function `extern "C" fn(f64) -> f64` that computes a unary operator.
pub fn unary(op: Unary) -> usize {
    macro_rules! address {
        (($($_:ident),*) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slope:expr })*) => {
            match op {
                // Has a different signature.
                Unary::External(_) => external_unary(),
                // Interpreted between fragments, or used in messages only.
                Unary::Carried(_) | Unary::Text(_) => external_unary(),
                $(Unary::$op => {
                    extern "C" fn compute(a: f64) -> f64 {
                        eval::unary_inlined(Unary::$op, a, &NONE)
                    }
                    compute as *const () as usize
                })*
            }
        };
    }
    unary_builtins!(address)
}

/// The external function `f` as an argument of [`external_unary`] and [`external_binary`]: the bits of
/// its address. All arguments of calls from machine code are floats.
pub fn handle(f: &Arc<dyn External>) -> f64 {
    f64::from_bits(std::ptr::from_ref(f) as u64)
}

/// The external function behind a handle.
///
/// # Safety
/// The handle is of a function in the [`Externals`] of the program that the machine code was made from.
/// The code owns a share of them, so they are neither moved nor dropped while it runs.
unsafe fn resolve<'a>(handle: f64) -> &'a dyn External {
    // SAFETY: see above.
    unsafe { &**(handle.to_bits() as *const Arc<dyn External>) }
}

/// Address of a function `extern "C" fn(f64, f64) -> f64` that calls an external function, by its
/// handle and its argument.
pub fn external_unary() -> usize {
    extern "C" fn compute(f: f64, a: f64) -> f64 {
        // SAFETY: machine code passes handles of the externals that it owns.
        unsafe { resolve(f) }.eval(&[a])
    }
    compute as *const () as usize
}

/// Address of a function `extern "C" fn(f64, f64, f64) -> f64` that calls an external function, by its
/// handle and its arguments.
pub fn external_binary() -> usize {
    extern "C" fn compute(f: f64, a: f64, b: f64) -> f64 {
        // SAFETY: machine code passes handles of the externals that it owns.
        unsafe { resolve(f) }.eval(&[a, b])
    }
    compute as *const () as usize
}

/// Address of a function `extern "C" fn(f64, f64) -> f64` that computes a binary operator.
pub fn binary(op: Binary) -> usize {
    macro_rules! address {
        (($($_:ident),*) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slopes:expr; $chain:expr })*) => {
            match op {
                // Has a different signature.
                Binary::External(_) => external_binary(),
                $(Binary::$op => {
                    extern "C" fn compute(a: f64, b: f64) -> f64 {
                        eval::binary_inlined(Binary::$op, a, b, &NONE)
                    }
                    compute as *const () as usize
                })*
            }
        };
    }
    binary_builtins!(address)
}
