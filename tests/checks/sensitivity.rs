//! Derivatives of runs by parameters and start values: against closed forms, and for the valve
//! against differences of whole runs.

use mocc::numeric::time_series::{Interpolation, TimeSeries};

use super::door::{Case, Differentiated, Reading, assert_close, suite_model};

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
    // At an event the limits on both sides are rows of the same time.
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
    let text = &suite_model("sensitivity/closed_forms/decay");
    let run =
        Case::text(text).stop(1.5).tolerance(1e-9).compile().differentiate(&["k", "start(x)"]);
    agrees(&run, 0, "x", |t| -3.0 * t * (-2.0 * t).exp(), 1e-7);
    agrees(&run, 1, "x", |t| (-2.0 * t).exp(), 1e-7);
    agrees(&run, 0, "y", |t| -18.0 * t * (-4.0 * t).exp(), 1e-7);
}

/// `x' = u(t - T)`: for a ramp `x = (t - T)^2/2`, after a step by 2 at 1 s `x = 2 (t - 1 - T)`.
#[test]
fn a_recorded_input_by_its_delay() {
    let model = |delay: f64| {
        format!(
            "model Late
               input Real u;
               parameter Real T = {delay};
               Real x(start = 0, fixed = true);
               Real y = delay(u, T);
             equation
               der(x) = y;
               annotation(experiment(StopTime = 3, Interval = 0.01));
             end Late;"
        )
    };
    let series = |times: &[f64], values: &[f64], interpolation| {
        TimeSeries::new(times.into(), values.to_vec(), interpolation)
    };
    for delay in [0.3, 1e-7] {
        let case = Case::text(&model(delay));
        let ramp = series(&[0.0, 3.0], &[0.0, 3.0], Interpolation::Linear);
        let run = case.compile_driven(&[("u", ramp)]).differentiate(&["T"]);
        let late = move |t: f64| (t - delay).max(0.0);
        assert_close(run.trajectory.last("x"), late(3.0).powi(2) / 2.0, 1e-8);
        agrees(&run, 0, "x", |t| -late(t), 1e-6);
        let step = series(&[0.0, 1.0, 3.0], &[0.0, 2.0, 2.0], Interpolation::Hold);
        let run = case.compile_driven(&[("u", step)]).differentiate(&["T"]);
        let after = move |t: f64| (t - 1.0 - delay).max(0.0);
        assert_close(run.trajectory.last("x"), 2.0 * after(3.0), 1e-8);
        agrees(&run, 0, "x", |t| if after(t) > 1e-9 { -2.0 } else { 0.0 }, 1e-6);
    }
}

/// `x' = k u` for a `u` that rises until 1 s and then falls: rows between the ends of steps are as exact as these,
/// also in the step after the kink.
#[test]
fn a_recorded_input_with_a_kink() {
    let model = "model Driven
        input Real u;
        parameter Real k = 2;
        Real x(start = 0, fixed = true);
      equation
        der(x) = k*u;
        annotation(experiment(StopTime = 2, Interval = 0.001));
      end Driven;";
    let roof = TimeSeries::new([0.0, 1.0, 2.0].into(), vec![0.0, 1.0, -3.0], Interpolation::Linear);
    let run = Case::text(model).compile_driven(&[("u", roof)]).differentiate(&["k"]);
    let integral =
        |t: f64| if t < 1.0 { t * t / 2.0 } else { 0.5 + (t - 1.0) - 2.0 * (t - 1.0).powi(2) };
    let x = run.trajectory.values("x").expect("x");
    for (t, x) in run.trajectory.time.iter().zip(x) {
        assert!((x - 2.0 * integral(*t)).abs() < 1e-9, "{t}: {x}");
    }
    agrees(&run, 0, "x", integral, 1e-9);
}

