//! Bound-constrained nonlinear least squares by the normal equations.
//!
//! D. W. Marquardt, *An algorithm for least-squares estimation of nonlinear parameters*, SIAM J.
//! Appl. Math. 11 (1963), with the scaling and the update of J. J. Moré, *The Levenberg-Marquardt
//! algorithm* (1978), and the damping of H. B. Nielsen, *Damping parameter in Marquardt's method*
//! (1999). A parameter at its bound stays there while the gradient pushes it outwards (projected
//! Newton: D. P. Bertsekas 1982). Residuals arrive as sums over all data, so `J` itself is never
//! stored.

use super::linear::DenseLu;

/// `gram = J^T J`, `gradient = J^T r` and `cost = r^T r` of residuals `r` at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalEquations {
    /// Number of parameters.
    pub n: usize,
    /// Column-major, symmetric.
    pub gram: Vec<f64>,
    /// Half the gradient of the cost.
    pub gradient: Vec<f64>,
    /// Sum of squares.
    pub cost: f64,
}

impl NormalEquations {
    /// The sums over no residuals.
    pub fn new(n: usize) -> Self {
        NormalEquations { n, gram: vec![0.0; n * n], gradient: vec![0.0; n], cost: 0.0 }
    }

    /// The decrease of the cost by a step whose damping is this share of the diagonal: an honest one even
    /// where the linearised residuals would promise everything by a step that is far too long. `None` if
    /// no step can be computed.
    pub fn decrease(&self, damping: f64) -> Option<f64> {
        let n = self.n;
        let mut matrix = self.gram.clone();
        for k in 0..n {
            let own = matrix[k + n * k];
            matrix[k + n * k] = if own > 0.0 { own * (1.0 + damping) } else { 1.0 };
        }
        let mut lu = DenseLu::new(n);
        lu.factor(&matrix).ok()?;
        let mut step: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        lu.solve_in_place(&mut step);
        Some((self.cost - self.after(&step)).clamp(0.0, self.cost))
    }

    /// The cost after a step, as the linearised residuals have it.
    pub fn after(&self, step: &[f64]) -> f64 {
        let n = self.n;
        let mut cost = self.cost;
        for j in 0..n {
            let product: f64 = (0..n).map(|i| self.gram[i + n * j] * step[i]).sum();
            cost += step[j] * (2.0 * self.gradient[j] + product);
        }
        cost
    }

    /// Adds one residual with its derivatives with respect to the parameters.
    pub fn add(&mut self, residual: f64, slopes: &[f64]) {
        self.cost += residual * residual;
        for (j, a) in slopes.iter().enumerate() {
            if *a == 0.0 {
                continue;
            }
            self.gradient[j] += a * residual;
            let column = &mut self.gram[j * self.n..j * self.n + self.n];
            for (g, b) in column.iter_mut().zip(slopes) {
                *g += a * b;
            }
        }
    }

    /// True if all sums are finite.
    pub fn is_finite(&self) -> bool {
        let all = self.gram.iter().chain(&self.gradient);
        self.cost.is_finite() && all.copied().all(f64::is_finite)
    }

    /// Adds the sums of other data.
    pub fn merge(&mut self, other: &NormalEquations) {
        self.cost += other.cost;
        self.gram.iter_mut().zip(&other.gram).for_each(|(a, b)| *a += b);
        self.gradient.iter_mut().zip(&other.gradient).for_each(|(a, b)| *a += b);
    }
}

/// The residuals whose sum of squares is minimized.
pub trait Residuals {
    /// The sums at `x`; `None` if they cannot be computed there.
    fn normal(&mut self, x: &[f64]) -> Option<NormalEquations>;

    /// The sum of squares at `x`; `None` if it cannot be computed there.
    fn cost(&mut self, x: &[f64]) -> Option<f64>;

    /// Called after each accepted step; returning false ends the search.
    fn accepts_step(&mut self, _iteration: u32, _x: &[f64], _cost: f64) -> bool {
        true
    }
}

