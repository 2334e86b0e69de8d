//! The stage equations of one step and their simplified Newton iteration.
//!
//! Hairer & Wanner II, sec. IV.8: with stage increments `Z` and `W = T^-1 Z`, each iteration solves
//! one real system for `dW_1` and one complex system for `dW_2 + i dW_3`, with matrices that stay
//! the same over many iterations and steps.

use crate::integrate::control::{Point, StepInterval};
use crate::integrate::matrix::{IterationMatrix, Shift};
use crate::integrate::options::Options;
use crate::integrate::radau::polynomial::Polynomial;
use crate::integrate::radau::tableau::{ALPHA, BETA, C1, C2, GAMMA, T, T_INVERSE};
use crate::integrate::stats::Stats;
use crate::integrate::system::{EvalError, System};
use crate::numeric::norm::{first_non_finite, weighted_square_sum, worst_component};

/// Iterations within which the stage equations must converge; RADAU5's NIT.
pub const MAX_ITERATIONS: u32 = 7;

/// Why the stage equations could not be solved.
#[derive(Clone, Copy, Debug)]
pub enum StageError {
    /// The right side could not be evaluated at a stage.
    Eval(EvalError),
    /// A correction is not finite.
    NonFinite {
        /// Its component.
        component: usize,
    },
    /// The iteration diverges or converges too slowly; `reduction` suggests a shorter step.
    Slow {
        /// Component with the largest correction.
        component: usize,
        /// Factor for the step, in (0, 1).
        reduction: f64,
    },
}

/// Stage increments and the memory of the iteration's convergence.
pub struct Stages {
    /// Increments `Z` from the start of the step to its stages; the third leads to the end.
    pub z: [Vec<f64>; 3],
    /// The transformed increments `W`.
    w: [Vec<f64>; 3],
    /// Right sides at the stages, then corrections.
    r: [Vec<f64>; 3],
    stage: Vec<f64>,
    /// Tolerance of the iteration, in units of the error tolerance.
    kappa: f64,
    /// `theta / (1 - theta)` of the last iteration: remaining error per correction.
    eta: f64,
    /// Convergence rate `theta` of the last iteration.
    pub rate: f64,
}

impl Stages {
    /// For `n` components. The iteration stops well below the error tolerance, at `kappa` of eq.
    /// (8.10): RADAU5's choice, the root of the tolerance, where that is sharp; but not below a
    /// hundredth at a tolerance of 1e-6, which the text (p. 121) finds the most efficient.
    pub fn new(n: usize, options: &Options) -> Self {
        let zeros = || std::array::from_fn(|_| vec![0.0; n]);
        Stages {
            z: zeros(),
            w: zeros(),
            r: zeros(),
            stage: vec![0.0; n],
            kappa: (10.0 * f64::EPSILON / options.rtol)
                .max(options.rtol.sqrt().min(0.03))
                .max((1e4 * options.rtol).min(0.01)),
            eta: 1.0,
            rate: 0.0,
        }
    }

    /// Resets the convergence estimate.
    pub fn reset(&mut self) {
        self.eta = 1.0;
        self.rate = 0.0;
    }

    /// Starts from zero increments.
    pub fn start_from_zero(&mut self) {
        for v in self.z.iter_mut().chain(&mut self.w) {
            v.fill(0.0);
        }
    }

    /// Starts from the continuation of the last step.
    pub fn start_from(&mut self, polynomial: &Polynomial, h: f64) {
        polynomial.extrapolate(h, &mut self.z);
        self.transform();
    }

    /// Starts from the polynomial of the step that began at `from` and is to be shortened to `h`.
    pub fn start_inside(&mut self, polynomial: &Polynomial, from: &Point, h: f64) {
        for (z, c) in self.z.iter_mut().zip([C1, C2, 1.0]) {
            polynomial.evaluate(from.t + c * h, z);
            for (z, y) in z.iter_mut().zip(&from.y) {
                *z -= y;
            }
        }
        self.transform();
    }

