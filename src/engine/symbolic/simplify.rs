//! Constructors of expressions that fold constants and apply the identities that are safe for every
//! finite argument: neutral and absorbing elements, double negation, decided conditions.
//! `0 * x = 0` is among them, as Modelica allows (section 3.1 of the specification).

use super::{eval, string};
use crate::base::name::Name;
use crate::ir::builtin::ValueType;
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Binary, Const, ExprId, Graph, ListId, Node, Type, Unary, VarId};
use crate::ir::external::ExternalId;

impl Graph {
    /// `-a`
    pub fn neg(&mut self, a: ExprId) -> ExprId {
        self.unary(Unary::Neg, a)
    }
    /// `a + b`
    pub fn add(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.binary(Binary::Add, a, b)
    }
    /// `a - b`
    pub fn sub(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.binary(Binary::Sub, a, b)
    }
    /// `a * b`
    pub fn mul(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.binary(Binary::Mul, a, b)
    }
    /// `a / b`
    pub fn div(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.binary(Binary::Div, a, b)
    }
    /// `a ^ b`
    pub fn pow(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.binary(Binary::Pow, a, b)
    }
    /// `a and b`
    pub fn and(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.binary(Binary::And, a, b)
    }
    /// `a or b`
    pub fn or(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.binary(Binary::Or, a, b)
    }
    /// `not a`
    pub fn not(&mut self, a: ExprId) -> ExprId {
        self.unary(Unary::Not, a)
    }
    /// A string literal.
    pub fn string(&mut self, text: &str) -> ExprId {
        self.constant(Const::String(Name::from(text)))
    }
    /// `pre(v)`
    pub fn pre(&mut self, v: VarId, ty: Type) -> ExprId {
        self.intern(Node::Pre(v), ty)
    }
    /// `der(v)`
    pub fn der(&mut self, v: VarId) -> ExprId {
        self.intern(Node::Der(v), Type::Real)
    }

    fn is_integer_valued(&self, f: ExternalId) -> bool {
        self.externals().get(f).signature().is_integer
    }

    /// An operator or function of one argument.
    pub fn unary(&mut self, op: Unary, a: ExprId) -> ExprId {
        if let Some(c) = self.as_const(a)
            && let Some(folded) = self.fold_unary(op, c)
        {
            return folded;
        }
        match (op, self.node(a)) {
            (Unary::Neg, Node::Unary(Unary::Neg, x)) | (Unary::Not, Node::Unary(Unary::Not, x)) => {
                return x;
            }
            (Unary::Neg, Node::Binary(Binary::Sub, x, y)) => return self.sub(y, x),
            _ => {}
        }
        let ty = match op {
            Unary::Text(_) => Type::String,
            Unary::External(f) if self.is_integer_valued(f) => Type::Integer,
            _ => match op.facts().map(|row| row.result) {
                Some(ValueType::Operand) => self.ty(a),
                Some(ValueType::Integer) => Type::Integer,
                Some(ValueType::Boolean) => Type::Boolean,
                Some(ValueType::Real) | None => Type::Real,
            },
        };
        self.intern(Node::Unary(op, a), ty)
    }

    /// An operator or function of two arguments.
    pub fn binary(&mut self, op: Binary, a: ExprId, b: ExprId) -> ExprId {
        let (a, b) = self.same_kind(op, a, b);
        if let (Some(x), Some(y)) = (self.as_const(a), self.as_const(b))
            && let Some(folded) = self.fold_binary(op, x, y)
        {
            return folded;
        }
        if let Some(e) = self.identity(op, a, b) {
            return e;
        }
        let ty = match op {
            Binary::External(f) if self.is_integer_valued(f) => Type::Integer,
            _ => match op.facts().map(|row| row.result) {
                Some(ValueType::Operand) => self.common_type(a, b),
                Some(ValueType::Integer) => Type::Integer,
                Some(ValueType::Boolean) => Type::Boolean,
                Some(ValueType::Real) | None => Type::Real,
            },
        };
        self.intern(Node::Binary(op, a, b), ty)
    }

