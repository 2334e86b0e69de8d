//! Reductions such as `sum(x[i] for i in 1:k)` whose number of terms is known only at run time: a
//! loop that accumulates them, which becomes a function of the flat model.

use super::Evaluator;
use super::value::Value;
use crate::base::index::FastSet;
use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::ir::ast::{ComponentRef, Expr, Iterator as Loop};
use crate::ir::expr::{Binary, ExprId, Graph};
use crate::ir::instance::Scope;

/// The operation of a reduction, and its value without terms.
fn operation(graph: &mut Graph, function: &ComponentRef) -> Option<(Binary, ExprId)> {
    Some(match function.simple()?.as_str() {
        "sum" => (Binary::Add, graph.integer(0)),
        "product" => (Binary::Mul, graph.integer(1)),
        "min" => (Binary::Min, graph.real(f64::MAX)),
        "max" => (Binary::Max, graph.real(f64::MIN)),
        _ => return None,
    })
}

impl Evaluator<'_> {
    /// A reduction over iterators with ranges, of which the first has bounds known only at run time;
    /// `Some(None)` for any other.
    pub(super) fn reduction_at_run_time(
        &mut self,
        function: &ComponentRef,
        body: &Expr,
        iterators: &[Loop],
        scope: Scope,
        span: Span,
    ) -> Option<Option<Value>> {
        if self.mode.fold || self.mode.sizes {
            return Some(None);
        }
        let (Some((joins, empty)), Some((first, rest))) =
            (operation(&mut self.graph, function), iterators.split_first())
        else {
            return Some(None);
        };
        let Some(range) = self.open_range(first, scope)? else { return Some(None) };
        // Named by their position: a loop around this one has others, which this one leaves as they are.
        let at = self.frames.visible().len();
        let [counter, result] = ["iteration", "reduction"].map(|of| name(&format!("${of}{at}")));
        let names: FastSet<Name> = [counter, result].into_iter().collect();
        let zero = Value::Scalar(self.graph.integer(0));
        let empty = Value::Scalar(empty);
        let reduced = self.with_local(counter, zero, |cx| {
            cx.with_local(result, empty, |cx| {
                cx.loop_as_function(&names, span, |cx| {
                    let [iteration, before] =
                        [at, at + 1].map(|k| cx.frames.visible()[k].1.scalar());
                    let (iteration, before) = (iteration?, before?);
                    let holds = cx.is_within(iteration, &range);
                    let passed = cx.graph.binary(Binary::Mul, iteration, range.step);
                    let value = Value::Scalar(cx.graph.binary(Binary::Add, range.start, passed));
                    let term = cx.with_local(first.name.name, value, |cx| {
                        cx.under(holds, |cx| cx.term(function, body, rest, scope, span))
                    })?;
                    let joined = cx.joined(joins, before, term);
                    let one = cx.graph.integer(1);
                    let next = cx.graph.binary(Binary::Add, iteration, one);
                    cx.frames.visible_mut()[at].1 = Value::Scalar(next);
                    cx.frames.visible_mut()[at + 1].1 = Value::Scalar(joined);
                    Some((holds, super::algorithm::Flow::Next))
                })?;
                Some(cx.frames.visible()[at + 1].1.clone())
            })
        });
        reduced.map(Some)
    }

    /// The body, or its reduction over the other iterators.
    fn term(
        &mut self,
        function: &ComponentRef,
        body: &Expr,
        rest: &[Loop],
        scope: Scope,
        span: Span,
    ) -> Option<ExprId> {
        let value = match rest {
            [] => self.evaluate(body, scope)?,
            _ => self.reduction(function, body, rest, scope, span)?,
        };
        match value.scalar() {
            Some(scalar) => Some(scalar),
            None => self.number(&value, body.span),
        }
    }
}
