//! Slices of tapes: the instructions that given slots depend on.

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
        if matches!(i.op, Op::Solve | Op::Differentiate | Op::Iterate | Op::Call) {
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
