//! BDF against published and closed-form solutions, and its behaviour where there is none.

use crate::integrate::bdf::Bdf;
use crate::integrate::options::Options;
use crate::integrate::outcome::Failure;
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

/// Errors of single steps meet the tolerance; those of many steps add up, the more the tighter it
/// is, as published work-precision diagrams of multistep codes show (Hairer & Wanner II, sec. V.5).
#[test]
fn published_solutions_are_met() {
    check_stepper(bdf, robertson_problem(), &[(1e-4, 5e-3), (1e-6, 5e-5), (1e-8, 1e-6)]);
    check_stepper(bdf, hires_problem(), &[(1e-4, 5e-3), (1e-6, 1e-4), (1e-8, 1e-6), (1e-10, 5e-8)]);
    check_stepper(bdf, van_der_pol_problem(), &[(1e-4, 5e-3), (1e-6, 5e-5), (1e-8, 1e-6)]);
}

/// The work is part of the contract: a change here is a change of the method.
#[test]
fn statistics_of_hires() {
    let (_, stats) = solve(&mut hires(), 1e-6, &[1e-3; 8], &HIRES_START, HIRES_TIME);
    assert_eq!((stats.steps, stats.rejected, stats.convergence_failures), (470, 40, 3));
    assert_eq!(stats.newton_iterations, 804);
    // One right side per iteration, two to start.
    assert_eq!(stats.rhs, stats.newton_iterations + 2);
    assert_eq!((stats.jacobians, stats.decompositions), (10, 98));
}

#[test]
fn algebraic_equation_of_index_one() {
    for stats in
        check_stepper(bdf, algebraic_problem(), &[(1e-4, 1e-2), (1e-6, 1e-4), (1e-9, 1e-7)])
    {
        assert!(stats.rejected <= stats.steps / 4, "{stats:?}");
    }
}

/// A system that is not stiff: the oscillator over a few periods.
#[test]
fn an_oscillator_keeps_its_amplitude() {
    for rtol in [1e-4, 1e-6, 1e-8] {
        let (y, _) = solve(&mut oscillator(), rtol, &[1.0; 2], &[0.0, 1.0], 20.0);
        let error = relative_error(&y, &[20.0_f64.sin(), 20.0_f64.cos()], 1.0);
        assert!(error < 200.0 * rtol, "rtol {rtol}: {error}");
    }
}

/// The steps of a method of order `q` grow in number as `tol^(-1/(q+1))` as the tolerance falls.
#[test]
fn high_orders_are_reached() {
    let mut steps = Vec::new();
    for rtol in [1e-6, 1e-9] {
        let (_, stats) = solve(&mut oscillator(), rtol, &[1.0; 2], &[0.0, 1.0], 50.0);
        steps.push(stats.steps as f64);
    }
    let order = 3.0 / (steps[1] / steps[0]).log10() - 1.0;
    assert!(order > 4.0, "{order}");
}

/// Prothero & Robinson's problem, stiff: between the ends the solution is as good as at them, and
/// there it is the solution to the bit, of the step before too.
#[test]
fn dense_output_of_a_stiff_component() {
    for rtol in [1e-4, 1e-6, 1e-8] {
        let mut system = ode(
            1,
            |t: f64, y: &[f64], f: &mut [f64]| {
                f[0] = -1e3 * (y[0] - t.cos()) - t.sin();
                Ok(())
            },
            |_, _: &[f64], j: &mut [f64]| j[0] = -1e3,
        );
        let mut stepper = bdf(rtol, &[1.0]);
        stepper.restart(&mut system, 0.0, &[1.0], JacobianMemory::Forget).unwrap();
        let (mut out, mut worst, mut last) = ([0.0], 0.0_f64, 1.0);
        while stepper.t() < 10.0 {
            stepper.step(&mut system, 10.0).unwrap();
            let (from, to) = (stepper.t_previous(), stepper.t());
            for part in 0..=10 {
                let t = from + (to - from) * f64::from(part) / 10.0;
                stepper.interpolate(t, &mut out);
                worst = worst.max((out[0] - t.cos()).abs() / rtol);
            }
            stepper.interpolate(from, &mut out);
            assert!((out[0] - last).abs() < 1e-13, "{}", out[0] - last);
            stepper.interpolate(to, &mut out);
            assert_eq!(out[0].to_bits(), stepper.y()[0].to_bits());
            last = out[0];
        }
        assert!(worst < 20.0, "rtol {rtol}: {worst}");
    }
}

