//! Friction laws against their closed forms, bodies that nothing holds at rest, and the choice of a law.

use super::door::{Case, Reading, assert_close, text_of};

/// LuGre and Dahl driven at constant speed, and a body on bristles under a constant load that they can bear.
const BRISTLES: &str = "
model Bristles
  constant Real v = 2e-3;
  constant Real g = 3 + 2*exp(-6*v);
  Friction.LuGre lugre(v = v, dp = 0, t_no = 0, F_Coulomb = 3, F_Stribeck = 2, F_prop = 10, f_exp = 6,
    sigma_0 = 1e5, sigma_1 = 30, v_d = 0.01);
  Friction.Dahl dahl(v = v, dp = 0, t_no = 0, F_Coulomb = 3, sigma_0 = 1e5);
  // The bristles bend as g/sigma_0 (1 - exp(-sigma_0 v t/g)); their damping dies away with dz/dt.
  Real lugre_exact = g + 10*v + (30*v*exp(-(v/0.01)^2) - g)*exp(-1e5*v*time/g);
  Real dahl_exact = 3*(1 - exp(-1e5*v*time/3));

  Translational.StopMass body(m = 1, s_min = -1, s_max = 1, s_start = 0,
    mode_start = Translational.Motion.Locked);
  Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Friction.LuGre(
    F_Coulomb = 3, F_Stribeck = 2, F_prop = 10, f_exp = 6, sigma_0 = 1e5, sigma_1 = 30));
  Translational.Force load(f = 0.05);
  Pneumatics.Ambient ambient;
equation
  connect(seal.spool, body.seals);
  connect(seal.port_a, ambient.port);
  connect(seal.port_b, ambient.port);
  connect(load.flange, body.flange);
end Bristles;";

#[test]
fn bristles_bend_and_slip_as_their_equations_say() {
    let run = Case::text(BRISTLES).stop(1.0).tolerance(1e-9).run();
    for (found, exact) in [("lugre.f_signed", "lugre_exact"), ("dahl.f_signed", "dahl_exact")] {
        for (found, exact) in run.of(found).iter().zip(run.of(exact)) {
            assert!((found - exact).abs() < 1e-8, "{found} N instead of {exact} N");
        }
    }
    // Stribeck: F_C + F_S exp(-f_exp v) + F_prop v.
    assert_close(run.last("lugre.f_signed"), 3.0 + 2.0 * f64::exp(-6.0 * 2e-3) + 10.0 * 2e-3, 1e-9);
}

/// A load of 1 % of what the bristles bear bends them by f/sigma_0 (1 + O(1 %)), counting the first swing, and there the
/// body stays: no creeping on, no switching to and fro.
#[test]
fn a_loaded_body_rests_on_its_bristles() {
    let run = Case::text(BRISTLES).stop(1.0).tolerance(1e-9).run();
    assert_close(run.last("seal.friction.f_z"), 0.05, 1e-6);
    assert!(run.last("body.v").abs() < 1e-10);
    assert_close(run.last("body.s"), 0.05 / 1e5, 0.15);
    assert_eq!(run.events.len(), 1, "the first reversal of the speed, after which it moves freely");
}

#[test]
fn a_body_that_nothing_holds_swings_without_events() {
    let text = "model Swing
      Translational.StopMass body(m = 1, s_min = -1, s_max = 1, s_start = 0.5,
        mode_start = Translational.Motion.Locked);
      Translational.Spring spring(c = 100);
      Translational.Fixed wall;
    equation
      connect(spring.flange_a, wall.flange);
      connect(spring.flange_b, body.flange);
    end Swing;";
    let run = Case::text(text).stop(3.0).tolerance(1e-9).run();
    for (t, s) in run.time.iter().zip(run.of("body.s")) {
        assert!((s - 0.5 * (10.0 * t).cos()).abs() < 1e-7, "{s} at {t} s");
    }
    assert_eq!(run.events.len(), 1, "the first reversal, at half a period");
    assert_close(run.events[0].time, std::f64::consts::PI / 10.0, 1e-8);
}

