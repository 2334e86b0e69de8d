//! The contract of [`Program`]: slots and jumps exist, temporaries are written before they are read, and the
//! pattern of the Jacobian covers what the derivatives read.

use crate::ir::builtin::Shape;
use crate::ir::expr::Binary;
use crate::ir::program::{Instr, Op, Program, Slot, Tape};

/// Everything in which a program breaks its contract.
pub fn check(program: &Program) -> Vec<String> {
    if let Err(why) = program.verify() {
        // What follows reads slots.
        return vec![why];
    }
    let mut found = Vec::new();
    unwritten(program, &mut found);
    pattern(program, &mut found);
    found
}

/// The slots that an instruction reads. `CopyIf` keeps what it does not overwrite.
fn reads(i: &Instr) -> impl Iterator<Item = Slot> {
    let all = match i.op {
        Op::Copy | Op::Neg | Op::Unary(_) => [Some(i.a), None, None],
        Op::CopyIf => [Some(i.dst), Some(i.a), Some(i.b)],
        Op::Input | Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Binary(_) => {
            [Some(i.a), Some(i.b), None]
        }
        Op::JumpUnless | Op::Assert => [Some(i.a), None, None],
        Op::Solve | Op::Differentiate | Op::Iterate | Op::Call | Op::Jump => [None; 3],
    };
    all.into_iter().flatten()
}

fn computes(i: &Instr) -> bool {
    !matches!(
        i.op,
        Op::Solve
            | Op::Differentiate
            | Op::Iterate
            | Op::Call
            | Op::Jump
            | Op::JumpUnless
            | Op::Assert
    )
}

/// What writes a slot.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Writer {
    /// No instruction.
    None,
    /// Instructions of this tape alone.
    Tape(usize),
    /// The run, a routine, or several tapes.
    Shared,
}

/// A slot that one tape alone writes is a temporary of it: it must be written before it is read there.
fn unwritten(program: &Program, found: &mut Vec<String>) {
    let tapes = program.all_tapes();
    let mut writers = vec![Writer::None; program.image.len()];
    for (k, (_, tape)) in tapes.iter().enumerate() {
        for i in tape.iter().filter(|i| computes(i)) {
            let writer = &mut writers[i.dst as usize];
            *writer = match *writer {
                Writer::None => Writer::Tape(k),
                Writer::Tape(other) if other == k => Writer::Tape(k),
                _ => Writer::Shared,
            };
        }
    }
    for slot in lasting(program) {
        writers[slot as usize] = Writer::Shared;
    }
    let mut written = vec![false; program.image.len()];
    for (k, (name, tape)) in tapes.iter().enumerate() {
        for (at, i) in tape.iter().enumerate() {
            for slot in reads(i) {
                if writers[slot as usize] == Writer::Tape(k) && !written[slot as usize] {
                    found.push(format!("instruction {at} of `{name}` reads slot {slot} too early"));
                }
            }
            if computes(i) {
                written[i.dst as usize] = true;
            }
        }
    }
}

/// Slots that keep their values from one run of a tape to the next.
fn lasting(program: &Program) -> Vec<Slot> {
    let (layout, routines) = (&program.layout, &program.routines);
    let relations = program.blocks.dae.relations.len() as Slot;
    let mut all = vec![layout.time, layout.initial, layout.terminal];
    all.extend(&layout.variables);
    all.extend(layout.states..layout.states + program.order() as Slot);
    for first in [layout.relations, layout.candidates, layout.indicators] {
        all.extend(first..first + relations);
    }
    all.extend(layout.pre.iter().flat_map(|(_, slot, pre)| [*slot, *pre]));
    all.extend(layout.starts.iter().flat_map(|(_, input, start)| [*input, *start]));
    for block in &routines.torn_blocks {
        all.extend(block.slots.iter().chain(&block.residuals));
    }
    all.extend(routines.block_derivatives.iter().flat_map(|d| &d.results));
    for site in &routines.calls {
        all.extend(&site.results);
        if let Some(first) = site.memo {
            all.extend(first..first + site.args.len() as Slot);
        }
    }
    all
}

/// Programs with more tangents than this are not followed.
const MOST_TANGENTS: usize = 2_000_000;

/// A tangent below this part of the largest one is what rounding leaves of zero.
const ROUNDING: f64 = 1e-9;

