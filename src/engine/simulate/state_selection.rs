//! Dynamic state selection.
//!
//! After each step the constraints are differentiated: how strongly do dependent candidates react
//! to the selected states? If a derivative exceeds [`LIMIT`], states are selected again. The new
//! selection is so well conditioned that it does not alternate with the old one.

use crate::ir::program::Program;
use crate::numeric::maxvol::Basis;
use crate::runtime::machine::{Fault, Machine};

/// Largest tolerated derivative of a dependent candidate with respect to a state, both in units of
/// their nominal value.
pub const LIMIT: f64 = 2.0;

/// The current selection.
#[derive(Clone)]
pub struct StateSelector {
    dependent: Vec<Basis>,
    matrix: Vec<f64>,
}

impl StateSelector {
    /// Starts from the selection of the compiler and improves it. All variables must be in the
    /// memory.
    pub fn begin(machine: &mut Machine<'_>) -> Result<StateSelector, Fault> {
        let program = machine.program;
        let mut dependent = Vec::new();
        let mut largest = 0;
        for set in &program.blocks.state_sets {
            let (rows, columns) = (set.constraints.len(), set.candidates.len());
            largest = largest.max(rows * columns);
            dependent.push(Basis::new(rows, columns, set.dependent.clone()));
        }
        let mut selection = StateSelector { dependent, matrix: vec![0.0; largest] };
        selection.improve(machine)?;
        selection.apply(machine);
        Ok(selection)
    }

    /// True if there is nothing to select.
    pub fn is_empty(&self) -> bool {
        self.dependent.is_empty()
    }

    /// Updates the selection if necessary, and the states in the memory; true if it changed. All
    /// variables must be in the memory.
    pub fn update(&mut self, machine: &mut Machine<'_>) -> Result<bool, Fault> {
        let changed = self.improve(machine)?;
        if changed {
            self.apply(machine);
            machine.run(&machine.program.tapes.discrete)?;
        }
        Ok(changed)
    }

    fn improve(&mut self, machine: &mut Machine<'_>) -> Result<bool, Fault> {
        let program: &Program = machine.program;
        machine.run(&program.tapes.state_selection)?;
        let mut changed = false;
        let sets = program.state_sets.iter().zip(&program.blocks.state_sets);
        for (basis, (slots, set)) in self.dependent.iter_mut().zip(sets) {
            let columns = slots.candidates.len();
            let matrix = &mut self.matrix[..set.constraints.len() * columns];
            matrix.fill(0.0);
            for e in &slots.jacobian {
                let j = e.column as usize;
                let nominal = machine.get(slots.nominals[j]).abs();
                let nominal = if nominal > 0.0 && nominal.is_finite() { nominal } else { 1.0 };
                matrix[e.row as usize * columns + j] =
                    machine.get(e.slot) * nominal / set.wishes[j];
            }
            changed |= basis.improve(matrix, LIMIT);
        }
        Ok(changed)
    }

    /// Writes the selection and the states.
    fn apply(&self, machine: &mut Machine<'_>) {
        for (basis, slots) in self.dependent.iter().zip(&machine.program.state_sets) {
            let columns = slots.candidates.len();
            for slot in &slots.selection {
                machine.set(*slot, 0.0);
            }
            let free = (0..columns).filter(|j| !basis.chosen().contains(j));
            for (i, j) in free.enumerate().take(slots.states.len()) {
                machine.set(slots.selection[i * columns + j], 1.0);
                machine.copy(slots.states[i], slots.candidates[j]);
            }
        }
    }
}

crate::base::wire::wire_struct!(StateSelector { dependent, matrix });
