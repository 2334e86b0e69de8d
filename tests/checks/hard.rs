//! Systems on which simulators are known to fail, each with a fact that is known.

use std::f64::consts::PI;

use super::door::{Case, Reading, assert_close};

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
