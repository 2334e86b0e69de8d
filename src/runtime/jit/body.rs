//! Calls, the bodies of functions, which jump, and blocks that are quotients.

use cranelift::codegen::ir::FuncRef;
use cranelift::prelude::*;

use crate::base::index::FastMap;
use crate::ir::program::{CallSite, FunctionCode, Op};
use crate::runtime::machine::{DIFFERENCE, Fault, JUMP_LIMIT};

use super::slots::Cells;
use super::source::Source;

/// The faults that machine code may end with; it returns the position of one, counted from one.
#[derive(Default)]
pub struct Faults(pub Vec<Fault>);

impl Faults {
    fn status(&mut self, fault: Fault) -> u32 {
        let known = self.0.iter().position(|f| *f == fault);
        let at = known.unwrap_or_else(|| {
            self.0.push(fault);
            self.0.len() - 1
        });
        at as u32 + 1
    }
}

/// Emits the body of function `k`. `site` emits a call.
pub fn emit(
    cells: &mut Cells<'_, '_>,
    k: usize,
    function: &FunctionCode,
    faults: &mut Faults,
    mut site: impl FnMut(&mut Cells<'_, '_>, usize),
) {
    let tape = &function.tape;
    let blocks = leaders(cells, function);
    let jumps = cells.build.declare_var(types::I32);
    let zero = cells.build.ins().iconst(types::I32, 0);
    cells.build.def_var(jumps, zero);
    // Set after each jump: what follows is reached from elsewhere only.
    let mut left = false;
    for at in 0..=tape.len() {
        if let Some(&block) = blocks.get(&at) {
            if !left {
                cells.build.ins().jump(block, &[]);
            }
            cells.build.switch_to_block(block);
            cells.forget();
            left = false;
        }
        let Some(i) = tape.get(at) else { break };
        if left {
            continue;
        }
        match i.op {
            Op::Jump => {
                let before = cells.build.use_var(jumps);
                let count = cells.build.ins().iadd_imm_s(before, 1);
                cells.build.def_var(jumps, count);
                let endless = cells.build.create_block();
                cells.build.set_cold_block(endless);
                let limit = i64::from(JUMP_LIMIT);
                let over = cells.build.ins().icmp_imm_u(IntCC::UnsignedGreaterThan, count, limit);
                cells.build.ins().brif(over, endless, &[], blocks[&(i.a as usize)], &[]);
                cells.build.switch_to_block(endless);
                cells.leave(faults.status(Fault::Endless { function: k }));
                left = true;
            }
            Op::JumpUnless => {
                let truth = cells.truth(i.a);
                let (next, target) = (blocks[&(at + 1)], blocks[&(i.b as usize)]);
                cells.build.ins().brif(truth, next, &[], target, &[]);
                left = true;
            }
            Op::Assert => {
                let truth = cells.truth(i.a);
                let message = i.b as usize;
                cells.leave_unless(truth, faults.status(Fault::Assertion { function: k, message }));
            }
            Op::Call => site(cells, i.a as usize),
            _ => cells.compute(i),
        }
    }
    if !left {
        cells.leave(0);
    }
}

/// A block for each instruction that a jump leads to or that follows one.
fn leaders(cells: &mut Cells<'_, '_>, function: &FunctionCode) -> FastMap<usize, Block> {
    let mut blocks = FastMap::default();
    let mut lead = |at: usize| {
        blocks.entry(at).or_insert_with(|| cells.build.create_block());
    };
    for (at, i) in function.tape.iter().enumerate() {
        match i.op {
            Op::Jump => lead(i.a as usize),
            Op::JumpUnless => [i.b as usize, at + 1].into_iter().for_each(&mut lead),
            _ => {}
        }
    }
    blocks
}

/// Emits a call, which is done where its condition holds.
pub fn call(cells: &mut Cells<'_, '_>, site: &CallSite, function: &FunctionCode, code: FuncRef) {
    let Some(guard) = site.guard else { return done(cells, site, function, code) };
    let (needed, after) = (cells.build.create_block(), cells.build.create_block());
    let truth = cells.truth(guard);
    cells.build.ins().brif(truth, needed, &[], after, &[]);
    cells.build.switch_to_block(needed);
    cells.forget();
    done(cells, site, function, code);
    cells.build.ins().jump(after, &[]);
    cells.build.switch_to_block(after);
    cells.forget();
}

