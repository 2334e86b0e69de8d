//! Dynamic state selection: no static choice of states is valid along the whole trajectory.
//!
//! S. E. Mattsson, H. Olsson, H. Elmqvist, "Dynamic Selection of States in Dymola", Modelica
//! Workshop 2000. If the pivots of a choice of dummy derivatives vary, they may vanish: those of a
//! pendulum in Cartesian coordinates do at its turning points. The states of such constraints
//! become new variables, `states = selection * candidates` and
//! `der(states) = selection * der(candidates)`, and the selection is updated during simulation.

use super::reduce::ConstraintPivot;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::base::source::Span;
use crate::ir::blocks::StateSet;
use crate::ir::dae::{Dae, EqId, Equation, Variable, VariableKind};
use crate::ir::expr::{Binary, ExprId, Type, VarId};
use crate::ir::flat::StateSelect;
use crate::symbolic::gradient::{Leaf, gradient};

/// Factor by which a `stateSelect` preference weights a pivot.
const PREFERENCE_WEIGHT: f64 = 10.0;

/// Finds the sets of constraints with varying pivots and appends their states, derivatives and
/// equations to the system. The candidates are no longer states.
pub fn state_sets(
    dae: &mut Dae,
    pivots: &[ConstraintPivot],
    is_state: &mut IndexVec<VarId, bool>,
) -> Vec<StateSet> {
    let mut sets = Vec::new();
    if !pivots.iter().any(|pivot| pivot.varying) {
        return sets;
    }
    let pivots = with_choice(dae, pivots);
    for group in groups(&pivots) {
        let mut candidates: Vec<VarId> =
            group.iter().flat_map(|pivot| pivot.candidates.iter().copied()).collect();
        candidates.sort_unstable();
        candidates.dedup();
        let determined: FastSet<VarId> = group.iter().map(|pivot| pivot.determined).collect();
        let free = candidates.iter().filter(|v| is_state[**v]).count();
        // Variables that must remain states may leave no choice.
        if free > 0 && free + group.len() == candidates.len() {
            let set = append(dae, &group, candidates, &determined, sets.len() + 1);
            is_state.resize(dae.variables.len(), false);
            set.candidates.iter().for_each(|v| is_state[*v] = false);
            set.states.iter().for_each(|v| is_state[*v] = true);
            sets.push(set);
        }
    }
    sets
}

/// The constraints and candidates between which there is a choice: without variables that must
/// remain states, and without those that a constraint determines alone, such as a prescribed
/// motion.
fn with_choice(dae: &Dae, pivots: &[ConstraintPivot]) -> Vec<ConstraintPivot> {
    let mut determined_alone: FastSet<(usize, VarId)> = FastSet::default();
    let is_free = |determined_alone: &FastSet<(usize, VarId)>, round: usize, v: VarId| {
        may_change(dae, v) && !determined_alone.contains(&(round, v))
    };
    loop {
        let before = determined_alone.len();
        for pivot in pivots.iter().filter(|pivot| !pivot.varying) {
            let alone =
                |v: &VarId| *v == pivot.determined || !is_free(&determined_alone, pivot.round, *v);
            if pivot.candidates.iter().all(alone) {
                determined_alone.insert((pivot.round, pivot.determined));
            }
        }
        if determined_alone.len() == before {
            break;
        }
    }
    let rest = pivots.iter().filter(|p| !determined_alone.contains(&(p.round, p.determined)));
    let opened = rest.map(|pivot| ConstraintPivot {
        candidates: (pivot.candidates.iter().copied())
            .filter(|v| is_free(&determined_alone, pivot.round, *v))
            .collect(),
        ..*pivot
    });
    opened.collect()
}

/// The constraints with varying pivots and those that determine some of their candidates, grouped
/// by common candidates.
fn groups(pivots: &[ConstraintPivot]) -> Vec<Vec<&ConstraintPivot>> {
    let determining: FastMap<(usize, VarId), usize> =
        pivots.iter().enumerate().map(|(i, p)| ((p.round, p.determined), i)).collect();
    let mut pending: Vec<usize> = (0..pivots.len()).filter(|i| pivots[*i].varying).collect();
    let mut included = vec![false; pivots.len()];
    while let Some(i) = pending.pop() {
        if !std::mem::replace(&mut included[i], true) {
            let of = pivots[i].candidates.iter().map(|v| (pivots[i].round, *v));
            pending.extend(of.filter_map(|key| determining.get(&key)));
        }
    }
    let mut groups: Vec<Vec<&ConstraintPivot>> = Vec::new();
    for pivot in pivots.iter().enumerate().filter(|(i, _)| included[*i]).map(|(_, pivot)| pivot) {
        let shares = |other: &&ConstraintPivot| {
            other.round == pivot.round
                && pivot.candidates.iter().any(|v| other.candidates.contains(v))
        };
        let (joined, separate): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|group| group.iter().any(shares));
        groups = separate;
        groups.push(joined.into_iter().flatten().chain([pivot]).collect());
    }
    groups
}

