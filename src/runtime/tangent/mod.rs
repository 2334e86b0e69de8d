//! Derivatives of everything that tapes compute, by forward accumulation (A. Griewank, A. Walther,
//! *Evaluating Derivatives*, 2nd ed. 2008, sec. 3.1): each cell has one derivative per direction, and
//! each instruction carries them on by the chain rule.
//!
//! A tape runs first; its derivatives follow from what it left in the memory, where every temporary
//! has a cell of its own. So one evaluation serves all directions, and a torn block is not iterated:
//! at its solution the implicit function theorem gives the derivatives of its unknowns.

use crate::ir::program::{CallSite, Instr, Op, Slot};
use crate::numeric::linear::DenseLu;
use crate::symbolic::partial;

pub mod forcing;
pub mod outputs;

use super::frame::Frames;
use super::machine::{Fault, Instance, JUMP_LIMIT, step};
use super::mixed_block::{LOOP_LIMIT, watched_slot};

/// Directions are handled in groups of so many.
const LANES: usize = 4;

/// The derivatives of all cells.
pub struct Tangents {
    directions: usize,
    /// Directions with padding: a multiple of [`LANES`].
    width: usize,
    /// Cell by cell, direction by direction.
    values: Vec<f64>,
    /// Those of calls in which a function has called itself, as `Instance::frames`.
    frames: Frames,
}

impl Tangents {
    /// No cell depends on any direction yet.
    pub fn new(cells: usize, directions: usize) -> Self {
        let width = directions.div_ceil(LANES) * LANES;
        Tangents { directions, width, values: vec![0.0; cells * width], frames: Frames::default() }
    }

    /// Number of directions.
    pub fn directions(&self) -> usize {
        self.directions
    }

    /// The derivatives of a cell.
    pub fn of(&self, slot: Slot) -> &[f64] {
        let start = slot as usize * self.width;
        &self.values[start..start + self.directions]
    }

    /// The derivatives of a cell, to be set.
    pub fn of_mut(&mut self, slot: Slot) -> &mut [f64] {
        let start = slot as usize * self.width;
        &mut self.values[start..start + self.directions]
    }

    /// Adds to each derivative of every cell that multiple of its derivative in direction `along`.
    pub fn shear(&mut self, along: usize, multiples: &[f64]) {
        for cell in self.values.chunks_exact_mut(self.width) {
            let rate = cell[along];
            if rate != 0.0 {
                for (d, m) in cell.iter_mut().zip(multiples) {
                    *d += rate * m;
                }
            }
        }
    }

    /// Takes over the derivatives of another set of the same size.
    pub fn copy_from(&mut self, other: &Tangents) {
        self.values.copy_from_slice(&other.values);
    }

    /// A copy to return to.
    pub fn snapshot(&self) -> Tangents {
        let frames = Frames::default();
        let values = self.values.clone();
        Tangents { directions: self.directions, width: self.width, values, frames }
    }

    /// `to := from`
    #[inline]
    pub fn copy(&mut self, to: Slot, from: Slot) {
        let start = from as usize * self.width;
        self.values.copy_within(start..start + self.width, to as usize * self.width);
    }

    fn clear(&mut self, slot: Slot) {
        let start = slot as usize * self.width;
        self.values[start..start + self.width].fill(0.0);
    }

    /// Follows a tape that has just run.
    pub fn follow(&mut self, instance: &mut Instance<'_>, tape: &[Instr]) -> Result<(), Fault> {
        for i in tape {
            match i.op {
                Op::Solve => self.solve(instance, i.a as usize)?,
                Op::Implicit => self.differentiate(instance, i.a as usize)?,
                Op::Repeat => self.repeat(instance, i.a as usize)?,
                Op::Call => self.call(instance, i.a as usize)?,
                _ => self.step(instance, i),
            }
        }
        Ok(())
    }