/// After the first impact at `t1 = sqrt(2 h0 / g)` the ball rises with `v1 = e g t1`:
/// `h = v1 (t - t1) - g (t - t1)^2 / 2`.
#[test]
fn a_ball_by_drop_restitution_and_gravity() {
    let text = &suite_model("sensitivity/events/bouncing_ball");
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
    let text = &suite_model("sensitivity/events/friction_stops_a_mass");
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
    let text = &suite_model("sensitivity/events/switching_times_and_clocks");
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
    let text = &suite_model("sensitivity/closed_forms/nonlinear_loop_and_function");
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

/// Two ways to the same derivatives: code for those of the right side by parameters, and their propagation along it.
/// The runs themselves are the same to the bit.
#[test]
fn derivatives_by_code_agree_with_propagated_ones() {
    let suite = |name: &str| Case::text(&suite_model(&format!("sensitivity/{name}")));
    let clocks = ["T", "first", "period", "a"];
    let valve = ["F_Coulomb", "k_S", "tau", "n", "f_exp", "F_ce", "w", "t_delay", "tau_pilot", "m"];
    let cases: [(&dyn Fn() -> Case, &[&str]); 6] = [
        (&|| suite("closed_forms/decay").stop(1.5), &["k", "start(x)"]),
        (&|| suite("events/bouncing_ball").stop(1.0), &["h0", "e", "g"]),
        (&|| suite("events/friction_stops_a_mass").stop(2.0), &["m", "F", "v0"]),
        (&|| suite("events/switching_times_and_clocks").stop(1.6), &clocks),
        (&|| suite("closed_forms/nonlinear_loop_and_function").stop(1.0), &["a", "start(x)"]),
        (&|| Case::file("examples/valve52.mol"), &valve),
    ];
    for (case, inputs) in cases {
        let coded = case().differentiated(inputs).compile();
        let code = coded.program.forcing.as_ref().expect("code for derivatives");
        assert_eq!(code.inputs.len(), inputs.iter().filter(|n| !n.starts_with("start")).count());
        let (coded, propagated) =
            (coded.differentiate(inputs), case().compile().differentiate(inputs));
        assert_eq!(coded.trajectory.time, propagated.trajectory.time);
        for column in propagated.trajectory.columns.iter().map(|c| c.name.as_str()) {
            assert_eq!(coded.trajectory.of(column), propagated.trajectory.of(column), "{column}");
            for (k, input) in inputs.iter().enumerate() {
                let (found, expected) = (coded.by(k, column), propagated.by(k, column));
                let size = expected.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
                for (found, expected) in found.iter().zip(&expected) {
                    let error = (found - expected).abs();
                    assert!(error <= 1e-8 * size, "d {column} by {input}: {found}, {expected}");
                }
            }
        }
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

/// A relay holds `y` on the moving line `b t + d`: `y' = c + r t - k u` with `u` the sign of the distance.
/// From above it is met at the root of `y0 + (c - k) t + r t^2 / 2 = b t + d`; on it `u = (c + r t - b) / k`;
/// it is left smoothly when `u` reaches one. `z' = u` adds up what the relay does.
#[test]
fn a_relay_that_slides_and_leaves() {
    let text = &suite_model("sensitivity/sliding/relay_on_a_line");
    let inputs = ["c", "r", "k", "b", "d", "y0"];
    let run = Case::text(text).stop(3.5).tolerance(1e-9).compile().differentiate(&inputs);
    let exact = |p: [f64; 6], t: f64| {
        let [c, r, k, b, d, y0] = p;
        let slope = c - k - b;
        let enters = (-slope - (slope * slope - 2.0 * r * (y0 - d)).sqrt()) / r;
        let leaves = (k + b - c) / r;
        let (met, left) = (t.min(enters), t.min(leaves));
        let on = |t: f64| ((c - b) * t + r * t * t / 2.0) / k;
        let z = if t <= enters { t } else { enters + on(left) - on(enters) + t - left };
        let free = |t: f64| (c - k) * t + r * t * t / 2.0;
        let y = if t <= enters { y0 + free(met) } else { b * left + d + free(t) - free(left) };
        [y, z]
    };
    let p = [0.2, 0.5, 1.0, 0.3, 0.1, 0.8];
    let enters = run.trajectory.times_of("stays where it switches");
    let leaves = run.trajectory.times_of("switches again");
    assert_eq!((enters.len(), leaves.len()), (1, 1));
    assert!((leaves[0] - 2.2).abs() < 1e-6, "{}", leaves[0]);
    for (input, name) in inputs.iter().enumerate() {
        // The closed form is smooth in each phase: its central difference is exact to ten digits.
        let by = |column: usize| {
            move |t: f64| {
                let moved = |h: f64| {
                    let mut p = p;
                    p[input] += h;
                    exact(p, t)[column]
                };
                (moved(1e-5) - moved(-1e-5)) / 2e-5
            }
        };
        for (k, column) in ["y", "z"].into_iter().enumerate() {
            let found = run.by(input, column);
            for (row, t) in run.trajectory.time.iter().enumerate() {
                let near = |e: &f64| (e - t).abs() < 1e-3;
                if enters.iter().chain(&leaves).any(near) {
                    continue;
                }
                let expected = by(k)(*t);
                assert!(
                    (found[row] - expected).abs() < 1e-6 * (1.0 + expected.abs()),
                    "d {column} / d {name} at {t} s: {} instead of {expected}",
                    found[row]
                );
            }
        }
        // On the line the relay's own value moves: u = (c + r t - b) / k.
        let (u, t) = (run.by(input, "u"), &run.trajectory.time);
        let row = t.partition_point(|t| *t < 1.5);
        let exact = [1.0, t[row], -(0.2 + 0.5 * t[row] - 0.3), -1.0, 0.0, 0.0][input];
        assert!((u[row] - exact).abs() < 1e-5, "d u / d {name}: {} instead of {exact}", u[row]);
    }
}

/// On a circle of radius `R`, which the relay holds against the flow, the angle turns at
/// `w + m c / k`: the surface is curved, and its gradient moves along.
#[test]
fn a_relay_on_a_circle() {
    let text = &suite_model("sensitivity/sliding/relay_on_a_circle");
    let inputs = ["c", "k", "w", "m", "R", "r0"];
    let run = Case::text(text).stop(2.0).tolerance(1e-9).compile().differentiate(&inputs);
    let at_end = |p: [f64; 6]| {
        let [c, k, w, m, radius, r0] = p;
        let enters = (r0 / radius).ln() / (k - c);
        let angle = (w + m) * enters + (w + m * c / k) * (2.0 - enters);
        [radius * angle.cos(), radius * angle.sin()]
    };
    let p = [0.4, 1.0, 2.0, 0.5, 1.5, 2.0];
    for (input, name) in inputs.iter().enumerate() {
        let moved = |h: f64| {
            let mut p = p;
            p[input] += h;
            at_end(p)
        };
        let (above, below) = (moved(1e-5), moved(-1e-5));
        for (k, column) in ["x", "y"].into_iter().enumerate() {
            let expected = (above[k] - below[k]) / 2e-5;
            let found = *run.by(input, column).last().unwrap();
            assert!(
                (found - expected).abs() < 1e-5 * (1.0 + expected.abs()),
                "d {column} / d {name}: {found} instead of {expected}"
            );
        }
    }
}

/// Another event ends the motion along a surface, which begins again at once: `y` is held at `d`, and
/// at `x = h`, an instant that moves with `v`, the flow that the relay holds changes from `c` to `e`.
#[test]
fn an_event_while_a_relay_slides() {
    let text = &suite_model("sensitivity/sliding/event_while_sliding");
    let inputs = ["c", "e", "k", "d", "v", "h"];
    let run = Case::text(text).stop(2.0).tolerance(1e-9).compile().differentiate(&inputs);
    let at_end = |p: [f64; 6]| {
        let [c, e, k, d, v, h] = p;
        let enters = (0.5 - d) / (k - c);
        let switches = h / v;
        enters + c / k * (switches - enters) + e / k * (2.0 - switches)
    };
    let p = [0.2, -0.4, 1.0, 0.1, 0.7, 0.9];
    for (input, name) in inputs.iter().enumerate() {
        let moved = |by: f64| {
            let mut p = p;
            p[input] += by;
            at_end(p)
        };
        let expected = (moved(1e-5) - moved(-1e-5)) / 2e-5;
        let found = *run.by(input, "z").last().unwrap();
        assert!(
            (found - expected).abs() < 1e-5 * (1.0 + expected.abs()),
            "d z / d {name}: {found} instead of {expected}"
        );
        let (y, on_d) = (*run.by(input, "y").last().unwrap(), f64::from(*name == "d"));
        assert!((y - on_d).abs() < 1e-6, "d y / d {name}: {y}");
    }
}

/// The rule is differentiated with the steps that it takes.
#[test]
fn an_integral_is_as_fine_as_it_must_be() {
    let case = Case::suite("evaluate/recursion/adaptive_integral")
        .model("P.Decay")
        .stop(3.0)
        .tolerance(1e-8);
    let run = case.compile().differentiate(&["k"]);
    let trajectory = &run.trajectory;
    let rate = 1.0 - (-2.0f64).exp();
    for (row, t) in trajectory.time.iter().enumerate() {
        let k = 1.0 + t;
        assert_close(trajectory.of("y")[row], 1.0 - (-2.0 * k).exp(), 1e-9);
        assert_close(trajectory.of("x")[row], (-rate * t).exp(), 1e-6);
        assert!((run.by(0, "y")[row] - 2.0 * (-2.0 * k).exp()).abs() < 1e-7);
        let slope = -2.0 * (-2.0f64).exp() * t * (-rate * t).exp();
        assert!((run.by(0, "x")[row] - slope).abs() < 1e-6);
    }
}
