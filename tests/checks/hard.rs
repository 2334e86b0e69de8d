//! Systems on which simulators are known to fail, each with a fact that is known.

use std::f64::consts::PI;

use super::door::{Case, Reading, assert_close};

/// Otter, Elmqvist, Mattsson (1999): locked and sliding phases of dry friction as one set of equations
/// over the curve parameter `sa`. Slip 10 rad/s is braked at 3 + 3 rad/s2 from 0.5 s on; the two
/// inertias lock, turn together, and slip again when the pressure is taken away at 4 s.
#[test]
fn a_clutch_engages_locks_and_slips_again() {
    let run = Case::text(
        "model Clutch
           parameter Real J = 1;
           Real w1(start = 10, fixed = true);
           Real w2(start = 0, fixed = true);
           Real tau;
           Real drive = if time < 4 then 0 else 1;
           Real tau_max = if time < 0.5 then 0 elseif time < 4 then 3 else 0.2;
           Real slip = w1 - w2;
           Real sa;
           Integer mode(start = 1, fixed = true);
           Boolean forward = pre(mode) == 0 and sa > tau_max;
           Boolean backward = pre(mode) == 0 and sa < -tau_max;
           Boolean locked = pre(mode) == 0 and not (forward or backward);
         equation
           J*der(w1) = drive - tau;
           J*der(w2) = tau;
           der(slip) = if locked then 0 elseif forward then sa - tau_max
             elseif backward then sa + tau_max else sa;
           tau = if locked then sa elseif forward then tau_max elseif backward then -tau_max
             else mode*tau_max;
           mode = if (pre(mode) == 1 or forward) and slip > 0 then 1
             elseif (pre(mode) == -1 or backward) and slip < 0 then -1 else 0;
         end Clutch;",
    )
    .stop(6.0)
    .tolerance(1e-9)
    .run();
    let lock = 0.5 + 10.0 / 6.0;
    for (i, &t) in run.time.iter().enumerate() {
        let (w1, w2) = (run.of("w1")[i], run.of("w2")[i]);
        let (exact_1, exact_2) = if t < 0.5 {
            (10.0, 0.0)
        } else if t < lock {
            (10.0 - 3.0 * (t - 0.5), 3.0 * (t - 0.5))
        } else if t < 4.0 {
            (5.0, 5.0)
        } else {
            (5.0 + 0.8 * (t - 4.0), 5.0 + 0.2 * (t - 4.0))
        };
        assert!((w1 - exact_1).abs() < 1e-7 && (w2 - exact_2).abs() < 1e-7, "{t}: {w1} {w2}");
    }
    assert!(run.events.len() < 12, "{:?}", run.events);
}

/// The plant `x' = u - x` under `u = K e + I` at multiples of `T`: by the exact map of a period,
/// `x := a x + (1 - a) u` with `a = exp(-T)`.
#[test]
fn a_sampled_pi_controller() {
    let (gain, integral, period, wanted) = (2.0, 3.0, 0.1, 1.0);
    let run = Case::text(
        "model Controlled
           parameter Real K = 2, Ki = 3, T = 0.1, r = 1;
           Real x(start = 0, fixed = true);
           discrete Real i(start = 0, fixed = true);
           discrete Real u(start = 0, fixed = true);
         equation
           der(x) = u - x;
           when sample(0, T) then
             i = pre(i) + Ki*T*(r - x);
             u = K*(r - x) + i;
           end when;
         end Controlled;",
    )
    .stop(3.05)
    .interval(0.05)
    .tolerance(1e-10)
    .run();
    let a = f64::exp(-period);
    let (mut x, mut i, mut u) = (0.0, 0.0, 0.0);
    for k in 0..30 {
        if k > 0 {
            x = a * x + (1.0 - a) * u;
        }
        i += integral * period * (wanted - x);
        u = gain * (wanted - x) + i;
        let t = k as f64 * period;
        assert!((run.at("x", t) - x).abs() < 1e-8, "{t}: {} {x}", run.at("x", t));
        assert!((run.at("u", t + 0.05) - u).abs() < 1e-8, "{t}");
    }
}

/// A force of 20 N at 0.05 Hz against 7 N of static friction: in each half period the body breaks away
/// at `20 sin(2 pi f t) = 7`, runs to the other stop and stays there, without a rebound or a second try.
#[test]
fn a_slow_sine_drives_a_mass_against_both_stops() {
    let run = Case::text(
        "model Slow
           Translational.StopMass body(m = 1, s_min = -0.5, s_max = 0.5, s_start = -0.5);
           Translational.Force push;
           model Rubber = Friction.Stribeck(F_Coulomb = 5, F_Stribeck = 2, F_prop = 1, f_exp = 2);
           Seals.SingleSeal seal(contact = Seals.Contact.CloseOnly, redeclare model FrictionLaw = Rubber);
           Pneumatics.Ambient ambient;
         equation
           push.f = 20*sin(2*3.14159265358979323846*0.05*time);
           connect(push.flange, body.flange);
           connect(seal.spool, body.seals);
           connect(seal.port_a, ambient.port);
           connect(seal.port_b, ambient.port);
         end Slow;",
    )
    .stop(60.0)
    .run();
    let omega = 2.0 * PI * 0.05;
    let first = (7.0f64 / 20.0).asin() / omega;
    let mut leaves = run.times_of("> body.f_static became true");
    leaves.sort_by(f64::total_cmp);
    assert_eq!(leaves.len(), 6, "{leaves:?}");
    for (k, t) in leaves.iter().enumerate() {
        assert_close(*t, first + 10.0 * k as f64, 1e-6);
        let end = if k % 2 == 0 { 0.5 } else { -0.5 };
        assert_eq!(run.at("body.s", t + 5.0), end, "after {t} s");
        assert_eq!(run.at("body.v", t + 5.0), 0.0);
    }
    assert!(run.of("body.s").iter().all(|s| s.abs() <= 0.5 + 1e-12));
}

/// Published at the end of 0.03 s: F. Mazzia, C. Magherini, *Test Set for Initial Value Problem Solvers*
/// (2008), Andrews' squeezing mechanism; of index 3 as it is written.
#[test]
fn a_mechanism_of_seven_bodies_in_three_loops() {
    let run = Case::file("tests/data/SqueezingMechanism.mo").run();
    let published = [
        0.158_107_711_962_990_4e2,
        -0.157_563_710_598_429_8e2,
        0.408_222_401_307_310_1e-1,
        -0.534_730_116_322_694_8,
        0.524_409_965_880_530_4,
        0.534_730_116_322_694_8,
        0.104_808_074_104_226_3e1,
    ];
    for (k, exact) in published.into_iter().enumerate() {
        assert_close(run.last(&format!("q[{}]", k + 1)), exact, 1e-8);
    }
}

/// Published at the end of 5 s: F. Mazzia, C. Magherini, *Test Set for Initial Value Problem Solvers*
/// (2008), beam; the problem is (1.10) in sec. IV.1 of Hairer & Wanner II, with 40 elements.
#[test]
fn an_elastic_beam_of_eighty_states() {
    let run = Case::file("tests/data/Beam.mo").tolerance(1e-7).run();
    let published = [
        -0.579_236_659_128_500_7e-2,
        -0.169_529_855_072_173_5e-1,
        -0.276_910_331_297_309_4e-1,
        -0.380_081_565_587_915_8e-1,
    ];
    for (l, exact) in published.into_iter().enumerate() {
        assert_close(run.last(&format!("theta[{}]", l + 1)), exact, 1e-6);
    }
}
