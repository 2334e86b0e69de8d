//! Equations and relations that must be solved together, equations that depend on each other, and
//! coefficients that vanish.

use super::door::{Case, Reading, Scratch, assert_close};
use super::program::mocc;

/// Two bodies with dry friction between them. The force that holds them together is known only where
/// they are held: from sliding no repetition leads there.
#[test]
fn bodies_stick_where_the_friction_is_strong_enough() {
    let text = "model Contact
           parameter Real F = 3;
           parameter Real c = 4;
           Real v1(start = -1, fixed = true);
           Real v2(start = 0, fixed = true);
           Real w = v1 - v2;
           Real a_rel = der(v1) - der(v2);
           Real s;
           Real f;
           Boolean up(start = false, fixed = true);
           Boolean down(start = false, fixed = true);
           Boolean stuck;
           Integer mode(start = -1, fixed = true);
         equation
           up = pre(mode) == 0 and s > c;
           down = pre(mode) == 0 and s < -c;
           stuck = not (pre(mode) == 1 or up or pre(mode) == -1 or down);
           a_rel = if stuck then 0 elseif up or pre(mode) == 1 then s - c else s + c;
           f = if stuck then s elseif up or pre(mode) == 1 then c else -c;
           mode = if (pre(mode) == 1 or up) and w > 0 then 1
             elseif (pre(mode) == -1 or down) and w < 0 then -1 else 0;
           der(v1) = F - f;
           10*der(v2) = f;
           annotation(experiment(StopTime = 1, Tolerance = 1e-9));
         end Contact;";
    // They slide until -1 + (F + c) t = -c/10 t, and then go together, by F/11.
    let run = Case::text(text).run();
    let met = 1.0 / 7.4;
    let together = -0.4 * met + 3.0 / 11.0 * (1.0 - met);
    assert_close(run.last("v1"), together, 1e-8);
    assert_close(run.last("v2"), together, 1e-8);
    assert_eq!(run.last("mode"), 0.0);
    // A stronger pull tears them apart: F - c forwards on the one, c/10 on the other.
    let run = Case::text(text).set("F=8").run();
    let met = 1.0 / 12.4;
    assert_close(run.last("v2"), -0.4 * met + 0.4 * (1.0 - met), 1e-8);
    assert_close(run.last("v1"), -0.4 * met + 4.0 * (1.0 - met), 1e-8);
    assert_eq!(run.last("mode"), 1.0);
}

/// A ring of differences says two things in three equations: the level stays open, the rest is right.
#[test]
fn equations_that_follow_from_others_are_no_contradiction() {
    let (run, warnings) = Case::text(
        "model Ring
           Real a;
           Real b;
           Real c;
           Real x(start = 0, fixed = true);
         equation
           a - b = sin(time);
           b - c = cos(time);
           c - a = -sin(time) - cos(time);
           der(x) = a - c;
           annotation(experiment(StopTime = 1, Tolerance = 1e-9));
         end Ring;",
    )
    .compile()
    .run_with_warnings();
    let (sin, cos) = 1.0_f64.sin_cos();
    assert_close(run.last("a") - run.last("b"), sin, 1e-12);
    assert_close(run.last("b") - run.last("c"), cos, 1e-12);
    assert_close(run.last("x"), 1.0 - cos + sin, 1e-8);
    let said: Vec<_> = warnings.iter().map(|w| (w.code, w.message.as_str())).collect();
    assert_eq!(said, [("MO0918", "at time 0 s nothing determines `a`")]);
}

