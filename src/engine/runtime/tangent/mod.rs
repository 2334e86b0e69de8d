//! Tangents: derivatives of all slots by forward accumulation (A. Griewank, A. Walther, *Evaluating
//! Derivatives*, 2nd ed. 2008, sec. 3.1). Each slot has one derivative per direction, and each
//! instruction propagates them by the chain rule.
//!
//! A tape is executed first; its derivatives follow from the values in the memory, where every
//! temporary has its own slot. So one evaluation serves all directions, and torn blocks are not
//! iterated again: the implicit function theorem gives the derivatives of their unknowns.

use crate::ir::expr::{Binary, Unary};
use crate::ir::program::{CallSite, Instr, Layout, Op, Slot, Tape};
use crate::numeric::linear::DenseLu;
use crate::symbolic::partial;

pub mod forcing;
pub mod outputs;

use super::frame::Frames;
use super::input_signals::{DelayedSlots, InputSignals};
use super::machine::{Fault, JUMP_LIMIT, Machine, compute};
use super::mixed_block::{ITERATION_LIMIT, discrete_slot};

/// Number of directions that are processed together.
const LANES: usize = 4;

/// The derivatives of all slots.
pub struct Tangents {
    directions: usize,
    /// Directions with padding: a multiple of [`LANES`].
    width: usize,
    /// Slot by slot, direction by direction.
    values: Vec<f64>,
    /// Frames of recursive calls, parallel to `Machine::frames`.
    frames: Frames,
    /// For each direction, whether it has reached a function whose derivatives lie outside of the program.
    hidden: Vec<bool>,
    /// The instructions of a tape that are propagated, by its number, where those are not all.
    slices: Vec<(u32, Vec<Instr>)>,
}

impl Tangents {
    /// Tangents that are all zero.
    pub fn new(slots: usize, directions: usize) -> Self {
        let width = directions.div_ceil(LANES) * LANES;
        let (values, frames) = (vec![0.0; slots * width], Frames::default());
        let (hidden, slices) = (vec![false; directions], Vec::new());
        Tangents { directions, width, values, frames, hidden, slices }
    }

    /// From now on propagates only these instructions of a tape, in [`Tangents::propagate_tape`].
    pub fn restrict(&mut self, tape: &Tape, code: Vec<Instr>) {
        self.slices.extend(tape.number.map(|number| (number, code)));
    }

    /// Number of directions.
    pub fn directions(&self) -> usize {
        self.directions
    }

    /// Makes all tangents zero.
    pub fn clear_all(&mut self) {
        self.values.fill(0.0);
    }

    /// The derivatives of a slot.
    pub fn of(&self, slot: Slot) -> &[f64] {
        let start = slot as usize * self.width;
        &self.values[start..start + self.directions]
    }

    /// The derivatives of a slot, to be set.
    pub fn of_mut(&mut self, slot: Slot) -> &mut [f64] {
        let start = slot as usize * self.width;
        &mut self.values[start..start + self.directions]
    }

    /// For each direction, whether derivatives in it are not known: it has reached a function that hides them.
    pub fn hidden(&self) -> &[bool] {
        &self.hidden
    }

    /// Notes the directions in which the arguments of a function that hides its derivatives move.
    fn hide(&mut self, i: &Instr) {
        let [a, b] = [i.a, i.b].map(|slot| slot as usize * self.width);
        let is_binary = matches!(i.op, Op::Binary(_));
        for (k, hidden) in self.hidden.iter_mut().enumerate() {
            *hidden |= self.values[a + k] != 0.0 || (is_binary && self.values[b + k] != 0.0);
        }
    }

    /// `to := from`
    #[inline]
    pub fn copy(&mut self, to: Slot, from: Slot) {
        let start = from as usize * self.width;
        self.values.copy_within(start..start + self.width, to as usize * self.width);
    }

