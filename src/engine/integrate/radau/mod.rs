//! Radau IIA of order 5: for stiff systems and differential-algebraic systems of index 1.
//!
//! E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II* (2nd ed. 1996), sec. IV.8;
//! the constants are those of the authors' RADAU5, except that tolerances are taken as they are
//! (RADAU5 loosens `rtol` to `0.1 rtol^(2/3)`, by which just the ends of steps meet them): the
//! dense output, whose error is of the order of the estimate, is used to find events and should
//! meet them.
pub mod estimate;
pub mod polynomial;
pub mod stage_system;
pub mod stages;
pub mod tableau;
pub mod variation;

#[cfg(test)]
mod tests;

use crate::integrate::control::{
    Point, StepInterval, error_weights, first_step, initial_step, next_interval, resolution,
};
use crate::integrate::matrix::{IterationMatrix, Planes, Shift};
use crate::integrate::options::{OptionError, Options};
use crate::integrate::outcome::{Failure, Step};
use crate::integrate::radau::estimate::{ErrorEstimate, ORDER};
use crate::integrate::radau::polynomial::Polynomial;
use crate::integrate::radau::stages::{MAX_ITERATIONS, StageError, Stages, shift};
use crate::integrate::radau::variation::{AcceptedStep, NoVariation, Variation};
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::integrate::system::{EvalError, System};
use crate::integrate::variational::Variational;
use crate::numeric::norm::first_non_finite;

/// Safety factor of the step size prediction.
const SAFETY: f64 = 0.9;
/// Maximum growth of the step.
const GROWTH: f64 = 8.0;
/// Maximum reduction of the step.
const SHRINK: f64 = 0.2;
/// Maximum reduction of a rejected first step, whose length was a guess.
const SHRINK_FIRST: f64 = 0.01;
/// Shortest first step after an event, relative to the one that the slope suggests, where steps before it were short.
const LEAST_AFTER_EVENT: f64 = 0.05;
/// Error of the cubic between its nodes, in units of the tolerance, above which the next step is
/// shortened; the quartic of the dense output is more accurate.
const BETWEEN_NODES: f64 = 10.0;
/// Minimum growth that is worth a new decomposition.
const WORTHWHILE: f64 = 1.2;
/// Convergence rate up to which the Jacobian is kept.
const FAST: f64 = 1e-3;
/// Reduction if the system could not be evaluated.
const OUT_OF_DOMAIN: f64 = 0.25;

/// The stepper.
pub struct Radau {
    options: Options,
    now: Point,
    t_previous: f64,
    next: Point,
    weights: Vec<f64>,
    polynomial: Polynomial,
    stages: Stages,
    matrix: IterationMatrix,
    jacobian: JacobianAge,
    decomposed: Option<Shift>,
    history: History,
    estimate: ErrorEstimate,
    stats: Stats,
}

/// Age of the Jacobian.
#[derive(Clone, Copy, PartialEq, Eq)]
enum JacobianAge {
    /// To be evaluated before use.
    Outdated,
    /// From an earlier point.
    Old,
    /// Evaluated at the accepted point.
    Fresh,
}

/// State of the step size control since the restart.
struct History {
    /// Wanted length of the next step.
    h: f64,
    /// Length and error of the last accepted step, for Gustafsson's control; `None` after a
    /// restart, when the error estimate is checked more strictly.
    last: Option<(f64, f64)>,
    /// The polynomial may be extrapolated into the next step.
    continued: bool,
    /// The curvature of the solution jumps where the next step begins.
    kink: bool,
}

/// Why an attempt to step failed.
#[derive(Clone, Copy)]
enum Rejection {
    Error {
        component: usize,
        size: f64,
        iterations: u32,
    },
    Newton {
        component: usize,
        reduction: f64,
    },
    Singular {
        component: usize,
    },
    NonFinite {
        component: usize,
    },
    Eval(EvalError),
    /// The Jacobian at the accepted point cannot be evaluated: no step can help.
    JacobianError(JacobianError),
}

