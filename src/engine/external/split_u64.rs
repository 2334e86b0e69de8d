//! Arithmetic of 64-bit words that are split into two 32-bit Integers, the lower half first: the
//! state of the random number generators of the Modelica Standard Library.
//!
//! In: halves as floats in the range of signed 32-bit integers. Out: a half, or a fraction between
//! 0 and
//! 1. All operations are exact and wrap around.

use super::{External, Signature, same_if_equal};
use crate::base::wire::wire_enum;

/// A half of a word.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Half {
    /// The low 32 bits.
    Low,
    /// The high 32 bits.
    High,
}

/// A function of two numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Operation {
    /// Exclusive or of two halves.
    Xor,
    /// Sum of two halves.
    Add,
    /// The carry of the sum of two lower halves: 0 or 1.
    Carry,
    /// A half of a word (low, high) shifted to the left.
    ShiftLeft(u32, Half),
    /// A half of a word (low, high) shifted to the right.
    ShiftRight(u32, Half),
    /// A half of a word (low, high) multiplied by this.
    Times(u64, Half),
    /// A word (low, high), interpreted as a signed integer, as a fraction from 0 to 1.
    Fraction,
}

impl External for Operation {
    fn signature(&self) -> Signature {
        let is_integer = *self != Operation::Fraction;
        Signature { name: "word", arity: 2, is_integer, is_differentiable: false }
    }

    fn eval(&self, args: &[f64]) -> f64 {
        self.at(args[0], args[1])
    }

    same_if_equal!();
}

impl Operation {
    /// The value of the function.
    pub fn at(self, a: f64, b: f64) -> f64 {
        let (x, y) = (bits(a), bits(b));
        let word = u64::from(y) << 32 | u64::from(x);
        match self {
            Operation::Xor => number(x ^ y),
            Operation::Add => number(x.wrapping_add(y)),
            Operation::Carry => f64::from(u8::from(x.checked_add(y).is_none())),
            Operation::ShiftLeft(n, half) => part(word << n, half),
            Operation::ShiftRight(n, half) => part(word >> n, half),
            Operation::Times(factor, half) => part(word.wrapping_mul(factor), half),
            Operation::Fraction => word as i64 as f64 / 2.0_f64.powi(64) + 0.5,
        }
    }
}

/// The bits of a half; numbers beyond 32 bits are truncated.
fn bits(x: f64) -> u32 {
    x as i64 as u32
}

fn number(half: u32) -> f64 {
    f64::from(half as i32)
}

fn part(word: u64, half: Half) -> f64 {
    match half {
        Half::Low => number(word as u32),
        Half::High => number((word >> 32) as u32),
    }
}

wire_enum!(Half { Low = 0, High = 1 });
wire_enum!(Operation {
    Xor = 0,
    Add = 1,
    Carry = 2,
    ShiftLeft(bits, half) = 3,
    ShiftRight(bits, half) = 4,
    Times(factor, half) = 5,
    Fraction = 6,
});

#[cfg(test)]
mod tests {
    use super::*;

    fn halves(word: u64) -> (f64, f64) {
        (part(word, Half::Low), part(word, Half::High))
    }

    #[test]
    fn operations_on_halves_agree_with_those_on_words() {
        let (x, y) = (0xF123_4567_89AB_CDEF_u64, 0x8FED_CBA9_F765_4321_u64);
        let ((a, b), (c, d)) = (halves(x), halves(y));
        let apply = |f: &dyn Fn(Half) -> Operation| {
            let at = |half| f(half).at(a, b);
            (at(Half::Low), at(Half::High))
        };
        assert_eq!(apply(&|h| Operation::ShiftLeft(23, h)), halves(x << 23));
        assert_eq!(apply(&|h| Operation::ShiftRight(17, h)), halves(x >> 17));
        assert_eq!(apply(&|h| Operation::Times(2_685_821_657_736_338_717, h)), {
            halves(x.wrapping_mul(2_685_821_657_736_338_717))
        });
        let carry = Operation::Carry.at(a, c);
        let high = Operation::Add.at(Operation::Add.at(b, d), carry);
        assert_eq!((Operation::Add.at(a, c), high), halves(x.wrapping_add(y)));
        assert_eq!((Operation::Xor.at(a, c), Operation::Xor.at(b, d)), halves(x ^ y));
    }

    #[test]
    fn fractions_lie_between_0_and_1() {
        assert_eq!(Operation::Fraction.at(0.0, f64::from(i32::MIN)), 0.0);
        assert_eq!(Operation::Fraction.at(0.0, 0.0), 0.5);
        assert_eq!(Operation::Fraction.at(-1.0, f64::from(i32::MAX)), 1.0);
    }
}
