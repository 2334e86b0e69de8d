//! The derivatives of a solution over one accepted step.
//!
//! They obey linear equations, which are integrated by the same method, linearized at the stages of
//! the solution. So they are the exact derivatives of the discrete solution, except for the choice
//! of steps (staggered method: M. Caracotsios, W. E. Stewart, Computers & Chemical Engineering 9,
//! 1985; T. Maly, L. Petzold, Applied Numerical Mathematics 20, 1996). The matrices of the step,
//! whose Jacobian may be slightly outdated, precondition a fixed-point iteration that converges
//! like the Newton iteration of the step. If it does not converge, the stage equations are solved
//! directly, as dense ones. Where the entries of the Jacobians are known and elimination takes less
//! than the iteration, they are solved by [`super::stage_system`] at once.

use crate::integrate::control::Point;
use crate::integrate::matrix::{IterationMatrix, Shift};
use crate::integrate::radau::polynomial::Polynomial;
use crate::integrate::radau::stage_system::StageSystem;
use crate::integrate::radau::stages::{advance, shift, transform, transformed_residual};
use crate::integrate::radau::tableau::{ALPHA, BETA, C1, C2, GAMMA, T, T_INVERSE};
use crate::integrate::system::EvalError;
use crate::integrate::variational::Variational;
use crate::numeric::linear::{DenseLu, Singular};
use crate::numeric::panel;
use crate::numeric::pattern::Pattern;

/// Maximum number of iterations before the stage equations are solved directly.
const MAX_ITERATIONS: u32 = 12;
/// Slowest convergence rate at which the iteration is continued.
const SLOWEST: f64 = 0.5;
/// Tolerance of the corrections, relative to the derivatives and to the tolerance of the solution.
const PRECISION: f64 = 1e-3;

/// The derivatives in all directions at the accepted point, and over the last step.
///
/// Vectors of derivatives are panels ([`crate::numeric::panel`]): a row for each component, a column for each direction.
pub struct Variation {
    /// Number of components.
    n: usize,
    directions: usize,
    /// Directions with padding.
    width: usize,
    s: Vec<f64>,
    z: [Vec<f64>; 3],
    polynomial: Polynomial,
    continued: bool,
    /// The curvature jumps at the end of the last step.
    kink: bool,
    /// Transformed stage increments, then residuals and corrections.
    w: [Vec<f64>; 3],
    r: [Vec<f64>; 3],
    stage: Vec<f64>,
    /// A stage of the solution.
    point: Vec<f64>,
    progress: Vec<Progress>,
    whole: Option<Box<Whole>>,
    /// The stage equations by blocks, if the pattern of the Jacobian is known and elimination pays.
    blocks: Option<Box<StageSystem>>,
    /// The diagonal of `M`, if it differs from that of the solution.
    mass: Option<Vec<f64>>,
}

/// How far the iteration is in a direction.
#[derive(Clone, Copy, Default)]
struct Progress {
    state: State,
    /// Largest norm of the corrections at a stage, squared.
    size: f64,
    /// Largest norm of the increments and of the derivatives at the start, squared.
    scale: f64,
    /// The `size` of the last iteration.
    last: f64,
}

#[derive(Clone, Copy, PartialEq, Eq, Default)]
enum State {
    #[default]
    Open,
    Converged,
    Slow,
}

/// The stage equations without transformation, decomposed: `A^-1 / h M - J_i`.
struct Whole {
    lu: DenseLu,
    matrix: Vec<f64>,
    right: Vec<f64>,
}

/// Why the derivatives could not be advanced.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NoVariation {
    /// The linearization at a stage failed.
    Eval(EvalError),
    /// The stage equations of the derivatives are singular.
    Singular {
        /// Component.
        component: usize,
    },
}

impl Variation {
    /// For `directions` directions of `n` components, all zero.
    pub fn new(n: usize, directions: usize) -> Self {
        let width = panel::width(directions);
        let zeros = || vec![0.0; n * width];
        let stages = || std::array::from_fn(|_| zeros());
        Variation {
            n,
            directions,
            width,
            s: zeros(),
            z: stages(),
            polynomial: Polynomial::new(n * width),
            continued: false,
            kink: false,
            w: stages(),
            r: stages(),
            stage: zeros(),
            point: vec![0.0; n],
            progress: vec![Progress::default(); directions],
            whole: None,
            blocks: None,
            mass: None,
        }
    }

