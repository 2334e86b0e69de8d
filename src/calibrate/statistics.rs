//! How well the data determine the parameters, from the normal equations at the minimum.
//!
//! Residuals are in units of the sensors' noise, so the covariance is the inverse of `J^T J` (G. A. F.
//! Seber, C. J. Wild, *Nonlinear Regression*, 1989, section 2.1.2). It is not scaled by the residuals,
//! whose reduced sum of squares shows whether the model explains the data. The inverse is computed from
//! eigenvectors: a direction with an eigenvalue below one is not determined, since a change by a factor of e
//! along it (one unit of the search) changes the sum of squares by less than one.

use crate::numeric::eigen;
use crate::numeric::least_squares::NormalEquations;

use super::parameter::{Parameter, Scale};

/// Least eigenvalue of a determined direction.
const DETERMINED: f64 = 1.0;
/// Eigenvalue below which the influence of a direction is within rounding: a thousand factors of e.
const NO_INFLUENCE: f64 = 1e-6;
/// Component above which a parameter takes part in a direction without influence.
const SHARE: f64 = 1e-3;
/// Share of some parameters in the square of an undetermined direction above which it concerns them.
const CONCERNS: f64 = 0.35;
/// Component, relative to the largest, above which a parameter is named with a direction.
const NAMED: f64 = 0.1;

/// How well the data determine the parameters.
#[derive(Clone, PartialEq, Debug)]
pub struct Statistics {
    /// Covariance in the coordinates of the search, column-major; zero in the rows of parameters at a bound,
    /// infinite on the diagonal of those without influence.
    pub covariance: Vec<f64>,
    /// Standard error of each parameter's value, in its unit.
    pub errors: Vec<f64>,
    /// The same in the coordinates of the search.
    pub spreads: Vec<f64>,
    /// The parameter is at a bound, and the data push it there.
    pub at_bound: Vec<bool>,
    /// The data do not determine the parameter: its standard error is above a factor of e.
    pub undetermined: Vec<bool>,
    /// The undetermined directions, in words.
    pub directions: Vec<String>,
}

impl Statistics {
    /// At the minimum `x` with its normal equations.
    pub fn new(normal: &NormalEquations, parameters: &[Parameter], x: &[f64]) -> Statistics {
        let n = parameters.len();
        let at_bound = at_bound(normal, parameters, x);
        let free: Vec<usize> = (0..n).filter(|i| !at_bound[*i]).collect();
        // What is determined is decided in parts of the values: one that began at zero may have grown far beyond its size.
        let units: Vec<f64> = parameters.iter().zip(x).map(|(p, x)| unit(p, *x)).collect();
        let scaled = &in_units(normal, &units);
        let (covariance, spreads) = spreads(scaled, &units, &at_bound, &|_, _| true);
        let values = parameters.iter().zip(x).map(|(p, x)| p.scale.slope(p.scale.value(*x)));
        let errors = values.zip(&spreads).map(|(slope, s)| slope.abs() * s).collect();
        let wide = |(s, unit): (&f64, &f64)| (s / unit).powi(2) > 1.0 / DETERMINED;
        let undetermined = spreads.iter().zip(&units).map(wide).collect();
        let directions = directions(scaled, &free)
            .into_iter()
            .filter(|(value, _)| *value < DETERMINED)
            .map(|(_, v)| in_words(parameters, x, &v))
            .collect();
        Statistics { covariance, errors, spreads, at_bound, undetermined, directions }
    }

    /// The covariance of the parameters' values, in their units, row by row.
    pub fn covariance_of(&self, parameters: &[Parameter], values: &[f64]) -> Vec<f64> {
        let slopes = parameters.iter().zip(values).map(|(p, v)| p.scale.slope(*v));
        let slopes: Vec<f64> = slopes.collect();
        let n = slopes.len();
        (0..n * n).map(|k| self.covariance[k] * slopes[k / n] * slopes[k % n]).collect()
    }

    /// The correlation of two parameters; zero for one at a bound or without influence.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        let n = self.spreads.len();
        let variance = |k: usize| self.covariance[k + n * k];
        let rho = self.covariance[i + n * j] / (variance(i) * variance(j)).sqrt();
        match (i == j, rho.is_finite()) {
            (true, _) => 1.0,
            (_, true) => rho.clamp(-1.0, 1.0),
            (_, false) => 0.0,
        }
    }
}