/// It meets a stop from free motion, rests there without rebound, and leaves it again.
#[test]
fn free_motion_ends_at_either_stop() {
    let text = "model Thrown
      Translational.StopMass body(m = 1, s_min = -1, s_max = 1, s_start = 0, v_start = 1,
        mode_start = Translational.Motion.Forward);
      Translational.Force force(f = if time < 2 then -1 elseif time < 4 then 1 else -2);
    equation
      connect(force.flange, body.flange);
    end Thrown;";
    let run = Case::text(text).stop(7.0).interval(0.01).tolerance(1e-9).run();
    // Up to 0.5 m at 1 s and back; at the lower stop at 1 + sqrt(3) s, unless pushed from 2 s on: then it turns before.
    // From 2 s (s = 0, v = -1) s = -t' + t'^2/2 turns at -0.5 m, and is back at 0 at 4 s with v = 1.
    assert_close(run.at("body.s", 1.0), 0.5, 1e-8);
    assert_close(run.at("body.s", 3.0), -0.5, 1e-8);
    // From 4 s s = t' - t'^2: it turns at 0.25 m and arrives at -1 m after (1 + sqrt(5))/2 s.
    let arrived = 4.0 + (1.0 + f64::sqrt(5.0)) / 2.0;
    assert_close(run.times_of("s_left")[0], arrived, 1e-8);
    assert_eq!((run.last("body.s"), run.last("body.v")), (-1.0, 0.0));
}

/// The choice by a parameter and by a redeclaration are the same model.
#[test]
fn a_law_chosen_is_the_law_declared() {
    let dwell = "F_Stribeck_max = F_Stribeck_max, tau = tau, n = n";
    let curve = "F_prop = F_prop, f_exp = f_exp";
    let pressure = "k_C = k_C, k_S = k_S";
    let bristles = "sigma_0 = sigma_0, sigma_1 = sigma_1";
    let laws = [
        ("Frictionless", String::new()),
        ("Coulomb", "F_Coulomb = F_Coulomb".to_owned()),
        ("Stribeck", format!("F_Coulomb = F_Coulomb, F_Stribeck = F_Stribeck_max, {curve}")),
        ("StribeckDwell", format!("F_Coulomb = F_Coulomb, {dwell}, {curve}")),
        ("StribeckDwellPressure", format!("F_Coulomb = F_Coulomb, {pressure}, {dwell}, {curve}")),
        (
            "LuGre",
            format!("F_Coulomb = F_Coulomb, F_Stribeck = F_Stribeck_max, {curve}, {bristles}"),
        ),
        (
            "LuGreDwellPressure",
            format!("F_Coulomb = F_Coulomb, {pressure}, {dwell}, {curve}, {bristles}"),
        ),
        ("Dahl", "F_Coulomb = F_Coulomb, sigma_0 = sigma_0".to_owned()),
        ("TanhRegularised", "F_Coulomb = F_Coulomb".to_owned()),
    ];
    let valve = text_of("examples/valve32.mol");
    for (law, parameters) in laws {
        let chosen =
            Case::file("examples/valve32.mol").set(format!("friction_law=Friction.Kind.{law}"));
        let chosen = chosen.stop(0.04).interval(1e-4).run();
        let declared = format!(
            "{valve}\nmodel Declared\n  extends Valve32(redeclare model SealFriction = Friction.{law}({parameters}));\n\
             end Declared;"
        );
        let declared = Case::text(&declared).stop(0.04).interval(1e-4).run();
        assert!(chosen.last("s") > 3.4e-3, "{law}: the valve has switched");
        assert!(chosen.events.len() < 20, "{law}: {} events", chosen.events.len());
        for column in ["s", "p14", "p2"] {
            assert_close(chosen.at(column, 0.02), declared.at(column, 0.02), 1e-12);
            assert_close(chosen.last(column), declared.last(column), 1e-12);
        }
    }
}

/// The stiffer its bristles, the closer LuGre comes to the Stribeck curve with exact locking.
#[test]
fn stiff_bristles_approach_dry_friction() {
    let run = |settings: &[&str]| {
        let mut case = Case::file("examples/valve52.mol").stop(0.05).tolerance(1e-7);
        for setting in settings {
            case = case.set(*setting);
        }
        case.run()
    };
    let dry = run(&[]);
    let mut before = f64::INFINITY;
    for (sigma_0, sigma_1) in [(1e5, 40), (1e6, 150), (1e7, 400)] {
        let bristles = run(&[
            "friction_law=Friction.Kind.LuGreDwellPressure",
            &format!("sigma_0={sigma_0}"),
            &format!("sigma_1={sigma_1}"),
        ]);
        let times = (0..=500).map(|k| f64::from(k) * 1e-4);
        let apart = times.map(|t| (bristles.at("s", t) - dry.at("s", t)).abs()).fold(0.0, f64::max);
        assert!(apart < before / 2.0, "{apart} m after {before} m");
        before = apart;
    }
    assert!(before < 10e-6, "{before} m");
}
