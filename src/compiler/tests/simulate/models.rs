//! Whole models, from flat equations to the trajectory.

use crate::base::diag::Problems;
use crate::base::render::{Style, render};
use crate::base::source::SourceMap;
use crate::codegen::compile;
use crate::ir::flat::Experiment;
use crate::ir::program::Program;
use crate::lower::fixture::model;
use crate::lower::lower;
use crate::structure::structure;
use mocc_engine::simulate::failure::Failure;
use mocc_engine::simulate::run::{Run, simulate};
use mocc_engine::simulate::settings::Settings;

pub fn compiled(text: &str) -> (Program, SourceMap) {
    let (flat, sources) = model(text);
    let mut problems = Problems::new();
    let blocks = lower(flat, &mut problems).and_then(|dae| structure(dae, &mut problems));
    let program = match compile(blocks.unwrap_or_else(|| panic!("{problems:?}"))) {
        Ok(program) => program,
        Err(problems) => panic!("{problems:?}"),
    };
    assert_eq!(program.verify(), Ok(()));
    (program, sources)
}

pub fn run(text: &str, stop: f64) -> Result<Run, Failure> {
    let (program, sources) = compiled(text);
    let settings = Settings {
        stop,
        interval: stop / 100.0,
        tolerance: 1e-8,
        ..Settings::of(&Experiment::default())
    };
    let run = simulate(&program, &settings, &sources)?;
    assert_eq!(run.trajectory.verify(), Ok(()));
    Ok(run)
}

pub fn last(run: &Run, name: &str) -> f64 {
    *run.trajectory.values(name).unwrap().last().unwrap()
}

#[test]
fn a_circuit_with_eliminated_variables_records_them_all() {
    let run = run(
        "parameter Real R = 10;
        parameter Real C = 0.1;
        Real u;
        Real v(start = 0, fixed = true);
        Real i;
        Real i2;
        Real minus;
        equation
        u = R * i + v;
        u = 5;
        C * der(v) = i;
        i2 = i;
        minus = -v;",
        2.0,
    )
    .unwrap();
    // v = u (1 - exp(-t / R C)), R C = 1 s
    let v = 5.0 * (1.0 - (-2.0f64).exp());
    assert!((last(&run, "v") - v).abs() < 1e-7);
    assert_eq!(last(&run, "minus"), -last(&run, "v"));
    assert_eq!(last(&run, "i2"), last(&run, "i"));
    let names: Vec<&str> = run.trajectory.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names[..5], ["u", "v", "i", "i2", "minus"]);
}

/// The pendulum as a constraint, against the same one in its angle.
#[test]
fn the_cartesian_pendulum_follows_the_angle() {
    let cartesian = run(
        "Real x(start = 0.6);
        Real y(start = -0.8);
        Real w;
        Real z;
        Real T;
        equation
        der(x) = w;
        der(y) = z;
        der(w) = T * x;
        der(z) = T * y - 9.81;
        x^2 + y^2 = 1;",
        0.5,
    )
    .unwrap();
    let polar = run(
        "Real a(start = 0.6435011087932844, fixed = true);
        Real w(start = 0, fixed = true);
        equation
        der(a) = w;
        der(w) = -9.81 * sin(a);",
        0.5,
    )
    .unwrap();
    let a = last(&polar, "a");
    assert!(
        (last(&cartesian, "x") - a.sin()).abs() < 1e-6,
        "{} {}",
        last(&cartesian, "x"),
        a.sin()
    );
    assert!((last(&cartesian, "y") + a.cos()).abs() < 1e-6);
}

#[test]
fn a_parameter_is_found_by_initialisation() {
    let run = run(
        "parameter Real k(fixed = false);
        Real x(start = 2, fixed = true);
        Real y;
        initial equation
        der(x) = 0;
        der(y) = 0;
        equation
        der(x) = 1 - k * x;
        der(y) = x - y;",
        1.0,
    )
    .unwrap();
    // k = 1 / 2; everything rests, to the bit.
    assert!(run.trajectory.values("x").unwrap().iter().all(|x| *x == 2.0));
    assert!(run.trajectory.values("y").unwrap().iter().all(|y| *y == 2.0));
}

