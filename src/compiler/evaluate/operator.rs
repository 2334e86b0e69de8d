//! Operators on values: element by element, and matrix products (section 10.6 of the specification).

use std::rc::Rc;

use super::Evaluator;
use super::cause::array::{ArrayCause, Pair};
use super::cause::types::{Conversion, Expected, Pairing, TypeCause};
use super::cause::value::ValueCause;
use super::value::{Record, Value};
use crate::base::source::Span;
use crate::ir::ast::{BinaryOp, Expr, UnaryOp};
use crate::ir::expr::{Binary, Const, ExprId, Type, Unary};
use crate::ir::instance::Scope;

/// Length of a string that is joined here, bytes.
const MAX_STRING: usize = 1_000_000;
/// Characters of a text that cost as much as the evaluation of an expression.
const CHARACTERS_PER_STEP: usize = 8;

impl Evaluator<'_> {
    /// `op a`
    pub(crate) fn unary_operator(&mut self, op: UnaryOp, a: Value, span: Span) -> Option<Value> {
        match op {
            UnaryOp::Plus | UnaryOp::ElementPlus => Some(a),
            UnaryOp::Minus | UnaryOp::ElementMinus if self.is_overloaded(&a) => {
                a.map(|v| self.overloaded("'-'", std::slice::from_ref(v), span))
            }
            UnaryOp::Minus | UnaryOp::ElementMinus => {
                a.map(|v| Some(Value::Scalar(self.number(v, span).map(|e| self.graph.neg(e))?)))
            }
            UnaryOp::Not if self.is_overloaded(&a) => {
                a.map(|v| self.overloaded("'not'", std::slice::from_ref(v), span))
            }
            UnaryOp::Not => {
                a.map(|v| Some(Value::Scalar(self.boolean_of(v, span).map(|e| self.graph.not(e))?)))
            }
        }
    }

    /// `a op b`
    pub(crate) fn binary_operator(
        &mut self,
        op: BinaryOp,
        a: Value,
        b: Value,
        span: Span,
    ) -> Option<Value> {
        match op {
            BinaryOp::Add | BinaryOp::ElementAdd => {
                self.elementwise(Binary::Add, &a, &b, op == BinaryOp::ElementAdd, span)
            }
            BinaryOp::Sub | BinaryOp::ElementSub => {
                self.elementwise(Binary::Sub, &a, &b, op == BinaryOp::ElementSub, span)
            }
            BinaryOp::Mul => self.product(&a, &b, span),
            BinaryOp::ElementMul => self.elementwise(Binary::Mul, &a, &b, true, span),
            BinaryOp::Div | BinaryOp::ElementDiv => {
                if op == BinaryOp::Div && !b.dims().is_empty() {
                    self.report(ArrayCause::ArrayDivisor, span);
                    return None;
                }
                self.elementwise(Binary::Div, &a, &b, true, span)
            }
            BinaryOp::Pow if a.dims().is_empty() && !b.dims().is_empty() => {
                self.report(ArrayCause::ArrayExponent, span);
                None
            }
            BinaryOp::Pow if !a.dims().is_empty() => self.matrix_power(&a, &b, span),
            BinaryOp::Pow | BinaryOp::ElementPow => {
                self.elementwise(Binary::Pow, &a, &b, true, span)
            }
            BinaryOp::And | BinaryOp::Or => {
                let op = if op == BinaryOp::And { Binary::And } else { Binary::Or };
                self.zip(&a, &b, span, &mut |cx, x, y| {
                    if let (Value::Record(_), _) | (_, Value::Record(_)) = (x, y) {
                        let operator = format!("'{}'", op.name());
                        return cx.overloaded(&operator, &[x.clone(), y.clone()], span);
                    }
                    let (x, y) = (cx.boolean_of(x, span)?, cx.boolean_of(y, span)?);
                    Some(Value::Scalar(cx.graph.binary(op, x, y)))
                })
            }
            BinaryOp::Less => self.relation(Binary::Less, &a, &b, span),
            BinaryOp::LessEqual => self.relation(Binary::LessEqual, &a, &b, span),
            BinaryOp::Greater => self.relation(Binary::Greater, &a, &b, span),
            BinaryOp::GreaterEqual => self.relation(Binary::GreaterEqual, &a, &b, span),
            BinaryOp::Equal => self.relation(Binary::Equal, &a, &b, span),
            BinaryOp::NotEqual => self.relation(Binary::NotEqual, &a, &b, span),
        }
    }

    fn relation(&mut self, op: Binary, a: &Value, b: &Value, span: Span) -> Option<Value> {
        if let (Value::Record(_), _) | (_, Value::Record(_)) = (a, b) {
            let operator = format!("'{}'", op.name());
            return self.overloaded(&operator, &[a.clone(), b.clone()], span);
        }
        let (Some(x), Some(y)) = (a.scalar(), b.scalar()) else {
            let other = if a.scalar().is_none() { a } else { b };
            let found = self.described(other);
            self.report(TypeCause::ComparedArray { found }, span);
            return None;
        };
        let kind = |t: Type| match t {
            Type::Integer => Type::Real,
            other => other,
        };
        let (s, t) = (kind(self.graph.ty(x)), kind(self.graph.ty(y)));
        if s != t {
            self.report_types(span, Pairing::Compared, self.graph.ty(x), self.graph.ty(y));
            return None;
        }
        if s == Type::String && (self.changes_between_events(x) || self.changes_between_events(y)) {
            self.report_continuous(Type::String, span);
            return None;
        }
        Some(Value::Scalar(self.graph.binary(op, x, y)))
    }

    pub(crate) fn report_types(&mut self, span: Span, as_: Pairing, s: Type, t: Type) {
        let name = |t| crate::symbolic::print::type_name(&self.graph, t);
        let number = |t| matches!(t, Type::Real | Type::Integer);
        let by = match (s, t) {
            (Type::Boolean, t) | (t, Type::Boolean) if number(t) => Conversion::BooleanAndNumber,
            (Type::Enumeration(_), t) | (t, Type::Enumeration(_)) if number(t) => {
                Conversion::EnumerationAndNumber
            }
            (Type::String, _) | (_, Type::String) => Conversion::ToString,
            _ => Conversion::None,
        };
        let (left, right) = (name(s), name(t));
        self.report(TypeCause::IncompatibleTypes { left, right, as_, by }, span);
    }

    /// The number of a scalar; strings are accepted for `+`.
    pub(super) fn number(&mut self, v: &Value, span: Span) -> Option<ExprId> {
        let Some(e) = v.scalar() else {
            self.report_type(Expected::Number, v, span);
            return None;
        };
        match self.graph.ty(e) {
            Type::Real | Type::Integer => Some(e),
            _ => {
                self.report_type(Expected::Number, v, span);
                None
            }
        }
    }

    pub(crate) fn boolean_of(&mut self, v: &Value, span: Span) -> Option<ExprId> {
        match v.scalar() {
            Some(e) if self.graph.ty(e) == Type::Boolean => Some(e),
            _ => {
                self.report_type(Expected::Boolean, v, span);
                None
            }
        }
    }

    /// The right operand of `and` and `or` counts only where the left one has not decided.
    pub(crate) fn guarded(
        &mut self,
        op: BinaryOp,
        left: Option<&Value>,
        right: &Expr,
        scope: Scope,
    ) -> Option<Value> {
        let truth = left.and_then(Value::scalar).filter(|e| self.graph.ty(*e) == Type::Boolean);
        let counts = match (op, truth) {
            (BinaryOp::And, Some(c)) => c,
            (BinaryOp::Or, Some(c)) => self.graph.not(c),
            _ => return self.evaluate(right, scope),
        };
        // While a function is executed on known values, an inactive operand is not even evaluated.
        if self.frames.in_function() && self.graph.as_const(counts) == Some(Const::Boolean(false)) {
            return Some(Value::Scalar(self.graph.boolean(false)));
        }
        self.under(counts, |cx| cx.evaluate(right, scope))
    }

    fn elementwise(
        &mut self,
        op: Binary,
        a: &Value,
        b: &Value,
        spread: bool,
        span: Span,
    ) -> Option<Value> {
        let mut act = |cx: &mut Self, x: &Value, y: &Value| {
            if let (Some(s), Some(t)) = (x.scalar(), y.scalar())
                && op == Binary::Add
                && cx.graph.ty(s) == Type::String
                && cx.graph.ty(t) == Type::String
            {
                let length = |e| match cx.graph.as_const(e) {
                    Some(Const::String(text)) => text.len(),
                    _ => 0,
                };
                let length = length(s) + length(t);
                if length > MAX_STRING {
                    cx.report(ValueCause::LongString { length, most: MAX_STRING }, span);
                    return None;
                }
                // A loop that makes a text longer leaves all of the shorter ones in memory.
                cx.spend((length / CHARACTERS_PER_STEP) as u64, span)?;
                return Some(Value::Scalar(cx.graph.binary(Binary::Add, s, t)));
            }
            if let (Value::Record(_), _) | (_, Value::Record(_)) = (x, y) {
                let operator = format!("'{}'", op.name());
                return cx.overloaded(&operator, &[x.clone(), y.clone()], span);
            }
            let (s, t) = (cx.number(x, span)?, cx.number(y, span)?);
            Some(Value::Scalar(cx.graph.binary(op, s, t)))
        };
        match (a.dims().is_empty(), b.dims().is_empty()) {
            (true, true) => act(self, a, b),
            (false, true) if spread => a.map(|x| act(self, x, b)),
            (true, false) if spread => b.map(|y| act(self, a, y)),
            _ => self.zip(a, b, span, &mut act),
        }
    }

    fn zip(
        &mut self,
        a: &Value,
        b: &Value,
        span: Span,
        act: &mut impl FnMut(&mut Self, &Value, &Value) -> Option<Value>,
    ) -> Option<Value> {
        if a.dims() != b.dims() {
            self.report_sizes(Pair::Operands, a, b, span);
            return None;
        }
        self.spend(a.elements().len() as u64, span)?;
        let elements: Option<Vec<Value>> =
            a.elements().iter().zip(b.elements()).map(|(x, y)| act(self, x, y)).collect();
        Some(Value::array(a.dims().to_vec(), elements?))
    }

    /// `a * b`: scalars, scaled arrays, and products of vectors and matrices.
    fn product(&mut self, a: &Value, b: &Value, span: Span) -> Option<Value> {
        let (m, n) = (a.dims().to_vec(), b.dims().to_vec());
        let (rows, inner, columns) = match (m.as_slice(), n.as_slice()) {
            ([], _) | (_, []) => return self.elementwise(Binary::Mul, a, b, true, span),
            ([k], [l]) if k == l => (1, *k, 1),
            ([r, k], [l]) if k == l => (*r, *k, 1),
            ([k], [l, c]) if k == l => (1, *k, *c),
            ([r, k], [l, c]) if k == l => (*r, *k, *c),
            _ => {
                self.report(ArrayCause::ProductSizes { left: m, right: n }, span);
                return None;
            }
        };
        if self.is_overloaded(a) || self.is_overloaded(b) {
            return self.overloaded_product(a, b, [rows, inner, columns], span);
        }
        let mut out = Vec::with_capacity(rows * columns);
        for r in 0..rows {
            self.spend((inner * columns) as u64, span)?;
            for c in 0..columns {
                let mut terms = Vec::with_capacity(inner);
                for k in 0..inner {
                    let x = self.number(&a.elements()[r * inner + k], span)?;
                    let y = self.number(&b.elements()[k * columns + c], span)?;
                    terms.push(self.graph.mul(x, y));
                }
                out.push(Value::Scalar(self.graph.sum(terms)));
            }
        }
        let mut dims = Vec::new();
        if m.len() == 2 {
            dims.push(rows);
        }
        if n.len() == 2 {
            dims.push(columns);
        }
        Some(Value::array(dims, out))
    }

    /// The product of arrays of operator records: their own for two vectors, if they have one, else
    /// sums of products.
    fn overloaded_product(
        &mut self,
        a: &Value,
        b: &Value,
        [rows, inner, columns]: [usize; 3],
        span: Span,
    ) -> Option<Value> {
        if a.dims().len() == 1 && b.dims().len() == 1 {
            return self.overloaded("'*'", &[a.clone(), b.clone()], span);
        }
        let mut out = Vec::with_capacity(rows * columns);
        for k in 0..rows * columns {
            let (r, c) = (k / columns, k % columns);
            let mut sum: Option<Value> = None;
            for k in 0..inner {
                let (x, y) = (&a.elements()[r * inner + k], &b.elements()[k * columns + c]);
                let term = self.overloaded("'*'", &[x.clone(), y.clone()], span)?;
                sum = Some(match sum {
                    Some(sum) => self.overloaded("'+'", &[sum, term], span)?,
                    None => term,
                });
            }
            out.push(sum?);
        }
        let mut dims = Vec::new();
        if a.dims().len() == 2 {
            dims.push(rows);
        }
        if b.dims().len() == 2 {
            dims.push(columns);
        }
        Some(Value::array(dims, out))
    }

    fn matrix_power(&mut self, a: &Value, b: &Value, span: Span) -> Option<Value> {
        let exponent = b.scalar().and_then(|e| self.graph.as_const(e));
        let (Some(Const::Integer(k @ 0..)), [r, c]) = (exponent, a.dims()) else {
            self.report(ArrayCause::MatrixPower, span);
            return None;
        };
        if r != c {
            self.report(ArrayCause::MatrixPower, span);
            return None;
        }
        let n = *r;
        // By squares: `a^13` is `a * a^4 * a^8`.
        let (mut result, mut square, mut left) = (self.identity(n), a.clone(), k);
        while left > 0 {
            if left % 2 == 1 {
                result = self.product(&result, &square, span)?;
            }
            left /= 2;
            if left > 0 {
                square = self.product(&square, &square, span)?;
            }
        }
        Some(result)
    }

    /// The unit matrix, of integers.
    pub(crate) fn identity(&mut self, n: usize) -> Value {
        let elements = (0..n * n)
            .map(|i| Value::Scalar(self.graph.integer(i64::from(i / n == i % n))))
            .collect();
        Value::array(vec![n, n], elements)
    }

    /// `if c then a elseif ... else b`
    pub(crate) fn if_expression(
        &mut self,
        branches: &[(Expr, Expr)],
        otherwise: &Expr,
        scope: Scope,
    ) -> Option<Value> {
        let Some(((condition, value), rest)) = branches.split_first() else {
            return self.evaluate(otherwise, scope);
        };
        let c = self.evaluate(condition, scope)?;
        let c = self.boolean_of(&c, condition.span)?;
        // Conditions on parameters of discrete type are decided here: the other branch need not
        // even have the same type.
        match self.decided(c) {
            Some(Const::Boolean(true)) => self.evaluate(value, scope),
            Some(Const::Boolean(false)) => self.if_expression(rest, otherwise, scope),
            _ => {
                let not_c = self.graph.not(c);
                let a = self.under(c, |cx| cx.evaluate(value, scope));
                let b = self.under(not_c, |cx| cx.if_expression(rest, otherwise, scope));
                self.if_values(c, a?, b?, value.span)
            }
        }
    }

    /// `if c then a else b` of values of the same shape.
    pub(crate) fn if_values(&mut self, c: ExprId, a: Value, b: Value, span: Span) -> Option<Value> {
        match (&a, &b) {
            (Value::Scalar(x), Value::Scalar(y)) => {
                let kind = |t| if t == Type::Integer { Type::Real } else { t };
                let (s, t) = (self.graph.ty(*x), self.graph.ty(*y));
                if kind(s) != kind(t) {
                    self.report_types(span, Pairing::Alternatives, s, t);
                    return None;
                }
                Some(Value::Scalar(self.graph.if_then_else(c, *x, *y)))
            }
            (Value::Array(_), Value::Array(_)) => {
                self.zip(&a, &b, span, &mut |cx, x, y| cx.if_values(c, x.clone(), y.clone(), span))
            }
            (Value::Record(r), Value::Record(s)) => {
                let mut fields = Vec::new();
                for (name, x) in &r.fields {
                    let y = s.fields.iter().find(|(n, _)| n == name)?.1.clone();
                    fields.push((*name, self.if_values(c, x.clone(), y, span)?));
                }
                Some(Value::Record(Rc::new(Record { class: r.class, fields })))
            }
            (Value::Tuple(s), Value::Tuple(t)) if s.len() == t.len() => {
                let all: Option<Vec<Value>> = s
                    .iter()
                    .zip(t.iter())
                    .map(|(x, y)| self.if_values(c, x.clone(), y.clone(), span))
                    .collect();
                Some(Value::Tuple(all?.into()))
            }
            _ => {
                self.report_sizes(Pair::Alternatives, &a, &b, span);
                None
            }
        }
    }

    /// A function of one number on every element.
    pub(crate) fn each_number(&mut self, op: Unary, a: &Value, span: Span) -> Option<Value> {
        a.map(|v| {
            let e = self.number(v, span)?;
            Some(Value::Scalar(self.graph.unary(op, e)))
        })
    }

    /// A function of two numbers on every pair of elements.
    pub(crate) fn each_pair(
        &mut self,
        op: Binary,
        a: &Value,
        b: &Value,
        span: Span,
    ) -> Option<Value> {
        self.elementwise(op, a, b, true, span)
    }
}
