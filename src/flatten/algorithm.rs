//! Algorithm sections of models (Modelica 3.6, section 11.1).

use super::equation::{Target, asserted};
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::evaluate::implicit_ranges::Body;
use crate::ir::ast::{self, StatementKind};
use crate::ir::expr::{Node, VarId};
use crate::ir::flat::EquationKind;
use crate::ir::instance::Scope;

/// Expands an algorithm section of a model: statements are executed symbolically; when-statements
/// become separate when-clauses.
pub(super) fn expand(
    cx: &mut Evaluator<'_>,
    list: &[ast::Statement],
    span: Span,
    scope: Scope,
    target: &mut Target<'_>,
) {
    cx.units.unitless_literal = false;
    cx.assigned.clear();
    let plain: Vec<ast::Statement> =
        list.iter().filter(|s| !matches!(s.kind, StatementKind::When { .. })).cloned().collect();
    let mut outputs = Vec::new();
    // The statements are evaluated again below, so assertions of their subscripts are
    // discarded here.
    let (started, _) =
        cx.collect_assertions(|cx| start_values(cx, &plain, scope, target, &mut outputs));
    let plain_outputs = outputs.clone();
    if started.is_some() && cx.run_statements(&plain, scope).is_some() && !outputs.is_empty() {
        let values = outputs.iter().map(|v| cx.assigned[v]).collect();
        target.push(EquationKind::Algorithm { outputs, values }, span);
    }
    cx.assigned.clear();
    asserted(cx, target);
    let mut whens = Vec::new();
    for s in list {
        if let StatementKind::When { branches } = &s.kind
            && let Some(branches) =
                cx.in_when(|cx| super::when::statement_branches(cx, branches, scope))
        {
            target.flat.unitless_literals.extend(cx.units.unitless_literal.then_some(s.span));
            whens.push((branches, s.span));
        }
    }
    super::when::conditions_before_assignment(cx, &mut whens, &plain_outputs);
    for (branches, span) in super::when::last_wins(whens) {
        target.push(EquationKind::When(branches), span);
    }
    target.flat.unitless_literals.extend(cx.units.unitless_literal.then_some(span));
    cx.units.unitless_literal = false;
}

/// Initializes the assigned variables of a section: discrete ones with their `pre` value, others
/// with their start value (Modelica 3.6, section 11.1.2).
fn start_values(
    cx: &mut Evaluator<'_>,
    list: &[ast::Statement],
    scope: Scope,
    target: &Target<'_>,
    outputs: &mut Vec<VarId>,
) -> Option<()> {
    for s in list {
        match &s.kind {
            StatementKind::Assign(to, _) => start_value(cx, to, scope, target, outputs)?,
            StatementKind::AssignTuple(all, _) => {
                for to in all.iter().flatten() {
                    start_value(cx, to, scope, target, outputs)?;
                }
            }
            StatementKind::If { branches, otherwise } => {
                for (_, body) in branches {
                    start_values(cx, body, scope, target, outputs)?;
                }
                start_values(cx, otherwise, scope, target, outputs)?;
            }
            StatementKind::For { iterators, body } => {
                let iterators = cx.with_ranges(iterators, Body::Statements(body), scope)?;
                start_values_of_loop(cx, &iterators, body, scope, target, outputs)?;
            }
            StatementKind::While { body, .. } => start_values(cx, body, scope, target, outputs)?,
            _ => {}
        }
    }
    Some(())
}

fn start_values_of_loop(
    cx: &mut Evaluator<'_>,
    iterators: &[ast::Iterator],
    body: &[ast::Statement],
    scope: Scope,
    target: &Target<'_>,
    outputs: &mut Vec<VarId>,
) -> Option<()> {
    let Some((first, rest)) = iterators.split_first() else {
        return start_values(cx, body, scope, target, outputs);
    };
    let values = match cx.unknown_iterator(first, scope)? {
        Some(value) => vec![value],
        None => cx.values_of(first, scope)?,
    };
    for value in values {
        cx.with_local(first.name.name, value, |cx| {
            start_values_of_loop(cx, rest, body, scope, target, outputs)
        })?;
    }
    Some(())
}

fn start_value(
    cx: &mut Evaluator<'_>,
    to: &ast::ComponentRef,
    scope: Scope,
    target: &Target<'_>,
    outputs: &mut Vec<VarId>,
) -> Option<()> {
    let selection = cx.select_target(to, scope)?;
    for v in cx.selected_variables(&selection, to.span)? {
        if cx.assigned.contains_key(&v) {
            continue;
        }
        let variable = &target.flat.variables[v];
        let value = if variable.variability == ast::Variability::Continuous {
            match variable.start {
                Some(start) => start,
                None => cx.graph.real(0.0),
            }
        } else {
            cx.graph.intern(Node::Pre(v), variable.ty)
        };
        cx.assigned.insert(v, value);
        outputs.push(v);
    }
    Some(())
}
