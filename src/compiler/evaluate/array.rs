//! Built-in functions of arrays: sizes, constructors and matrix algebra (section 10.3 of the
//! specification).

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::cause::types::Expected;
use super::value::Value;
use crate::base::source::Span;
use crate::ir::ast::{Expr, ExprKind};
use crate::ir::expr::{Binary, ExprId, Type};
use crate::ir::instance::Scope;

impl Evaluator<'_> {
    pub(super) fn min_max(
        &mut self,
        name: &str,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        match args {
            [a] => {
                let value = self.evaluate(a, scope)?;
                if value.scalar().is_some() {
                    self.wrong_arguments(span, "one array or two numbers");
                    return None;
                }
                self.reduce(name, &value, span)
            }
            [a, b] => {
                let (a, b) = (self.evaluate(a, scope)?, self.evaluate(b, scope)?);
                let op = if name == "min" { Binary::Min } else { Binary::Max };
                match (a.scalar(), b.scalar()) {
                    (Some(a), Some(b))
                        if self.graph.ty(a) == self.graph.ty(b)
                            && !matches!(
                                self.graph.ty(a),
                                Type::Real | Type::Integer | Type::String
                            ) =>
                    {
                        Some(Value::Scalar(self.joined(op, a, b)))
                    }
                    _ => self.each_pair(op, &a, &b, span),
                }
            }
            _ => {
                self.wrong_arguments(span, "one array or two numbers");
                None
            }
        }
    }

    /// Sizes of a value. Those of a variable are known before the model runs, though its values are not.
    fn dims_of(&mut self, e: &Expr, scope: Scope) -> Option<Vec<usize>> {
        let whole = match &e.kind {
            ExprKind::Ref(r) => r.parts.iter().all(|p| p.subscripts.is_empty()),
            _ => false,
        };
        let mode = self.mode.of_size_argument(whole);
        let value = self.with_mode(mode, |cx| cx.evaluate(e, scope));
        value.map(|v| v.dims().to_vec())
    }

    pub(super) fn array_call(
        &mut self,
        name: &str,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        match (name, args) {
            ("size", [a, k]) => {
                let k = self.fold_size(k, scope)?;
                if let Some(n) = self.known_size(a, k, scope) {
                    return Some(Value::Scalar(self.graph.integer(n as i64)));
                }
                let dims = self.dims_of(a, scope)?;
                match k.checked_sub(1).and_then(|k| dims.get(k)) {
                    Some(n) => Some(Value::Scalar(self.graph.integer(*n as i64))),
                    None => {
                        self.report(ArrayCause::NoSuchDimension { dimensions: dims.len() }, span);
                        None
                    }
                }
            }
            ("size", [a]) => {
                let dims = self.dims_of(a, scope)?;
                Some(Value::vector(
                    dims.into_iter().map(|n| self.graph.integer(n as i64)).collect(),
                ))
            }
            ("ndims", [a]) => {
                let n = self.dims_of(a, scope)?.len();
                Some(Value::Scalar(self.graph.integer(n as i64)))
            }
            ("zeros" | "ones", sizes) if !sizes.is_empty() => {
                let value = self.graph.integer(i64::from(name == "ones"));
                self.filled(Value::Scalar(value), sizes, scope)
            }
            ("fill", [value, sizes @ ..]) if !sizes.is_empty() => {
                let value = self.evaluate(value, scope)?;
                self.filled(value, sizes, scope)
            }
            ("identity", [n]) => {
                let n = self.fold_size(n, scope)?;
                self.check_count(&[n, n], span)?;
                Some(self.identity(n))
            }
            ("linspace", [a, b, n]) => self.linspace(a, b, n, scope, span),
            ("cat", [k, parts @ ..]) => {
                let k = self.fold_size(k, scope)?;
                let parts: Option<Vec<Value>> =
                    parts.iter().map(|p| self.evaluate(p, scope)).collect();
                self.cat(k, &parts?, span)
            }
            ("array", parts) => {
                let parts: Option<Vec<Value>> =
                    parts.iter().map(|p| self.evaluate(p, scope)).collect();
                self.stack(parts?, span)
            }
            ("cross" | "outerProduct", [a, b]) => {
                let (a, b) = (self.evaluate(a, scope)?, self.evaluate(b, scope)?);
                if name == "cross" {
                    self.cross(&a, &b, span)
                } else {
                    self.outer_product(&a, &b, span)
                }
            }
            (
                "diagonal" | "transpose" | "skew" | "symmetric" | "vector" | "scalar" | "matrix",
                [a],
            ) => {
                let value = self.evaluate(a, scope)?;
                self.reshaped(name, &value, span)
            }
            _ => {
                self.wrong_arguments(span, arguments_of(name));
                None
            }
        }
    }

    fn filled(&mut self, value: Value, sizes: &[Expr], scope: Scope) -> Option<Value> {
        let mut dims = Vec::with_capacity(sizes.len());
        for s in sizes {
            dims.push(self.fold_size(s, scope)?);
            self.check_count(&[dims.as_slice(), &[value.elements().len()]].concat(), s.span)?;
        }
        let n: usize = dims.iter().product();
        let mut elements = Vec::with_capacity(n * value.elements().len());
        for _ in 0..n {
            elements.extend_from_slice(value.elements());
        }
        dims.extend(value.dims());
        Some(Value::array(dims, elements))
    }

    fn linspace(
        &mut self,
        a: &Expr,
        b: &Expr,
        n: &Expr,
        scope: Scope,
        span: Span,
    ) -> Option<Value> {
        let (a, b) = (self.evaluate_scalar(a, scope)?, self.evaluate_scalar(b, scope)?);
        let n = self.fold_size(n, scope)?;
        if n < 2 {
            self.report(ArrayCause::TooFewPoints, span);
            return None;
        }
        let width = self.graph.sub(b, a);
        let elements = (0..n)
            .map(|i| {
                let share = self.graph.real(i as f64 / (n - 1) as f64);
                let part = self.graph.mul(width, share);
                self.graph.add(a, part)
            })
            .collect();
        Some(Value::vector(elements))
    }

    fn scalars(&mut self, v: &Value, span: Span) -> Option<Vec<ExprId>> {
        let all: Option<Vec<ExprId>> = v.elements().iter().map(Value::scalar).collect();
        if let Some(other) = v.elements().iter().find(|e| e.scalar().is_none()) {
            self.report_type(Expected::Number, other, span);
        }
        all
    }

    fn cross(&mut self, a: &Value, b: &Value, span: Span) -> Option<Value> {
        if a.dims() != [3] || b.dims() != [3] {
            let given = [a, b].map(|v| v.dims().to_vec()).into();
            self.report(ArrayCause::ArgumentSize { function: "cross".to_string(), given }, span);
            return None;
        }
        let (x, y) = (self.scalars(a, span)?, self.scalars(b, span)?);
        let mut minor = |i: usize, j: usize| {
            let p = self.graph.mul(x[i], y[j]);
            let q = self.graph.mul(x[j], y[i]);
            self.graph.sub(p, q)
        };
        Some(Value::vector(vec![minor(1, 2), minor(2, 0), minor(0, 1)]))
    }

    fn outer_product(&mut self, a: &Value, b: &Value, span: Span) -> Option<Value> {
        let (x, y) = (self.scalars(a, span)?, self.scalars(b, span)?);
        self.check_count(&[x.len(), y.len()], span)?;
        self.spend((x.len() * y.len()) as u64, span)?;
        let mut out = Vec::with_capacity(x.len() * y.len());
        for p in &x {
            for q in &y {
                out.push(Value::Scalar(self.graph.mul(*p, *q)));
            }
        }
        Some(Value::array(vec![x.len(), y.len()], out))
    }

    fn reshaped(&mut self, name: &str, a: &Value, span: Span) -> Option<Value> {
        let dims = a.dims().to_vec();
        let e = a.elements();
        let wrong = |cx: &mut Self| {
            let (function, given) = (name.to_string(), vec![dims.clone()]);
            cx.report(ArrayCause::ArgumentSize { function, given }, span);
            None
        };
        match (name, dims.as_slice()) {
            ("transpose", [r, c]) => {
                let out = (0..r * c).map(|k| e[(k % r) * c + k / r].clone()).collect();
                Some(Value::array(vec![*c, *r], out))
            }
            ("symmetric", [r, c]) if r == c => {
                let at = |i: usize, j: usize| e[i.min(j) * c + i.max(j)].clone();
                Some(Value::array(dims.clone(), (0..r * c).map(|k| at(k / c, k % c)).collect()))
            }
            ("diagonal", [n]) => {
                self.check_count(&[*n, *n], span)?;
                self.spend((n * n) as u64, span)?;
                let zero = Value::Scalar(self.graph.integer(0));
                let at = |k: usize| if k / n == k % n { e[k / n].clone() } else { zero.clone() };
                Some(Value::array(vec![*n, *n], (0..n * n).map(at).collect()))
            }
            ("skew", [3]) => {
                let x = self.scalars(a, span)?;
                let zero = self.graph.real(0.0);
                let n: Vec<ExprId> = x.iter().map(|e| self.graph.neg(*e)).collect();
                let m = [zero, n[2], x[1], x[2], zero, n[0], n[1], x[0], zero];
                Some(Value::array(vec![3, 3], m.map(Value::Scalar).to_vec()))
            }
            ("vector", _) if dims.iter().filter(|n| **n != 1).count() <= 1 => {
                Some(Value::array(vec![e.len()], e.to_vec()))
            }
            ("scalar", _) if e.len() == 1 => Some(e[0].clone()),
            ("matrix", d) => match d {
                [] => Some(Value::array(vec![1, 1], e.to_vec())),
                [n] => Some(Value::array(vec![*n, 1], e.to_vec())),
                [_, _] => Some(a.clone()),
                // Further dimensions have one element each (section 10.3.2).
                [rows, columns, rest @ ..] if rest.iter().all(|n| *n == 1) => {
                    Some(Value::array(vec![*rows, *columns], e.to_vec()))
                }
                _ => wrong(self),
            },
            _ => wrong(self),
        }
    }
}

/// The arguments of an array function, in words.
fn arguments_of(name: &str) -> &'static str {
    match name {
        "size" => "an array, and optionally a dimension",
        "zeros" | "ones" => "at least one size",
        "fill" => "a value and at least one size",
        "linspace" => "two bounds and a number of points",
        "cat" => "a dimension and at least one array",
        "cross" | "outerProduct" => "two vectors",
        _ => "one argument",
    }
}
