//! A fingerprint of the arithmetic of this machine: whether another one computes the same bits.
//!
//! Sums and products are the same everywhere (IEEE 754), but the elementary functions come from the system's library,
//! which has several versions and chooses among implementations by the processor; and large matrices are decomposed in
//! an order that depends on the width of its vector registers. Results of machines with different fingerprints may
//! differ in their last digits, so they are never mixed in one table.

use std::sync::OnceLock;

use crate::ir::builtin::{binary_builtins, unary_builtins};
use crate::ir::expr::{Binary, Unary};
use crate::ir::external::Externals;
use crate::numeric::linear::DenseLu;
use crate::symbolic::eval::{binary, unary};

/// Arguments for each function: implementations that round well differ in about one of a hundred.
const ARGUMENTS: u64 = 3000;
/// Order of the matrix, beyond that up to which the order of operations is fixed.
const ORDER: usize = 96;

/// The fingerprint.
pub fn arithmetic() -> u64 {
    static FOUND: OnceLock<u64> = OnceLock::new();
    *FOUND.get_or_init(|| {
        let mut bits = Bits(0xcbf2_9ce4_8422_2325);
        functions(&mut bits);
        matrices(&mut bits);
        bits.0
    })
}

/// A running hash, 64-bit FNV-1a (RFC 9923).
struct Bits(u64);

impl Bits {
    fn add(&mut self, x: f64) {
        // The sign and the payload of NaN mean nothing.
        let bits = if x.is_nan() { 0 } else { x.to_bits() };
        for byte in bits.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

/// Numbers between 0 and 1 by integer arithmetic alone: a Weyl sequence.
fn fraction(k: u64) -> f64 {
    (k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1_u64 << 53) as f64
}

fn functions(bits: &mut Bits) {
    let none = Externals::default();
    macro_rules! all_unary {
        (($a:ident, $_y:ident, $_g:ident) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slope:expr })*) => {
            [$(Unary::$op),*]
        };
    }
    macro_rules! all_binary {
        (($a:ident, $b:ident, $_y:ident, $_g:ident, $_seed:ident)
         $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slopes:expr; $chain:expr })*) => {
            [$(Binary::$op),*]
        };
    }
    for op in unary_builtins!(all_unary) {
        for k in 0..ARGUMENTS {
            // Small, of either sign, and large in turn.
            let x = fraction(k);
            let x = match k % 3 {
                0 => x,
                1 => 4.0 * x - 2.0,
                _ => 60.0 * x,
            };
            bits.add(unary(op, x, &none));
        }
    }
    for op in binary_builtins!(all_binary) {
        for k in 0..ARGUMENTS {
            let (x, y) = (8.0 * fraction(k), 6.0 * fraction(k + ARGUMENTS) - 3.0);
            bits.add(binary(op, x, y, &none));
        }
    }
}

fn matrices(bits: &mut Bits) {
    let n = ORDER;
    let entry = |k: u64| fraction(k) - 0.5;
    let matrix: Vec<f64> = (0..(n * n) as u64).map(entry).collect();
    let mut lu = DenseLu::new(n);
    if lu.factor(&matrix).is_ok() {
        let mut x: Vec<f64> = (0..n as u64).map(fraction).collect();
        lu.solve_in_place(&mut x);
        x.into_iter().for_each(|x| bits.add(x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_same_for_the_same_machine() {
        let again = || {
            let mut bits = Bits(0);
            functions(&mut bits);
            matrices(&mut bits);
            bits.0
        };
        assert_eq!(again(), again());
        assert_eq!(arithmetic(), arithmetic());
    }

    #[test]
    fn the_last_digit_of_one_value_changes_it() {
        let of = |x: f64| {
            let mut bits = Bits(0);
            bits.add(x);
            bits.0
        };
        assert_ne!(of(1.0), of(1.0_f64.next_up()));
        assert_eq!(of(f64::NAN), of(-f64::NAN));
    }
}
