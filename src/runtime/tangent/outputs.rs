//! The instructions that some cells depend on: at most instants only these need be followed.

use super::forcing::{operands, touch};
use crate::ir::program::{Instr, Op, Program, Slot};

/// What of `tapes`, which run one after the other, the cells `wanted` depend on, in order.
pub fn needed(program: &Program, tapes: &[&[Instr]], wanted: &[Slot]) -> Vec<Instr> {
    let cells = program.image.len();
    let mut open = vec![false; cells];
    wanted.iter().for_each(|slot| open[*slot as usize] = true);
    let mut kept = Vec::new();
    for i in tapes.iter().rev().flat_map(|tape| tape.iter().rev()) {
        if matches!(i.op, Op::Solve | Op::Implicit | Op::Repeat | Op::Call) {
            let (mut writes, mut reads) = (vec![false; cells], vec![false; cells]);
            touch(program, std::slice::from_ref(i), &mut writes, &mut reads);
            if (0..cells).any(|c| open[c] && writes[c]) {
                (0..cells).filter(|c| reads[*c]).for_each(|c| open[c] = true);
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
