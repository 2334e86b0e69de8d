//! Generates code for calls, function bodies with jumps, and scalar linear blocks.

use cranelift::codegen::ir::FuncRef;
use cranelift::prelude::*;

use crate::base::index::FastMap;
use crate::ir::program::{CallSite, FunctionCode, Op, Slot};
use crate::runtime::machine::{DIFFERENCE, Fault, JUMP_LIMIT};

use super::slots::FragmentBuilder;
use super::source::Source;

/// The faults that machine code may return, by their position counted from one.
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

/// Emits the body of function `k`; `site` emits a call.
pub fn emit(
    fragment: &mut FragmentBuilder<'_, '_>,
    k: usize,
    function: &FunctionCode,
    faults: &mut Faults,
    mut site: impl FnMut(&mut FragmentBuilder<'_, '_>, usize),
) {
    let tape = &function.tape;
    let blocks = leaders(fragment, function);
    let jumps = fragment.build.declare_var(types::I32);
    let zero = fragment.build.ins().iconst(types::I32, 0);
    fragment.build.def_var(jumps, zero);
    // True after a jump: the following code is reachable only through its label.
    let mut unreachable = false;
    for at in 0..=tape.len() {
        if let Some(&block) = blocks.get(&at) {
            if !unreachable {
                fragment.build.ins().jump(block, &[]);
            }
            fragment.build.switch_to_block(block);
            fragment.invalidate();
            unreachable = false;
        }
        let Some(i) = tape.get(at) else { break };
        if unreachable {
            continue;
        }
        match i.op {
            Op::Jump => {
                let before = fragment.build.use_var(jumps);
                let count = fragment.build.ins().iadd_imm_s(before, 1);
                fragment.build.def_var(jumps, count);
                let endless = fragment.build.create_block();
                fragment.build.set_cold_block(endless);
                let limit = i64::from(JUMP_LIMIT);
                let over =
                    fragment.build.ins().icmp_imm_u(IntCC::UnsignedGreaterThan, count, limit);
                fragment.build.ins().brif(over, endless, &[], blocks[&(i.a as usize)], &[]);
                fragment.build.switch_to_block(endless);
                fragment.return_status(faults.status(Fault::NonTerminating { function: k }));
                unreachable = true;
            }
            Op::JumpUnless => {
                let truth = fragment.truth(i.a);
                let (next, target) = (blocks[&(at + 1)], blocks[&(i.b as usize)]);
                fragment.build.ins().brif(truth, next, &[], target, &[]);
                unreachable = true;
            }
            Op::Assert => {
                let truth = fragment.truth(i.a);
                let message = i.b as usize;
                fragment
                    .return_unless(truth, faults.status(Fault::Assertion { function: k, message }));
            }
            Op::Call => site(fragment, i.a as usize),
            _ => fragment.compute(i),
        }
    }
    if !unreachable {
        fragment.return_status(0);
    }
}

