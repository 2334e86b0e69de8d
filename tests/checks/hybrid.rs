//! Systems with events whose times and results are known.

use super::door::{Case, Reading, assert_close};

#[test]
fn bouncing_ball() {
    let run = Case::file("examples/bouncing_ball.mol").run();
    let (g, h_0, e) = (9.81, 1.0, 0.8_f64);
    let t_1 = f64::sqrt(2.0 * h_0 / g);
    let impacts = run.times_of("h <= 0.0 became true");
    assert_eq!(impacts.len(), 6);
    let mut exact = t_1;
    for (k, t) in impacts.iter().enumerate() {
        assert_close(*t, exact, 1e-9);
        assert_eq!(run.at("impacts", *t), (k + 1) as f64);
        exact += 2.0 * t_1 * e.powi(k as i32 + 1);
    }
}

#[test]
fn stick_slip() {
    let run = Case::file("examples/stick_slip.mol").run();
    let leaves = run.times_of("> slider.f_static became true");
    let rests = run.times_of("slider.v_along < 0.0 became true");
    assert_close(leaves[0], 10.0 / (500.0 * 0.1), 1e-9);
    assert_eq!((leaves.len(), rests.len()), (5, 5));
    for k in 1..leaves.len() {
        assert!(leaves[k - 1] < rests[k - 1] && rests[k - 1] < leaves[k]);
        assert_close(leaves[k] - leaves[k - 1], leaves[1] - leaves[0], 1e-6);
    }
    let (locked, v) = (run.of("slider.locked"), run.of("slider.v"));
    assert!(locked.iter().zip(v).all(|(locked, v)| *locked == 0.0 || *v == 0.0));
}

#[test]
fn coulomb_friction_stops_a_sliding_body() {
    // F = 2 N against m = 0.5 kg at 3 m/s: rest after v m/F = 0.75 s and v^2 m/(2 F) = 1.125 m.
    let run = Case::text(
        "model Slide
           model Rubber = Friction.Coulomb(F_Coulomb = 2);
           Translational.StopMass body(m = 0.5, s_min = -1, s_max = 10, s_start = 0, v_start = 3,
             mode_start = Translational.Motion.Forward);
           Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Rubber);
           Pneumatics.Ambient ambient;
         equation
           connect(seal.spool, body.seals);
           connect(seal.port_a, ambient.port);
           connect(seal.port_b, ambient.port);
           annotation(experiment(StopTime = 2));
         end Slide;",
    )
    .run();
    assert_eq!(run.events.len(), 1);
    assert_close(run.events[0].time, 0.75, 1e-9);
    assert_close(run.last("body.s"), 1.125, 1e-9);
    assert_eq!(run.last("body.v"), 0.0);
    assert_close(run.last("body.t_no"), 1.25, 1e-9);
}

#[test]
fn sampled_counter() {
    let run = Case::text(
        "model Counter
           Integer n(start = 0, fixed = true);
           Real last(start = -1, fixed = true);
         equation
           when sample(0.1, 0.25) then
             n = pre(n) + 1;
             last = time;
           end when;
           annotation(experiment(StopTime = 2));
         end Counter;",
    )
    .run();
    // 0.1, 0.35, ... 1.85
    assert_eq!(run.last("n"), 8.0);
    assert_close(run.last("last"), 1.85, 1e-14);
    assert_eq!(run.at("n", 0.849), 3.0);
    assert_eq!(run.at("n", 0.85), 4.0);
    assert_eq!(run.events.len(), 8);
}

#[test]
fn thermostat_with_hysteresis() {
    // Heating towards 30, cooling towards 10, both with 1 s; between 18 and 22 a period takes
    // ln(12/8) both ways.
    let run = Case::text(
        "model Thermostat
           Real T(start = 18, fixed = true);
           Boolean on(start = true, fixed = true);
           Integer switches(start = 0, fixed = true);
         equation
           der(T) = (if on then 30 else 10) - T;
           when T > 22 then
             on = false;
           elsewhen T < 18 then
             on = true;
           end when;
           when change(on) then
             switches = pre(switches) + 1;
           end when;
           annotation(experiment(StopTime = 4, Tolerance = 1e-9));
         end Thermostat;",
    )
    .run();
    let half = f64::ln(1.5);
    let off = run.times_of("T > 22.0 became true");
    let on = run.times_of("T < 18.0 became true");
    assert_eq!((off.len(), on.len()), (5, 4));
    for (k, t) in off.iter().enumerate() {
        assert_close(*t, half * (2 * k + 1) as f64, 1e-7);
    }
    for (k, t) in on.iter().enumerate() {
        assert_close(*t, half * (2 * k + 2) as f64, 1e-7);
    }
    assert_eq!(run.last("switches"), 9.0);
}

