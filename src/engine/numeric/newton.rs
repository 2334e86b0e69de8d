//! Small dense nonlinear systems `g(z) = 0` by damped Newton iteration.
//!
//! P. Deuflhard, *Newton Methods for Nonlinear Problems* (2004), sec. 3.3: the natural monotonicity
//! test. Progress is measured by corrections `J^-1 g` in units of the unknowns, so the residuals
//! need no scaling of their own: the equations of a model mix pascals, newtons and square metres.
//! Where equations repeat each other, the shortest correction takes the place of the only one.

use super::linear::DenseLu;
use super::norm::{first_non_finite, weighted_rms, worst_component};
use super::pseudo_inverse::PseudoInverse;

/// Largest number of unknowns of a singular system that is solved as far as it is determined.
const MOST_DECOMPOSED: usize = 100;

/// The equations to solve. Both functions may use memory of their own.
pub trait NonlinearSystem {
    /// Writes `g(z)` to `g`; false if it cannot be evaluated at `z`, which counts like a value that
    /// is not finite.
    fn residual(&mut self, z: &[f64], g: &mut [f64]) -> bool;

    /// Writes `dg_i/dz_j (z)` to `j[i + n * j]`, where `j` arrives filled with zeros; false if it
    /// cannot be evaluated.
    fn jacobian(&mut self, z: &[f64], j: &mut [f64]) -> bool;
}

/// Tolerances and limits of the iteration.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NewtonSettings {
    /// Tolerated last correction relative to `max(|z_i|, nominal_i)`.
    pub tolerance: f64,
    /// A correction of this size is accepted too if rounding prevents a smaller one.
    pub stagnation: f64,
    /// Maximum number of Jacobian evaluations.
    pub max_iterations: u32,
    /// Smallest damping factor.
    pub min_damping: f64,
    /// Makes the shortest correction where equations repeat each other, instead of giving up. Where a matrix is
    /// singular at the start only, as at zero flow, that leads far away.
    pub may_repeat: bool,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        NewtonSettings {
            tolerance: 64.0 * f64::EPSILON,
            stagnation: 1e-9,
            max_iterations: 50,
            min_damping: 1e-6,
            may_repeat: true,
        }
    }
}

/// The region in which a solution is sought, and the size of its components.
#[derive(Clone, Copy, Debug)]
pub struct Region<'a> {
    /// Typical size of each unknown; positive.
    pub nominal: &'a [f64],
    /// Smallest and largest value of each unknown; iterates are kept between them.
    pub bounds: Option<&'a [(f64, f64)]>,
}

/// How an iteration ended. `z` holds the solution after `Converged`, otherwise its start value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum NewtonOutcome {
    /// The equations hold, to a last correction of size `accuracy`.
    Converged {
        /// Jacobians evaluated.
        iterations: u32,
        /// Weighted size of the last correction.
        accuracy: f64,
        /// An unknown that the equations leave undetermined: they repeat each other.
        undetermined: Option<usize>,
    },
    /// The Jacobian is singular; the unknown of this column is not determined.
    Singular {
        /// Index of the unknown.
        column: usize,
    },
    /// No damping factor makes progress, or the iteration limit is reached.
    Diverged {
        /// Unknown with the largest correction.
        component: usize,
    },
    /// The equations cannot be evaluated, at the start or at any trial point.
    NonFinite {
        /// First residual that is not finite; zero if the evaluation failed as a whole.
        residual: usize,
    },
}

/// The solver with its memory, for systems of one order.
pub struct Newton {
    lu: DenseLu,
    /// In place of factors, if the last matrix was singular, and the unknown that it does not determine.
    singular: Option<(PseudoInverse, usize)>,
    jacobian: Vec<f64>,
    start: Vec<f64>,
    weights: Vec<f64>,
    correction: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    trial_correction: Vec<f64>,
}