    /// `if c then a else b`
    pub fn if_then_else(&mut self, c: ExprId, a: ExprId, b: ExprId) -> ExprId {
        if let Some(Const::Boolean(value)) = self.as_const(c) {
            return if value { a } else { b };
        }
        let (a, b) = self.same_kind(Binary::Add, a, b);
        if a == b {
            return a;
        }
        let ty = self.common_type(a, b);
        if ty == Type::Boolean {
            match (self.as_const(a), self.as_const(b)) {
                (Some(Const::Boolean(true)), _) => return self.or(c, b),
                (_, Some(Const::Boolean(false))) => return self.and(c, a),
                _ => {}
            }
        }
        self.intern(Node::If(c, a, b), ty)
    }

    /// `noEvent(e)`
    pub fn no_event(&mut self, e: ExprId) -> ExprId {
        match self.node(e) {
            Node::Const(_) | Node::Var(_) | Node::Time | Node::NoEvent(_) => e,
            _ => {
                let ty = self.ty(e);
                self.intern(Node::NoEvent(e), ty)
            }
        }
    }

    /// An operator of clocks with operands, of type `ty`.
    pub fn clocked(&mut self, op: ClockOperator, args: &[ExprId], ty: Type) -> ExprId {
        let args = self.intern_list(args);
        self.intern(Node::Clocked(op, args), ty)
    }

    /// `smooth(order, e)`
    pub fn smooth(&mut self, order: u32, e: ExprId) -> ExprId {
        match self.node(e) {
            Node::Const(_) | Node::Var(_) | Node::Time | Node::NoEvent(_) => e,
            _ => {
                let ty = self.ty(e);
                self.intern(Node::Smooth(order, e), ty)
            }
        }
    }

    /// An integer literal as a real one; anything else as it is.
    pub fn as_real(&mut self, e: ExprId) -> ExprId {
        match self.as_const(e) {
            Some(Const::Integer(i)) => self.real(i as f64),
            _ => e,
        }
    }

    /// The sum of all, `0.0` of none.
    pub fn sum(&mut self, terms: impl IntoIterator<Item = ExprId>) -> ExprId {
        let mut terms = terms.into_iter();
        let Some(first) = terms.next() else { return self.real(0.0) };
        terms.fold(first, |s, t| self.add(s, t))
    }

    /// Rebuilds a node with other operands, given in the order of `for_each_operand`.
    pub fn rebuild(&mut self, e: ExprId, operands: &[ExprId]) -> ExprId {
        match (self.node(e), operands) {
            (Node::Unary(op, _), &[a]) => self.unary(op, a),
            (Node::Binary(op, ..), &[a, b]) => self.binary(op, a, b),
            (Node::If(..), &[c, a, b]) => self.if_then_else(c, a, b),
            (Node::NoEvent(_), &[a]) => self.no_event(a),
            (Node::Smooth(k, _), &[a]) => self.smooth(k, a),
            (Node::Homotopy(..), &[a, b]) => self.intern(Node::Homotopy(a, b), Type::Real),
            (Node::Sample(..), &[a, b]) => self.intern(Node::Sample(a, b), Type::Boolean),
            (Node::Clocked(op, _), args) => self.clocked(op, args, self.ty(e)),
            (Node::Call { function, output, .. }, args) => {
                let ty = self.ty(e);
                let args: ListId = self.intern_list(args);
                self.intern(Node::Call { function, output, args }, ty)
            }
            _ => e,
        }
    }

    /// `Real` if either is; otherwise the type of the first.
    pub fn common_type(&self, a: ExprId, b: ExprId) -> Type {
        match (self.ty(a), self.ty(b)) {
            (Type::Real, _) | (_, Type::Real) => Type::Real,
            (t, _) => t,
        }
    }

