//! Derivatives of runs by parameters and start values: against closed forms, and for the valve
//! against differences of whole runs.

use super::door::{Case, Differentiated, Reading};

/// Compares the derivatives of a column by an input with a closed form at every row.
#[track_caller]
fn agrees(
    run: &Differentiated,
    input: usize,
    column: &str,
    exact: impl Fn(f64) -> f64,
    tolerance: f64,
) {
    let found = run.by(input, column);
    // Beside an event the limits on both sides are rows of the same time.
    let near_event =
        |t: f64| run.trajectory.events.iter().any(|e| (e.time - t).abs() < 1e-9 * (1.0 + t));
    for (t, found) in run.trajectory.time.iter().zip(found) {
        if near_event(*t) {
            continue;
        }
        let exact = exact(*t);
        assert!(
            (found - exact).abs() <= tolerance * (1.0 + exact.abs()),
            "d {column} at {t} s: {found} instead of {exact}"
        );
    }
}

#[test]
fn decay_by_its_rate_and_its_start() {
    let text = "model Decay
      parameter Real k = 2;
      Real x(start = 3, fixed = true);
      Real y = x ^ 2;
    equation
      der(x) = -k * x;
    end Decay;";
    let run =
        Case::text(text).stop(1.5).tolerance(1e-9).compile().differentiate(&["k", "start(x)"]);
    agrees(&run, 0, "x", |t| -3.0 * t * (-2.0 * t).exp(), 1e-7);
    agrees(&run, 1, "x", |t| (-2.0 * t).exp(), 1e-7);
    agrees(&run, 0, "y", |t| -18.0 * t * (-4.0 * t).exp(), 1e-7);
}

/// After the first impact at `t1 = sqrt(2 h0 / g)` the ball rises with `v1 = e g t1`:
/// `h = v1 (t - t1) - g (t - t1)^2 / 2`.
#[test]
fn a_ball_by_drop_restitution_and_gravity() {
    let text = "model Ball
      parameter Real g = 9.81;
      parameter Real e = 0.8;
      parameter Real h0 = 1;
      Real h(start = h0, fixed = true);
      Real v(start = 0, fixed = true);
      Integer bounces(start = 0, fixed = true);
    equation
      der(h) = v;
      der(v) = -g;
      when h <= 0 then
        reinit(v, -e * pre(v));
        bounces = pre(bounces) + 1;
      end when;
    end Ball;";
    let run = Case::text(text).stop(1.0).tolerance(1e-9).compile().differentiate(&["h0", "e", "g"]);
    assert_eq!(run.trajectory.last("bounces"), 1.0);
    let (g, e, h0) = (9.81f64, 0.8, 1.0);
    let t1 = (2.0 * h0 / g).sqrt();
    // The closed form's own derivatives, by its instant of impact.
    let by_t1 = move |t: f64| e * g * (t - t1) - e * g * t1 + g * (t - t1);
    let (dt1_dh0, dt1_dg) = (1.0 / (g * t1), -h0 / (g * g * t1));
    let after = move |t: f64| t > t1;
    agrees(&run, 0, "h", |t| if after(t) { by_t1(t) * dt1_dh0 } else { 1.0 }, 1e-7);
    agrees(&run, 1, "h", |t| if after(t) { g * t1 * (t - t1) } else { 0.0 }, 1e-7);
    let by_g = |t: f64| {
        if after(t) {
            e * t1 * (t - t1) - (t - t1) * (t - t1) / 2.0 + by_t1(t) * dt1_dg
        } else {
            -t * t / 2.0
        }
    };
    agrees(&run, 2, "h", by_g, 1e-7);
    agrees(&run, 0, "v", |t| if after(t) { (1.0 + e) * g * dt1_dh0 } else { 0.0 }, 1e-7);
}

/// A mass slows down by Coulomb friction until it sticks: `s = m v0^2 / (2 F)` at the end.
#[test]
fn a_mass_that_comes_to_rest_by_friction() {
    let text = "model Slide
      parameter Real m = 2;
      parameter Real F = 3;
      parameter Real v0 = 1.5;
      Real s(start = 0, fixed = true);
      Real v(start = v0, fixed = true);
      Boolean stuck(start = false, fixed = true);
    equation
      der(s) = v;
      m * der(v) = if stuck then 0 else -F;
      when v <= 0 then
        stuck = true;
        reinit(v, 0);
      end when;
    end Slide;";
    let run = Case::text(text).stop(2.0).tolerance(1e-9).compile().differentiate(&["m", "F", "v0"]);
    let (m, f, v0): (f64, f64, f64) = (2.0, 3.0, 1.5);
    let end = |input| *run.by(input, "s").last().unwrap();
    assert!((run.trajectory.last("s") - m * v0 * v0 / (2.0 * f)).abs() < 1e-8);
    assert!((end(0) - v0 * v0 / (2.0 * f)).abs() < 1e-8, "{}", end(0));
    assert!((end(1) + m * v0 * v0 / (2.0 * f * f)).abs() < 1e-8, "{}", end(1));
    assert!((end(2) - m * v0 / f).abs() < 1e-8, "{}", end(2));
    assert!(run.by(1, "v").last().unwrap().abs() < 1e-12);
}

