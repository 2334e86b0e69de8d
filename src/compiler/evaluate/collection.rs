//! Arrays built from parts, ranges and iterators, and reductions of their elements (chapter 10 of
//! the specification).

use super::Evaluator;
use super::cause::array::ArrayCause;
use super::cause::builtin::BuiltinCause;
use super::cause::types::Expected;
use super::implicit_ranges::Body;
use super::value::Value;
use crate::base::source::Span;
use crate::ir::ast::{self, ComponentRef, Expr};
use crate::ir::expr::{Binary, Const, ExprId, Type};
use crate::ir::instance::Scope;

/// Part of a step by which a range of Reals may miss its bound and still have it as an element.
pub(super) const MARGIN: f64 = 1e-10;

impl Evaluator<'_> {
    /// `{a, b}`: parts of one shape under a new first dimension.
    pub(crate) fn stack(&mut self, parts: Vec<Value>, span: Span) -> Option<Value> {
        let Some(first) = parts.first() else {
            return Some(Value::array(vec![0], Vec::new()));
        };
        let inner = first.dims().to_vec();
        if let Some(other) = parts.iter().find(|p| p.dims() != inner) {
            let other = other.dims().to_vec();
            self.report(ArrayCause::EntrySizes { first: inner, other }, span);
            return None;
        }
        let mut dims = vec![parts.len()];
        dims.extend(inner);
        self.check_count(&dims, span)?;
        self.spend(dims.iter().product::<usize>() as u64, span)?;
        let elements = self.same_type(parts.iter().flat_map(|p| p.elements().to_vec()).collect());
        Some(Value::array(dims, elements))
    }

    /// Integer literals among reals become real.
    fn same_type(&mut self, elements: Vec<Value>) -> Vec<Value> {
        let real =
            elements.iter().any(|v| v.scalar().is_some_and(|e| self.graph.ty(e) == Type::Real));
        if !real {
            return elements;
        }
        elements
            .into_iter()
            .map(|v| match v.scalar().and_then(|e| self.graph.as_const(e)) {
                Some(Const::Integer(i)) => Value::Scalar(self.graph.real(i as f64)),
                _ => v,
            })
            .collect()
    }

    /// `cat(k, ...)`, `[a, b; c]`; vectors and scalars are raised to matrices first.
    pub(crate) fn concatenate(&mut self, k: usize, parts: Vec<Value>, span: Span) -> Option<Value> {
        let rank = parts.iter().map(|p| p.dims().len()).max().unwrap_or(0).max(2);
        let raised: Vec<Value> = parts
            .into_iter()
            .map(|p| {
                let mut dims = p.dims().to_vec();
                let elements = p.elements().to_vec();
                dims.resize(rank, 1);
                Value::array(dims, elements)
            })
            .collect();
        self.cat(k, &raised, span)
    }

    /// `cat(k, ...)` of arrays of equal rank.
    pub(crate) fn cat(&mut self, k: usize, parts: &[Value], span: Span) -> Option<Value> {
        let first = parts.first()?.dims().to_vec();
        let fits = |d: &[usize]| {
            d.len() == first.len() && (0..d.len()).all(|i| i + 1 == k || d[i] == first[i])
        };
        if k == 0 || k > first.len() || !parts.iter().all(|p| fits(p.dims())) {
            let sizes = parts.iter().map(|p| p.dims().to_vec()).collect();
            self.report(ArrayCause::ConcatenatedSizes { sizes }, span);
            return None;
        }
        let mut dims = first.clone();
        dims[k - 1] = parts.iter().map(|p| p.dims()[k - 1]).sum();
        self.check_count(&dims, span)?;
        self.spend(dims.iter().product::<usize>() as u64, span)?;
        let outer: usize = first[..k - 1].iter().product();
        let mut elements = Vec::new();
        for o in 0..outer {
            for p in parts {
                let chunk: usize = p.dims()[k - 1..].iter().product();
                elements.extend_from_slice(&p.elements()[o * chunk..(o + 1) * chunk]);
            }
        }
        let elements = self.same_type(elements);
        Some(Value::array(dims, elements))
    }

    /// `a : step : b`
    pub(crate) fn range(
        &mut self,
        start: &Expr,
        step: Option<&Expr>,
        stop: &Expr,
        scope: Scope,
        span: Span,
    ) -> Option<Value> {
        // The bounds decide the size, so their values count where only sizes are wanted.
        let mode = if self.mode.sizes { self.mode.folding() } else { self.mode };
        let mut bound = |e: &Expr| {
            let s = self.with_mode(mode, |cx| cx.evaluate_scalar(e, scope))?;
            if let Some(c) = self.graph.as_const(s) {
                return Some(c);
            }
            let value = self.fold(e, scope)?;
            value.scalar().and_then(|s| self.graph.as_const(s))
        };
        let (a, b) = (bound(start)?, bound(stop)?);
        let step = match step {
            Some(e) => bound(e)?,
            None => Const::Integer(1),
        };
        let elements = match (a, step, b) {
            (Const::Integer(a), Const::Integer(s), Const::Integer(b)) if s != 0 => {
                let (from, by, to) = (i128::from(a), i128::from(s), i128::from(b));
                let n =
                    if (to - from).signum() * by.signum() < 0 { 0 } else { (to - from) / by + 1 };
                self.check_count(&[usize::try_from(n).unwrap_or(usize::MAX)], span)?;
                (0..n as i64).map(|i| Value::Scalar(self.graph.integer(a + i * s))).collect()
            }
            (Const::Enumeration(t, a), _, Const::Enumeration(u, b)) if t == u => (a..=b)
                .map(|k| Value::Scalar(self.graph.constant(Const::Enumeration(t, k))))
                .collect(),
            (Const::Boolean(a), _, Const::Boolean(b)) => [false, true]
                .into_iter()
                .filter(|x| *x >= a && *x <= b)
                .map(|x| Value::Scalar(self.graph.boolean(x)))
                .collect(),
            _ => match (a.number(), step.number(), b.number()) {
                (Some(a), Some(s), Some(b)) if s != 0.0 => {
                    let n = ((b - a) / s + MARGIN).floor();
                    let n = if n < 0.0 { 0 } else { (n as usize).saturating_add(1) };
                    self.check_count(&[n], span)?;
                    (0..n).map(|i| Value::Scalar(self.graph.real(a + i as f64 * s))).collect()
                }
                (Some(_), Some(_), Some(_)) => {
                    self.report(ArrayCause::ZeroStep, span);
                    return None;
                }
                _ => {
                    let other = [a, step, b].into_iter().find(|c| c.number().is_none())?;
                    let other = Value::Scalar(self.graph.constant(other));
                    self.report_type(Expected::RangeBound, &other, span);
                    return None;
                }
            },
        };
        let elements: Vec<Value> = elements;
        Some(Value::array(vec![elements.len()], elements))
    }

    /// `{e for i in r, j in s}`: the last iterator is the outermost dimension.
    pub(crate) fn comprehension(
        &mut self,
        body: &Expr,
        iterators: &[ast::Iterator],
        scope: Scope,
    ) -> Option<Value> {
        let iterators = self.with_ranges(iterators, Body::Expression(body), scope)?;
        self.comprehend(body, &iterators, scope)
    }

    fn comprehend(
        &mut self,
        body: &Expr,
        iterators: &[ast::Iterator],
        scope: Scope,
    ) -> Option<Value> {
        let Some((last, inner)) = iterators.split_last() else {
            return self.evaluate(body, scope);
        };
        let values = self.values_of(last, scope)?;
        let mut parts = Vec::with_capacity(values.len());
        for value in values {
            let part =
                self.with_local(last.name.name, value, |cx| cx.comprehend(body, inner, scope));
            parts.push(part?);
        }
        self.stack(parts, body.span)
    }

    /// `sum(e for i in r)` and the like.
    pub(crate) fn reduction(
        &mut self,
        function: &ComponentRef,
        body: &Expr,
        iterators: &[ast::Iterator],
        scope: Scope,
        span: Span,
    ) -> Option<Value> {
        let iterators = &self.with_ranges(iterators, Body::Expression(body), scope)?[..];
        if let Some(sum) = self.reduction_at_run_time(function, body, iterators, scope, span)? {
            return Some(sum);
        }
        let all = self.comprehend(body, iterators, scope)?;
        match function.simple().as_ref().map(|n| n.as_str()) {
            Some("array") => Some(all),
            Some("sum") if all.dims().len() > iterators.len() => {
                self.sum_of_arrays(&all, iterators.len(), span)
            }
            Some(name @ ("sum" | "product" | "min" | "max")) => self.reduce(name, &all, span),
            _ => {
                let function_name = self.sources.text(function.span).unwrap_or_default();
                let cause = BuiltinCause::NotAReduction { function: function_name.to_string() };
                self.report(cause, function.span);
                None
            }
        }
    }

    /// `sum(e for i in r)` has the sizes of `e` (section 10.3.4.1): the sum over the first `leading`
    /// dimensions.
    fn sum_of_arrays(&mut self, all: &Value, leading: usize, span: Span) -> Option<Value> {
        let inner = all.dims()[leading..].to_vec();
        let width: usize = inner.iter().product();
        let mut sums = Vec::with_capacity(width);
        for k in 0..width {
            let column: Vec<Value> =
                all.elements().iter().skip(k).step_by(width).cloned().collect();
            let column = Value::array(vec![column.len()], column);
            sums.push(self.reduce("sum", &column, span)?);
        }
        Some(Value::array(inner, sums))
    }

    /// `sum`, `product`, `min`, `max` over all elements.
    pub(crate) fn reduce(&mut self, name: &str, all: &Value, span: Span) -> Option<Value> {
        if self.is_overloaded(all) && matches!(name, "sum" | "product") {
            let operator = if name == "sum" { "'+'" } else { "'*'" };
            let (first, rest) = all.elements().split_first()?;
            return rest.iter().try_fold(first.clone(), |result, v| {
                self.overloaded(operator, &[result, v.clone()], span)
            });
        }
        let mut elements = Vec::with_capacity(all.elements().len());
        let needs_numbers = matches!(name, "sum" | "product");
        for v in all.elements() {
            elements.push(match v.scalar() {
                Some(_) if needs_numbers => self.number(v, span)?,
                Some(e) => e,
                None => return self.number(v, span).map(Value::Scalar),
            });
        }
        let (op, empty) = match name {
            "sum" => (Binary::Add, 0.0),
            "product" => (Binary::Mul, 1.0),
            "min" => (Binary::Min, f64::MAX),
            _ => (Binary::Max, f64::MIN),
        };
        let result = elements.iter().copied().reduce(|a, b| self.joined(op, a, b));
        Some(Value::Scalar(result.unwrap_or_else(|| match op {
            Binary::Add => self.graph.integer(0),
            Binary::Mul => self.graph.integer(1),
            _ => self.graph.real(empty),
        })))
    }

    /// Sum, product, minimum or maximum of two values. Booleans and enumerations are ordered too
    /// (section 10.3.4).
    pub(super) fn joined(&mut self, op: Binary, a: ExprId, b: ExprId) -> ExprId {
        match (op, self.graph.ty(a)) {
            (Binary::Min, Type::Boolean) => self.graph.and(a, b),
            (Binary::Max, Type::Boolean) => self.graph.or(a, b),
            (Binary::Min | Binary::Max, Type::Enumeration(_)) => {
                let relation =
                    if op == Binary::Min { Binary::LessEqual } else { Binary::GreaterEqual };
                let first = self.graph.binary(relation, a, b);
                self.graph.if_then_else(first, a, b)
            }
            _ => self.graph.binary(op, a, b),
        }
    }
}
