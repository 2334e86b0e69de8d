//! Exported models, driven as an importer drives them, against ordinary runs and closed forms. The C functions
//! and the archive are tested by `tests/fmu/check.py` with FMPy.

use mocc::driver::compile::{Request, Session};
use mocc::driver::ports::Exportable;
use mocc::fmu::disclosure::disclosed;
use mocc::fmu::instance::{Instance, Kind, Saved};
use mocc::fmu::interface::{FIRST_DERIVATIVE, Varies, reference, scalars};
use mocc::fmu::package::{self, PackageError};
use mocc::ir::flat::Causality;
use mocc::ir::program::Program;
use mocc::simulate::run::simulate;
use mocc::simulate::settings::Settings;
use mocc::simulate::stepping::Arrival;

/// The programs before and after their way through an archive.
fn exported(text: &str) -> (Program, Program, Vec<(String, Causality)>) {
    let request = Request {
        file: Some("model.mo".into()),
        text: Some(text.to_owned()),
        ..Request::default()
    };
    let mut session = Session::default();
    let Exportable { program, causalities, .. } =
        session.compile_for_export(&request).expect("compiles");
    let bytes = package::write(&disclosed(&program, false), "token");
    let received = package::read(&bytes, "token").expect("reads");
    (program, received, causalities)
}

fn value_reference(program: &Program, name: &str) -> u32 {
    let variables = &program.blocks.dae.variables;
    let found = variables.enumerate().find(|(_, v)| v.name == name);
    reference(found.expect("a variable").0)
}

const BALL: &str = "model Ball
  parameter Real e = 0.5;
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
  Integer bounces(start = 0, fixed = true);
equation
  der(h) = v;
  der(v) = -9.81;
  when h <= 0 then
    reinit(v, -e*pre(v));
    bounces = pre(bounces) + 1;
  end when;
  annotation(experiment(StopTime = 1));
end Ball;";

/// Between events the motion is a parabola, which the midpoint rule integrates exactly.
#[test]
fn an_importer_finds_the_bounces_of_a_ball() {
    let (_, program, _) = exported(BALL);
    let mut ball = Instance::new(&program, Kind::Exchange);
    ball.set(value_reference(&program, "e"), 0.8).expect("a parameter");
    ball.set_up(None, 0.0, Some(1.0)).expect("a run");
    ball.enter_initialization().expect("initialization");
    ball.exit_initialization().expect("initialized");
    ball.update().expect("an event");
    ball.enter_continuous_mode().expect("continuous");
    let (mut t, step) = (0.0, 1e-4);
    let mut hits = Vec::new();
    let (mut dx, mut z) = ([0.0; 2], [0.0; 1]);
    while t < 1.0 {
        let exchange = ball.exchange().expect("exchange");
        let x = exchange.states().to_vec();
        exchange.indicators(&mut z).expect("indicators");
        let before = z[0];
        exchange.derivatives(&mut dx).expect("derivatives");
        let next = [x[0] + step * dx[0] + 0.5 * step * step * dx[1], x[1] + step * dx[1]];
        t += step;
        exchange.set_time(t);
        exchange.set_states(&next);
        exchange.indicators(&mut z).expect("indicators");
        let crossed = (z[0] > 0.0) != (before > 0.0);
        let missed = ball.complete_step().expect("a step");
        assert_eq!(crossed, missed, "an indicator that changes its sign asks for an event");
        if crossed {
            ball.enter_event_mode().expect("event mode");
            // The relation becomes false again when the ball rises, which changes no state.
            if ball.update().expect("an event").states_changed {
                hits.push(t);
            }
            ball.enter_continuous_mode().expect("continuous");
        }
    }
    // States can be set one by one as well.
    ball.set(value_reference(&program, "h"), 0.25).expect("a state");
    assert_eq!(ball.exchange().expect("exchange").states()[0], 0.25);
    let first = (2.0_f64 / 9.81).sqrt();
    let second = first + 2.0 * 0.8 * 9.81 * first / 9.81;
    assert_eq!(hits.len(), 1 + usize::from(second < 1.0), "{hits:?}");
    assert!((hits[0] - first).abs() < 2.0 * step, "{hits:?}, expected {first}");
    let bounces = ball.get(value_reference(&program, "bounces")).expect("a value");
    assert_eq!(bounces, hits.len() as f64);
}

