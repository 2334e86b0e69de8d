//! The derivatives that matter at events: a few of all slots.
//!
//! An event reads states, discrete variables and left limits; its sequence computes the rest again. So only the
//! instructions that these, the indicators of relations and the recorded variables depend on are differentiated, and
//! only what one event iteration leaves to the next is saved.

use crate::ir::program::{Instr, Program, RelationTrigger, Slot};
use crate::runtime::tangent::Tangents;
use crate::runtime::tangent::outputs::{needed, read_first, written};

/// Which derivatives events need.
pub struct AtEvents {
    /// The instructions between events whose results events read.
    pub arriving: Vec<Instr>,
    /// The slots that may move with time after them, besides states, time and signals.
    moving: Vec<Slot>,
    /// The slots that the event sequence changes, and that something reads later.
    carried: Vec<Slot>,
    /// Their derivatives at the left limit.
    kept: Vec<f64>,
}

impl AtEvents {
    /// Finds them for a program that records the slots `recorded`, and lets `tangents` propagate no others along the
    /// event sequence.
    pub fn new(program: &Program, recorded: &[Slot], tangents: &mut Tangents) -> Self {
        let tapes = &program.tapes;
        let own = [&tapes.event, &tapes.discrete, &tapes.rhs, &tapes.roots, &tapes.outputs];
        let own: Vec<&[Instr]> = own.into_iter().map(|tape| &tape[..]).collect();
        let read = read_first(program, &own);
        let mut wanted: Vec<Slot> = (0..read.len() as Slot).filter(|c| read[*c as usize]).collect();
        wanted.extend(recorded);
        wanted.extend(program.layout.pre.iter().map(|(_, slot, _)| *slot));
        wanted.extend(program.events.clocks.iter().flat_map(|c| [c.start, c.interval]));
        for (k, trigger) in (0..).zip(&program.events.relation_triggers) {
            match trigger {
                RelationTrigger::Time(slot) => wanted.push(*slot),
                _ => wanted.push(program.layout.indicators + k),
            }
        }
        let between = [&tapes.rhs[..], &tapes.roots, &tapes.outputs];
        // The selection of states reads all variables.
        let selects = !program.state_sets.is_empty();
        let arriving = match selects {
            true => between.concat(),
            false => needed(program, &between, &wanted),
        };
        let moving = written(program, &arriving);
        wanted.extend(program.events.reinits.iter().map(|r| r.value));
        if !selects {
            let code = needed(program, &[&tapes.event], &wanted);
            tangents.restrict(&tapes.event, code);
        }
        let layout = &program.layout;
        let mut carried = written(program, &tapes.event);
        carried.extend(written(program, &tapes.discrete));
        carried.extend(layout.pre.iter().flat_map(|(_, slot, pre)| [*slot, *pre]));
        carried.extend(program.events.reinits.iter().map(|r| r.state));
        carried.sort_unstable();
        carried.dedup();
        carried.retain(|c| selects || read[*c as usize] || is_source(program, *c));
        AtEvents { arriving, moving, carried, kept: Vec::new() }
    }

    /// Remembers the derivatives that the event sequence changes.
    pub fn keep(&mut self, tangents: &Tangents) {
        self.kept.clear();
        for slot in &self.carried {
            self.kept.extend_from_slice(tangents.of(*slot));
        }
    }

    /// Restores them.
    pub fn restore(&self, tangents: &mut Tangents) {
        let kept = self.kept.chunks_exact(tangents.directions());
        for (slot, derivatives) in self.carried.iter().zip(kept) {
            tangents.of_mut(*slot).copy_from_slice(derivatives);
        }
    }

    /// Adds to each derivative a multiple of the rate, which is the derivative in the last direction: one multiple for
    /// each of the others.
    pub fn shift(&self, program: &Program, tangents: &mut Tangents, multiples: &[f64]) {
        let layout = &program.layout;
        let along = tangents.directions() - 1;
        let states = layout.states..layout.states + program.order() as Slot;
        let signals = layout.signals.iter().map(|(.., slot)| *slot);
        let moving = self.moving.iter().copied().filter(|c| !states.contains(c));
        for slot in states.clone().chain([layout.time]).chain(signals).chain(moving) {
            let derivatives = tangents.of_mut(slot);
            let rate = derivatives[along];
            if rate != 0.0 {
                derivatives.iter_mut().zip(multiples).for_each(|(d, m)| *d += rate * m);
            }
        }
    }
}

/// True for the source of a left limit.
fn is_source(program: &Program, slot: Slot) -> bool {
    program.layout.pre.iter().any(|(_, own, _)| *own == slot)
}