/// The entries are in order, exist, and cover the derivatives.
fn pattern(program: &Program, found: &mut Vec<String>) {
    let order = program.order();
    let entries: Vec<(u32, u32)> =
        program.jacobian_entries.iter().map(|e| (e.row, e.column)).collect();
    if entries.windows(2).any(|pair| pair[0] >= pair[1]) {
        found.push("entries of the Jacobian are not in order".to_owned());
    }
    if entries.iter().any(|(row, column)| (*row.max(column)) as usize >= order) {
        found.push("an entry of the Jacobian lies outside".to_owned());
    }
    if order * program.image.len() > MOST_TANGENTS {
        return;
    }
    let tangents = Tangents::of(program, &program.tapes.rhs);
    for (row, slot) in program.layout.derivatives.iter().enumerate() {
        for column in tangents.columns(*slot) {
            if entries.binary_search(&(row as u32, column as u32)).is_err() {
                found.push(format!("the Jacobian has no entry ({row}, {column})"));
            }
        }
    }
}

/// The derivatives of each slot by each state, at a point of no meaning: what is not zero there has an entry.
///
/// Instructions are followed as they stand on the tape. Torn blocks and calls are not: their results count as
/// constant, which may hide a derivative and never makes one up, because no derivative of theirs is a literal
/// that another could cancel.
struct Tangents {
    order: usize,
    values: Vec<f64>,
    by_slot: Vec<f64>,
}

impl Tangents {
    fn of(program: &Program, tape: &Tape) -> Tangents {
        let order = program.order();
        // Literals keep their values: their sums may cancel.
        let mut values: Vec<f64> =
            (0..program.image.len()).map(|slot| 0.5 + arbitrary(slot as u64)).collect();
        for slot in &program.literals {
            values[*slot as usize] = program.image[*slot as usize];
        }
        let mut by_slot = vec![0.0; order * program.image.len()];
        for column in 0..order {
            by_slot[(program.layout.states as usize + column) * order + column] = 1.0;
        }
        let mut all = Tangents { order, values, by_slot };
        tape.iter().for_each(|i| all.follow(i));
        all
    }

    fn follow(&mut self, i: &Instr) {
        let (a, b) = (self.values[i.a as usize], self.values[i.b as usize]);
        let other = 0.5 + arbitrary(u64::from(i.dst) + u64::from(i.a) * 31);
        let (value, keep, by_a, by_b) = match i.op {
            Op::Copy => (a, 0.0, 1.0, 0.0),
            Op::Neg => (-a, 0.0, -1.0, 0.0),
            Op::Add => (a + b, 0.0, 1.0, 1.0),
            Op::Sub => (a - b, 0.0, 1.0, -1.0),
            Op::Mul => (a * b, 0.0, b, a),
            Op::Div => (a / b, 0.0, 1.0 / b, -a / (b * b)),
            // Either branch.
            Op::CopyIf => (self.values[i.dst as usize], 1.0, 0.0, other),
            Op::Input => (a, 0.0, 0.0, 0.0),
            Op::Unary(op) if moves(op.facts().map(|row| row.shape)) => (other, 0.0, other, 0.0),
            Op::Binary(Binary::Pow) => (other, 0.0, other, 0.0),
            Op::Binary(op) if moves(op.facts().map(|row| row.shape)) => {
                (other, 0.0, other, 1.0 - other / 7.0)
            }
            Op::Unary(_) | Op::Binary(_) => (other, 0.0, 0.0, 0.0),
            _ => return,
        };
        self.values[i.dst as usize] = value;
        for column in 0..self.order {
            let at = |slot: Slot| slot as usize * self.order + column;
            let of = |factor: f64, slot: Slot| match self.by_slot[at(slot)] {
                0.0 => 0.0,
                tangent => factor * tangent,
            };
            let tangent = of(keep, i.dst) + of(by_a, i.a) + of(by_b, i.b);
            self.by_slot[at(i.dst)] = tangent;
        }
    }

    /// The states by which a slot has a derivative.
    fn columns(&self, slot: Slot) -> impl Iterator<Item = usize> {
        let row = &self.by_slot[slot as usize * self.order..][..self.order];
        let least = ROUNDING * row.iter().fold(1.0, |most: f64, t| most.max(t.abs()));
        (0..self.order).filter(move |k| row[*k].is_finite() && row[*k].abs() > least)
    }
}

/// A number between 0 and 1 that differs from slot to slot.
fn arbitrary(slot: u64) -> f64 {
    let bits = slot.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Whether a value has a derivative by its operands.
fn moves(shape: Option<Shape>) -> bool {
    matches!(shape, Some(Shape::Smooth | Shape::Kink | Shape::Remainder(_)))
}
