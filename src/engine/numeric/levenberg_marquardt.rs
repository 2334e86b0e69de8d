//! Small dense nonlinear systems `g(z) = 0` as a least-squares problem, for starts from which Newton's iteration does
//! not converge: its matrix is singular there, as at zero flow, or its direction leads nowhere.
//!
//! K. Levenberg 1944 and D. W. Marquardt 1963, with the damping of H. B. Nielsen, *Damping parameter in Marquardt's
//! method* (1999). Unknowns are measured by their nominal values, and residuals by what a change of the unknowns by
//! these makes of them, so that units do not matter. Near a solution Newton's method takes over; it decides what a
//! solution is, except where equations repeat each other: there, the solution is one of many.

use super::linear::DenseLu;
use super::newton::{NonlinearSystem, Region};
use super::norm::first_non_finite;

/// Largest number of unknowns; a step takes time of its third power.
const MOST_UNKNOWNS: usize = 250;
/// Largest number of Jacobians.
const MOST_ITERATIONS: u32 = 150;
/// Scaled residuals of this size are rounding errors.
const SOLVED: f64 = 1e-11;
/// Scaled residuals of this size are close enough for Newton's method.
const CLOSE: f64 = 1e-6;
/// A row of the Jacobian counts for at least this fraction of its largest size so far.
const SMALLEST_SLOPE: f64 = 1e-3;
/// Damping of the first step.
const FIRST_DAMPING: f64 = 1e-3;
/// Damping that does not matter.
const LEAST_DAMPING: f64 = 1e-15;
/// First displacement of an unknown that no equation depends on at the start, in its size.
const DISPLACEMENT: f64 = 1e-2;
/// Damping at which steps become negligible.
const MOST_DAMPING: f64 = 1e14;

/// How the search ended.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Approach {
    /// The equations hold up to rounding errors.
    Solved,
    /// Newton's method should succeed from here.
    Close,
    /// Neither.
    Failed,
}

/// The search with its memory.
pub struct LevenbergMarquardt {
    n: usize,
    lu: DenseLu,
    jacobian: Vec<f64>,
    gram: Vec<f64>,
    gradient: Vec<f64>,
    residual: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    step: Vec<f64>,
    /// Size of each unknown.
    sizes: Vec<f64>,
    /// Size of each residual.
    slopes: Vec<f64>,
}

impl LevenbergMarquardt {
    /// For systems of `n` equations; `None` if there are too many.
    pub fn new(n: usize) -> Option<Self> {
        let zeros = || vec![0.0; n];
        (n <= MOST_UNKNOWNS).then(|| LevenbergMarquardt {
            n,
            lu: DenseLu::new(n),
            jacobian: vec![0.0; n * n],
            gram: vec![0.0; n * n],
            gradient: zeros(),
            residual: zeros(),
            trial: zeros(),
            trial_residual: zeros(),
            step: zeros(),
            sizes: zeros(),
            slopes: zeros(),
        })
    }

    /// Moves `z` towards a solution; `z` is its start again if the search failed.
    pub fn approach(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &mut [f64],
        region: Region,
    ) -> Approach {
        let start = z.to_vec();
        self.slopes.fill(0.0);
        let ending = self.search(equations, z, region);
        if ending == Approach::Failed {
            z.copy_from_slice(&start);
        }
        ending
    }

    fn search(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &mut [f64],
        region: Region,
    ) -> Approach {
        let mut damping = FIRST_DAMPING;
        let mut displacements = [1.0, -2.0].into_iter();
        if !self.evaluate(equations, z) {
            return Approach::Failed;
        }
        for _ in 0..MOST_ITERATIONS {
            if !self.linearize(equations, z, region) {
                return Approach::Failed;
            }
            if self.largest(&self.residual) <= SOLVED {
                return Approach::Solved;
            }
            if let Some(next) = self.move_on(equations, z, damping, region) {
                damping = next;
                continue;
            }
            // Equations that are even in an unknown have no slope at its zero.
            let is_displaced = displacements.next().is_some_and(|by| self.displace(z, by));
            if self.ending() == Approach::Close || !is_displaced || !self.evaluate(equations, z) {
                break;
            }
            damping = FIRST_DAMPING;
        }
        self.ending()
    }

    /// Makes the step with the least damping from `damping` on that reduces the residuals: the damping of the next
    /// one; `None` if no step does.
    fn move_on(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &mut [f64],
        mut damping: f64,
        region: Region,
    ) -> Option<f64> {
        let mut growth = 2.0;
        while damping <= MOST_DAMPING {
            match self.try_step(equations, z, damping, region) {
                Some(gain) if gain > 1e-4 => {
                    z.copy_from_slice(&self.trial);
                    std::mem::swap(&mut self.residual, &mut self.trial_residual);
                    damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
                    return Some(damping.max(LEAST_DAMPING));
                }
                _ => {
                    damping *= growth;
                    growth *= 2.0;
                }
            }
        }
        None
    }

