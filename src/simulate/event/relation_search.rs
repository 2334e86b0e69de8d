//! Relations and equations that must be solved together: by repetition, and where that goes round in
//! circles, by a search for values of the relations that the equations confirm.

use crate::ir::program::Tape;
use crate::numeric::combinations::Combinations;
use crate::numeric::cycle_detection::CycleDetector;
use crate::runtime::machine::{Fault, Machine};

use super::iterate::{EventError, ITERATION_LIMIT};

/// Relations that are turned one by one before all combinations are tried.
const MAX_FLIPS: usize = 300;
/// Values of relations that were found by a search and are tried first at the next one.
const MAX_KNOWN: usize = 16;

/// Runs a tape of the initial or event sequence until the relations it reads too early rest. Where
/// they go round in circles, or lead to equations without solution, others are looked for: near by, or
/// `exhaustive` among all combinations.
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

/// Repeats the tape until the relations rest, or come again as they were. `changed` is told which moved.
fn rest<'p>(
    machine: &mut Machine<'p>,
    tape: &'p Tape,
    lagged: &[u32],
    changed: &mut Vec<u32>,
) -> Result<(), EventError> {
    let first = machine.program.layout.relations;
    let mut values: Vec<f64> = Vec::with_capacity(lagged.len());
    let mut changing = Vec::new();
    let mut cycle = CycleDetector::default();
    for _ in 0..ITERATION_LIMIT {
        values.clear();
        values.extend(lagged.iter().map(|k| machine.get(first + k)));
        if cycle.repeats(&values) {
            break;
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

/// Attempts to find values of relations that the equations confirm.
struct RelationSearch<'a, 'p> {
    machine: &'a mut Machine<'p>,
    tape: &'p Tape,
    lagged: &'a [u32],
    /// The memory from which each attempt begins.
    entry_memory: &'a [f64],
}

impl RelationSearch<'_, '_> {
    /// Values of the relations at the beginning.
    fn first(&self) -> Vec<f64> {
        let first = self.machine.program.layout.relations;
        self.lagged.iter().map(|k| self.entry_memory[(first + k) as usize]).collect()
    }

    /// Runs the tape with these values of the relations; the first of them that the equations contradict.
    fn contradicted(&mut self, values: &[f64]) -> Result<Option<usize>, Fault> {
        let first = self.machine.program.layout.relations;
        self.machine.memory.copy_from_slice(self.entry_memory);
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

    /// Tries what was found before: what switches periodically comes to the same again and again.
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

    /// Turns of the relations that the equations contradict only the first, until there is none: where
    /// the relations are those of a linear complementarity problem with a P-matrix, as of networks of
    /// ideal diodes and resistances, that ends (K. G. Murty, "Note on a Bard-type scheme for solving the
    /// complementarity problem", Opsearch 11, 1974).
    fn flip_contradicted(&mut self) -> bool {
        let mut values = self.first();
        // Elsewhere it may go round in circles.
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

    /// Looks for values that differ least from those at the beginning, first among the relations that were
    /// seen to move.
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

/// What may come to rest if each turn sees the one before as its past.
pub fn may_have_solution(failed: &EventError) -> bool {
    matches!(
        failed,
        EventError::NotConverged(..)
            | EventError::Fault(Fault::NotConverged { .. } | Fault::Singular { .. })
    )
}
