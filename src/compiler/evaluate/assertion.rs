//! Assertions of functions, and the conditions under which the code being evaluated is active.

use super::Evaluator;
use super::algorithm::Exits;
use super::builtin::argument;
use super::cause::call::{CallCause, Takes};
use super::cause::types::Expected;
use super::random_draw::Place;
use super::value::Value;
use crate::base::source::Span;
use crate::ir::ast::{Expr, Ident};
use crate::ir::expr::{Const, ExprId, Type};
use crate::ir::flat::{Assert, AssertionLevel};
use crate::ir::instance::Scope;

/// An assertion in a function that is checked at run time.
#[derive(Clone, Debug)]
pub(crate) struct Asserted {
    /// Must be true, unless one of `unless` is.
    pub(super) bare: ExprId,
    /// The conditions under which it is not reached, the outermost first.
    pub(super) unless: Vec<ExprId>,
    /// Must be true: both together.
    pub(crate) condition: ExprId,
    pub(crate) message: ExprId,
    pub(crate) level: AssertionLevel,
    pub(crate) span: Span,
}

impl Asserted {
    /// As a statement of a function that is called at run time; warnings are dropped there.
    pub(super) fn in_function(&self) -> Option<(Assert, Span)> {
        (self.level == AssertionLevel::Error).then(|| self.as_statement())
    }

    /// As a statement.
    pub(super) fn as_statement(&self) -> (Assert, Span) {
        let Asserted { condition, message, level, span, .. } = *self;
        (Assert { condition, message, level }, span)
    }
}

/// Assertions that are decided at run time.
#[derive(Default, Debug)]
pub struct Assertions {
    /// Those that no equation, when-clause or function has taken yet.
    pub(crate) pending: Vec<Asserted>,
    /// Conditions, known only at run time, under which the code being evaluated is active.
    pub(crate) conditions: Vec<ExprId>,
    /// `terminate` in the when-statement that is being executed: condition and message.
    pub(crate) terminations: Vec<(ExprId, ExprId)>,
}

/// The level that an `AssertionLevel` means.
pub(crate) fn level_of(level: Option<Const>) -> AssertionLevel {
    match level {
        Some(Const::Enumeration(_, 1)) => AssertionLevel::Warning,
        _ => AssertionLevel::Error,
    }
}

