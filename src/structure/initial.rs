//! The system of initialisation: Modelica 3.6, section 8.6.
//!
//! States are unknowns here. All equations hold, and besides them the initial equations and
//! `variable = start` where `fixed = true`. What the model leaves open is closed by further starts,
//! those of states first.

use super::incidence::System;
use super::structural_zero::Vanishing;
use super::{explain, is_continuous, reduce, sort};
use crate::base::diag::Problems;
use crate::base::index::{Id, IndexVec};
use crate::graph::augment::AugmentingSearch;
use crate::graph::bipartite::{Bipartite, Col, Row};
use crate::graph::matching::{self, Matching};
use crate::ir::blocks::{Block, Source};
use crate::ir::dae::{Dae, Kind};
use crate::ir::expr::VarId;

/// The blocks of initialisation, and the variables whose starts had to be assumed.
pub fn sequence(
    dae: &mut Dae,
    is_state: &IndexVec<VarId, bool>,
    vanishing: &Vanishing,
    problems: &mut Problems,
) -> Option<(Vec<Block>, Vec<VarId>)> {
    let system = given(dae);
    let system = super::redundant_initial::without_repeated(dae, system, vanishing);
    // States are matched last, so that those left over are the ones to be assumed, mostly without
    // any search.
    let column_class = |col: Col| u8::from(is_state[system.unknowns[col]]);
    let mut matched = preferred(&system, vanishing, column_class);
    if matched.cardinality() < system.sources.len() {
        problems.push(explain::initially_too_many(dae, &system, &matched));
        return None;
    }
    let candidates = candidates(dae, is_state, &system);
    let assumed = complete(&system.graph, &mut matched, &candidates);
    if let Some(free) = matched.free_cols().next() {
        problems.push(explain::initially_open(dae, system.unknowns[free]));
        return None;
    }
    let sources = system.sources.iter().copied();
    let chosen: Vec<Col> = assumed.iter().map(|place| candidates[*place]).collect();
    let starts: Vec<VarId> = chosen.iter().map(|col| system.unknowns[*col]).collect();
    let sources = sources.chain(starts.iter().map(|v| Source::Start(*v))).collect();
    let (system, matched) = {
        let matched = without_refused(&system, &matched, &assumed);
        let system = System::new(dae, sources, system.unknowns.iter().copied().collect());
        system.with_discrete(dae, matched)
    };
    let mut starts = starts;
    starts.sort_unstable();
    Some((sort::sequence(dae, &system, &matched), starts))
}

/// A maximum matching with columns of low class, and without incidences that vanish where it can.
fn preferred(system: &System, vanishing: &Vanishing, column_class: impl Fn(Col) -> u8) -> Matching {
    let gone = vanishing.edges(system);
    let cost = system.graph.rows().flat_map(|row| system.graph.edges(row));
    let cost = cost
        .map(|edge| Some(if gone[edge] { 2 } else { column_class(system.graph.col(edge)) }))
        .collect();
    matching::maximum_preferring(&system.graph, &cost, Matching::empty(&system.graph))
}

/// The equations that the model gives.
fn given(dae: &Dae) -> System {
    let is_unknown =
        |v: &VarId| is_continuous(dae, *v) || dae.variables[*v].kind == Kind::InitialParameter;
    let is_fixed = |v: &VarId| is_continuous(dae, *v) && dae.variables[*v].fixed == Some(true);
    let mut sources: Vec<Source> = dae.equations.ids().map(Source::Continuous).collect();
    sources.extend((0..dae.initial.len()).map(Source::Initial));
    sources.extend(dae.variables.ids().filter(is_fixed).map(Source::Start));
    System::new(dae, sources, dae.variables.ids().filter(is_unknown).collect())
}

/// The unknowns whose starts may be assumed, best first: states, then what is differentiated, then
/// whatever has a start of its own.
fn candidates(dae: &Dae, is_state: &IndexVec<VarId, bool>, system: &System) -> Vec<Col> {
    let mut candidates: Vec<Col> = system.unknowns.ids().collect();
    candidates.sort_by_key(|col| {
        let v = system.unknowns[*col];
        let variable = &dae.variables[v];
        let is_differentiated = matches!(variable.kind, Kind::Differentiated { .. });
        let priority = reduce::priority(variable);
        // What the compiler made has no start of its own.
        let is_state = is_state[v] && !variable.hidden;
        std::cmp::Reverse((
            is_state,
            is_differentiated && !variable.hidden,
            priority,
            std::cmp::Reverse(v),
        ))
    });
    candidates
}

/// Adds rows `candidate = start` as long as columns are free and the row helps. Returns the places
/// of the accepted candidates. The rows of all candidates stand in the graph from the beginning, so
/// that failed searches are remembered and the whole is nearly linear.
fn complete(graph: &Bipartite, matched: &mut Matching, candidates: &[Col]) -> Vec<usize> {
    let mut extended = graph.clone();
    for col in candidates {
        extended.push_row([*col]);
    }
    matched.grow(&extended);
    let mut open = matched.free_cols().count();
    let mut search = AugmentingSearch::new();
    let mut accepted = Vec::new();
    for place in 0..candidates.len() {
        if open == 0 {
            break;
        }
        let row = Row::from_usize(graph.row_count() + place);
        if search.augment(&extended, matched, row, |_, _| true) {
            accepted.push(place);
            open -= 1;
        }
    }
    accepted
}

/// The matching with the rows of accepted candidates directly behind those of the system.
fn without_refused(system: &System, matched: &Matching, accepted: &[usize]) -> Matching {
    let first = system.sources.len();
    let rows = (0..first).chain(accepted.iter().map(|place| first + place));
    let mut compact = Matching {
        row_to_col: IndexVec::filled(None, first + accepted.len()),
        col_to_row: IndexVec::filled(None, system.unknowns.len()),
    };
    for (new, old) in rows.enumerate() {
        if let Some(col) = matched.row_to_col[Row::from_usize(old)] {
            compact.join(Row::from_usize(new), col);
        }
    }
    compact
}
