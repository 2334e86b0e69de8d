//! The variables that the statements of an algorithm section assign (Modelica 3.6, section 11.1.1).

use crate::base::index::FastSet;
use crate::evaluate::Evaluator;
use crate::evaluate::implicit_ranges::Body;
use crate::ir::ast::{self, StatementKind};
use crate::ir::expr::VarId;
use crate::ir::instance::Scope;

/// The variables that one statement of a section assigns.
#[derive(Default)]
pub(super) struct Targets {
    /// All of them, in the order of appearance.
    pub(super) all: Vec<VarId>,
    /// Those of each branch, if it is a when-statement.
    pub(super) branches: Vec<Vec<VarId>>,
}

/// The targets of each statement of a section; `None` after an error.
///
/// Subscripts are evaluated here, and again where the statements are executed: assertions that they
/// lead to are dropped here.
pub(super) fn of_statements(
    cx: &mut Evaluator<'_>,
    list: &[ast::Statement],
    scope: Scope,
) -> Option<Vec<Targets>> {
    let (found, _) =
        cx.collect_assertions(|cx| list.iter().map(|s| of_statement(cx, s, scope)).collect());
    found
}

fn of_statement(cx: &mut Evaluator<'_>, s: &ast::Statement, scope: Scope) -> Option<Targets> {
    let mut targets = Targets::default();
    match &s.kind {
        StatementKind::When { branches } => {
            for (_, body) in branches {
                let mut own = Vec::new();
                add_all(cx, body, scope, &mut own)?;
                targets.all.extend(&own);
                targets.branches.push(without_repetition(own));
            }
        }
        _ => add(cx, s, scope, &mut targets.all)?,
    }
    targets.all = without_repetition(targets.all);
    Some(targets)
}

fn without_repetition(mut list: Vec<VarId>) -> Vec<VarId> {
    let mut seen: FastSet<VarId> = FastSet::default();
    list.retain(|v| seen.insert(*v));
    list
}

fn add_all(
    cx: &mut Evaluator<'_>,
    list: &[ast::Statement],
    scope: Scope,
    out: &mut Vec<VarId>,
) -> Option<()> {
    list.iter().try_for_each(|s| add(cx, s, scope, out))
}

fn add(
    cx: &mut Evaluator<'_>,
    s: &ast::Statement,
    scope: Scope,
    out: &mut Vec<VarId>,
) -> Option<()> {
    match &s.kind {
        StatementKind::Assign(to, _) => add_target(cx, to, scope, out),
        StatementKind::AssignTuple(all, _) => {
            all.iter().flatten().try_for_each(|to| add_target(cx, to, scope, out))
        }
        StatementKind::If { branches, otherwise } => {
            for (_, body) in branches {
                add_all(cx, body, scope, out)?;
            }
            add_all(cx, otherwise, scope, out)
        }
        StatementKind::For { iterators, body } => {
            let iterators = cx.with_ranges(iterators, Body::Statements(body), scope)?;
            add_loop(cx, &iterators, body, scope, out)
        }
        StatementKind::While { body, .. } => add_all(cx, body, scope, out),
        _ => Some(()),
    }
}

fn add_loop(
    cx: &mut Evaluator<'_>,
    iterators: &[ast::Iterator],
    body: &[ast::Statement],
    scope: Scope,
    out: &mut Vec<VarId>,
) -> Option<()> {
    let Some((first, rest)) = iterators.split_first() else {
        return add_all(cx, body, scope, out);
    };
    let values = match cx.unknown_iterator(first, scope)? {
        Some(value) => vec![value],
        None => cx.values_of(first, scope)?,
    };
    for value in values {
        cx.with_local(first.name.name, value, |cx| add_loop(cx, rest, body, scope, out))?;
    }
    Some(())
}

fn add_target(
    cx: &mut Evaluator<'_>,
    to: &ast::ComponentRef,
    scope: Scope,
    out: &mut Vec<VarId>,
) -> Option<()> {
    let selection = cx.select_target(to, scope)?;
    out.extend(cx.selected_variables(&selection, to.span)?);
    Some(())
}
