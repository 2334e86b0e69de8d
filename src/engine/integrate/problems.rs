//! Test problems with known solutions, shared by the tests of all steppers.

#![allow(clippy::excessive_precision, reason = "all digits of the sources are kept")]

use crate::integrate::outcome::{Failure, Step};
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::integrate::system::{EvalError, System};
use crate::numeric::pattern::Pattern;

/// A system made of closures, so that a test can state its equations where it uses them.
pub struct TestSystem<F, J> {
    pub differential: Vec<bool>,
    pub rhs: F,
    pub jacobian: J,
}

/// A system of `n` differential equations whose Jacobian cannot fail.
pub fn ode<F, J>(n: usize, rhs: F, jacobian: J) -> TestSystem<F, J>
where
    F: FnMut(f64, &[f64], &mut [f64]) -> Result<(), EvalError>,
    J: FnMut(f64, &[f64], &mut [f64]),
{
    TestSystem { differential: vec![true; n], rhs, jacobian }
}

impl<F, J> System for TestSystem<F, J>
where
    F: FnMut(f64, &[f64], &mut [f64]) -> Result<(), EvalError>,
    J: FnMut(f64, &[f64], &mut [f64]),
{
    fn dim(&self) -> usize {
        self.differential.len()
    }
    fn differential(&self) -> &[bool] {
        &self.differential
    }
    fn rhs(&mut self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        (self.rhs)(t, y, f)
    }
    fn jacobian(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        (self.jacobian)(t, y, j);
        Ok(())
    }
}

/// Runs from the accepted point to `t_stop`.
pub fn advance(
    stepper: &mut dyn Stepper,
    system: &mut dyn System,
    t_stop: f64,
) -> Result<(), Failure> {
    while let Step::Advanced { .. } = stepper.step(system, t_stop)? {}
    assert_eq!(stepper.t().to_bits(), t_stop.to_bits(), "the stop is hit exactly");
    Ok(())
}

/// Starts and runs; returns the solution at `t_stop`.
pub fn run(
    stepper: &mut dyn Stepper,
    system: &mut dyn System,
    (t, y): (f64, &[f64]),
    t_stop: f64,
) -> Result<Vec<f64>, Failure> {
    stepper.restart(system, t, y, JacobianMemory::Forget)?;
    advance(stepper, system, t_stop)?;
    Ok(stepper.y().to_vec())
}

/// Largest `|a_i - b_i| / (|b_i| + floor)`.
pub fn relative_error(a: &[f64], b: &[f64], floor: f64) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / (b.abs() + floor)).fold(0.0, f64::max)
}

/// A system with a known solution.
pub struct Problem {
    pub system: Box<dyn System>,
    /// Nominal values of the components.
    pub nominals: Vec<f64>,
    /// The solution at time zero.
    pub start: Vec<f64>,
    /// Later instants and the solution there.
    pub solution: Vec<(f64, Vec<f64>)>,
    /// Added to the denominator of the relative error.
    pub floor: f64,
}

/// Integrates a problem at each tolerance and compares the relative error with the allowed one:
/// `(rtol, allowed)`. Returns the statistics of each run.
pub fn check_stepper<S: Stepper>(
    make: impl Fn(f64, &[f64]) -> S,
    problem: Problem,
    tolerances: &[(f64, f64)],
) -> Vec<Stats> {
    let Problem { mut system, nominals, start, solution, floor } = problem;
    let mut stats = Vec::new();
    for &(rtol, allowed) in tolerances {
        let mut stepper = make(rtol, &nominals);
        stepper.restart(&mut *system, 0.0, &start, JacobianMemory::Forget).unwrap();
        for (t, reference) in &solution {
            advance(&mut stepper, &mut *system, *t).unwrap();
            let error = relative_error(stepper.y(), reference, floor);
            assert!(error < allowed, "rtol {rtol}, t = {t:e}: {error}");
        }
        stats.push(*stepper.stats());
    }
    stats
}

/// [`robertson`] over eleven decades of time.
pub fn robertson_problem() -> Problem {
    let decades = ROBERTSON.iter().enumerate();
    Problem {
        system: Box::new(robertson()),
        nominals: vec![1e-6, 1e-12, 1e-2],
        start: vec![1.0, 0.0, 0.0],
        solution: decades.map(|(k, y)| (10.0_f64.powi(k as i32), y.to_vec())).collect(),
        floor: 1e-10,
    }
}

/// [`hires`] at its published end.
pub fn hires_problem() -> Problem {
    Problem {
        system: Box::new(hires()),
        nominals: vec![1e-3; 8],
        start: HIRES_START.to_vec(),
        solution: vec![(HIRES_TIME, HIRES_END.to_vec())],
        floor: 1e-6,
    }
}