#[derive(Clone, Copy)]
enum JacobianError {
    Eval(EvalError),
    NonFinite { component: usize },
}

/// An attempt that passed all tests.
struct Success {
    error: f64,
    iterations: u32,
}

impl Radau {
    /// A stepper for systems of `n` components, with dense matrices. All memory is allocated here.
    pub fn new(n: usize, options: Options) -> Result<Self, OptionError> {
        Radau::with_matrix(n, IterationMatrix::dense(n, Planes::Complex), options)
    }

    /// A stepper for this system, with the matrices of [`IterationMatrix::for_system`].
    pub fn for_system(system: &dyn System, options: Options) -> Result<Self, OptionError> {
        let matrix = IterationMatrix::for_system(system, Planes::Complex);
        Radau::with_matrix(system.dim(), matrix, options)
    }

    fn with_matrix(
        n: usize,
        matrix: IterationMatrix,
        options: Options,
    ) -> Result<Self, OptionError> {
        options.validate(n)?;
        Ok(Radau {
            now: Point::new(n),
            t_previous: 0.0,
            next: Point::new(n),
            weights: vec![1.0; n],
            polynomial: Polynomial::new(n),
            stages: Stages::new(n, &options),
            matrix,
            jacobian: JacobianAge::Outdated,
            decomposed: None,
            history: History { h: 0.0, last: None, continued: false, kink: false },
            estimate: ErrorEstimate::new(n),
            stats: Stats::default(),
            options,
        })
    }

    /// Advances the derivatives of the solution over the last step. Call it directly after each
    /// step; after a restart of this stepper, restart `variation` too.
    pub fn advance_variation(
        &mut self,
        system: &mut dyn Variational,
        variation: &mut Variation,
    ) -> Result<(), NoVariation> {
        // After a step, `next` holds the previous point.
        let (from, end) = (&self.next, self.now.t);
        let h = self.polynomial.length();
        let (weights, rtol) = (&self.weights[..], self.options.rtol);
        let step = AcceptedStep { from, z: &self.stages.z, h, end, weights, rtol };
        variation.advance(system, step, &mut self.matrix)?;
        // The last stage is the point at which the next step needs its Jacobian.
        if self.jacobian == JacobianAge::Outdated
            && system.jacobian(2).is_some_and(|entries| self.matrix.adopt(entries))
        {
            self.decomposed = None;
            self.jacobian = JacobianAge::Fresh;
        }
        Ok(())
    }

    /// The options.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Decomposes the iteration matrices unless they are still valid.
    fn prepare(&mut self, system: &mut dyn System, h: f64) -> Result<(), Rejection> {
        if self.jacobian == JacobianAge::Outdated {
            self.stats.jacobians += 1;
            self.matrix
                .evaluate(system, self.now.t, &self.now.y)
                .map_err(|error| Rejection::JacobianError(JacobianError::Eval(error)))?;
            self.decomposed = None;
            self.matrix.analyze().map_err(|component| {
                Rejection::JacobianError(JacobianError::NonFinite { component })
            })?;
            self.jacobian = JacobianAge::Fresh;
        }
        let shift = shift(h);
        if self.decomposed != Some(shift) {
            self.stats.decompositions += 1;
            self.decomposed = None;
            self.matrix
                .factor(shift)
                .map_err(|singular| Rejection::Singular { component: singular.column })?;
            self.decomposed = Some(shift);
        }
        Ok(())
    }

    /// Sets the starting values of the stages.
    fn predict(&mut self, h: f64) {
        if self.history.continued {
            self.stages.start_from(&self.polynomial, h);
        } else {
            self.stages.start_from_zero();
        }
    }