/// Instants that are computed from parameters: `x = t` before `T`, `2 T - t` after; and a counter
/// that grows by `a` at each tick of a clock: `y' = n a`.
#[test]
fn switching_times_and_clocks_by_their_parameters() {
    let text = "model Timed
      parameter Real T = 0.7;
      parameter Real first = 0.25;
      parameter Real period = 0.5;
      parameter Real a = 2;
      Real x(start = 0, fixed = true);
      Real y(start = 0, fixed = true);
      discrete Real u(start = 0, fixed = true);
    equation
      der(x) = if time < T then 1 else -1;
      der(y) = u;
      when sample(first, period) then
        u = pre(u) + a;
      end when;
    end Timed;";
    let inputs = ["T", "first", "period", "a"];
    let run = Case::text(text).stop(1.6).tolerance(1e-9).compile().differentiate(&inputs);
    agrees(&run, 0, "x", |t| if t < 0.7 { 0.0 } else { 2.0 }, 1e-9);
    let ticks = |t: f64| {
        (0..3).map(move |k| (k as f64, 0.25 + 0.5 * k as f64)).filter(move |(_, at)| *at < t)
    };
    agrees(&run, 1, "y", |t| -2.0 * ticks(t).count() as f64, 1e-9);
    agrees(&run, 2, "y", |t| ticks(t).map(|(k, _)| -2.0 * k).sum(), 1e-9);
    agrees(&run, 3, "y", |t| ticks(t).map(|(_, at)| t - at).sum(), 1e-9);
    agrees(&run, 3, "u", |t| ticks(t).count() as f64, 1e-12);
}

/// A loop without closed solution: `z^3 + z = a x`, `x' = -z`, so along the way
/// `dz = (a dx + x da) / (3 z^2 + 1)`; compared with a fine difference of closed relations at the end.
#[test]
fn a_nonlinear_loop_and_a_function() {
    let text = "package P
      function half
        input Real u;
        output Real y;
      protected
        Real sum;
      algorithm
        sum := 0;
        for i in 1:20 loop
          sum := sum + u * 0.5 ^ (i + 1);
        end for;
        y := sum;
      end half;
      model Loop
        parameter Real a = 2;
        Real x(start = 1, fixed = true);
        Real z(start = 0.5);
        Real h = half(x);
      equation
        z ^ 3 + z = a * x;
        der(x) = -z;
      end Loop;
    end P;";
    let mut case = Case::text(text).stop(1.0).tolerance(1e-10).compile();
    let run = case.differentiate(&["a", "start(x)"]);
    for column in ["x", "z"] {
        let exact = *run.by(0, column).last().unwrap();
        let mut at = |a: f64| {
            case.set("a", a);
            case.run().last(column)
        };
        let difference = (at(2.0 + 1e-4) - at(2.0 - 1e-4)) / 2e-4;
        assert!((exact - difference).abs() < 1e-6, "{column}: {exact} {difference}");
    }
    // h = x (1 - 0.5^20) / 2
    let factor = 0.5 * (1.0 - 0.5f64.powi(20));
    let (x, h) = (run.by(0, "x"), run.by(0, "h"));
    assert!(x.iter().zip(h).all(|(x, h)| (h - factor * x).abs() < 1e-14));
    // From x' = -z(x) alone: dx/dx0 = z(x) / z(x0).
    let z = run.trajectory.of("z");
    for (slope, z_now) in run.by(1, "x").iter().zip(z) {
        assert!((slope - z_now / z[0]).abs() < 1e-8, "{slope}");
    }
}

/// The valve, with all its seals, stops and locked phases, against central differences of runs.
#[test]
fn the_valve_by_eight_of_its_parameters() {
    let inputs = [
        ("F_Coulomb", 1.0),
        ("F_prop", 1.5),
        ("m", 0.03),
        ("A_14", 2.01e-4),
        ("C_pilot", 5e-10),
        ("V_14", 0.9e-6),
        ("t_delay", 5e-3),
        ("s_ce_14", 1.95e-3),
    ];
    let names = inputs.map(|(name, _)| name);
    let mut case = Case::file("examples/valve52.mol").tolerance(1e-9).compile();
    let run = case.differentiate(&names);
    let columns = ["s", "p14", "p4"];
    for (input, (name, value)) in inputs.iter().enumerate() {
        let step = 1e-4 * value;
        let mut at = |value: f64| {
            case.set(name, value);
            case.run()
        };
        let (above, below) = (at(value + step), at(value - step));
        at(*value);
        for column in columns {
            let slopes = run.by(input, column);
            // At instants away from events, which differ between the runs.
            let mut compared = 0;
            let size = slopes.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            for k in 1..120 {
                let t = k as f64 * 1e-3;
                let near = run.trajectory.events.iter().any(|e| (e.time - t).abs() < 2e-4);
                if near {
                    continue;
                }
                let row = run.trajectory.time.partition_point(|x| *x < t - 1e-9);
                let difference = (above.at(column, t) - below.at(column, t)) / (2.0 * step);
                let error = (slopes[row] - difference).abs();
                assert!(
                    error <= 2e-3 * size.max(1e-30) + 1e-3 * difference.abs(),
                    "d {column} / d {name} at {t} s: {} instead of {difference}, largest {size}",
                    slopes[row]
                );
                compared += 1;
            }
            assert!(compared > 60, "{compared}");
        }
    }
}
