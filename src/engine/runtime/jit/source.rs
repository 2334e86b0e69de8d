//! The part of a program that is compiled to machine code.

use std::sync::Arc;

use crate::ir::expr::Unary;
use crate::ir::external::Externals;
use crate::ir::program::{CallSite, FunctionCode, Instr, Op, Program, Slot, TornBlock};

/// A linear block with one unknown, solved by a division: `z = -r(0) / J`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ScalarBlock {
    /// Slot of the unknown.
    pub unknown: Slot,
    /// Slot of the residual.
    pub residual: Slot,
    /// Slot of its derivative.
    pub pivot: Slot,
    /// Number of the tape that computes the residual.
    pub residual_tape: u32,
    /// Number of the tape that computes its derivative.
    pub jacobian_tape: u32,
}

/// A copy of the tapes of a program and of everything they refer to, for use in another thread and
/// to recognize the program.
#[derive(Clone, PartialEq, Debug)]
pub struct Source {
    /// All tapes, by number.
    pub tapes: Vec<Vec<Instr>>,
    /// Functions.
    pub functions: Vec<FunctionCode>,
    /// Functions that are interpreted: recursive ones and their callers.
    pub interpreted: Vec<bool>,
    /// Calls.
    pub calls: Vec<CallSite>,
    /// Torn blocks that are linear in a single unknown.
    pub scalar_blocks: Vec<Option<ScalarBlock>>,
    /// Slots of literals and their values.
    pub literals: Vec<(Slot, f64)>,
    /// External functions.
    pub externals: Arc<Externals>,
    /// Number of slots.
    pub slots: usize,
}

impl Source {
    /// Copies the parts of a program.
    pub fn of(program: &Program) -> Source {
        let interpreted = interpreted(program);
        Source {
            tapes: program.all_tapes().into_iter().map(|(_, tape)| tape.to_vec()).collect(),
            functions: program.routines.functions.clone(),
            calls: program.routines.calls.clone(),
            scalar_blocks: program
                .routines
                .torn_blocks
                .iter()
                .map(|s| scalar_block(program, &interpreted, s))
                .collect(),
            interpreted,
            literals: literals(program).collect(),
            externals: program.externals().clone(),
            slots: program.image.len(),
        }
    }

    /// True if the program is identical.
    pub fn is_of(&self, program: &Program) -> bool {
        let tapes = program.all_tapes();
        tapes.len() == self.tapes.len()
            && tapes.iter().zip(&self.tapes).all(|((_, own), copy)| ***own == **copy)
            && program.routines.functions == self.functions
            && program.routines.calls == self.calls
            && program
                .routines
                .torn_blocks
                .iter()
                .map(|s| scalar_block(program, &self.interpreted, s))
                .eq(self.scalar_blocks.iter().copied())
            && literals(program)
                .map(|(slot, value)| (slot, value.to_bits()))
                .eq(self.literals.iter().map(|(slot, value)| (*slot, value.to_bits())))
            && *program.externals() == self.externals
            && program.image.len() == self.slots
    }

    /// Number of instructions.
    pub fn size(&self) -> usize {
        let tapes: usize = self.tapes.iter().map(Vec::len).sum();
        tapes + self.functions.iter().map(|f| f.tape.len()).sum::<usize>()
    }
}

/// The functions that must be interpreted.
fn interpreted(program: &Program) -> Vec<bool> {
    let mut found: Vec<bool> = program.routines.functions.iter().map(|f| f.is_recursive).collect();
    loop {
        let calls =
            |i: &Instr| i.op == Op::Call && found[program.routines.calls[i.a as usize].function];
        let next = |f: &FunctionCode| !f.is_recursive && f.tape.iter().any(calls);
        let more: Vec<usize> = (0..found.len())
            .filter(|k| !found[*k] && next(&program.routines.functions[*k]))
            .collect();
        if more.is_empty() {
            return found;
        }
        more.into_iter().for_each(|k| found[k] = true);
    }
}

fn scalar_block(
    program: &Program,
    interpreted: &[bool],
    torn_block: &TornBlock,
) -> Option<ScalarBlock> {
    let (&[unknown], &[residual], [entry]) =
        (&torn_block.slots[..], &torn_block.residuals[..], &torn_block.jacobian[..])
    else {
        return None;
    };
    let tapes = [&torn_block.residual_tape, &torn_block.jacobian_tape];
    let straight = |i: &Instr| match i.op {
        Op::Solve | Op::Differentiate | Op::Iterate | Op::Unary(Unary::Carried(_)) => false,
        Op::Call => !interpreted[program.routines.calls[i.a as usize].function],
        _ => true,
    };
    let simple = torn_block.linear && tapes.iter().all(|tape| tape.iter().all(straight));
    simple.then_some(ScalarBlock {
        unknown,
        residual,
        pivot: entry.slot,
        residual_tape: torn_block.residual_tape.number?,
        jacobian_tape: torn_block.jacobian_tape.number?,
    })
}

fn literals(program: &Program) -> impl Iterator<Item = (Slot, f64)> {
    program.literals.iter().map(|&slot| (slot, program.image[slot as usize]))
}
