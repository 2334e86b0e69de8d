//! Derivatives of the right side with respect to inputs at constant states: the forcing term
//! `df/dp` of the variational equations.
//!
//! An input affects few instructions, so each instruction is propagated only in its active
//! directions (dependence sets in forward accumulation: A. Griewank, A. Walther, *Evaluating
//! Derivatives*, 2nd ed. 2008, sec. 7.1). The sets depend on the tangents of the memory, which
//! change at events.

use super::{Rule, Tangents, product, rule};
use crate::ir::program::{Instr, Op, Program, Slot};
use crate::runtime::input_signals::{DelayedSlots, InputSignals};
use crate::runtime::machine::{Fault, Machine};

/// Directions per word of a set.
const WORD: usize = u64::BITS as usize;

/// The derivatives of the right side in all directions.
pub struct Forcing {
    tangents: Tangents,
    /// Instructions with active directions.
    active: Vec<ActiveInstruction>,
    /// The active directions of all of them, concatenated.
    directions: Vec<u16>,
    /// Words per set.
    words: usize,
    /// For each slot, the set of directions it depends on.
    sets: Vec<u64>,
    /// Slots that the tape reads but does not write.
    read: Vec<Slot>,
    /// Slots that it writes.
    written: Vec<Slot>,
}

/// An instruction with its active directions.
struct ActiveInstruction {
    instr: Instr,
    /// Start of its directions.
    first: u32,
    /// Number of its directions; zero for blocks and calls, which propagate all directions.
    count: u32,
}

impl Forcing {
    /// Working memory for the right side of a program.
    pub fn new(program: &Program, directions: usize) -> Self {
        let slots = program.image.len();
        let words = directions.div_ceil(WORD).max(1);
        let (mut writes, mut reads) = (vec![false; slots], vec![false; slots]);
        mark_accesses(program, &program.tapes.rhs, &mut writes, &mut reads);
        // A derivative may be the slot of a parameter.
        program.layout.derivatives.iter().for_each(|slot| reads[*slot as usize] = true);
        let active_directions = |wanted: &dyn Fn(usize) -> bool| -> Vec<Slot> {
            (0..slots).filter(|c| wanted(*c)).map(|c| c as Slot).collect()
        };
        Forcing {
            tangents: Tangents::new(slots, directions),
            active: Vec::new(),
            directions: Vec::new(),
            words,
            sets: vec![0; slots * words],
            read: active_directions(&|c| reads[c] && !writes[c]),
            written: active_directions(&|c| writes[c]),
        }
    }

    /// Copies the tangents of the memory, except those of time and states, and finds the active
    /// directions of each instruction. `from` may have additional directions.
    pub fn prepare(&mut self, program: &Program, from: &Tangents, signals: &InputSignals) {
        let (words, layout) = (self.words, &program.layout);
        let directions = self.tangents.directions;
        self.sets.fill(0);
        for slot in &self.written {
            self.tangents.clear(*slot);
        }
        let states = layout.states..layout.states + program.order() as Slot;
        // Delayed signals move with their delay, at whatever rate.
        let source = |slot: Slot| {
            signals.delayed().find(|s| s.value == slot).map_or(slot, |delayed| delayed.delay)
        };
        let mut all = vec![0u64; words];
        for slot in self.read.iter().filter(|s| **s != layout.time && !states.contains(s)) {
            let derivatives = &from.of(source(*slot))[..directions];
            self.tangents.of_mut(*slot).copy_from_slice(derivatives);
            let at = *slot as usize * words;
            for (direction, d) in derivatives.iter().enumerate() {
                if *d != 0.0 {
                    self.sets[at + direction / WORD] |= 1 << (direction % WORD);
                }
            }
            all.iter_mut().zip(&self.sets[at..at + words]).for_each(|(a, s)| *a |= s);
        }
        self.active.clear();
        self.directions.clear();
        let mut set = vec![0u64; words];
        for i in program.tapes.rhs.iter() {
            if matches!(i.op, Op::Solve | Op::Differentiate | Op::Iterate | Op::Call) {
                self.active.push(ActiveInstruction { instr: *i, first: 0, count: 0 });
                let slots = self.sets.len() / words;
                let (mut writes, mut reads) = (vec![false; slots], vec![false; slots]);
                mark_accesses(program, std::slice::from_ref(i), &mut writes, &mut reads);
                for cell in (0..slots).filter(|c| writes[*c]) {
                    self.sets[cell * words..(cell + 1) * words].copy_from_slice(&all);
                }
                continue;
            }
            set.fill(0);
            for slot in operands(i).into_iter().flatten() {
                let at = slot as usize * words;
                set.iter_mut().zip(&self.sets[at..at + words]).for_each(|(a, s)| *a |= s);
            }
            let first = self.directions.len() as u32;
            for (word, bits) in set.iter().enumerate() {
                let mut bits = *bits;
                while bits != 0 {
                    self.directions.push((word * WORD) as u16 + bits.trailing_zeros() as u16);
                    bits &= bits - 1;
                }
            }
            let count = self.directions.len() as u32 - first;
            if count > 0 {
                self.active.push(ActiveInstruction { instr: *i, first, count });
            }
            let at = i.dst as usize * words;
            self.sets[at..at + words].copy_from_slice(&set);
        }
    }

