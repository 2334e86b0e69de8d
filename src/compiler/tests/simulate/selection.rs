//! States that are selected while the model runs, against closed forms and conserved quantities.

use super::models::{compiled, last, run};
use crate::ir::flat::Experiment;
use mocc_engine::simulate::run::{Run, simulate};
use mocc_engine::simulate::settings::Settings;

/// A unit pendulum in Cartesian coordinates, with this speed at its lowest point.
fn pendulum(speed: f64, extra: &str) -> String {
    format!(
        "Real x(start = 0, fixed = true);
        Real y(start = -1);
        Real vx(start = {speed}, fixed = true);
        Real vy(start = 0);
        Real F;
        Real E;
        {extra}
        equation
        der(x) = vx;
        der(y) = vy;
        der(vx) = -x * F;
        der(vy) = -y * F - 9.81;
        x ^ 2 + y ^ 2 = 1;
        E = 9.81 * y + 0.5 * (vx ^ 2 + vy ^ 2);"
    )
}

fn with_defaults(text: &str, stop: f64) -> Run {
    let (program, sources) = compiled(text);
    let settings =
        Settings { stop, interval: stop / 500.0, ..Settings::of(&Experiment::default()) };
    simulate(&program, &settings, &sources).unwrap()
}

#[test]
fn a_pendulum_goes_over_the_top_and_keeps_its_energy() {
    let run = with_defaults(&pendulum(6.5, ""), 10.0);
    let y = run.trajectory.values("y").unwrap();
    assert!(y.iter().any(|y| *y > 0.999));
    let energy = run.trajectory.values("E").unwrap();
    assert!(energy.iter().all(|e| (e / energy[0] - 1.0).abs() < 1e-5));
    let x = run.trajectory.values("x").unwrap();
    assert!(x.iter().zip(y).all(|(x, y)| (x * x + y * y - 1.0).abs() < 1e-10));
    // Each turn asks for four selections.
    assert!(run.statistics.selections > 20, "{}", run.statistics.selections);
}

/// The same pendulum by its angle, whose state never has to change.
#[test]
fn cartesian_and_polar_pendulum_agree_over_the_top() {
    let cartesian = run(&pendulum(6.5, ""), 3.0).unwrap();
    let polar = run(
        "Real a(start = 0, fixed = true);
        Real w(start = 6.5, fixed = true);
        equation
        der(a) = w;
        der(w) = -9.81 * sin(a);",
        3.0,
    )
    .unwrap();
    assert_eq!(polar.statistics.selections, 0);
    let a = last(&polar, "a");
    assert!(a > 2.0 * std::f64::consts::PI);
    assert!((last(&cartesian, "x") - a.sin()).abs() < 1e-5);
    assert!((last(&cartesian, "y") + a.cos()).abs() < 1e-5);
}

/// From rest at the side, where `x` determines `y` badly, though it is wanted as a state: the first
/// selection, made at the start, is not that of the compiler.
#[test]
fn the_first_selection_suits_the_start() {
    let text = "Real x(start = 1);
        Real y(start = 0, fixed = true);
        Real vx(start = 0);
        Real vy(start = 0, fixed = true);
        Real F;
        equation
        der(x) = vx;
        der(y) = vy;
        der(vx) = -x * F;
        der(vy) = -y * F - 9.81;
        x ^ 2 + y ^ 2 = 1;";
    let (program, _) = compiled(text);
    let names = |k: usize| -> Vec<&str> {
        let candidates = program.blocks.state_sets[k].candidates.iter();
        candidates.map(|v| program.name(*v)).collect()
    };
    assert_eq!([names(0), names(1)], [["vx", "vy"], ["x", "y"]]);
    let run = run(text, 10.0).unwrap();
    // sin(theta / 2) = k cd(w t | k^2) by Jacobi's elliptic functions, k = sin(pi / 4).
    assert!((last(&run, "x") - 0.2750874625761169).abs() < 1e-6, "{}", last(&run, "x"));
    assert!((last(&run, "y") + 0.9614192050991252).abs() < 1e-6, "{}", last(&run, "y"));
}

/// The charge of a node with two capacitors, one of them nonlinear, is the state: the node voltage
/// follows from it without derivatives.
#[test]
fn a_sum_of_charges_is_a_state() {
    let text = "parameter Real c = 0.000000000001;
        Real u(start = 0, fixed = true);
        Real q1;
        Real q2;
        equation
        q1 = c * u;
        q2 = c * u ^ 3;
        der(q1) + der(q2) = 2 * c;";
    let run = run(text, 5.0).unwrap();
    // u + u^3 = 2 t.
    assert!((last(&run, "u") - 2.0).abs() < 1e-7, "{}", last(&run, "u"));
    let (program, _) = compiled(text);
    assert_eq!(program.order(), 1);
    assert!(program.blocks.state_sets.is_empty());
}
