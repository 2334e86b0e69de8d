//! Structural analysis: from a system of equations to blocks in order of evaluation.
//!
//! *In:* a [`Dae`]. *Out:* [`Blocks`]: constraints are differentiated (Pantelides 1988), states are
//! selected (Mattsson and Söderlind 1993), some of them dynamically during simulation (Mattsson,
//! Olsson and Elmqvist 2000), and the equations of each phase are matched, sorted into blocks
//! (Tarjan 1972) and torn. Singular systems are explained in the user's names.
pub mod apply;
mod culprit;
mod discrete_loops;
pub mod derivative_combinations;
pub mod diagram;
pub mod dynamic_selection;
pub mod error;
pub mod error_growth;
mod explain;
pub mod incidence;
pub mod initial;
mod initial_propagation;
mod inline;
mod linear_dependence;
mod name_order;
mod parameter_values;
mod preferred_states;
pub mod print;
pub mod reduce;
pub mod redundant_initial;
mod relation_order;
mod singular_blocks;
pub mod solve;
pub mod sort;
pub mod start_report;
pub mod structural_zeros;
pub mod tear;

#[cfg(test)]
mod tests;

use crate::base::diag::Problems;
use crate::base::index::{FastSet, IndexVec};
use crate::graph::matching::{self, Matching};
use crate::ir::blocks::{Block, Blocks, Source, State};
use crate::ir::dae::{Dae, EqId, VariableKind};
use crate::ir::expr::VarId;
use incidence::EquationSystem;
use initial::StartTearing;
use structural_zeros::StructuralZeros;

/// Sorts a system. Errors are added to `problems`; `None` if there are any.
pub fn structure(dae: Dae, problems: &mut Problems) -> Option<Blocks> {
    structure_with(dae, StartTearing::default(), problems)
}

/// As [`structure`], with the loops of the initialization torn in this way.
pub fn structure_with(
    mut dae: Dae,
    tearing: StartTearing,
    problems: &mut Problems,
) -> Option<Blocks> {
    let stated = std::mem::take(&mut dae.stated);
    let zeros = StructuralZeros::find(&mut dae);
    let original = (!zeros.is_empty()).then(|| dae.clone());
    explain::check_determined(&dae, &stated, problems)?;
    drop(stated);
    let reduce::Reduced { mut is_state, pivots } = reduced(&mut dae, problems)?;

    let reduced_zeros = match original {
        Some(_) => StructuralZeros::find(&mut dae),
        None => zeros,
    };
    let (mut system, mut matched) = matched(&dae, &is_state, &reduced_zeros, problems)?;
    if let Some(mut original) = original {
        let wrong = reduced_zeros.mismatched(&dae, &system, &matched);
        // If the model is singular at these values, the simulation reports it.
        if StructuralZeros::find(&mut original).apply(&mut original, &wrong)
            && let mut quiet = Problems::new()
            && let Some(blocks) = structure_with(original, tearing, &mut quiet)
        {
            problems.extend(quiet);
            return Some(blocks);
        }
    }
    let zeros = reduced_zeros;
    // Initialization precedes the dynamic selection of states.
    let start = initial::sequence(&mut dae, &is_state, &zeros, tearing, problems)?;
    let state_sets = dynamic_selection::state_sets(&mut dae, &pivots, &mut is_state);
    if !state_sets.is_empty() {
        (system, matched) = self::matched(&dae, &is_state, &zeros, problems)?;
    }
    let continuous = sort::sequence(&mut dae, &system, &matched);
    discrete_loops::report(&mut dae, problems);
    let undetermined = singular_blocks::report(&mut dae, &continuous, problems);
    let (system, matched) = system.with_discrete(&dae, matched);
    let event = sort::sequence(&mut dae, &system, &matched);

    let (states, mut dummies) = split(&dae, &is_state);
    dummies.retain(|v| !state_sets.iter().any(|set| set.candidates.contains(v)));
    Some(Blocks {
        dae,
        states,
        dummies,
        state_sets,
        initial: start.blocks,
        initial_by_states: start.by_states,
        event,
        continuous,
        assumed_starts: start.assumed,
        undetermined,
    })
}