    /// Solves the stage equations; the third stage is the candidate for the next point.
    fn solve(&mut self, system: &mut dyn System, interval: StepInterval) -> Result<u32, Rejection> {
        let iterations = self
            .stages
            .solve(system, &self.now, interval, &self.weights, &mut self.matrix, &mut self.stats)
            .map_err(|rejection| match rejection {
                StageError::Eval(error) => Rejection::Eval(error),
                StageError::NonFinite { component } => Rejection::NonFinite { component },
                StageError::Slow { component, reduction } => {
                    Rejection::Newton { component, reduction }
                }
            })?;
        self.next.t = interval.end;
        for ((next, y), z) in self.next.y.iter_mut().zip(&self.now.y).zip(&self.stages.z[2]) {
            *next = y + z;
        }
        Ok(iterations)
    }

    /// Accepts or rejects by the estimate of the local error.
    fn test(
        &mut self,
        system: &mut dyn System,
        h: f64,
        iterations: u32,
        strict: bool,
    ) -> Result<f64, Rejection> {
        let (now, weights) = (&self.now, &self.weights[..]);
        let mut size = self.estimate.first(now, h, &self.stages.z, &mut self.matrix, weights);
        if !(size < 1.0) && strict {
            let matrix = &mut self.matrix;
            size = self.estimate.again(system, now, matrix, weights, size, &mut self.stats);
        }
        if size < 1.0 {
            return Ok(size.max(1e-10));
        }
        let component = self.estimate.worst(weights);
        if size.is_finite() {
            Err(Rejection::Error { component, size, iterations })
        } else {
            Err(Rejection::NonFinite { component })
        }
    }

    /// Evaluates the right side at the candidate; the last condition for accepting it.
    fn evaluate_next(&mut self, system: &mut dyn System) -> Result<(), Rejection> {
        self.stats.rhs += 1;
        system.rhs(self.next.t, &self.next.y, &mut self.next.f).map_err(Rejection::Eval)?;
        match first_non_finite(&self.next.f) {
            Some(component) => Err(Rejection::NonFinite { component }),
            None => Ok(()),
        }
    }

    /// Attempts a step; every reason for not accepting it is an error.
    fn attempt(
        &mut self,
        system: &mut dyn System,
        interval: StepInterval,
        repeated: bool,
    ) -> Result<Success, Rejection> {
        self.prepare(system, interval.h)?;
        self.predict(interval.h);
        let iterations = self.solve(system, interval)?;
        let strict = repeated || self.history.last.is_none();
        let error = self.test(system, interval.h, iterations, strict)?;
        self.evaluate_next(system)?;
        Ok(Success { error, iterations })
    }

    /// Attempts a step within the last one, which needs no error test.
    fn attempt_inside(
        &mut self,
        system: &mut dyn System,
        interval: StepInterval,
    ) -> Result<(), Rejection> {
        self.prepare(system, interval.h)?;
        self.stages.start_inside(&self.polynomial, &self.now, interval.h);
        self.solve(system, interval)?;
        self.evaluate_next(system)
    }

    /// Moves to the accepted candidate and plans the next step.
    fn complete(&mut self, interval: StepInterval, success: &Success, repeated: bool) {
        self.stats.steps += 1;
        self.t_previous = self.now.t;
        std::mem::swap(&mut self.now, &mut self.next);
        let continued = self.history.last.is_some() && !self.history.kink;
        self.polynomial.set(interval.h, interval.end, &self.now.y, &self.stages.z, continued);
        error_weights(&self.options, &self.now.y, &mut self.weights);
        let wanted = self.plan(interval.h, success, repeated);
        self.history.last = Some((interval.h, success.error.max(1e-2)));
        self.history.continued = true;
        self.history.kink = false;

        let fast = self.stages.rate <= FAST;
        self.jacobian = if fast { JacobianAge::Old } else { JacobianAge::Outdated };
        let growth = wanted / interval.h;
        let keep = fast && (1.0..=WORTHWHILE).contains(&growth);
        self.history.h = if keep { interval.h } else { wanted };
    }

