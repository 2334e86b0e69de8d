//! Delayed expressions and transport along a line: `delay` and `spatialDistribution` (sections
//! 3.7.4.1 and 3.7.4.2 of the specification).

use super::Evaluator;
use super::builtin::argument;
use super::cause::builtin::{BuiltinCause, WrongPoints};
use super::cause::types::Expected;
use super::random_draw::RandomDraw;
use super::value::Value;
use crate::base::source::Span;
use crate::classes::unsupported::Construct;
use crate::ir::ast::{Expr, Ident, Variability};
use crate::ir::expr::{Binary, Carried, Const, ExprId, FIRST_SYMBOL, Node, Type, Unary, VarId};
use crate::ir::flat::AssertionLevel;
use crate::ir::instance::Scope;

/// Delays, transport lines and random numbers found so far.
#[derive(Clone, Default)]
pub(crate) struct History {
    /// The variables after all others, in their order.
    pub synthetic: Vec<Synthetic>,
    /// Lines along which something is carried.
    pub lines: Vec<TransportCall>,
}

/// A synthetic variable that expressions of the model refer to.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Synthetic {
    /// A delayed expression.
    Delay(DelayCall),
    /// How often a when-clause has drawn random numbers.
    Counter(Span),
    /// A random number.
    Number(RandomDraw),
    /// The value of a stream variable that flows in.
    InStream(VarId),
    /// A condition of a when-statement.
    Condition(ExprId, Span),
    /// The value that one when-statement of several gives a variable.
    Assigned(Type, Span),
    /// An expression with calls of functions whose derivative is read.
    Derived(ExprId, Span),
    /// An expression whose derivative, a variable, an annotation gives; the last derivative has none.
    Given(ExprId, Option<VarId>, Span),
}

/// An expression that is delayed by a time that stays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DelayCall {
    /// The delayed expression.
    pub value: ExprId,
    /// By how much, s.
    pub time: ExprId,
    /// Place of the call.
    pub span: Span,
}

/// A line along which something is carried, see [`crate::ir::flat::Transport`].
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct TransportCall {
    /// Places of the low and of the high end.
    pub ends: [ExprId; 2],
    /// The value that enters there, if any.
    pub entering: [Option<ExprId>; 2],
    /// The initial profile of the line: places from the low end on, and values.
    pub initial: Vec<(ExprId, ExprId)>,
    /// For a line in time: the longest delay.
    pub longest: Option<ExprId>,
    /// The places that are read.
    pub readers: Vec<ExprId>,
    /// Place of the call.
    pub span: Span,
}

