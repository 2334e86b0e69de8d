//! Expands the equations of components: loops are unrolled, `if` on parameters is decided, arrays
//! and records are split into scalars (Modelica 3.6, chapter 8).

use std::sync::Arc;

use super::cause::{ConnectPlace, FlattenCause, WhenEquationPlace};
use super::connect::Connections;
use super::connect::written::is_graph_call;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::classes::unsupported::Construct;
use crate::evaluate::Evaluator;
use crate::evaluate::assertion::{Asserted, level_of};
use crate::evaluate::builtin::argument;
use crate::evaluate::cause::array::Pair;
use crate::evaluate::cause::builtin::BuiltinCause;
use crate::evaluate::cause::call::CallCause;
use crate::evaluate::cause::types::{Expected, Pairing, TypeCause};
use crate::evaluate::implicit_ranges::Body;
use crate::evaluate::random_draw::Place;
use crate::evaluate::value::Value;
use crate::ir::ast::{self, Expr, ExprKind, Variability};
use crate::ir::expr::{Const, ExprId, Node, Type};
use crate::ir::flat::{Assert, AssertionLevel, Equation, EquationKind, FlatModel, Origin};
use crate::ir::instance::{InstanceId, Scope, SectionKind};

/// The destination of expanded equations, and their origin.
pub(super) struct Target<'f> {
    pub(super) flat: &'f mut FlatModel,
    pub(super) connections: &'f mut Connections,
    pub(super) component: Arc<str>,
    pub(super) initial: bool,
}

impl Target<'_> {
    pub(super) fn origin(&self, span: Span) -> Origin {
        Origin { span, component: self.component.clone() }
    }

    pub(super) fn push(&mut self, kind: EquationKind, span: Span) {
        let equation = Equation { kind, origin: self.origin(span) };
        self.list().push(equation);
    }

    /// The equations or the initial equations of the model.
    pub(super) fn list(&mut self) -> &mut Vec<Equation> {
        if self.initial { &mut self.flat.initial_equations } else { &mut self.flat.equations }
    }
}

/// Adds the equations of one component.
pub fn of_object(
    cx: &mut Evaluator<'_>,
    object: InstanceId,
    flat: &mut FlatModel,
    connections: &mut Connections,
) {
    let table = cx.table_of(object);
    if table.sections.is_empty() {
        return;
    }
    let component: Arc<str> = cx.path(object).into();
    for section in &table.sections {
        let scope = Scope { instance: object, class: section.class };
        let mut target =
            Target { flat, connections, component: component.clone(), initial: section.initial };
        let place = if section.initial { Place::Start } else { Place::Always };
        cx.in_place(place, |cx| match &section.kind {
            SectionKind::Equations(list) => expand_all(cx, list, scope, &mut target),
            SectionKind::Algorithm(list, span) => {
                super::algorithm::expand(cx, list, *span, scope, &mut target)
            }
        });
        asserted(cx, &mut target);
    }
}

pub(super) fn expand_all(
    cx: &mut Evaluator<'_>,
    list: &[ast::Equation],
    scope: Scope,
    target: &mut Target<'_>,
) {
    for e in list {
        let (done, unitless) = cx.with_unitless_literals(|cx| expand(cx, e, scope, target));
        // An equation is never left out without a word.
        if done.is_none() && !cx.problems.has_errors() {
            cx.unsupported(e.span, Construct::ThisEquation);
        }
        if unitless {
            target.flat.unitless_literals.insert(e.span);
        }
        asserted(cx, target);
    }
}

/// Adds the assertions of the functions that were called.
pub(super) fn asserted(cx: &mut Evaluator<'_>, target: &mut Target<'_>) {
    for a in std::mem::take(&mut cx.assertions.pending) {
        let Asserted { condition, message, level, span, .. } = a;
        target.push(EquationKind::Assert(Assert { condition, message, level }), span);
    }
}

