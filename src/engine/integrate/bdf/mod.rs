//! Backward differentiation formulas of order 1 to 5 with variable steps: for large stiff systems
//! and differential-algebraic systems of index 1 whose solution is smooth for long.
//!
//! The fixed-leading-coefficient form on Nordsieck's array, with the heuristics of VODE and CVODE:
//! P. N. Brown, G. D. Byrne, A. C. Hindmarsh, *VODE: a variable-coefficient ODE solver*, SIAM J.
//! Sci. Stat. Comput. 10 (1989), 1038-1051; A. C. Hindmarsh et al., *SUNDIALS*, ACM Trans. Math.
//! Softw. 31 (2005), 363-396; for algebraic rows K. E. Brenan, S. L. Campbell, L. R. Petzold,
//! *Numerical Solution of Initial-Value Problems in Differential-Algebraic Equations* (1996), ch.
//! 5.
//!
//! A step costs one or two right sides and solves, against three or more of each in Radau, but the
//! order is lower, and every restart begins with order 1.
pub mod coefficients;
pub mod corrector;
pub mod nordsieck;
pub mod order;

#[cfg(test)]
mod tests;

use crate::integrate::bdf::coefficients::{Coefficients, Formula};
use crate::integrate::bdf::corrector::{Corrector, Equations};
use crate::integrate::bdf::nordsieck::Nordsieck;
use crate::integrate::bdf::order::{Change, OrderControl, growth};
use crate::integrate::control::{
    Point, StepInterval, error_weights, first_step, initial_step, next_interval, resolution,
};
use crate::integrate::matrix::{IterationMatrix, Planes, Shift};
use crate::integrate::options::{OptionError, Options};
use crate::integrate::outcome::{Failure, Step};
use crate::integrate::stats::Stats;
use crate::integrate::stepper::{JacobianMemory, Stepper};
use crate::integrate::system::{EvalError, System};
use crate::numeric::norm::{weighted_rms, worst_component};

/// Maximum reduction after a failed error test.
const SHRINK: f64 = 0.1;
/// Minimum reduction from the second failure on.
const SHRINK_AGAIN: f64 = 0.2;
/// Number of failed error tests of one step before the order is lowered.
const MAX_ERROR_FAILURES: u32 = 3;
/// Reduction if the corrections do not converge or the system cannot be evaluated.
const NOT_SOLVED: f64 = 0.25;
/// Tolerated relative deviation of the shift of the matrix.
const STALE: f64 = 0.3;
/// Maximum number of steps with one decomposition.
const MAX_AGE: u64 = 20;
/// Maximum number of steps with one Jacobian.
const MAX_JACOBIAN_AGE: u64 = 50;
/// Relative deviation of the shift above which a failed iteration is attributed to it.
const SHIFT_TO_BLAME: f64 = 0.2;

/// The stepper.
pub struct Bdf {
    options: Options,
    now: Point,
    t_previous: f64,
    next_y: Vec<f64>,
    weights: Vec<f64>,
    /// The polynomial at the accepted point.
    array: Nordsieck,
    /// During an attempt the polynomial of the next point, afterwards that before the step.
    other: Nordsieck,
    /// The polynomial of a step that was undone, and its end.
    undone: Nordsieck,
    undone_end: Option<f64>,
    /// `other` is the array before the last step.
    whole: bool,
    formula: Formula,
    corrector: Corrector,
    matrix: IterationMatrix,
    jacobian: Jacobian,
    decomposed: Option<Decomposed>,
    /// Wanted length of the next step.
    h: f64,
    order: OrderControl,
    stats: Stats,
}

/// Age of the Jacobian.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Jacobian {
    /// To be evaluated before use.
    Outdated,
    /// Evaluated for this step.
    From { step: u64 },
    /// Evaluated for the current step.
    Fresh,
}

/// The shift and the step of the last decomposition.
#[derive(Clone, Copy)]
struct Decomposed {
    shift: f64,
    step: u64,
}

/// Why an attempt to step failed.
#[derive(Clone, Copy)]
enum Rejection {
    Error { component: usize, size: f64 },
    Newton { component: usize },
    Singular { component: usize },
    NonFinite { component: usize },
    Eval(EvalError),
}

impl From<corrector::CorrectorError> for Rejection {
    fn from(rejection: corrector::CorrectorError) -> Self {
        match rejection {
            corrector::CorrectorError::Eval(error) => Rejection::Eval(error),
            corrector::CorrectorError::NonFinite { component } => {
                Rejection::NonFinite { component }
            }
            corrector::CorrectorError::Slow { component } => Rejection::Newton { component },
        }
    }
}

