//! Tests which tape expressions are emitted to.

use super::compile;
use crate::base::diag::Problems;
use crate::ir::program::{Op, Program};
use crate::lower::fixture::model;
use crate::lower::lower;
use crate::structure::structure;

fn compiled(text: &str) -> Program {
    let (flat, _) = model(text);
    let mut problems = Problems::new();
    let blocks = lower(flat, &mut problems).and_then(|dae| structure(dae, &mut problems));
    let program = compile(blocks.unwrap()).unwrap_or_else(|p| panic!("{p:?}"));
    assert_eq!(program.verify(), Ok(()));
    program
}

fn count(tape: &[crate::ir::program::Instr], op: Op) -> usize {
    tape.iter().filter(|i| i.op == op).count()
}

#[test]
fn equal_expressions_are_computed_once_for_all_blocks() {
    let program = compiled(
        "Real x(start = 1, fixed = true);
        Real y(start = 1, fixed = true);
        equation
        der(x) = y - x * y;
        der(y) = x * y - x;",
    );
    assert_eq!(count(&program.tapes.rhs, Op::Mul), 1);
    assert_eq!(program.tapes.rhs.len(), 3);
    // d der(x) / dx = -y, and so on: the constant ones need no instruction.
    assert_eq!(program.jacobian_entries.len(), 4);
}

#[test]
fn expressions_are_computed_at_the_lowest_possible_rate() {
    let program = compiled(
        "parameter Real a = 2;
        parameter Real b = 3;
        Real x(start = 1, fixed = true);
        discrete Real d(start = 0);
        equation
        der(x) = a * b * x + d * a;
        when sample(0, 1) then
        d = x;
        end when;",
    );
    // a * b once per run; d * a after events; the remaining product and sum on each evaluation.
    assert_eq!(count(&program.tapes.parameters, Op::Mul), 1);
    assert_eq!(count(&program.tapes.discrete, Op::Mul), 1);
    assert_eq!((count(&program.tapes.rhs, Op::Mul), program.tapes.rhs.len()), (1, 2));
    // d der(x) / dx = a * b is known before the run begins.
    assert!(program.tapes.jacobian.is_empty());
}

#[test]
fn recorded_only_expressions_are_not_on_the_rhs_tape() {
    let program = compiled(
        "Real x(start = 1, fixed = true);
        Real shown;
        equation
        der(x) = -x;
        shown = sin(x) + exp(x);",
    );
    assert_eq!(program.tapes.rhs.len(), 1);
    assert!(program.tapes.roots.is_empty());
    assert_eq!(program.tapes.outputs.len(), 3);
}

#[test]
fn the_listing_of_a_program() {
    let program = compiled(
        "parameter Real k = 2;
        Real x(start = 1, fixed = true);
        equation
        der(x) = if x > 0.5 then -k * x else 1;",
    );
    insta::assert_snapshot!(super::print::print(&program), @r"
    parameters:
      k := input(k) or else 2
      start(x) := input(start of x) or else 1
      $29 := -k
    initial:
      x := start(x)
      relation[1] := x > 0.5
      $17 := k * x
      $18 := -$17
      der(x) := 1
      der(x) := $18 if relation[1]
    event:
      relation[1] := x > 0.5
      $21 := k * x
      $22 := -$21
      der(x) := 1
      der(x) := $22 if relation[1]
    discrete:
      $31 := 0
      $31 := $29 if relation[1]
    derivatives:
      $24 := k * x
      $25 := -$24
      der(x) := 1
      der(x) := $25 if relation[1]
    roots:
      candidate[1] := x > 0.5
      indicator[1] := x - 0.5
    ");
}