    /// Turns an Integer literal next to a Real operand into a Real one, so that `2 * x` and `2.0 * x`
    /// are one node.
    fn same_kind(&mut self, op: Binary, a: ExprId, b: ExprId) -> (ExprId, ExprId) {
        let real = self.ty(a) == Type::Real || self.ty(b) == Type::Real || op == Binary::Div;
        if !real {
            return (a, b);
        }
        (self.as_real(a), self.as_real(b))
    }

    fn fold_unary(&mut self, op: Unary, c: Const) -> Option<ExprId> {
        match (op, c) {
            (Unary::Not, Const::Boolean(b)) => Some(self.boolean(!b)),
            (Unary::Neg, Const::Integer(i)) => i.checked_neg().map(|i| self.integer(i)),
            (Unary::Abs, Const::Integer(i)) => i.checked_abs().map(|i| self.integer(i)),
            (Unary::Ordinal, Const::Enumeration(_, k)) => Some(self.integer(i64::from(k))),
            (Unary::Ordinal, Const::Boolean(b)) => Some(self.integer(i64::from(b))),
            (Unary::ToInteger | Unary::Sign, _) => {
                let value = eval::unary(op, c.number()?, self.externals());
                (value.abs() < 9e15).then(|| self.integer(value as i64))
            }
            // Known only at run time.
            (Unary::Carried(_), _) => None,
            (Unary::Text(form), _) => {
                let text = string::text(self, c, self.forms[form])?;
                Some(self.string(&text))
            }
            (Unary::External(f), _) if self.is_integer_valued(f) => {
                Some(self.integer(eval::unary(op, c.number()?, self.externals()) as i64))
            }
            _ => self.finite(eval::unary(op, c.number()?, self.externals())),
        }
    }

    fn fold_binary(&mut self, op: Binary, a: Const, b: Const) -> Option<ExprId> {
        if let (Const::String(x), Const::String(y)) = (a, b) {
            return match op {
                Binary::Add => Some(self.string(&format!("{x}{y}"))),
                Binary::Equal => Some(self.boolean(x == y)),
                Binary::NotEqual => Some(self.boolean(x != y)),
                Binary::Less => Some(self.boolean(x.as_str() < y.as_str())),
                Binary::LessEqual => Some(self.boolean(x.as_str() <= y.as_str())),
                Binary::Greater => Some(self.boolean(x.as_str() > y.as_str())),
                Binary::GreaterEqual => Some(self.boolean(x.as_str() >= y.as_str())),
                _ => None,
            };
        }
        if let (Const::Integer(x), Const::Integer(y)) = (a, b) {
            let whole = match op {
                Binary::Add => x.checked_add(y),
                Binary::Sub => x.checked_sub(y),
                Binary::Mul => x.checked_mul(y),
                Binary::Min => Some(x.min(y)),
                Binary::Max => Some(x.max(y)),
                Binary::Quotient => x.checked_div(y),
                Binary::Rem => x.checked_rem(y),
                Binary::Mod => {
                    x.checked_rem(y).map(|r| if r != 0 && (r < 0) != (y < 0) { r + y } else { r })
                }
                _ => None,
            };
            if let Some(value) = whole {
                return Some(self.integer(value));
            }
            if matches!(op, Binary::Quotient | Binary::Rem | Binary::Mod) {
                return None;
            }
        }
        let value = eval::binary(op, a.register(), b.register(), self.externals());
        if op.is_relation() || matches!(op, Binary::And | Binary::Or) {
            return Some(self.boolean(value != 0.0));
        }
        if matches!(op, Binary::External(f) if self.is_integer_valued(f)) {
            return Some(self.integer(value as i64));
        }
        self.finite(value)
    }

    /// A literal, unless the value is not finite: then the expression stays, and running it reports
    /// where.
    fn finite(&mut self, value: f64) -> Option<ExprId> {
        value.is_finite().then(|| self.real(value))
    }

