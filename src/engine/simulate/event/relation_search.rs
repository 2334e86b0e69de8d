//! Solves relations and equations together: by fixed-point iteration, and if that cycles, by a
//! search for values of the relations that are consistent with the equations.

use crate::ir::program::Tape;
use crate::numeric::combinations::Combinations;
use crate::numeric::cycle_detection::CycleDetector;
use crate::runtime::machine::{Fault, Machine};

use super::iterate::{EventError, ITERATION_LIMIT};

/// Maximum number of single flips before all combinations are tried.
const MAX_FLIPS: usize = 300;
/// Number of consistent values that are remembered and tried first in the next search.
const MAX_KNOWN: usize = 16;

/// Executes a tape of the initial or event sequence until its lagged relations stop changing. If
/// they cycle or lead to equations without a solution, searches for other values: by single flips,
/// and if `exhaustive`, among all combinations.
pub fn solve_relations<'p>(
    machine: &mut Machine<'p>,
    tape: &'p Tape,
    lagged: &[u32],
    exhaustive: bool,
) -> Result<(), EventError> {
    let mut changed = Vec::new();
    if lagged.is_empty() || machine.tangents.is_some() {
        return iterate_relations(machine, tape, lagged, &mut changed);
    }
    let entry_memory = machine.snapshot();
    let mut outcome = iterate_relations(machine, tape, lagged, &mut changed);
    if outcome.as_ref().is_err_and(may_have_solution) {
        let saved = machine.save_fault();
        let exhaustive = exhaustive && !is_about_unknowns(machine, &outcome, &changed);
        let mut search = RelationSearch { machine, tape, lagged, entry_memory: &entry_memory };
        let found = search.try_known()
            || search.flip_contradicted()
            || exhaustive && search.enumerate(&changed);
        if found {
            machine.discard_fault(saved);
            outcome = Ok(());
        } else {
            machine.restore_fault(saved);
        }
    }
    machine.recycle(entry_memory);
    outcome
}

/// Whether a start failed where no relation has changed, so that none is suspected: starts of the unknowns far away are tried
/// first.
fn is_about_unknowns(
    machine: &Machine<'_>,
    outcome: &Result<(), EventError>,
    changed: &[u32],
) -> bool {
    let starts = machine.get(machine.program.layout.initial) != 0.0;
    let is_singular = matches!(outcome, Err(EventError::Fault(Fault::Singular { .. })));
    starts && !machine.branch_switch && is_singular && changed.is_empty()
}

/// Repeats the tape until the relations stop changing or a combination recurs. Appends the
/// relations that changed to `changed`.
fn iterate_relations<'p>(
    machine: &mut Machine<'p>,
    tape: &'p Tape,
    lagged: &[u32],
    changed: &mut Vec<u32>,
) -> Result<(), EventError> {
    let first = machine.program.layout.relations;
    let mut values: Vec<f64> = Vec::with_capacity(lagged.len());
    let mut changing = Vec::new();
    let mut cycle = CycleDetector::default();
    let mut recurred = false;
    for _ in 0..ITERATION_LIMIT {
        values.clear();
        values.extend(lagged.iter().map(|k| machine.get(first + k)));
        if cycle.repeats(&values) {
            // Unknowns that nothing determines now start from where they are.
            if recurred || machine.undetermined.is_none() {
                break;
            }
            recurred = true;
            cycle.restart();
        }
        machine.run(tape)?;
        changing.clear();
        let pairs = lagged.iter().zip(&values);
        changing.extend(pairs.filter(|(k, h)| machine.get(first + **k) != **h).map(|(k, _)| *k));
        if changing.is_empty() {
            return Ok(());
        }
        for k in &changing {
            if !changed.contains(k) {
                changed.push(*k);
            }
        }
    }
    Err(EventError::NotConverged(Vec::new(), changing))
}