/// A basic block for each jump target and each instruction after a jump.
fn leaders(
    fragment: &mut FragmentBuilder<'_, '_>,
    function: &FunctionCode,
) -> FastMap<usize, Block> {
    let mut blocks = FastMap::default();
    let mut lead = |at: usize| {
        blocks.entry(at).or_insert_with(|| fragment.build.create_block());
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

/// Emits a call that is made if its condition holds.
pub fn call(
    fragment: &mut FragmentBuilder<'_, '_>,
    site: &CallSite,
    function: &FunctionCode,
    code: FuncRef,
) {
    let Some(guard) = site.condition else { return emit_call(fragment, site, function, code) };
    let (needed, after) = (fragment.build.create_block(), fragment.build.create_block());
    let truth = fragment.truth(guard);
    fragment.build.ins().brif(truth, needed, &[], after, &[]);
    fragment.build.switch_to_block(needed);
    fragment.invalidate();
    emit_call(fragment, site, function, code);
    fragment.build.ins().jump(after, &[]);
    fragment.build.switch_to_block(after);
    fragment.invalidate();
}

/// Emits a call that is left out if the last one had the same arguments, as in `Machine::call`.
fn emit_call(
    fragment: &mut FragmentBuilder<'_, '_>,
    site: &CallSite,
    function: &FunctionCode,
    code: FuncRef,
) {
    let Some(last) = site.memo else { return emit_made_call(fragment, site, function, code) };
    let slots: Vec<(Slot, Slot)> = (last..).zip(site.args.iter().copied()).collect();
    let (changed, after) = (fragment.build.create_block(), fragment.build.create_block());
    let same = fragment.are_identical(&slots);
    fragment.build.ins().brif(same, after, &[], changed, &[]);
    fragment.build.switch_to_block(changed);
    fragment.invalidate();
    emit_made_call(fragment, site, function, code);
    for (copy, argument) in slots {
        let value = fragment.get(argument);
        fragment.set(copy, value);
    }
    fragment.build.ins().jump(after, &[]);
    fragment.build.switch_to_block(after);
    fragment.invalidate();
}

/// Emits a call with the same operations as `Machine::call`.
fn emit_made_call(
    fragment: &mut FragmentBuilder<'_, '_>,
    site: &CallSite,
    function: &FunctionCode,
    code: FuncRef,
) {
    let Some((output, argument)) = site.partial else {
        emit_body_call(fragment, site, function, code, None);
        for (to, from) in site.results.iter().zip(&function.outputs) {
            let value = fragment.get(*from);
            fragment.set(*to, value);
        }
        return;
    };
    let out = function.outputs[output];
    let replaced = |fragment: &mut FragmentBuilder<'_, '_>, sign: f64| {
        let x = fragment.get(site.args[argument]);
        let (zero, one) = (fragment.number(0.0), fragment.number(1.0));
        let at_zero = fragment.build.ins().fcmp(FloatCC::Equal, x, zero);
        let size = fragment.build.ins().fabs(x);
        let size = fragment.build.ins().select(at_zero, one, size);
        let factor = fragment.number(DIFFERENCE);
        let h = fragment.build.ins().fmul(factor, size);
        if sign > 0.0 { fragment.build.ins().fadd(x, h) } else { fragment.build.ins().fsub(x, h) }
    };
    let (x_above, x_below) = (replaced(fragment, 1.0), replaced(fragment, -1.0));
    emit_body_call(fragment, site, function, code, Some((argument, x_above)));
    let above = fragment.get(out);
    emit_body_call(fragment, site, function, code, Some((argument, x_below)));
    let below = fragment.get(out);
    let rise = fragment.build.ins().fsub(above, below);
    let run = fragment.build.ins().fsub(x_above, x_below);
    let slope = fragment.build.ins().fdiv(rise, run);
    fragment.set(site.results[0], slope);
}

/// Emits the solution of block `k` with the same operations as `TornBlockSolver::solve`.
pub fn scalar_block(
    fragment: &mut FragmentBuilder<'_, '_>,
    source: &Source,
    k: usize,
    faults: &mut Faults,
    call: &mut dyn FnMut(&mut FragmentBuilder<'_, '_>, usize),
) {
    let Some(block) = source.scalar_blocks[k] else { return };
    let mut run = |fragment: &mut FragmentBuilder<'_, '_>, tape: u32| {
        for i in &source.tapes[tape as usize] {
            match i.op {
                Op::Call => call(fragment, i.a as usize),
                _ => fragment.compute(i),
            }
        }
    };
    let zero = fragment.number(0.0);
    fragment.set(block.unknown, zero);
    run(fragment, block.residual_tape);
    run(fragment, block.jacobian_tape);
    let residual = fragment.get(block.residual);
    let (zero, infinity) = (fragment.number(0.0), fragment.number(f64::INFINITY));
    let size = fragment.build.ins().fabs(residual);
    let finite = fragment.build.ins().fcmp(FloatCC::LessThan, size, infinity);
    let status = faults.status(Fault::NotFinite { torn_block: k, residual: 0 });
    fragment.return_unless(finite, status);
    let pivot = fragment.get(block.pivot);
    let size = fragment.build.ins().fabs(pivot);
    let finite = fragment.build.ins().fcmp(FloatCC::LessThan, size, infinity);
    let nonzero = fragment.build.ins().fcmp(FloatCC::GreaterThan, size, zero);
    let regular = fragment.build.ins().band(finite, nonzero);
    let status = faults.status(Fault::Singular { torn_block: k, unknown: 0 });
    fragment.return_unless(regular, status);
    let negative = fragment.build.ins().fneg(residual);
    let solution = fragment.build.ins().fdiv(negative, pivot);
    fragment.set(block.unknown, solution);
    run(fragment, block.residual_tape);
}

fn emit_body_call(
    fragment: &mut FragmentBuilder<'_, '_>,
    site: &CallSite,
    function: &FunctionCode,
    code: FuncRef,
    replaced: Option<(usize, Value)>,
) {
    for local in &function.locals {
        let zero = fragment.number(0.0);
        fragment.set(*local, zero);
    }
    for (k, (to, from)) in function.inputs.iter().zip(&site.args).enumerate() {
        let value = match replaced {
            Some((argument, value)) if argument == k => value,
            _ => fragment.get(*from),
        };
        fragment.set(*to, value);
    }
    let status = fragment.call(code);
    fragment.return_on_fault(status);
}
