//! Step size control shared by all methods: start points, first steps, fitting to stops.

use crate::integrate::options::Options;
use crate::integrate::outcome::{Failure, Step};
use crate::integrate::stats::Stats;
use crate::integrate::system::System;
use crate::numeric::norm::{first_non_finite, weighted_square_sum};

/// An accepted point of the trajectory.
#[derive(Clone, Debug)]
pub struct Point {
    /// Time.
    pub t: f64,
    /// Solution.
    pub y: Vec<f64>,
    /// Right side at `(t, y)`.
    pub f: Vec<f64>,
}

impl Point {
    /// A point of `n` zeros at time zero.
    pub fn new(n: usize) -> Self {
        Point { t: 0.0, y: vec![0.0; n], f: vec![0.0; n] }
    }

    /// Moves to a start point, after checking it, and evaluates the right side there.
    pub fn start(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
        stats: &mut Stats,
    ) -> Result<(), Failure> {
        let n = self.y.len();
        if y.len() != n || system.dim() != n || !t.is_finite() {
            return Err(Failure::Start { component: y.len().min(n) });
        }
        if let Some(component) = first_non_finite(y) {
            return Err(Failure::Start { component });
        }
        stats.restarts += 1;
        stats.rhs += 1;
        self.t = t;
        self.y.copy_from_slice(y);
        system.rhs(t, &self.y, &mut self.f).map_err(|error| Failure::Eval { t, error })?;
        match first_non_finite(&self.f) {
            Some(component) => Err(Failure::NonFinite { t, component }),
            None => Ok(()),
        }
    }
}

/// Writes the weights `1 / (atol_i + rtol |y_i|)` of the error norm at `y`.
pub fn error_weights(options: &Options, y: &[f64], weights: &mut [f64]) {
    for ((w, a), y) in weights.iter_mut().zip(&options.atol).zip(y) {
        *w = 1.0 / (a + options.rtol * y.abs());
    }
}

/// The minimum step that advances `t`: a few spacings of doubles.
pub fn resolution(t: f64) -> f64 {
    16.0 * f64::EPSILON * t.abs()
}

/// A step of at most the wanted length that does not pass `t_stop`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StepInterval {
    /// Length of the step.
    pub h: f64,
    /// Its end; has the bits of `t_stop` if the step reaches it.
    pub end: f64,
    /// True if `end` is the stop.
    pub last: bool,
}

/// Fits a step into the remaining interval: slightly longer if it would just miss the stop, half of
/// the interval if it would leave a tiny remainder.
pub fn fit_to_stop(t: f64, wanted: f64, t_stop: f64) -> StepInterval {
    let rest = t_stop - t;
    if wanted * STRETCH >= rest {
        StepInterval { h: rest, end: t_stop, last: true }
    } else if wanted * 2.0 > rest {
        let h = 0.5 * rest;
        StepInterval { h, end: t + h, last: false }
    } else {
        StepInterval { h: wanted, end: t + wanted, last: false }
    }
}

impl StepInterval {
    /// The outcome of a step over this interval.
    pub fn outcome(self) -> Step {
        let t = self.end;
        if self.last { Step::Reached { t } } else { Step::Advanced { t } }
    }
}

/// The interval of the next attempt from `t` with the wanted length `h`. Fails if the limit of
/// steps is exhausted, or if the step is too small to advance `t`; then `worst` gives the component
/// to blame.
pub fn next_interval(
    t: f64,
    h: f64,
    t_stop: f64,
    options: &Options,
    stats: &Stats,
    worst: impl FnOnce() -> usize,
) -> Result<StepInterval, Failure> {
    let limit = options.max_steps;
    if stats.steps + stats.rejected >= limit {
        return Err(Failure::TooManySteps { t, steps: limit });
    }
    let interval = fit_to_stop(t, h, t_stop);
    if !(interval.end > t) {
        return Err(Failure::StepTooSmall { t, h: interval.h, component: worst() });
    }
    Ok(interval)
}

/// The first step after a restart at `t`, within the limits of the options.
pub fn first_step(options: &Options, t: f64, h: f64) -> f64 {
    h.max(options.min_step).max(resolution(t)).min(options.max_step)
}

/// Maximum stretching of a step to reach the stop; RADAU5 has the same value.
const STRETCH: f64 = 1.0001;

/// The starting step size of Hairer, Nørsett & Wanner I, sec. II.4, p. 169, for a method whose
/// error estimate has order `order`; needs one evaluation of the right side.
///
/// Algebraic rows have no slope and are ignored. If the trial point cannot be evaluated, returns
/// the reduced first guess of the algorithm.
pub fn initial_step(
    system: &mut dyn System,
    point: &Point,
    weights: &[f64],
    order: u32,
    trial: &mut [f64],
    slope: &mut [f64],
    stats: &mut Stats,
) -> f64 {
    let n = point.y.len().max(1) as f64;
    for ((s, f), d) in slope.iter_mut().zip(&point.f).zip(system.differential()) {
        *s = if *d { *f } else { 0.0 };
    }
    let d0 = (weighted_square_sum(&point.y, weights) / n).sqrt();
    let d1 = (weighted_square_sum(slope, weights) / n).sqrt();
    let h0 = if d0 < 1e-5 || d1 < 1e-5 { 1e-6 } else { 0.01 * d0 / d1 };
    for ((trial, y), s) in trial.iter_mut().zip(&point.y).zip(slope.iter()) {
        *trial = y + h0 * s;
    }
    stats.rhs += 1;
    if system.rhs(point.t + h0, trial, slope).is_err() {
        return 0.01 * h0;
    }
    for ((s, f), d) in slope.iter_mut().zip(&point.f).zip(system.differential()) {
        *s = if *d { *s - f } else { 0.0 };
    }
    let d2 = (weighted_square_sum(slope, weights) / n).sqrt() / h0;
    if !d2.is_finite() {
        return 0.01 * h0;
    }
    let steepest = d1.max(d2);
    let h1 = if steepest <= 1e-15 {
        (h0 * 1e-3).max(1e-6)
    } else {
        (0.01 / steepest).powf(1.0 / (f64::from(order) + 1.0))
    };
    h1.min(100.0 * h0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stop_is_hit_with_its_own_bits() {
        let (t, stop) = (0.1, 0.7);
        let interval = fit_to_stop(t, 1.0, stop);
        assert_eq!((interval.end, interval.last), (stop, true));
        // Just missing the stop: stretched.
        assert!(fit_to_stop(t, 0.59999, stop).last);
        // A tiny remainder would be left: two equal steps.
        let half = fit_to_stop(t, 0.5, stop);
        assert!((half.h - 0.3).abs() < 1e-15 && !half.last);
        assert_eq!(fit_to_stop(t, 0.2, stop).h, 0.2);
    }
}