    /// Sets the derivatives of all signals at constant time: only those that are delayed have any, by the delay. The
    /// signals have been evaluated.
    pub fn hold_signals(&mut self, layout: &Layout, signals: &InputSignals, memory: &[f64]) {
        layout.signals.iter().for_each(|(.., slot)| self.clear(*slot));
        for DelayedSlots { value, rate, delay } in signals.delayed() {
            let rate = memory[rate as usize];
            let (to, from) = (value as usize * self.width, delay as usize * self.width);
            for k in 0..self.width {
                self.values[to + k] = -rate * self.values[from + k];
            }
        }
    }

    fn clear(&mut self, slot: Slot) {
        let start = slot as usize * self.width;
        self.values[start..start + self.width].fill(0.0);
    }

    /// Propagates derivatives along a tape of the program that has just been executed, or along what is needed of it.
    pub fn propagate_tape(&mut self, machine: &mut Machine<'_>, tape: &Tape) -> Result<(), Fault> {
        let slices = std::mem::take(&mut self.slices);
        let slice = slices.iter().find(|(number, _)| tape.number == Some(*number));
        let outcome = self.propagate(machine, slice.map_or(&tape[..], |(_, code)| code));
        self.slices = slices;
        outcome
    }

    /// Propagates derivatives along instructions that have just been executed.
    pub fn propagate(&mut self, machine: &mut Machine<'_>, tape: &[Instr]) -> Result<(), Fault> {
        for i in tape {
            match i.op {
                Op::Solve => self.solve(machine, i.a as usize)?,
                Op::Differentiate => self.differentiate(machine, i.a as usize)?,
                Op::Iterate => self.iterate(machine, i.a as usize)?,
                Op::Call => self.call(machine, i.a as usize)?,
                _ => self.propagate_instruction(machine, i),
            }
        }
        Ok(())
    }

    /// Propagates derivatives along one instruction whose result is in the memory.
    #[inline]
    fn propagate_instruction(&mut self, machine: &Machine<'_>, i: &Instr) {
        if hides_derivatives(machine, i) {
            self.hide(i);
        }
        match rule(machine, i) {
            Rule::Keep => {}
            Rule::Clear => self.clear(i.dst),
            Rule::Copy(from) => self.copy(i.dst, from),
            Rule::Scale(factor) => self.scale(i, factor),
            Rule::Combine(by_a, by_b) => self.combine(i, by_a, by_b),
        }
    }

    /// `d dst = factor * d a`
    #[inline]
    fn scale(&mut self, i: &Instr, factor: f64) {
        if factor == 0.0 {
            return self.clear(i.dst);
        }
        let (dst, a) = (i.dst as usize * self.width, i.a as usize * self.width);
        for lane in (0..self.width).step_by(LANES) {
            let from = self.lanes(a + lane);
            self.lanes_mut(dst + lane).copy_from_slice(&from.map(|d| product(factor, d)));
        }
    }

    /// `d dst = by_a * d a + by_b * d b`
    #[inline]
    fn combine(&mut self, i: &Instr, by_a: f64, by_b: f64) {
        let [dst, a, b] = [i.dst, i.a, i.b].map(|slot| slot as usize * self.width);
        if by_a.is_finite() && by_b.is_finite() {
            for lane in (0..self.width).step_by(LANES) {
                let (da, db) = (self.lanes(a + lane), self.lanes(b + lane));
                let sum: [f64; LANES] = std::array::from_fn(|k| by_a * da[k] + by_b * db[k]);
                self.lanes_mut(dst + lane).copy_from_slice(&sum);
            }
            return;
        }
        for k in 0..self.width {
            self.values[dst + k] =
                product(by_a, self.values[a + k]) + product(by_b, self.values[b + k]);
        }
    }

    #[inline]
    fn lanes(&self, at: usize) -> [f64; LANES] {
        std::array::from_fn(|k| self.values[at + k])
    }

    #[inline]
    fn lanes_mut(&mut self, at: usize) -> &mut [f64] {
        &mut self.values[at..at + LANES]
    }