/// Reduces the index; preferred variables that the model does not differentiate become states where that is safe.
fn reduced(dae: &mut Dae, problems: &mut Problems) -> Option<reduce::Reduced> {
    let preferred = preferred_states::find(dae);
    if preferred.is_empty() {
        return reduced_by_combinations(dae, problems);
    }
    let original = dae.clone();
    preferred_states::differentiate(dae, &preferred);
    let mut found = Problems::new();
    if let Some(reduced) = reduced_by_combinations(dae, &mut found)
        && found.error_count() == 0
        && preferred_states::are_states(dae, &preferred, &reduced)
    {
        problems.extend(found);
        return Some(reduced);
    }
    *dae = original;
    reduced_by_combinations(dae, problems)
}

/// Reduces the index. Combinations of derivatives that nonlinear constraints relate become states, unless a term may jump,
/// which would make the others jump, too.
fn reduced_by_combinations(dae: &mut Dae, problems: &mut Problems) -> Option<reduce::Reduced> {
    let combinations = derivative_combinations::find(dae);
    if combinations.is_empty() {
        return reduce::reduce(dae, problems);
    }
    let original = dae.clone();
    let mut first_problems = Problems::new();
    let reduced = reduce::reduce(dae, &mut first_problems);
    let is_nonlinear = |r: &reduce::Reduced| {
        let nonlinear = r.pivots.iter().filter(|pivot| pivot.nonlinear).map(|p| p.constraint);
        let nonlinear: Vec<EqId> = nonlinear.collect();
        !nonlinear.is_empty() && !preferred_states::any_jumps(dae, nonlinear.into_iter())
    };
    if !reduced.as_ref().is_some_and(is_nonlinear) {
        problems.extend(first_problems);
        return reduced;
    }
    *dae = original;
    derivative_combinations::introduce_states(dae, &combinations);
    reduce::reduce(dae, problems)
}

/// The equations between events with a perfect matching of equations and unknowns.
fn matched(
    dae: &Dae,
    is_state: &IndexVec<VarId, bool>,
    zeros: &StructuralZeros,
    problems: &mut Problems,
) -> Option<(EquationSystem, Matching)> {
    let system = running(dae, is_state);
    let empty = Matching::empty(&system.graph);
    let matched = if zeros.is_empty() {
        matching::maximum(&system.graph, |_, _| true, empty)
    } else {
        let cost = zeros.edges(&system).iter().map(|vanished| Some(u8::from(*vanished))).collect();
        matching::maximum_preferring(&system.graph, &cost, empty)
    };
    if matched.cardinality() < system.sources.len().max(system.unknowns.len()) {
        problems.push(explain::lost_rank(dae, &system, &matched));
        return None;
    }
    Some((system, matched))
}

/// The equations between events, with the states known.
fn running(dae: &Dae, is_state: &IndexVec<VarId, bool>) -> EquationSystem {
    let sources = dae.equations.ids().map(Source::Continuous).collect();
    let unknowns = dae.variables.ids().filter(|v| is_continuous(dae, *v) && !is_state[*v]);
    EquationSystem::new(dae, sources, unknowns.collect())
}

fn split(dae: &Dae, is_state: &IndexVec<VarId, bool>) -> (Vec<State>, Vec<VarId>) {
    let mut states = Vec::new();
    let mut dummies = Vec::new();
    for (variable, v) in dae.variables.enumerate() {
        if let VariableKind::Differentiated { derivative } = v.kind {
            if is_state[variable] {
                states.push(State { variable, derivative });
            } else {
                dummies.push(variable);
            }
        }
    }
    (states, dummies)
}

/// True for an unknown of the continuous equations or a state.
fn is_continuous(dae: &Dae, v: VarId) -> bool {
    matches!(dae.variables[v].kind, VariableKind::Algebraic | VariableKind::Differentiated { .. })
}

/// The variables that a sequence of blocks determines, in order.
pub fn determined(blocks: &[Block]) -> Vec<VarId> {
    let mut found = Vec::new();
    let mut seen = FastSet::default();
    let mut open: Vec<&Block> = blocks.iter().rev().collect();
    while let Some(block) = open.pop() {
        let mut add = |v: VarId| {
            if seen.insert(v) {
                found.push(v);
            }
        };
        match block {
            Block::Assign(a) => add(a.variable),
            Block::Torn(t) => {
                t.unknowns.iter().copied().for_each(&mut add);
                t.explicit.iter().map(|a| a.variable).for_each(add);
            }
            Block::Mixed(parts) => open.extend(parts.iter().rev()),
        }
    }
    found
}