/// Standard errors of the parameters' values, in their units; infinite where the data do not determine them.
pub fn standard_errors(normal: &NormalEquations, parameters: &[Parameter], x: &[f64]) -> Vec<f64> {
    Statistics::new(normal, parameters, x).errors
}

/// The same of some parameters beside all others, `is_own`, without the undetermined directions that concern the others. Where
/// only potentials are measured and prescribed, all capacities and conductances have a common factor that nothing determines:
/// what a further one is relative to them is known all the same.
pub fn errors_beside(
    normal: &NormalEquations,
    parameters: &[Parameter],
    x: &[f64],
    is_own: &[bool],
) -> Vec<f64> {
    let units: Vec<f64> = parameters.iter().zip(x).map(|(p, x)| unit(p, *x)).collect();
    let concerns_own = |value: f64, v: &[f64]| {
        let own = v.iter().zip(is_own).filter(|(_, is_own)| **is_own);
        value >= DETERMINED || own.map(|(v, _)| v * v).sum::<f64>() > CONCERNS
    };
    let at_bound = at_bound(normal, parameters, x);
    let (_, spreads) = spreads(&in_units(normal, &units), &units, &at_bound, &concerns_own);
    let slopes = parameters.iter().zip(x).map(|(p, x)| p.scale.slope(p.scale.value(*x)));
    slopes.zip(spreads).map(|(slope, spread)| slope.abs() * spread).collect()
}

/// Covariance and spreads in the coordinates of the search, from the directions that `counts` admits.
fn spreads(
    scaled: &NormalEquations,
    units: &[f64],
    at_bound: &[bool],
    counts: &dyn Fn(f64, &[f64]) -> bool,
) -> (Vec<f64>, Vec<f64>) {
    let n = units.len();
    let covariance = |of: Vec<usize>| {
        let mut directions = directions(scaled, &of);
        directions.retain(|(value, v)| counts(*value, v));
        let mut covariance = inverse(n, &directions, &of);
        covariance.iter_mut().enumerate().for_each(|(k, c)| *c *= units[k % n] * units[k / n]);
        covariance
    };
    let free = covariance((0..n).filter(|i| !at_bound[*i]).collect());
    // A parameter at its bound has no variance beside the others; its error is that of the whole system.
    let whole = covariance((0..n).collect());
    let variance = |i: usize| if at_bound[i] { whole[i + n * i] } else { free[i + n * i] };
    let spreads = (0..n).map(|i| variance(i).sqrt()).collect();
    (free, spreads)
}

/// Sum of squares by degree of freedom: near one if the model explains the data to their noise.
pub fn reduced(cost: f64, residuals: usize, parameters: usize) -> f64 {
    cost / residuals.saturating_sub(parameters).max(1) as f64
}

/// Which of the parameters are at a bound that the sum of squares pushes them against.
pub fn at_bound(normal: &NormalEquations, parameters: &[Parameter], x: &[f64]) -> Vec<bool> {
    let held = |(i, p): (usize, &Parameter)| {
        let (low, high) = p.range();
        let downhill = -normal.gradient[i];
        (x[i] <= low && downhill <= 0.0) || (x[i] >= high && downhill >= 0.0)
    };
    parameters.iter().enumerate().map(held).collect()
}

/// The change of a parameter in the search that counts as large at `x`: where the scale is linear the value itself, if that
/// is larger than the size of the scale.
fn unit(parameter: &Parameter, x: f64) -> f64 {
    match parameter.scale {
        Scale::Positive { .. } if x > 0.0 => 1.0,
        _ => x.abs().max(1.0),
    }
}

/// The normal equations of parameters that are counted in these units.
fn in_units(normal: &NormalEquations, units: &[f64]) -> NormalEquations {
    let mut scaled = normal.clone();
    let n = normal.n;
    scaled.gram.iter_mut().enumerate().for_each(|(k, g)| *g *= units[k % n] * units[k / n]);
    scaled.gradient.iter_mut().zip(units).for_each(|(g, unit)| *g *= unit);
    scaled
}

