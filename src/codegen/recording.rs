//! What a run records, and the part of the program that only serves what it does not.

use crate::ir::dae::{Dae, Kind, Variable};
use crate::ir::expr::{Type, VarId};
use crate::ir::program::{Entry, Instr, Op, Program, Slot, Watch};

/// All variables that the user declared and whose values a run finds: those that move, and
/// parameters that initialisation determines. Of a model without any its parameters are the result.
pub fn all(dae: &Dae) -> Vec<VarId> {
    let found = found(dae);
    if found.is_empty() { known(dae) } else { found }
}

/// All parameters and constants whose values are known before a run, and which are not recorded.
pub fn constants(dae: &Dae) -> Vec<VarId> {
    if found(dae).is_empty() { Vec::new() } else { known(dae) }
}

fn found(dae: &Dae) -> Vec<VarId> {
    shown(dae, |kind| kind != Kind::Parameter)
}

fn known(dae: &Dae) -> Vec<VarId> {
    shown(dae, |kind| kind == Kind::Parameter)
}

fn shown(dae: &Dae, wanted: impl Fn(Kind) -> bool) -> Vec<VarId> {
    let is_shown = |v: &Variable| wanted(v.kind) && !v.hidden && v.ty != Type::String;
    dae.variables.enumerate().filter(|(_, v)| is_shown(v)).map(|(v, _)| v).collect()
}

/// Restricts what is recorded to the variables whose names `keep` accepts, and drops from the tape
/// `rest` what nothing else reads: in a large model most of the work between steps.
pub fn only(program: &mut Program, keep: impl Fn(&str) -> bool) {
    let variables = &program.blocks.dae.variables;
    program.recorded.retain(|v| keep(&variables[*v].name));
    program.constants.retain(|v| keep(&variables[*v].name));
    let mut needed = read_elsewhere(program);
    for v in &program.recorded {
        needed[program.slot(*v) as usize] = true;
    }
    let mut kept: Vec<Instr> = Vec::with_capacity(program.rest.len());
    for instr in program.rest.iter().rev() {
        let serves = match instr.op {
            Op::Solve | Op::Implicit | Op::Repeat | Op::Call => true,
            Op::Jump | Op::JumpUnless | Op::Assert => true,
            _ => needed[instr.dst as usize],
        };
        if serves {
            read_by(instr, &mut |slot| needed[slot as usize] = true);
            kept.push(*instr);
        }
    }
    kept.reverse();
    kept.shrink_to_fit();
    *program.rest = kept;
}

/// Cells that anything but the tape `rest` reads, by cell.
fn read_elsewhere(program: &Program) -> Vec<bool> {
    let mut needed = vec![false; program.image.len()];
    let mut mark = |slot: Slot| needed[slot as usize] = true;
    let blocks = program.solvers.iter().flat_map(|s| [&s.residual_tape, &s.jacobian_tape]);
    let loops = program.loops.iter().map(|l| &l.tape);
    let own = [&program.initial, &program.event, &program.held, &program.rhs, &program.roots];
    for tape in own.into_iter().chain([&program.jacobian]).chain(blocks).chain(loops) {
        tape.iter().for_each(|i| read_by(i, &mut mark));
    }
    let entry = |e: &Entry| e.slot;
    for s in &program.solvers {
        s.slots.iter().chain(&s.residuals).chain(&s.nominals).for_each(|c| mark(*c));
        s.bounds.iter().for_each(|(min, max)| [*min, *max].into_iter().for_each(&mut mark));
        s.jacobian.iter().map(entry).for_each(&mut mark);
    }
    for i in &program.implicits {
        i.jacobian.iter().chain(&i.seeds).map(entry).for_each(&mut mark);
    }
    program.jacobian_entries.iter().map(entry).for_each(&mut mark);
    program.calls.iter().flat_map(|c| c.args.iter().chain(&c.guard)).for_each(|c| mark(*c));
    let layout = &program.layout;
    layout.derivatives.iter().chain(&layout.nominals).for_each(|c| mark(*c));
    layout.pre.iter().for_each(|(_, slot, pre)| [*slot, *pre].into_iter().for_each(&mut mark));
    let relations = program.watches.len() as Slot;
    for first in [layout.relations, layout.fresh, layout.gaps] {
        (first..first + relations).for_each(&mut mark);
    }
    for watch in &program.watches {
        if let Watch::Time(slot) = watch {
            mark(*slot);
        }
    }
    program.clocks.iter().flat_map(|c| [c.start, c.interval, c.flag]).for_each(&mut mark);
    program.reinits.iter().flat_map(|r| [r.active, r.state, r.value]).for_each(&mut mark);
    program.asserts.iter().flat_map(|a| [a.active, a.condition]).for_each(&mut mark);
    program.terminates.iter().for_each(|c| mark(*c));
    needed
}

/// Calls `visit` with the cells that an instruction names as operands.
fn read_by(instr: &Instr, visit: &mut impl FnMut(Slot)) {
    match instr.op {
        Op::Solve | Op::Implicit | Op::Repeat | Op::Call | Op::Jump => {}
        Op::JumpUnless | Op::Assert => visit(instr.a),
        Op::CopyIf => [instr.dst, instr.a, instr.b].into_iter().for_each(visit),
        _ => [instr.a, instr.b].into_iter().for_each(visit),
    }
}
