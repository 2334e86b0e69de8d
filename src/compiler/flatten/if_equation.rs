//! If-equations: decided by parameters, or merged branch by branch (Modelica 3.6, section 8.3.4).

use super::cause::{FlattenCause, WhenEquationPlace};
use super::connect::written::connects;
use super::equation::{Target, expand_all};
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::ir::ast::{self, Expr};
use crate::ir::expr::{Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{Assert, Equation, EquationKind};
use crate::ir::instance::Scope;

/// Expands an if-equation: the branch that parameters select, or all branches merged.
pub(super) fn expand(
    cx: &mut Evaluator<'_>,
    branches: &[(Expr, Vec<ast::Equation>)],
    otherwise: &[ast::Equation],
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    // Whether a branch from each one on connects: connections are part of the structure, and so are the conditions they
    // depend on.
    let mut connecting = vec![connects(otherwise)];
    for (_, body) in branches.iter().rev() {
        let last = connecting.last().copied().unwrap_or(false);
        connecting.push(last || connects(body));
    }
    connecting.reverse();
    let cases = Cases { branches, connecting: &connecting, otherwise, span };
    from(cx, cases, scope, target)
}

/// The branches of an if-equation from one on.
#[derive(Clone, Copy)]
struct Cases<'a> {
    branches: &'a [(Expr, Vec<ast::Equation>)],
    connecting: &'a [bool],
    otherwise: &'a [ast::Equation],
    span: Span,
}

fn from(
    cx: &mut Evaluator<'_>,
    cases: Cases<'_>,
    scope: Scope,
    target: &mut Target<'_>,
) -> Option<()> {
    let Cases { branches, connecting, otherwise, span } = cases;
    let Some(((condition, body), rest)) = branches.split_first() else {
        expand_all(cx, otherwise, scope, target);
        return Some(());
    };
    let others = Cases { branches: rest, connecting: &connecting[1..], ..cases };
    let c = cx.evaluate(condition, scope)?;
    let c = cx.boolean_of(&c, condition.span)?;
    match cx.parameter_expression(c, connecting[0]) {
        Some(Const::Boolean(true)) => {
            expand_all(cx, body, scope, target);
            return Some(());
        }
        Some(Const::Boolean(false)) => {
            return from(cx, others, scope, target);
        }
        _ => {}
    }
    let not_c = cx.graph.not(c);
    let first = collected(target, |t| cx.under(c, |cx| expand_all(cx, body, scope, t)));
    let mut done = None;
    let second = collected(target, |t| {
        done = cx.under(not_c, |cx| from(cx, others, scope, t));
    });
    done?;
    // If the branches relate different unknowns, the condition is part of the structure as soon as
    // its parameters have values (an example is `v = 0` for `R = 0`).
    let is_known = cx.variability(c) <= ast::Variability::Parameter;
    if is_known
        && unknowns(cx, &first) != unknowns(cx, &second)
        && let Some(Const::Boolean(chosen)) = cx.parameter_expression(c, true)
    {
        target.list().extend(if chosen { first } else { second });
        return Some(());
    }
    // If a branch has to be chosen, a parameter without a value decides by its start value.
    if is_known && count(&first) != count(&second) {
        let known = cx.fold(condition, scope)?;
        let known = cx.boolean_of(&known, condition.span)?;
        if let Some(Const::Boolean(chosen)) = cx.graph.as_const(known) {
            target.list().extend(if chosen { first } else { second });
            return Some(());
        }
    }
    merge(cx, c, first, second, span, target)
}

/// Number of equations, without assertions.
fn count(list: &[Equation]) -> usize {
    list.iter().filter(|e| matches!(e.kind, EquationKind::Equal(..))).count()
}

/// The variables, except parameters, and the derivatives that occur in equations, in order.
fn unknowns(cx: &mut Evaluator<'_>, equations: &[Equation]) -> Vec<(VarId, bool)> {
    let sides = equations.iter().filter_map(|e| match e.kind {
        EquationKind::Equal(a, b) => Some([a, b]),
        _ => None,
    });
    let nodes = cx.graph.postorder(sides.flatten());
    let mut found = Vec::new();
    for n in nodes {
        match cx.graph.node(n) {
            Node::Var(v) if cx.variability(n) > ast::Variability::Parameter => {
                found.push((v, false));
            }
            Node::Der(v) => found.push((v, true)),
            _ => {}
        }
    }
    found.sort_unstable();
    found
}

/// Removes and returns the equations that `act` adds.
fn collected(target: &mut Target<'_>, act: impl FnOnce(&mut Target<'_>)) -> Vec<Equation> {
    let before = target.list().len();
    act(target);
    target.list().split_off(before)
}

/// Merges branches equation by equation into `if c then first else second` (Modelica 3.6, section
/// 8.3.4).
fn merge(
    cx: &mut Evaluator<'_>,
    c: ExprId,
    first: Vec<Equation>,
    second: Vec<Equation>,
    span: Span,
    target: &mut Target<'_>,
) -> Option<()> {
    let not_c = cx.graph.not(c);
    let mut sides = [Vec::new(), Vec::new()];
    for (k, (list, applies)) in [(first, c), (second, not_c)].into_iter().enumerate() {
        for e in list {
            match e.kind {
                EquationKind::Equal(a, b) => sides[k].push((a, b, e.origin)),
                EquationKind::Assert(a) => {
                    let off = cx.graph.not(applies);
                    let condition = cx.graph.or(off, a.condition);
                    let kind = EquationKind::Assert(Assert { condition, ..a });
                    target.push(kind, e.origin.span);
                }
                EquationKind::When(_) | EquationKind::Algorithm { .. } => {
                    let inside = WhenEquationPlace::VaryingIf;
                    cx.report(FlattenCause::MisplacedWhen { inside }, e.origin.span);
                    return None;
                }
            }
        }
    }
    let [first, mut second] = sides;
    // Equations that define the same variables may come in any order.
    for k in 0..first.len().min(second.len()) {
        let same = |(a, ..): &(ExprId, ExprId, _)| *a == first[k].0;
        if let Some(at) = second[k..].iter().position(same) {
            second.swap(k, k + at);
        }
    }
    if first.len() != second.len() {
        let (first, second) = (first.len(), second.len());
        cx.report(FlattenCause::BranchCount { first, second }, span);
        return None;
    }
    for ((a, b, origin), (a2, b2, _)) in first.into_iter().zip(second) {
        let kind = if a == a2 {
            let merged = cx.graph.if_then_else(c, b, b2);
            if !target.initial {
                cx.check_seen(cx.graph.ty(a), merged, origin.span)?;
            }
            EquationKind::Equal(a, merged)
        } else if cx.graph.ty(a) == Type::Real || cx.graph.ty(b) == Type::Real {
            let (r, r2) = (cx.graph.sub(a, b), cx.graph.sub(a2, b2));
            let zero = cx.graph.real(0.0);
            EquationKind::Equal(zero, cx.graph.if_then_else(c, r, r2))
        } else {
            cx.report(FlattenCause::DifferentDiscrete, origin.span);
            return None;
        };
        target.push(kind, origin.span);
    }
    Some(())
}