/// Stopping criteria.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Stopping {
    /// Predicted relative decrease of the cost below which the search has converged.
    pub decrease: f64,
    /// Largest change of a parameter below which the search has converged.
    pub step: f64,
    /// Maximum number of steps.
    pub iterations: u32,
    /// Largest change of a parameter in one step.
    pub reach: f64,
    /// Measures the sizes of parameters that have none of their own, and lets steps grow while the residuals are as linear
    /// as predicted.
    pub by_data: bool,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// The parameters.
    pub x: Vec<f64>,
    /// The sums there.
    pub normal: NormalEquations,
    /// Steps taken.
    pub iterations: u32,
    /// True if the search met a convergence criterion.
    pub converged: bool,
    /// If the search ended at a jump of the cost: a point beyond it, in the direction of descent.
    pub beyond: Option<Vec<f64>>,
}

/// Damping at which steps become negligible.
const MAX_DAMPING: f64 = 1e12;
/// An increase of the cost beyond this multiple of the predicted decrease counts as a jump.
const JUMP: f64 = 1.0;
/// Steps next to a jump that are at most this long count as creeping.
const CREEPING: f64 = 1e-2;
/// Number of successive creeping steps after which the search stops.
const MAX_CREEPING_STEPS: u32 = 3;

/// Relative difference of the decrease of the cost from the predicted one up to which the residuals count as linear.
const LINEAR: f64 = 0.1;
/// Factor by which the largest step then grows.
const LONGER: f64 = 4.0;
/// Range of a parameter above which its coordinate says nothing of its size.
const WIDE: f64 = 1e3;

/// Searches for a minimum from `x`, each parameter within its bounds. `None` if the residuals
/// cannot be computed at the start.
pub fn minimize(
    residuals: &mut dyn Residuals,
    x: &[f64],
    bounds: &[(f64, f64)],
    stopping: &Stopping,
) -> Option<Minimum> {
    let n = x.len();
    let mut x: Vec<f64> = x.iter().zip(bounds).map(|(x, b)| x.max(b.0).min(b.1)).collect();
    let mut normal = residuals.normal(&x).filter(NormalEquations::is_finite)?;
    let units = match stopping.by_data {
        true => units(&normal, &x, bounds),
        false => vec![1.0; n],
    };
    let mut reach = stopping.reach;
    let mut damping = 1e-3;
    let mut growth = 2.0;
    let mut iterations = 0;
    let mut converged = n == 0;
    let mut beyond = None;
    let mut crept = 0;
    while iterations < stopping.iterations && !converged {
        iterations += 1;
        let free = free(&x, &normal.gradient, bounds);
        let mut accepted = None;
        let (mut jumps, mut length) = (0, 0.0);
        while accepted.is_none() {
            let Some(mut moved) = step(&normal, &free, damping, &x, bounds, &units) else {
                damping = damping.max(1e-12) * 10.0;
                if damping > MAX_DAMPING {
                    break;
                }
                continue;
            };
            let longest =
                moved.iter().zip(&units).fold(0.0f64, |m, (s, unit)| m.max(s.abs() / unit));
            let promised = predicted(&normal, &moved);
            let is_cut = longest > reach;
            if is_cut {
                moved.iter_mut().for_each(|s| *s *= reach / longest);
            }
            let trial: Vec<f64> = x.iter().zip(&moved).map(|(x, m)| x + m).collect();
            let predicted = predicted(&normal, &moved);
            let is_small = longest.min(reach) <= stopping.step;
            let decrease = if stopping.by_data { promised } else { predicted };
            if is_small || decrease <= stopping.decrease * normal.cost {
                converged = true;
                break;
            }
            let cost = residuals.cost(&trial).filter(|c| c.is_finite());
            let ratio = cost.map_or(-1.0, |c| (normal.cost - c) / predicted);
            if ratio > 1e-4 {
                damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).max(1.0 / 3.0);
                growth = 2.0;
                length = longest.min(reach);
                // Where the residuals turn out to be as linear as predicted, the next step may be longer.
                if stopping.by_data && is_cut && (ratio - 1.0).abs() < LINEAR {
                    reach *= LONGER;
                }
                accepted = Some(trial);
            } else {
                reach = stopping.reach.max(reach / LONGER);
                if ratio < -JUMP && cost.is_some() {
                    jumps += 1;
                    beyond = Some(trial);
                }
                damping *= growth;
                growth *= 2.0;
                if damping > MAX_DAMPING {
                    converged = true;
                    break;
                }
            }
        }
        crept = if jumps > 0 && length < CREEPING { crept + 1 } else { 0 };
        if jumps == 0 {
            beyond = None;
        }
        let Some(trial) = accepted else { break };
        let Some(next) = residuals.normal(&trial).filter(NormalEquations::is_finite) else { break };
        (x, normal) = (trial, next);
        if !residuals.accepts_step(iterations, &x, normal.cost) || crept >= MAX_CREEPING_STEPS {
            break;
        }
    }
    Some(Minimum { x, normal, iterations, converged, beyond })
}

