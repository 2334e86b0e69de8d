//! Slices of tapes: the instructions that given slots depend on, and what a tape reads and writes.

use super::forcing::{mark_accesses, operands};
use crate::ir::program::{Instr, Op, Program, Slot};

/// The instructions of `tapes`, executed one after the other, that the slots `wanted` depend on, in
/// order.
pub fn needed(program: &Program, tapes: &[&[Instr]], wanted: &[Slot]) -> Vec<Instr> {
    let slots = program.image.len();
    let mut open = vec![false; slots];
    wanted.iter().for_each(|slot| open[*slot as usize] = true);
    let mut kept = Vec::new();
    for i in tapes.iter().rev().flat_map(|tape| tape.iter().rev()) {
        if is_composite(i) {
            let (mut writes, mut reads) = (vec![false; slots], vec![false; slots]);
            mark_accesses(program, std::slice::from_ref(i), &mut writes, &mut reads);
            if (0..slots).any(|c| open[c] && writes[c]) {
                (0..slots).filter(|c| reads[*c]).for_each(|c| open[c] = true);
                kept.push(*i);
            }
        } else if std::mem::take(&mut open[i.dst as usize]) {
            for slot in operands(i).into_iter().flatten() {
                open[slot as usize] = true;
            }
            kept.push(*i);
        }
    }
    kept.reverse();
    kept
}

/// For each slot, whether derivatives at `tapes`, each on its own, may depend on its derivatives from before.
pub fn read_first(program: &Program, tapes: &[&[Instr]]) -> Vec<bool> {
    let slots = program.image.len();
    let mut all = vec![false; slots];
    for tape in tapes {
        let mut done = vec![false; slots];
        for i in tape.iter() {
            if is_composite(i) {
                let mut reads = vec![false; slots];
                mark_accesses(program, std::slice::from_ref(i), &mut done, &mut reads);
                (0..slots).for_each(|c| all[c] |= reads[c]);
                continue;
            }
            for slot in operands(i).into_iter().flatten() {
                all[slot as usize] |= !done[slot as usize];
            }
            done[i.dst as usize] = true;
        }
    }
    all
}

/// The slots that a tape writes, ascending.
pub fn written(program: &Program, tape: &[Instr]) -> Vec<Slot> {
    let slots = program.image.len();
    let (mut writes, mut reads) = (vec![false; slots], vec![false; slots]);
    mark_accesses(program, tape, &mut writes, &mut reads);
    (0..slots as Slot).filter(|c| writes[*c as usize]).collect()
}

fn is_composite(i: &Instr) -> bool {
    matches!(i.op, Op::Solve | Op::Differentiate | Op::Iterate | Op::Call)
}