    /// Sets the derivatives of delayed signals at the instant that has been evaluated.
    pub fn delay_signals(&mut self, machine: &Machine<'_>, from: &Tangents) {
        for DelayedSlots { value, rate, delay } in machine.input_signals.delayed() {
            let rate = machine.get(rate);
            let own = self.tangents.of_mut(value).iter_mut();
            own.zip(from.of(delay)).for_each(|(d, of_delay)| *d = -rate * of_delay);
        }
    }

    /// Propagates derivatives along the right side, which has just been evaluated.
    pub fn propagate(&mut self, machine: &mut Machine<'_>) -> Result<(), Fault> {
        let Forcing { tangents, active, directions, .. } = self;
        let width = tangents.width;
        for ActiveInstruction { instr: i, first, count } in active.iter() {
            if *count == 0 {
                tangents.propagate(machine, std::slice::from_ref(i))?;
                continue;
            }
            let active_directions = &directions[*first as usize..(*first + *count) as usize];
            if 2 * active_directions.len() > width || super::hides_derivatives(machine, i) {
                tangents.propagate_instruction(machine, i);
                continue;
            }
            let values = &mut tangents.values;
            let dst = i.dst as usize * width;
            let [a, b] = [i.a, i.b].map(|slot| slot as usize * width);
            let each = active_directions.iter().map(|d| *d as usize);
            match rule(machine, i) {
                Rule::Keep => {}
                Rule::Clear => each.for_each(|d| values[dst + d] = 0.0),
                Rule::Copy(from) => {
                    let from = from as usize * width;
                    each.for_each(|d| values[dst + d] = values[from + d]);
                }
                Rule::Scale(factor) => {
                    each.for_each(|d| values[dst + d] = product(factor, values[a + d]));
                }
                Rule::Combine(by_a, by_b) => each.for_each(|d| {
                    values[dst + d] = product(by_a, values[a + d]) + product(by_b, values[b + d]);
                }),
            }
        }
        Ok(())
    }

    /// For each direction, whether derivatives in it are not known.
    pub fn hidden(&self) -> &[bool] {
        self.tangents.hidden()
    }

    /// The derivatives of a slot.
    pub fn of(&self, slot: Slot) -> &[f64] {
        self.tangents.of(slot)
    }
}

/// The slots on whose derivatives the derivatives of the result depend.
pub(super) fn operands(i: &Instr) -> [Option<Slot>; 3] {
    match i.op {
        Op::Copy | Op::Neg | Op::Unary(_) => [Some(i.a), None, None],
        // The old value remains if the condition is false.
        Op::CopyIf => [Some(i.b), Some(i.dst), None],
        _ => [Some(i.a), Some(i.b), None],
    }
}

/// Marks the slots that a tape writes and reads, including everything it calls.
pub(super) fn mark_accesses(
    program: &Program,
    tape: &[Instr],
    writes: &mut [bool],
    reads: &mut [bool],
) {
    for i in tape {
        let k = i.a as usize;
        match i.op {
            Op::Solve => {
                let torn_block = &program.routines.torn_blocks[k];
                torn_block.slots.iter().for_each(|s| writes[*s as usize] = true);
                mark_accesses(program, &torn_block.residual_tape, writes, reads);
                mark_accesses(program, &torn_block.jacobian_tape, writes, reads);
            }
            Op::Differentiate => {
                let derivative = &program.routines.block_derivatives[k];
                derivative.results.iter().for_each(|s| writes[*s as usize] = true);
                derivative.seeds.iter().for_each(|e| reads[e.slot as usize] = true);
                derivative.jacobian.iter().for_each(|e| reads[e.slot as usize] = true);
            }
            Op::Iterate => {
                let mixed = &program.routines.mixed_blocks[k];
                mark_accesses(program, &mixed.decisions, writes, reads);
                mark_accesses(program, &mixed.tape, writes, reads);
            }
            Op::Call => {
                let site = &program.routines.calls[k];
                site.args.iter().chain(&site.condition).for_each(|s| reads[*s as usize] = true);
                site.results.iter().for_each(|s| writes[*s as usize] = true);
                let function = &program.routines.functions[site.function];
                let own = function.locals.iter().chain(&function.inputs).chain(&function.outputs);
                if function.is_recursive && own.clone().all(|s| writes[*s as usize]) {
                    continue;
                }
                own.for_each(|s| writes[*s as usize] = true);
                mark_accesses(program, &function.tape, writes, reads);
            }
            Op::Jump => {}
            _ => {
                for slot in operands(i).into_iter().flatten() {
                    reads[slot as usize] = true;
                }
                if !matches!(i.op, Op::JumpUnless | Op::Assert) {
                    writes[i.dst as usize] = true;
                }
            }
        }
    }
}
