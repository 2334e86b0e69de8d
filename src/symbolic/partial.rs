//! The partial derivatives of each operator at a point: what `gradient` writes as expressions, as
//! numbers. Both follow the same conventions: relations and integer-valued functions have derivative
//! zero, and at a corner the branch counts that gives the value.

use crate::ir::expr::{Binary, Unary};

/// `d op(a) / da`, where `value` is `op(a)`.
pub fn unary(op: Unary, a: f64, value: f64) -> f64 {
    match op {
        Unary::Neg => -1.0,
        Unary::Sin => a.cos(),
        Unary::Cos => -a.sin(),
        Unary::Tan => 1.0 + value * value,
        Unary::Asin => 1.0 / (1.0 - a * a).sqrt(),
        Unary::Acos => -1.0 / (1.0 - a * a).sqrt(),
        Unary::Atan => 1.0 / (1.0 + a * a),
        Unary::Sinh => a.cosh(),
        Unary::Cosh => a.sinh(),
        Unary::Tanh => 1.0 - value * value,
        Unary::Exp => value,
        Unary::Log => 1.0 / a,
        Unary::Log10 => std::f64::consts::LOG10_E / a,
        Unary::Sqrt => 0.5 / value,
        Unary::Abs => super::eval::unary(Unary::Sign, a),
        Unary::Not
        | Unary::Sign
        | Unary::Floor
        | Unary::Ceil
        | Unary::ToInteger
        | Unary::Ordinal
        | Unary::Text(_) => 0.0,
        Unary::Native(f) => f.slope(a),
        // A run that reads what was before is not differentiated.
        Unary::Carried(_) => f64::NAN,
    }
}

/// `(d op(a, b) / da, d op(a, b) / db)`, where `value` is `op(a, b)`.
pub fn binary(op: Binary, a: f64, b: f64, value: f64) -> (f64, f64) {
    match op {
        Binary::Add => (1.0, 1.0),
        Binary::Sub => (1.0, -1.0),
        Binary::Mul => (b, a),
        Binary::Div => (1.0 / b, -value / b),
        Binary::Pow => power(a, b, value),
        Binary::Atan2 => {
            let sum = a * a + b * b;
            (b / sum, -a / sum)
        }
        Binary::Min if a <= b => (1.0, 0.0),
        Binary::Max if a >= b => (1.0, 0.0),
        Binary::Min | Binary::Max => (0.0, 1.0),
        Binary::Mod => (1.0, -(a / b).floor()),
        Binary::Rem => (1.0, -(a / b).trunc()),
        Binary::Quotient
        | Binary::Less
        | Binary::LessEqual
        | Binary::Greater
        | Binary::GreaterEqual
        | Binary::Equal
        | Binary::NotEqual
        | Binary::And
        | Binary::Or => (0.0, 0.0),
        Binary::Native(f) => f.slopes(a, b),
    }
}

/// By the exponent only where the base is positive: elsewhere it must be constant.
fn power(a: f64, b: f64, value: f64) -> (f64, f64) {
    let by_base = if b == 0.0 { 0.0 } else { b * super::eval::power(a, b - 1.0) };
    let by_exponent = if a > 0.0 { value * a.ln() } else { 0.0 };
    (by_base, by_exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symbolic::eval;

    const H: f64 = 1e-6;

    #[test]
    fn functions_of_one_number_agree_with_differences() {
        let all = [
            Unary::Neg,
            Unary::Sin,
            Unary::Cos,
            Unary::Tan,
            Unary::Asin,
            Unary::Acos,
            Unary::Atan,
            Unary::Sinh,
            Unary::Cosh,
            Unary::Tanh,
            Unary::Exp,
            Unary::Log,
            Unary::Log10,
            Unary::Sqrt,
            Unary::Abs,
            Unary::Sign,
            Unary::Floor,
            Unary::Ceil,
        ];
        for op in all {
            for a in [0.3, 0.7] {
                let difference = (eval::unary(op, a + H) - eval::unary(op, a - H)) / (2.0 * H);
                let exact = unary(op, a, eval::unary(op, a));
                assert!((exact - difference).abs() < 1e-8, "{op:?} at {a}: {exact} {difference}");
            }
        }
    }

    #[test]
    fn functions_of_two_numbers_agree_with_differences() {
        let all = [
            Binary::Add,
            Binary::Sub,
            Binary::Mul,
            Binary::Div,
            Binary::Pow,
            Binary::Atan2,
            Binary::Min,
            Binary::Max,
            Binary::Mod,
            Binary::Rem,
            Binary::Quotient,
        ];
        for op in all {
            for (a, b) in [(1.7, 0.6), (0.4, 2.2)] {
                let value = |a, b| eval::binary(op, a, b);
                let (by_a, by_b) = binary(op, a, b, value(a, b));
                let along_a = (value(a + H, b) - value(a - H, b)) / (2.0 * H);
                let along_b = (value(a, b + H) - value(a, b - H)) / (2.0 * H);
                assert!((by_a - along_a).abs() < 1e-8, "{op:?}({a}, {b}) by the first");
                assert!((by_b - along_b).abs() < 1e-8, "{op:?}({a}, {b}) by the second");
            }
        }
    }

    #[test]
    fn a_whole_power_of_a_negative_base_has_a_slope() {
        assert_eq!(binary(Binary::Pow, -2.0, 3.0, -8.0), (12.0, 0.0));
        assert_eq!(binary(Binary::Pow, 0.0, 1.0, 0.0).0, 1.0);
    }
}