/// Eigenvalues and vectors of the normal equations of some parameters, padded to all.
fn directions(normal: &NormalEquations, of: &[usize]) -> Vec<(f64, Vec<f64>)> {
    let (n, m) = (normal.n, of.len());
    let mut part = vec![0.0; m * m];
    for (b, j) in of.iter().enumerate() {
        for (a, i) in of.iter().enumerate() {
            part[a + m * b] = normal.gram[i + n * j];
        }
    }
    let padded = |v: Vec<f64>| {
        let mut all = vec![0.0; n];
        of.iter().zip(v).for_each(|(i, x)| all[*i] = x);
        all
    };
    eigen::symmetric(m, &part).into_iter().map(|(value, v)| (value, padded(v))).collect()
}

/// The inverse of the normal equations of some of `n` parameters, of their eigenvalues and vectors.
fn inverse(n: usize, directions: &[(f64, Vec<f64>)], of: &[usize]) -> Vec<f64> {
    let mut sum = vec![0.0; n * n];
    let largest = directions.last().map_or(0.0, |d| d.0);
    // Rounding of sums of products of this size.
    let least = NO_INFLUENCE.max(n as f64 * f64::EPSILON * largest);
    let mut no_influence = vec![directions.is_empty(); n];
    for (value, v) in directions {
        if *value <= least {
            (0..n).for_each(|i| no_influence[i] |= v[i].abs() > SHARE);
            continue;
        }
        for j in 0..n {
            for i in 0..n {
                sum[i + n * j] += v[i] * v[j] / value;
            }
        }
    }
    for i in of {
        if no_influence[*i] {
            sum[i + n * i] = f64::INFINITY;
        }
    }
    sum
}

