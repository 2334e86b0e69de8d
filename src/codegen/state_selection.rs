//! What the selection of states is judged by.

use crate::base::index::Id;
use crate::ir::blocks::StateSet;
use crate::ir::program::{Entry, StateSetCells, Tape};

use super::block::nominal;
use super::emit::{Emitter, HELD, MOVING, PARAMETER};

/// Compiles the derivatives of the constraints, from variables that are all in the memory.
pub fn compile(e: &mut Emitter, sets: &[StateSet]) -> (Tape, Vec<StateSetCells>) {
    if sets.is_empty() {
        return (Tape::default(), Vec::new());
    }
    for level in e.levels.iter_mut().filter(|level| **level != Some(PARAMETER)) {
        *level = Some(HELD);
    }
    e.moving = HELD;
    e.push_layer();
    e.floor = HELD;
    let cells = sets.iter().map(|set| set_cells(e, set)).collect();
    let tape = e.pop_discard();
    e.moving = MOVING;
    (tape, cells)
}

fn set_cells(e: &mut Emitter, set: &StateSet) -> StateSetCells {
    let mut jacobian = Vec::new();
    for &(row, column, value) in &set.jacobian {
        if let Some(constraint) = set.constraints.get(row) {
            e.span = e.dae.equations[*constraint].origin.span;
        }
        // A cell of its own: what the tape computed must stay.
        let slot = e.cell(0.0);
        e.emit_to(slot, value);
        jacobian.push(Entry { row: row as u32, column: column as u32, slot });
    }
    StateSetCells {
        candidates: set.candidates.iter().map(|v| e.slot(*v)).collect(),
        nominals: set.candidates.iter().map(|v| nominal(e, *v)).collect(),
        states: set.states.iter().map(|v| e.slot(*v)).collect(),
        selection: set.selection.iter().map(|v| e.layout.variables[v.idx()]).collect(),
        jacobian,
    }
}
