//! The selection of states while the model runs.
//!
//! After each step the constraints are asked how strongly what is not selected reacts to what is.
//! As soon as a reaction exceeds [`LIMIT`] the selection is made anew; it is then so good that much
//! has to happen before the next time, so that it does not go to and fro.

use crate::ir::program::Program;
use crate::numeric::maxvol::Basis;
use crate::runtime::machine::{Fault, Instance};

/// Largest tolerated derivative of a dependent candidate by a state, both in units of their nominal
/// value.
pub const LIMIT: f64 = 2.0;

/// The states in use.
pub struct Selection {
    dependent: Vec<Basis>,
    matrix: Vec<f64>,
}

impl Selection {
    /// What the compiler would select. Variables must have their values.
    pub fn begin(instance: &mut Instance<'_>) -> Result<Selection, Fault> {
        let program = instance.program;
        let mut dependent = Vec::new();
        let mut largest = 0;
        for set in &program.blocks.state_sets {
            let (rows, columns) = (set.constraints.len(), set.candidates.len());
            largest = largest.max(rows * columns);
            dependent.push(Basis::new(rows, columns, set.dependent.clone()));
        }
        let mut selection = Selection { dependent, matrix: vec![0.0; largest] };
        selection.improve(instance)?;
        selection.apply(instance);
        Ok(selection)
    }

    /// True if there is nothing to select.
    pub fn is_empty(&self) -> bool {
        self.dependent.is_empty()
    }

    /// Selects anew if necessary; true if states changed. Variables must have their values, and the
    /// states in the memory get theirs.
    pub fn renew(&mut self, instance: &mut Instance<'_>) -> Result<bool, Fault> {
        let changed = self.improve(instance)?;
        if changed {
            self.apply(instance);
            instance.run(&instance.program.held)?;
        }
        Ok(changed)
    }

    fn improve(&mut self, instance: &mut Instance<'_>) -> Result<bool, Fault> {
        let program: &Program = instance.program;
        instance.run(&program.selection)?;
        let mut changed = false;
        let sets = program.state_sets.iter().zip(&program.blocks.state_sets);
        for (basis, (cells, set)) in self.dependent.iter_mut().zip(sets) {
            let columns = cells.candidates.len();
            let matrix = &mut self.matrix[..set.constraints.len() * columns];
            matrix.fill(0.0);
            for e in &cells.jacobian {
                let j = e.column as usize;
                let nominal = instance.get(cells.nominals[j]).abs();
                let nominal = if nominal > 0.0 && nominal.is_finite() { nominal } else { 1.0 };
                matrix[e.row as usize * columns + j] =
                    instance.get(e.slot) * nominal / set.wishes[j];
            }
            changed |= basis.improve(matrix, LIMIT);
        }
        Ok(changed)
    }

    /// Writes the selection and the states.
    fn apply(&self, instance: &mut Instance<'_>) {
        for (basis, cells) in self.dependent.iter().zip(&instance.program.state_sets) {
            let columns = cells.candidates.len();
            for cell in &cells.selection {
                instance.set(*cell, 0.0);
            }
            let free = (0..columns).filter(|j| !basis.chosen().contains(j));
            for (i, j) in free.enumerate().take(cells.states.len()) {
                instance.set(cells.selection[i * columns + j], 1.0);
                instance.copy(cells.states[i], cells.candidates[j]);
            }
        }
    }
}
