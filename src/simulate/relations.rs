//! Relations and equations that must be solved together: by repetition, and where that goes round in
//! circles, by a search for values of the relations that the equations confirm.

use crate::codegen::interp::{Fault, Instance, next_choice};
use crate::ir::program::Tape;

use super::events::{ITERATION_LIMIT, Unsettled};

/// Relations that are turned one by one before all combinations are tried.
const MOST_TURNS: usize = 300;
/// Combinations of relations that are tried where an event iteration goes round in circles.
const MOST_TRIALS: u32 = 2000;

/// Runs a tape of the initial or event sequence until the relations it reads too early rest. Where
/// they go round in circles, or lead to equations without solution, others are looked for.
pub fn sweep<'p>(
    instance: &mut Instance<'p>,
    tape: &'p Tape,
    late: &[u32],
) -> Result<(), Unsettled> {
    let begun = if late.is_empty() { Vec::new() } else { instance.memory.clone() };
    let mut moved = Vec::new();
    let outcome = rest(instance, tape, late, &mut moved);
    let Err(failed) = outcome else { return Ok(()) };
    if late.is_empty() || instance.tangents.is_some() || !is_restless(&failed) {
        return Err(failed);
    }
    let told = (instance.memory.clone(), instance.fault_memory.clone(), instance.fault);
    if turn_one_by_one(instance, tape, late, &begun) || search(instance, tape, late, &begun, &moved)
    {
        instance.fault = None;
        return Ok(());
    }
    (instance.memory, instance.fault_memory, instance.fault) = told;
    Err(failed)
}

/// Finds out that relations go round in a circle, by comparing them with those of a turn that is kept ever
/// longer (R. P. Brent, BIT 20, 1980).
#[derive(Default)]
struct Circle {
    kept: Vec<f64>,
    turn: u32,
    next: u32,
}

impl Circle {
    /// True if the relations of the next turn are those of a turn before.
    fn is_closed_by(&mut self, held: &[f64]) -> bool {
        self.turn += 1;
        if self.turn > 1 && self.kept == held {
            return true;
        }
        if self.turn > self.next {
            self.kept.clear();
            self.kept.extend_from_slice(held);
            self.next = 2 * self.turn;
        }
        false
    }
}

fn rest<'p>(
    instance: &mut Instance<'p>,
    tape: &'p Tape,
    late: &[u32],
    moved: &mut Vec<u32>,
) -> Result<(), Unsettled> {
    let first = instance.program.layout.relations;
    let mut held: Vec<f64> = Vec::with_capacity(late.len());
    let mut restless = Vec::new();
    let mut circle = Circle::default();
    for _ in 0..ITERATION_LIMIT {
        held.clear();
        held.extend(late.iter().map(|k| instance.get(first + k)));
        if circle.is_closed_by(&held) {
            break;
        }
        instance.run(tape)?;
        restless.clear();
        let pairs = late.iter().zip(&held);
        restless.extend(pairs.filter(|(k, h)| instance.get(first + **k) != **h).map(|(k, _)| *k));
        if restless.is_empty() {
            return Ok(());
        }
        moved.extend(restless.iter().filter(|k| !moved.contains(k)).copied().collect::<Vec<_>>());
    }
    Err(Unsettled::Restless(Vec::new(), restless))
}

/// Turns of the relations that the equations contradict only the first, until there is none: where the
/// relations are those of a linear complementarity problem with a P-matrix, as of networks of ideal
/// diodes and resistances, that ends (K. G. Murty, "Note on a Bard-type scheme for solving the
/// complementarity problem", Opsearch 11, 1974).
fn turn_one_by_one<'p>(
    instance: &mut Instance<'p>,
    tape: &'p Tape,
    late: &[u32],
    begun: &[f64],
) -> bool {
    let first = instance.program.layout.relations;
    instance.memory.copy_from_slice(begun);
    let mut held: Vec<f64> = late.iter().map(|k| instance.get(first + k)).collect();
    // Elsewhere it may go round in circles.
    let mut circle = Circle::default();
    for _ in 0..MOST_TURNS {
        if circle.is_closed_by(&held) || instance.run(tape).is_err() {
            return false;
        }
        let wrong = late.iter().zip(&held).position(|(k, h)| instance.get(first + k) != *h);
        let Some(wrong) = wrong else { return true };
        instance.memory.copy_from_slice(begun);
        held[wrong] = 1.0 - held[wrong];
        for (k, h) in late.iter().zip(&held) {
            instance.set(first + k, *h);
        }
    }
    false
}

/// Looks for values of relations that the equations confirm, from `begun` on: those first that differ
/// least from what they were, and first among the relations that were seen to move.
fn search<'p>(
    instance: &mut Instance<'p>,
    tape: &'p Tape,
    late: &[u32],
    begun: &[f64],
    moved: &[u32],
) -> bool {
    let first = instance.program.layout.relations;
    let mut relations: Vec<u32> = moved.to_vec();
    relations.extend(late.iter().filter(|k| !moved.contains(k)));
    let sets = [moved.len(), relations.len()];
    let mut left = MOST_TRIALS;
    for (k, &count) in sets.iter().enumerate() {
        if k > 0 && count == sets[0] {
            break;
        }
        for distance in 0..=count {
            let mut flipped: Vec<usize> = (0..distance).collect();
            loop {
                if left == 0 {
                    return false;
                }
                left -= 1;
                instance.memory.copy_from_slice(begun);
                for &i in &flipped {
                    let slot = first + relations[i];
                    instance.set(slot, 1.0 - instance.get(slot));
                }
                let held: Vec<f64> = late.iter().map(|k| instance.get(first + k)).collect();
                let confirmed = instance.run(tape).is_ok()
                    && late.iter().zip(&held).all(|(k, h)| instance.get(first + k) == *h);
                if confirmed {
                    return true;
                }
                if !next_choice(&mut flipped, count) {
                    break;
                }
            }
        }
    }
    false
}

/// What may come to rest if each turn sees the one before as its past.
pub fn is_restless(failed: &Unsettled) -> bool {
    matches!(
        failed,
        Unsettled::Restless(..) | Unsettled::Fault(Fault::Restless { .. } | Fault::Singular { .. })
    )
}
