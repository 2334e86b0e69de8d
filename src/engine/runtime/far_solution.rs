//! Searches for solutions of nonlinear blocks that Newton's method does not reach from the start, where the branch of
//! the solution need not be kept: at the start of a run and at events.

use crate::numeric::levenberg_marquardt::{Approach, LevenbergMarquardt};
use crate::numeric::newton::{Newton, NewtonOutcome, NewtonSettings, NonlinearSystem, Region};

use super::torn_block::{BlockEquations, is_solved};

/// Maximum number of unknowns of blocks that are searched around the start.
const MAX_SEARCHED_UNKNOWNS: usize = 12;
/// First displacement of an unknown, in nominal values.
const FIRST_DISPLACEMENT: f64 = 1e-3;
/// Number of displacements of each unknown.
const DISPLACEMENTS: i32 = 8;
/// Factor from one displacement to the next.
const DISPLACEMENT_GROWTH: f64 = 8.0;

/// First step of the search along one unknown, in nominal values.
const FIRST_STEP: f64 = 1e-6;
/// Number of times that step is doubled.
const DOUBLINGS: u32 = 60;
/// Number of bisections; more would not change the result.
const BISECTIONS: u32 = 100;

/// Shares of their nominal values that unknowns take where the equations cannot be evaluated at zero.
const SHARES: [f64; 4] = [1.0, 0.1, 1e-3, -1.0];

/// A search for a solution of a block.
pub(super) struct FarSolution<'s, 'a, 'p> {
    pub(super) newton: &'s mut Newton,
    pub(super) equations: &'s mut BlockEquations<'a, 'p>,
    pub(super) region: Region<'s>,
    pub(super) settings: NewtonSettings,
}

impl<'s> FarSolution<'s, '_, '_> {
    /// Tries one search after the other from the start in `z`, which becomes the solution; `failed` is how Newton's
    /// method ended there. If nothing is found, the memory shows where the iteration from the start ended.
    pub(super) fn find(&mut self, z: &mut [f64], failed: NewtonOutcome) -> NewtonOutcome {
        let start = z.to_vec();
        let mut ending = failed;
        if matches!(ending, NewtonOutcome::NonFinite { .. }) && self.move_to_finite_values(z) {
            ending = self.solve(z, self.region);
        }
        let from = z.to_vec();
        if !is_solved(ending) {
            ending = match z.len() {
                1 => self.along_the_unknown(z, ending),
                _ => self.search_displaced_starts(z, &from, ending),
            };
        }
        if !is_solved(ending) {
            ending = self.by_least_squares(z, &from, ending);
        }
        if !is_solved(ending) {
            z.copy_from_slice(&start);
            ending = match self.solve_repeated(z) {
                solved if is_solved(solved) => solved,
                _ => failed,
            };
        }
        ending
    }

    fn solve(&mut self, z: &mut [f64], region: Region<'_>) -> NewtonOutcome {
        self.newton.solve(self.equations, z, region, &self.settings)
    }

    /// As far as the equations determine the unknowns, if they repeat each other.
    fn solve_repeated(&mut self, z: &mut [f64]) -> NewtonOutcome {
        let region = self.free();
        self.newton.solve(self.equations, z, region, &NewtonSettings::default())
    }

