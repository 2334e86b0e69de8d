//! Homotopy: continuation from the simplified system to the actual one.
//!
//! `lambda` goes from 0 to 1 in steps whose length adapts to the success of the initialization
//! (natural continuation: E. L. Allgower, K. Georg, *Introduction to Numerical Continuation
//! Methods*, 2003, ch. 2). Each solution is the guess for the next.

use crate::ir::program::{Continuation, Slot};
use crate::runtime::machine::Machine;

use super::initialization::initialise_from;
use super::settings::Settings;

/// First step of `lambda`; later ones at most double.
const FIRST: f64 = 0.25;
/// Minimum step of `lambda`.
const SHORTEST: f64 = 1e-4;

/// Guesses for the slots of the actual program, if the continuation reaches `lambda = 1`.
/// `by_states` says whether loops are torn at states, and `searches` whether the solution of the simplified system may
/// lie far from the start values; each further one is near the one before.
pub fn follow(
    continuation: &Continuation,
    settings: &Settings,
    by_states: bool,
    searches: bool,
) -> Option<Vec<(Slot, f64)>> {
    let Continuation { program, lambda, slots } = continuation;
    let names = settings.parameters.iter().chain(&settings.starts);
    // Both programs have the same numbering of variables.
    debug_assert!(names.clone().all(|(v, _)| v != lambda));
    let mut settings = settings.clone();
    let mut machine = Machine::new(program);
    machine.starts_by_states = by_states && !program.tapes.initial_by_states.is_empty();
    let given = settings.parameters.len();
    machine.set_execution(&settings.execution);
    let mut start_at = |at: f64, guess: &[(Slot, f64)]| {
        machine.branch_switch = searches && guess.is_empty();
        settings.parameters.truncate(given);
        settings.parameters.push((*lambda, at));
        initialise_from(&mut machine, &settings, guess).ok()?;
        Some(slots.iter().map(|&(slot, _)| (slot, machine.get(slot))).collect::<Vec<_>>())
    };
    let mut found = start_at(0.0, &[])?;
    let (mut at, mut step) = (0.0, FIRST);
    while at < 1.0 {
        let next = if at + step >= 1.0 - SHORTEST { 1.0 } else { at + step };
        match start_at(next, &found) {
            Some(better) => {
                found = better;
                at = next;
                step *= 2.0;
            }
            None => {
                step *= 0.5;
                if step < SHORTEST {
                    return None;
                }
            }
        }
    }
    Some(found.iter().zip(slots).map(|(&(_, value), &(_, slot))| (slot, value)).collect())
}