/// Without inputs the steps are those of an ordinary run, so the values are equal, also after events.
#[test]
fn co_simulation_equals_a_run() {
    let (own, program, _) = exported(BALL);
    let settings = Settings::of(&own.blocks.dae.experiment);
    let run = simulate(&own, &settings, &Session::default().sources).expect("runs");
    let expected = run.trajectory.values("h").and_then(|h| h.last().copied()).expect("rows");
    let mut ball = Instance::new(&program, Kind::Stepping { events: false });
    ball.set_up(None, 0.0, Some(1.0)).expect("a run");
    ball.enter_initialization().expect("initialization");
    ball.exit_initialization().expect("initialized");
    for k in 0..10 {
        let from = f64::from(k) * 0.1;
        assert_eq!(ball.step(from, 0.1).expect("a step"), Arrival::Reached);
    }
    let h = ball.get(value_reference(&program, "h")).expect("a value");
    assert!((h - expected).abs() < 1e-9, "{h} instead of {expected}");
}

/// A step ends before each event if the importer handles events.
#[test]
fn a_step_returns_early_at_an_event() {
    let (_, program, _) = exported(BALL);
    let mut ball = Instance::new(&program, Kind::Stepping { events: true });
    ball.set_up(None, 0.0, Some(1.0)).expect("a run");
    ball.enter_initialization().expect("initialization");
    ball.exit_initialization().expect("initialized");
    ball.update().expect("an event");
    ball.enter_step_mode().expect("step mode");
    let Arrival::EventDue(at) = ball.step(0.0, 1.0).expect("a step") else { panic!("no event") };
    assert!((at - (2.0_f64 / 9.81).sqrt()).abs() < 1e-6, "{at}");
    let v = value_reference(&program, "v");
    assert!(ball.get(v).expect("a value") < 0.0, "the left limit");
    ball.enter_event_mode().expect("event mode");
    ball.update().expect("an event");
    assert!(ball.get(v).expect("a value") > 0.0, "the right limit");
}

const DRIVEN: &str = "model Driven
  input Real u(start = 1);
  parameter Real tau = 0.5;
  output Real y;
  Real x(start = 0, fixed = true);
  Real past;
equation
  tau*der(x) = u^2 - x;
  y = 3*x + u;
  past = delay(x, 0.1);
  annotation(experiment(StopTime = 1));
end Driven;";

/// `x` tends to `u^2` with the time constant, and the history is part of the state.
#[test]
fn inputs_and_saved_states() {
    let (_, program, _) = exported(DRIVEN);
    let start = || {
        let mut model = Instance::new(&program, Kind::Stepping { events: false });
        model.set_up(Some(1e-9), 0.0, Some(1.0)).expect("a run");
        model.set(value_reference(&program, "u"), 2.0).expect("an input");
        model.enter_initialization().expect("initialization");
        model.exit_initialization().expect("initialized");
        model
    };
    let [x, past, u] = ["x", "past", "u"].map(|name| value_reference(&program, name));
    let mut model = start();
    model.step(0.0, 0.5).expect("a step");
    let value = model.get(x).expect("a value");
    assert!((value - 4.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-6, "{value}");
    let bytes = model.save().expect("a state").to_bytes();
    let finish = |model: &mut Instance<'_>| {
        model.set(u, 0.0).expect("an input");
        model.step(0.5, 0.25).expect("a step");
        [x, past].map(|r| model.get(r).expect("a value"))
    };
    let expected = finish(&mut model);
    let decayed = 4.0 * (1.0 - (-1.0_f64).exp()) * (-0.5_f64).exp();
    assert!((expected[0] - decayed).abs() < 1e-6, "{expected:?}");
    let mut other = start();
    other.restore(&Saved::from_bytes(&bytes).expect("a state")).expect("restored");
    let again = finish(&mut other);
    assert!(
        expected.iter().zip(again).all(|(a, b)| (a - b).abs() < 1e-7),
        "{expected:?} {again:?}"
    );
    assert!(Saved::from_bytes(&bytes[..bytes.len() / 2]).is_err());
}

/// A state that is restored in a new instance does not lead the run through the rows before it, where the last step
/// says nothing: here it would pass through negative values.
#[test]
fn a_state_goes_on_in_a_new_instance() {
    let text = "model Growth
  Real x(start = 1e-3, fixed = true);
  Real y;
equation
  der(x) = 20*x;
  y = log(x);
  annotation(experiment(StopTime = 1, Interval = 0.01));
end Growth;";
    let (_, program, _) = exported(text);
    let start = || {
        let mut model = Instance::new(&program, Kind::Stepping { events: false });
        model.set_up(Some(1e-9), 0.0, Some(1.0)).expect("a run");
        model.enter_initialization().expect("initialization");
        model.exit_initialization().expect("initialized");
        model
    };
    let mut model = start();
    model.step(0.0, 0.5).expect("a step");
    let state = model.save().expect("a state");
    let mut other = start();
    other.restore(&state).expect("restored");
    other.step(0.5, 0.25).expect("a step");
    let y = other.get(value_reference(&program, "y")).expect("a value");
    assert!((y - (1e-3_f64.ln() + 15.0)).abs() < 1e-6, "{y}");
}

