//! Sequential quadratic programming: the minimum of a function in a box, under inequalities.
//!
//! `minimise f(x)` with `low <= x <= high` and `c(x) <= 0`. Each step solves a quadratic model of the Lagrangian with
//! linear constraints; its matrix is updated by the damped formula of M. J. D. Powell (*A fast algorithm for nonlinearly
//! constrained optimization calculations*, Lecture Notes in Mathematics 630, 1978), and the step is shortened until the
//! exact penalty `f + rho * sum(max(0, c))` decreases (S. P. Han 1977). The constraints of the quadratic problem are
//! elastic with the same `rho`, so it always has a solution: its dual is a problem in a box, which coordinate ascent
//! solves (C. Hildreth, *A quadratic programming procedure*, Naval Research Logistics Quarterly 4, 1957).

use super::small_lu;

/// A function and its constraints.
pub trait Constrained {
    /// The function and the constraints at a point; none if they do not exist there.
    fn values(&mut self, x: &[f64]) -> Option<Values>;
    /// Their gradients at the point where `values` were computed last, or at another.
    fn gradients(&mut self, x: &[f64]) -> Option<Gradients>;
    /// Called after each step with the values there; `false` ends the search.
    fn accepts_step(&mut self, _iteration: u32, _x: &[f64], _values: &Values) -> bool {
        true
    }
}

/// The function and the constraints, which hold where they are not positive.
#[derive(Clone, PartialEq, Debug)]
pub struct Values {
    /// The function.
    pub f: f64,
    /// The constraints.
    pub c: Vec<f64>,
}

impl Values {
    /// The largest violation of a constraint; 0 if all hold.
    pub fn violation(&self) -> f64 {
        self.c.iter().fold(0.0, |a, c| a.max(*c))
    }

    fn penalty(&self, rho: f64) -> f64 {
        self.f + rho * self.c.iter().map(|c| c.max(0.0)).sum::<f64>()
    }
}

/// The gradients of the function and of each constraint.
#[derive(Clone, PartialEq, Debug)]
pub struct Gradients {
    /// Of the function.
    pub f: Vec<f64>,
    /// Of each constraint.
    pub c: Vec<Vec<f64>>,
}

/// When a search ends.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Stopping {
    /// Steps.
    pub most_steps: u32,
    /// Length of a step, in coordinates of the search.
    pub step: f64,
    /// Decrease that a step promises, relative to the function.
    pub decrease: f64,
    /// Violation of a constraint that is accepted.
    pub violation: f64,
}

impl Default for Stopping {
    fn default() -> Self {
        Stopping { most_steps: 60, step: 1e-7, decrease: 1e-9, violation: 1e-6 }
    }
}

/// Where a search ended.
#[derive(Clone, PartialEq, Debug)]
pub struct Minimum {
    /// The point.
    pub x: Vec<f64>,
    /// The function and the constraints there.
    pub values: Values,
    /// The multiplier of each constraint: how much the minimum rises as the constraint is tightened by 1.
    pub multipliers: Vec<f64>,
    /// Number of steps.
    pub steps: u32,
    /// No step is worth while, and all constraints hold.
    pub converged: bool,
}

/// First weight of violations.
const FIRST_PENALTY: f64 = 10.0;
/// Greatest weight of violations.
const MOST_PENALTY: f64 = 1e8;
/// Sweeps over the multipliers of a quadratic problem.
const MOST_SWEEPS: u32 = 20_000;
/// Share of the promised decrease that a step must bring.
const ARMIJO: f64 = 1e-4;
/// Times that a step is halved.
const HALVINGS: u32 = 14;
/// Change of the function, relative to it, that counts as noise of its computation.
const NOISE: f64 = 1e-5;