    /// `J dz = -dr`, where `dr` are the derivatives of the residuals at constant `z`.
    fn solve(&mut self, machine: &mut Machine<'_>, k: usize) -> Result<(), Fault> {
        let program = machine.program;
        let torn_block = &program.routines.torn_blocks[k];
        let n = torn_block.unknowns.len();
        for slot in &torn_block.slots {
            self.clear(*slot);
        }
        self.propagate(machine, &torn_block.residual_tape)?;
        machine.run(&torn_block.jacobian_tape)?;
        let mut matrix = vec![0.0; n * n];
        for e in &torn_block.jacobian {
            matrix[e.row as usize + n * e.column as usize] = machine.get(e.slot);
        }
        let mut lu = DenseLu::new(n);
        let factored = lu.factor(&matrix);
        factored.map_err(|s| Fault::Singular { torn_block: k, unknown: s.column })?;
        let mut column = vec![0.0; n];
        for direction in 0..self.directions {
            for (c, slot) in column.iter_mut().zip(&torn_block.residuals) {
                *c = -self.of(*slot)[direction];
            }
            lu.solve_in_place(&mut column);
            for (c, slot) in column.iter().zip(&torn_block.slots) {
                self.of_mut(*slot)[direction] = *c;
            }
        }
        self.propagate(machine, &torn_block.residual_tape)
    }

    /// From `J z = -B` follows `J dz = -dB - dJ z`.
    fn differentiate(&mut self, machine: &mut Machine<'_>, k: usize) -> Result<(), Fault> {
        let derivative = &machine.program.routines.block_derivatives[k];
        let n = derivative.order;
        let mut matrix = vec![0.0; n * n];
        for e in &derivative.jacobian {
            matrix[e.row as usize + n * e.column as usize] = machine.get(e.slot);
        }
        let mut lu = DenseLu::new(n);
        let torn_block = derivative.torn_block as usize;
        let factored = lu.factor(&matrix);
        factored.map_err(|s| Fault::Singular { torn_block, unknown: s.column })?;
        let mut columns = vec![0.0; derivative.results.len()];
        for direction in 0..self.directions {
            columns.fill(0.0);
            for e in &derivative.seeds {
                columns[e.row as usize + n * e.column as usize] = -self.of(e.slot)[direction];
            }
            for (seed, column) in columns.chunks_exact_mut(n).enumerate() {
                for e in &derivative.jacobian {
                    let z = machine.get(derivative.results[seed * n + e.column as usize]);
                    column[e.row as usize] -= self.of(e.slot)[direction] * z;
                }
                lu.solve_in_place(column);
            }
            for (slot, value) in derivative.results.iter().zip(&columns) {
                self.of_mut(*slot)[direction] = *value;
            }
        }
        Ok(())
    }

    /// The values have converged; iterates the derivatives until they converge too.
    fn iterate(&mut self, machine: &mut Machine<'_>, k: usize) -> Result<(), Fault> {
        let mixed = &machine.program.routines.mixed_blocks[k];
        let mut before: Vec<f64> = Vec::new();
        for _ in 0..ITERATION_LIMIT {
            let discrete_unknowns = mixed.discrete_unknowns.iter().map(|w| discrete_slot(*w));
            before.clear();
            before.extend(discrete_unknowns.clone().flat_map(|slot| self.of(slot).iter().copied()));
            self.propagate(machine, &mixed.decisions)?;
            self.propagate(machine, &mixed.tape)?;
            let mut now = discrete_unknowns.flat_map(|slot| self.of(slot).iter());
            if before.iter().all(|b| now.next() == Some(b)) {
                break;
            }
        }
        Ok(())
    }