/// Expands one equation; `None` after an error, which does not affect the others.
fn expand(
    cx: &mut Evaluator<'_>,
    e: &ast::Equation,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    match &e.kind {
        ast::EquationKind::Equal(lhs, rhs) => equal(cx, lhs, rhs, e.span, scope, target),
        ast::EquationKind::If { branches, otherwise } => {
            super::if_equation::expand(cx, branches, otherwise, e.span, scope, target)
        }
        ast::EquationKind::For { iterators, body } => {
            let iterators = cx.with_ranges(iterators, Body::Equations(body), scope)?;
            for_each(cx, &iterators, scope, &mut |cx| expand_all(cx, body, scope, target))
        }
        ast::EquationKind::When { branches } => {
            if target.initial {
                let inside = WhenEquationPlace::Initial;
                cx.report(FlattenCause::MisplacedWhen { inside }, e.span);
                return None;
            }
            if let Some(done) = super::clocked::when(cx, branches, e.span, scope, target) {
                return done;
            }
            let branches = cx.in_when(|cx| super::when::branches(cx, branches, scope))?;
            target.push(EquationKind::When(branches), e.span);
            Some(())
        }
        ast::EquationKind::Connect(a, b) => {
            if !cx.assertions.conditions.is_empty() {
                let inside = ConnectPlace::VaryingIf;
                cx.report(FlattenCause::MisplacedConnect { inside }, e.span);
                return None;
            }
            target.connections.connect(cx, a, b, e.span, scope, &target.component)
        }
        ast::EquationKind::Call(call) => call_equation(cx, call, scope, target),
        ast::EquationKind::Broken => None,
    }
}

