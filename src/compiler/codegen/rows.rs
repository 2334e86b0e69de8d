//! The part of a program that the recorded variables need: a tape for rows between the steps.
//!
//! In: a program whose recorded variables are known. Out: the instructions of the derivatives,
//! indicators and outputs that recorded variables, their bounds, and assertions depend on; a
//! backward pass over straight-line code (Aho, Lam, Sethi and Ullman, *Compilers*, 2nd ed. 2007,
//! sec. 8.4.2). A cycle of a valve has three rows for each step, and a variable is often a state.

use crate::base::index::Id;
use crate::ir::expr::Unary;
use crate::ir::program::{Instr, Op, Program, Slot, Tape};

use super::recording::operands;

/// Share of the instructions of a full evaluation up to which a tape of its own pays: it must be
/// compiled too.
const WORTHWHILE: f64 = 0.5;

/// The tape; `None` if it would not be much shorter than a full evaluation, or if a loop of the
/// model starts from its last solution, which would then depend on what is recorded.
pub fn tape(program: &Program) -> Option<Tape> {
    let tapes = [&program.tapes.rhs, &program.tapes.roots, &program.tapes.outputs];
    let all = || tapes.iter().flat_map(|t| t.iter());
    if program.foreign.is_some() || !all().all(|i| is_reproducible(program, i)) {
        return None;
    }
    let mut needed = wanted(program);
    let mut code: Vec<Instr> = Vec::new();
    for instr in all().rev() {
        if !is_needed(program, instr, &needed) {
            continue;
        }
        operands_of(program, instr, &mut |slot| needed[slot as usize] = true);
        code.push(*instr);
    }
    code.reverse();
    let full = all().count();
    (code.len() as f64 <= WORTHWHILE * full as f64).then(|| Tape::from(code))
}

/// The slots that a row reads.
fn wanted(program: &Program) -> Vec<bool> {
    let mut wanted = vec![false; program.image.len()];
    let mut is_recorded = vec![false; program.blocks.dae.variables.len()];
    for v in &program.recorded {
        is_recorded[v.idx()] = true;
        wanted[program.slot(*v) as usize] = true;
    }
    let mut mark = |slot: Slot| wanted[slot as usize] = true;
    let bounds = program.bounds.iter().filter(|b| is_recorded[b.variable.idx()]);
    bounds.for_each(|b| [b.value, b.min, b.max, b.nominal].into_iter().for_each(&mut mark));
    program.events.asserts.iter().filter(|a| !a.at_events).for_each(|a| mark(a.condition));
    wanted
}

/// True if the result of an instruction depends on its operands only.
fn is_reproducible(program: &Program, instr: &Instr) -> bool {
    match instr.op {
        Op::Solve => {
            let block = &program.routines.torn_blocks[instr.a as usize];
            let tapes = [&block.residual_tape, &block.jacobian_tape];
            let is_plain = |i: &Instr| !matches!(i.op, Op::Solve | Op::Iterate | Op::Differentiate);
            // Several equations may turn out to be dependent, and then keep their values.
            block.linear
                && block.unknowns.len() == 1
                && tapes.iter().all(|t| t.iter().all(is_plain))
        }
        Op::Differentiate | Op::Iterate | Op::Unary(Unary::Carried(_)) => false,
        _ => true,
    }
}

fn is_needed(program: &Program, instr: &Instr, needed: &[bool]) -> bool {
    let is = |slot: &Slot| needed[*slot as usize];
    match instr.op {
        Op::Solve => {
            let block = &program.routines.torn_blocks[instr.a as usize];
            let tapes = [&block.residual_tape, &block.jacobian_tape];
            block.slots.iter().any(is) || tapes.iter().any(|t| t.iter().any(|i| is(&i.dst)))
        }
        Op::Call => {
            let site = &program.routines.calls[instr.a as usize];
            let body = &program.routines.functions[site.function];
            // A function that checks something is called wherever a full evaluation calls it.
            let is_silent = body.tape.iter().all(|i| !matches!(i.op, Op::Assert | Op::Call));
            !is_silent || site.results.iter().any(is)
        }
        Op::Differentiate | Op::Iterate | Op::Jump | Op::JumpUnless | Op::Assert => true,
        _ => is(&instr.dst),
    }
}

fn operands_of(program: &Program, instr: &Instr, visit: &mut impl FnMut(Slot)) {
    match instr.op {
        Op::Solve => {
            let block = &program.routines.torn_blocks[instr.a as usize];
            for tape in [&block.residual_tape, &block.jacobian_tape] {
                for i in tape.iter() {
                    match i.op {
                        Op::Call => call_operands(program, i, visit),
                        _ => operands(i, visit),
                    }
                }
            }
            let entries = block.jacobian.iter().map(|e| e.slot);
            let read = block.slots.iter().chain(&block.residuals).chain(&block.nominals);
            read.copied().chain(entries).for_each(&mut *visit);
            block.bounds.iter().flat_map(|(min, max)| [*min, *max]).for_each(visit);
        }
        Op::Call => call_operands(program, instr, visit),
        _ => operands(instr, visit),
    }
}

fn call_operands(program: &Program, instr: &Instr, visit: &mut impl FnMut(Slot)) {
    let site = &program.routines.calls[instr.a as usize];
    site.args.iter().chain(&site.condition).copied().for_each(visit);
}