    /// `W = T^-1 Z`.
    fn transform(&mut self) {
        transform(&self.z, &mut self.w);
    }

    /// Iterates to the solution of the stage equations; returns the number of iterations.
    pub fn solve(
        &mut self,
        system: &mut dyn System,
        from: &Point,
        interval: StepInterval,
        weights: &[f64],
        matrix: &mut IterationMatrix,
        stats: &mut Stats,
    ) -> Result<u32, StageError> {
        let shift = shift(interval.h);
        // The convergence estimate carries over from the last step (eq. 8.11).
        self.eta = self.eta.max(f64::EPSILON).powf(0.8);
        self.rate = 0.0;
        let mut last_size = 0.0;
        let mut last_ratio = 0.0;
        for iteration in 1..=MAX_ITERATIONS {
            stats.newton_iterations += 1;
            self.evaluate(system, from, interval, stats).map_err(StageError::Eval)?;
            correct(&mut self.r, &self.w, matrix, shift);
            let size = self.correction_size(weights);
            if !size.is_finite() {
                return Err(self.blame(system, from, interval, weights, stats));
            }
            if iteration > 1 {
                let ratio: f64 = size / last_size;
                self.rate = if iteration == 2 { ratio } else { (ratio * last_ratio).sqrt() };
                last_ratio = ratio;
                self.check_convergence(iteration, size, weights)?;
            }
            last_size = size.max(f64::EPSILON);
            advance(&self.r, &mut self.w, &mut self.z);
            if self.eta * size <= self.kappa {
                return Ok(iteration);
            }
        }
        Err(StageError::Slow { component: self.worst(weights), reduction: 0.5 })
    }

    /// Right sides at the three stages, into `r`.
    fn evaluate(
        &mut self,
        system: &mut dyn System,
        from: &Point,
        interval: StepInterval,
        stats: &mut Stats,
    ) -> Result<(), EvalError> {
        let times = [from.t + C1 * interval.h, from.t + C2 * interval.h, interval.end];
        for ((z, r), t) in self.z.iter().zip(&mut self.r).zip(times) {
            for ((stage, y), z) in self.stage.iter_mut().zip(&from.y).zip(z) {
                *stage = y + z;
            }
            stats.rhs += 1;
            system.rhs(t, &self.stage, r)?;
        }
        Ok(())
    }

    fn correction_size(&self, weights: &[f64]) -> f64 {
        let sum: f64 = self.r.iter().map(|r| weighted_square_sum(r, weights)).sum();
        (sum / (3 * weights.len()).max(1) as f64).sqrt()
    }

    /// Stops as soon as the remaining iterations cannot reach the tolerance (eq. 8.12).
    fn check_convergence(
        &mut self,
        iteration: u32,
        size: f64,
        weights: &[f64],
    ) -> Result<(), StageError> {
        if !(self.rate < 0.99) {
            let component = self.worst(weights);
            return Err(StageError::Slow { component, reduction: 0.5 });
        }
        self.eta = self.rate / (1.0 - self.rate);
        if iteration < MAX_ITERATIONS {
            let left = (MAX_ITERATIONS - 1 - iteration) as i32;
            let missing = self.eta * size * self.rate.powi(left) / self.kappa;
            if missing >= 1.0 {
                let missing = missing.clamp(1e-4, 20.0);
                let reduction = 0.8 * missing.powf(-1.0 / f64::from(4 + left));
                return Err(StageError::Slow { component: self.worst(weights), reduction });
            }
        }
        Ok(())
    }

    /// Finds the right side that is not finite, which the solution of the linear systems has spread
    /// over all components, by evaluating again.
    fn blame(
        &mut self,
        system: &mut dyn System,
        from: &Point,
        interval: StepInterval,
        weights: &[f64],
        stats: &mut Stats,
    ) -> StageError {
        let spread = self.worst(weights);
        match self.evaluate(system, from, interval, stats) {
            Err(error) => StageError::Eval(error),
            Ok(()) => {
                let component = self.r.iter().find_map(|r| first_non_finite(r)).unwrap_or(spread);
                StageError::NonFinite { component }
            }
        }
    }