/// The change of each parameter that counts as large. It is 1 for parameters whose coordinates are scaled. One that starts
/// at zero, or anywhere between bounds far apart, has no size of its own: there it is the change that would
/// alone make up for all residuals.
fn units(normal: &NormalEquations, x: &[f64], bounds: &[(f64, f64)]) -> Vec<f64> {
    let unit = |i: usize| {
        let range = bounds[i].1 - bounds[i].0;
        let gram = normal.gram[i + normal.n * i];
        let size = (normal.cost / gram).sqrt();
        if !size.is_finite() || size == 0.0 {
            1.0
        } else if x[i] == 0.0 {
            size.min(0.25 * range)
        } else if range > WIDE && range.is_finite() {
            size.min(0.25 * range).max(1.0)
        } else {
            1.0
        }
    };
    (0..x.len()).map(unit).collect()
}

/// Parameters that the gradient does not push beyond a bound.
fn free(x: &[f64], gradient: &[f64], bounds: &[(f64, f64)]) -> Vec<usize> {
    let held = |i: &usize| {
        (x[*i] <= bounds[*i].0 && gradient[*i] > 0.0)
            || (x[*i] >= bounds[*i].1 && gradient[*i] < 0.0)
    };
    (0..x.len()).filter(|i| !held(i)).collect()
}

/// Solves `(G + damping diag G) step = -gradient` for the free parameters. A parameter that would
/// cross its bound moves to the bound, and the system is solved again for the others.
fn step(
    normal: &NormalEquations,
    free: &[usize],
    damping: f64,
    x: &[f64],
    bounds: &[(f64, f64)],
    units: &[f64],
) -> Option<Vec<f64>> {
    let n = normal.n;
    let scaled = |i: usize| normal.gram[i * n + i] * units[i] * units[i];
    let largest = (0..n).map(scaled).fold(0.0, f64::max);
    let mut step = vec![0.0; n];
    let mut free = free.to_vec();
    while !free.is_empty() {
        let m = free.len();
        let mut matrix = vec![0.0; m * m];
        let mut right = vec![0.0; m];
        for (a, &i) in free.iter().enumerate() {
            for (b, &j) in free.iter().enumerate() {
                matrix[a + m * b] = normal.gram[i + n * j];
            }
            // Parameters that the data do not determine must not diverge.
            matrix[a + m * a] +=
                damping * normal.gram[i + n * i].max(1e-12 * largest / (units[i] * units[i]));
            let from_fixed: f64 = (0..n)
                .filter(|j| !free.contains(j))
                .map(|j| normal.gram[i + n * j] * step[j])
                .sum();
            right[a] = -normal.gradient[i] - from_fixed;
        }
        let mut lu = DenseLu::new(m);
        lu.factor(&matrix).ok()?;
        lu.solve_in_place(&mut right);
        if right.iter().any(|s| !s.is_finite()) {
            return None;
        }
        let mut inside = Vec::with_capacity(m);
        for (s, &i) in right.iter().zip(&free) {
            let (low, high) = (bounds[i].0 - x[i], bounds[i].1 - x[i]);
            if (low..=high).contains(s) {
                inside.push(i);
            } else {
                step[i] = s.max(low).min(high);
            }
        }
        if inside.len() == m {
            for (s, &i) in right.iter().zip(&free) {
                step[i] = *s;
            }
            break;
        }
        free = inside;
    }
    Some(step)
}

