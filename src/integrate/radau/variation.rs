//! The derivatives of a solution over one accepted step.
//!
//! They obey linear equations, which are integrated by the same method, linearized at the stages of
//! the solution. So they are the exact derivatives of the discrete solution, except for the choice
//! of steps (staggered method: M. Caracotsios, W. E. Stewart, Computers & Chemical Engineering 9,
//! 1985; T. Maly, L. Petzold, Applied Numerical Mathematics 20, 1996). The matrices of the step,
//! whose Jacobian may be slightly outdated, precondition a fixed-point iteration that converges
//! like the Newton iteration of the step. If it does not converge, the stage equations are solved
//! directly.

use crate::integrate::control::Point;
use crate::integrate::matrix::IterationMatrix;
use crate::integrate::radau::polynomial::Polynomial;
use crate::integrate::radau::stages::{advance, correct, shift, transform};
use crate::integrate::radau::tableau::{ALPHA, BETA, C1, C2, GAMMA, T, T_INVERSE};
use crate::integrate::system::EvalError;
use crate::integrate::variational::Variational;
use crate::numeric::linear::DenseLu;
use crate::numeric::norm::weighted_square_sum;

/// Maximum number of iterations before the stage equations are solved directly.
const MAX_ITERATIONS: u32 = 12;
/// Slowest convergence rate at which the iteration is continued.
const SLOWEST: f64 = 0.5;
/// Tolerance of the corrections, relative to the derivatives and to the tolerance of the solution.
const PRECISION: f64 = 1e-3;

/// The derivatives in all directions at the accepted point, and over the last step.
pub struct Variation {
    directions: Vec<Direction>,
    /// Transformed stage increments, then residuals and corrections.
    w: [Vec<f64>; 3],
    r: [Vec<f64>; 3],
    stage: Vec<f64>,
    whole: Option<Box<Whole>>,
    /// The diagonal of `M`, if it differs from that of the solution.
    mass: Option<Vec<f64>>,
}

/// One direction.
struct Direction {
    s: Vec<f64>,
    z: [Vec<f64>; 3],
    polynomial: Polynomial,
    continued: bool,
}

/// The stage equations without transformation, decomposed: `A^-1 / h M - J_i`.
struct Whole {
    lu: DenseLu,
    matrix: Vec<f64>,
    right: Vec<f64>,
    /// Decomposed for this step.
    ready: bool,
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
        let zeros = || std::array::from_fn(|_| vec![0.0; n]);
        let direction = |_| Direction {
            s: vec![0.0; n],
            z: zeros(),
            polynomial: Polynomial::new(n),
            continued: false,
        };
        Variation {
            directions: (0..directions).map(direction).collect(),
            w: zeros(),
            r: zeros(),
            stage: vec![0.0; n],
            whole: None,
            mass: None,
        }
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

    /// The derivatives in a direction at the accepted point.
    pub fn at_end(&self, direction: usize) -> &[f64] {
        &self.directions[direction].s
    }

    /// Restarts at `t` with these derivatives.
    pub fn restart(&mut self, t: f64, direction: usize, s: &[f64]) {
        let d = &mut self.directions[direction];
        d.s.copy_from_slice(s);
        d.polynomial.set_constant(t, s);
        d.continued = false;
    }