/// `x` decays with one time constant, and from the change of the parameter on with the other; also without inputs, where
/// the integrator is ahead of the communication points.
#[test]
fn parameters_are_tuned_while_the_model_runs() {
    let text = "model Decay
  parameter Real tau = 0.5;
  parameter Real rate = 1/tau;
  parameter Real period = 0.3;
  Real x(start = 1, fixed = true);
  Integer n(start = 0, fixed = true);
equation
  der(x) = -rate*x;
  when sample(period, period) then
    n = pre(n) + 1;
  end when;
  annotation(experiment(StopTime = 1));
end Decay;";
    let (own, program, causalities) = exported(text);
    let all = scalars(&own, &causalities);
    let varies = |name: &str| all.iter().find(|s| s.name == name).map(|s| s.varies);
    assert_eq!(varies("tau"), Some(Varies::Tunable));
    assert_eq!(varies("rate"), Some(Varies::Tunable));
    assert_eq!(varies("period"), Some(Varies::Fixed), "its ticks are planned");
    let [tau, x, period] = ["tau", "x", "period"].map(|name| value_reference(&program, name));
    let mut model = Instance::new(&program, Kind::Stepping { events: false });
    model.set_up(Some(1e-9), 0.0, Some(1.0)).expect("a run");
    model.enter_initialization().expect("initialization");
    model.exit_initialization().expect("initialized");
    model.step(0.0, 0.5).expect("a step");
    model.set(tau, 0.1).expect("tunable");
    assert!(model.set(period, 0.1).is_err());
    model.step(0.5, 0.25).expect("a step");
    let value = model.get(x).expect("a value");
    let expected = (-1.0_f64 - 2.5).exp();
    assert!((value - expected).abs() < 1e-7, "{value} instead of {expected}");
    let mut model = Instance::new(&program, Kind::Exchange);
    model.enter_initialization().expect("initialization");
    model.exit_initialization().expect("initialized");
    model.set(tau, 0.25).expect("tunable");
    model.update().expect("an event");
    assert_eq!(model.get(FIRST_DERIVATIVE).expect("a derivative"), -4.0);
}

/// `der(x) = (u^2 - x)/tau` by `x` and by `u`.
#[test]
fn derivatives_are_exact() {
    let text = DRIVEN.replace("past = delay(x, 0.1);", "past = x;");
    let (own, program, causalities) = exported(&text);
    let mut model = Instance::new(&program, Kind::Exchange);
    model.set(value_reference(&program, "u"), 2.0).expect("an input");
    model.enter_initialization().expect("initialization");
    model.exit_initialization().expect("initialized");
    let [x, u, y] = ["x", "u", "y"].map(|name| value_reference(&program, name));
    let mut out = [0.0; 2];
    model.directional(&[FIRST_DERIVATIVE, y], &[x, u], &[1.0, 1.0], &mut out).expect("derivatives");
    assert_eq!(out, [-2.0 + 8.0, 4.0]);
    model.adjoint(&[FIRST_DERIVATIVE, y], &[x, u], &[1.0, 10.0], &mut out).expect("derivatives");
    assert_eq!(out, [-2.0 + 30.0, 8.0 + 10.0]);
    let all = scalars(&own, &causalities);
    let of = |name: &str| all.iter().find(|s| s.name == name).expect("a variable");
    assert_eq!(of("der(x)").derivative_of, Some(x));
    assert_eq!(format!("{:?} {:?}", of("tau").role, of("tau").initial), "Parameter Some(Exact)");
    assert_eq!(format!("{:?} {:?}", of("u").role, of("y").role), "Input Output");
}

/// Neither equations nor names of files leave the process, and damaged bytes are an error.
#[test]
fn packages_disclose_nothing_and_are_checked() {
    let text = "model Secret
  parameter Real hidden_constant = 3;
  Real x(start = 1, fixed = true);
equation
  der(x) = if x > 0.5 then -hidden_constant*x else 0;
  assert(x < 10, \"x is too large\");
end Secret;";
    let (own, _, _) = exported(text);
    let bytes = package::write(&disclosed(&own, false), "token");
    let shown = String::from_utf8_lossy(&bytes);
    assert!(shown.contains("x is too large") && !shown.contains("model.mo"), "{shown}");
    let wrong = package::read(&bytes, "other").err();
    assert!(matches!(wrong, Some(PackageError::OtherToken { .. })));
    for end in 0..bytes.len() {
        assert!(package::read(&bytes[..end], "token").is_err(), "cut at {end}");
    }
    assert_eq!(package::read(b"PK", "token").err(), Some(PackageError::NotAPackage));
}