impl Bdf {
    /// A stepper for systems of `n` components, with dense matrices. All memory is allocated here.
    pub fn new(n: usize, options: Options) -> Result<Self, OptionError> {
        Bdf::with_matrix(n, IterationMatrix::dense(n, Planes::Real), options)
    }

    /// A stepper for this system, with the matrices of [`IterationMatrix::for_system`].
    pub fn for_system(system: &dyn System, options: Options) -> Result<Self, OptionError> {
        let matrix = IterationMatrix::for_system(system, Planes::Real);
        Bdf::with_matrix(system.dim(), matrix, options)
    }

    fn with_matrix(
        n: usize,
        matrix: IterationMatrix,
        options: Options,
    ) -> Result<Self, OptionError> {
        options.validate(n)?;
        Ok(Bdf {
            now: Point::new(n),
            t_previous: 0.0,
            next_y: vec![0.0; n],
            weights: vec![1.0; n],
            array: Nordsieck::new(n),
            other: Nordsieck::new(n),
            undone: Nordsieck::new(n),
            undone_end: None,
            whole: false,
            formula: Formula::default(),
            corrector: Corrector::new(n),
            matrix,
            jacobian: Jacobian::Outdated,
            decomposed: None,
            h: 0.0,
            order: OrderControl::new(n),
            stats: Stats::default(),
            options,
        })
    }

    /// Order of the formula of the next step, 1 to 5.
    pub fn order(&self) -> usize {
        self.array.order
    }

    /// Attempts a step; every reason for not accepting it is an error. Returns the formula and the
    /// weighted local error; the predicted array is in `other`.
    fn attempt(
        &mut self,
        system: &mut dyn System,
        interval: StepInterval,
    ) -> Result<(Coefficients, f64), Rejection> {
        self.whole = false;
        let formula = self.formula.of(self.array.order, interval.h, &self.array.steps);
        self.other.predict(&self.array, interval.h, &mut self.next_y);
        let shift = formula.l[1] / interval.h;
        let staleness = self.prepare(system, interval.end, shift)?;
        let equations = Equations {
            t: interval.end,
            predicted: &self.other,
            leading: formula.l[1],
            error: formula.error,
            staleness,
            weights: &self.weights,
        };
        let (matrix, y) = (&mut self.matrix, &mut self.next_y);
        self.corrector.solve(system, equations, y, matrix, &mut self.stats)?;
        let error = formula.error * self.size_of_correction(system.differential());
        Ok((formula, error))
    }

    /// The weighted norm of the correction. In the first step the prediction of algebraic
    /// components is just their start value, which says nothing about the error.
    fn size_of_correction(&mut self, differential: &[bool]) -> f64 {
        let e = &self.corrector.e;
        if !self.order.is_first() {
            return weighted_rms(e, &self.weights);
        }
        let r = &mut self.corrector.r;
        for ((r, e), d) in r.iter_mut().zip(e).zip(differential) {
            *r = if *d { *e } else { 0.0 };
        }
        weighted_rms(r, &self.weights)
    }

    /// Evaluates the Jacobian and decomposes the matrix unless they are still valid; returns the
    /// shift of the decomposed matrix in units of the wanted one.
    fn prepare(&mut self, system: &mut dyn System, t: f64, shift: f64) -> Result<f64, Rejection> {
        let step = self.stats.steps;
        let outdated = match self.jacobian {
            Jacobian::Outdated => true,
            Jacobian::From { step: from } => step >= from + MAX_JACOBIAN_AGE,
            Jacobian::Fresh => false,
        };
        if outdated {
            self.stats.jacobians += 1;
            self.jacobian = Jacobian::Outdated;
            self.decomposed = None;
            self.matrix.evaluate(system, t, &self.next_y).map_err(Rejection::Eval)?;
            self.matrix.analyze().map_err(|component| Rejection::NonFinite { component })?;
            self.jacobian = Jacobian::Fresh;
        }
        if let Some(last) = self.decomposed {
            let staleness = last.shift / shift;
            if (1.0 / staleness - 1.0).abs() <= STALE && step < last.step + MAX_AGE {
                return Ok(staleness);
            }
        }
        self.stats.decompositions += 1;
        self.decomposed = None;
        self.matrix
            .factor(Shift { real: shift, ..Shift::default() })
            .map_err(|singular| Rejection::Singular { component: singular.column })?;
        self.decomposed = Some(Decomposed { shift, step });
        self.corrector.reset();
        Ok(1.0)
    }