/// Minimises from `start`; none if the values or gradients do not exist there.
pub fn minimize(
    problem: &mut dyn Constrained,
    start: &[f64],
    bounds: &[(f64, f64)],
    stopping: &Stopping,
) -> Option<Minimum> {
    let n = start.len();
    let mut x: Vec<f64> = start.iter().zip(bounds).map(|(x, b)| x.clamp(b.0, b.1)).collect();
    let mut values = problem.values(&x)?;
    let mut slopes = problem.gradients(&x)?;
    let mut matrix = identity(n);
    let mut rho = FIRST_PENALTY;
    let mut multipliers = vec![0.0; values.c.len()];
    let (mut steps, mut converged, mut is_fresh) = (0, false, true);
    while steps < stopping.most_steps {
        let inverse = inverted(n, &matrix).unwrap_or_else(|| identity(n));
        let mut step;
        loop {
            step = quadratic(&inverse, &x, bounds, &values, &slopes, rho);
            let remains =
                step.remaining > 0.5 * values.violation() && step.remaining > stopping.violation;
            if !remains || rho >= MOST_PENALTY {
                break;
            }
            rho *= 10.0;
        }
        multipliers.clone_from(&step.multipliers);
        let violation = values.violation();
        let promised = dot(&slopes.f, &step.d) + rho * (step.sum - positive_sum(&values.c));
        let length = step.d.iter().fold(0.0_f64, |a, d| a.max(d.abs()));
        let scale = 1.0_f64.max(values.f.abs());
        if length <= stopping.step || -promised <= stopping.decrease * scale {
            converged = violation <= stopping.violation;
            break;
        }
        let before = values.penalty(rho);
        let mut share = 1.0;
        let mut next = None;
        for _ in 0..HALVINGS {
            let tried: Vec<f64> = x
                .iter()
                .zip(&step.d)
                .zip(bounds)
                .map(|((x, d), b)| (x + share * d).clamp(b.0, b.1))
                .collect();
            if let Some(found) = problem.values(&tried)
                && found.penalty(rho) <= before + ARMIJO * share * promised
                && let Some(gradients) = problem.gradients(&tried)
            {
                next = Some((tried, found, gradients));
                break;
            }
            share *= 0.5;
        }
        let Some((tried, found, gradients)) = next else {
            if is_fresh {
                // No direction leads down: what is promised is within the noise of the values, or nothing helps.
                converged = violation <= stopping.violation && -promised <= NOISE * scale;
                break;
            }
            matrix = identity(n);
            is_fresh = true;
            continue;
        };
        steps += 1;
        is_fresh = false;
        let s: Vec<f64> = tried.iter().zip(&x).map(|(a, b)| a - b).collect();
        let lagrangian = |g: &Gradients, k: usize| {
            let of_constraints = g.c.iter().zip(&multipliers).map(|(c, m)| c[k] * m);
            g.f[k] + of_constraints.sum::<f64>()
        };
        let y: Vec<f64> =
            (0..n).map(|k| lagrangian(&gradients, k) - lagrangian(&slopes, k)).collect();
        update(n, &mut matrix, &s, y);
        (x, values, slopes) = (tried, found, gradients);
        if !problem.accepts_step(steps, &x, &values) {
            break;
        }
    }
    Some(Minimum { x, values, multipliers, steps, converged })
}

/// A step and what it leaves of the linear constraints.
struct Step {
    d: Vec<f64>,
    multipliers: Vec<f64>,
    /// Largest violation, and sum of all.
    remaining: f64,
    sum: f64,
}

