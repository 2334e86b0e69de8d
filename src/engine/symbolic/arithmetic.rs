//! What a derivative in the [table](crate::ir::builtin) is written in: operations on numbers, which give its
//! value at a point, and on expressions, which give its formula.

use super::eval;
use crate::ir::expr::{Binary, ExprId, Graph, Unary};
use crate::ir::external::Externals;

/// Computes with numbers or builds expressions.
pub trait Arithmetic {
    /// A number or an expression.
    type Value: Copy;

    /// A literal.
    fn real(&mut self, value: f64) -> Self::Value;
    /// A unary operator.
    fn unary(&mut self, op: Unary, a: Self::Value) -> Self::Value;
    /// A binary operator.
    fn binary(&mut self, op: Binary, a: Self::Value, b: Self::Value) -> Self::Value;

    /// `-a`
    fn neg(&mut self, a: Self::Value) -> Self::Value {
        self.unary(Unary::Neg, a)
    }
    /// `a / b`
    fn div(&mut self, a: Self::Value, b: Self::Value) -> Self::Value {
        self.binary(Binary::Div, a, b)
    }
    /// `a * a`
    fn square(&mut self, a: Self::Value) -> Self::Value {
        self.binary(Binary::Mul, a, a)
    }
    /// `1 + a`
    fn one_plus(&mut self, a: Self::Value) -> Self::Value {
        let one = self.real(1.0);
        self.binary(Binary::Add, one, a)
    }
    /// `1 - a`
    fn one_minus(&mut self, a: Self::Value) -> Self::Value {
        let one = self.real(1.0);
        self.binary(Binary::Sub, one, a)
    }
    /// `1 / a`
    fn inverse(&mut self, a: Self::Value) -> Self::Value {
        let one = self.real(1.0);
        self.div(one, a)
    }
    /// `1 / sqrt(1 - a * a)`
    fn inverse_of_cathetus(&mut self, a: Self::Value) -> Self::Value {
        let square = self.square(a);
        let rest = self.one_minus(square);
        let root = self.unary(Unary::Sqrt, rest);
        self.inverse(root)
    }
}

/// Arithmetic of numbers.
pub struct Numbers;

impl Arithmetic for Numbers {
    type Value = f64;

    #[inline]
    fn real(&mut self, value: f64) -> f64 {
        value
    }
    #[inline]
    fn unary(&mut self, op: Unary, a: f64) -> f64 {
        eval::unary(op, a, &Externals::EMPTY)
    }
    #[inline]
    fn binary(&mut self, op: Binary, a: f64, b: f64) -> f64 {
        eval::binary(op, a, b, &Externals::EMPTY)
    }
}

impl Arithmetic for Graph {
    type Value = ExprId;

    fn real(&mut self, value: f64) -> ExprId {
        Graph::real(self, value)
    }
    fn unary(&mut self, op: Unary, a: ExprId) -> ExprId {
        Graph::unary(self, op, a)
    }
    fn binary(&mut self, op: Binary, a: ExprId, b: ExprId) -> ExprId {
        Graph::binary(self, op, a, b)
    }
}
