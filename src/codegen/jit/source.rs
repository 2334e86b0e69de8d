//! What of a program becomes machine code.

use crate::ir::program::{CallSite, FunctionCode, Instr, Program, Slot};

/// A copy of the tapes of a program and of what they refer to, for a thread of its own; and to know
/// the program again.
#[derive(Clone, PartialEq, Debug)]
pub struct Source {
    /// All tapes, by number.
    pub tapes: Vec<Vec<Instr>>,
    /// Functions.
    pub functions: Vec<FunctionCode>,
    /// Calls.
    pub calls: Vec<CallSite>,
    /// Cells of literals and their values.
    pub literals: Vec<(Slot, f64)>,
    /// Number of cells.
    pub cells: usize,
}

impl Source {
    /// Of a program.
    pub fn of(program: &Program) -> Source {
        Source {
            tapes: program.tapes().into_iter().map(|(_, tape)| tape.to_vec()).collect(),
            functions: program.functions.clone(),
            calls: program.calls.clone(),
            literals: literals(program).collect(),
            cells: program.image.len(),
        }
    }

    /// True if the program does exactly this.
    pub fn is_of(&self, program: &Program) -> bool {
        let tapes = program.tapes();
        tapes.len() == self.tapes.len()
            && tapes.iter().zip(&self.tapes).all(|((_, own), copy)| ***own == **copy)
            && program.functions == self.functions
            && program.calls == self.calls
            && literals(program)
                .map(|(slot, value)| (slot, value.to_bits()))
                .eq(self.literals.iter().map(|(slot, value)| (*slot, value.to_bits())))
            && program.image.len() == self.cells
    }

    /// Number of instructions.
    pub fn size(&self) -> usize {
        let tapes: usize = self.tapes.iter().map(Vec::len).sum();
        tapes + self.functions.iter().map(|f| f.tape.len()).sum::<usize>()
    }
}

fn literals(program: &Program) -> impl Iterator<Item = (Slot, f64)> {
    program.literals.iter().map(|&slot| (slot, program.image[slot as usize]))
}
