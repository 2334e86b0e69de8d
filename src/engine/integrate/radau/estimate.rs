//! The local error of a step, from an embedded formula of order 3.

use crate::integrate::control::Point;
use crate::integrate::matrix::IterationMatrix;
use crate::integrate::radau::tableau::ERROR;
use crate::integrate::stats::Stats;
use crate::integrate::system::System;
use crate::numeric::norm::{weighted_rms, worst_component};

/// Order of the embedded formula: the estimate is of order `h^4`.
pub const ORDER: u32 = 3;

/// The estimate of Hairer & Wanner II, sec. IV.8, eq. (8.19) and (8.20).
pub struct ErrorEstimate {
    /// `M (e1 Z1 + e2 Z2 + e3 Z3) / h`: contribution of the stages.
    stages: Vec<f64>,
    /// The filtered error.
    error: Vec<f64>,
    /// Point and right side of the second estimate.
    trial: Vec<f64>,
    slope: Vec<f64>,
}

impl ErrorEstimate {
    /// For `n` components.
    pub fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        ErrorEstimate { stages: zeros(), error: zeros(), trial: zeros(), slope: zeros() }
    }

    /// The weighted size of `(g/h M - J)^-1 (f0 + stages)`. The matrix filters the stiff
    /// components, for which the bare difference of two formulas would be far too large.
    pub fn first(
        &mut self,
        from: &Point,
        h: f64,
        z: &[Vec<f64>; 3],
        matrix: &mut IterationMatrix,
        weights: &[f64],
    ) -> f64 {
        let e = ERROR.map(|e| e / h);
        for (i, mass) in matrix.mass().iter().enumerate() {
            let stages = mass * (e[0] * z[0][i] + e[1] * z[1][i] + e[2] * z[2][i]);
            self.stages[i] = stages;
            self.error[i] = from.f[i] + stages;
        }
        matrix.solve_real(&mut self.error);
        weighted_rms(&self.error, weights)
    }

    /// Filters once more, with the slope at the start moved by the first estimate: for the first
    /// step and after a rejection, where the first estimate of stiff components does not vanish.
    /// Keeps the first estimate `size` if the slope there cannot be evaluated.
    pub fn again(
        &mut self,
        system: &mut dyn System,
        from: &Point,
        matrix: &mut IterationMatrix,
        weights: &[f64],
        size: f64,
        stats: &mut Stats,
    ) -> f64 {
        for ((trial, y), error) in self.trial.iter_mut().zip(&from.y).zip(&self.error) {
            *trial = y + error;
        }
        stats.rhs += 1;
        if system.rhs(from.t, &self.trial, &mut self.slope).is_err() {
            return size;
        }
        for ((error, slope), stages) in self.error.iter_mut().zip(&self.slope).zip(&self.stages) {
            *error = slope + stages;
        }
        matrix.solve_real(&mut self.error);
        weighted_rms(&self.error, weights)
    }

    /// The component with the largest estimate; zero for an empty system.
    pub fn worst(&self, weights: &[f64]) -> usize {
        worst_component(&self.error, weights).unwrap_or(0)
    }

    /// Two work vectors that are free between steps.
    pub fn memory(&mut self) -> [&mut [f64]; 2] {
        [&mut self.trial, &mut self.slope]
    }
}