    /// Writes the derivatives in a direction at `t` within the last step to `out`.
    pub fn interpolate(&self, direction: usize, t: f64, out: &mut [f64]) {
        self.directions[direction].polynomial.evaluate(t, out);
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
            for ((stage, y), z) in self.stage.iter_mut().zip(&from.y).zip(z) {
                *stage = y + z;
            }
            system.linearise(k, t, &self.stage).map_err(NoVariation::Eval)?;
        }
        if let Some(whole) = &mut self.whole {
            whole.ready = false;
        }
        for direction in 0..self.directions.len() {
            let own = self.mass.take();
            let solved = match &own {
                Some(mass) => self.solve_at_once(system, direction, h, mass),
                None if self.iterate(system, direction, &step, matrix) => Ok(()),
                None => self.solve_at_once(system, direction, h, matrix.mass()),
            };
            self.mass = own;
            solved?;
            let d = &mut self.directions[direction];
            if self.mass.is_some() {
                d.level_last();
            }
            for (s, z) in d.s.iter_mut().zip(&d.z[2]) {
                *s += z;
            }
            d.polynomial.set(h, end, &d.s, &d.z, d.continued);
            d.continued = self.mass.is_none();
        }
        Ok(())
    }

    /// The fixed-point iteration; false if it does not converge well.
    fn iterate(
        &mut self,
        system: &dyn Variational,
        direction: usize,
        step: &AcceptedStep<'_>,
        matrix: &mut IterationMatrix,
    ) -> bool {
        let Variation { directions, w, r, stage, .. } = self;
        let d = &mut directions[direction];
        if d.continued {
            d.polynomial.extrapolate(step.h, &mut d.z);
        } else {
            d.z.iter_mut().for_each(|z| z.fill(0.0));
        }
        transform(&d.z, w);
        let norm = |v: &[f64]| weighted_square_sum(v, step.weights).sqrt();
        let mut last = f64::INFINITY;
        for iteration in 0..MAX_ITERATIONS {
            for (k, (z, r)) in d.z.iter().zip(r.iter_mut()).enumerate() {
                for ((stage, s), z) in stage.iter_mut().zip(&d.s).zip(z) {
                    *stage = s + z;
                }
                system.slope(k, direction, stage, r);
            }
            correct(r, w, matrix, shift(step.h));
            advance(r, w, &mut d.z);
            let size = r.iter().map(|r| norm(r)).fold(0.0, f64::max);
            let scale = d.z.iter().map(|z| norm(z)).fold(norm(&d.s), f64::max);
            if size <= PRECISION * step.rtol * scale {
                return true;
            }
            let slow = iteration > 0 && size > SLOWEST * last;
            if slow || !size.is_finite() {
                // Rounding errors may keep the corrections from decreasing further.
                return size <= step.rtol * scale;
            }
            last = size;
        }
        false
    }

    fn solve_at_once(
        &mut self,
        system: &dyn Variational,
        direction: usize,
        h: f64,
        mass: &[f64],
    ) -> Result<(), NoVariation> {
        let Variation { directions, stage, whole, r, .. } = self;
        let d = &mut directions[direction];
        let n = d.s.len();
        let whole = whole.get_or_insert_with(|| {
            Box::new(Whole {
                lu: DenseLu::new(3 * n),
                matrix: vec![0.0; 9 * n * n],
                right: vec![0.0; 3 * n],
                ready: false,
            })
        });
        if !whole.ready {
            whole.fill(system, h, mass, stage, r);
            whole
                .lu
                .factor(&whole.matrix)
                .map_err(|s| NoVariation::Singular { component: s.column % n })?;
            whole.ready = true;
        }
        for (k, right) in whole.right.chunks_exact_mut(n).enumerate() {
            system.slope(k, direction, &d.s, right);
        }
        whole.lu.solve_in_place(&mut whole.right);
        for (z, right) in d.z.iter_mut().zip(whole.right.chunks_exact(n)) {
            z.copy_from_slice(right);
        }
        if whole.right.iter().any(|x| !x.is_finite()) {
            return Err(NoVariation::Singular { component: 0 });
        }
        Ok(())
    }
}

impl Direction {
    /// Moves the last component at the start of the step onto the parabola through its stages.
    fn level_last(&mut self) {
        let last = self.s.len() - 1;
        let nodes = [C1, C2, 1.0];
        let at_start: f64 = (0..3)
            .map(|k| {
                let others = (0..3).filter(|j| *j != k);
                let weight: f64 = others.map(|j| nodes[j] / (nodes[j] - nodes[k])).product();
                weight * self.z[k][last]
            })
            .sum();
        self.s[last] += at_start;
        self.z.iter_mut().for_each(|z| z[last] -= at_start);
    }
}

impl Whole {
    /// `A^-1 / h M - diag(J_1, J_2, J_3)`, column by column.
    fn fill(
        &mut self,
        system: &dyn Variational,
        h: f64,
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
            system.slope(stage, 0, unit, base);
            for j in 0..n {
                unit[j] = 1.0;
                system.slope(stage, 0, unit, slope);
                unit[j] = 0.0;
                for i in 0..n {
                    self.matrix[stage * n + i + 3 * n * (stage * n + j)] -= slope[i] - base[i];
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
fn inverse_of_a() -> [[f64; 3]; 3] {
    let l = [[GAMMA, 0.0, 0.0], [0.0, ALPHA, -BETA], [0.0, BETA, ALPHA]];
    let product = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    };
    product(product(T, l), T_INVERSE)
}
