//! The initialization problem (Modelica 3.6, section 8.6).
//!
//! States are unknowns here. All equations hold, and in addition the initial equations and
//! `variable = start` for `fixed = true`. If the model leaves unknowns undetermined, further start
//! values are assumed, those of states first.

use super::incidence::EquationSystem;
use super::structural_zeros::StructuralZeros;
use super::{explain, is_continuous, name_order, reduce, redundant_initial, relation_order, sort};
use crate::base::diag::Problems;
use crate::base::index::{Id, IndexVec};
use crate::graph::augment::AugmentingSearch;
use crate::graph::bipartite::{Bipartite, Col, Row};
use crate::graph::matching::{self, Matching};
use crate::ir::blocks::{Block, Source};
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::VarId;
use crate::ir::flat::StateSelect;

/// Where nonlinear loops of the initialization are torn.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum StartTearing {
    /// Where few unknowns remain.
    #[default]
    Fewest,
    /// At states, and at variables that have a start value: an iteration begins near these values,
    /// and the other unknowns follow.
    AtStarts,
}

/// The initialization in order.
pub struct InitialSequence {
    /// See [`Blocks::initial`](crate::ir::blocks::Blocks::initial).
    pub blocks: Vec<Block>,
    /// See [`Blocks::initial_by_states`](crate::ir::blocks::Blocks::initial_by_states).
    pub by_states: Vec<Block>,
    /// The variables whose start values had to be assumed.
    pub assumed: Vec<VarId>,
}

/// The blocks of initialization.
pub fn sequence(
    dae: &mut Dae,
    is_state: &IndexVec<VarId, bool>,
    zeros: &StructuralZeros,
    tearing: StartTearing,
    problems: &mut Problems,
) -> Option<InitialSequence> {
    let contradicted = redundant_initial::contradicted_constants(dae);
    if !contradicted.is_empty() {
        problems.push(explain::contradicted_constants(dae, &contradicted));
        return None;
    }
    let system = specified(dae);
    let system = redundant_initial::without_redundant(dae, system, zeros);
    // States are matched last: unmatched states are the ones to be assumed, usually without any
    // search.
    let column_class = |col: Col| u8::from(is_state[system.unknowns[col]]);
    let mut matched = preferred_matching(&system, zeros, column_class);
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
        let matched = compact(&system, &matched, &assumed);
        let system = EquationSystem::new(dae, sources, system.unknowns.iter().copied().collect());
        system.with_discrete(dae, matched)
    };
    let mut starts = starts;
    starts.sort_unstable();
    let is_preferred = |v: VarId| is_state[v];
    let blocks = match tearing {
        StartTearing::Fewest => sort::sequence(dae, &system, &matched),
        StartTearing::AtStarts => {
            let has_start: IndexVec<VarId, bool> =
                dae.variables.ids().map(|v| dae.variables[v].start.is_some()).collect();
            let is_known = |v: VarId| is_state[v] || has_start[v];
            sort::sequence_torn_at(dae, &system, &matched, &is_known)
        }
    };
    let by_states = match blocks.iter().any(|block| has_hidden_state(block, &is_preferred)) {
        true => sort::sequence_torn_at(dae, &system, &matched, &is_preferred),
        false => Vec::new(),
    };
    let [blocks, by_states] = [blocks, by_states].map(|b| relation_order::after_operands(dae, b));
    Some(InitialSequence { blocks, by_states, assumed: starts })
}

/// Whether a nonlinear loop is not torn at a state that it contains.
fn has_hidden_state(block: &Block, is_state: &dyn Fn(VarId) -> bool) -> bool {
    match block {
        Block::Assign(_) => false,
        Block::Torn(torn) => !torn.linear && torn.explicit.iter().any(|a| is_state(a.variable)),
        Block::Mixed(parts) => parts.iter().any(|part| has_hidden_state(part, is_state)),
    }
}

/// A maximum matching that prefers columns of low class and avoids structural zeros where possible.
fn preferred_matching(
    system: &EquationSystem,
    zeros: &StructuralZeros,
    column_class: impl Fn(Col) -> u8,
) -> Matching {
    let vanished = zeros.edges(system);
    let cost = system.graph.rows().flat_map(|row| system.graph.edges(row));
    let cost = cost
        .map(|edge| Some(if vanished[edge] { 2 } else { column_class(system.graph.col(edge)) }))
        .collect();
    matching::maximum_preferring(&system.graph, &cost, Matching::empty(&system.graph))
}

/// The initialization problem as specified by the model.
fn specified(dae: &Dae) -> EquationSystem {
    let is_unknown = |v: &VarId| {
        is_continuous(dae, *v) || dae.variables[*v].kind == VariableKind::InitialParameter
    };
    let is_fixed = |v: &VarId| is_continuous(dae, *v) && dae.variables[*v].fixed == Some(true);
    let mut sources: Vec<Source> = dae.equations.ids().map(Source::Continuous).collect();
    sources.extend((0..dae.initial.len()).map(Source::Initial));
    sources.extend(dae.variables.ids().filter(is_fixed).map(Source::Start));
    EquationSystem::new(dae, sources, dae.variables.ids().filter(is_unknown).collect())
}

/// The unknowns whose start values may be assumed, best first: states with a written
/// start value, variables preferred as states with one, states, then differentiated variables, then
/// the others by priority, and by name where nothing else decides.
fn candidates(dae: &Dae, is_state: &IndexVec<VarId, bool>, system: &EquationSystem) -> Vec<Col> {
    let mut candidates: Vec<Col> = system.unknowns.ids().collect();
    let preference = |col: Col| {
        let v = system.unknowns[col];
        let variable = &dae.variables[v];
        let is_differentiated = matches!(variable.kind, VariableKind::Differentiated { .. });
        let priority = reduce::priority(variable);
        // Variables introduced by the compiler have no start value of their own.
        let is_state = is_state[v] && !variable.hidden;
        // A start value that is written goes before one that is not, if it is that of a variable
        // that the model prefers as a state.
        let is_preferred = variable.state_select >= StateSelect::Prefer && !variable.hidden;
        let has_start = variable.start.is_some() && (is_state || is_preferred);
        (has_start, is_state, is_differentiated && !variable.hidden, priority)
    };
    let name = |col: Col| &*dae.variables[system.unknowns[col]].name;
    candidates.sort_by(|a, b| {
        let preferred = preference(*b).cmp(&preference(*a));
        preferred.then_with(|| name_order::compare(name(*a), name(*b)))
    });
    candidates
}

/// Adds rows `candidate = start` as long as columns are free and the row can be matched. Returns
/// the indices of the accepted candidates. The graph contains the rows of all candidates from the
/// start, so that failed searches are not repeated and the effort is nearly linear.
fn complete(graph: &Bipartite, matched: &mut Matching, candidates: &[Col]) -> Vec<usize> {
    let mut extended = graph.clone();
    for col in candidates {
        extended.push_row([*col]);
    }
    matched.grow(&extended);
    let mut open = matched.free_cols().count();
    let mut search = AugmentingSearch::new();
    let mut accepted = Vec::new();
    for index in 0..candidates.len() {
        if open == 0 {
            break;
        }
        let row = Row::from_usize(graph.row_count() + index);
        if search.augment(&extended, matched, row, |_, _| true) {
            accepted.push(index);
            open -= 1;
        }
    }
    accepted
}

/// The matching with the rows of accepted candidates directly after those of the system.
fn compact(system: &EquationSystem, matched: &Matching, accepted: &[usize]) -> Matching {
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