/// Minimises `g d + d B d / 2 + rho sum(max(0, c + a d))` in the box; `inverse` is that of `B`.
fn quadratic(
    inverse: &[f64],
    x: &[f64],
    bounds: &[(f64, f64)],
    values: &Values,
    slopes: &Gradients,
    rho: f64,
) -> Step {
    let n = x.len();
    let times = |row: &[f64]| -> Vec<f64> {
        (0..n).map(|i| (0..n).map(|j| inverse[j * n + i] * row[j]).sum()).collect()
    };
    // Rows `a d <= b` with `H a`, the curvature `a H a` and the greatest multiplier.
    let mut rows: Vec<(Vec<f64>, f64, Vec<f64>, f64, f64)> = Vec::new();
    let mut add = |row: Vec<f64>, limit: f64, most: f64| {
        let of = times(&row);
        let curvature = dot(&row, &of);
        rows.push((row, limit, of, curvature, most));
    };
    for (c, a) in values.c.iter().zip(&slopes.c) {
        add(a.clone(), -c, rho);
    }
    for (k, b) in bounds.iter().enumerate() {
        let unit = |sign: f64| (0..n).map(|j| if j == k { sign } else { 0.0 }).collect();
        add(unit(1.0), b.1 - x[k], f64::INFINITY);
        add(unit(-1.0), x[k] - b.0, f64::INFINITY);
    }
    let mut d: Vec<f64> = times(&slopes.f).into_iter().map(|v| -v).collect();
    let mut multipliers = vec![0.0_f64; rows.len()];
    for _ in 0..MOST_SWEEPS {
        let mut moved = 0.0_f64;
        for ((row, limit, of, curvature, most), m) in rows.iter().zip(&mut multipliers) {
            if *curvature <= 0.0 {
                continue;
            }
            let wanted = (*m + (dot(row, &d) - limit) / curvature).clamp(0.0, *most);
            let change = wanted - *m;
            if change != 0.0 {
                *m = wanted;
                for (d, h) in d.iter_mut().zip(of) {
                    *d -= change * h;
                    moved = moved.max((change * h).abs());
                }
            }
        }
        if moved < 1e-13 {
            break;
        }
    }
    let left: Vec<f64> = values.c.iter().zip(&slopes.c).map(|(c, a)| c + dot(a, &d)).collect();
    multipliers.truncate(left.len());
    let remaining = left.iter().fold(0.0_f64, |a, c| a.max(*c));
    Step { remaining, sum: positive_sum(&left), multipliers, d }
}

/// Powell's damped update of the matrix of the quadratic model.
fn update(n: usize, matrix: &mut [f64], s: &[f64], mut y: Vec<f64>) {
    let bs: Vec<f64> = (0..n).map(|i| (0..n).map(|j| matrix[j * n + i] * s[j]).sum()).collect();
    let (curvature, along) = (dot(s, &bs), dot(s, &y));
    if curvature <= 0.0 {
        return;
    }
    if along < 0.2 * curvature {
        let theta = 0.8 * curvature / (curvature - along);
        for (y, b) in y.iter_mut().zip(&bs) {
            *y = theta * *y + (1.0 - theta) * b;
        }
    }
    let along = dot(s, &y);
    for i in 0..n {
        for j in 0..n {
            matrix[j * n + i] += y[i] * y[j] / along - bs[i] * bs[j] / curvature;
        }
    }
}

fn identity(n: usize) -> Vec<f64> {
    (0..n * n).map(|k| if k / n == k % n { 1.0 } else { 0.0 }).collect()
}

