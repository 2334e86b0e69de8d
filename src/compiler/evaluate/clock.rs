//! Operators of clocks and state machines (Modelica 3.6, chapters 16 and 17).
//!
//! The evaluator only types them and folds the arguments that must be known: the stage `clocks` gives them a
//! meaning.

use super::Evaluator;
use super::builtin::argument;
use super::cause::builtin::BuiltinCause;
use super::cause::types::Expected;
use super::value::Value;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{ComponentRef, Expr, ExprKind, Ident, Variability};
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Const, ExprId, Node, Type};
use crate::ir::instance::{InstanceId, InstanceKind, Scope};

impl Evaluator<'_> {
    /// A call of an operator of clocks or state machines; `None` if the name is none of them.
    pub(super) fn clock_call(
        &mut self,
        name: Name,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Option<Value>> {
        use ClockOperator::*;
        Some(match name.as_str() {
            "Clock" => self.clock_constructor(args, named, span, scope),
            "subSample" => self.conversion(SubSample, args, named, span, scope),
            "superSample" => self.conversion(SuperSample, args, named, span, scope),
            "shiftSample" => self.conversion(ShiftSample, args, named, span, scope),
            "backSample" => self.conversion(BackSample, args, named, span, scope),
            "noClock" => self.conversion(NoClock, args, named, span, scope),
            "previous" => self.of_component(Previous, args, span, scope),
            "hold" => self.of_component(Hold, args, span, scope),
            "firstTick" => self.of_clock(FirstTick, Type::Boolean, args, span, scope),
            "interval" => self.of_clock(Elapsed, Type::Real, args, span, scope),
            "ticksInState" => self.of_clock(TicksInState, Type::Integer, args, span, scope),
            "timeInState" => self.of_clock(TimeInState, Type::Real, args, span, scope),
            "activeState" => self.active_state(args, span, scope),
            _ => return None,
        })
    }

    /// `sample(u)` or `sample(u, clock)`.
    pub(super) fn clocked_sample(&mut self, u: &Value, clock: Option<ExprId>) -> Value {
        u.each_scalar(&mut |e| {
            let ty = self.graph.ty(e);
            let args: Vec<ExprId> = [e].into_iter().chain(clock).collect();
            self.graph.clocked(ClockOperator::Sample, &args, ty)
        })
    }

    /// `Clock(...)` in each of its forms (section 16.3).
    fn clock_constructor(
        &mut self,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let find =
            |k: usize, names: &[&str]| names.iter().find_map(|name| argument(args, named, k, name));
        let Some(first) = find(0, &["intervalCounter", "interval", "condition", "c"]) else {
            return Some(self.clock(ClockOperator::Inferred, &[]));
        };
        let given = self.evaluate_scalar(first, scope)?;
        match self.graph.ty(given) {
            Type::Clock => {
                let method = match find(1, &["solverMethod"]) {
                    Some(method) => self.fold_scalar(method, scope)?,
                    None => self.graph.string(""),
                };
                Some(self.clock(ClockOperator::Solver, &[given, method]))
            }
            Type::Boolean => {
                let start = match find(1, &["startInterval"]) {
                    Some(start) => self.evaluate_scalar(start, scope)?,
                    None => self.graph.real(0.0),
                };
                let start = self.graph.as_real(start);
                Some(self.clock(ClockOperator::Event, &[given, start]))
            }
            Type::Integer => {
                let resolution = match find(1, &["resolution"]) {
                    Some(resolution) => self.fold_scalar(resolution, scope)?,
                    None => self.graph.integer(1),
                };
                let counter = match self.variability(given) <= Variability::Parameter {
                    true => self.fold_scalar(first, scope)?,
                    false => given,
                };
                let known = |e| matches!(self.graph.as_const(e), Some(Const::Integer(n)) if n >= 1);
                let zero = self.graph.as_const(counter) == Some(Const::Integer(0));
                if !known(resolution)
                    || !zero && self.graph.as_const(counter).is_some() && !known(counter)
                {
                    self.report(BuiltinCause::ClockCounter, span);
                    return None;
                }
                if zero {
                    return Some(self.clock(ClockOperator::Inferred, &[]));
                }
                Some(self.clock(ClockOperator::Rational, &[counter, resolution]))
            }
            Type::Real => Some(self.clock(ClockOperator::Interval, &[given])),
            _ => {
                self.report_type(Expected::Clock, &Value::Scalar(given), first.span);
                None
            }
        }
    }

    fn clock(&mut self, op: ClockOperator, args: &[ExprId]) -> Value {
        Value::Scalar(self.graph.clocked(op, args, Type::Clock))
    }

    /// Operators between clocks of one base clock (section 16.5.2).
    fn conversion(
        &mut self,
        op: ClockOperator,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let Some(u) = argument(args, named, 0, "u") else {
            self.wrong_arguments(span, "a clocked expression or a clock");
            return None;
        };
        let counters: &[(&str, i64)] = match op {
            ClockOperator::SubSample | ClockOperator::SuperSample => &[("factor", 0)],
            ClockOperator::ShiftSample => &[("shiftCounter", 0), ("resolution", 1)],
            ClockOperator::BackSample => &[("backCounter", 0), ("resolution", 1)],
            _ => &[],
        };
        let mut known = Vec::with_capacity(counters.len());
        for (k, &(name, default)) in counters.iter().enumerate() {
            let counter = match argument(args, named, k + 1, name) {
                Some(written) => self.fold_scalar(written, scope)?,
                None => self.graph.integer(default),
            };
            match self.graph.as_const(counter) {
                Some(Const::Integer(n)) if n >= i64::from(name == "resolution") => {}
                _ => {
                    self.report(BuiltinCause::ClockCounter, span);
                    return None;
                }
            }
            known.push(counter);
        }
        let value = self.evaluate(u, scope)?;
        Some(value.each_scalar(&mut |e| {
            let ty = self.graph.ty(e);
            let args: Vec<ExprId> = [e].into_iter().chain(known.iter().copied()).collect();
            self.graph.clocked(op, &args, ty)
        }))
    }

    /// `previous` and `hold`, whose argument has a start value or never changes.
    fn of_component(
        &mut self,
        op: ClockOperator,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let [u] = args else {
            self.wrong_arguments(span, "one argument");
            return None;
        };
        let mode = self.mode.unassigned();
        let value = self.with_mode(mode, |cx| cx.evaluate(u, scope))?;
        let mut wrong = false;
        let value = value.each_scalar(&mut |e| match self.graph.node(e) {
            Node::Var(_) => {
                if self.variability(e) <= Variability::Parameter {
                    return e;
                }
                let ty = self.graph.ty(e);
                self.graph.clocked(op, &[e], ty)
            }
            _ if self.variability(e) <= Variability::Parameter => e,
            _ => {
                wrong = true;
                e
            }
        });
        if wrong {
            let function = self.called_name(span);
            self.report(BuiltinCause::ArgumentNotVariable { function }, span);
            return None;
        }
        Some(value)
    }

    /// What an operator says about the clock of its argument, or of the equation where it is written.
    fn of_clock(
        &mut self,
        op: ClockOperator,
        ty: Type,
        args: &[Expr],
        span: Span,
        scope: Scope,
    ) -> Option<Value> {
        let mut given = Vec::new();
        match args {
            [] => {}
            [u] => self.evaluate(u, scope)?.for_each_scalar(&mut |e| given.push(e)),
            _ => {
                self.wrong_arguments(span, "at most one argument");
                return None;
            }
        }
        given.truncate(1);
        Some(Value::Scalar(self.graph.clocked(op, &given, ty)))
    }

    fn active_state(&mut self, args: &[Expr], span: Span, scope: Scope) -> Option<Value> {
        let state = match args {
            [state] => self.state(state, scope),
            _ => None,
        };
        let Some(state) = state else {
            self.report(BuiltinCause::NotAState, span);
            return None;
        };
        let path = self.path(state);
        let path = self.graph.string(&path);
        Some(Value::Scalar(self.graph.clocked(ClockOperator::ActiveState, &[path], Type::Boolean)))
    }

    /// The block that an argument of `transition`, `initialState` or `activeState` names.
    pub(crate) fn state(&mut self, e: &Expr, scope: Scope) -> Option<InstanceId> {
        let ExprKind::Ref(ComponentRef { parts, .. }) = &e.kind else { return None };
        let mut at = scope.instance;
        for part in parts {
            at = self.child(at, part.name.name)?;
            self.complete(at);
            if !part.subscripts.is_empty() {
                return None;
            }
            if let InstanceKind::Outer(inner) = self.instances[at].kind {
                at = inner;
            }
        }
        matches!(self.instances[at].kind, InstanceKind::Object(_)).then_some(at)
    }
}