    fn call(&mut self, machine: &mut Machine<'_>, k: usize) -> Result<(), Fault> {
        let program = machine.program;
        let site = &program.routines.calls[k];
        if !machine.is_needed(site) {
            return Ok(());
        }
        let function = &program.routines.functions[site.function];
        let Some((output, arg)) = site.partial else {
            self.enter(machine, site, None)?;
            for (to, from) in site.results.iter().zip(&function.outputs) {
                machine.memory[*to as usize] = machine.memory[*from as usize];
                self.copy(*to, *from);
            }
            return Ok(());
        };
        // Differentiate the difference quotient that approximates the partial derivative.
        let out = function.outputs[output];
        let x = machine.get(site.args[arg]);
        let h = f64::EPSILON.cbrt() * if x == 0.0 { 1.0 } else { x.abs() };
        self.enter(machine, site, Some((arg, x + h)))?;
        let above = self.of(out).to_vec();
        self.enter(machine, site, Some((arg, x - h)))?;
        let width = (x + h) - (x - h);
        let result: Vec<f64> =
            above.iter().zip(self.of(out)).map(|(a, b)| (a - b) / width).collect();
        self.of_mut(site.results[0]).copy_from_slice(&result);
        Ok(())
    }

    /// Executes the body of a function again, propagating derivatives after each instruction: its
    /// locals are shared by all calls, so their values may be those of another call.
    fn enter(
        &mut self,
        machine: &mut Machine<'_>,
        site: &CallSite,
        replaced: Option<(usize, f64)>,
    ) -> Result<(), Fault> {
        let program = machine.program;
        let function = &program.routines.functions[site.function];
        for local in &function.locals {
            machine.set(*local, 0.0);
            self.clear(*local);
        }
        for (i, (to, from)) in function.inputs.iter().zip(&site.args).enumerate() {
            machine.memory[*to as usize] = match replaced {
                Some((arg, value)) if arg == i => value,
                _ => machine.memory[*from as usize],
            };
            self.copy(*to, *from);
        }
        let depth = machine.frames.depth();
        self.run_body(machine, site.function, depth).inspect_err(|_| {
            machine.frames.unwind(depth);
            self.frames.unwind(0);
        })
    }

    /// As [`Machine`] executes the body of a function, with derivatives.
    fn run_body(
        &mut self,
        machine: &mut Machine<'_>,
        mut function: usize,
        depth: usize,
    ) -> Result<(), Fault> {
        let program = machine.program;
        let mut tape = &program.routines.functions[function].tape;
        let (mut at, mut jumps) = (0, 0);
        loop {
            let Some(i) = tape.get(at) else {
                if machine.frames.depth() == depth {
                    return Ok(());
                }
                self.frames.pop(program, &mut self.values, self.width);
                let back = machine.frames.pop(program, &mut machine.memory, 1);
                (function, at) = back.unwrap_or((function, at));
                tape = &program.routines.functions[function].tape;
                continue;
            };
            at += 1;
            match i.op {
                Op::Jump => at = i.a as usize,
                Op::JumpUnless if machine.get(i.a) == 0.0 => at = i.b as usize,
                Op::JumpUnless | Op::Assert => {}
                Op::Call if program.is_recursive_call(i.a as usize) => {
                    let (site, back) = (i.a as usize, (function, at));
                    let own = self.frames.push(program, site, back, &mut self.values, self.width);
                    let memory = &mut machine.memory;
                    if !(own && machine.frames.push(program, site, back, memory, 1)) {
                        return Err(machine.fail(Fault::NonTerminating { function }));
                    }
                    (function, at) = (program.routines.calls[site].function, 0);
                    tape = &program.routines.functions[function].tape;
                    jumps += 1;
                }
                Op::Call => self.call(machine, i.a as usize)?,
                _ => self.compute_and_propagate(machine, i),
            }
            jumps += u32::from(i.op == Op::Jump);
            if jumps > JUMP_LIMIT {
                return Err(machine.fail(Fault::NonTerminating { function }));
            }
        }
    }

