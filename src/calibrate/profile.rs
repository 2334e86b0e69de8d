//! Intervals of confidence from the profile of the likelihood.
//!
//! One parameter is moved while the others follow to their best: where the sum of squares has grown by
//! the quantile of chi-square, the interval ends (D. M. Bates, D. G. Watts, *Nonlinear Regression
//! Analysis and Its Applications*, 1988, section 6.1; W. Q. Meeker, L. A. Escobar, *Teaching about
//! approximate confidence regions based on maximum likelihood estimation*, The American Statistician 49,
//! 1995). Unlike standard errors, they see curvature and bounds. The root of the growth is nearly a
//! straight line, so one or two differentiated runs of the recordings locate an end: the first point is
//! where the quadratic prediction has it, and the gradient there tells what the others still gain.

use crate::numeric::least_squares::NormalEquations;
use crate::numeric::linear::DenseLu;

use super::fit::Fit;
use super::problem::Problem;
use super::statistics::Statistics;

/// The root of 3.84, the 95 % quantile of chi-square with one degree of freedom.
const ROOT: f64 = 1.959_963_984_540_054;
/// Part of that root at which interpolation is good enough.
const NEAR: f64 = 0.1;
/// What the others may still gain without another run, in units of the sum of squares.
const GAIN: f64 = 0.4;
/// Runs for one end at most.
const RUNS: u32 = 5;
/// Longest way in units of the search.
const REACH: f64 = 2.0;
/// A sum of squares lower by this is a better minimum, not rounding.
const BETTER: f64 = 0.5;

/// How an end of an interval was found.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum End {
    /// On the profile.
    Profile,
    /// From the standard error: the profile was not asked, or could not be followed.
    Quadratic,
    /// The bound of the parameter: the data set no limit before it.
    Bound,
}

impl End {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            End::Profile => "profile",
            End::Quadratic => "quadratic",
            End::Bound => "bound",
        }
    }
}

/// A 95 % interval of a parameter's value, in its unit.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How they were found.
    pub ends: [End; 2],
}

/// The intervals of all parameters, or a better minimum that was met on the way.
#[derive(Clone, PartialEq, Debug)]
pub enum Profiles {
    /// The intervals.
    Intervals(Vec<Interval>),
    /// Parameters, as the search sees them, at which the data fit better.
    Better(Vec<f64>),
}

/// Intervals from the standard errors alone.
pub fn quadratic(problem: &Problem<'_>, fit: &Fit, statistics: &Statistics) -> Vec<Interval> {
    let one = |i: usize| {
        let [(low, a), (high, b)] = [-1.0, 1.0].map(|sign| {
            let (limit, way) = (limit(problem, fit, i, sign), ROOT * statistics.spreads[i]);
            if way < limit { (way, End::Quadratic) } else { (limit, End::Bound) }
        });
        interval(problem, fit, i, [low, high], [a, b])
    };
    (0..fit.x.len()).map(one).collect()
}

/// Follows the profiles of all parameters. `accepts_step` is asked before each; after it said no, the
/// intervals that are left come from the standard errors.
pub fn profile(
    problem: &Problem<'_>,
    fit: &Fit,
    statistics: &Statistics,
    accepts_step: &mut dyn FnMut(usize) -> bool,
) -> Profiles {
    let mut intervals = quadratic(problem, fit, statistics);
    for (i, place) in intervals.iter_mut().enumerate() {
        if !statistics.spreads[i].is_finite() {
            continue;
        }
        if !accepts_step(i) {
            break;
        }
        let mut ways = [0.0; 2];
        let mut ends = [End::Profile; 2];
        for (k, sign) in [-1.0, 1.0].into_iter().enumerate() {
            match side(problem, fit, statistics, i, sign) {
                Side::End(way, end) => (ways[k], ends[k]) = (way, end),
                Side::Better(x) => return Profiles::Better(x),
            }
        }
        *place = interval(problem, fit, i, ways, ends);
    }
    Profiles::Intervals(intervals)
}

fn interval(
    problem: &Problem<'_>,
    fit: &Fit,
    i: usize,
    [below, above]: [f64; 2],
    ends: [End; 2],
) -> Interval {
    let p = &problem.parameters[i];
    let value = |x: f64| p.scale.value(x).max(p.bounds.0).min(p.bounds.1);
    Interval { low: value(fit.x[i] - below), high: value(fit.x[i] + above), ends }
}

/// The way to the bound.
fn limit(problem: &Problem<'_>, fit: &Fit, i: usize, sign: f64) -> f64 {
    let (low, high) = problem.parameters[i].range();
    if sign < 0.0 { fit.x[i] - low } else { high - fit.x[i] }.max(0.0)
}

enum Side {
    /// The way to the end.
    End(f64, End),
    /// A better minimum.
    Better(Vec<f64>),
}