    /// Moves the unknowns that no equation depends on at `z`; false if there are none.
    fn displace(&self, z: &mut [f64], by: f64) -> bool {
        let mut any = false;
        let columns = self.jacobian.chunks_exact(self.n);
        for ((column, size), z) in columns.zip(&self.sizes).zip(z) {
            if column.iter().all(|a| *a == 0.0) {
                *z += by * DISPLACEMENT * size;
                any = true;
            }
        }
        any
    }

    /// The residuals at `z`; false if they cannot be computed.
    fn evaluate(&mut self, equations: &mut dyn NonlinearSystem, z: &[f64]) -> bool {
        equations.residual(z, &mut self.residual) && first_non_finite(&self.residual).is_none()
    }

    fn ending(&self) -> Approach {
        if self.largest(&self.residual) <= CLOSE { Approach::Close } else { Approach::Failed }
    }

    /// The largest residual, in units of the changes that the unknowns make.
    fn largest(&self, residual: &[f64]) -> f64 {
        residual.iter().zip(&self.slopes).fold(0.0, |most: f64, (g, s)| most.max((g / s).abs()))
    }

    /// The sum of squares of the scaled residuals.
    fn cost(&self, residual: &[f64]) -> f64 {
        residual.iter().zip(&self.slopes).map(|(g, s)| (g / s) * (g / s)).sum()
    }

    /// The scaled Jacobian at `z`, and the normal equations; false if it cannot be computed.
    fn linearize(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &[f64],
        region: Region,
    ) -> bool {
        let n = self.n;
        self.jacobian.fill(0.0);
        if !equations.jacobian(z, &mut self.jacobian) || first_non_finite(&self.jacobian).is_some()
        {
            return false;
        }
        for ((size, z), nominal) in self.sizes.iter_mut().zip(z).zip(region.nominal) {
            *size = z.abs().max(*nominal);
        }
        for (column, size) in self.jacobian.chunks_exact_mut(n).zip(&self.sizes) {
            column.iter_mut().for_each(|a| *a *= size);
        }
        for (i, slope) in self.slopes.iter_mut().enumerate() {
            let row = self.jacobian.iter().skip(i).step_by(n);
            let largest = row.fold(0.0f64, |most, a| most.max(a.abs()));
            *slope = largest.max(SMALLEST_SLOPE * *slope);
            if *slope == 0.0 {
                *slope = if self.residual[i] == 0.0 { 1.0 } else { self.residual[i].abs() };
            }
        }
        for column in self.jacobian.chunks_exact_mut(n) {
            for (a, slope) in column.iter_mut().zip(&self.slopes) {
                *a /= slope;
            }
        }
        let columns = || self.jacobian.chunks_exact(n);
        for (j, left) in columns().enumerate() {
            for (k, right) in columns().enumerate().take(j + 1) {
                let product: f64 = left.iter().zip(right).map(|(a, b)| a * b).sum();
                self.gram[j + n * k] = product;
                self.gram[k + n * j] = product;
            }
            let scaled = self.residual.iter().zip(&self.slopes).map(|(g, s)| g / s);
            self.gradient[j] = left.iter().zip(scaled).map(|(a, g)| a * g).sum();
        }
        true
    }

    /// Tries the step with this damping: the decrease of the sum of squares in units of the predicted one; `None` if
    /// there is no step, or the equations cannot be evaluated there.
    fn try_step(
        &mut self,
        equations: &mut dyn NonlinearSystem,
        z: &[f64],
        damping: f64,
        region: Region,
    ) -> Option<f64> {
        let n = self.n;
        let gram = &self.gram;
        self.lu
            .factor_with(|matrix| {
                matrix.copy_from_slice(gram);
                (0..n).for_each(|k| matrix[k + n * k] += damping);
            })
            .ok()?;
        self.step.copy_from_slice(&self.gradient);
        self.lu.solve_in_place(&mut self.step);
        for k in 0..n {
            self.trial[k] = z[k] - self.step[k] * self.sizes[k];
            if let Some((min, max)) = region.bounds.map(|bounds| bounds[k]) {
                self.trial[k] = self.trial[k].max(min).min(max);
            }
        }
        let predicted: f64 =
            (0..n).map(|k| self.step[k] * (self.gradient[k] + damping * self.step[k])).sum();
        let is_step = predicted.is_finite() && predicted > 0.0;
        let is_computed = is_step && equations.residual(&self.trial, &mut self.trial_residual);
        if !is_computed || first_non_finite(&self.trial_residual).is_some() {
            return None;
        }
        Some((self.cost(&self.residual) - self.cost(&self.trial_residual)) / predicted)
    }
}

#[cfg(test)]
mod tests {
    use super::super::newton::{Newton, NewtonOutcome, NewtonSettings};
    use super::*;