/// [`van_der_pol`] at its published end.
pub fn van_der_pol_problem() -> Problem {
    Problem {
        system: Box::new(van_der_pol(1e-6)),
        nominals: vec![1.0; 2],
        start: vec![2.0, 0.0],
        solution: vec![(2.0, VAN_DER_POL_END.to_vec())],
        floor: 0.0,
    }
}

/// `y' = z, 0 = y^2 + z^2 - 1` with `y = sin t, z = cos t`: index 1.
pub fn algebraic_problem() -> Problem {
    let mut system = ode(
        2,
        |_, y: &[f64], f: &mut [f64]| {
            f.copy_from_slice(&[y[1], y[0] * y[0] + y[1] * y[1] - 1.0]);
            Ok(())
        },
        |_, y: &[f64], j: &mut [f64]| j.copy_from_slice(&[0.0, 2.0 * y[0], 1.0, 2.0 * y[1]]),
    );
    system.differential[1] = false;
    Problem {
        system: Box::new(system),
        nominals: vec![1.0; 2],
        start: vec![0.0, 1.0],
        solution: vec![(1.2, vec![1.2_f64.sin(), 1.2_f64.cos()])],
        floor: 0.0,
    }
}

/// Equal inputs give equal bits, also in a stepper that was used before.
pub fn check_repeatability<S: Stepper>(make: impl Fn(f64, &[f64]) -> S) {
    let bits = |stepper: &mut S| -> Vec<u64> {
        let y = run(stepper, &mut hires(), (0.0, &HIRES_START), 100.0).unwrap();
        y.iter().map(|y| y.to_bits()).collect()
    };
    let mut stepper = make(1e-6, &[1e-3; 8]);
    let first = bits(&mut stepper);
    assert_eq!(bits(&mut stepper), first);
    assert_eq!(bits(&mut make(1e-6, &[1e-3; 8])), first);
}

/// A stop in the past changes nothing, and one a single double ahead is reached.
pub fn check_stops<S: Stepper>(make: impl Fn(f64, &[f64]) -> S) {
    let mut stepper = make(1e-6, &[1.0; 2]);
    let mut system = van_der_pol(1e-3);
    run(&mut stepper, &mut system, (0.0, &[2.0, 0.0]), 0.1).unwrap();
    let stats = *stepper.stats();
    for stop in [0.1, 0.0] {
        assert_eq!(stepper.step(&mut system, stop).unwrap(), Step::Reached { t: 0.1 });
    }
    assert_eq!(*stepper.stats(), stats);
    let next = 0.1_f64.next_up();
    assert_eq!(stepper.step(&mut system, next).unwrap(), Step::Reached { t: next });
}

/// A system without components only advances time.
pub fn check_empty_system<S: Stepper>(make: impl Fn(f64, &[f64]) -> S) {
    let mut system = ode(0, |_, _: &[f64], _: &mut [f64]| Ok(()), |_, _: &[f64], _: &mut [f64]| {});
    assert_eq!(run(&mut make(1e-6, &[]), &mut system, (0.0, &[]), 10.0).unwrap(), [0.0; 0]);
}

/// The oscillator `y1' = y2, y2' = -y1`, solved by `(sin t, cos t)`.
pub fn oscillator() -> impl System {
    ode(
        2,
        |_, y: &[f64], f: &mut [f64]| {
            f.copy_from_slice(&[y[1], -y[0]]);
            Ok(())
        },
        |_, _: &[f64], j: &mut [f64]| j.copy_from_slice(&[0.0, -1.0, 1.0, 0.0]),
    )
}

/// Shortens every third step of [`oscillator`] and continues from there, within `tolerance`.
pub fn check_shortening(stepper: &mut dyn Stepper, tolerance: f64) {
    let mut system = oscillator();
    stepper.restart(&mut system, 0.0, &[0.0, 1.0], JacobianMemory::Forget).unwrap();
    let mut out = [0.0; 2];
    for step in 0.. {
        if stepper.step(&mut system, 5.0).unwrap() == (Step::Reached { t: 5.0 }) {
            break;
        }
        if step % 3 == 2 {
            let (from, to) = (stepper.t_previous(), stepper.t());
            let t = from + 0.4 * (to - from);
            stepper.shorten(&mut system, t).unwrap();
            assert_eq!((stepper.t_previous(), stepper.t()), (from, t));
            let inside = 0.5 * (from + t);
            stepper.interpolate(inside, &mut out);
            assert!((out[0] - inside.sin()).abs() < 2.0 * tolerance);
        }
        let (sin, cos) = stepper.t().sin_cos();
        let error = relative_error(stepper.y(), &[sin, cos], 1.0);
        assert!(error < tolerance, "{error} at {}", stepper.t());
    }
    // Shortening has no effect outside of the last step.
    let y = stepper.y().to_vec();
    stepper.shorten(&mut system, 6.0).unwrap();
    stepper.shorten(&mut system, 0.0).unwrap();
    assert_eq!((stepper.t(), stepper.y()), (5.0, &y[..]));
}