impl Newton {
    /// For systems of `n` equations.
    pub fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Newton {
            lu: DenseLu::new(n),
            singular: None,
            jacobian: vec![0.0; n * n],
            start: zeros(),
            weights: zeros(),
            correction: zeros(),
            trial: zeros(),
            trial_residual: zeros(),
            trial_correction: zeros(),
        }
    }

    /// Solves from the guess in `z`, which becomes the solution. Never reports a solution that is
    /// not finite. A guess near the solution costs one Jacobian and two residuals.
    pub fn solve(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &mut [f64],
        region: Region,
        settings: &NewtonSettings,
    ) -> NewtonOutcome {
        self.start.copy_from_slice(z);
        let ending = self.iterate(equations, z, region, settings);
        if !matches!(ending, NewtonOutcome::Converged { .. }) {
            z.copy_from_slice(&self.start);
        }
        ending
    }

    fn iterate(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &mut [f64],
        region: Region,
        settings: &NewtonSettings,
    ) -> NewtonOutcome {
        clamp(z, region);
        let mut damping = 1.0;
        let mut smallest = f64::INFINITY;
        if let Err(residual) = evaluate(equations, z, &mut self.correction) {
            return NewtonOutcome::NonFinite { residual };
        }
        if self.correction.iter().all(|g| *g == 0.0) {
            // Also if the Jacobian is singular here: a solution needs no correction.
            return NewtonOutcome::Converged { iterations: 0, accuracy: 0.0, undetermined: None };
        }
        for iterations in 1..=settings.max_iterations {
            self.set_weights(z, region);
            if let Err(ending) = self.linearize(equations, z, settings) {
                return ending;
            }
            // `correction` holds the residual at z and becomes the Newton correction.
            if let Err(column) = self.correct() {
                return NewtonOutcome::Singular { column };
            }
            let size = weighted_rms(&self.correction, &self.weights);
            if !size.is_finite() {
                return NewtonOutcome::Singular { column: self.worst() };
            }
            let stagnates = size <= settings.stagnation && size >= 0.5 * smallest;
            if size <= settings.tolerance || stagnates {
                subtract(z, &self.correction, region);
                return self.converged(iterations, size);
            }
            smallest = smallest.min(size);

            match self.damped_step(equations, z, region, size, &mut damping, settings) {
                Err(ending) => return ending,
                Ok(DampedStep::Moved) => {}
                Ok(DampedStep::Finished { accuracy }) => {
                    return self.converged(iterations, accuracy);
                }
            }
        }
        NewtonOutcome::Diverged { component: self.worst() }
    }

    /// Tries the Newton correction with decreasing damping factors until the simplified correction
    /// at the trial point is smaller than the one that led there. Leaves the residual of the new
    /// `z` in `correction`.
    fn damped_step(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &mut [f64],
        region: Region,
        size: f64,
        damping: &mut f64,
        settings: &NewtonSettings,
    ) -> Result<DampedStep, NewtonOutcome> {
        let mut failed = None;
        while *damping >= settings.min_damping {
            for ((trial, z), c) in self.trial.iter_mut().zip(z.iter()).zip(&self.correction) {
                *trial = z - *damping * c;
            }
            clamp(&mut self.trial, region);
            match evaluate(equations, &self.trial, &mut self.trial_residual) {
                Err(residual) => failed = Some(residual),
                Ok(()) => {
                    failed = None;
                    if let Some(progress) = self.judge_trial(z, region, size, *damping, settings) {
                        *damping = (*damping * 4.0).min(1.0);
                        return Ok(progress);
                    }
                }
            }
            *damping *= 0.5;
        }
        Err(match failed {
            Some(residual) => NewtonOutcome::NonFinite { residual },
            None => NewtonOutcome::Diverged { component: self.worst() },
        })
    }

    /// Moves to the trial point if the simplified correction there is small enough, and applies
    /// that correction too if it ends the iteration.
    fn judge_trial(
        &mut self,
        z: &mut [f64],
        region: Region,
        size: f64,
        damping: f64,
        settings: &NewtonSettings,
    ) -> Option<DampedStep> {
        self.trial_correction.copy_from_slice(&self.trial_residual);
        match &self.singular {
            None => self.lu.solve_in_place(&mut self.trial_correction),
            Some((inverse, _)) => {
                inverse.solve_in_place(&mut self.trial_correction);
            }
        }
        let next = weighted_rms(&self.trial_correction, &self.weights);
        if !(next <= (1.0 - 0.25 * damping) * size) {
            // At the rounding limit, corrections no longer become smaller.
            if size <= settings.stagnation && next <= settings.stagnation {
                z.copy_from_slice(&self.trial);
                return Some(DampedStep::Finished { accuracy: next });
            }
            return None;
        }
        z.copy_from_slice(&self.trial);
        // One more simplified correction would contract by about twice the ratio.
        let ratio = next / size;
        if damping == 1.0 && ratio < 0.25 && 2.0 * ratio * next <= settings.tolerance {
            subtract(z, &self.trial_correction, region);
            return Some(DampedStep::Finished { accuracy: next });
        }
        self.correction.copy_from_slice(&self.trial_residual);
        Some(DampedStep::Moved)
    }

    fn linearize(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &[f64],
        settings: &NewtonSettings,
    ) -> Result<(), NewtonOutcome> {
        self.jacobian.fill(0.0);
        if !equations.jacobian(z, &mut self.jacobian) {
            return Err(NewtonOutcome::NonFinite { residual: 0 });
        }
        if let Some(entry) = first_non_finite(&self.jacobian) {
            return Err(NewtonOutcome::NonFinite { residual: entry % z.len() });
        }
        self.singular = None;
        let Err(singular) = self.lu.factor(&self.jacobian) else { return Ok(()) };
        let column = singular.column;
        let failed = NewtonOutcome::Singular { column };
        if !settings.may_repeat || z.len() > MOST_DECOMPOSED {
            return Err(failed);
        }
        let inverse = PseudoInverse::new(z.len(), &self.jacobian).ok_or(failed)?;
        self.singular = Some((inverse, column));
        Ok(())
    }

    /// Turns the residual in `correction` into the correction: the shortest one if the matrix is singular, or the
    /// unknown that is not determined if there is none.
    fn correct(&mut self) -> Result<(), usize> {
        match &self.singular {
            None => self.lu.solve_in_place(&mut self.correction),
            Some((inverse, column)) => {
                if !inverse.solve_in_place(&mut self.correction) {
                    return Err(*column);
                }
            }
        }
        Ok(())
    }

    fn converged(&self, iterations: u32, accuracy: f64) -> NewtonOutcome {
        let undetermined = self.singular.as_ref().map(|(_, column)| *column);
        NewtonOutcome::Converged { iterations, accuracy, undetermined }
    }

    fn set_weights(&mut self, z: &[f64], region: Region) {
        for ((w, z), nominal) in self.weights.iter_mut().zip(z).zip(region.nominal) {
            *w = 1.0 / z.abs().max(*nominal);
        }
    }

    fn worst(&self) -> usize {
        worst_component(&self.correction, &self.weights).unwrap_or(0)
    }
}