/// Runs `body` for every combination of iterators, which are visible as names.
pub(super) fn for_each(
    cx: &mut Evaluator<'_>,
    iterators: &[ast::Iterator],
    scope: Scope,
    body: &mut dyn FnMut(&mut Evaluator<'_>),
) -> Option<()> {
    let Some((first, rest)) = iterators.split_first() else {
        body(cx);
        return Some(());
    };
    for value in cx.fold_range(first, scope)? {
        cx.with_local(first.name.name, value, |cx| for_each(cx, rest, scope, body))?;
    }
    Some(())
}

fn equal(
    cx: &mut Evaluator<'_>,
    lhs: &Expr,
    rhs: &Expr,
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    if let ExprKind::Tuple(items) = &lhs.kind {
        let Value::Tuple(values) = cx.evaluate_outputs(rhs, scope)? else {
            cx.report(CallCause::NotSeveralOutputs, rhs.span);
            return None;
        };
        if items.len() > values.len() {
            let (wanted, given) = (items.len(), values.len());
            cx.report(CallCause::TooFewOutputs { wanted, given }, span);
            return None;
        }
        for (item, value) in items.iter().zip(values.iter()) {
            if let Some(item) = item {
                let left = cx.evaluate(item, scope)?;
                let value = cx.with_own_events(value);
                equate(cx, &left, &value, span, target)?;
            }
        }
        return Some(());
    }
    let (left, right) = (cx.evaluate(lhs, scope), cx.evaluate(rhs, scope));
    let (left, right) = (left?, right?);
    let is_record = matches!((&left, &right), (Value::Record(_), Value::Record(_)));
    let right = if is_record && !target.initial { cx.with_own_events(&right) } else { right };
    equate(cx, &left, &right, span, target)
}

fn equate(
    cx: &mut Evaluator<'_>,
    left: &Value,
    right: &Value,
    span: Span,
    target: &mut Target<'_>,
) -> Option<()> {
    match (left, right) {
        (Value::Scalar(a), Value::Scalar(b)) => {
            let (s, t) = (cx.graph.ty(*a), cx.graph.ty(*b));
            let kind = |t| if t == Type::Integer { Type::Real } else { t };
            if kind(s) != kind(t) {
                cx.report_types(span, Pairing::Equal, s, t);
                return None;
            }
            if gives_integer_fraction(cx, *a, *b, target.initial) {
                let expected = Expected::Assigned { ty: "Integer".to_string() };
                let found = "Real".to_string();
                cx.report(TypeCause::WrongType { expected, found }, span);
                return None;
            }
            let discrete = |t: Type| !matches!(t, Type::Real | Type::String | Type::Clock);
            // Initial equations hold at a single instant, so continuity does not matter.
            if discrete(s) && discrete(t) && !target.initial {
                cx.check_seen(s, *a, span)?;
                cx.check_seen(s, *b, span)?;
            }
            let (a, b) = (real_literal(cx, *a, t), real_literal(cx, *b, s));
            target.push(EquationKind::Equal(a, b), span);
            Some(())
        }
        (Value::Array(_), Value::Array(_)) => {
            if left.dims() != right.dims() {
                cx.report_sizes(Pair::Sides, left, right, span);
                return None;
            }
            for (a, b) in left.elements().iter().zip(right.elements()) {
                equate(cx, a, b, span, target)?;
            }
            Some(())
        }
        (Value::Record(r), Value::Record(s)) => {
            for (name, a) in &r.fields {
                match s.fields.iter().find(|(n, _)| n == name) {
                    Some((_, b)) => {
                        let [a, b] = [a, b].map(|field| cx.with_own_events(field));
                        equate(cx, &a, &b, span, target)?;
                    }
                    None => {
                        cx.report(TypeCause::MissingField { name: *name }, span);
                        return None;
                    }
                }
            }
            Some(())
        }
        _ => {
            cx.report_sizes(Pair::Sides, left, right, span);
            None
        }
    }
}

/// Whether an equation gives an Integer variable the value of a Real expression: that holds no
/// unknown of type Real, which the equation could determine instead.
fn gives_integer_fraction(cx: &Evaluator<'_>, a: ExprId, b: ExprId, initial: bool) -> bool {
    let unknown = |n: ExprId| match cx.graph.node(n) {
        Node::Var(_) => {
            let variability = cx.variability(n);
            variability > Variability::Parameter || initial && variability == Variability::Parameter
        }
        Node::Der(_) => true,
        _ => false,
    };
    let gives = |variable: ExprId, value: ExprId| {
        let is_integer = matches!(cx.graph.node(variable), Node::Var(_))
            && cx.graph.ty(variable) == Type::Integer
            && unknown(variable);
        let is_real = |n: &ExprId| cx.graph.ty(*n) == Type::Real;
        is_integer
            && is_real(&value)
            && !cx.graph.postorder([value]).iter().any(|n| is_real(n) && unknown(*n))
    };
    gives(a, b) || gives(b, a)
}

fn real_literal(cx: &mut Evaluator<'_>, e: ExprId, other: Type) -> ExprId {
    match cx.graph.as_const(e) {
        Some(Const::Integer(i)) if other == Type::Real => cx.graph.real(i as f64),
        _ => e,
    }
}

fn call_equation(
    cx: &mut Evaluator<'_>,
    call: &Expr,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    let ExprKind::Call { function, args, named } = &call.kind else {
        cx.report(FlattenCause::NotAnEquation, call.span);
        return None;
    };
    let simple = function.simple();
    match simple.as_ref().map(|n| n.as_str()) {
        Some("assert") => {
            let assert = assertion(cx, args, named, call.span, scope)?;
            if cx.graph.as_const(assert.condition) == Some(Const::Boolean(true)) {
                return Some(());
            }
            // In a branch that may not be taken, it is left to the run.
            if cx.assertions.conditions.is_empty()
                && let Some(Const::Boolean(false)) = cx.structural_value(assert.condition)
                && assert.level == AssertionLevel::Error
            {
                let text = match cx.graph.as_const(assert.message) {
                    Some(Const::String(s)) => s.to_string(),
                    _ => "its message is known only at run time".into(),
                };
                cx.problems.push(
                    Diagnostic::new(FlattenCause::Assertion { message: text }, call.span)
                        .label("false for these parameters"),
                );
                return None;
            }
            target.push(EquationKind::Assert(assert), call.span);
            Some(())
        }
        Some("reinit") => {
            cx.report(BuiltinCause::ReinitOutsideWhen, call.span);
            None
        }
        Some("terminate") => {
            cx.report(BuiltinCause::TerminateOutsideWhen, call.span);
            None
        }
        Some("transition") => super::clocked::transition(cx, args, named, call.span, scope, target),
        Some("initialState") => super::clocked::initial_state(cx, args, call.span, scope, target),
        // The connection graph has already read it.
        _ if is_graph_call(call) => Some(()),
        _ => cx.call_alone(call, scope),
    }
}

/// `assert(condition, message, level)`
pub(super) fn assertion(
    cx: &mut Evaluator<'_>,
    args: &[Expr],
    named: &[(ast::Ident, Expr)],
    span: Span,
    scope: Scope,
) -> Option<Assert> {
    let find = |k: usize, name: &str| argument(args, named, k, name);
    let both = (find(0, "condition"), find(1, "message"));
    let ((Some(condition), Some(message)), ..=3) = (both, args.len() + named.len()) else {
        cx.report_arguments_of_assert(span);
        return None;
    };
    let c = cx.evaluate(condition, scope)?;
    let c = cx.boolean_of(&c, condition.span)?;
    if cx.graph.as_const(c) == Some(Const::Boolean(true)) {
        // The message of an assertion that always holds is not evaluated.
        let empty = cx.graph.string("");
        return Some(Assert { condition: c, message: empty, level: AssertionLevel::Error });
    }
    let violated = cx.graph.not(c);
    let text = cx.under(violated, |cx| cx.evaluate_scalar(message, scope))?;
    if !cx.is_message(text, message.span) {
        return None;
    }
    let level = match find(2, "level") {
        Some(level) => {
            let value = cx.fold(level, scope)?.scalar()?;
            level_of(cx.graph.as_const(value))
        }
        None => AssertionLevel::Error,
    };
    Some(Assert { condition: c, message: text, level })
}
