//! What lands on which tape.

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
    assert_eq!(count(&program.rhs, Op::Mul), 1);
    assert_eq!(program.rhs.len(), 3);
    // d der(x) / dx = -y, and so on: the constant ones need no instruction.
    assert_eq!(program.jacobian_entries.len(), 4);
}

#[test]
fn what_changes_rarely_is_computed_rarely() {
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
    // a * b once per run; d * a after events; the rest, one product and one sum, always.
    assert_eq!(count(&program.parameters, Op::Mul), 1);
    assert_eq!(count(&program.held, Op::Mul), 1);
    assert_eq!((count(&program.rhs, Op::Mul), program.rhs.len()), (1, 2));
    // d der(x) / dx = a * b is known before the run begins.
    assert!(program.jacobian.is_empty());
}

#[test]
fn derivatives_do_not_wait_for_what_is_only_shown() {
    let program = compiled(
        "Real x(start = 1, fixed = true);
        Real shown;
        equation
        der(x) = -x;
        shown = sin(x) + exp(x);",
    );
    assert_eq!(program.rhs.len(), 1);
    assert!(program.roots.is_empty());
    assert_eq!(program.rest.len(), 3);
}

#[test]
fn a_program_can_be_read() {
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
    held:
      $31 := 0
      $31 := $29 if relation[1]
    derivatives:
      $24 := k * x
      $25 := -$24
      der(x) := 1
      der(x) := $25 if relation[1]
    roots:
      fresh[1] := x > 0.5
      gap[1] := x - 0.5
    ");
}