    /// Executes an instruction and propagates derivatives; its result may overwrite an operand.
    fn compute_and_propagate(&mut self, machine: &mut Machine<'_>, i: &Instr) {
        let (a, b) = (machine.get(i.a), machine.get(i.b));
        if machine.clamp_domain {
            compute::<true>(&mut machine.memory, i, machine.program.externals());
        } else {
            compute::<false>(&mut machine.memory, i, machine.program.externals());
        }
        let value = machine.get(i.dst);
        let overwritten = i.dst == i.a || i.dst == i.b;
        if overwritten && hides_derivatives(machine, i) {
            self.hide(i);
        }
        if !overwritten {
            return self.propagate_instruction(machine, i);
        }
        match i.op {
            Op::Mul => self.combine(i, b, a),
            Op::Div => self.combine(i, 1.0 / b, -value / b),
            Op::Unary(op) => {
                self.scale(i, partial::unary(op, a, value, machine.program.externals()))
            }
            Op::Binary(op) => {
                let (by_a, by_b) = partial::binary(op, a, b, value, machine.program.externals());
                self.combine(i, by_a, by_b);
            }
            Op::CopyIf if a != 0.0 => self.copy(i.dst, i.b),
            Op::CopyIf => {}
            // The other rules do not read the operands.
            _ => self.propagate_instruction(machine, i),
        }
    }
}

/// True for a function whose derivatives lie outside of the program.
#[inline]
fn hides_derivatives(machine: &Machine<'_>, i: &Instr) -> bool {
    let f = match i.op {
        Op::Unary(Unary::External(f)) => f,
        Op::Binary(Binary::External(f)) => f,
        _ => return false,
    };
    machine.program.externals().get(f).hides_derivatives()
}

/// How an instruction propagates derivatives.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Rule {
    /// Nothing.
    Keep,
    /// `d dst = 0`
    Clear,
    /// `d dst = d from`
    Copy(Slot),
    /// `d dst = factor * d a`
    Scale(f64),
    /// `d dst = by_a * d a + by_b * d b`
    Combine(f64, f64),
}

/// The chain rule for an instruction whose result is in the memory.
#[inline]
fn rule(machine: &Machine<'_>, i: &Instr) -> Rule {
    let memory = &machine.memory;
    let (a, b) = (memory[i.a as usize], memory[i.b as usize]);
    let value = memory[i.dst as usize];
    match i.op {
        Op::Copy => Rule::Copy(i.a),
        Op::CopyIf if a != 0.0 => Rule::Copy(i.b),
        Op::CopyIf => Rule::Keep,
        Op::Input => Rule::Copy(if b.is_nan() { i.a } else { i.b }),
        Op::Add => Rule::Combine(1.0, 1.0),
        Op::Sub => Rule::Combine(1.0, -1.0),
        Op::Mul => Rule::Combine(b, a),
        Op::Div if machine.clamp_domain && a == 0.0 && b == 0.0 => Rule::Clear,
        Op::Div => Rule::Combine(1.0 / b, -value / b),
        Op::Neg => Rule::Scale(-1.0),
        Op::Unary(op) => {
            let factor = partial::unary(op, a, value, machine.program.externals());
            // Beyond a domain boundary the clamped function is constant.
            let level = machine.clamp_domain && !factor.is_finite();
            Rule::Scale(if level { 0.0 } else { factor })
        }
        Op::Binary(op) => {
            let (mut by_a, mut by_b) =
                partial::binary(op, a, b, value, machine.program.externals());
            if machine.clamp_domain {
                by_a = if by_a.is_finite() { by_a } else { 0.0 };
                by_b = if by_b.is_finite() { by_b } else { 0.0 };
            }
            Rule::Combine(by_a, by_b)
        }
        Op::Solve | Op::Differentiate | Op::Iterate | Op::Call => Rule::Keep,
        Op::Jump | Op::JumpUnless | Op::Assert => Rule::Keep,
    }
}

/// `factor * d`, where zero times an infinite slope is zero.
#[inline]
fn product(factor: f64, d: f64) -> f64 {
    if d == 0.0 { 0.0 } else { factor * d }
}