    fn identity(&mut self, op: Binary, a: ExprId, b: ExprId) -> Option<ExprId> {
        let (x, y) = (self.as_number(a), self.as_number(b));
        match op {
            Binary::Add if x == Some(0.0) => Some(b),
            Binary::Add | Binary::Sub if y == Some(0.0) => Some(a),
            Binary::Sub if x == Some(0.0) => Some(self.neg(b)),
            Binary::Sub if a == b => Some(self.zero_like(a)),
            Binary::Add => match self.node(b) {
                Node::Unary(Unary::Neg, n) => Some(self.sub(a, n)),
                _ => match self.node(a) {
                    Node::Unary(Unary::Neg, n) => Some(self.sub(b, n)),
                    _ => None,
                },
            },
            Binary::Sub => match self.node(b) {
                Node::Unary(Unary::Neg, n) => Some(self.add(a, n)),
                _ => None,
            },
            Binary::Mul if x == Some(0.0) || y == Some(0.0) => Some(self.zero_of(a, b)),
            Binary::Mul if x == Some(1.0) => Some(b),
            Binary::Mul | Binary::Div if y == Some(1.0) => Some(a),
            Binary::Mul if x == Some(-1.0) => Some(self.neg(b)),
            Binary::Mul | Binary::Div if y == Some(-1.0) => Some(self.neg(a)),
            Binary::Mul => self.product_of_negatives(a, b),
            Binary::Div if x == Some(0.0) && y != Some(0.0) => Some(a),
            Binary::Pow if y == Some(1.0) => Some(a),
            Binary::Pow if y == Some(0.0) => Some(self.real(1.0)),
            Binary::And => match (self.as_const(a), self.as_const(b)) {
                (Some(Const::Boolean(v)), _) => Some(if v { b } else { a }),
                (_, Some(Const::Boolean(v))) => Some(if v { a } else { b }),
                _ => (a == b).then_some(a),
            },
            Binary::Or => match (self.as_const(a), self.as_const(b)) {
                (Some(Const::Boolean(v)), _) => Some(if v { a } else { b }),
                (_, Some(Const::Boolean(v))) => Some(if v { b } else { a }),
                _ => (a == b).then_some(a),
            },
            _ => None,
        }
    }

    /// `(-a) * (-b) = a * b`, and a single sign is drawn out of a product.
    fn product_of_negatives(&mut self, a: ExprId, b: ExprId) -> Option<ExprId> {
        match (self.node(a), self.node(b)) {
            (Node::Unary(Unary::Neg, x), Node::Unary(Unary::Neg, y)) => Some(self.mul(x, y)),
            (Node::Unary(Unary::Neg, x), _) => {
                let p = self.mul(x, b);
                Some(self.neg(p))
            }
            (_, Node::Unary(Unary::Neg, y)) => {
                let p = self.mul(a, y);
                Some(self.neg(p))
            }
            _ => None,
        }
    }

    fn zero_like(&mut self, a: ExprId) -> ExprId {
        if self.ty(a) == Type::Integer { self.integer(0) } else { self.real(0.0) }
    }

    fn zero_of(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if self.common_type(a, b) == Type::Integer { self.integer(0) } else { self.real(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_expressions_are_one_node_and_constants_fold() {
        let mut g = Graph::new();
        let x = g.var(VarId(0), Type::Real);
        let two = g.integer(2);
        let two_real = g.real(2.0);
        assert_eq!(g.mul(two, x), g.mul(two_real, x));
        let three = g.integer(3);
        let six = g.mul(two, three);
        assert_eq!(g.as_const(six), Some(Const::Integer(6)));
        let zero = g.integer(0);
        let product = g.mul(zero, x);
        assert_eq!(g.as_number(product), Some(0.0));
        let half = g.div(three, two);
        assert_eq!(g.as_number(half), Some(1.5));
    }

    #[test]
    fn a_division_by_a_literal_zero_is_kept_for_the_run_to_report() {
        let mut g = Graph::new();
        let one = g.real(1.0);
        let zero = g.real(0.0);
        let e = g.div(one, zero);
        assert!(matches!(g.node(e), Node::Binary(Binary::Div, ..)));
    }
}
