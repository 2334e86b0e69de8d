//! Relations and equations that must be solved together: by repetition, and where that goes round in
//! circles, by a search for values of the relations that the equations confirm.

use crate::ir::program::Tape;
use crate::numeric::combinations::Combinations;
use crate::numeric::cycle_detection::CycleDetector;
use crate::runtime::machine::{Fault, Instance};

use super::iterate::{ITERATION_LIMIT, Unsettled};

/// Relations that are turned one by one before all combinations are tried.
const MOST_TURNS: usize = 300;
/// Values of relations that were found by a search and are tried first at the next one.
const REMEMBERED: usize = 16;

/// Runs a tape of the initial or event sequence until the relations it reads too early rest. Where
/// they go round in circles, or lead to equations without solution, others are looked for: near by, or
/// `thoroughly` among all combinations.
pub fn sweep<'p>(
    instance: &mut Instance<'p>,
    tape: &'p Tape,
    late: &[u32],
    thoroughly: bool,
) -> Result<(), Unsettled> {
    let mut moved = Vec::new();
    if late.is_empty() || instance.tangents.is_some() {
        return rest(instance, tape, late, &mut moved);
    }
    let begun = instance.keep();
    let mut outcome = rest(instance, tape, late, &mut moved);
    if outcome.as_ref().is_err_and(is_restless) {
        let told = instance.told();
        let mut trials = Trials { instance, tape, late, begun: &begun };
        let found =
            trials.recall() || trials.turn_one_by_one() || thoroughly && trials.search(&moved);
        if found {
            instance.forget(told);
            outcome = Ok(());
        } else {
            instance.tell(told);
        }
    }
    instance.release(begun);
    outcome
}

/// Repeats the tape until the relations rest, or come again as they were. `moved` is told which moved.
fn rest<'p>(
    instance: &mut Instance<'p>,
    tape: &'p Tape,
    late: &[u32],
    moved: &mut Vec<u32>,
) -> Result<(), Unsettled> {
    let first = instance.program.layout.relations;
    let mut held: Vec<f64> = Vec::with_capacity(late.len());
    let mut restless = Vec::new();
    let mut circle = CycleDetector::default();
    for _ in 0..ITERATION_LIMIT {
        held.clear();
        held.extend(late.iter().map(|k| instance.get(first + k)));
        if circle.repeats(&held) {
            break;
        }
        instance.run(tape)?;
        restless.clear();
        let pairs = late.iter().zip(&held);
        restless.extend(pairs.filter(|(k, h)| instance.get(first + **k) != **h).map(|(k, _)| *k));
        if restless.is_empty() {
            return Ok(());
        }
        for k in &restless {
            if !moved.contains(k) {
                moved.push(*k);
            }
        }
    }
    Err(Unsettled::Restless(Vec::new(), restless))
}

/// Attempts to find values of relations that the equations confirm.
struct Trials<'a, 'p> {
    instance: &'a mut Instance<'p>,
    tape: &'p Tape,
    late: &'a [u32],
    /// The memory from which each attempt begins.
    begun: &'a [f64],
}

impl Trials<'_, '_> {
    /// Values of the relations at the beginning.
    fn first(&self) -> Vec<f64> {
        let first = self.instance.program.layout.relations;
        self.late.iter().map(|k| self.begun[(first + k) as usize]).collect()
    }

    /// Runs the tape with these values of the relations; the first of them that the equations contradict.
    fn contradicted(&mut self, held: &[f64]) -> Result<Option<usize>, Fault> {
        let first = self.instance.program.layout.relations;
        self.instance.memory.copy_from_slice(self.begun);
        for (k, h) in self.late.iter().zip(held) {
            self.instance.set(first + k, *h);
        }
        self.instance.run(self.tape)?;
        let mut pairs = self.late.iter().zip(held);
        Ok(pairs.position(|(k, h)| self.instance.get(first + k) != *h))
    }

    fn is_confirmed(&mut self, held: &[f64]) -> bool {
        self.contradicted(held) == Ok(None)
    }

    /// Tries what was found before: what switches periodically comes to the same again and again.
    fn recall(&mut self) -> bool {
        let mut known = std::mem::take(&mut self.instance.confirmed);
        let found = known.iter().position(|held| self.is_confirmed(held));
        if let Some(k) = found {
            known[..=k].rotate_right(1);
        }
        self.instance.confirmed = known;
        found.is_some()
    }

    fn remember(&mut self, held: Vec<f64>) {
        let known = &mut self.instance.confirmed;
        known.truncate(REMEMBERED - 1);
        known.insert(0, held);
    }

    /// Turns of the relations that the equations contradict only the first, until there is none: where
    /// the relations are those of a linear complementarity problem with a P-matrix, as of networks of
    /// ideal diodes and resistances, that ends (K. G. Murty, "Note on a Bard-type scheme for solving the
    /// complementarity problem", Opsearch 11, 1974).
    fn turn_one_by_one(&mut self) -> bool {
        let mut held = self.first();
        // Elsewhere it may go round in circles.
        let mut circle = CycleDetector::default();
        for _ in 0..MOST_TURNS {
            if circle.repeats(&held) {
                return false;
            }
            match self.contradicted(&held) {
                Ok(Some(wrong)) => held[wrong] = 1.0 - held[wrong],
                Ok(None) => {
                    self.remember(held);
                    return true;
                }
                Err(_) => return false,
            }
        }
        false
    }

    /// Looks for values that differ least from those at the beginning, first among the relations that were
    /// seen to move.
    fn search(&mut self, moved: &[u32]) -> bool {
        let position = |k: &u32| self.late.iter().position(|l| l == k);
        let mut order: Vec<usize> = moved.iter().filter_map(position).collect();
        let others = (0..self.late.len()).filter(|i| !order.contains(i)).collect::<Vec<_>>();
        let counts = [order.len(), self.late.len()];
        order.extend(&others);
        let begun = self.first();
        let mut held = begun.clone();
        let sets = if others.is_empty() { &counts[..1] } else { &counts[..] };
        for count in sets {
            let mut choices = Combinations::new(*count);
            while let Some(turned) = choices.next_subset() {
                held.copy_from_slice(&begun);
                for i in turned {
                    held[order[*i]] = 1.0 - held[order[*i]];
                }
                if self.is_confirmed(&held) {
                    self.remember(held);
                    return true;
                }
            }
        }
        false
    }
}

/// What may come to rest if each turn sees the one before as its past.
pub fn is_restless(failed: &Unsettled) -> bool {
    matches!(
        failed,
        Unsettled::Restless(..) | Unsettled::Fault(Fault::Restless { .. } | Fault::Singular { .. })
    )
}