/// Looks for one end of one interval.
fn side(problem: &Problem<'_>, fit: &Fit, s: &Statistics, i: usize, sign: f64) -> Side {
    let n = fit.x.len();
    let limit = limit(problem, fit, i, sign);
    let spread = s.spreads[i];
    let bounds = problem.bounds();
    let others: Vec<usize> = (0..n).filter(|j| *j != i && !s.at_bound[*j]).collect();
    let by_itself = ROOT * spread;
    let roughly = if by_itself < limit {
        Side::End(by_itself, End::Quadratic)
    } else {
        Side::End(limit, End::Bound)
    };
    // Where the others go for each unit that this one goes.
    let variance = s.covariance[i + n * i];
    let mut course: Vec<f64> = (0..n)
        .map(|j| if others.contains(&j) { s.covariance[j + n * i] / variance * sign } else { 0.0 })
        .map(|c| if c.is_finite() { c } else { 0.0 })
        .collect();
    course[i] = sign;
    let mut way = by_itself.min(limit).min(REACH);
    if way <= 0.0 {
        return Side::End(limit, End::Bound);
    }
    for _ in 0..RUNS {
        let place = |course: &[f64]| -> Vec<f64> {
            let moved = fit.x.iter().zip(course).map(|(x, c)| x + way * c);
            moved.zip(&bounds).map(|(x, b)| x.max(b.0).min(b.1)).collect()
        };
        let x = place(&course);
        let Ok(normal) = problem.normal(&x) else { return roughly };
        if normal.cost < fit.normal.cost - BETTER {
            return Side::Better(x);
        }
        let (step, gain) = follow(&normal, &others);
        // Where they would rather be.
        for j in &others {
            course[*j] = (x[*j] - fit.x[*j] + step[*j].clamp(-0.5, 0.5)) / way;
        }
        let growth = normal.cost - gain - fit.normal.cost;
        if gain > GAIN && growth < 4.0 * ROOT * ROOT {
            continue;
        }
        let root = growth.max(0.0).sqrt();
        if way >= limit && root < ROOT {
            return Side::End(limit, End::Bound);
        }
        let next = reached(way, root, spread);
        if (root - ROOT).abs() <= NEAR * ROOT {
            return Side::End(
                next.min(limit),
                if next < limit { End::Profile } else { End::Bound },
            );
        }
        let next = next.clamp(0.2 * way, 3.0 * way).min(limit);
        if next > REACH {
            return roughly;
        }
        way = next;
    }
    roughly
}

/// The way at which `root(way) = way / spread + c way^2` through a known point takes the wanted value.
fn reached(way: f64, root: f64, spread: f64) -> f64 {
    let c = (root - way / spread) / (way * way);
    let slope = 1.0 / spread;
    let discriminant = slope * slope + 4.0 * c * ROOT;
    if discriminant > 0.0 {
        // The root of smaller size, without cancellation.
        2.0 * ROOT / (slope + discriminant.sqrt())
    } else {
        // The parabola turns back before: go on in proportion.
        way * (ROOT / root.max(0.3 * ROOT))
    }
}

/// The step of the others to their best, and what it gains, by the linearised residuals.
fn follow(normal: &NormalEquations, others: &[usize]) -> (Vec<f64>, f64) {
    let (n, m) = (normal.n, others.len());
    let mut matrix = vec![0.0; m * m];
    for (b, j) in others.iter().enumerate() {
        for (a, k) in others.iter().enumerate() {
            matrix[a + m * b] = normal.gram[k + n * j];
        }
        // Where the data say nothing, nothing moves.
        matrix[b + m * b] += 1e-6 * normal.gram[j + n * j] + 1e-3;
    }
    let mut right: Vec<f64> = others.iter().map(|j| -normal.gradient[*j]).collect();
    let mut step = vec![0.0; n];
    let mut lu = DenseLu::new(m);
    if m == 0 || lu.factor(&matrix).is_err() {
        return (step, 0.0);
    }
    lu.solve_in_place(&mut right);
    let mut gain = 0.0;
    for (j, s) in others.iter().zip(&right) {
        step[*j] = *s;
        gain -= s * normal.gradient[*j];
    }
    (step, gain)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a parabola the end is where the standard error says; on a bent one the interpolation meets
    /// the point that it was made from.
    #[test]
    fn the_end_is_interpolated() {
        assert!((reached(1.0, 10.0, 0.1) - 0.1 * ROOT).abs() < 1e-12);
        let bent = |way: f64| way / 0.1 + 3.0 * way * way;
        let way = reached(0.25, bent(0.25), 0.1);
        assert!((bent(way) - ROOT).abs() < 1e-10, "{way}");
    }

    /// `r = (x - y, 2 y - 1)` at `x = 3, y = 0`: the best `y` is `(x + 2) / 5 = 1`, and the sum falls
    /// from 10 to 5.
    #[test]
    fn the_others_follow() {
        let mut normal = NormalEquations::new(2);
        normal.add(3.0, &[1.0, -1.0]);
        normal.add(-1.0, &[0.0, 2.0]);
        let (step, gain) = follow(&normal, &[1]);
        assert!((step[1] - 1.0).abs() < 1e-3 && (gain - 5.0).abs() < 1e-2, "{step:?} {gain}");
    }
}
