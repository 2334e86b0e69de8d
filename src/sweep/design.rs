//! The values of the parameters in each run.

use super::error::SweepError;
use super::random::Random;
use super::vary::{Axis, Value};

/// Largest number of runs.
const MAX_RUNS: u64 = 100_000_000;

/// The runs of a sweep.
#[derive(Clone, Debug)]
pub struct Design {
    /// The axes.
    pub axes: Vec<Axis>,
    /// Number of runs.
    pub count: u64,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// All combinations; the last axis varies fastest.
    Grid {
        /// Points of each axis.
        counts: Vec<u64>,
    },
    /// For each axis its position within the range, from 0 to 1, run by run.
    Sample(Vec<Vec<f64>>),
}

impl Design {
    /// All combinations of the values of all axes, in the order of nested loops.
    pub fn grid(axes: Vec<Axis>) -> Result<Design, SweepError> {
        distinct(&axes)?;
        let counts = axes.iter().map(Axis::count).collect::<Result<Vec<_>, _>>()?;
        let all = counts.iter().try_fold(1_u64, |all, n| all.checked_mul(*n));
        let count = all.filter(|n| *n <= MAX_RUNS).ok_or(SweepError::TooMany { max: MAX_RUNS })?;
        Ok(Design { axes, count, kind: Kind::Grid { counts } })
    }

    /// A Latin hypercube of `count` runs: the range of each axis is cut into as many equal strata as there are runs,
    /// each stratum has one run, at random within it, and which strata of the axes meet is random.
    ///
    /// M. D. McKay, R. J. Beckman, W. J. Conover: *A comparison of three methods for selecting values of input
    /// variables in the analysis of output from a computer code*, Technometrics 21 (1979), section 2.2.
    pub fn latin_hypercube(axes: Vec<Axis>, count: u64, seed: u64) -> Result<Design, SweepError> {
        distinct(&axes)?;
        if count > MAX_RUNS {
            return Err(SweepError::TooMany { max: MAX_RUNS });
        }
        let parts = |d: usize| {
            let mut random = Random::new(seed, d as u64);
            let strata = random.permutation(count as usize);
            // Rounding must not leave the stratum at its upper end.
            let below =
                |x: f64, stratum: usize| x.min(((stratum + 1) as f64 / count as f64).next_down());
            let part = |s: usize| below((s as f64 + random.unit()) / count as f64, s);
            strata.into_iter().map(part).collect()
        };
        let parts = (0..axes.len()).map(parts).collect();
        Ok(Design { axes, count, kind: Kind::Sample(parts) })
    }

    /// The values of the axes in a run, counted from 0.
    pub fn values(&self, run: u64) -> Vec<Value> {
        match &self.kind {
            Kind::Grid { counts } => {
                let mut rest = run;
                let mut values: Vec<Value> = Vec::with_capacity(counts.len());
                for (axis, n) in self.axes.iter().zip(counts).rev() {
                    values.push(axis.point(rest % n));
                    rest /= n;
                }
                values.reverse();
                values
            }
            Kind::Sample(parts) => {
                self.axes.iter().zip(parts).map(|(axis, p)| axis.at(p[run as usize])).collect()
            }
        }
    }
}

/// The number of runs of `lhs:N`.
pub fn sample(text: &str) -> Result<u64, SweepError> {
    let count = text.strip_prefix("lhs:").and_then(|n| n.trim().parse::<u64>().ok());
    count.filter(|n| *n > 0).ok_or_else(|| SweepError::Sample(text.to_owned()))
}

fn distinct(axes: &[Axis]) -> Result<(), SweepError> {
    let again = |(k, axis): (usize, &Axis)| axes[..k].iter().any(|a| a.name == axis.name);
    match axes.iter().enumerate().find(|pair| again(*pair)) {
        Some((_, axis)) => Err(SweepError::Twice(axis.name.clone())),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(texts: &[&str]) -> Vec<Axis> {
        texts.iter().map(|t| Axis::read(t).unwrap()).collect()
    }

    fn numbers(design: &Design, axis: usize) -> Vec<f64> {
        let of = |run| match &design.values(run)[axis] {
            Value::Number(x) => *x,
            Value::Text(text) => panic!("{text} is not a number"),
        };
        (0..design.count).map(of).collect()
    }

    #[test]
    fn a_grid_is_nested_loops() {
        let grid = Design::grid(axes(&["a=1,2", "b=0:1:3"])).unwrap();
        assert_eq!(numbers(&grid, 0), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!(numbers(&grid, 1), [0.0, 0.5, 1.0, 0.0, 0.5, 1.0]);
        assert!(Design::grid(axes(&["a=1,2", "a=3"])).is_err());
        assert!(Design::grid(axes(&["a=0:1:100000", "b=0:1:100000"])).is_err());
        assert_eq!(Design::grid(Vec::new()).unwrap().count, 1);
    }

    #[test]
    fn every_stratum_has_one_run_in_every_dimension() {
        for (count, seed) in [(1, 0), (10, 1), (1000, 2)] {
            let design = Design::latin_hypercube(axes(&["a=0:1", "b=-3:5"]), count, seed).unwrap();
            for (axis, from, length) in [(0, 0.0, 1.0), (1, -3.0, 8.0)] {
                let stratum = |x: &f64| ((x - from) / length * count as f64) as u64;
                let mut strata: Vec<u64> = numbers(&design, axis).iter().map(stratum).collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..count).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn discrete_values_are_sampled_equally_often() {
        let design = Design::latin_hypercube(axes(&["a=1,2,3"]), 12, 5).unwrap();
        let all = numbers(&design, 0);
        for level in [1.0, 2.0, 3.0] {
            assert_eq!(all.iter().filter(|x| **x == level).count(), 4);
        }
    }

    #[test]
    fn the_seed_decides() {
        let of = |seed| numbers(&Design::latin_hypercube(axes(&["a=0:1"]), 50, seed).unwrap(), 0);
        assert_eq!(of(3), of(3));
        assert_ne!(of(3), of(4));
        assert_eq!(sample("lhs:12").unwrap(), 12);
        assert!(sample("lhs:0").is_err() && sample("mc:3").is_err());
    }
}
