//! Derivatives of the rates by inputs while the states rest: `df/dp` of the variational equations.
//!
//! An input reaches few instructions, so each is followed only in the directions that reach it
//! (dependence sets in forward accumulation: A. Griewank, A. Walther, *Evaluating Derivatives*, 2nd ed.
//! 2008, sec. 7.1). Which these are follows from what the memory depends on, which changes at events.

use super::{Rule, Tangents, product, rule};
use crate::ir::program::{Instr, Op, Program, Slot};
use crate::runtime::machine::{Fault, Instance};

/// Directions in one word of a set.
const WORD: usize = u64::BITS as usize;

/// The derivatives of the rates in all directions.
pub struct Forcing {
    tangents: Tangents,
    /// Instructions that a direction reaches.
    reached: Vec<Reached>,
    /// The directions of all of them, one after the other.
    directions: Vec<u16>,
    /// Words of a set.
    words: usize,
    /// By cell: the directions that it depends on.
    sets: Vec<u64>,
    /// Cells that the tape reads and does not write.
    read: Vec<Slot>,
    /// Cells that it writes.
    written: Vec<Slot>,
}

/// An instruction with its directions.
struct Reached {
    instr: Instr,
    /// Where its directions begin.
    first: u32,
    /// How many they are; none: all, by rules of its own.
    count: u32,
}

impl Forcing {
    /// For the rates of a program.
    pub fn new(program: &Program, directions: usize) -> Self {
        let cells = program.image.len();
        let words = directions.div_ceil(WORD).max(1);
        let (mut writes, mut reads) = (vec![false; cells], vec![false; cells]);
        touch(program, &program.rhs, &mut writes, &mut reads);
        // A rate may be a parameter as it stands.
        program.layout.derivatives.iter().for_each(|slot| reads[*slot as usize] = true);
        let those = |wanted: &dyn Fn(usize) -> bool| -> Vec<Slot> {
            (0..cells).filter(|c| wanted(*c)).map(|c| c as Slot).collect()
        };
        Forcing {
            tangents: Tangents::new(cells, directions),
            reached: Vec::new(),
            directions: Vec::new(),
            words,
            sets: vec![0; cells * words],
            read: those(&|c| reads[c] && !writes[c]),
            written: those(&|c| writes[c]),
        }
    }

    /// Takes over on what the memory depends, time and states excepted. `from` may have further
    /// directions.
    pub fn prepare(&mut self, program: &Program, from: &Tangents) {
        let (words, layout) = (self.words, &program.layout);
        let directions = self.tangents.directions;
        self.sets.fill(0);
        for slot in &self.written {
            self.tangents.clear(*slot);
        }
        let states = layout.states..layout.states + program.order() as Slot;
        let mut all = vec![0u64; words];
        for slot in self.read.iter().filter(|s| **s != layout.time && !states.contains(s)) {
            self.tangents.of_mut(*slot).copy_from_slice(&from.of(*slot)[..directions]);
            let at = *slot as usize * words;
            for (direction, d) in self.tangents.of(*slot).iter().enumerate() {
                if *d != 0.0 {
                    self.sets[at + direction / WORD] |= 1 << (direction % WORD);
                }
            }
            all.iter_mut().zip(&self.sets[at..at + words]).for_each(|(a, s)| *a |= s);
        }
        self.reached.clear();
        self.directions.clear();
        let mut set = vec![0u64; words];
        for i in program.rhs.iter() {
            if matches!(i.op, Op::Solve | Op::Implicit | Op::Repeat | Op::Call) {
                self.reached.push(Reached { instr: *i, first: 0, count: 0 });
                let cells = self.sets.len() / words;
                let (mut writes, mut reads) = (vec![false; cells], vec![false; cells]);
                touch(program, std::slice::from_ref(i), &mut writes, &mut reads);
                for cell in (0..cells).filter(|c| writes[*c]) {
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
                self.reached.push(Reached { instr: *i, first, count });
            }
            let at = i.dst as usize * words;
            self.sets[at..at + words].copy_from_slice(&set);
        }
    }

    /// Follows the rates, which have just been computed.
    pub fn follow(&mut self, instance: &mut Instance<'_>) -> Result<(), Fault> {
        let Forcing { tangents, reached, directions, .. } = self;
        let width = tangents.width;
        for Reached { instr: i, first, count } in reached.iter() {
            if *count == 0 {
                tangents.follow(instance, std::slice::from_ref(i))?;
                continue;
            }
            let those = &directions[*first as usize..(*first + *count) as usize];
            if 2 * those.len() > width {
                tangents.step(instance, i);
                continue;
            }
            let values = &mut tangents.values;
            let dst = i.dst as usize * width;
            let [a, b] = [i.a, i.b].map(|slot| slot as usize * width);
            let each = those.iter().map(|d| *d as usize);
            match rule(instance, i) {
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

    /// The derivatives of a cell.
    pub fn of(&self, slot: Slot) -> &[f64] {
        self.tangents.of(slot)
    }
}

/// The cells on whose derivatives those of the result depend.
pub(super) fn operands(i: &Instr) -> [Option<Slot>; 3] {
    match i.op {
        Op::Copy | Op::Neg | Op::Unary(_) => [Some(i.a), None, None],
        // What is there remains if the condition is false.
        Op::CopyIf => [Some(i.b), Some(i.dst), None],
        _ => [Some(i.a), Some(i.b), None],
    }
}

/// Marks the cells that a tape writes and reads, with all that it calls.
pub(super) fn touch(program: &Program, tape: &[Instr], writes: &mut [bool], reads: &mut [bool]) {
    for i in tape {
        let k = i.a as usize;
        match i.op {
            Op::Solve => {
                let solver = &program.solvers[k];
                solver.slots.iter().for_each(|s| writes[*s as usize] = true);
                touch(program, &solver.residual_tape, writes, reads);
                touch(program, &solver.jacobian_tape, writes, reads);
            }
            Op::Implicit => {
                let implicit = &program.implicits[k];
                implicit.results.iter().for_each(|s| writes[*s as usize] = true);
                implicit.seeds.iter().for_each(|e| reads[e.slot as usize] = true);
                implicit.jacobian.iter().for_each(|e| reads[e.slot as usize] = true);
            }
            Op::Repeat => touch(program, &program.loops[k].tape, writes, reads),
            Op::Call => {
                let site = &program.calls[k];
                site.args.iter().chain(&site.guard).for_each(|s| reads[*s as usize] = true);
                site.results.iter().for_each(|s| writes[*s as usize] = true);
                let function = &program.functions[site.function];
                let own = function.locals.iter().chain(&function.inputs).chain(&function.outputs);
                if function.recurs && own.clone().all(|s| writes[*s as usize]) {
                    continue;
                }
                own.for_each(|s| writes[*s as usize] = true);
                touch(program, &function.tape, writes, reads);
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
