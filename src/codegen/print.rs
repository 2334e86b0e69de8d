//! A program as text, one instruction a line, for people who look for a mistake.

use std::fmt::Write;

use crate::base::index::FastMap;
use crate::ir::program::{Instr, Op, Program, Slot};

/// The tapes of a program in the order of running; empty ones are left out.
pub fn print(program: &Program) -> String {
    let names = names(program);
    let mut out = String::new();
    for (title, tape) in [
        ("parameters", &program.parameters),
        ("initial", &program.initial),
        ("event", &program.event),
        ("held", &program.held),
        ("derivatives", &program.rhs),
        ("jacobian", &program.jacobian),
        ("roots", &program.roots),
        ("rest", &program.rest),
    ] {
        section(program, &names, title, tape, &mut out);
    }
    for (k, solver) in program.solvers.iter().enumerate() {
        let kind = if solver.linear { "linear" } else { "nonlinear" };
        let title = format!("block {k}, {kind}, residuals");
        section(program, &names, &title, &solver.residual_tape, &mut out);
        section(program, &names, &format!("block {k}, jacobian"), &solver.jacobian_tape, &mut out);
    }
    for (k, mixed) in program.loops.iter().enumerate() {
        section(program, &names, &format!("loop {k}"), &mixed.tape, &mut out);
    }
    for (k, function) in program.functions.iter().enumerate() {
        section(program, &names, &format!("function {k}"), &function.tape, &mut out);
    }
    out
}

/// What the user or the specification calls a cell.
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
    for k in 0..program.watches.len() as Slot {
        names.insert(layout.relations + k, format!("relation[{}]", k + 1));
        names.insert(layout.fresh + k, format!("fresh[{}]", k + 1));
        names.insert(layout.gaps + k, format!("gap[{}]", k + 1));
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
            Op::Implicit => writeln!(out, "  differentiate block {}", i.a),
            Op::Repeat => writeln!(out, "  repeat loop {}", i.a),
            Op::Call => writeln!(out, "  {dst} := call {}", i.a),
            Op::Jump => writeln!(out, "  go to {}", i.a),
            Op::JumpUnless => writeln!(out, "  unless {a} go to {}", i.b),
            Op::Assert => writeln!(out, "  assert {a}"),
        };
    }
}
