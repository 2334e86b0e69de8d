//! Redundant initial values. *In:* the initialization problem. *Out:* the same without initial
//! values that the other equations imply; these become assertions that are checked at the start.

use super::incidence::EquationSystem;
use super::structural_zeros::StructuralZeros;
use crate::base::index::IndexVec;
use crate::graph::bipartite::{Bipartite, Row};
use crate::graph::matching::{self, Matching};
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, GuardedAssert};
use crate::ir::expr::{Binary, ExprId, Node, Type, Unary, VarId};
use crate::ir::flat::{Assert, AssertionLevel, Origin};

/// An initial condition `variable = value`.
struct InitialValue {
    variable: VarId,
    /// `None` if it cannot be evaluated before simulation.
    value: Option<f64>,
}

/// Removes fixed starts and initial equations `variable = number` that compete with another one of
/// the same value.
pub fn without_redundant(
    dae: &mut Dae,
    system: EquationSystem,
    zeros: &StructuralZeros,
) -> EquationSystem {
    // Initial values are matched last, so that the unmatched rows are initial values if possible.
    let vanished = zeros.edges(&system);
    let mut cost = IndexVec::new();
    for row in system.graph.rows() {
        let states = initial_value(dae, system.sources[row]).is_some();
        for edge in system.graph.edges(row) {
            cost.push(Some(if states { 2 } else { u8::from(vanished[edge]) }));
        }
    }
    let empty = Matching::empty(&system.graph);
    let matched = matching::maximum_preferring(&system.graph, &cost, empty);
    let mut redundant = Vec::new();
    for row in matched.free_rows() {
        let Some(own) = initial_value(dae, system.sources[row]) else { continue };
        let tied = dependent(&system.graph, &matched, row);
        let mut others = tied.iter().filter(|other| **other != row);
        if others.any(|other| {
            initial_value(dae, system.sources[*other]).is_some_and(|s| s.value == own.value)
        }) {
            redundant.push((row, own));
        }
    }
    if redundant.is_empty() {
        return system;
    }
    for (row, own) in &redundant {
        let assert = comparison(dae, system.sources[*row], own);
        dae.asserts.push(assert);
    }
    let kept = system.sources.enumerate().filter(|(row, _)| !redundant.iter().any(|r| r.0 == *row));
    let sources = kept.map(|(_, source)| *source).collect();
    EquationSystem::new(dae, sources, system.unknowns.iter().copied().collect())
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

/// The initial value given by a fixed start or by an initial equation `variable = number`.
fn initial_value(dae: &Dae, source: Source) -> Option<InitialValue> {
    match source {
        Source::Start(variable) => {
            let value = match dae.variables[variable].start {
                Some(e) => dae.graph.as_number(e),
                None => Some(0.0),
            };
            Some(InitialValue { variable, value })
        }
        Source::Initial(k) => {
            let equation = &dae.initial[k];
            let between = |a: ExprId, b: ExprId| match dae.graph.node(a) {
                Node::Var(variable) => {
                    Some(InitialValue { variable, value: Some(dae.graph.as_number(b)?) })
                }
                _ => None,
            };
            between(equation.lhs, equation.rhs).or_else(|| between(equation.rhs, equation.lhs))
        }
        Source::Continuous(_) | Source::Discrete(_) => None,
    }
}

/// `not initial() or abs(variable - value) <= 1e-6 * (1 + abs(value))`
fn comparison(dae: &mut Dae, source: Source, stated: &InitialValue) -> GuardedAssert {
    let InitialValue { variable: v, value } = *stated;
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
    let assert = Assert { condition, message, level: AssertionLevel::Error };
    GuardedAssert { active: None, assert, origin }
}