/// Decrease of the cost predicted by the linearized residuals.
fn predicted(normal: &NormalEquations, moved: &[f64]) -> f64 {
    let n = normal.n;
    let mut sum = 0.0;
    for j in 0..n {
        let product: f64 = (0..n).map(|i| normal.gram[i + n * j] * moved[i]).sum();
        sum -= moved[j] * (2.0 * normal.gradient[j] + product);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOPPING: Stopping =
        Stopping { decrease: 1e-14, step: 1e-12, iterations: 200, reach: 10.0, by_data: true };

    struct Rosenbrock;

    impl Residuals for Rosenbrock {
        fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
            let mut normal = NormalEquations::new(2);
            normal.add(10.0 * (x[1] - x[0] * x[0]), &[-20.0 * x[0], 10.0]);
            normal.add(1.0 - x[0], &[-1.0, 0.0]);
            Some(normal)
        }
        fn cost(&mut self, x: &[f64]) -> Option<f64> {
            self.normal(x).map(|n| n.cost)
        }
    }

    /// `x - 3` with no damping leaves nothing; the step with damping 1 is half as long, and leaves a quarter.
    #[test]
    fn a_damped_step_gains_less() {
        let mut normal = NormalEquations::new(1);
        normal.add(-3.0, &[1.0]);
        assert!((normal.decrease(0.0).unwrap() - 9.0).abs() < 1e-12);
        assert!((normal.decrease(1.0).unwrap() - 6.75).abs() < 1e-12);
    }

    #[test]
    fn finds_the_minimum_of_rosenbrock() {
        let free = [(f64::NEG_INFINITY, f64::INFINITY); 2];
        let found = minimize(&mut Rosenbrock, &[-1.2, 1.0], &free, &STOPPING).unwrap();
        assert!(found.converged);
        assert!((found.x[0] - 1.0).abs() < 1e-8 && (found.x[1] - 1.0).abs() < 1e-8, "{found:?}");
    }

    /// A straight line `a + b t` through exact data, from zero, in units that differ by up to 16 powers of ten.
    struct Line(f64, f64);

    impl Residuals for Line {
        fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
            let mut normal = NormalEquations::new(2);
            for i in 0..11 {
                let t = 0.1 * i as f64;
                normal.add(x[0] + x[1] * t - self.0 - self.1 * t, &[1.0, t]);
            }
            Some(normal)
        }
        fn cost(&mut self, x: &[f64]) -> Option<f64> {
            self.normal(x).map(|n| n.cost)
        }
    }

    #[test]
    fn a_line_is_found_whatever_its_unit() {
        let stopping =
            Stopping { decrease: 1e-7, step: 1e-7, iterations: 60, reach: 1.0, by_data: true };
        let free = [(f64::NEG_INFINITY, f64::INFINITY); 2];
        let wide = [(-1e10, 1e10); 2];
        for (a, b) in [(1e-8, -3e-8), (1e8, -3e8), (2.0, 5e5), (1e-6, 1e3)] {
            for (start, bounds) in [(0.0, free), (1.0, free), (0.0, wide), (1.0, wide)] {
                let found = minimize(&mut Line(a, b), &[start; 2], &bounds, &stopping).unwrap();
                // A start of 1 says that 1e-7 is little.
                let least = if start == 1.0 { 1e-6 } else { 0.0 };
                let near =
                    |x: f64, y: f64| (x - y).abs() < (1e-2 * a.abs().max(b.abs())).max(least);
                assert!(
                    found.converged && near(found.x[0], a) && near(found.x[1], b),
                    "{a} {b} from {start}: {found:?}"
                );
            }
        }
    }

    /// With `x0 <= 0.5` the least value lies at `(0.5, 0.25)`.
    #[test]
    fn stops_at_a_bound_and_continues_along_it() {
        let bounds = [(-2.0, 0.5), (-2.0, 2.0)];
        let found = minimize(&mut Rosenbrock, &[-1.2, 1.0], &bounds, &STOPPING).unwrap();
        assert_eq!(found.x[0], 0.5);
        assert!((found.x[1] - 0.25).abs() < 1e-8, "{found:?}");
    }

    /// A slope with an upward step, which continues beyond it.
    struct Terraces;

    impl Residuals for Terraces {
        fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
            let mut normal = NormalEquations::new(1);
            normal.add(x[0] - 5.0, &[1.0]);
            normal.cost += if x[0] > 1.0 { 100.0 } else { 0.0 };
            Some(normal)
        }
        fn cost(&mut self, x: &[f64]) -> Option<f64> {
            self.normal(x).map(|n| n.cost)
        }
    }

    #[test]
    fn a_search_that_ends_at_a_jump_returns_a_point_beyond() {
        let free = [(f64::NEG_INFINITY, f64::INFINITY)];
        let found = minimize(&mut Terraces, &[0.0], &free, &STOPPING).unwrap();
        assert!(found.x[0] <= 1.0 && found.x[0] > 0.5, "{found:?}");
        assert!(found.beyond.unwrap()[0] > 1.0);
        assert!(minimize(&mut Terraces, &[2.0], &free, &STOPPING).unwrap().beyond.is_none());
    }

    /// A cost that decreases towards a point where its slope is NaN.
    struct Cliff;

    impl Residuals for Cliff {
        fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
            let mut normal = NormalEquations::new(2);
            normal.add(x[0], &[if x[0] < 0.5 { f64::NAN } else { 1.0 }, 0.0]);
            Some(normal)
        }
        fn cost(&mut self, x: &[f64]) -> Option<f64> {
            Some(x[0] * x[0])
        }
    }

    #[test]
    fn slopes_that_are_nan_end_the_search() {
        let free = [(f64::NEG_INFINITY, f64::INFINITY); 2];
        assert!(minimize(&mut Cliff, &[0.0, 0.0], &free, &STOPPING).is_none());
        let found = minimize(&mut Cliff, &[1.0, 0.0], &free, &STOPPING).unwrap();
        assert!(!found.converged && found.normal.is_finite(), "{found:?}");
    }

    /// A decay `a exp(-k t)` from exact data; trials far away cannot be computed.
    struct Decay;

    impl Residuals for Decay {
        fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
            let mut normal = NormalEquations::new(3);
            for i in 0..20 {
                let t = 0.1 * i as f64;
                let e = (-x[1] * t).exp();
                normal.add(x[0] * e - 2.0 * (-1.5 * t).exp(), &[e, -x[0] * t * e, 0.0]);
            }
            (x[1] < 4.0).then_some(normal)
        }
        fn cost(&mut self, x: &[f64]) -> Option<f64> {
            self.normal(x).map(|n| n.cost)
        }
    }

    /// The third parameter affects nothing and stays.
    #[test]
    fn finds_a_rate_next_to_a_parameter_without_effect() {
        let free = [(f64::NEG_INFINITY, f64::INFINITY); 3];
        let found = minimize(&mut Decay, &[0.3, 3.5, 7.0], &free, &STOPPING).unwrap();
        assert!((found.x[0] - 2.0).abs() < 1e-7 && (found.x[1] - 1.5).abs() < 1e-7, "{found:?}");
        assert_eq!(found.x[2], 7.0);
    }
}