/// An undetermined direction, in words.
fn in_words(parameters: &[Parameter], x: &[f64], v: &[f64]) -> String {
    let largest = v.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let mut members: Vec<usize> = (0..v.len()).filter(|i| v[*i].abs() >= NAMED * largest).collect();
    let name = |i: usize| &parameters[i].name;
    // Relative change of a positive parameter, change of another in its own size.
    let change = |i: usize| {
        let value = parameters[i].scale.value(x[i]);
        match parameters[i].scale {
            Scale::Positive { .. } if value > 0.0 => {
                v[i] * parameters[i].scale.slope(value) / value
            }
            _ => v[i],
        }
    };
    let positive = |i: usize| {
        matches!(parameters[i].scale, Scale::Positive { .. })
            && parameters[i].scale.value(x[i]) > 0.0
    };
    match members[..] {
        [one] => format!("the data do not determine `{}`", name(one)),
        [a, b] if positive(a) && positive(b) => {
            let exponent = -change(a) / change(b);
            let (sign, size) = if exponent < 0.0 { ("/", -exponent) } else { ("*", exponent) };
            let power = if (size - 1.0).abs() < 5e-3 {
                name(b).to_string()
            } else {
                format!("{}^{size:.2}", name(b))
            };
            let (a, b) = (name(a), name(b));
            format!("the data determine only `{a} {sign} {power}`, not `{a}` and `{b}` separately")
        }
        _ => {
            members.sort_by(|a, b| v[*b].abs().total_cmp(&v[*a].abs()));
            let most = members.iter().fold(0.0f64, |m, i| m.max(change(*i).abs()));
            let first = change(members[0]).signum();
            let each: Vec<String> = members
                .iter()
                .map(|i| format!("`{}` by {:+.1} %", name(*i), 10.0 * first * change(*i) / most))
                .collect();
            format!("the data cannot distinguish changing {} together", each.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(name: &str, scale: Scale, bounds: (f64, f64)) -> Parameter {
        Parameter {
            name: name.to_owned(),
            unit: String::new(),
            targets: Vec::new(),
            scale,
            start: 1.0,
            bounds,
            acts_on: None,
            only: None,
        }
    }

    fn positive(name: &str) -> Parameter {
        parameter(name, Scale::Positive { size: 1.0 }, (0.01, 100.0))
    }

    /// A straight line `a + b t`: the covariance has a closed form.
    #[test]
    fn errors_of_a_straight_line() {
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        let line = [
            parameter("a", Scale::Linear { size: 2.0 }, free),
            parameter("b", Scale::Linear { size: 0.5 }, free),
        ];
        let sigma = 0.1;
        let mut normal = NormalEquations::new(2);
        let (mut n, mut s1, mut s2) = (0.0, 0.0, 0.0);
        for i in 0..50 {
            let t = 0.1 * i as f64;
            normal.add(0.0, &[2.0 / sigma, 0.5 * t / sigma]);
            (n, s1, s2) = (n + 1.0, s1 + t, s2 + t * t);
        }
        let found = Statistics::new(&normal, &line, &[1.0, 1.0]);
        let determinant: f64 = n * s2 - s1 * s1;
        let expected = [sigma * (s2 / determinant).sqrt(), sigma * (n / determinant).sqrt()];
        for (found, expected) in found.errors.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-10, "{found} {expected}");
        }
        let rho = -s1 / (n * s2).sqrt();
        assert!((found.correlation(0, 1) - rho).abs() < 1e-10);
        assert_eq!(found.directions, [""; 0]);
    }

    /// Residuals that depend on `a b^2` and `c`, and not on `d`.
    #[test]
    fn undetermined_directions_are_named() {
        let all = ["a", "b", "c", "d"].map(positive);
        let mut normal = NormalEquations::new(4);
        for i in 0..100 {
            let s = (i as f64).sin() * 10.0;
            normal.add(0.0, &[s, 2.0 * s, 10.0 * (i as f64).cos(), 0.0]);
        }
        let found = Statistics::new(&normal, &all, &[1.5, 1.5, 1.5, 1.5]);
        assert_eq!(found.undetermined, [true, true, false, true]);
        assert!(found.errors[0].is_infinite() && found.errors[3].is_infinite());
        assert!(found.errors[2] < 0.1, "{:?}", found.errors);
        let mut directions = found.directions.clone();
        directions.sort();
        assert_eq!(
            directions,
            [
                "the data determine only `a * b^2.00`, not `a` and `b` separately",
                "the data do not determine `d`"
            ]
        );
        assert_eq!(found.correlation(0, 3), 0.0);
    }

    /// Residuals that depend on the ratios of four parameters only, of which one is that of an effect: it is known beside the
    /// others. One that only replaces another is not.
    #[test]
    fn a_common_factor_concerns_nobody() {
        let all = ["a", "b", "c", "effect"].map(positive);
        let x = [1.5, 1.5, 1.5, 1.5];
        let is_own = [false, false, false, true];
        let mut ratios = NormalEquations::new(4);
        let mut replaced = NormalEquations::new(4);
        for i in 0..100 {
            let wave = |k: f64| 10.0 * (k * i as f64).sin();
            let (p, q, r) = (wave(1.0), wave(1.7), wave(2.3));
            ratios.add(0.0, &[p, q - p, r - q, -r]);
            replaced.add(0.0, &[p, q, r, r]);
        }
        let errors = errors_beside(&ratios, &all, &x, &is_own);
        assert!(standard_errors(&ratios, &all, &x)[3].is_infinite());
        assert!(errors[3] < 0.1, "{errors:?}");
        assert!(errors_beside(&replaced, &all, &x, &is_own)[3] > 100.0);
        // Where the other one is held at its bound, nothing is left that the effect replaces.
        let held = [1.5, 1.5, all[2].range().0, 1.5];
        replaced.gradient[2] = 1.0;
        assert!(errors_beside(&replaced, &all, &held, &is_own)[3] < 0.1);
    }

    /// One of two correlated parameters at its bound: the other is as certain as without it.
    #[test]
    fn a_parameter_at_its_bound_is_held() {
        let two = [positive("a"), positive("b")];
        let mut normal = NormalEquations::new(2);
        normal.gram = vec![100.0, 90.0, 90.0, 100.0];
        normal.gradient = vec![1.0, 0.0];
        let x = [two[0].range().0, 1.5];
        let found = Statistics::new(&normal, &two, &x);
        assert_eq!(found.at_bound, [true, false]);
        assert!((found.spreads[1] - 0.1).abs() < 1e-12, "{:?}", found.spreads);
        let whole: f64 = (100.0f64 / (100.0 * 100.0 - 90.0 * 90.0)).sqrt();
        assert!((found.spreads[0] / whole - 1.0).abs() < 1e-10);
    }
}