#[test]
fn a_shortened_step_is_as_accurate_as_a_whole_one() {
    // Steps done again begin with less memory: more of them, and errors add up.
    check_shortening(&mut bdf(1e-8, &[1.0; 2]), 2e-5);
}

/// A component whose equation is `y' = 0` is never moved, by prediction or correction.
#[test]
fn a_component_at_rest_is_constant_to_the_bit() {
    let mut system = ode(
        2,
        |t: f64, y: &[f64], f: &mut [f64]| {
            f.copy_from_slice(&[0.0, -200.0 * (y[1] - (5.0 * t).sin()) + y[0]]);
            Ok(())
        },
        |_, _: &[f64], j: &mut [f64]| j.copy_from_slice(&[0.0, 1.0, 0.0, -200.0]),
    );
    let rest = 0.1 + 0.2;
    let mut stepper = bdf(1e-6, &[1.0; 2]);
    let y = run(&mut stepper, &mut system, (0.0, &[rest, 0.0]), 3.0).unwrap();
    assert!(stepper.stats().steps > 50);
    assert_eq!(y[0].to_bits(), rest.to_bits());
}

/// `y' = 1` up to `t = 1/3` and `y' = -200 y` from there on.
#[test]
fn restart_after_a_jump_in_the_equations() {
    let switch = 1.0 / 3.0;
    let late = std::cell::Cell::new(false);
    let mut system = ode(
        1,
        |_, y: &[f64], f: &mut [f64]| {
            f[0] = if late.get() { -200.0 * y[0] } else { 1.0 };
            Ok(())
        },
        |_, _: &[f64], j: &mut [f64]| j[0] = if late.get() { -200.0 } else { 0.0 },
    );
    let mut stepper = bdf(1e-6, &[1.0]);
    let y = run(&mut stepper, &mut system, (0.0, &[0.0]), switch).unwrap();
    assert!((y[0] - switch).abs() < 1e-14);
    late.set(true);
    stepper.restart(&mut system, switch, &y, JacobianMemory::Forget).unwrap();
    assert_eq!((stepper.t(), stepper.t_previous()), (switch, switch));
    let mut out = [0.0];
    stepper.interpolate(switch, &mut out);
    assert_eq!(out, [y[0]]);
    advance(&mut stepper, &mut system, 0.35).unwrap();
    let exact = switch * (-200.0 * (0.35 - switch)).exp();
    assert!((stepper.y()[0] - exact).abs() < 1e-5);
    let jacobians = stepper.stats().jacobians;
    let y = stepper.y().to_vec();
    stepper.restart(&mut system, 0.35, &y, JacobianMemory::Keep).unwrap();
    stepper.step(&mut system, 0.4).unwrap();
    assert_eq!(stepper.stats().jacobians, jacobians, "a kept Jacobian saves an evaluation");
}

/// Torricelli's law: `y' = -sqrt y` empties the tank at `t = 2` along `(1 - t/2)^2`.
#[test]
fn a_domain_error_cuts_the_step() {
    for outside in [Some(EvalError::Recoverable(7)), None] {
        let mut system = ode(
            1,
            move |_, y: &[f64], f: &mut [f64]| {
                f[0] = -y[0].sqrt();
                if f[0].is_nan() { outside.map_or(Ok(()), Err) } else { Ok(()) }
            },
            |_, y: &[f64], j: &mut [f64]| j[0] = -0.5 / y[0].sqrt(),
        );
        let mut options = Options::with_nominals(1e-6, &[1e-3]);
        // Long enough that the first attempts leave the domain.
        options.initial_step = Some(50.0);
        let mut stepper = Bdf::new(1, options).unwrap();
        let y = run(&mut stepper, &mut system, (0.0, &[1.0]), 1.9).unwrap();
        assert!((y[0] - 0.05_f64.powi(2)).abs() < 1e-5, "{}", y[0]);
        assert!(stepper.stats().evaluation_failures > 0);
    }
}