/// `d = (d + t) / 2` at each tick: `d = t`.
#[test]
fn a_mixed_block_is_repeated_to_its_fixed_point() {
    let run = run(
        "Real y;
        discrete Real d;
        equation
        y = d + time;
        when sample(0, 1) then
        d = 0.5 * y;
        end when;",
        2.5,
    )
    .unwrap();
    assert_eq!((last(&run, "d"), last(&run, "y")), (2.0, 4.5));
}

/// The ball of the Modelica specification comes to rest on the floor.
#[test]
fn the_ball_comes_to_rest() {
    let run = run(
        "Real h(start = 1, fixed = true);
        Real v(start = 0, fixed = true);
        Boolean flying(start = true);
        Boolean impact;
        equation
        v = der(h);
        der(v) = if flying then -9.81 else 0;
        impact = h <= 0;
        when {impact, h <= 0 and v <= 0} then
        flying = v <= -0.01;
        reinit(v, if flying then -0.7 * v else 0);
        end when;",
        3.0,
    )
    .unwrap();
    assert_eq!((last(&run, "flying"), last(&run, "v")), (0.0, 0.0));
    assert!(last(&run, "h").abs() < 1e-12, "{}", last(&run, "h"));
    let h = run.trajectory.values("h").unwrap();
    let resting = run.trajectory.time.iter().position(|t| *t > 2.7).unwrap();
    assert!(h[resting..].iter().all(|x| x.to_bits() == h[resting].to_bits()));
}

/// A mass on a slowly loaded spring sticks until the load passes the grip, then slides.
#[test]
fn a_stuck_mass_rests_to_the_bit_and_breaks_away_once() {
    let run = run(
        "Real s(start = 0.25, fixed = true);
        Real v(start = 0, fixed = true);
        Real a;
        Real f;
        Boolean stuck(start = true);
        equation
        f = 10 * time;
        stuck = pre(stuck) and f < 4;
        der(s) = v;
        der(v) = a;
        a = if stuck then 0 else (f - 3) / 2;",
        1.0,
    )
    .unwrap();
    let rows = run.trajectory.time.iter().zip(run.trajectory.values("s").unwrap());
    assert!(rows.filter(|(t, _)| **t < 0.4).all(|(_, s)| *s == 0.25));
    assert_eq!(run.trajectory.events.len(), 1);
    assert!((run.trajectory.events[0].time - 0.4).abs() < 1e-14);
    // v = (5 t^2 - 3 t) / 2 from t = 0.4.
    let v = |t: f64| (5.0 * t * t - 3.0 * t) / 2.0;
    assert!((last(&run, "v") - (v(1.0) - v(0.4))).abs() < 1e-9);
}

/// A sampled PI controller, against its recurrence.
#[test]
fn a_sampled_controller_holds_its_output() {
    let run = run(
        "Real x(start = 0, fixed = true);
        discrete Real e(start = 0);
        discrete Real sum(start = 0);
        discrete Real u(start = 0);
        equation
        der(x) = u - x;
        when sample(0, 0.1) then
        e = 1 - x;
        sum = pre(sum) + 0.1 * e;
        u = 2 * e + 3 * sum;
        end when;",
        1.0,
    )
    .unwrap();
    let (mut x, mut sum) = (0.0f64, 0.0);
    let decay = (-0.1f64).exp();
    for _ in 0..10 {
        let e = 1.0 - x;
        sum += 0.1 * e;
        let u = 2.0 * e + 3.0 * sum;
        x = u + (x - u) * decay;
    }
    assert!((last(&run, "x") - x).abs() < 1e-8, "{} {x}", last(&run, "x"));
    assert_eq!(run.statistics.time_events, 10);
}