    fn free(&self) -> Region<'s> {
        // Bounds only guide the iteration; enforcing them is up to assertions.
        Region { bounds: None, ..self.region }
    }

    /// Where the equations cannot be evaluated at the start, such as at a temperature of zero, unknowns that are zero
    /// take shares of their nominal values; false if the equations cannot be evaluated there either.
    fn move_to_finite_values(&mut self, z: &mut [f64]) -> bool {
        let start = z.to_vec();
        let mut residual = vec![0.0; z.len()];
        let equations = &mut *self.equations;
        let mut is_finite = |z: &[f64]| {
            equations.residual(z, &mut residual) && residual.iter().all(|g| g.is_finite())
        };
        if is_finite(&start) {
            return false;
        }
        for share in SHARES {
            for ((z, start), nominal) in z.iter_mut().zip(&start).zip(self.region.nominal) {
                *z = if *start == 0.0 { share * nominal } else { *start };
            }
            if is_finite(z) {
                return true;
            }
        }
        z.copy_from_slice(&start);
        false
    }

    /// The current branch of a single unknown may have ended at a fold: Newton's method from the nearest root.
    fn along_the_unknown(&mut self, z: &mut [f64], failed: NewtonOutcome) -> NewtonOutcome {
        let Some(found) = self.nearest_root(z[0]) else { return failed };
        z[0] = found;
        self.solve(z, self.free())
    }

    /// The root of a scalar equation nearest to `start`, found by searching outwards for a sign change
    /// and bisecting. Jumps and poles also change sign; they are rejected.
    fn nearest_root(&mut self, start: f64) -> Option<f64> {
        let mut value = |z: f64| {
            let mut g = [0.0];
            (self.equations.residual(&[z], &mut g) && g[0].is_finite()).then_some(g[0])
        };
        let centre = value(start)?;
        let mut sides = [(start, centre), (start, centre)];
        for k in 0..DOUBLINGS {
            let step = FIRST_STEP * self.region.nominal[0] * f64::exp2(f64::from(k));
            for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
                let z = start + sign * step;
                let Some(g) = value(z) else { continue };
                let before = std::mem::replace(side, (z, g));
                if before.1.signum() != g.signum()
                    && let Some(root) = bisected(&mut value, before, (z, g))
                {
                    return Some(root);
                }
            }
        }
        None
    }

    /// Restarts Newton's method from points around `start`, nearest first, displacing one unknown at a
    /// time.
    fn search_displaced_starts(
        &mut self,
        z: &mut [f64],
        start: &[f64],
        failed: NewtonOutcome,
    ) -> NewtonOutcome {
        if z.len() > MAX_SEARCHED_UNKNOWNS {
            return failed;
        }
        for k in 0..DISPLACEMENTS {
            let size = FIRST_DISPLACEMENT * DISPLACEMENT_GROWTH.powi(k);
            for j in 0..z.len() {
                for sign in [1.0, -1.0] {
                    z.copy_from_slice(start);
                    z[j] += sign * size * self.region.nominal[j];
                    let ending = self.solve(z, self.free());
                    if is_solved(ending) {
                        return ending;
                    }
                }
            }
        }
        failed
    }

    /// Continues Newton's method where a search for the least residuals ends. Equations that repeat each other have
    /// many solutions: the one that the search found is taken.
    fn by_least_squares(
        &mut self,
        z: &mut [f64],
        start: &[f64],
        failed: NewtonOutcome,
    ) -> NewtonOutcome {
        let Some(mut search) = LevenbergMarquardt::new(z.len()) else { return failed };
        let regions = [self.region, self.free()];
        for region in regions.iter().skip(usize::from(self.region.bounds.is_none())) {
            z.copy_from_slice(start);
            let approach = search.approach(self.equations, z, *region);
            if approach == Approach::Failed {
                continue;
            }
            let ending = self.solve(z, self.free());
            match ending {
                NewtonOutcome::Converged { .. } => return ending,
                NewtonOutcome::Singular { column } if approach == Approach::Solved => {
                    return NewtonOutcome::Converged {
                        iterations: 0,
                        accuracy: 0.0,
                        undetermined: Some(column),
                    };
                }
                NewtonOutcome::Singular { .. } => {
                    let ending = self.solve_repeated(z);
                    if is_solved(ending) {
                        return ending;
                    }
                }
                _ => {}
            }
        }
        failed
    }
}

/// The root between two points whose values differ in sign; `None` for a jump or a pole.
fn bisected(
    value: &mut impl FnMut(f64) -> Option<f64>,
    mut a: (f64, f64),
    mut b: (f64, f64),
) -> Option<f64> {
    let size = a.1.abs().max(b.1.abs());
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (a.0 + b.0);
        let Some(g) = value(middle) else { break };
        let end = if g.signum() == a.1.signum() { &mut a } else { &mut b };
        *end = (middle, g);
    }
    let (z, g) = if a.1.abs() < b.1.abs() { a } else { b };
    (g.abs() <= 1e-6 * size).then_some(z)
}
