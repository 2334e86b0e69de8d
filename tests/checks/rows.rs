//! What is recorded does not change it: a run that records little evaluates only that between its steps.

use mocc::codegen::recording;
use mocc::runtime::jit::tiering::Execution;

use super::door::{Case, Compiled};

/// Models with events, jumps and assertions, and variables of which some are states and some are not.
const CASES: [(&str, &[&str]); 3] = [
    ("examples/valve52.mol", &["spool.s"]),
    ("examples/valve52.mol", &["s", "p14", "chamber_4.p"]),
    ("examples/valve32.mol", &["p2"]),
];

fn restricted(case: &Case, names: &[&str]) -> Compiled {
    let mut compiled = case.compile();
    recording::only(&mut compiled.program, |name| names.contains(&name));
    compiled
}

#[test]
fn rows_of_a_few_variables_are_those_of_all() {
    for (file, names) in CASES {
        let case = Case::file(file);
        let all = case.compile().run();
        let mut some = restricted(&case, names);
        assert!(some.program.rows.is_some(), "{file}: {names:?}");
        for execution in [Execution::Interpreted, Execution::translated(&some.program)] {
            some.execute(execution);
            let few = some.run();
            assert_eq!(few.columns.len(), names.len(), "{file}: {names:?}");
            assert_eq!(few.time, all.time, "{file}: {names:?}");
            assert_eq!(few.events, all.events, "{file}: {names:?}");
            for column in &few.columns {
                assert_eq!(
                    few.values(&column.name),
                    all.values(&column.name),
                    "{file}: {}",
                    column.name
                );
            }
        }
    }
}

/// What is delayed is recorded in a history whether or not it is in the result.
#[test]
fn histories_do_not_depend_on_what_is_recorded() {
    let model = "model Delayed
        Real x(start = 0, fixed = true);
        Real u(start = 0, fixed = true);
        Real y = delay(2*x, 0.25);
        Real out0, out1;
      equation
        der(x) = 1;
        der(u) = cos(time);
        (out0, out1) = spatialDistribution(3*u, 0, x, true, {0, 1}, {0, 0});
        annotation(experiment(StopTime = 2));
      end Delayed;";
    let case = Case::text(model);
    let all = case.compile().run();
    let last = |name: &str| *all.values(name).expect("a column").last().expect("a row");
    assert!((last("y") - 3.5).abs() < 1e-6, "{}", last("y"));
    // What enters at a time when x was 1 less leaves now.
    assert!((last("out1") - 3.0 * 1.0_f64.sin()).abs() < 1e-3, "{}", last("out1"));
    for name in ["y", "out1"] {
        let few = restricted(&case, &[name]).run();
        assert_eq!(few.values(name), all.values(name), "{name}");
    }
}

#[test]
fn slopes_of_a_few_variables_are_those_of_all() {
    let (case, inputs) = (Case::file("examples/valve52.mol"), ["F_Coulomb", "t_delay"]);
    let all = case.compile().differentiate(&inputs);
    let few = restricted(&case, &["s", "p14"]).differentiate(&inputs);
    for (k, input) in inputs.iter().enumerate() {
        for name in ["s", "p14"] {
            assert_eq!(few.by(k, name), all.by(k, name), "{name} by {input}");
        }
    }
}

/// An assertion that holds at the ends of the steps is checked in the rows between them, by the same message.
#[test]
fn assertions_are_checked_in_rows() {
    let text = "
model Pulse
  Real x(start = 0, fixed = true);
  Real v(start = 0, fixed = true);
  Real y = x*x;
  Real z1 = sin(x)*cos(v) + exp(-x*x);
  Real z2 = z1*z1 + sin(v + z1)*exp(-z1*z1);
equation
  der(x) = v;
  der(v) = 1 - 4*x;
  assert(y < 0.24, \"x is large\");
end Pulse;";
    let case = Case::text(text).stop(3.0).interval(0.01);
    let all = case.compile().fails();
    let few = restricted(&case, &["x"]);
    assert!(few.program.rows.is_some());
    assert!(all.contains("x is large"), "{all}");
    assert_eq!(few.fails(), all);
}