#[test]
fn a_model_ends_itself() {
    let run = run(
        "Real x(start = 0, fixed = true);
        equation
        der(x) = 1;
        when x > 0.5 then
        terminate(\"arrived\");
        end when;",
        1.0,
    )
    .unwrap();
    assert_eq!(run.statistics.terminated.as_deref(), Some("arrived"));
    assert!((run.statistics.end - 0.5).abs() < 1e-12);
}

#[test]
fn conditions_that_trigger_each_other_are_named() {
    let failure = run(
        "Real x(start = 0, fixed = true);
        Boolean b;
        equation
        der(x) = 1;
        b = not pre(b);",
        1.0,
    )
    .unwrap_err();
    assert_eq!(failure.diagnostic.code, "MO0913");
    assert!(
        failure.diagnostic.message.contains("`b` keeps changing"),
        "{}",
        failure.diagnostic.message
    );
}

/// `v <= 0` switches back immediately, so only the event itself shows it.
#[test]
fn a_relation_that_the_event_itself_switches_back_is_announced() {
    let run = run(
        "Real v(start = 1, fixed = true);
        equation
        der(v) = -2;
        when v <= 0 then
        reinit(v, 1);
        end when;",
        1.2,
    )
    .unwrap();
    let said: Vec<&str> = run.trajectory.events.iter().map(|e| e.what.as_str()).collect();
    assert_eq!(said, ["v <= 0.0 became true", "v <= 0.0 became true"]);
    assert!((run.trajectory.events[1].time - 1.0).abs() < 1e-12);
}

/// A relation in a feedback: both branches are consistent on one side only.
#[test]
fn a_relation_of_an_algebraic_variable_is_settled() {
    let run = run(
        "Real x(start = 0, fixed = true);
        Real y;
        equation
        der(x) = 1;
        y = if y > 1 then 2 * x else x;",
        2.0,
    );
    let run = run.unwrap();
    assert!((last(&run, "y") - 4.0).abs() < 1e-12);
    assert_eq!(run.trajectory.events.len(), 1);
    assert!((run.trajectory.events[0].time - 1.0).abs() < 1e-12);
}

/// The message of a run that fails, as the user sees it.
fn complaint(text: &str) -> String {
    let (program, sources) = compiled(text);
    let settings = Settings::of(&Experiment::default());
    let failure = simulate(&program, &settings, &sources).unwrap_err();
    render(&failure.diagnostic, &sources, Style::Plain)
}

#[test]
fn a_division_by_zero_is_shown_in_the_text() {
    let shown = complaint(
        "parameter Real d = 0;
Real x(start = 1, fixed = true);
Real y;
equation
y = x + 1;
der(x) = if x > 0.5 then y / (x * d) else 1 / d;
",
    );
    insta::assert_snapshot!(shown, @r"
    error[MO0902]: at time 0 s division by zero: `x * d` is 0 in `y / (x * d)`
     --> model.mo:6:1
      |
    6 | der(x) = if x > 0.5 then y / (x * d) else 1 / d;
      | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ in `der(x) = if x > 0.5 then y / (x * d) else 1.0 / d`
      |
      = note: `y` = 2
      = note: `x` = 1
      = note: `d` = 0
      = help: keep the divisor away from zero, or test it with `if`
    ");
}

#[test]
fn chattering_is_shown_in_the_text() {
    let shown = complaint(
        "Real x(start = 0.1, fixed = true);
equation
der(x) = if x > 0 then -1 else if x < 0 then 1 else 2;
",
    );
    // The digits of the time in the first line depend on rounding.
    assert!(shown.starts_with("error[MO0911]: at time 0.1"), "{shown}");
    assert!(shown.contains("0.0` switches without end: 64 events within"), "{shown}");
    let place = shown.lines().skip(1).take(4).collect::<Vec<_>>().join("\n");
    insta::assert_snapshot!(place, @r"
     --> model.mo:3:1
      |
    3 | der(x) = if x > 0 then -1 else if x < 0 then 1 else 2;
      | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ this relation chatters
    ");
}

#[test]
fn when_terminal_acts_at_the_end() {
    let run = run(
        "Real x(start = 0, fixed = true);
        discrete Real end(start = -1);
        equation
        der(x) = 1;
        when terminal() then
        end = x;
        end when;",
        1.0,
    );
    assert!((last(&run.unwrap(), "end") - 1.0).abs() < 1e-12);
}