    /// The next step by Gustafsson's predictive control, eq. (8.24) and (8.25).
    fn plan(&self, h: f64, success: &Success, repeated: bool) -> f64 {
        let error = success.error;
        let mut divisor =
            (fourth_root(error) / safety(success.iterations)).clamp(1.0 / GROWTH, 1.0 / SHRINK);
        if let Some((h_last, error_last)) = self.history.last {
            let predicted = (h_last / h) * fourth_root(error * error / error_last) / SAFETY;
            divisor = divisor.max(predicted.clamp(1.0 / GROWTH, 1.0 / SHRINK));
        }
        let mut wanted = h / divisor;
        if repeated {
            wanted = wanted.min(h);
        } else if divisor <= 1.0 / GROWTH {
            // The growth limit does not apply to a step that was only cut by a stop.
            wanted = wanted.max(self.history.h);
        }
        let between = self.polynomial.error_between_nodes(&self.weights);
        if between > BETWEEN_NODES {
            wanted = wanted.min(h * fourth_root(BETWEEN_NODES / between).max(SHRINK));
        }
        wanted.min(self.options.max_step)
    }

    /// Shortens the step after a failed attempt, or returns the failure that names the cause.
    fn recover(
        &mut self,
        interval: StepInterval,
        rejection: Rejection,
        cuts: u32,
    ) -> Result<(), Failure> {
        let factor = match rejection {
            Rejection::JacobianError(_) | Rejection::Eval(EvalError::Fatal(_)) => {
                return Err(self.failure(interval.h, rejection));
            }
            Rejection::Error { size, iterations, .. } => {
                self.stats.rejected += 1;
                let limit = if self.history.last.is_none() { SHRINK_FIRST } else { SHRINK };
                (safety(iterations) / fourth_root(size)).clamp(limit, 1.0)
            }
            Rejection::Newton { reduction, .. } => {
                self.stats.convergence_failures += 1;
                match self.jacobian {
                    JacobianAge::Old => 1.0,
                    // The step crosses a kink; the convergence rate does not tell how far away it
                    // is.
                    _ if cuts > 1 => reduction * reduction,
                    _ => reduction,
                }
            }
            Rejection::Singular { .. } => {
                self.stats.convergence_failures += 1;
                0.5
            }
            Rejection::NonFinite { .. } | Rejection::Eval(EvalError::Recoverable(_)) => {
                self.stats.evaluation_failures += 1;
                // Do not repeat an extrapolation that left the domain.
                self.history.continued = false;
                OUT_OF_DOMAIN
            }
        };
        self.stages.reset();
        if self.jacobian == JacobianAge::Old {
            self.jacobian = JacobianAge::Outdated;
        }
        let h = interval.h * factor;
        let shortest = self.options.min_step.max(resolution(self.now.t));
        if cuts >= self.options.max_cuts || (factor < 1.0 && !(h > shortest)) {
            return Err(self.failure(h, rejection));
        }
        self.history.h = h;
        Ok(())
    }

    fn failure(&self, h: f64, rejection: Rejection) -> Failure {
        let t = self.now.t;
        match rejection {
            Rejection::Error { component, .. } => Failure::StepTooSmall { t, h, component },
            Rejection::Newton { component, .. } => Failure::NewtonFailed { t, h, component },
            Rejection::Singular { component } => Failure::Singular { t, component },
            Rejection::NonFinite { component }
            | Rejection::JacobianError(JacobianError::NonFinite { component }) => {
                Failure::NonFinite { t, component }
            }
            Rejection::Eval(error) | Rejection::JacobianError(JacobianError::Eval(error)) => {
                Failure::Eval { t, error }
            }
        }
    }
}

