//! Compiles the criterion of dynamic state selection: derivatives of the constraints with respect
//! to the candidates.

use crate::base::index::Id;
use crate::ir::blocks::StateSet;
use crate::ir::program::{Entry, StateSetSlots, Tape};

use super::block::nominal;
use super::emit::{CONTINUOUS, DISCRETE, Emitter, PARAMETER};

/// Compiles the derivatives of the constraints; reads all variables from the memory.
pub fn compile(e: &mut Emitter, sets: &[StateSet]) -> (Tape, Vec<StateSetSlots>) {
    if sets.is_empty() {
        return (Tape::default(), Vec::new());
    }
    for level in e.levels.iter_mut().filter(|level| **level != Some(PARAMETER)) {
        *level = Some(DISCRETE);
    }
    e.continuous_level = DISCRETE;
    e.push_layer();
    e.floor = DISCRETE;
    let slots = sets.iter().map(|set| set_slots(e, set)).collect();
    let tape = e.pop_discard();
    e.continuous_level = CONTINUOUS;
    (tape, slots)
}

fn set_slots(e: &mut Emitter, set: &StateSet) -> StateSetSlots {
    let mut jacobian = Vec::new();
    for &(row, column, value) in &set.jacobian {
        if let Some(constraint) = set.constraints.get(row) {
            e.span = e.dae.equations[*constraint].origin.span;
        }
        // The entry needs its own slot: its value must survive the tape.
        let slot = e.new_slot(0.0);
        e.emit_to(slot, value);
        jacobian.push(Entry { row: row as u32, column: column as u32, slot });
    }
    StateSetSlots {
        candidates: set.candidates.iter().map(|v| e.slot(*v)).collect(),
        nominals: set.candidates.iter().map(|v| nominal(e, *v)).collect(),
        states: set.states.iter().map(|v| e.slot(*v)).collect(),
        selection: set.selection.iter().map(|v| e.layout.variables[v.idx()]).collect(),
        jacobian,
    }
}