    /// The chain rule for one instruction whose value stands in the memory.
    #[inline]
    fn step(&mut self, instance: &Instance<'_>, i: &Instr) {
        match rule(instance, i) {
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

    /// `J dz = -dr`, where `dr` are the derivatives of the residuals with `z` held.
    fn solve(&mut self, instance: &mut Instance<'_>, k: usize) -> Result<(), Fault> {
        let program = instance.program;
        let solver = &program.solvers[k];
        let n = solver.unknowns.len();
        for slot in &solver.slots {
            self.clear(*slot);
        }
        self.follow(instance, &solver.residual_tape)?;
        instance.run(&solver.jacobian_tape)?;
        let mut matrix = vec![0.0; n * n];
        for e in &solver.jacobian {
            matrix[e.row as usize + n * e.column as usize] = instance.get(e.slot);
        }
        let mut lu = DenseLu::new(n);
        let factored = lu.factor(&matrix);
        factored.map_err(|s| Fault::Singular { solver: k, unknown: s.column })?;
        let mut column = vec![0.0; n];
        for direction in 0..self.directions {
            for (c, slot) in column.iter_mut().zip(&solver.residuals) {
                *c = -self.of(*slot)[direction];
            }
            lu.solve_in_place(&mut column);
            for (c, slot) in column.iter().zip(&solver.slots) {
                self.of_mut(*slot)[direction] = *c;
            }
        }
        self.follow(instance, &solver.residual_tape)
    }

    /// From `J z = -B` follows `J dz = -dB - dJ z`.
    fn differentiate(&mut self, instance: &mut Instance<'_>, k: usize) -> Result<(), Fault> {
        let implicit = &instance.program.implicits[k];
        let n = implicit.order;
        let mut matrix = vec![0.0; n * n];
        for e in &implicit.jacobian {
            matrix[e.row as usize + n * e.column as usize] = instance.get(e.slot);
        }
        let mut lu = DenseLu::new(n);
        let solver = implicit.solver as usize;
        let factored = lu.factor(&matrix);
        factored.map_err(|s| Fault::Singular { solver, unknown: s.column })?;
        let mut columns = vec![0.0; implicit.results.len()];
        for direction in 0..self.directions {
            columns.fill(0.0);
            for e in &implicit.seeds {
                columns[e.row as usize + n * e.column as usize] = -self.of(e.slot)[direction];
            }
            for (seed, column) in columns.chunks_exact_mut(n).enumerate() {
                for e in &implicit.jacobian {
                    let z = instance.get(implicit.results[seed * n + e.column as usize]);
                    column[e.row as usize] -= self.of(e.slot)[direction] * z;
                }
                lu.solve_in_place(column);
            }
            for (slot, value) in implicit.results.iter().zip(&columns) {
                self.of_mut(*slot)[direction] = *value;
            }
        }
        Ok(())
    }

    /// The values rest; the derivatives are repeated until they rest too.
    fn repeat(&mut self, instance: &mut Instance<'_>, k: usize) -> Result<(), Fault> {
        let mixed = &instance.program.loops[k];
        let mut before: Vec<f64> = Vec::new();
        for _ in 0..LOOP_LIMIT {
            let watched = mixed.watched.iter().map(|w| watched_slot(*w));
            before.clear();
            before.extend(watched.clone().flat_map(|slot| self.of(slot).iter().copied()));
            self.follow(instance, &mixed.tape)?;
            let mut now = watched.flat_map(|slot| self.of(slot).iter());
            if before.iter().all(|b| now.next() == Some(b)) {
                break;
            }
        }
        Ok(())
    }

    fn call(&mut self, instance: &mut Instance<'_>, k: usize) -> Result<(), Fault> {
        let program = instance.program;
        let site = &program.calls[k];
        if !instance.needs(site) {
            return Ok(());
        }
        let function = &program.functions[site.function];
        let Some((output, arg)) = site.partial else {
            self.enter(instance, site, None)?;
            for (to, from) in site.results.iter().zip(&function.outputs) {
                instance.memory[*to as usize] = instance.memory[*from as usize];
                self.copy(*to, *from);
            }
            return Ok(());
        };
        // The derivative of the difference quotient that stands for the partial derivative.
        let out = function.outputs[output];
        let x = instance.get(site.args[arg]);
        let h = f64::EPSILON.cbrt() * if x == 0.0 { 1.0 } else { x.abs() };
        self.enter(instance, site, Some((arg, x + h)))?;
        let above = self.of(out).to_vec();
        self.enter(instance, site, Some((arg, x - h)))?;
        let width = (x + h) - (x - h);
        let result: Vec<f64> =
            above.iter().zip(self.of(out)).map(|(a, b)| (a - b) / width).collect();
        self.of_mut(site.results[0]).copy_from_slice(&result);
        Ok(())
    }

    /// Runs the body of a function again, each instruction followed by its derivatives: its locals
    /// are shared by all calls.
    fn enter(
        &mut self,
        instance: &mut Instance<'_>,
        site: &CallSite,
        moved: Option<(usize, f64)>,
    ) -> Result<(), Fault> {
        let program = instance.program;
        let function = &program.functions[site.function];
        for local in &function.locals {
            instance.set(*local, 0.0);
            self.clear(*local);
        }
        for (i, (to, from)) in function.inputs.iter().zip(&site.args).enumerate() {
            instance.memory[*to as usize] = match moved {
                Some((arg, value)) if arg == i => value,
                _ => instance.memory[*from as usize],
            };
            self.copy(*to, *from);
        }
        let depth = instance.frames.depth();
        self.body(instance, site.function, depth).inspect_err(|_| {
            instance.frames.give_up(depth);
            self.frames.give_up(0);
        })
    }

    /// As the body of a function is run by [`Instance`].
    fn body(
        &mut self,
        instance: &mut Instance<'_>,
        mut function: usize,
        depth: usize,
    ) -> Result<(), Fault> {
        let program = instance.program;
        let mut tape = &program.functions[function].tape;
        let (mut at, mut jumps) = (0, 0);
        loop {
            let Some(i) = tape.get(at) else {
                if instance.frames.depth() == depth {
                    return Ok(());
                }
                self.frames.leave(program, &mut self.values, self.width);
                let back = instance.frames.leave(program, &mut instance.memory, 1);
                (function, at) = back.unwrap_or((function, at));
                tape = &program.functions[function].tape;
                continue;
            };
            at += 1;
            match i.op {
                Op::Jump => at = i.a as usize,
                Op::JumpUnless if instance.get(i.a) == 0.0 => at = i.b as usize,
                Op::JumpUnless | Op::Assert => {}
                Op::Call if program.calls_itself(i.a as usize) => {
                    let (site, back) = (i.a as usize, (function, at));
                    let own = self.frames.enter(program, site, back, &mut self.values, self.width);
                    let memory = &mut instance.memory;
                    if !(own && instance.frames.enter(program, site, back, memory, 1)) {
                        return Err(instance.fail(Fault::Endless { function }));
                    }
                    (function, at) = (program.calls[site].function, 0);
                    tape = &program.functions[function].tape;
                    jumps += 1;
                }
                Op::Call => self.call(instance, i.a as usize)?,
                _ => self.step_anew(instance, i),
            }
            jumps += u32::from(i.op == Op::Jump);
            if jumps > JUMP_LIMIT {
                return Err(instance.fail(Fault::Endless { function }));
            }
        }
    }

    /// Computes an instruction and follows it. A variable of a function may stand on both sides.
    fn step_anew(&mut self, instance: &mut Instance<'_>, i: &Instr) {
        let (a, b) = (instance.get(i.a), instance.get(i.b));
        if instance.inside {
            step::<true>(&mut instance.memory, i);
        } else {
            step::<false>(&mut instance.memory, i);
        }
        let value = instance.get(i.dst);
        let overwritten = i.dst == i.a || i.dst == i.b;
        if !overwritten {
            return self.step(instance, i);
        }
        match i.op {
            Op::Mul => self.combine(i, b, a),
            Op::Div => self.combine(i, 1.0 / b, -value / b),
            Op::Unary(op) => self.scale(i, partial::unary(op, a, value)),
            Op::Binary(op) => {
                let (by_a, by_b) = partial::binary(op, a, b, value);
                self.combine(i, by_a, by_b);
            }
            Op::CopyIf if a != 0.0 => self.copy(i.dst, i.b),
            Op::CopyIf => {}
            // The others do not read the operands.
            _ => self.step(instance, i),
        }
    }
}

/// What an instruction does to derivatives.
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

/// The chain rule for an instruction whose value stands in the memory.
#[inline]
fn rule(instance: &Instance<'_>, i: &Instr) -> Rule {
    let memory = &instance.memory;
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
        Op::Div if instance.inside && a == 0.0 && b == 0.0 => Rule::Clear,
        Op::Div => Rule::Combine(1.0 / b, -value / b),
        Op::Neg => Rule::Scale(-1.0),
        Op::Unary(op) => {
            let factor = partial::unary(op, a, value);
            // At the border of a domain the branch goes on level.
            let level = instance.inside && !factor.is_finite();
            Rule::Scale(if level { 0.0 } else { factor })
        }
        Op::Binary(op) => {
            let (mut by_a, mut by_b) = partial::binary(op, a, b, value);
            if instance.inside {
                by_a = if by_a.is_finite() { by_a } else { 0.0 };
                by_b = if by_b.is_finite() { by_b } else { 0.0 };
            }
            Rule::Combine(by_a, by_b)
        }
        Op::Solve | Op::Implicit | Op::Repeat | Op::Call => Rule::Keep,
        Op::Jump | Op::JumpUnless | Op::Assert => Rule::Keep,
    }
}

/// Where there is nothing to multiply, an infinite slope counts nothing.
#[inline]
fn product(factor: f64, d: f64) -> f64 {
    if d == 0.0 { 0.0 } else { factor * d }
}