impl Stepper for Radau {
    fn step(&mut self, system: &mut dyn System, t_stop: f64) -> Result<Step, Failure> {
        if !(t_stop > self.now.t) {
            return Ok(Step::Reached { t: self.now.t });
        }
        let mut cuts = 0;
        loop {
            let (t, h) = (self.now.t, self.history.h);
            let worst = || self.estimate.worst(&self.weights);
            let interval = next_interval(t, h, t_stop, &self.options, &self.stats, worst)?;
            match self.attempt(system, interval, cuts > 0) {
                Ok(success) => {
                    self.complete(interval, &success, cuts > 0);
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
        // The point before waits in `next` since the step was completed, unless a later attempt to
        // step failed.
        if !(self.t_previous < t && t < self.now.t) || self.next.t != self.t_previous {
            return Ok(());
        }
        std::mem::swap(&mut self.now, &mut self.next);
        error_weights(&self.options, &self.now.y, &mut self.weights);
        let interval = StepInterval { h: t - self.now.t, end: t, last: true };
        match self.attempt_inside(system, interval) {
            Ok(()) => {
                std::mem::swap(&mut self.now, &mut self.next);
                error_weights(&self.options, &self.now.y, &mut self.weights);
                self.polynomial.set(interval.h, t, &self.now.y, &self.stages.z, false);
                self.jacobian = JacobianAge::Old;
                Ok(())
            }
            Err(rejection) => {
                self.history = History { h: interval.h, last: None, continued: false, kink: false };
                self.stages.reset();
                Err(self.failure(interval.h, rejection))
            }
        }
    }

    fn restart(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
        jacobian: JacobianMemory,
    ) -> Result<(), Failure> {
        let is_within_last_step = self.t_previous < t && t <= self.now.t;
        let before = is_within_last_step.then_some(self.history.h);
        self.now.start(system, t, y, &mut self.stats)?;
        self.t_previous = t;
        self.polynomial.set_constant(t, y);
        self.stages.reset();
        let changed = self.matrix.set_mass(system.differential());
        self.history = History { h: 0.0, last: None, continued: false, kink: false };
        self.jacobian = match (jacobian, self.jacobian) {
            (JacobianMemory::Keep, JacobianAge::Fresh | JacobianAge::Old) if !changed => {
                JacobianAge::Old
            }
            _ => JacobianAge::Outdated,
        };
        error_weights(&self.options, &self.now.y, &mut self.weights);
        let h = match self.options.initial_step {
            Some(h) => h,
            None => {
                let [trial, slope] = self.estimate.memory();
                let (now, weights) = (&self.now, &self.weights[..]);
                let guess =
                    initial_step(system, now, weights, ORDER, trial, slope, &mut self.stats);
                after_event(guess, before)
            }
        };
        self.history.h = first_step(&self.options, t, h);
        Ok(())
    }

    fn t(&self) -> f64 {
        self.now.t
    }

    fn y(&self) -> &[f64] {
        &self.now.y
    }

    fn pass_kink(&mut self) {
        self.history.kink = true;
    }

    fn t_previous(&self) -> f64 {
        self.t_previous
    }

    fn interpolate(&self, t: f64, out: &mut [f64]) {
        self.polynomial.evaluate(t, out);
    }

    fn next_step(&self) -> f64 {
        self.history.h
    }

    fn stats(&self) -> &Stats {
        &self.stats
    }
}

/// The first step after a restart for which the slope suggests `guess`; at an event within a step, `before` was wanted
/// for the next one. Most events change little, and a guess that is longer is rejected.
fn after_event(guess: f64, before: Option<f64>) -> f64 {
    before.map_or(guess, |before| guess.min(before.max(LEAST_AFTER_EVENT * guess)))
}

/// The safety factor, smaller for more iterations (Hairer & Wanner II, sec. IV.8, step size
/// selection).
fn safety(iterations: u32) -> f64 {
    let (most, used) = (f64::from(MAX_ITERATIONS), f64::from(iterations));
    SAFETY * (2.0 * most + 1.0) / (2.0 * most + used)
}

fn fourth_root(x: f64) -> f64 {
    x.sqrt().sqrt()
}