/// Robertson's reaction; Hairer & Wanner II, eq. (IV.1.4) and problem ROBER of sec. IV.10.
pub fn robertson() -> impl System {
    ode(
        3,
        |_, y: &[f64], f: &mut [f64]| {
            let slow = 0.04 * y[0];
            let back = 1e4 * y[1] * y[2];
            let fast = 3e7 * y[1] * y[1];
            f.copy_from_slice(&[back - slow, slow - back - fast, fast]);
            Ok(())
        },
        |_, y: &[f64], j: &mut [f64]| {
            let (a, b, c) = (1e4 * y[2], 1e4 * y[1], 6e7 * y[1]);
            j.copy_from_slice(&[-0.04, 0.04, 0.0, a, -a - c, c, b, -b, 0.0]);
        },
    )
}

/// Solution of [`robertson`] at `t = 1, 10, ..., 1e11` from `(1, 0, 0)`: the reference values
/// distributed with the problem ROBER of Hairer & Wanner's test set (sec. IV.10).
pub const ROBERTSON: [[f64; 3]; 12] = [
    [0.9664597373330035, 0.3074626578578675e-4, 0.3350951640121071e-1],
    [0.8413699238414729, 0.1623390937990473e-4, 0.1586138422491472],
    [0.6172348823960878, 0.6153591274639123e-5, 0.3827589640126376],
    [0.3368745306607069, 0.2013702318261393e-5, 0.6631234556369748],
    [0.1073004285378040, 0.4800166972571660e-6, 0.8926990914454987],
    [0.1786592114209946e-1, 0.7274751468436319e-7, 0.9821340061103859],
    [0.2031483924973415e-2, 0.8142277783356159e-8, 0.9979685079327488],
    [0.2076093439016395e-3, 0.8306077485067610e-9, 0.9997923898254906],
    [0.2082417512179460e-4, 0.8329841429908955e-10, 0.9999791757415798],
    [0.2083229471647004e-5, 0.8332935037760723e-11, 0.9999979167621954],
    [0.2083328471883087e-6, 0.8333315602809495e-12, 0.9999997916663195],
    [0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050],
];

