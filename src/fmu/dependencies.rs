//! Which derivatives and outputs depend on which states and inputs.
//!
//! In: a program. Out: for slots, the knowns whose change between events can reach them. Computed by passing
//! sets along the instructions, as values are: an algebraic loop passes everything it reads to all its unknowns.

use crate::ir::program::{Instr, Op, Program, Slot};

/// For each slot, a set of knowns.
pub struct Dependencies {
    words: usize,
    sets: Vec<u64>,
}

impl Dependencies {
    /// Traces the knowns, slots, through the continuous tapes.
    pub fn trace(program: &Program, knowns: &[Slot]) -> Self {
        let mut traced = Dependencies::from(program, knowns);
        traced.pass_continuous(program);
        traced
    }

    /// Traces the knowns, slots, through the initialization.
    pub fn trace_initial(program: &Program, knowns: &[Slot]) -> Self {
        let mut traced = Dependencies::from(program, knowns);
        traced.pass(program, &program.tapes.parameters);
        for (v, _, start) in &program.layout.starts {
            traced.add(program.slot(*v), *start);
        }
        // What is read before it is computed, such as `pre` and relations, takes a second pass.
        for _ in 0..2 {
            for (_, slot, pre) in &program.layout.pre {
                traced.add(*pre, *slot);
            }
            traced.pass(program, &program.tapes.initial);
            traced.pass(program, &program.tapes.event);
            traced.pass(program, &program.tapes.discrete);
            traced.pass_continuous(program);
        }
        traced
    }

    /// Traces the knowns, slots, through the parameters.
    pub fn trace_parameters(program: &Program, knowns: &[Slot]) -> Self {
        let mut traced = Dependencies::from(program, knowns);
        traced.pass(program, &program.tapes.parameters);
        traced
    }

    fn pass_continuous(&mut self, program: &Program) {
        let tapes = &program.tapes;
        for tape in [&tapes.rhs, &tapes.roots, &tapes.outputs] {
            self.pass(program, tape);
        }
    }

    /// Sets in which each known has itself only.
    fn from(program: &Program, knowns: &[Slot]) -> Self {
        let words = knowns.len().div_ceil(64).max(1);
        let mut traced = Dependencies { words, sets: vec![0; words * program.image.len()] };
        for (k, slot) in knowns.iter().enumerate() {
            traced.sets[*slot as usize * words + k / 64] |= 1 << (k % 64);
        }
        traced
    }

    /// The numbers of the knowns that reach a slot.
    pub fn of(&self, slot: Slot) -> Vec<usize> {
        let set = &self.sets[slot as usize * self.words..][..self.words];
        let has = |k: &usize| set[k / 64] >> (k % 64) & 1 == 1;
        (0..64 * self.words).filter(has).collect()
    }

    /// Adds the set of a slot to that of another.
    fn add(&mut self, to: Slot, from: Slot) {
        for k in 0..self.words {
            self.sets[to as usize * self.words + k] |= self.sets[from as usize * self.words + k];
        }
    }

    fn pass(&mut self, program: &Program, tape: &[Instr]) {
        for i in tape {
            match i.op {
                Op::Solve => {
                    let torn = &program.routines.torn_blocks[i.a as usize];
                    self.pass(program, &torn.residual_tape);
                    for (unknown, residual) in torn
                        .slots
                        .iter()
                        .flat_map(|unknown| torn.residuals.iter().map(move |r| (*unknown, *r)))
                    {
                        self.add(unknown, residual);
                    }
                    self.pass(program, &torn.residual_tape);
                }
                Op::Iterate => {
                    let mixed = &program.routines.mixed_blocks[i.a as usize];
                    for _ in 0..2 {
                        self.pass(program, &mixed.decisions);
                        self.pass(program, &mixed.tape);
                    }
                }
                Op::Call => {
                    let site = &program.routines.calls[i.a as usize];
                    for (result, argument) in site
                        .results
                        .iter()
                        .flat_map(|result| site.args.iter().map(move |a| (*result, *a)))
                    {
                        self.add(result, argument);
                    }
                }
                Op::Differentiate | Op::Jump | Op::JumpUnless | Op::Assert => {}
                Op::Copy | Op::Neg | Op::Unary(_) => self.add(i.dst, i.a),
                _ => {
                    self.add(i.dst, i.a);
                    self.add(i.dst, i.b);
                }
            }
        }
    }
}