    /// Moves to the accepted candidate.
    fn advance_to(&mut self, formula: &Coefficients, end: f64) {
        self.other.correct(formula, &self.corrector.e, &self.next_y);
        std::mem::swap(&mut self.array, &mut self.other);
        std::mem::swap(&mut self.now.y, &mut self.next_y);
        self.t_previous = self.now.t;
        self.now.t = end;
        self.whole = true;
        self.undone_end = None;
        if self.jacobian == Jacobian::Fresh {
            self.jacobian = Jacobian::From { step: self.stats.steps };
        }
    }

    /// Accepts the step and plans the next one.
    fn complete(&mut self, formula: &Coefficients, interval: StepInterval, error: f64, cuts: u32) {
        self.advance_to(formula, interval.end);
        self.stats.steps += 1;
        let failed = cuts > 0;
        let factor =
            self.order.plan(formula, error, failed, &self.array, &self.corrector.e, &self.weights);
        self.h = (interval.h * factor).min(self.options.max_step);
        error_weights(&self.options, &self.now.y, &mut self.weights);
    }

    /// Shortens the step after a failed attempt, or returns the failure that names the cause.
    fn recover(
        &mut self,
        system: &mut dyn System,
        interval: StepInterval,
        rejection: Rejection,
        cuts: u32,
        errors: &mut u32,
    ) -> Result<(), Failure> {
        let factor = match rejection {
            Rejection::Eval(EvalError::Fatal(_)) => return Err(self.failure(interval.h, rejection)),
            Rejection::Error { size, .. } => {
                self.stats.rejected += 1;
                *errors += 1;
                self.after_error(system, size, *errors)?
            }
            Rejection::Newton { .. } => {
                self.stats.convergence_failures += 1;
                self.after_slow(interval)
            }
            Rejection::Singular { .. } => {
                self.stats.convergence_failures += 1;
                NOT_SOLVED
            }
            Rejection::NonFinite { .. } | Rejection::Eval(EvalError::Recoverable(_)) => {
                self.stats.evaluation_failures += 1;
                NOT_SOLVED
            }
        };
        let h = interval.h * factor;
        let shortest = self.options.min_step.max(resolution(self.now.t));
        if cuts >= self.options.max_cuts || (factor < 1.0 && !(h > shortest)) {
            return Err(self.failure(h, rejection));
        }
        self.h = h;
        Ok(())
    }

    /// The reduction after this number of failed error tests.
    fn after_error(
        &mut self,
        system: &mut dyn System,
        size: f64,
        errors: u32,
    ) -> Result<f64, Failure> {
        self.order.postpone_change(self.array.order);
        if errors <= MAX_ERROR_FAILURES {
            let most = if errors > 1 { SHRINK_AGAIN } else { 0.9 };
            return Ok(growth(6.0 * size, self.array.order + 1).max(SHRINK).min(most));
        }
        if self.array.order > 1 {
            self.array.lower();
            self.order.postpone_change(self.array.order);
            return Ok(SHRINK);
        }
        // The predicted slope no longer matches the solution: restart with order 1.
        let Point { t, y, f } = &mut self.now;
        self.stats.rhs += 1;
        system.rhs(*t, y, f).map_err(|error| Failure::Eval { t: *t, error })?;
        let slopes = f.iter().zip(system.differential()).map(|(f, d)| if *d { *f } else { 0.0 });
        self.array.start(self.array.h, y, slopes);
        Ok(SHRINK)
    }

    /// The reduction after the corrections did not converge: none if the matrix may be the cause.
    fn after_slow(&mut self, interval: StepInterval) -> f64 {
        let fresh = self.jacobian == Jacobian::Fresh;
        let Some(Decomposed { shift, .. }) = self.decomposed.take() else { return NOT_SOLVED };
        let formula = self.formula.of(self.array.order, interval.h, &self.array.steps);
        let wanted = formula.l[1] / interval.h;
        let stale = (wanted / shift - 1.0).abs();
        if !fresh && stale < SHIFT_TO_BLAME {
            self.jacobian = Jacobian::Outdated;
        }
        if fresh && stale == 0.0 { NOT_SOLVED } else { 1.0 }
    }

    fn failure(&self, h: f64, rejection: Rejection) -> Failure {
        let t = self.now.t;
        match rejection {
            Rejection::Error { component, .. } => Failure::StepTooSmall { t, h, component },
            Rejection::Newton { component } => Failure::NewtonFailed { t, h, component },
            Rejection::Singular { component } => Failure::Singular { t, component },
            Rejection::NonFinite { component } => Failure::NonFinite { t, component },
            Rejection::Eval(error) => Failure::Eval { t, error },
        }
    }