/// Emits a call, in the order in which `Instance::call` does it, but even if its results are there.
fn done(cells: &mut Cells<'_, '_>, site: &CallSite, function: &FunctionCode, code: FuncRef) {
    if let Some(last) = site.last {
        let nothing = cells.number(f64::NAN);
        cells.set(last, nothing);
    }
    let Some((output, argument)) = site.partial else {
        enter(cells, site, function, code, None);
        for (to, from) in site.results.iter().zip(&function.outputs) {
            let value = cells.get(*from);
            cells.set(*to, value);
        }
        return;
    };
    let out = function.outputs[output];
    let moved = |cells: &mut Cells<'_, '_>, sign: f64| {
        let x = cells.get(site.args[argument]);
        let (zero, one) = (cells.number(0.0), cells.number(1.0));
        let at_zero = cells.build.ins().fcmp(FloatCC::Equal, x, zero);
        let size = cells.build.ins().fabs(x);
        let size = cells.build.ins().select(at_zero, one, size);
        let factor = cells.number(DIFFERENCE);
        let h = cells.build.ins().fmul(factor, size);
        if sign > 0.0 { cells.build.ins().fadd(x, h) } else { cells.build.ins().fsub(x, h) }
    };
    let (x_above, x_below) = (moved(cells, 1.0), moved(cells, -1.0));
    enter(cells, site, function, code, Some((argument, x_above)));
    let above = cells.get(out);
    enter(cells, site, function, code, Some((argument, x_below)));
    let below = cells.get(out);
    let rise = cells.build.ins().fsub(above, below);
    let run = cells.build.ins().fsub(x_above, x_below);
    let slope = cells.build.ins().fdiv(rise, run);
    cells.set(site.results[0], slope);
}

/// Emits the solution of block `k`, in the order in which `SolverWork::solve` does it.
pub fn quotient(
    cells: &mut Cells<'_, '_>,
    source: &Source,
    k: usize,
    faults: &mut Faults,
    call: &mut dyn FnMut(&mut Cells<'_, '_>, usize),
) {
    let Some(block) = source.quotients[k] else { return };
    let mut run = |cells: &mut Cells<'_, '_>, tape: u32| {
        for i in &source.tapes[tape as usize] {
            match i.op {
                Op::Call => call(cells, i.a as usize),
                _ => cells.compute(i),
            }
        }
    };
    let zero = cells.number(0.0);
    cells.set(block.unknown, zero);
    run(cells, block.residual_tape);
    run(cells, block.jacobian_tape);
    let residual = cells.get(block.residual);
    let (zero, infinity) = (cells.number(0.0), cells.number(f64::INFINITY));
    let size = cells.build.ins().fabs(residual);
    let finite = cells.build.ins().fcmp(FloatCC::LessThan, size, infinity);
    let status = faults.status(Fault::NotFinite { solver: k, residual: 0 });
    cells.leave_unless(finite, status);
    let pivot = cells.get(block.pivot);
    let size = cells.build.ins().fabs(pivot);
    let finite = cells.build.ins().fcmp(FloatCC::LessThan, size, infinity);
    let nonzero = cells.build.ins().fcmp(FloatCC::GreaterThan, size, zero);
    let regular = cells.build.ins().band(finite, nonzero);
    let status = faults.status(Fault::Singular { solver: k, unknown: 0 });
    cells.leave_unless(regular, status);
    let negative = cells.build.ins().fneg(residual);
    let solution = cells.build.ins().fdiv(negative, pivot);
    cells.set(block.unknown, solution);
    run(cells, block.residual_tape);
}

fn enter(
    cells: &mut Cells<'_, '_>,
    site: &CallSite,
    function: &FunctionCode,
    code: FuncRef,
    moved: Option<(usize, Value)>,
) {
    for local in &function.locals {
        let zero = cells.number(0.0);
        cells.set(*local, zero);
    }
    for (k, (to, from)) in function.inputs.iter().zip(&site.args).enumerate() {
        let value = match moved {
            Some((argument, value)) if argument == k => value,
            _ => cells.get(*from),
        };
        cells.set(*to, value);
    }
    let status = cells.call(code);
    cells.leave_unless_fine(status);
}