enum DampedStep {
    Moved,
    Finished { accuracy: f64 },
}

/// The residual at `z`, or the index of the first that is not finite.
fn evaluate(equations: &mut dyn NonlinearSystem, z: &[f64], g: &mut [f64]) -> Result<(), usize> {
    if !equations.residual(z, g) {
        return Err(first_non_finite(g).unwrap_or(0));
    }
    first_non_finite(g).map_or(Ok(()), Err)
}

fn subtract(z: &mut [f64], correction: &[f64], region: Region) {
    for (z, c) in z.iter_mut().zip(correction) {
        *z -= c;
    }
    clamp(z, region);
}

fn clamp(z: &mut [f64], region: Region) {
    if let Some(bounds) = region.bounds {
        for (z, (min, max)) in z.iter_mut().zip(bounds) {
            // Not `clamp`, which panics for a NaN bound or a reversed pair.
            *z = z.max(*min).min(*max);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Closures<G, J> {
        residual: G,
        jacobian: J,
    }

    impl<G, J> NonlinearSystem for Closures<G, J>
    where
        G: FnMut(&[f64], &mut [f64]),
        J: FnMut(&[f64], &mut [f64]),
    {
        fn residual(&mut self, z: &[f64], g: &mut [f64]) -> bool {
            (self.residual)(z, g);
            true
        }
        fn jacobian(&mut self, z: &[f64], j: &mut [f64]) -> bool {
            (self.jacobian)(z, j);
            true
        }
    }

    struct Counted<E> {
        equations: E,
        residuals: u32,
        jacobians: u32,
    }

    impl<E: NonlinearSystem> NonlinearSystem for Counted<E> {
        fn residual(&mut self, z: &[f64], g: &mut [f64]) -> bool {
            self.residuals += 1;
            self.equations.residual(z, g)
        }
        fn jacobian(&mut self, z: &[f64], j: &mut [f64]) -> bool {
            self.jacobians += 1;
            self.equations.jacobian(z, j)
        }
    }

    fn equations<G, J>(residual: G, jacobian: J) -> Closures<G, J> {
        Closures { residual, jacobian }
    }

    fn free(nominal: &[f64]) -> Region<'_> {
        Region { nominal, bounds: None }
    }

    /// `z1^2 + z2^2 = 4, z1 z2 = 1`, solved by
    /// `z = ((sqrt 6 + sqrt 2) / 2, (sqrt 6 - sqrt 2) / 2)`.
    fn circle_meets_hyperbola() -> impl NonlinearSystem {
        equations(
            |z: &[f64], g: &mut [f64]| {
                // Wildly different residual scales must not matter.
                g[0] = 1e9 * (z[0] * z[0] + z[1] * z[1] - 4.0);
                g[1] = 1e-9 * (z[0] * z[1] - 1.0);
            },
            |z: &[f64], j: &mut [f64]| {
                j.copy_from_slice(&[2e9 * z[0], 1e-9 * z[1], 2e9 * z[1], 1e-9 * z[0]]);
            },
        )
    }

    fn intersection() -> [f64; 2] {
        let (a, b) = (6.0_f64.sqrt(), 2.0_f64.sqrt());
        [(a + b) / 2.0, (a - b) / 2.0]
    }

    #[test]
    fn converges_to_rounding_error() {
        let mut system = circle_meets_hyperbola();
        let mut z = [3.0, 0.1];
        let ending =
            Newton::new(2).solve(&mut system, &mut z, free(&[1.0; 2]), &NewtonSettings::default());
        assert!(matches!(ending, NewtonOutcome::Converged { .. }), "{ending:?}");
        for (z, exact) in z.iter().zip(intersection()) {
            assert!((z - exact).abs() < 1e-15 * 4.0);
        }
    }

    #[test]
    fn a_close_start_costs_one_jacobian() {
        let mut system =
            Counted { equations: circle_meets_hyperbola(), residuals: 0, jacobians: 0 };
        let [a, b] = intersection();
        let mut z = [a + 1e-7, b - 1e-7];
        Newton::new(2).solve(&mut system, &mut z, free(&[1.0; 2]), &NewtonSettings::default());
        assert_eq!((system.jacobians, system.residuals), (1, 2));
        assert!((z[0] - a).abs() < 1e-15 * 4.0);
    }

    /// `atan z = 0` diverges undamped from |z| > 1.39.
    #[test]
    fn damping_rescues_the_arc_tangent() {
        let mut system = equations(
            |z: &[f64], g: &mut [f64]| g[0] = z[0].atan(),
            |z: &[f64], j: &mut [f64]| j[0] = 1.0 / (1.0 + z[0] * z[0]),
        );
        let mut z = [10.0];
        let ending =
            Newton::new(1).solve(&mut system, &mut z, free(&[1.0]), &NewtonSettings::default());
        assert!(matches!(ending, NewtonOutcome::Converged { .. }), "{ending:?}");
        assert!(z[0].abs() < 1e-14);
    }

    /// The iteration leaves the domain of the root and comes back; bounds keep it inside.
    #[test]
    fn recovers_from_a_domain_error() {
        let system = || {
            equations(
                |z: &[f64], g: &mut [f64]| g[0] = z[0].sqrt() - 0.1,
                |z: &[f64], j: &mut [f64]| j[0] = 0.5 / z[0].sqrt(),
            )
        };
        let settings = NewtonSettings::default();
        let mut z = [4.0];
        let ending = Newton::new(1).solve(&mut system(), &mut z, free(&[1.0]), &settings);
        assert!(matches!(ending, NewtonOutcome::Converged { .. }), "{ending:?}");
        assert!((z[0] - 0.01).abs() < 1e-14);
        let region = Region { nominal: &[1.0], bounds: Some(&[(1e-6, 10.0)]) };
        let mut z = [4.0];
        let ending = Newton::new(1).solve(&mut system(), &mut z, region, &settings);
        assert!(matches!(ending, NewtonOutcome::Converged { .. }), "{ending:?}");
        assert!((z[0] - 0.01).abs() < 1e-14);
    }

    #[test]
    fn failures_are_named_and_restore_the_guess() {
        let settings = NewtonSettings::default();
        let mut newton = Newton::new(2);
        let nominal = [1.0; 2];

        let mut singular = equations(
            |z: &[f64], g: &mut [f64]| g.copy_from_slice(&[z[0] - 1.0, z[0] + 2.0]),
            |_: &[f64], j: &mut [f64]| j.copy_from_slice(&[1.0, 1.0, 0.0, 0.0]),
        );
        let mut z = [5.0, 6.0];
        let ending = newton.solve(&mut singular, &mut z, free(&nominal), &settings);
        assert_eq!(ending, NewtonOutcome::Singular { column: 1 });
        assert_eq!(z, [5.0, 6.0]);

        // z^2 + 1 has no real root.
        let mut rootless = equations(
            |z: &[f64], g: &mut [f64]| g.copy_from_slice(&[z[0] * z[0] + 1.0, z[1]]),
            |z: &[f64], j: &mut [f64]| j.copy_from_slice(&[2.0 * z[0], 0.0, 0.0, 1.0]),
        );
        let ending = newton.solve(&mut rootless, &mut z, free(&nominal), &settings);
        assert!(
            matches!(
                ending,
                NewtonOutcome::Diverged { component: 0 } | NewtonOutcome::Singular { column: 0 }
            ),
            "{ending:?}"
        );
        assert_eq!(z, [5.0, 6.0]);

        let mut broken = equations(
            |_: &[f64], g: &mut [f64]| g.copy_from_slice(&[0.0, f64::NAN]),
            |_: &[f64], _: &mut [f64]| {},
        );
        let ending = newton.solve(&mut broken, &mut z, free(&nominal), &settings);
        assert_eq!(ending, NewtonOutcome::NonFinite { residual: 1 });
    }

    /// Two equations that say the same leave a line of solutions; the nearest one is found.
    #[test]
    fn repeated_equations_are_solved_as_far_as_they_determine() {
        let mut system = equations(
            |z: &[f64], g: &mut [f64]| {
                let sum = (z[0] + z[1]).exp() - 2.0;
                g.copy_from_slice(&[sum, -sum]);
            },
            |z: &[f64], j: &mut [f64]| {
                let slope = (z[0] + z[1]).exp();
                j.copy_from_slice(&[slope, -slope, slope, -slope]);
            },
        );
        let mut z = [0.5, 0.3];
        let settings = NewtonSettings::default();
        let ending = Newton::new(2).solve(&mut system, &mut z, free(&[1.0; 2]), &settings);
        assert!(
            matches!(ending, NewtonOutcome::Converged { undetermined: Some(_), .. }),
            "{ending:?}"
        );
        assert!((z[0] + z[1] - 2.0_f64.ln()).abs() < 1e-14);
        assert!((z[0] - z[1] - 0.2).abs() < 1e-14);
    }

    /// A residual that is zero up to rounding of large terms cannot be improved, and is accepted.
    #[test]
    fn rounding_in_the_residual_is_accepted() {
        let mut system = equations(
            |z: &[f64], g: &mut [f64]| g[0] = ((z[0] + 1e4) - 1e4).powi(3) - 2.0,
            |z: &[f64], j: &mut [f64]| j[0] = 3.0 * z[0] * z[0],
        );
        let mut z = [1.0];
        let ending =
            Newton::new(1).solve(&mut system, &mut z, free(&[1.0]), &NewtonSettings::default());
        assert!(
            matches!(ending, NewtonOutcome::Converged { accuracy, .. } if accuracy < 1e-9),
            "{ending:?}"
        );
        assert!((z[0] - 2.0_f64.cbrt()).abs() < 1e-11);
    }

    /// The derivative of an even function vanishes at its root.
    #[test]
    fn a_guess_that_solves_the_equations_is_kept() {
        let equations = Closures {
            residual: |z: &[f64], g: &mut [f64]| g[0] = z[0] * z[0],
            jacobian: |z: &[f64], j: &mut [f64]| j[0] = 2.0 * z[0],
        };
        let mut counted = Counted { equations, residuals: 0, jacobians: 0 };
        let mut z = [0.0];
        let region = Region { nominal: &[1.0], bounds: None };
        let ending = Newton::new(1).solve(&mut counted, &mut z, region, &NewtonSettings::default());
        let exact = NewtonOutcome::Converged { iterations: 0, accuracy: 0.0, undetermined: None };
        assert_eq!(ending, exact);
        assert_eq!((z[0], counted.residuals, counted.jacobians), (0.0, 1, 0));
    }
}
