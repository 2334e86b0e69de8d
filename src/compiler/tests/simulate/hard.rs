//! Cases that break simulators, each with a fact that is known.

use super::models::{last, run};
use mocc_engine::simulate::failure::FailureKind;

/// Torricelli: h = (1 - t / 2)^2 until the tank is empty. The held branch has no value for h < 0.
#[test]
fn a_tank_runs_empty_at_the_branch_point_of_the_root() {
    let run = run(
        "Real h(start = 1, fixed = true);
        equation
        der(h) = if h > 0 then -sqrt(h) else 0;",
        4.0,
    )
    .unwrap();
    let h = run.trajectory.values("h").unwrap();
    for (t, h) in run.trajectory.time.iter().zip(h) {
        let exact = (1.0 - t / 2.0).max(0.0).powi(2);
        assert!((h - exact).abs() < 1e-6, "{t}: {h}");
    }
    assert_eq!(run.trajectory.events.len(), 1);
    assert!((run.trajectory.events[0].time - 2.0).abs() < 1e-3);
}

/// ISO 6358: choked flow, then the root of an ellipse that meets its branch point when the
/// pressures are equal; no `noEvent`. With r = p / p1 and s = (r - b) / (1 - b), the subsonic part
/// is ds/dt = sqrt(1 - s^2) / (1 - b): s = sin((t - t1) / (1 - b)), equal at t1 + (1 - b) pi / 2.
#[test]
fn filling_ends_where_the_root_meets_its_branch_point() {
    let run = run(
        "Real r(start = 0.1, fixed = true);
        Real m;
        equation
        m = if r < 0.3 then 1 else if r < 1 then sqrt(1 - ((r - 0.3) / 0.7) ^ 2) else 0;
        der(r) = m;",
        2.0,
    )
    .unwrap();
    let r = run.trajectory.values("r").unwrap();
    for (t, r) in run.trajectory.time.iter().zip(r) {
        let angle = ((t - 0.2) / 0.7).clamp(0.0, std::f64::consts::FRAC_PI_2);
        let exact = if *t < 0.2 { 0.1 + t } else { 0.3 + 0.7 * angle.sin() };
        assert!((r - exact).abs() < 1e-5, "{t}: {r} {exact}");
    }
}

/// Without a branch the domain is left in earnest.
#[test]
fn a_root_without_a_branch_still_fails() {
    let failure = run(
        "Real h(start = 1, fixed = true);
        Real q;
        equation
        q = sqrt(h);
        der(h) = -1 - q;",
        4.0,
    )
    .unwrap_err();
    assert_eq!(failure.kind, FailureKind::Numerics);
    assert_eq!(failure.diagnostic.code, "MO0902");
    // h' = -1 - sqrt(h): t = 2 - 2 ln 2 at h = 0.
    assert!((failure.time - (2.0 - 2.0 * 2.0f64.ln())).abs() < 1e-3, "{}", failure.time);
}

/// u = -sin(t) / 2 holds x at zero from 0.3264 on.
#[test]
fn a_relay_slides() {
    let run = run(
        "Real x(start = 0.3, fixed = true);
        Real u;
        equation
        u = if x > 0 then -1 else 1;
        der(x) = u + 0.5 * sin(time);",
        6.0,
    )
    .unwrap();
    let rows = run.trajectory.time.iter().zip(run.trajectory.values("u").unwrap());
    for ((t, u), x) in rows.zip(run.trajectory.values("x").unwrap()) {
        if *t > 0.33 {
            assert!(x.abs() < 1e-9, "{t}: {x}");
            assert!((u + 0.5 * t.sin()).abs() < 1e-6, "{t}: {u}");
        }
    }
    assert!(run.trajectory.events.iter().any(|e| e.what.contains("stays where it switches")));
    assert!(run.trajectory.events.len() < 10);
}

/// A mass on a belt that moves at 0.2: it slips to v = 0.2 at t0 = asin(0.2), rides until its
/// spring overcomes the friction at x = 1, then swings about x = 1.
#[test]
fn a_mass_rides_on_a_belt_until_the_spring_pulls_it_off() {
    let run = run(
        "Real x(start = 0, fixed = true);
        Real v(start = 0, fixed = true);
        Real F;
        equation
        der(x) = v;
        der(v) = F - x;
        F = if v < 0.2 then 1 else -1;",
        6.0,
    )
    .unwrap();
    let on = 0.2f64.asin();
    let off = on + on.cos() / 0.2;
    let said: Vec<(f64, &str)> =
        run.trajectory.events.iter().map(|e| (e.time, e.what.as_str())).collect();
    assert!(said.iter().any(|(t, s)| s.contains("stays") && (t - on).abs() < 1e-6), "{said:?}");
    assert!(said.iter().any(|(t, s)| s.contains("again") && (t - off).abs() < 1e-5), "{said:?}");
    let phase = 6.0 - off;
    assert!((last(&run, "v") - 0.2 * phase.cos()).abs() < 1e-6);
    assert!((last(&run, "x") - 1.0 - 0.2 * phase.sin()).abs() < 1e-6);
}

