//! Clocked when-clauses, and the states and transitions of state machines (Modelica 3.6, section 16.6 and
//! chapter 17).

use super::cause::{FlattenCause, WhenEquationPlace};
use super::equation::{Target, expand_all};
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::builtin::argument;
use crate::evaluate::cause::builtin::BuiltinCause;
use crate::evaluate::demand::Demand;
use crate::ir::ast::{self, Expr};
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{Assert, EquationKind, Transition};
use crate::ir::instance::{InstanceKind, Scope};

/// The equations of a when-clause whose condition is a clock, as equations with this clock; `None` if its
/// condition is not a clock.
pub(super) fn when(
    cx: &mut Evaluator<'_>,
    branches: &[(Expr, Vec<ast::Equation>)],
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<Option<()>> {
    let [(condition, body), rest @ ..] = branches else { return None };
    // Only a call or a name can be a clock, and most conditions are relations.
    if !matches!(condition.kind, ast::ExprKind::Call { .. } | ast::ExprKind::Ref(_)) {
        return None;
    }
    let pending = cx.assertions.pending.len();
    let Some(clock) = cx.evaluate(condition, scope)?.scalar() else {
        cx.assertions.pending.truncate(pending);
        return None;
    };
    if cx.graph.ty(clock) != Type::Clock {
        cx.assertions.pending.truncate(pending);
        return None;
    }
    if let Some((_, other)) = rest.first() {
        let inside = WhenEquationPlace::When;
        let place = other.first().map_or(span, |e| e.span);
        cx.report(FlattenCause::MisplacedWhen { inside }, place);
        return Some(None);
    }
    let before = target.list().len();
    expand_all(cx, body, scope, target);
    let added = target.list().split_off(before);
    // An inferred clock has no name by which the equations could belong to the same partition.
    let link = added.iter().find_map(|equation| assigned(cx, target, &equation.kind));
    let clock: Vec<ExprId> = [clock].into_iter().chain(link).collect();
    for mut equation in added {
        match &mut equation.kind {
            EquationKind::Equal(_, value)
            | EquationKind::Assert(Assert { condition: value, .. }) => {
                *value = at(cx, *value, &clock);
            }
            EquationKind::Algorithm { values, .. } => {
                for value in values {
                    *value = at(cx, *value, &clock);
                }
            }
            EquationKind::When(_) => {
                let inside = WhenEquationPlace::When;
                cx.report(FlattenCause::MisplacedWhen { inside }, equation.origin.span);
                return Some(None);
            }
        }
        target.list().push(equation);
    }
    Some(Some(()))
}

/// The first variable that an equation of a when-clause gives a value.
fn assigned(
    cx: &mut Evaluator<'_>,
    target: &Target<'_>,
    equation: &EquationKind,
) -> Option<ExprId> {
    match equation {
        EquationKind::Equal(lhs, _) => matches!(cx.graph.node(*lhs), Node::Var(_)).then_some(*lhs),
        EquationKind::Algorithm { outputs, .. } => {
            let v = *outputs.first()?;
            let ty = target.flat.variables[v].ty;
            Some(cx.graph.var(v, ty))
        }
        EquationKind::Assert(_) | EquationKind::When(_) => None,
    }
}

fn at(cx: &mut Evaluator<'_>, value: ExprId, clock: &[ExprId]) -> ExprId {
    let ty = cx.graph.ty(value);
    if ty == Type::Clock {
        return value;
    }
    let operands: Vec<ExprId> = [value].into_iter().chain(clock.iter().copied()).collect();
    cx.graph.clocked(ClockOperator::At, &operands, ty)
}

/// `initialState(state)`
pub(super) fn initial_state(
    cx: &mut Evaluator<'_>,
    args: &[Expr],
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    let state = match args {
        [state] => cx.state(state, scope),
        _ => None,
    };
    let Some(state) = state else {
        cx.report(BuiltinCause::NotAState, span);
        return None;
    };
    target.flat.initial_states.push((cx.path(state).into(), span));
    Some(())
}

/// `transition(from, to, condition, immediate, reset, synchronize, priority)`
pub(super) fn transition(
    cx: &mut Evaluator<'_>,
    args: &[Expr],
    named: &[(ast::Ident, Expr)],
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    let find = |k: usize, name: &str| argument(args, named, k, name);
    let ends = [find(0, "from"), find(1, "to")].map(|end| cx.state(end?, scope));
    let ([Some(from), Some(to)], Some(condition)) = (ends, find(2, "condition")) else {
        cx.report(BuiltinCause::NotAState, span);
        return None;
    };
    let value = cx.evaluate(condition, scope)?;
    let value = cx.boolean_of(&value, condition.span)?;
    let mut flags = [true, true, false];
    for (k, name) in ["immediate", "reset", "synchronize"].into_iter().enumerate() {
        if let Some(flag) = find(3 + k, name) {
            flags[k] = cx.fold_boolean(flag, scope)?;
        }
    }
    let priority = match find(6, "priority") {
        Some(priority) => {
            let value = cx.fold(priority, scope)?.scalar()?;
            match cx.graph.as_const(value) {
                Some(Const::Integer(n)) => n,
                _ => 1,
            }
        }
        None => 1,
    };
    let [immediate, reset, synchronize] = flags;
    target.flat.transitions.push(Transition {
        from: cx.path(from).into(),
        to: cx.path(to).into(),
        condition: value,
        immediate,
        reset,
        synchronize,
        priority,
        origin: target.origin(span),
    });
    Some(())
}

/// The variables that are `inner outer`, each with the outer one.
pub(super) fn inner_outer(cx: &mut Evaluator<'_>) -> Vec<(VarId, VarId)> {
    let mut found = Vec::new();
    for v in 0..cx.instance_of.len() {
        let (id, k) = cx.instance_of[v];
        let declaration = cx.instances[id].declaration.as_ref();
        if !declaration.is_some_and(|d| d.element.inner && d.element.outer) {
            continue;
        }
        let outer = cx.outer_of(id);
        if let InstanceKind::Variable { first: Some(first), .. } = cx.instances[outer].kind
            && outer != id
        {
            found.push((VarId(v as u32), VarId(first.0 + k as u32)));
        }
    }
    found
}