impl Evaluator<'_> {
    /// `delay(e, T)`: the value of `e` a time `T` ago; a bound on `T` may follow.
    pub(crate) fn delay(&mut self, args: &[Expr], span: Span, scope: Scope) -> Option<Value> {
        let ([e, time] | [e, time, _]) = args else {
            self.wrong_arguments(span, "an expression and a time");
            return None;
        };
        let place = time.span;
        let (value, time) = (self.evaluate(e, scope)?, self.evaluate_scalar(time, scope)?);
        let mut recorded = vec![time];
        value.for_each_scalar(&mut |e| recorded.push(e));
        self.check_recordable(&recorded, span)?;
        let varies = self.variability(time) > Variability::Parameter;
        if args.len() == 2 && varies {
            self.report(BuiltinCause::UnboundedDelay, place);
            return None;
        }
        let fixed = self.parameters.structural.len();
        let known = self.parameter_expression(time, true).and_then(Const::number);
        if known != Some(0.0) {
            // Only a delay of zero would affect the structure.
            for id in self.parameters.structural.split_off(fixed) {
                self.parameters.values.remove(&id);
            }
        }
        if known.is_some_and(|t| t < 0.0) {
            self.report(BuiltinCause::NegativeDelay, span);
            return None;
        }
        let mut bound = None;
        if let Some(longest) = args.get(2) {
            bound = Some(self.longest_delay(longest, known, scope)?);
        }
        if known == Some(0.0) || self.mode.is_before_simulation() {
            return Some(value);
        }
        if let Some(bound) = bound.filter(|_| varies) {
            self.assert_delay(time, bound, span)?;
        }
        value.map(|v| {
            let value = self.scalar_of(v.clone(), span)?;
            // A value that never changes has no history.
            if self.variability(value) <= Variability::Parameter {
                return Some(Value::Scalar(value));
            }
            if let Some(bound) = bound.filter(|_| varies) {
                return Some(Value::Scalar(self.varying_delay(value, time, bound, span)));
            }
            let same = |m: &Synthetic| matches!(m, Synthetic::Delay(d) if (d.value, d.time) == (value, time));
            let known = self.history.synthetic.iter().position(same);
            let v = match known {
                Some(k) => self.synthetic_variable(k),
                None => self.make(Synthetic::Delay(DelayCall { value, time, span })),
            };
            Some(Value::Scalar(self.graph.intern(Node::Recorded(v, 0), Type::Real)))
        })
    }

    /// What changes with the iterations of a loop has no value between them that could be recorded.
    fn check_recordable(&mut self, values: &[ExprId], span: Span) -> Option<()> {
        let is_symbol =
            |n: &ExprId| matches!(self.graph.node(*n), Node::Var(v) if v.0 >= FIRST_SYMBOL);
        if self.graph.postorder(values.iter().copied()).iter().any(is_symbol) {
            self.unsupported(span, Construct::HistoryInLoop);
            return None;
        }
        Some(())
    }

    /// The derivative of an expression with calls of functions: that of a variable, as functions have derivatives in the
    /// equations of index reduction only.
    pub(crate) fn derivative_of_calls(&mut self, value: ExprId, span: Span) -> Option<ExprId> {
        self.check_recordable(&[value], span)?;
        let same = |m: &Synthetic| matches!(m, Synthetic::Derived(e, _) if *e == value);
        let v = match self.history.synthetic.iter().position(same) {
            Some(k) => self.synthetic_variable(k),
            None => self.make(Synthetic::Derived(value, span)),
        };
        Some(self.graph.der(v))
    }

    /// A variable after all others.
    pub(crate) fn make(&mut self, made: Synthetic) -> VarId {
        self.history.synthetic.push(made);
        self.synthetic_variable(self.history.synthetic.len() - 1)
    }

    /// The variability of a synthetic variable, which follows all others.
    pub(crate) fn synthetic_variability(&self, v: VarId) -> Variability {
        let after = (v.0 as usize).checked_sub(self.instance_of.len());
        match after.and_then(|k| self.history.synthetic.get(k)) {
            Some(Synthetic::Number(drawing)) if drawing.counter.is_none() => Variability::Parameter,
            Some(
                Synthetic::Number(_)
                | Synthetic::Counter(_)
                | Synthetic::Condition(..)
                | Synthetic::Assigned(..),
            ) => Variability::Discrete,
            Some(
                Synthetic::Delay(_)
                | Synthetic::InStream(_)
                | Synthetic::Derived(..)
                | Synthetic::Given(..),
            )
            | None => Variability::Continuous,
        }
    }

    pub(super) fn synthetic_variable(&self, k: usize) -> VarId {
        VarId((self.instance_of.len() + k) as u32)
    }

    /// The bound on a delay is known before the model runs, and is a bound.
    fn longest_delay(&mut self, longest: &Expr, time: Option<f64>, scope: Scope) -> Option<ExprId> {
        let bound = self.evaluate_scalar(longest, scope)?;
        if self.variability(bound) > Variability::Parameter {
            self.report(BuiltinCause::VaryingDelayBound, longest.span);
            return None;
        }
        if let (Some(delay), Some(most)) = (time, self.graph.as_number(bound))
            && delay > most
        {
            self.report(BuiltinCause::DelayTooLong { delay, longest: most }, longest.span);
            return None;
        }
        Some(bound)
    }

    /// A delay that varies stays between zero and its bound.
    fn assert_delay(&mut self, time: ExprId, bound: ExprId, span: Span) -> Option<()> {
        let zero = self.graph.real(0.0);
        let positive = self.graph.binary(Binary::GreaterEqual, time, zero);
        let message = self.graph.string("the time of `delay` is negative");
        self.assert_now_or_later(positive, message, AssertionLevel::Error, span)?;
        let bounded = self.graph.binary(Binary::LessEqual, time, bound);
        let message = self.graph.string("the time of `delay` is longer than its bound");
        self.assert_now_or_later(bounded, message, AssertionLevel::Error, span)
    }

    /// Time itself is the line: the present enters at its high end.
    fn varying_delay(&mut self, value: ExprId, by: ExprId, bound: ExprId, span: Span) -> ExprId {
        let now = self.graph.time();
        let ends = [self.graph.sub(now, bound), now];
        let place = self.graph.sub(now, by);
        let entering = [None, Some(value)];
        let (initial, longest, readers) = (Vec::new(), Some(bound), vec![place]);
        self.transported(TransportCall { ends, entering, initial, longest, readers, span })
    }

    /// `(out0, out1) = spatialDistribution(in0, in1, x, positiveVelocity, initialPoints,
    /// initialValues)`: the values that arrive at the ends of a line of length 1, where `x` is the
    /// distance that its contents have moved.
    pub(crate) fn spatial_distribution(
        &mut self,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let find = |k: usize, name: &str| argument(args, named, k, name);
        let needed = [find(0, "in0"), find(1, "in1"), find(2, "x"), find(3, "positiveVelocity")];
        let [Some(in0), Some(in1), Some(x), Some(forward)] = needed else {
            self.wrong_arguments(span, "the inflows at both ends, a position and a direction");
            return None;
        };
        let position = x.span;
        let [in0, in1, x, forward] = [in0, in1, x, forward].map(|e| self.evaluate_scalar(e, scope));
        let (in0, in1, x, forward) = (in0?, in1?, x?, forward?);
        for (e, span) in [(in0, span), (in1, span), (x, position)] {
            if !matches!(self.graph.ty(e), Type::Real | Type::Integer) {
                self.report_type(Expected::Number, &Value::Scalar(e), span);
                return None;
            }
        }
        if self.graph.ty(forward) != Type::Boolean {
            self.report_type(Expected::Boolean, &Value::Scalar(forward), span);
            return None;
        }
        self.check_recordable(&[in0, in1, x, forward], span)?;
        let points = self.points(find(4, "initialPoints"), [0.0, 1.0], scope)?;
        let values = self.points(find(5, "initialValues"), [0.0, 0.0], scope)?;
        self.check_points(&points, &values, find(4, "initialPoints").map_or(span, |e| e.span))?;
        if self.mode.is_before_simulation() {
            return Some(Value::Tuple([Value::Scalar(in0), Value::Scalar(in1)].into()));
        }
        if self.variability(x) <= Variability::Parameter {
            self.report(BuiltinCause::FixedPosition, position);
            return None;
        }
        let one = self.graph.real(1.0);
        let (low, high) = (self.graph.neg(x), self.graph.sub(one, x));
        let line = |readers| TransportCall {
            ends: [low, high],
            entering: [Some(in0), Some(in1)],
            initial: points.iter().copied().zip(values.iter().copied()).collect(),
            longest: None,
            readers,
            span,
        };
        let (at_low, at_high) =
            (self.transported(line(vec![low])), self.transported(line(vec![high])));
        let out0 = self.graph.if_then_else(forward, in0, at_low);
        let out1 = self.graph.if_then_else(forward, at_high, in1);
        Some(Value::Tuple([out0, out1].map(Value::Scalar).into()))
    }

    /// A vector of parameters, or its default.
    fn points(
        &mut self,
        given: Option<&Expr>,
        default: [f64; 2],
        scope: Scope,
    ) -> Option<Vec<ExprId>> {
        let Some(given) = given else {
            return Some(default.map(|x| self.graph.real(x)).to_vec());
        };
        let value = self.evaluate(given, scope)?;
        if value.dims().len() != 1 {
            self.report_type(Expected::Vector, &value, given.span);
            return None;
        }
        value.elements().iter().map(Value::scalar).collect()
    }

    /// The points rise from 0 to 1, and each has a value.
    fn check_points(&mut self, points: &[ExprId], values: &[ExprId], span: Span) -> Option<()> {
        let known: Option<Vec<f64>> = points.iter().map(|p| self.graph.as_number(*p)).collect();
        let why = if points.len() != values.len() {
            WrongPoints::Count { points: points.len(), values: values.len() }
        } else if points.len() < 2 {
            WrongPoints::TooFew
        } else if known.is_some_and(|p| {
            p[0] != 0.0 || p[p.len() - 1] != 1.0 || p.windows(2).any(|w| w[0] > w[1])
        }) {
            WrongPoints::NotRising
        } else {
            return Some(());
        };
        self.report(BuiltinCause::InitialPoints { why }, span);
        None
    }

    /// The value at a place of a line. Lines that differ only in their readers are one.
    fn transported(&mut self, mut wanted: TransportCall) -> ExprId {
        let places = std::mem::take(&mut wanted.readers);
        let lines = &mut self.history.lines;
        let same = |l: &TransportCall| {
            (&l.ends, &l.entering, &l.initial) == (&wanted.ends, &wanted.entering, &wanted.initial)
        };
        let line = lines.iter().position(same).unwrap_or_else(|| {
            lines.push(wanted);
            lines.len() - 1
        });
        let place = places[0];
        let readers = &mut lines[line].readers;
        let reader = readers.iter().position(|r| *r == place).unwrap_or_else(|| {
            readers.push(place);
            readers.len() - 1
        });
        let what = Carried { line: line as u16, reader: reader as u16, order: 0 };
        self.graph.unary(Unary::Carried(what), place)
    }
}
