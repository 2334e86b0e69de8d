//! Runs that must fail with a useful message.

use super::builder::Builder;
use crate::ir::dae::{GuardedAssert, Trigger};
use crate::ir::expr::{Binary, Unary};
use crate::ir::flat::{Assert, AssertionLevel};
use mocc_engine::simulate::failure::FailureKind;

#[test]
fn the_root_of_a_negative_number_is_named() {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 1.0);
    let minus_one = b.real(-1.0);
    b.assign(dx, minus_one);
    let (y, y_read) = b.algebraic("y");
    let root = b.g().unary(Unary::Sqrt, x);
    b.assign(y, root);
    let (_, _, dz) = b.state("z", 0.0);
    b.assign(dz, y_read);
    let failure = b.run(2.0, 1e-6).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Numerics);
    assert!((failure.time - 1.0).abs() < 1e-3, "{}", failure.time);
    let message = &failure.diagnostic.message;
    assert!(message.contains("root of a negative number: `x` is -"), "{message}");
    assert_eq!(failure.diagnostic.primary.1, "in `y = sqrt(x)`");
    assert!(!failure.diagnostic.primary.0.is_none());
}

#[test]
fn a_division_by_zero_is_named() {
    let mut b = Builder::new();
    let (_, d) = b.parameter("d", 0.0);
    let (_, x, dx) = b.state("x", 1.0);
    let quotient = b.g().div(x, d);
    b.assign(dx, quotient);
    let failure = b.run(1.0, 1e-6).unwrap_err();
    let message = &failure.diagnostic.message;
    assert!(message.contains("division by zero: `d` is 0 in `x / d`"), "{message}");
}

#[test]
fn a_singular_linear_equation_names_variable_and_equation() {
    let mut b = Builder::new();
    let (_, k) = b.parameter("k", 0.0);
    let (_, x, dx) = b.state("x", 1.0);
    let (y, y_read) = b.algebraic("y");
    let product = b.g().mul(k, y_read);
    b.torn(&[y], vec![], &[(product, x)], true);
    b.assign(dx, y_read);
    let failure = b.run(1.0, 1e-6).unwrap_err();
    let message = &failure.diagnostic.message;
    assert!(message.contains("do not determine `y`"), "{message}");
    assert_eq!(failure.diagnostic.primary.1, "k * y = x");
}

#[test]
fn chattering_is_reported() {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 0.1);
    let zero = b.real(0.0);
    let positive = b.relation(x, Binary::Greater, zero, Trigger::State);
    // Two relations: there is no combination of two sides that keeps both.
    let negative = b.relation(x, Binary::Less, zero, Trigger::State);
    let (one, two, minus) = (b.real(1.0), b.real(2.0), b.real(-1.0));
    let below = b.g().if_then_else(negative, one, two);
    let slope = b.g().if_then_else(positive, minus, below);
    b.assign(dx, slope);
    let failure = b.run(1.0, 1e-6).unwrap_err();
    let message = &failure.diagnostic.message;
    assert!(message.contains("`x > 0.0` switches without end"), "{message}");
    assert!((failure.time - 0.1).abs() < 1e-6);
    assert!(!failure.diagnostic.primary.0.is_none());
}

#[test]
fn a_pole_ends_the_run() {
    let mut b = Builder::new();
    let (_, x, dx) = b.state("x", 1.0);
    let square = b.g().mul(x, x);
    b.assign(dx, square);
    // x = 1 / (1 - t)
    let failure = b.run(2.0, 1e-6).unwrap_err();
    assert!((failure.time - 1.0).abs() < 1e-3, "{}", failure.time);
    assert!(failure.diagnostic.message.contains("x"), "{}", failure.diagnostic.message);
}

#[test]
fn assertions_fail_and_warnings_are_said_once() {
    for warning in [false, true] {
        let mut b = Builder::new();
        let (_, x, dx) = b.state("x", 0.0);
        let one = b.real(1.0);
        b.assign(dx, one);
        let half = b.real(0.5);
        let condition = b.relation(x, Binary::Less, half, Trigger::State);
        let message = b.g().string("x is too large");
        let origin = b.origin("assert(x < 0.5, \"x is too large\");");
        let level = if warning { AssertionLevel::Warning } else { AssertionLevel::Error };
        let assert = Assert { condition, message, level };
        b.blocks.dae.asserts.push(GuardedAssert { active: None, assert, origin });
        match b.run(1.0, 1e-6) {
            Ok(run) => {
                assert!(warning);
                assert_eq!(run.statistics.warnings.len(), 1);
                assert!(run.statistics.warnings[0].message.ends_with("x is too large"));
            }
            Err(failure) => {
                assert!(!warning);
                assert_eq!(failure.kind, FailureKind::Assertion);
                assert!((failure.time - 0.5).abs() < 1e-9);
                assert_eq!(failure.diagnostic.primary.1, "`x < 0.5` is false");
            }
        }
    }
}
