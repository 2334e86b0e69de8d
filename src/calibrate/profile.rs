//! Confidence intervals from likelihood profiles.
//!
//! One parameter is moved while the others are fitted again: the interval ends where the sum of squares has
//! grown by the quantile of chi-square (D. M. Bates, D. G. Watts, *Nonlinear Regression
//! Analysis and Its Applications*, 1988, section 6.1; W. Q. Meeker, L. A. Escobar, *Teaching about
//! approximate confidence regions based on maximum likelihood estimation*, The American Statistician 49,
//! 1995). Unlike standard errors, they account for curvature and bounds. The root of the growth is nearly
//! linear, so one or two differentiated runs of the recordings locate an end: the first point is where the
//! quadratic prediction puts it, and the gradient there gives what the other parameters can still gain.

use crate::numeric::least_squares::NormalEquations;
use crate::numeric::linear::DenseLu;

use super::fit::Fit;
use super::policy::FitPolicy;
use super::problem::Problem;
use super::statistics::Statistics;

/// The root of 3.84, the 95 % quantile of chi-square with one degree of freedom.
const ROOT: f64 = 1.959_963_984_540_054;

/// How an end of an interval was found.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum End {
    /// On the profile.
    Profile,
    /// From the standard error: no profile was requested, or it could not be followed.
    Quadratic,
    /// The bound of the parameter: the data do not limit it further.
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

/// The intervals of all parameters, or a better minimum that a profile ran into.
#[derive(Clone, PartialEq, Debug)]
pub enum Profiles {
    /// The intervals.
    Intervals(Vec<Interval>),
    /// Parameters, in coordinates of the search, at which the data fit better.
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

/// Follows the profiles of all parameters. `goes_on` is called before each; once it returns `false`, the
/// remaining intervals come from the standard errors.
pub fn profile(
    problem: &Problem<'_>,
    policy: &FitPolicy,
    fit: &Fit,
    statistics: &Statistics,
    goes_on: &mut dyn FnMut(usize) -> bool,
) -> Profiles {
    let mut intervals = quadratic(problem, fit, statistics);
    for (i, place) in intervals.iter_mut().enumerate() {
        // A parameter of a single recording is not worth the runs of all.
        if !statistics.spreads[i].is_finite() || problem.parameters[i].only.is_some() {
            continue;
        }
        if !goes_on(i) {
            break;
        }
        let mut ways = [0.0; 2];
        let mut ends = [End::Profile; 2];
        for (k, sign) in [-1.0, 1.0].into_iter().enumerate() {
            match end_of_profile(problem, policy, (fit, statistics), i, sign) {
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

/// Distance to the bound.
fn limit(problem: &Problem<'_>, fit: &Fit, i: usize, sign: f64) -> f64 {
    let (low, high) = problem.parameters[i].range();
    if sign < 0.0 { fit.x[i] - low } else { high - fit.x[i] }.max(0.0)
}

enum Side {
    /// Distance to the end.
    End(f64, End),
    /// A better minimum.
    Better(Vec<f64>),
}

/// Locates one end of one interval.
fn end_of_profile(
    problem: &Problem<'_>,
    policy: &FitPolicy,
    (fit, s): (&Fit, &Statistics),
    i: usize,
    sign: f64,
) -> Side {
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
    // Change of each other parameter per unit of this one.
    let variance = s.covariance[i + n * i];
    let mut direction: Vec<f64> = (0..n)
        .map(|j| if others.contains(&j) { s.covariance[j + n * i] / variance * sign } else { 0.0 })
        .map(|c| if c.is_finite() { c } else { 0.0 })
        .collect();
    direction[i] = sign;
    let mut way = by_itself.min(limit).min(policy.profile_reach);
    if way <= 0.0 {
        return Side::End(limit, End::Bound);
    }
    for _ in 0..policy.profile_runs {
        let point = |direction: &[f64]| -> Vec<f64> {
            let moved = fit.x.iter().zip(direction).map(|(x, c)| x + way * c);
            moved.zip(&bounds).map(|(x, b)| x.max(b.0).min(b.1)).collect()
        };
        let x = point(&direction);
        let Ok(normal) = problem.normal(&x) else { return roughly };
        if normal.cost < fit.normal.cost - policy.profile_improvement {
            return Side::Better(x);
        }
        let (step, gain) = follow(&normal, &others);
        // Towards their own minimum.
        for j in &others {
            direction[*j] = (x[*j] - fit.x[*j] + step[*j].clamp(-0.5, 0.5)) / way;
        }
        let growth = normal.cost - gain - fit.normal.cost;
        if gain > policy.profile_gain && growth < 4.0 * ROOT * ROOT {
            continue;
        }
        let root = growth.max(0.0).sqrt();
        if way >= limit && root < ROOT {
            return Side::End(limit, End::Bound);
        }
        let next = reached(way, root, spread);
        if (root - ROOT).abs() <= policy.profile_precision * ROOT {
            return Side::End(
                next.min(limit),
                if next < limit { End::Profile } else { End::Bound },
            );
        }
        let next = next.clamp(0.2 * way, 3.0 * way).min(limit);
        if next > policy.profile_reach {
            return roughly;
        }
        way = next;
    }
    roughly
}

/// The distance at which `root(way) = way / spread + c way^2` through a known point takes the wanted value.
fn reached(way: f64, root: f64, spread: f64) -> f64 {
    let c = (root - way / spread) / (way * way);
    let slope = 1.0 / spread;
    let discriminant = slope * slope + 4.0 * c * ROOT;
    if discriminant > 0.0 {
        // The root of smaller size, without cancellation.
        2.0 * ROOT / (slope + discriminant.sqrt())
    } else {
        // The parabola has its vertex before that: extrapolate in proportion.
        way * (ROOT / root.max(0.3 * ROOT))
    }
}

/// The step of the other parameters to their minimum, and its gain, by the linearised residuals.
fn follow(normal: &NormalEquations, others: &[usize]) -> (Vec<f64>, f64) {
    let (n, m) = (normal.n, others.len());
    let mut matrix = vec![0.0; m * m];
    for (b, j) in others.iter().enumerate() {
        for (a, k) in others.iter().enumerate() {
            matrix[a + m * b] = normal.gram[k + n * j];
        }
        // Parameters without any influence stay.
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

    /// On a parabola the end is where the standard error puts it; with a quadratic term the interpolation
    /// reproduces the point it was made from.
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