    struct Closures<G, J>(G, J);

    impl<G, J> NonlinearSystem for Closures<G, J>
    where
        G: FnMut(&[f64], &mut [f64]),
        J: FnMut(&[f64], &mut [f64]),
    {
        fn residual(&mut self, z: &[f64], g: &mut [f64]) -> bool {
            (self.0)(z, g);
            true
        }
        fn jacobian(&mut self, z: &[f64], j: &mut [f64]) -> bool {
            (self.1)(z, j);
            true
        }
    }

    /// Powell's function has a singular matrix at its solution (0, 0, 0, 0): J. J. Moré, B. S. Garbow and K. E.
    /// Hillstrom, *Testing unconstrained optimization software* (1981), problem 13.
    #[test]
    fn a_singular_solution_is_approached() {
        let (a, b) = (5f64.sqrt(), 10f64.sqrt());
        let mut system = Closures(
            |z: &[f64], g: &mut [f64]| {
                g[0] = z[0] + 10.0 * z[1];
                g[1] = a * (z[2] - z[3]);
                g[2] = (z[1] - 2.0 * z[2]).powi(2);
                g[3] = b * (z[0] - z[3]).powi(2);
            },
            |z: &[f64], j: &mut [f64]| {
                let (c, d) = (2.0 * (z[1] - 2.0 * z[2]), 2.0 * b * (z[0] - z[3]));
                let rows = [
                    [1.0, 10.0, 0.0, 0.0],
                    [0.0, 0.0, a, -a],
                    [0.0, c, -2.0 * c, 0.0],
                    [d, 0.0, 0.0, -d],
                ];
                for (i, row) in rows.iter().enumerate() {
                    (0..4).for_each(|k| j[i + 4 * k] = row[k]);
                }
            },
        );
        let mut z = [3.0, -1.0, 0.0, 1.0];
        let region = Region { nominal: &[1.0; 4], bounds: None };
        let ending = LevenbergMarquardt::new(4).unwrap().approach(&mut system, &mut z, region);
        assert_ne!(ending, Approach::Failed);
        assert!(z.iter().all(|z| z.abs() < 1e-2), "{z:?}");
    }

    /// Newton's matrix is singular at the start, where the flow is zero: `q |q| = p`, `p = 4 - q` has `q = 1.56155`.
    #[test]
    fn newton_succeeds_after_a_start_at_zero_flow() {
        let mut system = Closures(
            |z: &[f64], g: &mut [f64]| {
                g[0] = z[0] * z[0].abs() - z[1];
                g[1] = z[1] - 4.0 + z[0] * z[0];
            },
            |z: &[f64], j: &mut [f64]| {
                j.copy_from_slice(&[2.0 * z[0].abs(), 2.0 * z[0], -1.0, 1.0]);
            },
        );
        let region = Region { nominal: &[1.0; 2], bounds: None };
        let settings = NewtonSettings::default();
        let mut z = [0.0, 0.0];
        let mut newton = Newton::new(2);
        let ending = newton.solve(&mut system, &mut z, region, &settings);
        assert!(matches!(ending, NewtonOutcome::Singular { .. }), "{ending:?}");
        let mut search = LevenbergMarquardt::new(2).unwrap();
        assert_ne!(search.approach(&mut system, &mut z, region), Approach::Failed);
        let ending = newton.solve(&mut system, &mut z, region, &settings);
        assert!(matches!(ending, NewtonOutcome::Converged { .. }), "{ending:?}");
        assert!((z[0] - 2f64.sqrt()).abs() < 1e-12 && (z[1] - 2.0).abs() < 1e-12);
    }

    /// Two equations that say the same leave a line of solutions; the one next to the start is found.
    #[test]
    fn repeated_equations_are_solved_next_to_the_start() {
        let mut system = Closures(
            |z: &[f64], g: &mut [f64]| {
                g[0] = (z[0] + z[1]).powi(3) - 8.0;
                g[1] = 1e6 * ((z[0] + z[1]).powi(3) - 8.0);
            },
            |z: &[f64], j: &mut [f64]| {
                let slope = 3.0 * (z[0] + z[1]).powi(2);
                j.copy_from_slice(&[slope, 1e6 * slope, slope, 1e6 * slope]);
            },
        );
        let region = Region { nominal: &[1.0; 2], bounds: None };
        let mut z = [3.0, 2.0];
        let ending = LevenbergMarquardt::new(2).unwrap().approach(&mut system, &mut z, region);
        assert_eq!(ending, Approach::Solved);
        // Both unknowns move, the larger one further.
        assert!((z[0] + z[1] - 2.0).abs() < 1e-10, "{z:?}");
        assert!(z[0] > 1.0 && z[0] < 3.0 && z[1] > 0.5 && z[1] < 2.0, "{z:?}");
    }
}
