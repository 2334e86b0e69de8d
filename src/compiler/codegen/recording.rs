//! Selects the variables that a run records, and removes code that serves only the others.

use crate::ir::dae::{Dae, Variable, VariableKind};
use crate::ir::expr::{Type, VarId};
use crate::ir::program::{Entry, Instr, Op, Program, RelationTrigger, Slot};

use super::rows;

/// All declared variables whose values a run computes: variables that may vary, and parameters that
/// initialization determines. If there are none, the parameters are the result.
pub fn all(dae: &Dae) -> Vec<VarId> {
    let varying = varying(dae);
    if varying.is_empty() { fixed(dae) } else { varying }
}

/// All parameters and constants whose values are known before the run; they are not recorded.
pub fn constants(dae: &Dae) -> Vec<VarId> {
    if varying(dae).is_empty() { Vec::new() } else { fixed(dae) }
}

fn varying(dae: &Dae) -> Vec<VarId> {
    selected(dae, |kind| kind != VariableKind::Parameter)
}

fn fixed(dae: &Dae) -> Vec<VarId> {
    selected(dae, |kind| kind == VariableKind::Parameter)
}

fn selected(dae: &Dae, wanted: impl Fn(VariableKind) -> bool) -> Vec<VarId> {
    let is_selected = |v: &Variable| wanted(v.kind) && !v.hidden && v.ty != Type::String;
    dae.variables.enumerate().filter(|(_, v)| is_selected(v)).map(|(v, _)| v).collect()
}

/// Restricts the recorded variables to those whose names `keep` accepts, and removes instructions
/// from the tape `outputs` that nothing else reads: in a large model most of the work between
/// steps. If few instructions remain, rows get a tape of their own ([`Program::rows`]).
pub fn only(program: &mut Program, keep: impl Fn(&str) -> bool) {
    let variables = &program.blocks.dae.variables;
    program.recorded.retain(|v| keep(&variables[*v].name));
    program.constants.retain(|v| keep(&variables[*v].name));
    let mut needed = slots_read_elsewhere(program);
    for v in &program.recorded {
        needed[program.slot(*v) as usize] = true;
    }
    let mut needed_code: Vec<Instr> = Vec::with_capacity(program.tapes.outputs.len());
    for instr in program.tapes.outputs.iter().rev() {
        let is_needed = match instr.op {
            Op::Solve | Op::Differentiate | Op::Iterate | Op::Call => true,
            Op::Jump | Op::JumpUnless | Op::Assert => true,
            _ => needed[instr.dst as usize],
        };
        if is_needed {
            operands(instr, &mut |slot| needed[slot as usize] = true);
            needed_code.push(*instr);
        }
    }
    needed_code.reverse();
    needed_code.shrink_to_fit();
    *program.tapes.outputs = needed_code;
    program.rows = rows::tape(program);
    program.number_tapes();
}

/// For each slot, whether anything other than the tape `outputs` reads it.
fn slots_read_elsewhere(program: &Program) -> Vec<bool> {
    let mut needed = vec![false; program.image.len()];
    let mut mark = |slot: Slot| needed[slot as usize] = true;
    let blocks =
        program.routines.torn_blocks.iter().flat_map(|s| [&s.residual_tape, &s.jacobian_tape]);
    let mixed_blocks = program.routines.mixed_blocks.iter().flat_map(|m| [&m.decisions, &m.tape]);
    let own = [
        &program.tapes.initial,
        &program.tapes.initial_by_states,
        &program.tapes.event,
        &program.tapes.decided,
        &program.tapes.discrete,
        &program.tapes.rhs,
        &program.tapes.roots,
    ];
    for tape in own
        .into_iter()
        .chain([&program.tapes.jacobian, &program.tapes.state_selection])
        .chain(blocks)
        .chain(mixed_blocks)
    {
        tape.iter().for_each(|i| operands(i, &mut mark));
    }
    let entry = |e: &Entry| e.slot;
    for s in &program.routines.torn_blocks {
        s.slots.iter().chain(&s.residuals).chain(&s.nominals).for_each(|c| mark(*c));
        s.bounds.iter().for_each(|(min, max)| [*min, *max].into_iter().for_each(&mut mark));
        s.jacobian.iter().map(entry).for_each(&mut mark);
    }
    for i in &program.routines.block_derivatives {
        i.jacobian.iter().chain(&i.seeds).map(entry).for_each(&mut mark);
    }
    program.jacobian_entries.iter().map(entry).for_each(&mut mark);
    if let Some(forcing) = &program.forcing {
        forcing.tape.iter().for_each(|i| operands(i, &mut mark));
        forcing.entries.iter().map(entry).for_each(&mut mark);
    }
    program
        .routines
        .calls
        .iter()
        .flat_map(|c| c.args.iter().chain(&c.condition))
        .for_each(|c| mark(*c));
    let layout = &program.layout;
    layout.derivatives.iter().chain(&layout.nominals).for_each(|c| mark(*c));
    layout.pre.iter().for_each(|(_, slot, pre)| [*slot, *pre].into_iter().for_each(&mut mark));
    let relations = program.events.relation_triggers.len() as Slot;
    for first in [layout.relations, layout.candidates, layout.indicators] {
        (first..first + relations).for_each(&mut mark);
    }
    for trigger in &program.events.relation_triggers {
        if let RelationTrigger::Time(slot) = trigger {
            mark(*slot);
        }
    }
    program.events.clocks.iter().flat_map(|c| [c.start, c.interval, c.flag]).for_each(&mut mark);
    program.events.reinits.iter().flat_map(|r| [r.active, r.state, r.value]).for_each(&mut mark);
    program.events.asserts.iter().flat_map(|a| [a.active, a.condition]).for_each(&mut mark);
    program.events.terminates.iter().for_each(|c| mark(*c));
    // What histories record and are read by.
    layout.delays.iter().flat_map(|d| [d.source, d.delay]).for_each(&mut mark);
    for line in &layout.transports {
        line.ends.iter().chain(line.entering.iter().flatten()).for_each(|c| mark(*c));
        line.readers.iter().for_each(|r| mark(r.place));
    }
    let sets = program.state_sets.iter();
    sets.flat_map(|s| s.candidates.iter().chain(&s.nominals)).for_each(|c| mark(*c));
    needed
}

/// Calls `visit` with the operand slots of an instruction.
pub(super) fn operands(instr: &Instr, visit: &mut impl FnMut(Slot)) {
    match instr.op {
        Op::Solve | Op::Differentiate | Op::Iterate | Op::Call | Op::Jump => {}
        Op::JumpUnless | Op::Assert => visit(instr.a),
        Op::CopyIf => [instr.dst, instr.a, instr.b].into_iter().for_each(visit),
        _ => [instr.a, instr.b].into_iter().for_each(visit),
    }
}
