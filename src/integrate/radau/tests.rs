//! Radau against published and closed-form solutions.

use crate::integrate::options::Options;
use crate::integrate::outcome::{Failure, Step};
use crate::integrate::problems::*;
use crate::integrate::radau::Radau;
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::integrate::system::{EvalError, System};

fn radau(rtol: f64, nominals: &[f64]) -> Radau {
    Radau::new(nominals.len(), Options::with_nominals(rtol, nominals)).unwrap()
}

fn solve(
    system: &mut dyn System,
    rtol: f64,
    nominals: &[f64],
    start: &[f64],
    t_stop: f64,
) -> (Vec<f64>, Stats) {
    let mut stepper = radau(rtol, nominals);
    let y = run(&mut stepper, system, (0.0, start), t_stop).unwrap();
    (y, *stepper.stats())
}

#[test]
fn robertson_over_eleven_decades() {
    for rtol in [1e-4, 1e-6, 1e-8] {
        let mut system = robertson();
        let mut stepper = radau(rtol, &[1e-6, 1e-12, 1e-2]);
        stepper.restart(&mut system, 0.0, &[1.0, 0.0, 0.0], JacobianMemory::Forget).unwrap();
        for (k, reference) in ROBERTSON.iter().enumerate() {
            advance(&mut stepper, &mut system, 10.0_f64.powi(k as i32)).unwrap();
            let error = relative_error(stepper.y(), reference, 1e-8);
            assert!(error < 20.0 * rtol, "rtol {rtol}, t = 1e{k}: {error}");
        }
        eprintln!("{rtol} {:?}", stepper.stats());
    }
}

#[test]
fn hires_published_end() {
    for rtol in [1e-4, 1e-6, 1e-8, 1e-10] {
        let (y, stats) = solve(&mut hires(), rtol, &[1e-3; 8], &HIRES_START, HIRES_TIME);
        let error = relative_error(&y, &HIRES_END, 1e-6);
        eprintln!("{rtol} {error} {stats:?}");
        assert!(error < 100.0 * rtol, "rtol {rtol}: {error}");
    }
}

#[test]
fn van_der_pol_published_end() {
    for rtol in [1e-4, 1e-6, 1e-8] {
        let (y, stats) = solve(&mut van_der_pol(1e-6), rtol, &[1.0; 2], &[2.0, 0.0], 2.0);
        let error = relative_error(&y, &VAN_DER_POL_END, 0.0);
        eprintln!("{rtol} {error} {stats:?}");
        assert!(error < 100.0 * rtol, "rtol {rtol}: {error}");
    }
}
