//! BDF against published and closed-form solutions, and its behaviour where there is none.

use crate::integrate::bdf::Bdf;
use crate::integrate::options::Options;
use crate::integrate::outcome::{Failure, Step};
use crate::integrate::problems::*;
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::integrate::system::{EvalError, System};

fn bdf(rtol: f64, nominals: &[f64]) -> Bdf {
    Bdf::new(nominals.len(), Options::with_nominals(rtol, nominals)).unwrap()
}

fn solve(
    system: &mut dyn System,
    rtol: f64,
    nominals: &[f64],
    start: &[f64],
    t_stop: f64,
) -> (Vec<f64>, Stats) {
    let mut stepper = bdf(rtol, nominals);
    let y = run(&mut stepper, system, (0.0, start), t_stop).unwrap();
    (y, *stepper.stats())
}

/// Errors of many steps add up: a multistep method stays within some ten times the tolerance.
const ACCUMULATED: f64 = 100.0;

#[test]
fn robertson_over_eleven_decades() {
    for rtol in [1e-4, 1e-6, 1e-8] {
        let mut system = robertson();
        let mut stepper = bdf(rtol, &[1e-6, 1e-12, 1e-2]);
        stepper.restart(&mut system, 0.0, &[1.0, 0.0, 0.0], JacobianMemory::Forget).unwrap();
        for (k, reference) in ROBERTSON.iter().enumerate() {
            advance(&mut stepper, &mut system, 10.0_f64.powi(k as i32)).unwrap();
            let error = relative_error(stepper.y(), reference, 1e-10);
            println!("rtol {rtol}, t = 1e{k}: {error}");
            assert!(error < ACCUMULATED * rtol, "rtol {rtol}, t = 1e{k}: {error}");
        }
        println!("{:?}", stepper.stats());
    }
}

#[test]
fn hires_published_end() {
    for rtol in [1e-4, 1e-6, 1e-8, 1e-10] {
        let (y, stats) = solve(&mut hires(), rtol, &[1e-3; 8], &HIRES_START, HIRES_TIME);
        let error = relative_error(&y, &HIRES_END, 1e-6);
        println!("rtol {rtol},  {error} {stats:?}");
        assert!(error < ACCUMULATED * rtol, "rtol {rtol}: {error}");
    }
}

#[test]
fn van_der_pol_published_end() {
    for rtol in [1e-4, 1e-6, 1e-8] {
        let (y, stats) = solve(&mut van_der_pol(1e-6), rtol, &[1.0; 2], &[2.0, 0.0], 2.0);
        let error = relative_error(&y, &VAN_DER_POL_END, 0.0);
        println!("rtol {rtol},  {error} {stats:?}");
        assert!(error < ACCUMULATED * rtol, "rtol {rtol}: {error}");
    }
}
