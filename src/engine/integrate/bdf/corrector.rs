//! The equations of one step and their modified Newton iteration.
//!
//! With the predicted array and a correction `e` the equations are `M (z_1 + l_1 e) / h = f(t, y +
//! e)`. Each iteration solves with `l_1/h M - J`, where `J` and the shift may be those of an
//! earlier step; then corrections are scaled by `2 / (1 + shift_old / shift)` (Hindmarsh et al.
//! 2005, sec. 2.1).

use crate::integrate::bdf::nordsieck::Nordsieck;
use crate::integrate::matrix::IterationMatrix;
use crate::integrate::stats::Stats;
use crate::integrate::system::{EvalError, System};
use crate::numeric::norm::{first_non_finite, weighted_rms, worst_component};

/// Iterations within which a step must converge.
const MAX_ITERATIONS: u32 = 4;
/// Tolerated iteration error, as a fraction of the tolerated local error.
const PART: f64 = 0.1;
/// Decay factor of the estimated convergence rate per iteration.
const FORGET: f64 = 0.3;
/// Growth of the correction that counts as divergence.
const DIVERGED: f64 = 2.0;

/// Why the equations of a step could not be solved.
#[derive(Clone, Copy, Debug)]
pub enum CorrectorError {
    /// The right side could not be evaluated.
    Eval(EvalError),
    /// A right side or a correction is not finite.
    NonFinite {
        /// Its component.
        component: usize,
    },
    /// The iteration diverges or converges too slowly.
    Slow {
        /// Component with the largest correction.
        component: usize,
    },
}

/// The equations of a step.
#[derive(Clone, Copy)]
pub struct Equations<'a> {
    /// End of the step.
    pub t: f64,
    /// The array, predicted.
    pub predicted: &'a Nordsieck,
    /// `l_1`.
    pub leading: f64,
    /// Local error per correction.
    pub error: f64,
    /// Shift of the decomposed matrix in units of that of this step.
    pub staleness: f64,
    /// One over the tolerated errors.
    pub weights: &'a [f64],
}

/// The corrections and the memory of the iteration's convergence.
pub struct Corrector {
    /// The sum of the corrections.
    pub e: Vec<f64>,
    /// The right side, then the last correction.
    pub r: Vec<f64>,
    /// Estimated convergence rate; 1 after a new decomposition.
    rate: f64,
}

impl Corrector {
    /// For `n` components.
    pub fn new(n: usize) -> Self {
        Corrector { e: vec![0.0; n], r: vec![0.0; n], rate: 1.0 }
    }

    /// Resets the convergence estimate after a new decomposition.
    pub fn reset(&mut self) {
        self.rate = 1.0;
    }

    /// Iterates from the predicted `y` to the solution; the corrections stay in `e`.
    pub fn solve(
        &mut self,
        system: &mut dyn System,
        equations: Equations<'_>,
        y: &mut [f64],
        matrix: &mut IterationMatrix,
        stats: &mut Stats,
    ) -> Result<(), CorrectorError> {
        let Equations { t, predicted, weights, .. } = equations;
        let per_step = 1.0 / predicted.h;
        let damping = 2.0 / (1.0 + 1.0 / equations.staleness);
        self.e.fill(0.0);
        let mut last_size = 0.0;
        for iteration in 0..MAX_ITERATIONS {
            stats.newton_iterations += 1;
            stats.rhs += 1;
            system.rhs(t, y, &mut self.r).map_err(CorrectorError::Eval)?;
            let slopes = predicted.slopes().zip(&self.e);
            for ((r, mass), (slope, e)) in self.r.iter_mut().zip(matrix.mass()).zip(slopes) {
                *r -= mass * ((slope + equations.leading * e) * per_step);
            }
            matrix.solve_real(&mut self.r);
            if damping != 1.0 {
                self.r.iter_mut().for_each(|r| *r *= damping);
            }
            let size = weighted_rms(&self.r, weights);
            if !size.is_finite() {
                return Err(self.blame(system, t, y, weights, stats));
            }
            for ((y, e), r) in y.iter_mut().zip(&mut self.e).zip(&self.r) {
                *e += r;
                *y += r;
            }
            if iteration > 0 {
                self.rate = (FORGET * self.rate).max(size / last_size);
            }
            if size * self.rate.min(1.0) * equations.error <= PART {
                return Ok(());
            }
            if iteration > 1 && size > DIVERGED * last_size {
                break;
            }
            last_size = size;
        }
        Err(CorrectorError::Slow { component: worst_component(&self.r, weights).unwrap_or(0) })
    }

    /// Finds the right side that is not finite, which the solution of the linear system has spread
    /// over all components, by evaluating again.
    fn blame(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
        weights: &[f64],
        stats: &mut Stats,
    ) -> CorrectorError {
        let spread = worst_component(&self.r, weights).unwrap_or(0);
        stats.rhs += 1;
        match system.rhs(t, y, &mut self.r) {
            Err(error) => CorrectorError::Eval(error),
            Ok(()) => {
                CorrectorError::NonFinite { component: first_non_finite(&self.r).unwrap_or(spread) }
            }
        }
    }
}