/// An amplifier that feeds back to itself leaves each limit where that is no solution any more, and jumps to
/// the other: between two jumps the capacitor goes from one threshold to the other.
#[test]
fn a_branch_that_ends_is_left_for_the_other_one() {
    let run = Case::text(
        "model Multivibrator
           parameter Real V0 = 15000;
           parameter Real tau = 0.1/(2*log(3));
           Real v(start = 1, fixed = true);
           Real w(start = 10);
           Real plus;
           Real u;
         equation
           w = plus - v;
           plus = u - plus;
           u = smooth(0, noEvent(if V0*w > 15 then 15 elseif V0*w < -15 then -15 else V0*w));
           tau*der(v) = u - v;
           annotation(experiment(StopTime = 1, Tolerance = 1e-8));
         end Multivibrator;",
    )
    .run();
    // The linear part of the amplifier shifts the thresholds by 15/V0.
    let tau = 0.1 / (2.0 * 3.0_f64.ln());
    let threshold = 7.5 - 15.0 / 15000.0;
    let first: f64 = tau * f64::ln(14.0 / (15.0 - threshold));
    let half: f64 = tau * f64::ln((15.0 + threshold) / (15.0 - threshold));
    for k in 0..19 {
        let side: f64 = if k % 2 == 0 { -15.0 } else { 15.0 };
        assert_eq!(run.at("u", first + (f64::from(k) + 0.5) * half), side, "after jump {k}");
    }
    let last = first + 19.0 * half;
    let exact = 15.0 - (15.0 + threshold) * (-(1.0 - last) / tau).exp();
    assert!((run.last("v") - exact).abs() < 1e-2, "{} instead of {exact}", run.last("v"));
}

/// A winding at an angle: of its two components one vanishes, at 0 exactly, at pi/2 by rounding.
#[test]
fn nothing_is_divided_by_the_sine_of_zero() {
    for angle in [0.0, 1.0, std::f64::consts::FRAC_PI_2, std::f64::consts::PI] {
        let run = Case::text(
            "model Winding
               parameter Real angle = 0;
               parameter Real n[2] = 5*{cos(angle), sin(angle)};
               Real phi[2];
               Real i(start = 0, fixed = true);
               Real u = exp(-time);
             equation
               phi = n*i/25;
               u = n*der(phi);
               annotation(experiment(StopTime = 1, Tolerance = 1e-9));
             end Winding;",
        )
        .set(format!("angle={angle}"))
        .run();
        assert_close(run.last("i"), 1.0 - f64::exp(-1.0), 1e-8);
    }
}

/// Two switches in opposite directions, one of them closed: what is left of the voltage across them is
/// 1e-9 of the current, and must not be the rounding of the voltages beside it.
#[test]
fn a_closed_switch_carries_the_current_to_the_last_digit() {
    let run = Case::text(
        "model Pair
           Real i(start = 1e-3, fixed = true);
           Real left = 100*cos(time);
           Real right;
           Real s1;
           Real s2;
           Real i1;
           Real i2;
           Real v1;
           Real v2;
           Boolean off = time > 10;
         equation
           v1 = left - right;
           v2 = right - left;
           v1 = s1*(if off then 1 else 1e-9);
           i1 = s1*(if off then 1e-9 else 1);
           v2 = s2*(if not off then 1 else 1e-9);
           i2 = s2*(if not off then 1e-9 else 1);
           i = i1 - i2;
           der(i) = -i;
         end Pair;",
    )
    .run();
    // The other switch takes 1e-18 of it.
    assert_close(run.last("i1"), run.last("i"), 1e-15);
    assert_close(run.last("s1"), run.last("i"), 1e-15);
}

/// Two pieces of one line that are joined carry one current, and both say where it begins.
#[test]
fn what_begins_twice_at_the_same_value_begins_there() {
    let text = "model Joined
           Real a;
           Real b;
           Real c;
           Real d;
         initial equation
           a = 0;
           c = END;
         equation
           der(a) + der(c) = 2;
           a = b;
           c = d;
           b = d;
         end Joined;";
    let run = Case::text(&text.replace("END", "0")).run();
    assert_close(run.last("a"), 1.0, 1e-9);
    // Another value is no second word for the first.
    let scratch = Scratch::new();
    let file = scratch.file("joined.mo", &text.replace("END", "1"));
    let ended = mocc(scratch.path(), &["simulate", file.to_str().expect("UTF-8")]);
    assert_eq!(ended.status, 1, "{}", ended.err);
    assert!(ended.err.contains("error[MO0408]"), "{}", ended.err);
}