    /// As [`Variation::new`], for equations whose Jacobians have this pattern.
    pub fn with_pattern(pattern: &Pattern, directions: usize) -> Self {
        let variation = Variation::new(pattern.columns(), directions);
        let blocks = StageSystem::new(pattern, variation.width).map(Box::new);
        Variation { blocks, ..variation }
    }

    /// As [`Variation::new`], for differential equations of `n` components with a constraint and
    /// its multiplier as the last component: a system of index 2. Its stage equations are always
    /// solved directly. The last component is interpolated by the parabola through its stages,
    /// which the value at the start of the step need not lie on.
    pub fn constrained(n: usize, directions: usize) -> Self {
        let mut mass = vec![1.0; n];
        mass.push(0.0);
        Variation { mass: Some(mass), ..Variation::new(n + 1, directions) }
    }

    /// Columns of the panels: the directions with padding.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The derivatives at the accepted point.
    pub fn at_end(&self) -> &[f64] {
        &self.s
    }

    /// Restarts at `t` with these derivatives.
    pub fn restart(&mut self, t: f64, s: &[f64]) {
        self.s.copy_from_slice(s);
        self.restart_here(t);
    }

    /// Restarts at `t`, the end of the last step.
    pub fn restart_here(&mut self, t: f64) {
        self.polynomial.set_constant(t, &self.s);
        self.continued = false;
    }

    /// The curvature of the derivatives may jump at the end of the last step: see
    /// [`Stepper::pass_kink`](crate::integrate::stepper::Stepper::pass_kink).
    pub fn pass_kink(&mut self) {
        self.kink = true;
    }

    /// Writes the derivatives at `t` within the last step to `out`.
    pub fn interpolate(&self, t: f64, out: &mut [f64]) {
        self.polynomial.evaluate(t, out);
    }

    /// Writes the derivatives of one component at `t` within the last step to `out`, with padding.
    pub fn interpolate_component(&self, component: usize, t: f64, out: &mut [f64]) {
        self.polynomial.evaluate_from(component * self.width, t, &mut out[..self.width]);
    }

    /// Advances over an accepted step; `matrix` is decomposed for it.
    pub fn advance(
        &mut self,
        system: &mut dyn Variational,
        step: AcceptedStep<'_>,
        matrix: &mut IterationMatrix,
    ) -> Result<(), NoVariation> {
        let AcceptedStep { from, z, h, end, .. } = step;
        let times = [from.t + C1 * h, from.t + C2 * h, end];
        for (k, (t, z)) in times.into_iter().zip(z).enumerate() {
            self.point.resize(from.y.len(), 0.0);
            for ((stage, y), z) in self.point.iter_mut().zip(&from.y).zip(z) {
                *stage = y + z;
            }
            system.linearise(k, t, &self.point).map_err(NoVariation::Eval)?;
        }
        match self.mass.take() {
            Some(mass) => {
                self.progress.fill(Progress::default());
                let solved = self.solve_at_once(system, h, &mass);
                self.mass = Some(mass);
                solved?;
                self.level_last();
            }
            None if self.solve_by_blocks(system, h, matrix.mass()) => {}
            None => {
                self.iterate(system, &step, matrix);
                if self.progress.iter().any(|p| p.state != State::Converged) {
                    self.solve_at_once(system, h, matrix.mass())?;
                }
            }
        }
        for (s, z) in self.s.iter_mut().zip(&self.z[2]) {
            *s += z;
        }
        let smooth = !std::mem::take(&mut self.kink);
        self.polynomial.set(h, end, &self.s, &self.z, self.continued && smooth);
        self.continued = self.mass.is_none();
        Ok(())
    }

    /// Solves the stage equations by blocks; false, with nothing changed that matters, where that is not possible.
    fn solve_by_blocks(&mut self, system: &dyn Variational, h: f64, mass: &[f64]) -> bool {
        let Variation { width, s, z, r, blocks: Some(blocks), .. } = self else { return false };
        let [Some(first), Some(second), Some(third)] = [0, 1, 2].map(|k| system.jacobian(k)) else {
            return false;
        };
        if blocks.factor([first, second, third], mass, &inverse_of_a(), h).is_err() {
            return false;
        }
        for (k, r) in r.iter_mut().enumerate() {
            system.slopes(k, *width, s, r);
        }
        blocks.solve(r, z);
        z.iter().flatten().all(|z| z.is_finite())
    }