impl Evaluator<'_> {
    /// Evaluates something that counts only where `c` is true.
    pub(crate) fn under<T>(&mut self, c: ExprId, act: impl FnOnce(&mut Self) -> T) -> T {
        if self.graph.as_const(c) == Some(Const::Boolean(true)) {
            return act(self);
        }
        self.assertions.conditions.push(c);
        let result = act(self);
        self.assertions.conditions.pop();
        result
    }

    /// Evaluates something as if it stood under no condition.
    pub(super) fn unconditionally<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        let around = std::mem::take(&mut self.assertions.conditions);
        let result = act(self);
        self.assertions.conditions = around;
        result
    }

    /// True if the code being evaluated is never active.
    pub(super) fn is_unreached(&self) -> bool {
        let never = Some(Const::Boolean(false));
        self.assertions.conditions.iter().any(|c| self.graph.as_const(*c) == never)
    }

    /// `assert(condition, message, level)` in a function: decided here, or left to the run.
    pub(super) fn run_assert(
        &mut self,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<()> {
        let find = |k: usize, name: &str| argument(args, named, k, name);
        let both = (find(0, "condition"), find(1, "message"));
        let ((Some(condition), Some(message)), ..=3) = (both, args.len() + named.len()) else {
            self.report_arguments_of_assert(span);
            return None;
        };
        let value = self.evaluate(condition, scope)?;
        let condition = self.boolean_of(&value, condition.span)?;
        if self.graph.as_const(condition) == Some(Const::Boolean(true)) {
            return Some(());
        }
        let violated = self.graph.not(condition);
        let at = message.span;
        let message = self.under(violated, |cx| cx.evaluate_scalar(message, scope))?;
        if !self.is_message(message, at) {
            return None;
        }
        let level = find(2, "level").and_then(|l| self.evaluate_scalar(l, scope));
        let level = level.and_then(|l| self.graph.as_const(l));
        self.assert_now_or_later(condition, message, level_of(level), span)
    }

    /// Reports an assertion without a condition or a message, or with too many arguments.
    pub(crate) fn report_arguments_of_assert(&mut self, span: Span) {
        let takes = Takes::These("a condition, a message and perhaps a level");
        self.report(CallCause::WrongArguments { function: "assert".to_string(), takes }, span);
    }

    /// The message of `terminate(message)`.
    pub(crate) fn message_of_terminate(
        &mut self,
        args: &[Expr],
        named: &[(Ident, Expr)],
        span: Span,
        scope: Scope,
    ) -> Option<ExprId> {
        let message = argument(args, named, 0, "message");
        let (Some(message), 1) = (message, args.len() + named.len()) else {
            let takes = Takes::These("a message");
            let function = "terminate".to_string();
            self.report(CallCause::WrongArguments { function, takes }, span);
            return None;
        };
        let text = self.evaluate_scalar(message, scope)?;
        self.is_message(text, message.span).then_some(text)
    }

    /// Reports a message that is not a String.
    pub(crate) fn is_message(&mut self, text: ExprId, span: Span) -> bool {
        let is_string = self.graph.ty(text) == Type::String;
        if !is_string {
            self.report_type(Expected::Message, &Value::Scalar(text), span);
        }
        is_string
    }

    /// Reports an assertion that is false; leaves one that is not known yet to the run.
    pub(super) fn assert_now_or_later(
        &mut self,
        condition: ExprId,
        message: ExprId,
        level: AssertionLevel,
        span: Span,
    ) -> Option<()> {
        self.assert_unless(condition, Vec::new(), message, level, span)
    }

    /// As [`Evaluator::assert_now_or_later`], for an assertion that is not reached where one of these holds.
    pub(super) fn assert_unless(
        &mut self,
        bare: ExprId,
        inner: Vec<ExprId>,
        message: ExprId,
        level: AssertionLevel,
        span: Span,
    ) -> Option<()> {
        let condition = bare;
        let left = self.exits;
        let always = self.random_draws.place != Place::When;
        let surely_reached = self.assertions.conditions.is_empty() && left == Exits::default();
        let never = Some(Const::Boolean(false));
        let sure =
            always && surely_reached && inner.iter().all(|e| self.graph.as_const(*e) == never);
        if sure
            && level == AssertionLevel::Error
            && self.graph.as_const(condition) == Some(Const::Boolean(false))
        {
            let text = match self.graph.as_const(message) {
                Some(Const::String(t)) => t.to_string(),
                _ => "its message is known only at run time".to_string(),
            };
            self.report(CallCause::FunctionAssertion { message: text }, span);
            return None;
        }
        // Asked for its value before the model runs, a function is not yet called by the model.
        if self.mode.is_before_simulation() {
            return Some(());
        }
        let mut unless = Vec::new();
        for c in self.assertions.conditions.clone() {
            unless.push(self.graph.not(c));
        }
        unless.extend(left.all());
        unless.extend(inner);
        let condition = unless.iter().fold(bare, |all, off| self.graph.or(*off, all));
        if self.graph.as_const(condition) == Some(Const::Boolean(true)) {
            return Some(());
        }
        self.assertions.pending.push(Asserted { bare, unless, condition, message, level, span });
        Some(())
    }

    /// Runs something, and takes the assertions that it leaves to the run.
    pub(crate) fn collect_assertions<T>(
        &mut self,
        act: impl FnOnce(&mut Self) -> T,
    ) -> (T, Vec<Asserted>) {
        let before = self.assertions.pending.len();
        let result = act(self);
        (result, self.assertions.pending.split_off(before))
    }
}
