//! Initial values that are stated more than once. In comes the system of initialisation, out goes one in
//! which what others imply with the same value is no equation of its own: at the start it is compared,
//! and that is all.

use super::incidence::System;
use super::structural_zero::Vanishing;
use crate::base::index::IndexVec;
use crate::graph::bipartite::{Bipartite, Row};
use crate::graph::matching::{self, Matching};
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, GuardedAssert};
use crate::ir::expr::{Binary, ExprId, Node, Type, Unary, VarId};
use crate::ir::flat::{Assert, Level, Origin};

/// `variable = value` at the start.
struct Statement {
    variable: VarId,
    /// `None` if only a run knows it.
    value: Option<f64>,
}

/// The system without the fixed starts and initial equations `variable = number` that compete with
/// another one of the same value.
pub fn without_repeated(dae: &mut Dae, system: System, vanishing: &Vanishing) -> System {
    // Statements are matched after everything else, so that those left over are statements if any can be.
    let gone = vanishing.edges(&system);
    let mut cost = IndexVec::new();
    for row in system.graph.rows() {
        let states = statement(dae, system.sources[row]).is_some();
        for edge in system.graph.edges(row) {
            cost.push(Some(if states { 2 } else { u8::from(gone[edge]) }));
        }
    }
    let empty = Matching::empty(&system.graph);
    let matched = matching::maximum_preferring(&system.graph, &cost, empty);
    let mut repeated = Vec::new();
    for row in matched.free_rows() {
        let Some(own) = statement(dae, system.sources[row]) else { continue };
        let tied = dependent(&system.graph, &matched, row);
        let mut others = tied.iter().filter(|other| **other != row);
        if others.any(|other| {
            statement(dae, system.sources[*other]).is_some_and(|s| s.value == own.value)
        }) {
            repeated.push((row, own));
        }
    }
    if repeated.is_empty() {
        return system;
    }
    for (row, own) in &repeated {
        let assert = compared(dae, system.sources[*row], own);
        dae.asserts.push(assert);
    }
    let kept = system.sources.enumerate().filter(|(row, _)| !repeated.iter().any(|r| r.0 == *row));
    let sources = kept.map(|(_, source)| *source).collect();
    System::new(dae, sources, system.unknowns.iter().copied().collect())
}

/// The rows that compete with a free row for columns.
fn dependent(graph: &Bipartite, matched: &Matching, free: Row) -> Vec<Row> {
    let mut seen: IndexVec<Row, bool> = IndexVec::filled(false, graph.row_count());
    seen[free] = true;
    let mut rows = vec![free];
    let mut at = 0;
    while at < rows.len() {
        for &col in graph.cols(rows[at]) {
            if let Some(other) = matched.col_to_row[col]
                && !std::mem::replace(&mut seen[other], true)
            {
                rows.push(other);
            }
        }
        at += 1;
    }
    rows
}

/// What a fixed start, or an initial equation between a variable and a number, states.
fn statement(dae: &Dae, source: Source) -> Option<Statement> {
    match source {
        Source::Start(variable) => {
            let value = match dae.variables[variable].start {
                Some(e) => dae.graph.as_number(e),
                None => Some(0.0),
            };
            Some(Statement { variable, value })
        }
        Source::Initial(k) => {
            let equation = &dae.initial[k];
            let between = |a: ExprId, b: ExprId| match dae.graph.node(a) {
                Node::Var(variable) => {
                    Some(Statement { variable, value: Some(dae.graph.as_number(b)?) })
                }
                _ => None,
            };
            between(equation.lhs, equation.rhs).or_else(|| between(equation.rhs, equation.lhs))
        }
        Source::Continuous(_) | Source::Discrete(_) => None,
    }
}

/// `not initial() or abs(variable - value) <= 1e-6 * (1 + abs(value))`
fn compared(dae: &mut Dae, source: Source, stated: &Statement) -> GuardedAssert {
    let Statement { variable: v, value } = *stated;
    let value = value.unwrap_or(0.0);
    let g = &mut dae.graph;
    let (own, start) = (g.var(v, dae.variables[v].ty), g.real(value));
    let difference = g.sub(own, start);
    let size = g.unary(Unary::Abs, difference);
    let bound = g.real(1e-6 * (1.0 + value.abs()));
    let equal = g.binary(Binary::LessEqual, size, bound);
    let initial = g.intern(Node::Initial, Type::Boolean);
    let later = g.not(initial);
    let condition = g.or(later, equal);
    let name = &dae.variables[v].name;
    let (text, origin) = match source {
        Source::Initial(k) => (
            format!("this initial equation of `{name}` contradicts the others"),
            dae.initial[k].origin.clone(),
        ),
        _ => (
            format!("the fixed start of `{name}` contradicts the other starts"),
            Origin { span: dae.variables[v].span, component: "".into() },
        ),
    };
    let message = g.string(&text);
    let assert = Assert { condition, message, level: Level::Error };
    GuardedAssert { active: None, assert, origin }
}
