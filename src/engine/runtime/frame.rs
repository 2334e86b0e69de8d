//! Frames of recursive functions. The slots of a function are fixed, so a recursive call saves them
//! and restores them on return.

use crate::ir::program::{CallSite, Program, Slot};

/// Maximum number of saved values (128 MB).
const MAX_SAVED_VALUES: usize = 1 << 24;

/// The open recursive calls, innermost last.
#[derive(Default)]
pub struct Frames {
    open: Vec<Frame>,
    /// The saved slots.
    values: Vec<f64>,
}

struct Frame {
    /// The call site.
    site: usize,
    /// Return address: the function and the position of the instruction.
    back: (usize, usize),
    /// Start of its saved values.
    first: usize,
}

impl Frames {
    /// Number of open calls.
    pub fn depth(&self) -> usize {
        self.open.len()
    }

    /// Enters a recursive call that returns to `back`. Each slot has `width` values. False if the
    /// recursion is too deep.
    #[must_use]
    pub fn push(
        &mut self,
        program: &Program,
        site: usize,
        back: (usize, usize),
        slots: &mut [f64],
        width: usize,
    ) -> bool {
        let CallSite { function, args, .. } = &program.routines.calls[site];
        let function = &program.routines.functions[*function];
        let range = |slot: Slot| slot as usize * width..(slot as usize + 1) * width;
        let first = self.values.len();
        let frame = function.frame.start as usize * width..function.frame.end as usize * width;
        if first + frame.len() > MAX_SAVED_VALUES {
            return false;
        }
        self.values.extend_from_slice(&slots[frame]);
        // Arguments may be in the slots of inputs.
        let arguments = self.values.len();
        args.iter().for_each(|a| self.values.extend_from_slice(&slots[range(*a)]));
        function.locals.iter().for_each(|l| slots[range(*l)].fill(0.0));
        for (to, value) in function.inputs.iter().zip(self.values[arguments..].chunks(width)) {
            slots[range(*to)].copy_from_slice(value);
        }
        self.values.truncate(arguments);
        self.open.push(Frame { site, back, first });
        true
    }

    /// Returns from the innermost call with its results; the return address.
    pub fn pop(
        &mut self,
        program: &Program,
        slots: &mut [f64],
        width: usize,
    ) -> Option<(usize, usize)> {
        let Frame { site, back, first } = self.open.pop()?;
        let CallSite { function, results, .. } = &program.routines.calls[site];
        let function = &program.routines.functions[*function];
        let range = |slot: Slot| slot as usize * width..(slot as usize + 1) * width;
        let outputs = self.values.len();
        function.outputs.iter().for_each(|o| self.values.extend_from_slice(&slots[range(*o)]));
        let start = function.frame.start as usize * width;
        slots[start..start + outputs - first].copy_from_slice(&self.values[first..outputs]);
        for (to, value) in results.iter().zip(self.values[outputs..].chunks(width)) {
            slots[range(*to)].copy_from_slice(value);
        }
        self.values.truncate(first);
        Some(back)
    }

    /// Drops all frames above `depth`.
    pub fn unwind(&mut self, depth: usize) {
        if let Some(first) = self.open.get(depth) {
            self.values.truncate(first.first);
            self.open.truncate(depth);
        }
    }
}