/// False for a variable that must remain a state.
fn may_change(dae: &Dae, v: VarId) -> bool {
    let reinitialised = dae.reinits.iter().any(|reinit| reinit.state == v);
    let Variable { state_select, hidden, .. } = dae.variables[v];
    // Combinations of derivatives were introduced as states.
    let is_sum = hidden && state_select == StateSelect::Prefer;
    !(reinitialised || is_sum || state_select == StateSelect::Always)
}

fn append(
    dae: &mut Dae,
    group: &[&ConstraintPivot],
    candidates: Vec<VarId>,
    determined: &FastSet<VarId>,
    number: usize,
) -> StateSet {
    let jacobian = jacobian(dae, group, &candidates);
    let count = candidates.len() - group.len();
    let first = group[0].constraint;
    let nominal = nominal(dae, &candidates);
    let (mut states, mut selection) = (Vec::new(), Vec::new());
    for i in 1..=count {
        let row: Vec<VarId> = (1..=candidates.len())
            .map(|j| hidden(dae, format!("$selection{number}[{i},{j}]"), VariableKind::Input))
            .collect();
        let state = hidden(dae, format!("$state{number}[{i}]"), VariableKind::Algebraic);
        let derivative =
            Variable::derivative(state, &dae.variables[state], VariableKind::Algebraic);
        let derivative = dae.variables.push(derivative);
        dae.variables[state].kind = VariableKind::Differentiated { derivative };
        dae.variables[state].nominal = nominal;
        let rates: Vec<VarId> = candidates.iter().map(|v| derivative_of(dae, *v)).collect();
        select(dae, first, state, &row, &candidates);
        select(dae, first, derivative, &row, &rates);
        states.push(state);
        selection.extend(row);
    }
    let position = |(i, v): (usize, &VarId)| determined.contains(v).then_some(i);
    StateSet {
        dependent: candidates.iter().enumerate().filter_map(position).collect(),
        wishes: candidates.iter().map(|v| preference(&dae.variables[*v])).collect(),
        constraints: group.iter().map(|pivot| pivot.constraint).collect(),
        candidates,
        states,
        selection,
        jacobian,
    }
}

/// The partial derivatives of the constraints with respect to the candidates.
fn jacobian(
    dae: &mut Dae,
    group: &[&ConstraintPivot],
    candidates: &[VarId],
) -> Vec<(usize, usize, ExprId)> {
    let place: FastMap<VarId, usize> =
        candidates.iter().enumerate().map(|(j, v)| (*v, j)).collect();
    let mut entries = Vec::new();
    for (i, pivot) in group.iter().enumerate() {
        let residual = dae.equations[pivot.constraint].residual;
        let wanted = |leaf| matches!(leaf, Leaf::Var(v) if place.contains_key(&v));
        for (leaf, value) in gradient(&mut dae.graph, residual, wanted) {
            if let Leaf::Var(v) = leaf {
                entries.push((i, place[&v], value));
            }
        }
    }
    entries.sort_unstable_by_key(|(i, j, _)| (*i, *j));
    entries
}

/// Appends `v = sum of coefficients times terms`.
fn select(dae: &mut Dae, of: EqId, v: VarId, coefficients: &[VarId], terms: &[VarId]) {
    let products: Vec<ExprId> = coefficients
        .iter()
        .zip(terms)
        .map(|(a, x)| {
            let (a, x) = (dae.graph.var(*a, Type::Real), dae.graph.var(*x, Type::Real));
            dae.graph.mul(a, x)
        })
        .collect();
    let rhs = dae.graph.sum(products);
    let lhs = dae.graph.var(v, Type::Real);
    let residual = dae.graph.sub(lhs, rhs);
    let origin = dae.equations[of].origin.clone();
    dae.equations.push(Equation { lhs, rhs, residual, origin, derivative_of: None });
}

fn hidden(dae: &mut Dae, name: String, kind: VariableKind) -> VarId {
    let variable = Variable { hidden: true, ..Variable::new(name, Type::Real, kind, Span::NONE) };
    dae.variables.push(variable)
}

fn derivative_of(dae: &Dae, v: VarId) -> VarId {
    match dae.variables[v].kind {
        VariableKind::Differentiated { derivative } => derivative,
        // Unreachable: candidates are differentiated.
        _ => v,
    }
}

/// The smallest nominal value of the candidates, if all have one.
fn nominal(dae: &mut Dae, candidates: &[VarId]) -> Option<ExprId> {
    let given: Option<Vec<ExprId>> = candidates.iter().map(|v| dae.variables[*v].nominal).collect();
    let smaller = |a, b| dae.graph.binary(Binary::Min, a, b);
    given?.into_iter().reduce(smaller)
}

fn preference(variable: &Variable) -> f64 {
    match variable.state_select {
        StateSelect::Never | StateSelect::Avoid => 1.0 / PREFERENCE_WEIGHT,
        StateSelect::Default => 1.0,
        StateSelect::Prefer | StateSelect::Always => PREFERENCE_WEIGHT,
    }
}