/// HIRES, the response of plants to light; Hairer & Wanner II, sec. IV.10.
pub fn hires() -> impl System {
    ode(
        8,
        |_, y: &[f64], f: &mut [f64]| {
            let r = 280.0 * y[5] * y[7];
            f[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
            f[1] = 1.71 * y[0] - 8.75 * y[1];
            f[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
            f[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
            f[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6];
            f[5] = -r + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
            f[6] = r - 1.81 * y[6];
            f[7] = -f[6];
            Ok(())
        },
        |_, y: &[f64], j: &mut [f64]| {
            let (p, q) = (280.0 * y[7], 280.0 * y[5]);
            for (i, k, value) in [
                (0, 0, -1.71),
                (0, 1, 0.43),
                (0, 2, 8.32),
                (1, 0, 1.71),
                (1, 1, -8.75),
                (2, 2, -10.03),
                (2, 3, 0.43),
                (2, 4, 0.035),
                (3, 1, 8.32),
                (3, 2, 1.71),
                (3, 3, -1.12),
                (4, 4, -1.745),
                (4, 5, 0.43),
                (4, 6, 0.43),
                (5, 3, 0.69),
                (5, 4, 1.71),
                (5, 5, -0.43 - p),
                (5, 6, 0.69),
                (5, 7, -q),
                (6, 5, p),
                (6, 6, -1.81),
                (6, 7, q),
                (7, 5, -p),
                (7, 6, 1.81),
                (7, 7, -q),
            ] {
                j[i + 8 * k] = value;
            }
        },
    )
}

/// Start of [`hires`] at `t = 0`.
pub const HIRES_START: [f64; 8] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
/// End of the integration interval of [`hires`].
pub const HIRES_TIME: f64 = 321.8122;
/// Solution of [`hires`] at [`HIRES_TIME`]: Test Set for IVP Solvers, problem HIRES.
pub const HIRES_END: [f64; 8] = [
    0.7371312573325668e-3,
    0.1442485726316185e-3,
    0.5888729740967575e-4,
    0.1175651343283149e-2,
    0.2386356198831331e-2,
    0.6238968252742796e-2,
    0.2849998395185769e-2,
    0.2850001604814231e-2,
];

/// Van der Pol's oscillator in the scaling of Hairer & Wanner II, eq. (IV.1.5'):
/// `eps y2' = (1 - y1^2) y2 - y1`.
pub fn van_der_pol(eps: f64) -> impl System {
    ode(
        2,
        move |_, y: &[f64], f: &mut [f64]| {
            f.copy_from_slice(&[y[1], ((1.0 - y[0] * y[0]) * y[1] - y[0]) / eps]);
            Ok(())
        },
        move |_, y: &[f64], j: &mut [f64]| {
            j.copy_from_slice(&[
                0.0,
                (-2.0 * y[0] * y[1] - 1.0) / eps,
                1.0,
                (1.0 - y[0] * y[0]) / eps,
            ]);
        },
    )
}

/// Solution of [`van_der_pol`] for `eps = 1e-6` at `t = 2` from `(2, 0)`: Test Set for IVP Solvers,
/// problem VDPOL.
pub const VAN_DER_POL_END: [f64; 2] = [0.1706167732170483e1, -0.8928097010247975];

/// The Arenstorf orbit: a satellite between earth and moon, back at its start after one period.
/// Hairer, Nørsett & Wanner I, sec. II.0, eq. (0.1) and (0.2).
pub fn arenstorf() -> impl System {
    ode(
        4,
        |_, y: &[f64], f: &mut [f64]| {
            let moon = 0.012277471;
            let earth = 1.0 - moon;
            let d1 = ((y[0] + moon).powi(2) + y[1] * y[1]).powf(1.5);
            let d2 = ((y[0] - earth).powi(2) + y[1] * y[1]).powf(1.5);
            f[0] = y[2];
            f[1] = y[3];
            f[2] = y[0] + 2.0 * y[3] - earth * (y[0] + moon) / d1 - moon * (y[0] - earth) / d2;
            f[3] = y[1] - 2.0 * y[2] - earth * y[1] / d1 - moon * y[1] / d2;
            Ok(())
        },
        |_, _: &[f64], _: &mut [f64]| {},
    )
}

/// Start, and after [`ARENSTORF_PERIOD`] the end, of [`arenstorf`].
pub const ARENSTORF_START: [f64; 4] = [0.994, 0.0, 0.0, -2.00158510637908252240537862224];
/// Period of [`arenstorf`].
pub const ARENSTORF_PERIOD: f64 = 17.0652165601579625588917206249;

/// The heat equation with a cubic sink; its pattern has three diagonals.
pub struct Heat {
    pattern: Pattern,
    differential: Vec<bool>,
}

impl Heat {
    /// On `n` points.
    pub fn new(n: usize) -> Self {
        let near = |j: usize| (j.saturating_sub(1)..(j + 2).min(n)).map(move |i| (i, j));
        let entries: Vec<_> = (0..n).flat_map(near).collect();
        let pattern = Pattern::from_entries(n, n, &entries);
        Heat { pattern, differential: vec![true; n] }
    }

    fn scale(&self) -> f64 {
        ((self.dim() + 1) * (self.dim() + 1)) as f64
    }

    /// Decay of the first mode.
    pub fn first_rate(&self) -> f64 {
        let angle = std::f64::consts::PI / (self.dim() + 1) as f64;
        4.0 * self.scale() * (0.5 * angle).sin().powi(2)
    }

    fn derivative(&self, y: &[f64], i: usize, j: usize) -> f64 {
        let scale = self.scale();
        if i == j { -2.0 * scale - 3.0 * y[j] * y[j] } else { scale }
    }
}

impl System for Heat {
    fn dim(&self) -> usize {
        self.differential.len()
    }
    fn differential(&self) -> &[bool] {
        &self.differential
    }
    fn rhs(&mut self, _: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        let (n, scale) = (y.len(), self.scale());
        for i in 0..n {
            let left = if i > 0 { y[i - 1] } else { 0.0 };
            let right = if i + 1 < n { y[i + 1] } else { 0.0 };
            f[i] = scale * (left - 2.0 * y[i] + right) - y[i].powi(3);
        }
        Ok(())
    }
    fn jacobian(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let n = y.len();
        for j in 0..n {
            for &i in self.pattern.column(j) {
                out[i + n * j] = self.derivative(y, i, j);
            }
        }
        Ok(())
    }
    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.pattern)
    }
    fn jacobian_entries(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let columns =
            (0..y.len()).flat_map(|j| self.pattern.column(j).iter().map(move |&i| (i, j)));
        for (out, (i, j)) in out.iter_mut().zip(columns) {
            *out = self.derivative(y, i, j);
        }
        Ok(())
    }
}
