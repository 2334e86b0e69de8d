//! What of a program becomes machine code.

use crate::ir::expr::Unary;
use crate::ir::program::{CallSite, FunctionCode, Instr, Op, Program, Slot, Solver};

/// A linear block of one unknown, which needs no solver: `z = -r(0) / J`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Quotient {
    /// Cell of the unknown.
    pub unknown: Slot,
    /// Cell of the residual.
    pub residual: Slot,
    /// Cell of its derivative.
    pub pivot: Slot,
    /// Number of the tape that computes the residual.
    pub residual_tape: u32,
    /// Number of the tape that computes its derivative.
    pub jacobian_tape: u32,
}

/// A copy of the tapes of a program and of what they refer to, for a thread of its own; and to know
/// the program again.
#[derive(Clone, PartialEq, Debug)]
pub struct Source {
    /// All tapes, by number.
    pub tapes: Vec<Vec<Instr>>,
    /// Functions.
    pub functions: Vec<FunctionCode>,
    /// Which of them are interpreted: those that call themselves, and their callers.
    pub interpreted: Vec<bool>,
    /// Calls.
    pub calls: Vec<CallSite>,
    /// Torn blocks, where they are quotients.
    pub quotients: Vec<Option<Quotient>>,
    /// Cells of literals and their values.
    pub literals: Vec<(Slot, f64)>,
    /// Number of cells.
    pub cells: usize,
}

impl Source {
    /// Of a program.
    pub fn of(program: &Program) -> Source {
        let interpreted = interpreted(program);
        Source {
            tapes: program.tapes().into_iter().map(|(_, tape)| tape.to_vec()).collect(),
            functions: program.functions.clone(),
            calls: program.calls.clone(),
            quotients: program.solvers.iter().map(|s| quotient(program, &interpreted, s)).collect(),
            interpreted,
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
            && program
                .solvers
                .iter()
                .map(|s| quotient(program, &self.interpreted, s))
                .eq(self.quotients.iter().copied())
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

/// The functions that machine code does not call.
fn interpreted(program: &Program) -> Vec<bool> {
    let mut found: Vec<bool> = program.functions.iter().map(|f| f.recurs).collect();
    loop {
        let calls = |i: &Instr| i.op == Op::Call && found[program.calls[i.a as usize].function];
        let next = |f: &FunctionCode| !f.recurs && f.tape.iter().any(calls);
        let more: Vec<usize> =
            (0..found.len()).filter(|k| !found[*k] && next(&program.functions[*k])).collect();
        if more.is_empty() {
            return found;
        }
        more.into_iter().for_each(|k| found[k] = true);
    }
}

fn quotient(program: &Program, interpreted: &[bool], solver: &Solver) -> Option<Quotient> {
    let (&[unknown], &[residual], [entry]) =
        (&solver.slots[..], &solver.residuals[..], &solver.jacobian[..])
    else {
        return None;
    };
    let tapes = [&solver.residual_tape, &solver.jacobian_tape];
    let straight = |i: &Instr| match i.op {
        Op::Solve | Op::Implicit | Op::Repeat | Op::Unary(Unary::Carried(_)) => false,
        Op::Call => !interpreted[program.calls[i.a as usize].function],
        _ => true,
    };
    let simple = solver.linear && tapes.iter().all(|tape| tape.iter().all(straight));
    simple.then_some(Quotient {
        unknown,
        residual,
        pivot: entry.slot,
        residual_tape: solver.residual_tape.number?,
        jacobian_tape: solver.jacobian_tape.number?,
    })
}

fn literals(program: &Program) -> impl Iterator<Item = (Slot, f64)> {
    program.literals.iter().map(|&slot| (slot, program.image[slot as usize]))
}