/// Two relations that switch in turn have no derived motion: the run ends with a message.
#[test]
fn chattering_that_can_not_be_resolved_ends_the_run() {
    let failure = run(
        "Real x(start = 0.1, fixed = true);
        discrete Real n(start = 0);
        equation
        der(x) = if x > 0 then -1 else 1;
        when x > 0 then
        n = pre(n) + 1;
        end when;",
        1.0,
    )
    .unwrap_err();
    assert_eq!(failure.diagnostic.code, "MO0911");
    assert!(failure.diagnostic.message.contains("x > 0"), "{}", failure.diagnostic.message);
    assert!((failure.time - 0.1).abs() < 1e-6);
}

const BALL: &str = "Real h(start = 1, fixed = true);
        Real v(start = 0, fixed = true);
        equation
        der(h) = v;
        der(v) = -9.81;
        when h <= 0 then
        reinit(v, -0.8 * pre(v));
        end when;";

/// Impact k is at t0 (1 + 2 (e + ... + e^k)), t0 = sqrt(2 / g), with e = 0.8.
#[test]
fn a_ball_bounces_as_computed_by_hand() {
    let run = run(BALL, 3.0).unwrap();
    let (mut impact, mut flight) = ((2.0f64 / 9.81).sqrt(), 2.0 * (2.0f64 / 9.81).sqrt());
    let (mut speed, mut last_impact) = (9.81 * impact, 0.0);
    while impact < 3.0 {
        last_impact = impact;
        (flight, speed) = (0.8 * flight, 0.8 * speed);
        impact += flight;
    }
    let t = 3.0 - last_impact;
    assert!((last(&run, "h") - (speed * t - 0.5 * 9.81 * t * t)).abs() < 1e-7);
}

/// Impacts accumulate at 9 t0 = 4.06 s: nothing falls through the floor.
#[test]
fn the_zeno_point_of_a_ball_is_reported() {
    let failure = run(BALL, 6.0).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Numerics);
    assert_eq!(failure.diagnostic.code, "MO0911");
    assert!((failure.time - 9.0 * (2.0f64 / 9.81).sqrt()).abs() < 1e-4, "{}", failure.time);
    assert!(failure.diagnostic.message.contains("`h <= 0"), "{}", failure.diagnostic.message);
    assert!(!failure.diagnostic.primary.0.is_none());
}

/// A ball that knows a state of rest enters it at t0 (1 + e) / (1 - e), and stays on the floor.
#[test]
fn a_ball_comes_to_rest_where_its_bounces_pile_up() {
    for e in [0.3, 0.7, 0.95, 0.98] {
        let run = run(
            &format!(
                "Real h(start = 1, fixed = true);
                Real v(start = 0, fixed = true);
                Boolean flying(start = true, fixed = true);
                Boolean impact;
                discrete Real v_new(start = 0, fixed = true);
                discrete Real rest(start = 0, fixed = true);
                equation
                impact = h <= 0;
                der(h) = v;
                der(v) = if flying then -9.81 else 0;
                when {{h <= 0 and v <= 0, impact}} then
                  v_new = if impact and not pre(impact) then -{e} * pre(v) else 0;
                  flying = v_new > 0;
                  reinit(v, v_new);
                end when;
                when not flying then
                  rest = time;
                end when;"
            ),
            60.0,
        )
        .unwrap();
        let end = (2.0f64 / 9.81).sqrt() * (1.0 + e) / (1.0 - e);
        assert!((last(&run, "rest") - end).abs() < 1e-6 * end, "{e}: {}", last(&run, "rest"));
        assert_eq!(last(&run, "v"), 0.0);
        assert!(last(&run, "h").abs() < 1e-12);
    }
}

/// y^2 = 4 + x has two solutions; the start value decides.
#[test]
fn the_start_value_decides_between_two_solutions() {
    for sign in [1.0, -1.0] {
        let run = run(
            &format!(
                "Real x(start = 0, fixed = true);
                Real y(start = {sign});
                equation
                der(x) = 1;
                y ^ 2 = 4 + x;"
            ),
            5.0,
        )
        .unwrap();
        assert!((last(&run, "y") - sign * 3.0).abs() < 1e-9);
    }
}

/// `der(J) = der(E)` couples J to E, except where a state is reinitialized: then E jumps and J does
/// not.
#[test]
fn a_reinit_moves_its_own_state_alone() {
    let run = run(
        "Real J(start = 0, fixed = true);
        Real b(start = 1, fixed = true);
        Real E;
        equation
        E = b * (2 + sin(time));
        der(b) = 0;
        when time > 1 then
          reinit(b, 0.5);
        end when;
        der(J) = der(E);",
        2.0,
    )
    .unwrap();
    let exact = 1.0_f64.sin() + 0.5 * (2.0_f64.sin() - 1.0_f64.sin());
    assert!((last(&run, "J") - exact).abs() < 1e-6, "{}", last(&run, "J"));
    assert!((last(&run, "E") - 0.5 * (2.0 + 2.0_f64.sin())).abs() < 1e-9);
}

/// A single step over the whole run would miss the violation.
#[test]
fn an_assertion_fails_within_a_long_step() {
    let failed = run(
        "Real x(start = 1, fixed = true);
        equation
        der(x) = -1;
        assert(noEvent(x > 0 or x < -0.5), \"between\");",
        2.0,
    );
    let failure = failed.err().unwrap();
    assert_eq!(failure.kind, FailureKind::Assertion);
    assert!((1.0..=1.05).contains(&failure.time), "{}", failure.time);
}
