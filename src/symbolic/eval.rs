//! What each operator computes: the one definition that constant folding, the reference interpreter
//! and the tests share.

use crate::ir::expr::{Binary, Unary};

/// The value of a unary operator; truth values are 0 and 1.
#[inline]
pub fn unary(op: Unary, a: f64) -> f64 {
    match op {
        Unary::Neg => -a,
        Unary::Not => truth(a == 0.0),
        Unary::Sin => a.sin(),
        Unary::Cos => a.cos(),
        Unary::Tan => a.tan(),
        Unary::Asin => a.asin(),
        Unary::Acos => a.acos(),
        Unary::Atan => a.atan(),
        Unary::Sinh => a.sinh(),
        Unary::Cosh => a.cosh(),
        Unary::Tanh => a.tanh(),
        Unary::Exp => a.exp(),
        Unary::Log => a.ln(),
        Unary::Log10 => a.log10(),
        Unary::Sqrt => a.sqrt(),
        Unary::Abs => a.abs(),
        Unary::Sign => {
            if a > 0.0 {
                1.0
            } else if a < 0.0 {
                -1.0
            } else {
                0.0
            }
        }
        Unary::Floor | Unary::ToInteger => a.floor(),
        Unary::Ceil => a.ceil(),
        Unary::Ordinal => a,
        Unary::Native(f) => f.unary(a),
        // Only a run knows.
        Unary::Carried(_) | Unary::Text(_) => f64::NAN,
    }
}

/// The value of a binary operator; truth values are 0 and 1.
#[inline]
pub fn binary(op: Binary, a: f64, b: f64) -> f64 {
    match op {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div => a / b,
        Binary::Pow => power(a, b),
        Binary::Less => truth(a < b),
        Binary::LessEqual => truth(a <= b),
        Binary::Greater => truth(a > b),
        Binary::GreaterEqual => truth(a >= b),
        Binary::Equal => truth(a == b),
        Binary::NotEqual => truth(a != b),
        Binary::And => truth(a != 0.0 && b != 0.0),
        Binary::Or => truth(a != 0.0 || b != 0.0),
        Binary::Atan2 => a.atan2(b),
        // Which of two zeros is taken, and that NaN is the other one, is said here and not left open.
        Binary::Min => {
            if b < a || a.is_nan() {
                b
            } else {
                a
            }
        }
        Binary::Max => {
            if b > a || a.is_nan() {
                b
            } else {
                a
            }
        }
        Binary::Quotient => (a / b).trunc(),
        Binary::Mod => a - (a / b).floor() * b,
        Binary::Rem => a - (a / b).trunc() * b,
        Binary::Native(f) => f.binary(a, b),
    }
}

/// `a ^ b`; small whole exponents by multiplication, which is exact where `powf` may not be.
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
/// branch goes on, for a moment, beyond the point at which it will be left.
pub fn unary_inside(op: Unary, a: f64) -> f64 {
    let inside = match op {
        Unary::Sqrt => a.max(0.0),
        Unary::Log | Unary::Log10 => a.max(f64::MIN_POSITIVE),
        Unary::Asin | Unary::Acos => a.clamp(-1.0, 1.0),
        _ => a,
    };
    // What is not a number stays so.
    unary(op, if a.is_nan() { a } else { inside })
}

/// The value of a binary operator, with arguments outside of its domain moved to the border.
pub fn binary_inside(op: Binary, a: f64, b: f64) -> f64 {
    match op {
        Binary::Pow if a < 0.0 && b.fract() != 0.0 => power(0.0, b),
        _ => binary(op, a, b),
    }
}

#[inline]
fn truth(b: bool) -> f64 {
    f64::from(u8::from(b))
}