fn inverted(n: usize, matrix: &[f64]) -> Option<Vec<f64>> {
    let (mut factors, mut pivots) = (matrix.to_vec(), vec![0; n]);
    small_lu::factor(n, &mut factors, &mut pivots).ok()?;
    let mut inverse = identity(n);
    for column in inverse.chunks_exact_mut(n) {
        small_lu::solve(n, &factors, &pivots, column);
    }
    inverse.iter().all(|x| x.is_finite()).then_some(inverse)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn positive_sum(c: &[f64]) -> f64 {
    c.iter().map(|c| c.max(0.0)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A function with constraints in closed form.
    struct Closed<F, G>(F, G);

    impl<F: Fn(&[f64]) -> (f64, Vec<f64>), G: Fn(&[f64]) -> (Vec<f64>, Vec<Vec<f64>>)> Constrained
        for Closed<F, G>
    {
        fn values(&mut self, x: &[f64]) -> Option<Values> {
            let (f, c) = (self.0)(x);
            Some(Values { f, c })
        }
        fn gradients(&mut self, x: &[f64]) -> Option<Gradients> {
            let (f, c) = (self.1)(x);
            Some(Gradients { f, c })
        }
    }

    fn near(found: &[f64], expected: &[f64], tolerance: f64) {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() <= tolerance, "{found:?} instead of {expected:?}");
        }
    }

    /// Problem 43 of W. Hock, K. Schittkowski, *Test Examples for Nonlinear Programming Codes*, 1981 (Rosen and Suzuki).
    #[test]
    fn the_problem_of_rosen_and_suzuki() {
        let mut problem = Closed(
            |x: &[f64]| {
                let [a, b, c, d] = [x[0], x[1], x[2], x[3]];
                let f =
                    a * a + b * b + 2.0 * c * c + d * d - 5.0 * a - 5.0 * b - 21.0 * c + 7.0 * d;
                let g = vec![
                    a * a + b * b + c * c + d * d + a - b + c - d - 8.0,
                    a * a + 2.0 * b * b + c * c + 2.0 * d * d - a - d - 10.0,
                    2.0 * a * a + b * b + c * c + 2.0 * a - b - d - 5.0,
                ];
                (f, g)
            },
            |x: &[f64]| {
                let [a, b, c, d] = [x[0], x[1], x[2], x[3]];
                let f = vec![2.0 * a - 5.0, 2.0 * b - 5.0, 4.0 * c - 21.0, 2.0 * d + 7.0];
                let g = vec![
                    vec![2.0 * a + 1.0, 2.0 * b - 1.0, 2.0 * c + 1.0, 2.0 * d - 1.0],
                    vec![2.0 * a - 1.0, 4.0 * b, 2.0 * c, 4.0 * d - 1.0],
                    vec![4.0 * a + 2.0, 2.0 * b - 1.0, 2.0 * c, -1.0],
                ];
                (f, g)
            },
        );
        let bounds = [(-10.0, 10.0); 4];
        let found = minimize(&mut problem, &[0.0; 4], &bounds, &Stopping::default());
        let found = found.expect("it has values everywhere");
        assert!(found.converged, "{found:?}");
        near(&found.x, &[0.0, 1.0, 2.0, -1.0], 1e-4);
        near(&[found.values.f], &[-44.0], 1e-6);
        near(&found.multipliers, &[1.0, 0.0, 2.0], 1e-3);
    }

    /// Rosenbrock's valley with a bound across it: the minimum is at the bound, on the parabola.
    #[test]
    fn a_bound_holds_the_minimum() {
        let mut problem = Closed(
            |x: &[f64]| (100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2), vec![]),
            |x: &[f64]| {
                let r = x[1] - x[0] * x[0];
                (vec![-400.0 * x[0] * r - 2.0 * (1.0 - x[0]), 200.0 * r], vec![])
            },
        );
        let bounds = [(-2.0, 0.5), (-2.0, 2.0)];
        let found = minimize(&mut problem, &[-1.2, 1.0], &bounds, &Stopping::default());
        let found = found.expect("it has values everywhere");
        near(&found.x, &[0.5, 0.25], 1e-5);
        assert!(found.converged, "{found:?}");
    }

    /// Constraints that contradict each other end where their violation is least, and the search says so.
    #[test]
    fn contradictory_constraints_do_not_converge() {
        let mut problem = Closed(
            |x: &[f64]| (x[0], vec![1.0 - x[0], x[0] + 1.0]),
            |_: &[f64]| (vec![1.0], vec![vec![-1.0], vec![1.0]]),
        );
        let found = minimize(&mut problem, &[0.3], &[(-5.0, 5.0)], &Stopping::default());
        let found = found.expect("it has values everywhere");
        assert!(!found.converged && found.values.violation() >= 1.0, "{found:?}");
    }
}