    /// The fixed-point iteration, in all directions until each has converged or is too slow.
    fn iterate(
        &mut self,
        system: &dyn Variational,
        step: &AcceptedStep<'_>,
        matrix: &mut IterationMatrix,
    ) {
        let width = self.width;
        if self.continued {
            self.polynomial.extrapolate(step.h, &mut self.z);
        } else {
            self.z.iter_mut().for_each(|z| z.fill(0.0));
        }
        transform(&self.z, &mut self.w);
        self.progress.fill(Progress { last: f64::INFINITY, ..Progress::default() });
        let shift = shift(step.h);
        for iteration in 0..MAX_ITERATIONS {
            for k in 0..3 {
                for ((stage, s), z) in self.stage.iter_mut().zip(&self.s).zip(&self.z[k]) {
                    *stage = s + z;
                }
                system.slopes(k, width, &self.stage, &mut self.r[k]);
            }
            residuals(&mut self.r, &self.w, matrix.mass(), width, shift);
            matrix.solve_panels(&mut self.r, width);
            advance(&self.r, &mut self.w, &mut self.z);
            self.measure(step.weights);
            let mut is_open = false;
            for p in self.progress.iter_mut().filter(|p| p.state == State::Open) {
                let (size, scale) = (p.size.sqrt(), p.scale.sqrt());
                if size <= PRECISION * step.rtol * scale {
                    p.state = State::Converged;
                } else if iteration > 0 && size > SLOWEST * p.last || !size.is_finite() {
                    // Rounding errors may keep the corrections from decreasing further.
                    let is_small = size <= step.rtol * scale;
                    p.state = if is_small { State::Converged } else { State::Slow };
                } else {
                    is_open = true;
                }
                p.last = size;
            }
            if !is_open {
                return;
            }
        }
    }

    /// The norms of the last corrections and of what they correct, in each direction.
    fn measure(&mut self, weights: &[f64]) {
        let Variation { width, s, z, r, stage, progress, .. } = self;
        let mut largest = |panels: &mut dyn Iterator<Item = &Vec<f64>>,
                           out: fn(&mut Progress) -> &mut f64| {
            progress.iter_mut().for_each(|p| *out(p) = 0.0);
            for panel in panels {
                let sums = &mut stage[..*width];
                sums.fill(0.0);
                for (row, weight) in panel.chunks_exact(*width).zip(weights) {
                    for (sum, v) in sums.iter_mut().zip(row) {
                        *sum += (v * weight) * (v * weight);
                    }
                }
                for (p, sum) in progress.iter_mut().zip(sums.iter()) {
                    let largest = out(p);
                    // A NaN stays.
                    *largest = if *sum <= *largest { *largest } else { *sum };
                }
            }
        };
        largest(&mut r.iter(), |p| &mut p.size);
        largest(&mut z.iter().chain([&*s]), |p| &mut p.scale);
    }

    /// Solves the stage equations directly in the directions that have not converged.
    fn solve_at_once(
        &mut self,
        system: &dyn Variational,
        h: f64,
        mass: &[f64],
    ) -> Result<(), NoVariation> {
        let Variation { n, width, directions, s, z, r, stage, progress, whole, .. } = self;
        let (n, width) = (*n, *width);
        let whole = whole.get_or_insert_with(|| {
            Box::new(Whole {
                lu: DenseLu::new(3 * n),
                matrix: vec![0.0; 9 * n * n],
                right: vec![0.0; 3 * n],
            })
        });
        whole.fill(system, (h, width), mass, stage, r);
        let singular = |s: Singular| NoVariation::Singular { component: s.column % n };
        whole.lu.factor(&whole.matrix).map_err(singular)?;
        for (k, r) in r.iter_mut().enumerate() {
            system.slopes(k, width, s, r);
        }
        for d in (0..*directions).filter(|d| progress[*d].state != State::Converged) {
            for (right, r) in whole.right.chunks_exact_mut(n).zip(&*r) {
                (0..n).for_each(|i| right[i] = r[i * width + d]);
            }
            whole.lu.solve_in_place(&mut whole.right);
            if whole.right.iter().any(|x| !x.is_finite()) {
                return Err(NoVariation::Singular { component: 0 });
            }
            for (z, right) in z.iter_mut().zip(whole.right.chunks_exact(n)) {
                (0..n).for_each(|i| z[i * width + d] = right[i]);
            }
        }
        Ok(())
    }

