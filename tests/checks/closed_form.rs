//! Smooth systems whose solution is known.

use std::f64::consts::PI;

use mocc::external::table::Extrapolation;
use mocc::external::table::curve::Curve;
use mocc::numeric::hermite::Smoothness;

use super::door::{Case, Reading, assert_close};

/// Density at the reference state, kg/m3, gas constant, J/(kg K), and temperature, K, of the library's air.
const RHO_0: f64 = 1.185;
const R: f64 = 287.1;
const T: f64 = 293.15;

#[test]
fn damped_oscillator() {
    let run = Case::file("examples/oscillator.mol").tolerance(1e-9).run();
    let (s_0, omega_0, damping) = (0.1, 10.0, 0.1);
    let omega = omega_0 * f64::sqrt(1.0 - damping * damping);
    for (t, s) in run.time.iter().zip(run.of("mass.s")) {
        let (sin, cos) = (omega * t).sin_cos();
        let exact = s_0 * (-damping * omega_0 * t).exp() * (cos + damping * omega_0 / omega * sin);
        assert!((s - exact).abs() < 1e-8, "{s} instead of {exact} at {t} s");
    }
}

#[test]
fn filling_through_a_choked_restriction() {
    let run = Case::file("examples/filling.mol").run();
    let (c, p_0, p_start, volume, b): (f64, f64, f64, f64, f64) = (1e-9, 7e5, 1e5, 1e-3, 0.3);
    let rate = c * RHO_0 * p_0 * R * T / volume;
    let t_subsonic = (b * p_0 - p_start) / rate;
    let t_c = (1.0 - b) * volume / (c * RHO_0 * R * T);
    let mut compared = [0, 0];
    for (&t, &p) in run.time.iter().zip(run.of("p")) {
        let exact = if t <= t_subsonic {
            compared[0] += 1;
            p_start + rate * t
        } else {
            let ratio = b + (1.0 - b) * ((t - t_subsonic) / t_c).min(PI / 2.0).sin();
            if ratio > 0.999 {
                break;
            }
            compared[1] += 1;
            ratio * p_0
        };
        assert!((p - exact).abs() < 2.0, "{p} Pa instead of {exact} Pa at {t} s");
    }
    assert!(compared[0] > 50 && compared[1] > 300, "{compared:?}");
}

#[test]
fn equalisation_keeps_the_mass_of_air() {
    let run = Case::file("examples/equalisation.mol").run();
    let total = run.of("m_total");
    assert_close(total[0], (7e5 * 1e-3 + 1e5 * 2e-3) / (R * T), 1e-13);
    assert!(total.iter().all(|m| ((m - total[0]) / total[0]).abs() < 1e-13));
    assert_close(run.last("vessel_1.p"), 3e5, 1e-5);
    assert_close(run.last("vessel_2.p"), 3e5, 1e-5);
}

/// The text of an interpolated table is the table: the points (0, 0), (1, 2), (3, 1), with each extrapolation, and the slopes
/// of the cubic ones.
#[test]
fn a_table_is_a_function_of_its_text() {
    let (x, y) = ([0.0, 1.0, 3.0], [0.0, 2.0, 1.0]);
    let run = |curve: &Curve, order: u8| {
        let function = curve.modelica("f", order);
        Case::text(&format!(
            "model M\n{function}  Real y = f(6*time - 2);\n  annotation(experiment(StopTime = 1, Interval = 0.0625));\nend M;\n"
        ))
        .run()
    };
    let lines = |u: f64| if u < 1.0 { 2.0 * u } else { 2.0 - (u - 1.0) / 2.0 };
    let exact: [(Extrapolation, &dyn Fn(f64) -> f64); 3] = [
        (Extrapolation::Hold, &|u| lines(u.clamp(0.0, 3.0))),
        (Extrapolation::Linear, &lines),
        // The value at the end of a period is that at its start.
        (Extrapolation::Periodic, &|u| lines(u.rem_euclid(3.0))),
    ];
    for (extrapolation, exact) in exact {
        let curve = Curve::new(&x, &y, Smoothness::Linear, extrapolation).expect("a curve");
        let found = run(&curve, 0);
        for (t, found) in found.time.iter().zip(found.of("y")) {
            let exact = exact(6.0 * t - 2.0);
            assert!(
                (found - exact).abs() < 1e-12,
                "{extrapolation:?} at {t}: {found}, not {exact}"
            );
        }
    }
    for order in 0..=2 {
        let curve = Curve::new(&x, &y, Smoothness::Akima, Extrapolation::Linear).expect("a curve");
        let found = run(&curve, order);
        for (t, found) in found.time.iter().zip(found.of("y")) {
            let exact = curve.at(6.0 * t - 2.0, order);
            assert!((found - exact).abs() < 1e-12, "order {order} at {t}: {found}, not {exact}");
        }
    }
}