/// Every kind of failure terminates and names the cause.
#[test]
fn failures_end_and_name_the_culprit() {
    fn outcome(rhs: impl FnMut(f64, &[f64], &mut [f64]) -> Result<(), EvalError>) -> Failure {
        let mut system = ode(2, rhs, |_, _: &[f64], _: &mut [f64]| {});
        run(&mut bdf(1e-6, &[1.0; 2]), &mut system, (0.0, &[1.0, 1.0]), 5.0).unwrap_err()
    }
    let t = 0.0;
    for error in [EvalError::Recoverable(4), EvalError::Fatal(5)] {
        let failure = outcome(|t, _, f| {
            f.fill(1.0);
            if t > 0.0 { Err(error) } else { Ok(()) }
        });
        assert_eq!(failure, Failure::Eval { t, error });
    }
    let failure = outcome(|t, _, f| {
        f.copy_from_slice(&[1.0, if t > 0.0 { f64::NAN } else { 0.0 }]);
        Ok(())
    });
    assert_eq!(failure, Failure::NonFinite { t, component: 1 });
    // y' = y^2 has a pole at t = 1.
    let failure = outcome(|_, y, f| {
        f.copy_from_slice(&[0.0, y[1] * y[1]]);
        Ok(())
    });
    match failure {
        Failure::StepTooSmall { t, component, .. }
        | Failure::NewtonFailed { t, component, .. }
        | Failure::NonFinite { t, component } => {
            assert!((t - 1.0).abs() < 1e-4, "{t}");
            assert_eq!(component, 1);
        }
        other => panic!("{other:?}"),
    }
    let mut options = Options::with_nominals(1e-6, &[1.0; 2]);
    options.max_steps = 5;
    let mut stepper = Bdf::new(2, options).unwrap();
    let failure = run(&mut stepper, &mut van_der_pol(1e-3), (0.0, &[2.0, 0.0]), 2.0).unwrap_err();
    assert!(matches!(failure, Failure::TooManySteps { steps: 5, .. }));
}

#[test]
fn runs_repeat_to_the_bit() {
    check_repeatability(bdf);
    check_stops(bdf);
}

#[test]
fn a_system_without_components_only_advances_time() {
    check_empty_system(bdf);
}

/// Dense and sparse decompositions differ by rounding only; the first mode of the linear heat
/// equation gives the size of the solution.
#[test]
fn sparse_and_dense_decompositions_agree() {
    let n = 150;
    let mut system = Heat::new(n);
    let angle = std::f64::consts::PI / (n + 1) as f64;
    let start: Vec<f64> = (1..=n).map(|i| 1e-3 * (angle * i as f64).sin()).collect();
    let options = || Options::with_nominals(1e-8, &vec![1e-3; n]);
    let mut end = |mut stepper: Bdf| run(&mut stepper, &mut system, (0.0, &start), 0.1).unwrap();
    let by_dense = end(Bdf::new(n, options()).unwrap());
    let by_sparse = end(Bdf::for_system(&Heat::new(n), options()).unwrap());
    let decay = (-0.1 * system.first_rate()).exp();
    for ((a, b), y) in by_dense.iter().zip(&by_sparse).zip(&start) {
        assert!((a - b).abs() < 1e-13, "{a} {b}");
        // The cubic sink removes less than a part in 1e6 of the remainder.
        assert!((a - decay * y).abs() < 1e-8 + 1e-6 * y, "{a} {}", decay * y);
    }
}
