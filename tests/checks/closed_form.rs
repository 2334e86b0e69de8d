//! Smooth systems whose solution is known.

use std::f64::consts::PI;

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
