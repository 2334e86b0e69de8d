//! Dormand & Prince's explicit Runge-Kutta pair of order 5(4), for systems that are not stiff.
//!
//! Hairer, Nørsett & Wanner I, sec. II.5, table 5.2 (the pair) and sec. II.6, eq. (6.12) (the dense
//! output of order 4); J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6 (1980), 19-26. Step
//! size control of DOPRI5 with its stabilisation (sec. IV.2 of vol. II). The last stage of a step
//! is the first of the next.

use crate::integrate::control::{
    Point, StepInterval, error_weights, first_step, initial_step, next_interval, resolution,
};
use crate::integrate::options::{OptionError, Options};
use crate::integrate::outcome::{Failure, Step};
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::integrate::system::{EvalError, System};
use crate::numeric::norm::{first_non_finite, weighted_rms, worst_component};

/// Abscissae of stages 2 to 6.
const C: [f64; 5] = [0.2, 0.3, 0.8, 8.0 / 9.0, 1.0];
/// Weights of the earlier slopes in stages 2 to 6, and in the result (stage 7).
const A: [[f64; 6]; 6] = [
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Difference of the weights of order 5 and 4.
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];
/// Weights of the highest term of the dense output.
const DENSE: [f64; 7] = [
    -12715105075.0 / 11282082432.0,
    0.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

/// Safety factor of the step size prediction.
const SAFETY: f64 = 0.9;
/// Exponent of the last error, which damps oscillations of the step size.
const BETA: f64 = 0.04;
/// Maximum growth of the step.
const GROWTH: f64 = 10.0;
/// Maximum reduction of the step.
const SHRINK: f64 = 0.2;
/// Reduction if the system could not be evaluated.
const OUT_OF_DOMAIN: f64 = 0.25;

/// Approximate end of the stability region on the negative real axis.
const STABILITY: f64 = 3.25;
/// Minimum of [`border`]: a component that follows slow ones with a large eigenvalue also limits
/// steps by accuracy, to products with that eigenvalue of this size.
const MIN_BORDER: f64 = 1.0;
/// Number of stability-limited steps after which a system counts as stiff.
const STIFF_STEPS: u32 = 15;
/// Number of consecutive other steps after which that count is reset.
const RESET_STEPS: u32 = 6;

/// The stepper. Only for systems whose components are all differential.
pub struct DormandPrince {
    options: Options,
    now: Point,
    t_previous: f64,
    y_previous: Vec<f64>,
    next_y: Vec<f64>,
    weights: Vec<f64>,
    /// Slopes of stages 2 to 7; the first is `now.f`.
    slopes: [Vec<f64>; 6],
    /// Coefficients of the dense output.
    dense: [Vec<f64>; 4],
    /// End of the dense output.
    dense_end: f64,
    /// The slope at the start of the last step is still in the last stage.
    whole: bool,
    trial: Vec<f64>,
    /// Argument of stage 6, which like stage 7 is at the end of the step.
    sixth: Vec<f64>,
    stiffness: Stiffness,
    /// Product of step and eigenvalue from which on the system is stiff, see [`border`].
    border: f64,
    h: f64,
    error_last: f64,
    stats: Stats,
}

/// Counts steps whose length stability limits rather than accuracy.
#[derive(Clone, Copy, Default)]
struct Stiffness {
    limited: u32,
    free: u32,
    found: bool,
}

impl Stiffness {
    /// Updates the counts with the product of an accepted step and the dominant eigenvalue: Hairer
    /// & Wanner II, sec. IV.2, "automatic stiffness detection", with the counts of DOPRI5.
    fn observe(&mut self, product: f64, border: f64) {
        if product > border {
            self.free = 0;
            self.limited += 1;
            self.found |= self.limited >= STIFF_STEPS;
        } else {
            self.free += 1;
            if self.free >= RESET_STEPS {
                self.limited = 0;
            }
        }
    }
}

enum Rejection {
    Error { component: usize, size: f64 },
    NonFinite { component: usize },
    Eval(EvalError),
}

impl DormandPrince {
    /// A stepper for systems of `n` components. All memory is allocated here.
    pub fn new(n: usize, options: Options) -> Result<Self, OptionError> {
        options.validate(n)?;
        let zeros = || vec![0.0; n];
        Ok(DormandPrince {
            now: Point::new(n),
            t_previous: 0.0,
            y_previous: zeros(),
            next_y: zeros(),
            weights: zeros(),
            slopes: std::array::from_fn(|_| zeros()),
            dense: std::array::from_fn(|_| zeros()),
            dense_end: 0.0,
            whole: false,
            trial: zeros(),
            sixth: zeros(),
            stiffness: Stiffness::default(),
            border: border(options.rtol),
            h: 0.0,
            error_last: 1e-4,
            stats: Stats::default(),
            options,
        })
    }

    /// True if stability limits the steps since the restart: the system is stiff, and an implicit
    /// method would take longer steps.
    pub fn is_stiff(&self) -> bool {
        self.stiffness.found
    }

    /// The product of the step and the dominant eigenvalue, from the two stages at its end; zero if
    /// they coincide.
    fn spectral_step(&self, h: f64) -> f64 {
        let (mut slopes, mut arguments) = (0.0, 0.0);
        for (i, w) in self.weights.iter().enumerate() {
            slopes += ((self.slopes[5][i] - self.slopes[4][i]) * w).powi(2);
            arguments += ((self.next_y[i] - self.sixth[i]) * w).powi(2);
        }
        if arguments > 0.0 { h * (slopes / arguments).sqrt() } else { 0.0 }
    }

    /// Computes all stages of a step; the last one is evaluated at the result, in `next_y`.
    fn attempt(
        &mut self,
        system: &mut dyn System,
        interval: StepInterval,
    ) -> Result<f64, Rejection> {
        self.whole = false;
        for (stage, row) in A.iter().enumerate() {
            let (done, open) = self.slopes.split_at_mut(stage);
            let y = &mut self.next_y;
            for (i, y) in y.iter_mut().enumerate() {
                let sum: f64 = done.iter().zip(&row[1..]).map(|(k, a)| a * k[i]).sum();
                *y = self.now.y[i] + interval.h * (row[0] * self.now.f[i] + sum);
            }
            if stage == C.len() - 1 {
                self.sixth.copy_from_slice(y);
            }
            let t = C
                .get(stage)
                .map_or(interval.end, |c| (self.now.t + c * interval.h).min(interval.end));
            self.stats.rhs += 1;
            system.rhs(t, y, &mut open[0]).map_err(Rejection::Eval)?;
        }
        if let Some(component) = first_non_finite(&self.slopes[5]) {
            return Err(Rejection::NonFinite { component });
        }
        self.estimate(interval.h)
    }

    fn estimate(&mut self, h: f64) -> Result<f64, Rejection> {
        for (i, trial) in self.trial.iter_mut().enumerate() {
            let sum: f64 = self.slopes.iter().zip(&ERROR[1..]).map(|(k, e)| e * k[i]).sum();
            *trial = h * (ERROR[0] * self.now.f[i] + sum);
            let scale = self.now.y[i].abs().max(self.next_y[i].abs());
            self.weights[i] = 1.0 / (self.options.atol[i] + self.options.rtol * scale);
        }
        let size = weighted_rms(&self.trial, &self.weights);
        let component = worst_component(&self.trial, &self.weights).unwrap_or(0);
        if !size.is_finite() {
            return Err(Rejection::NonFinite { component });
        }
        if size <= 1.0 { Ok(size) } else { Err(Rejection::Error { component, size }) }
    }

    fn complete(&mut self, interval: StepInterval, error: f64, repeated: bool) {
        self.stats.steps += 1;
        self.stiffness.observe(self.spectral_step(interval.h), self.border);
        self.set_dense(interval.h);
        self.advance_to(interval.end);
        let exponent = 0.2 - 0.75 * BETA;
        let shrink = error.powf(exponent) / self.error_last.powf(BETA) / SAFETY;
        let divisor = shrink.clamp(1.0 / GROWTH, 1.0 / SHRINK);
        let mut wanted = interval.h / divisor;
        if repeated {
            wanted = wanted.min(interval.h);
        } else if divisor <= 1.0 / GROWTH {
            wanted = wanted.max(self.h);
        }
        self.h = wanted.min(self.options.max_step);
        self.error_last = error.max(1e-4);
    }

    /// Makes the result of an attempt the accepted point.
    fn advance_to(&mut self, end: f64) {
        self.whole = true;
        self.t_previous = self.now.t;
        self.now.t = end;
        self.dense_end = end;
        std::mem::swap(&mut self.y_previous, &mut self.now.y);
        std::mem::swap(&mut self.now.y, &mut self.next_y);
        std::mem::swap(&mut self.now.f, &mut self.slopes[5]);
    }

    fn set_dense(&mut self, h: f64) {
        let [d1, d2, d3, d4] = &mut self.dense;
        for i in 0..d1.len() {
            let (f0, f1) = (self.now.f[i], self.slopes[5][i]);
            let difference = self.next_y[i] - self.now.y[i];
            let chord = h * f0 - difference;
            let sum: f64 = self.slopes.iter().zip(&DENSE[1..]).map(|(k, d)| d * k[i]).sum();
            d1[i] = difference;
            d2[i] = chord;
            d3[i] = difference - h * f1 - chord;
            d4[i] = h * (DENSE[0] * f0 + sum);
        }
    }

    fn recover(
        &mut self,
        interval: StepInterval,
        rejection: Rejection,
        cuts: u32,
    ) -> Result<(), Failure> {
        let factor = match rejection {
            Rejection::Error { size, .. } => {
                self.stats.rejected += 1;
                (SAFETY / size.powf(0.2)).clamp(SHRINK, 1.0)
            }
            Rejection::NonFinite { .. } | Rejection::Eval(EvalError::Recoverable(_)) => {
                self.stats.evaluation_failures += 1;
                OUT_OF_DOMAIN
            }
            Rejection::Eval(EvalError::Fatal(_)) => {
                return Err(self.failure(interval.h, &rejection));
            }
        };
        let h = interval.h * factor;
        let shortest = self.options.min_step.max(resolution(self.now.t));
        if cuts >= self.options.max_cuts || !(h > shortest) {
            return Err(self.failure(h, &rejection));
        }
        self.h = h;
        Ok(())
    }

    fn failure(&self, h: f64, rejection: &Rejection) -> Failure {
        let t = self.now.t;
        match *rejection {
            Rejection::Error { component, .. } => Failure::StepTooSmall { t, h, component },
            Rejection::NonFinite { component } => Failure::NonFinite { t, component },
            Rejection::Eval(error) => Failure::Eval { t, error },
        }
    }
}

/// The product of step and dominant eigenvalue above which accuracy cannot be what limits the step:
/// three times that of `y' = lambda y` with a local error of `rtol`, whose error constant is about
/// 1e-4; at most the stability limit.
fn border(rtol: f64) -> f64 {
    (3.0 * (1e4 * rtol).powf(0.2)).clamp(MIN_BORDER, STABILITY)
}

impl Stepper for DormandPrince {
    fn step(&mut self, system: &mut dyn System, t_stop: f64) -> Result<Step, Failure> {
        if !(t_stop > self.now.t) {
            return Ok(Step::Reached { t: self.now.t });
        }
        let mut cuts = 0;
        loop {
            let (t, h) = (self.now.t, self.h);
            let worst = || worst_component(&self.trial, &self.weights).unwrap_or(0);
            let interval = next_interval(t, h, t_stop, &self.options, &self.stats, worst)?;
            match self.attempt(system, interval) {
                Ok(error) => {
                    self.complete(interval, error, cuts > 0);
                    return Ok(interval.outcome());
                }
                Err(rejection) => {
                    cuts += 1;
                    self.recover(interval, rejection, cuts)?;
                }
            }
        }
    }

    fn shorten(&mut self, system: &mut dyn System, t: f64) -> Result<(), Failure> {
        // The last stage still holds the slope at the previous point, unless a later attempt
        // failed.
        if !(self.t_previous < t && t < self.now.t && self.whole) {
            return Ok(());
        }
        std::mem::swap(&mut self.now.f, &mut self.slopes[5]);
        std::mem::swap(&mut self.now.y, &mut self.y_previous);
        let end = self.now.t;
        self.now.t = self.t_previous;
        let interval = StepInterval { h: t - self.t_previous, end: t, last: true };
        match self.attempt(system, interval) {
            Ok(_) | Err(Rejection::Error { .. }) => {
                self.set_dense(interval.h);
                self.advance_to(t);
                Ok(())
            }
            Err(rejection) => {
                // The dense output of the whole step starts at its first point.
                self.y_previous.copy_from_slice(&self.now.y);
                self.dense_end = end;
                Err(self.failure(interval.h, &rejection))
            }
        }
    }

    fn restart(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
        _: JacobianMemory,
    ) -> Result<(), Failure> {
        if let Some(component) = system.differential().iter().position(|d| !d) {
            return Err(Failure::Singular { t, component });
        }
        self.now.start(system, t, y, &mut self.stats)?;
        self.t_previous = t;
        self.dense_end = t;
        self.y_previous.copy_from_slice(y);
        for d in &mut self.dense {
            d.fill(0.0);
        }
        self.error_last = 1e-4;
        self.stiffness = Stiffness::default();
        error_weights(&self.options, &self.now.y, &mut self.weights);
        let h = match self.options.initial_step {
            Some(h) => h,
            None => initial_step(
                system,
                &self.now,
                &self.weights,
                5,
                &mut self.trial,
                &mut self.next_y,
                &mut self.stats,
            ),
        };
        self.h = first_step(&self.options, t, h);
        Ok(())
    }

    fn t(&self) -> f64 {
        self.now.t
    }

    fn y(&self) -> &[f64] {
        &self.now.y
    }

    fn t_previous(&self) -> f64 {
        self.t_previous
    }

    fn interpolate(&self, t: f64, out: &mut [f64]) {
        if t == self.now.t {
            return out.copy_from_slice(&self.now.y);
        }
        let h = self.dense_end - self.t_previous;
        let s = if h > 0.0 { (t - self.t_previous) / h } else { 0.0 };
        let [d1, d2, d3, d4] = &self.dense;
        for (i, out) in out.iter_mut().enumerate() {
            let inner = d2[i] + s * (d3[i] + (1.0 - s) * d4[i]);
            *out = self.y_previous[i] + s * (d1[i] + (1.0 - s) * inner);
        }
    }

    fn next_step(&self) -> f64 {
        self.h
    }

    fn stats(&self) -> &Stats {
        &self.stats
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::problems::*;

    /// The dense output must agree with the step at its ends; its weights then sum to zero.
    #[test]
    fn coefficients_are_consistent() {
        for (row, c) in A.iter().zip(C.iter().chain(&[1.0])) {
            assert!((row.iter().sum::<f64>() - c).abs() < 2e-15);
        }
        assert!(ERROR.iter().sum::<f64>().abs() < 1e-16);
        assert!(DENSE.iter().sum::<f64>().abs() < 1e-14);
    }

    #[test]
    fn arenstorf_orbit_closes() {
        for rtol in [1e-7, 1e-9, 1e-11] {
            let options = Options::with_nominals(rtol, &[1.0; 4]);
            let mut stepper = DormandPrince::new(4, options).unwrap();
            let start = (0.0, &ARENSTORF_START[..]);
            let y = run(&mut stepper, &mut arenstorf(), start, ARENSTORF_PERIOD).unwrap();
            let error = relative_error(&y, &ARENSTORF_START, 1.0);
            // The orbit amplifies errors near the moon by several powers of ten.
            assert!(error < 3e4 * rtol, "rtol {rtol}: {error}");
        }
    }

    /// y' = -y: order 5 at the ends and order 4 between them.
    #[test]
    fn order_of_steps_and_of_dense_output() {
        let mut errors = Vec::new();
        for steps in [8, 16] {
            let mut options = Options::with_nominals(0.99, &[1e6]);
            let h = 1.0 / f64::from(steps);
            (options.initial_step, options.max_step) = (Some(h), h);
            let mut stepper = DormandPrince::new(1, options).unwrap();
            let mut system = ode(
                1,
                |_, y: &[f64], f: &mut [f64]| {
                    f[0] = -y[0];
                    Ok(())
                },
                |_, _: &[f64], _: &mut [f64]| {},
            );
            stepper.restart(&mut system, 0.0, &[1.0], JacobianMemory::Forget).unwrap();
            let (mut dense, mut out) = (0.0_f64, [0.0]);
            while stepper.t() < 1.0 {
                stepper.step(&mut system, 1.0).unwrap();
                for part in 1..8 {
                    let t = stepper.t() - h * f64::from(part) / 8.0;
                    stepper.interpolate(t, &mut out);
                    dense = dense.max((out[0] - (-t).exp()).abs());
                }
            }
            errors.push(((stepper.y()[0] - (-1.0_f64).exp()).abs(), dense));
        }
        let order = |a: f64, b: f64| (a / b).log2();
        let end = order(errors[0].0, errors[1].0);
        let dense = order(errors[0].1, errors[1].1);
        assert!((end - 5.0).abs() < 0.3, "{end}");
        assert!(dense > 4.5, "{dense}");
    }

    #[test]
    fn a_shortened_step_is_as_accurate_as_a_whole_one() {
        let options = Options::with_nominals(1e-8, &[1.0; 2]);
        let mut stepper = DormandPrince::new(2, options).unwrap();
        check_shortening(&mut stepper, 1e-8);
    }

    #[test]
    fn algebraic_rows_are_refused() {
        let mut stepper = DormandPrince::new(1, Options::new(1)).unwrap();
        let mut system =
            ode(1, |_, _: &[f64], _: &mut [f64]| Ok(()), |_, _: &[f64], _: &mut [f64]| {});
        system.differential[0] = false;
        let result = stepper.restart(&mut system, 0.0, &[1.0], JacobianMemory::Forget);
        assert_eq!(result, Err(Failure::Singular { t: 0.0, component: 0 }));
    }
}