    /// The component with the largest correction; zero for an empty system.
    fn worst(&self, weights: &[f64]) -> usize {
        let sizes = self.r.iter().filter_map(|r| {
            let i = worst_component(r, weights)?;
            Some((i, (r[i] * weights[i]).abs()))
        });
        let mut worst = (0, -1.0);
        for (i, size) in sizes {
            if !size.is_finite() {
                return i;
            }
            if size > worst.1 {
                worst = (i, size);
            }
        }
        worst.0
    }
}

/// The multiples of `M` in the iteration matrices for a step `h`.
pub fn shift(h: f64) -> Shift {
    Shift { real: GAMMA / h, re: ALPHA / h, im: BETA / h }
}

/// `W = T^-1 Z`.
pub fn transform(z: &[Vec<f64>; 3], w: &mut [Vec<f64>; 3]) {
    let [z1, z2, z3] = z;
    for (w, t) in w.iter_mut().zip(&T_INVERSE) {
        for (((w, a), b), c) in w.iter_mut().zip(z1).zip(z2).zip(z3) {
            *w = t[0] * a + t[1] * b + t[2] * c;
        }
    }
}

/// Turns the right sides `r` at the stages into the corrections `dW`.
pub fn correct(
    r: &mut [Vec<f64>; 3],
    w: &[Vec<f64>; 3],
    matrix: &mut IterationMatrix,
    shift: Shift,
) {
    let [r1, r2, r3] = r;
    let [w1, w2, w3] = w;
    let rows = r1.iter_mut().zip(r2.iter_mut()).zip(r3.iter_mut());
    let increments = w1.iter().zip(w2).zip(w3);
    for ((((a, b), c), ((x, y), z)), mass) in rows.zip(increments).zip(matrix.mass()) {
        let w = [mass * x, mass * y, mass * z];
        [*a, *b, *c] = transformed_residual([*a, *b, *c], w, shift);
    }
    matrix.solve(r1, r2, r3);
}

/// `T^-1 f - L w` for the right sides `f` of one component at the stages and its increments `w`, times the mass.
#[inline]
pub fn transformed_residual(f: [f64; 3], w: [f64; 3], shift: Shift) -> [f64; 3] {
    let [f1, f2, f3] = f;
    let t = &T_INVERSE;
    [
        t[0][0] * f1 + t[0][1] * f2 + t[0][2] * f3 - shift.real * w[0],
        t[1][0] * f1 + t[1][1] * f2 + t[1][2] * f3 - (shift.re * w[1] - shift.im * w[2]),
        t[2][0] * f1 + t[2][1] * f2 + t[2][2] * f3 - (shift.im * w[1] + shift.re * w[2]),
    ]
}

/// Applies the corrections: `W += dW`, `Z = T W`.
pub fn advance(corrections: &[Vec<f64>; 3], w: &mut [Vec<f64>; 3], z: &mut [Vec<f64>; 3]) {
    for (w, r) in w.iter_mut().zip(corrections) {
        for (w, r) in w.iter_mut().zip(r) {
            *w += r;
        }
    }
    let [w1, w2, w3] = w;
    let [z1, z2, z3] = z;
    let increments = z1.iter_mut().zip(z2.iter_mut()).zip(z3.iter_mut());
    for (((x, y), z), ((a, b), c)) in increments.zip(w1.iter().zip(w2.iter()).zip(w3.iter())) {
        *x = T[0][0] * a + T[0][1] * b + T[0][2] * c;
        *y = T[1][0] * a + T[1][1] * b + T[1][2] * c;
        *z = T[2][0] * a + b;
    }
}
