//! Expands when-clauses into conditions and actions (Modelica 3.6, section 8.3.5).

use std::collections::BTreeSet;

use super::cause::{ConnectPlace, FlattenCause, WhenEquationPlace};
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::assertion::Asserted;
use crate::evaluate::cause::array::Pair;
use crate::evaluate::cause::builtin::BuiltinCause;
use crate::evaluate::cause::call::{CallCause, Takes};
use crate::evaluate::cause::types::{Conversion, Pairing, TypeCause};
use crate::evaluate::value::Value;
use crate::ir::ast::{self, Expr, ExprKind, StatementKind};
use crate::ir::expr::{Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{Action, Assert, WhenBranch};
use crate::ir::instance::Scope;

/// The branches of a when-equation.
pub(super) fn branches(
    cx: &mut Evaluator<'_>,
    list: &[(Expr, Vec<ast::Equation>)],
    scope: Scope,
) -> Option<Vec<WhenBranch>> {
    let mut out: Vec<WhenBranch> = Vec::with_capacity(list.len());
    let mut left_sides: Option<BTreeSet<VarId>> = None;
    for (condition, body) in list {
        let conditions = conditions(cx, condition, scope)?;
        let mut actions = Vec::new();
        let (done, asserts) = cx.collect_assertions(|cx| {
            body.iter().try_for_each(|e| action(cx, e, scope, &mut actions))
        });
        done?;
        let own = WhenBranch::assigned(&actions);
        let first = left_sides.get_or_insert_with(|| own.clone());
        let mut others = first.symmetric_difference(&own);
        if let Some((id, _)) = others.find_map(|v| cx.instance_of.get(v.0 as usize).copied()) {
            let name = cx.path(id);
            cx.report(FlattenCause::OtherLeftSides { name }, condition.span);
            return None;
        }
        add_asserts(asserts, &mut actions);
        actions.extend(cx.leave_branch().map(|(v, e)| Action::Assign(v, e)));
        out.push(WhenBranch { conditions, actions });
    }
    Some(out)
}

/// The scalar conditions of a branch: one, or the elements of a vector.
fn conditions(cx: &mut Evaluator<'_>, e: &Expr, scope: Scope) -> Option<Vec<ExprId>> {
    let value = cx.evaluate(e, scope)?;
    let list: Option<Vec<ExprId>> =
        value.elements().iter().map(|v| cx.boolean_of(v, e.span)).collect();
    for condition in list.iter().flatten() {
        cx.check_seen(Type::Boolean, *condition, e.span)?;
    }
    list
}

fn action(
    cx: &mut Evaluator<'_>,
    e: &ast::Equation,
    scope: Scope,
    out: &mut Vec<Action>,
) -> Option<()> {
    match &e.kind {
        ast::EquationKind::Equal(lhs, rhs) => equal(cx, lhs, rhs, e.span, scope, out),
        ast::EquationKind::If { branches, otherwise } => {
            if_actions(cx, branches, otherwise, scope, out)
        }
        ast::EquationKind::For { iterators, body } => {
            let mut done = Some(());
            let body_of = crate::evaluate::implicit_ranges::Body::Equations(body);
            let iterators = cx.with_ranges(iterators, body_of, scope)?;
            super::equation::for_each(cx, &iterators, scope, &mut |cx| {
                for e in body {
                    if done.is_some() {
                        done = action(cx, e, scope, out);
                    }
                }
            })?;
            done
        }
        ast::EquationKind::Call(call) => call_action(cx, call, scope, out),
        ast::EquationKind::When { .. } => {
            cx.report(FlattenCause::MisplacedWhen { inside: WhenEquationPlace::When }, e.span);
            None
        }
        ast::EquationKind::Connect(..) => {
            cx.report(FlattenCause::MisplacedConnect { inside: ConnectPlace::When }, e.span);
            None
        }
        ast::EquationKind::Broken => None,
    }
}

fn equal(
    cx: &mut Evaluator<'_>,
    lhs: &Expr,
    rhs: &Expr,
    span: Span,
    scope: Scope,
    out: &mut Vec<Action>,
) -> Option<()> {
    for target in targets(lhs) {
        check_target(cx, target, scope);
    }
    if let ExprKind::Tuple(items) = &lhs.kind {
        let Value::Tuple(values) = cx.evaluate_outputs(rhs, scope)? else {
            cx.report(CallCause::NotSeveralOutputs, rhs.span);
            return None;
        };
        for (item, value) in items.iter().zip(values.iter()) {
            if let Some(item) = item {
                let left = cx.evaluate(item, scope)?;
                assign(cx, &left, value, span, out)?;
            }
        }
        return Some(());
    }
    let right = cx.evaluate(rhs, scope)?;
    let left = cx.evaluate(lhs, scope)?;
    assign(cx, &left, &right, span, out)
}

/// The variables on a left-hand side.
fn targets(lhs: &Expr) -> Vec<&ast::ComponentRef> {
    match &lhs.kind {
        ExprKind::Ref(r) => vec![r],
        ExprKind::Tuple(items) => items.iter().flatten().flat_map(targets).collect(),
        _ => Vec::new(),
    }
}

/// Checks that a when-clause only determines variables of its own class; otherwise a component
/// would have one more equation than its class shows (Modelica 3.6, section 4.7).
fn check_target(cx: &mut Evaluator<'_>, target: &ast::ComponentRef, scope: Scope) {
    let [first, .., last] = target.parts.as_slice() else { return };
    let Some(mut at) = cx.child(scope.instance, first.name.name) else { return };
    cx.complete(at);
    if let crate::ir::instance::InstanceKind::Array { elements, .. } = &cx.instances[at].kind {
        let Some(element) = elements.first() else { return };
        at = *element;
    }
    let Some(class) = cx.instances[at].class else { return };
    if matches!(cx.kind(class), ast::ClassKind::Model | ast::ClassKind::Block) {
        let (variable, component) = (last.name.name, first.name.name);
        cx.problems.push(
            Diagnostic::new(FlattenCause::ForeignVariable { variable, component }, target.span)
                .label("belongs to another component"),
        );
    }
}

/// Adds the assertions met in a clause to its actions.
fn add_asserts(asserts: Vec<Asserted>, out: &mut Vec<Action>) {
    for p in asserts {
        let Asserted { condition, message, level, .. } = p;
        out.push(Action::Assert(Assert { condition, message, level }));
    }
}

fn assign(
    cx: &mut Evaluator<'_>,
    left: &Value,
    right: &Value,
    span: Span,
    out: &mut Vec<Action>,
) -> Option<()> {
    if left.dims() != right.dims() {
        cx.report_sizes(Pair::Sides, left, right, span);
        return None;
    }
    let pattern = cx.pattern_of_value(left);
    let right = cx.fitted(&pattern, &[], right.clone(), span)?;
    assign_fitted(cx, left, &right, span, out)
}

/// As [`assign`], of a value with the sizes of the variable and the order of its fields.
fn assign_fitted(
    cx: &mut Evaluator<'_>,
    left: &Value,
    right: &Value,
    span: Span,
    out: &mut Vec<Action>,
) -> Option<()> {
    for (a, b) in left.elements().iter().zip(right.elements()) {
        match (a, b) {
            (Value::Record(r), Value::Record(s)) => {
                for ((_, x), (_, y)) in r.fields.iter().zip(&s.fields) {
                    assign_fitted(cx, x, y, span, out)?;
                }
            }
            _ => {
                let (Some(a), Some(b)) = (a.scalar(), b.scalar()) else {
                    let (left, right) = (cx.described(a), cx.described(b));
                    let (as_, by) = (Pairing::Equal, Conversion::None);
                    cx.report(TypeCause::IncompatibleTypes { left, right, as_, by }, span);
                    return None;
                };
                let Node::Var(v) = cx.graph.node(a) else {
                    cx.report(FlattenCause::LeftSideInWhen, span);
                    return None;
                };
                out.push(Action::Assign(v, b));
            }
        }
    }
    Some(())
}

fn call_action(
    cx: &mut Evaluator<'_>,
    call: &Expr,
    scope: Scope,
    out: &mut Vec<Action>,
) -> Option<()> {
    let ExprKind::Call { function, args, named } = &call.kind else {
        cx.report(FlattenCause::NotAnEquation, call.span);
        return None;
    };
    match function.simple().as_ref().map(|n| n.as_str()) {
        Some("reinit") => {
            let [state, value] = args.as_slice() else {
                let takes = Takes::These("a state and its new value");
                let function = "reinit".to_string();
                cx.report(CallCause::WrongArguments { function, takes }, call.span);
                return None;
            };
            let (x, e) = (cx.evaluate(state, scope)?, cx.evaluate(value, scope)?);
            if x.dims() != e.dims() {
                cx.report_sizes(Pair::StateAndValue, &x, &e, call.span);
                return None;
            }
            let pattern = cx.pattern_of_value(&x);
            let e = cx.fitted(&pattern, &[], e, value.span)?;
            for (a, b) in x.elements().iter().zip(e.elements()) {
                let (a, b) = (a.scalar()?, b.scalar()?);
                let Node::Var(v) = cx.graph.node(a) else {
                    cx.report(FlattenCause::ReinitTarget, state.span);
                    return None;
                };
                out.push(Action::Reinit { state: v, value: b, guard: None });
            }
            Some(())
        }
        Some("assert") => {
            let assert = super::equation::assertion(cx, args, named, call.span, scope)?;
            out.push(Action::Assert(assert));
            Some(())
        }
        Some("terminate") => {
            let message = cx.message_of_terminate(args, named, call.span, scope)?;
            out.push(Action::Terminate { message, guard: None });
            Some(())
        }
        _ => cx.call_alone(call, scope),
    }
}

/// `if` inside a when-clause: assignments are merged variable by variable; in a branch that does
/// not assign a variable, it keeps its `pre` value.
fn if_actions(
    cx: &mut Evaluator<'_>,
    branches: &[(Expr, Vec<ast::Equation>)],
    otherwise: &[ast::Equation],
    scope: Scope,
    out: &mut Vec<Action>,
) -> Option<()> {
    let Some(((condition, body), rest)) = branches.split_first() else {
        for e in otherwise {
            action(cx, e, scope, out)?;
        }
        return Some(());
    };
    let c = cx.evaluate(condition, scope)?;
    let c = cx.boolean_of(&c, condition.span)?;
    let actions_of_body = |cx: &mut Evaluator<'_>, out: &mut Vec<Action>| {
        body.iter().try_for_each(|e| action(cx, e, scope, out))
    };
    match cx.structural_value(c) {
        Some(Const::Boolean(false)) => return if_actions(cx, rest, otherwise, scope, out),
        Some(Const::Boolean(true)) => return actions_of_body(cx, out),
        _ => {}
    }
    let (mut first, mut second) = (Vec::new(), Vec::new());
    cx.under(c, |cx| actions_of_body(cx, &mut first))?;
    let not_c = cx.graph.not(c);
    cx.under(not_c, |cx| if_actions(cx, rest, otherwise, scope, &mut second))?;
    merge_branches(cx, c, first, second, out);
    Some(())
}