    fn worst(&self) -> usize {
        worst_component(&self.corrector.e, &self.weights).unwrap_or(0)
    }

    /// Attempts until a step is accepted.
    fn try_step(&mut self, system: &mut dyn System, t_stop: f64) -> Result<Step, Failure> {
        let (mut cuts, mut errors) = (0, 0);
        loop {
            let worst = || self.worst();
            let (t, h) = (self.now.t, self.h);
            let interval = next_interval(t, h, t_stop, &self.options, &self.stats, worst)?;
            let rejection = match self.attempt(system, interval) {
                Ok((formula, error)) if error <= 1.0 => {
                    self.complete(&formula, interval, error, cuts);
                    return Ok(interval.outcome());
                }
                Ok((_, size)) => Rejection::Error { component: self.worst(), size },
                Err(rejection) => rejection,
            };
            cuts += 1;
            self.recover(system, interval, rejection, cuts, &mut errors)?;
            if self.jacobian == Jacobian::Fresh {
                self.jacobian = Jacobian::From { step: self.stats.steps };
            }
        }
    }
}

impl Stepper for Bdf {
    fn step(&mut self, system: &mut dyn System, t_stop: f64) -> Result<Step, Failure> {
        if !(t_stop > self.now.t) {
            return Ok(Step::Reached { t: self.now.t });
        }
        match self.order.take_change() {
            Some(Change::Raise) => self.array.raise(&self.corrector.e),
            Some(Change::Lower) => self.array.lower(),
            None => {}
        }
        self.try_step(system, t_stop)
    }

    fn shorten(&mut self, system: &mut dyn System, t: f64) -> Result<(), Failure> {
        if !(self.t_previous < t && t < self.now.t && self.whole) {
            return Ok(());
        }
        // From here on: `array` is before the step, `undone` is its polynomial, `other` is free.
        let end = self.now.t;
        std::mem::swap(&mut self.array, &mut self.other);
        std::mem::swap(&mut self.undone, &mut self.other);
        std::mem::swap(&mut self.now.y, &mut self.next_y);
        for (y, value) in self.now.y.iter_mut().zip(self.array.values()) {
            *y = value;
        }
        self.now.t = self.t_previous;
        error_weights(&self.options, &self.now.y, &mut self.weights);
        let interval = StepInterval { h: t - self.now.t, end: t, last: true };
        let mut outcome = self.attempt(system, interval);
        if matches!(outcome, Err(Rejection::Newton { .. })) {
            self.jacobian = Jacobian::Outdated;
            outcome = self.attempt(system, interval);
        }
        self.order.postpone_change(self.array.order);
        match outcome {
            Ok((formula, _)) => {
                self.advance_to(&formula, t);
                error_weights(&self.options, &self.now.y, &mut self.weights);
                Ok(())
            }
            Err(rejection) => {
                self.array.flatten();
                self.h = interval.h;
                self.undone_end = Some(end);
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
        self.now.start(system, t, y, &mut self.stats)?;
        self.t_previous = t;
        self.whole = false;
        self.undone_end = None;
        self.order.restart();
        let changed = self.matrix.set_mass(system.differential());
        self.decomposed = None;
        self.jacobian = match (jacobian, self.jacobian) {
            (JacobianMemory::Keep, Jacobian::Fresh | Jacobian::From { .. }) if !changed => {
                Jacobian::From { step: self.stats.steps }
            }
            _ => Jacobian::Outdated,
        };
        error_weights(&self.options, &self.now.y, &mut self.weights);
        let h = match self.options.initial_step {
            Some(h) => h,
            None => {
                let Corrector { e, r, .. } = &mut self.corrector;
                initial_step(system, &self.now, &self.weights, 1, e, r, &mut self.stats)
            }
        };
        self.h = first_step(&self.options, t, h);
        let slopes = self.now.f.iter().zip(system.differential());
        let slopes = slopes.map(|(f, d)| if *d { *f } else { 0.0 });
        self.array.start(self.h, &self.now.y, slopes);
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
        match self.undone_end {
            Some(end) => self.undone.evaluate(t - end, out),
            None => self.array.evaluate(t - self.now.t, out),
        }
    }

    fn next_step(&self) -> f64 {
        self.h
    }

    fn stats(&self) -> &Stats {
        &self.stats
    }
}
