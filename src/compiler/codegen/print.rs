//! Listing of a program for debugging, one instruction per line.

use std::fmt::Write;

use crate::base::index::FastMap;
use crate::ir::program::{Instr, Op, Program, Slot};

/// The nonempty tapes of a program in order of execution.
pub fn print(program: &Program) -> String {
    let names = names(program);
    let mut out = String::new();
    for (title, tape) in [
        ("parameters", &program.tapes.parameters),
        ("initial", &program.tapes.initial),
        ("event", &program.tapes.event),
        ("discrete", &program.tapes.discrete),
        ("derivatives", &program.tapes.rhs),
        ("jacobian", &program.tapes.jacobian),
        ("roots", &program.tapes.roots),
        ("outputs", &program.tapes.outputs),
    ] {
        section(program, &names, title, tape, &mut out);
    }
    for (k, torn_block) in program.routines.torn_blocks.iter().enumerate() {
        let kind = if torn_block.linear { "linear" } else { "nonlinear" };
        let title = format!("block {k}, {kind}, residuals");
        section(program, &names, &title, &torn_block.residual_tape, &mut out);
        section(
            program,
            &names,
            &format!("block {k}, jacobian"),
            &torn_block.jacobian_tape,
            &mut out,
        );
    }
    for (k, mixed) in program.routines.mixed_blocks.iter().enumerate() {
        let title = format!("mixed block {k}, decisions");
        section(program, &names, &title, &mixed.decisions, &mut out);
        section(program, &names, &format!("mixed block {k}"), &mixed.tape, &mut out);
    }
    for (k, function) in program.routines.functions.iter().enumerate() {
        section(program, &names, &format!("function {k}"), &function.tape, &mut out);
    }
    out
}

/// Names of slots, in terms of the model or the specification.
fn names(program: &Program) -> FastMap<Slot, String> {
    let layout = &program.layout;
    let mut names: FastMap<Slot, String> = FastMap::default();
    names.insert(layout.time, "time".into());
    names.insert(layout.initial, "initial()".into());
    names.insert(layout.terminal, "terminal()".into());
    for (v, variable) in program.blocks.dae.variables.enumerate() {
        names.insert(program.slot(v), variable.name.clone());
    }
    for (v, _, slot) in &layout.pre {
        names.insert(*slot, format!("pre({})", program.name(*v)));
    }
    for (v, input) in &layout.parameter_inputs {
        names.insert(*input, format!("input({})", program.name(*v)));
    }
    for (v, input, start) in &layout.starts {
        names.insert(*input, format!("input(start of {})", program.name(*v)));
        names.insert(*start, format!("start({})", program.name(*v)));
    }
    for k in 0..program.events.relation_triggers.len() as Slot {
        names.insert(layout.relations + k, format!("relation[{}]", k + 1));
        names.insert(layout.candidates + k, format!("candidate[{}]", k + 1));
        names.insert(layout.indicators + k, format!("indicator[{}]", k + 1));
    }
    names
}

fn section(
    program: &Program,
    names: &FastMap<Slot, String>,
    title: &str,
    tape: &[Instr],
    out: &mut String,
) {
    if tape.is_empty() {
        return;
    }
    let cell = |slot: Slot| match names.get(&slot) {
        Some(name) => name.clone(),
        None => format!("${slot}"),
    };
    let operand = |slot: Slot| match program.image.get(slot as usize) {
        Some(value) if program.literals.binary_search(&slot).is_ok() => format!("{value}"),
        _ => cell(slot),
    };
    // Writing to a String does not fail.
    let _ = writeln!(out, "{title}:");
    for i in tape {
        let (dst, a, b) = (cell(i.dst), operand(i.a), operand(i.b));
        let _ = match i.op {
            Op::Copy => writeln!(out, "  {dst} := {a}"),
            Op::CopyIf => writeln!(out, "  {dst} := {b} if {a}"),
            Op::Input => writeln!(out, "  {dst} := {b} or else {a}"),
            Op::Add => writeln!(out, "  {dst} := {a} + {b}"),
            Op::Sub => writeln!(out, "  {dst} := {a} - {b}"),
            Op::Mul => writeln!(out, "  {dst} := {a} * {b}"),
            Op::Div => writeln!(out, "  {dst} := {a} / {b}"),
            Op::Neg => writeln!(out, "  {dst} := -{a}"),
            Op::Unary(op) => writeln!(out, "  {dst} := {}({a})", op.name()),
            Op::Binary(op) => writeln!(out, "  {dst} := {a} {} {b}", op.name()),
            Op::Solve => writeln!(out, "  solve block {}", i.a),
            Op::Differentiate => writeln!(out, "  differentiate block {}", i.a),
            Op::Iterate => writeln!(out, "  iterate mixed block {}", i.a),
            Op::Call => writeln!(out, "  {dst} := call {}", i.a),
            Op::Jump => writeln!(out, "  go to {}", i.a),
            Op::JumpUnless => writeln!(out, "  unless {a} go to {}", i.b),
            Op::Assert => writeln!(out, "  assert {a}"),
        };
    }
}