#[test]
fn the_first_branch_of_elsewhen_wins() {
    let run = Case::text(
        "model Both
           Integer which(start = 0, fixed = true);
         equation
           when time >= 1 then
             which = 1;
           elsewhen time >= 1 then
             which = 2;
           elsewhen time >= 2 then
             which = 3;
           end when;
           annotation(experiment(StopTime = 3));
         end Both;",
    )
    .run();
    assert_eq!((run.at("which", 0.99), run.at("which", 1.0), run.last("which")), (0.0, 1.0, 3.0));
}

#[test]
fn an_event_leads_to_the_next_at_the_same_time() {
    let run = Case::text(
        "model Cascade
           Boolean a(start = false, fixed = true);
           Integer n(start = 0, fixed = true);
           Integer m(start = 0, fixed = true);
           Real x(start = 0, fixed = true);
         equation
           der(x) = 1;
           when x >= 0.5 then
             a = true;
             reinit(x, 2);
           end when;
           when {a, x > 1.5} then
             n = pre(n) + 1;
           end when;
           when edge(a) then
             m = pre(m) + 1;
           end when;
           annotation(experiment(StopTime = 1));
         end Cascade;",
    )
    .run();
    // Two relations at one instant, in two rows: a jump of x, and each clause active once per cause.
    assert_eq!(run.events.len(), 2);
    assert_eq!(run.events[0].time, run.events[1].time);
    assert_eq!(run.time.iter().filter(|t| **t == run.events[0].time).count(), 2);
    assert_close(run.last("x"), 2.5, 1e-9);
    assert_eq!(run.last("m"), 1.0);
    assert_eq!(run.last("n"), 2.0);
}

#[test]
fn a_switched_equation_changes_its_structure_only_in_values() {
    // Exact: rises with slope 2 to 1, then decays.
    let run = Case::text(
        "model Switched
           Real x(start = 0, fixed = true);
           Boolean charging;
           Real u;
         equation
           charging = time < 0.5;
           if charging then
             der(x) = 2;
             u = x;
           else
             u = -x;
             der(x) = u;
           end if;
           annotation(experiment(StopTime = 1.5, Tolerance = 1e-9));
         end Switched;",
    )
    .run();
    assert_close(run.at("x", 0.5), 1.0, 1e-9);
    assert_close(run.last("x"), f64::exp(-1.0), 1e-7);
    assert_eq!(run.times_of("time < 0.5 became false"), [0.5]);
}

#[test]
fn terminate_ends_the_run() {
    let run = Case::text(
        "model Fall
           Real h(start = 5, fixed = true);
         equation
           der(h) = -2;
           when h < 1 then
             terminate(\"landed\");
           end when;
           annotation(experiment(StopTime = 10));
         end Fall;",
    )
    .run();
    assert_close(*run.time.last().expect("rows"), 2.0, 1e-9);
}

/// The mean of a sine over each of its periods is 0, whatever the time at which the run begins.
#[test]
fn a_clock_may_begin_when_initialisation_says_so() {
    let text = "model Mean
      parameter Real f = 5;
      parameter Real t_0(fixed = false);
      Real u = 2 + sin(2*3.141592653589793*f*time);
      Real x(start = 0, fixed = true);
      discrete Real y(start = 0, fixed = true);
      discrete Real n(start = 0, fixed = true);
    initial equation
      t_0 = time + 0.05;
    equation
      der(x) = u;
      when sample(t_0 + 1/f, 1/f) then
        y = f*pre(x);
        n = pre(n) + 1;
        reinit(x, 0);
      end when;
    end Mean;";
    let run = Case::text(text).stop(1.0).tolerance(1e-9).run();
    // Ticks at 0.25, 0.45, 0.65 and 0.85 s.
    assert_eq!(run.last("n"), 4.0);
    assert!((run.last("y") - 2.0).abs() < 1e-7, "{}", run.last("y"));
    let ticks: Vec<f64> = run.events.iter().map(|e| e.time).collect();
    for (tick, at) in ticks.iter().zip([0.25, 0.45, 0.65, 0.85]) {
        assert!((tick - at).abs() < 1e-12, "{ticks:?}");
    }
}