/// A search for values of relations that are consistent with the equations.
struct RelationSearch<'a, 'p> {
    machine: &'a mut Machine<'p>,
    tape: &'p Tape,
    lagged: &'a [u32],
    /// The memory at the start of each attempt.
    entry_memory: &'a [f64],
}

impl RelationSearch<'_, '_> {
    /// Values of the relations on entry.
    fn first(&self) -> Vec<f64> {
        let first = self.machine.program.layout.relations;
        self.lagged.iter().map(|k| self.entry_memory[(first + k) as usize]).collect()
    }

    /// Executes the tape with these values of the relations; the first one that the equations
    /// contradict.
    fn contradicted(&mut self, values: &[f64]) -> Result<Option<usize>, Fault> {
        let first = self.machine.program.layout.relations;
        self.machine.restore_from(self.entry_memory);
        for (k, h) in self.lagged.iter().zip(values) {
            self.machine.set(first + k, *h);
        }
        self.machine.run(self.tape)?;
        let mut pairs = self.lagged.iter().zip(values);
        Ok(pairs.position(|(k, h)| self.machine.get(first + k) != *h))
    }

    fn is_confirmed(&mut self, values: &[f64]) -> bool {
        self.contradicted(values) == Ok(None)
    }

    /// Tries the results of previous searches: periodic switching recurs to the same values.
    fn try_known(&mut self) -> bool {
        let mut known = std::mem::take(&mut self.machine.relation_solutions);
        let found = known.iter().position(|values| self.is_confirmed(values));
        if let Some(k) = found {
            known[..=k].rotate_right(1);
        }
        self.machine.relation_solutions = known;
        found.is_some()
    }

    fn add_known(&mut self, values: Vec<f64>) {
        let known = &mut self.machine.relation_solutions;
        known.truncate(MAX_KNOWN - 1);
        known.insert(0, values);
    }

    /// Repeatedly flips the first relation that the equations contradict. This terminates if the
    /// relations form a linear complementarity problem with a P-matrix, as in networks of ideal
    /// diodes and resistors (K. G. Murty, "Note on a Bard-type scheme for solving the
    /// complementarity problem", Opsearch 11, 1974).
    fn flip_contradicted(&mut self) -> bool {
        let mut values = self.first();
        // Otherwise it may cycle.
        let mut cycle = CycleDetector::default();
        for _ in 0..MAX_FLIPS {
            if cycle.repeats(&values) {
                return false;
            }
            match self.contradicted(&values) {
                Ok(Some(wrong)) => values[wrong] = 1.0 - values[wrong],
                Ok(None) => {
                    self.add_known(values);
                    return true;
                }
                Err(_) => return false,
            }
        }
        false
    }

    /// Tries all combinations in order of the number of flips, first of the relations that changed
    /// during the iteration.
    fn enumerate(&mut self, changed: &[u32]) -> bool {
        let position = |k: &u32| self.lagged.iter().position(|l| l == k);
        let mut order: Vec<usize> = changed.iter().filter_map(position).collect();
        let others = (0..self.lagged.len()).filter(|i| !order.contains(i)).collect::<Vec<_>>();
        let counts = [order.len(), self.lagged.len()];
        order.extend(&others);
        let entry_memory = self.first();
        let mut values = entry_memory.clone();
        let sets = if others.is_empty() { &counts[..1] } else { &counts[..] };
        for count in sets {
            let mut choices = Combinations::new(*count);
            while let Some(flipped) = choices.next_subset() {
                values.copy_from_slice(&entry_memory);
                for i in flipped {
                    values[order[*i]] = 1.0 - values[order[*i]];
                }
                if self.is_confirmed(&values) {
                    self.add_known(values);
                    return true;
                }
            }
        }
        false
    }
}

/// True for failures that another strategy may avoid.
pub fn may_have_solution(failed: &EventError) -> bool {
    matches!(
        failed,
        EventError::NotConverged(..)
            | EventError::Fault(Fault::NotConverged { .. } | Fault::Singular { .. })
    )
}