/// Merges the actions of two branches into `if c then first else second`.
pub(super) fn merge_branches(
    cx: &mut Evaluator<'_>,
    c: ExprId,
    first: Vec<Action>,
    second: Vec<Action>,
    out: &mut Vec<Action>,
) {
    let not_c = cx.graph.not(c);
    let mut assigned: Vec<(VarId, Option<ExprId>, Option<ExprId>)> = Vec::new();
    for (k, (list, applies)) in [(first, c), (second, not_c)].into_iter().enumerate() {
        for a in list {
            match a {
                Action::Assign(v, e) => {
                    let at = match assigned.iter().position(|(w, ..)| *w == v) {
                        Some(at) => at,
                        None => {
                            assigned.push((v, None, None));
                            assigned.len() - 1
                        }
                    };
                    let slot = &mut assigned[at];
                    *(if k == 0 { &mut slot.1 } else { &mut slot.2 }) = Some(e);
                }
                Action::Reinit { state, value, guard } => {
                    let guard = Some(guard.map_or(applies, |g| cx.graph.and(applies, g)));
                    out.push(Action::Reinit { state, value, guard });
                }
                Action::Terminate { message, guard } => {
                    let guard = Some(guard.map_or(applies, |g| cx.graph.and(applies, g)));
                    out.push(Action::Terminate { message, guard });
                }
                Action::Assert(mut a) => {
                    let off = cx.graph.not(applies);
                    a.condition = cx.graph.or(off, a.condition);
                    out.push(Action::Assert(a));
                }
            }
        }
    }
    for (v, a, b) in assigned {
        let ty = a.or(b).map_or(Type::Real, |e| cx.graph.ty(e));
        let before = cx.graph.pre(v, ty);
        let e = cx.graph.if_then_else(c, a.unwrap_or(before), b.unwrap_or(before));
        out.push(Action::Assign(v, e));
    }
}