    /// Moves the last component at the start of the step onto the parabola through its stages.
    fn level_last(&mut self) {
        let last = (self.n - 1) * self.width..self.n * self.width;
        let nodes = [C1, C2, 1.0];
        let weight = |k: usize| -> f64 {
            let others = (0..3).filter(|j| *j != k);
            others.map(|j| nodes[j] / (nodes[j] - nodes[k])).product()
        };
        let weights = [0, 1, 2].map(weight);
        for i in last {
            let at_start: f64 = (0..3).map(|k| weights[k] * self.z[k][i]).sum();
            self.s[i] += at_start;
            self.z.iter_mut().for_each(|z| z[i] -= at_start);
        }
    }
}

/// Turns the right sides `r` at the stages into those of the systems for the corrections `dW`.
fn residuals(r: &mut [Vec<f64>; 3], w: &[Vec<f64>; 3], mass: &[f64], width: usize, shift: Shift) {
    let [r1, r2, r3] = r;
    let [w1, w2, w3] = w;
    for (row, mass) in mass.iter().enumerate() {
        let range = row * width..(row + 1) * width;
        let (r1, r2, r3) = (&mut r1[range.clone()], &mut r2[range.clone()], &mut r3[range.clone()]);
        let (w1, w2, w3) = (&w1[range.clone()], &w2[range.clone()], &w3[range]);
        for i in 0..width {
            let w = [mass * w1[i], mass * w2[i], mass * w3[i]];
            [r1[i], r2[i], r3[i]] = transformed_residual([r1[i], r2[i], r3[i]], w, shift);
        }
    }
}

impl Whole {
    /// `A^-1 / h M - diag(J_1, J_2, J_3)`, column by column.
    fn fill(
        &mut self,
        system: &dyn Variational,
        (h, width): (f64, usize),
        mass: &[f64],
        unit: &mut [f64],
        memory: &mut [Vec<f64>; 3],
    ) {
        let n = mass.len();
        let inverse = inverse_of_a();
        self.matrix.fill(0.0);
        let [slope, base, _] = memory;
        for (stage, row) in inverse.iter().enumerate() {
            for (other, a) in row.iter().enumerate() {
                for (i, mass) in mass.iter().enumerate() {
                    self.matrix[stage * n + i + 3 * n * (other * n + i)] += a / h * mass;
                }
            }
            unit.fill(0.0);
            system.slopes(stage, width, unit, base);
            // As many columns of the Jacobian at once as a panel has.
            for first in (0..n).step_by(width) {
                let count = width.min(n - first);
                (0..count).for_each(|d| unit[(first + d) * width + d] = 1.0);
                system.slopes(stage, width, unit, slope);
                (0..count).for_each(|d| unit[(first + d) * width + d] = 0.0);
                for d in 0..count {
                    for i in 0..n {
                        let at = i * width + d;
                        self.matrix[stage * n + i + 3 * n * (stage * n + first + d)] -=
                            slope[at] - base[at];
                    }
                }
            }
        }
    }
}

/// Data of an accepted step.
#[derive(Clone, Copy)]
pub struct AcceptedStep<'a> {
    /// Its start.
    pub from: &'a Point,
    /// Increments to its stages.
    pub z: &'a [Vec<f64>; 3],
    /// Its length.
    pub h: f64,
    /// Its end.
    pub end: f64,
    /// Weights of the error norm.
    pub weights: &'a [f64],
    /// Relative tolerance of the solution.
    pub rtol: f64,
}

/// `A^-1 = T L T^-1`
pub fn inverse_of_a() -> [[f64; 3]; 3] {
    let l = [[GAMMA, 0.0, 0.0], [0.0, ALPHA, -BETA], [0.0, BETA, ALPHA]];
    let product = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    };
    product(product(T, l), T_INVERSE)
}
