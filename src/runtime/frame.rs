//! Functions that call themselves: their cells are fixed, so what stands there is put aside for each call in
//! which another one is made.

use crate::ir::program::{CallSite, Program, Slot};

/// So many numbers are put aside at most (128 MB).
const MOST: usize = 1 << 24;

/// The calls in which a function has called itself, innermost last.
#[derive(Default)]
pub struct Frames {
    open: Vec<Open>,
    /// What stood in the cells.
    values: Vec<f64>,
}

struct Open {
    /// The call that is being made.
    site: usize,
    /// Where it goes on after it: the function, and the position of the instruction.
    back: (usize, usize),
    /// Where its values begin.
    first: usize,
}

impl Frames {
    /// How many calls are open.
    pub fn depth(&self) -> usize {
        self.open.len()
    }

    /// Calls in the midst of a function, to go on at `back`. Each cell has `width` numbers. False if there
    /// are too many calls.
    #[must_use]
    pub fn enter(
        &mut self,
        program: &Program,
        site: usize,
        back: (usize, usize),
        cells: &mut [f64],
        width: usize,
    ) -> bool {
        let CallSite { function, args, .. } = &program.calls[site];
        let function = &program.functions[*function];
        let place = |slot: Slot| slot as usize * width..(slot as usize + 1) * width;
        let first = self.values.len();
        let frame = function.frame.start as usize * width..function.frame.end as usize * width;
        if first + frame.len() > MOST {
            return false;
        }
        self.values.extend_from_slice(&cells[frame]);
        // Arguments may stand in cells of inputs.
        let arguments = self.values.len();
        args.iter().for_each(|a| self.values.extend_from_slice(&cells[place(*a)]));
        function.locals.iter().for_each(|l| cells[place(*l)].fill(0.0));
        for (to, value) in function.inputs.iter().zip(self.values[arguments..].chunks(width)) {
            cells[place(*to)].copy_from_slice(value);
        }
        self.values.truncate(arguments);
        self.open.push(Open { site, back, first });
        true
    }

    /// Returns from the innermost call, with its results: where to go on.
    pub fn leave(
        &mut self,
        program: &Program,
        cells: &mut [f64],
        width: usize,
    ) -> Option<(usize, usize)> {
        let Open { site, back, first } = self.open.pop()?;
        let CallSite { function, results, .. } = &program.calls[site];
        let function = &program.functions[*function];
        let place = |slot: Slot| slot as usize * width..(slot as usize + 1) * width;
        let outputs = self.values.len();
        function.outputs.iter().for_each(|o| self.values.extend_from_slice(&cells[place(*o)]));
        let start = function.frame.start as usize * width;
        cells[start..start + outputs - first].copy_from_slice(&self.values[first..outputs]);
        for (to, value) in results.iter().zip(self.values[outputs..].chunks(width)) {
            cells[place(*to)].copy_from_slice(value);
        }
        self.values.truncate(first);
        Some(back)
    }

    /// Gives up all calls but the first so many.
    pub fn give_up(&mut self, depth: usize) {
        if let Some(first) = self.open.get(depth) {
            self.values.truncate(first.first);
            self.open.truncate(depth);
        }
    }
}