/// A branch of a when-statement that was executed.
pub(super) struct Executed {
    /// Its conditions, any of which activates it.
    pub(super) conditions: Vec<ExprId>,
    /// Its actions other than assignments of the section's variables.
    pub(super) actions: Vec<Action>,
    /// The variables that it assigns, with their values at its end.
    pub(super) values: Vec<(VarId, ExprId)>,
}

/// Executes the branches of a when-statement of an algorithm, each from the values before the
/// statement. `targets` are the variables that each of them assigns.
pub(super) fn statement_branches(
    cx: &mut Evaluator<'_>,
    list: &[(Expr, Vec<ast::Statement>)],
    targets: &[Vec<VarId>],
    scope: Scope,
) -> Option<Vec<Executed>> {
    let before = cx.assigned.clone();
    let mut out = Vec::with_capacity(list.len());
    for ((condition, body), targets) in list.iter().zip(targets) {
        cx.assigned.clone_from(&before);
        let conditions = conditions(cx, condition, scope)?;
        let mut actions = Vec::new();
        let (result, asserts) = cx.collect_assertions(|cx| statement_actions(cx, body, scope));
        add_asserts(asserts, &mut actions);
        for (guard, message) in std::mem::take(&mut cx.assertions.terminations) {
            let always = cx.graph.as_const(guard) == Some(Const::Boolean(true));
            actions.push(Action::Terminate { message, guard: (!always).then_some(guard) });
        }
        result?;
        let values = targets.iter().filter_map(|v| Some((*v, *cx.assigned.get(v)?))).collect();
        actions.extend(cx.leave_branch().map(|(v, e)| Action::Assign(v, e)));
        out.push(Executed { conditions, actions, values });
    }
    Some(out)
}

/// Executes statements: assignments remain in the evaluator; assertions and the like become actions.
/// `reinit` belongs to equations (section 8.3.6).
fn statement_actions(cx: &mut Evaluator<'_>, body: &[ast::Statement], scope: Scope) -> Option<()> {
    for s in body {
        match &s.kind {
            StatementKind::Call(call) if is_reinit(call) => {
                cx.report(BuiltinCause::ReinitOutsideWhen, call.span);
                return None;
            }
            _ => {
                cx.run_statements(std::slice::from_ref(s), scope)?;
            }
        }
    }
    Some(())
}

fn is_reinit(call: &Expr) -> bool {
    match &call.kind {
        ExprKind::Call { function, .. } => function.simple().is_some_and(|n| n == "reinit"),
        _ => false,
    }
}
