//! The result of a calibration: estimates, and how well the model then explains each signal of each
//! recording; as JSON.

use crate::io::json::Json;
use crate::simulate::failure::Failure;

use super::data::Split;
use super::fit::Fit;
use super::parallel;
use super::plan::Plan;
use super::problem::Problem;
use super::profile::Interval;
use super::statistics::{Statistics, reduced};
use super::table::shown;
use super::unit::Unit;

/// Correlations above this are listed in the table.
const STRONG: f64 = 0.9;

/// The estimate of a parameter.
#[derive(Clone, PartialEq, Debug)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Its unit, as the model declares it.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// Standard error of the value; infinite if the data do not determine it.
    pub error: f64,
    /// 95 % interval.
    pub interval: Interval,
    /// Its start.
    pub start: f64,
    /// The bounds of the search.
    pub bounds: (f64, f64),
    /// The estimate is at one of the bounds.
    pub at_bound: bool,
    /// The data do not determine it.
    pub undetermined: bool,
}

/// How well the model explains a set of values.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Quality {
    /// Sum of squared residuals, in units of the noise.
    pub squares: f64,
    /// Number of residuals.
    pub count: usize,
}

impl Quality {
    /// Sum of squares by number of residuals.
    pub fn reduced(self) -> f64 {
        reduced(self.squares, self.count, 0)
    }

    /// Root of the mean square, in the unit of `sigma`, the standard deviation of the noise.
    pub fn rmse(self, sigma: f64) -> f64 {
        self.reduced().sqrt() * sigma
    }

    fn plus(self, other: Quality) -> Quality {
        Quality { squares: self.squares + other.squares, count: self.count + other.count }
    }
}

/// A signal.
#[derive(Clone, PartialEq, Debug)]
pub struct Channel {
    /// The column of the recordings.
    pub column: String,
    /// The variable of the model.
    pub variable: String,
    /// The unit of the column.
    pub unit: String,
    /// Standard deviation of its noise, in that unit.
    pub sigma: f64,
    /// That unit.
    pub si: Unit,
    /// The unit of the variable, as the model declares it.
    pub si_unit: String,
}

/// A recording compared with the model.
#[derive(Clone, PartialEq, Debug)]
pub struct Comparison {
    /// The recording.
    pub name: String,
    /// Its use.
    pub split: Split,
    /// Instants, s.
    pub time: Vec<f64>,
    /// Measured values, signal by signal, in the units of the columns; NaN where there is none.
    pub measured: Vec<Vec<f64>>,
    /// Values of the model.
    pub predicted: Vec<Vec<f64>>,
    /// How well they agree, signal by signal.
    pub quality: Vec<Quality>,
}

impl Comparison {
    /// All signals together.
    pub fn whole(&self) -> Quality {
        self.quality.iter().fold(Quality::default(), |a, b| a.plus(*b))
    }
}

/// How the fit ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FitSummary {
    /// Number of steps.
    pub iterations: u32,
    /// Nothing was left to gain.
    pub converged: bool,
    /// The calibration was not cancelled.
    pub complete: bool,
}

/// A calibration.
#[derive(Clone, PartialEq, Debug)]
pub struct Calibration {
    /// Full name of the model.
    pub model: String,
    /// The plan file.
    pub plan: String,
    /// The estimates, in the order of the plan.
    pub estimates: Vec<Estimate>,
    /// Correlations of the estimates, row by row.
    pub correlations: Vec<Vec<f64>>,
    /// Combinations of parameters that the data do not determine, in words.
    pub directions: Vec<String>,
    /// The signals.
    pub channels: Vec<Channel>,
    /// The recordings.
    pub comparisons: Vec<Comparison>,
    /// Repairs of the data, in words.
    pub repairs: Vec<String>,
    /// How the fit ended.
    pub fit: FitSummary,
}

impl Calibration {
    /// Simulates every recording once more with the estimates.
    pub fn new(
        problem: &Problem<'_>,
        plan: &Plan,
        repairs: &[String],
        fit: &Fit,
        (statistics, intervals): (&Statistics, &[Interval]),
        summary: FitSummary,
    ) -> Result<Calibration, Failure> {
        let n = problem.parameters.len();
        let values = problem.values(&fit.x);
        let estimate = |i: usize| {
            let p = &problem.parameters[i];
            Estimate {
                name: p.name.clone(),
                unit: p.unit.clone(),
                value: values[i],
                error: statistics.errors[i],
                interval: intervals[i],
                start: p.start,
                bounds: p.bounds,
                at_bound: statistics.at_bound[i],
                undetermined: statistics.undetermined[i],
            }
        };
        let correlations =
            (0..n).map(|i| (0..n).map(|j| statistics.correlation(i, j)).collect()).collect();
        let variables = &problem.program.blocks.dae.variables;
        let channels = plan.signals.iter().zip(problem.sigmas()).map(|(s, sigma)| Channel {
            column: s.column.clone(),
            variable: s.variable.clone(),
            unit: s.unit_name.clone(),
            sigma: *sigma,
            si: s.unit,
            si_unit: variables
                .iter()
                .find(|v| v.name == s.variable)
                .map_or(String::new(), |v| v.unit.to_string()),
        });
        Ok(Calibration {
            model: problem.program.blocks.dae.name.clone(),
            plan: plan.path.display().to_string(),
            estimates: (0..n).map(estimate).collect(),
            correlations,
            directions: statistics.directions.clone(),
            channels: channels.collect(),
            comparisons: comparisons(problem, &fit.x)?,
            repairs: repairs.to_vec(),
            fit: summary,
        })
    }

    /// All recordings of one kind, of one signal or of all.
    pub fn quality(&self, split: Split, signal: Option<usize>) -> Quality {
        let of = self.comparisons.iter().filter(|c| c.split == split);
        of.map(|c| signal.map_or_else(|| c.whole(), |k| c.quality[k]))
            .fold(Quality::default(), Quality::plus)
    }

    /// Sum of squares of the recordings for training by degree of freedom.
    pub fn reduced_train(&self) -> f64 {
        let all = self.quality(Split::Train, None);
        let free = self.estimates.iter().filter(|e| !e.at_bound).count();
        reduced(all.squares, all.count, free)
    }

    /// As JSON, with the elapsed time. Infinite numbers are `null`.
    pub fn json(&self, seconds: f64) -> String {
        let estimate = |e: &Estimate| {
            let ends = e.interval.ends.map(|e| Json::text(e.name()));
            Json::object([
                ("name", Json::text(&e.name)),
                ("unit", Json::text(&e.unit)),
                ("value", Json::number(e.value)),
                ("standard_error", Json::number(e.error)),
                ("interval_95", Json::numbers(&[e.interval.low, e.interval.high])),
                ("interval_from", Json::list(ends)),
                ("start", Json::number(e.start)),
                ("bounds", Json::numbers(&[e.bounds.0, e.bounds.1])),
                ("at_bound", Json::flag(e.at_bound)),
                ("determined", Json::flag(!e.undetermined)),
            ])
        };
        let quality = |q: Quality, k: usize| {
            let c = &self.channels[k];
            let members = [
                ("rmse", Json::number(q.rmse(c.sigma))),
                ("unit", Json::text(&c.unit)),
                ("reduced_chi_square", Json::number(q.reduced())),
                ("values", Json::count(q.count)),
            ];
            (c.column.clone(), Json::object(members))
        };
        let signals = |of: &dyn Fn(usize) -> Quality| {
            Json::object((0..self.channels.len()).map(|k| quality(of(k), k)))
        };
        let comparison = |c: &Comparison| {
            Json::object([
                ("recording", Json::text(&c.name)),
                ("split", Json::text(c.split.name())),
                ("reduced_chi_square", Json::number(c.whole().reduced())),
                ("signals", signals(&|k| c.quality[k])),
            ])
        };
        let split = |s: Split| {
            let all = self.quality(s, None);
            let chi = if s == Split::Train { self.reduced_train() } else { all.reduced() };
            let members = [
                ("reduced_chi_square", Json::number(if all.count == 0 { f64::NAN } else { chi })),
                ("values", Json::count(all.count)),
                ("signals", signals(&|k| self.quality(s, Some(k)))),
            ];
            (s.name(), Json::object(members))
        };
        let has_test = self.quality(Split::Test, None).count > 0;
        let splits = Split::ALL.into_iter().filter(|s| has_test || *s != Split::Test);
        let texts = |list: &[String]| Json::list(list.iter().map(Json::text));
        Json::object([
            ("model", Json::text(&self.model)),
            ("plan", Json::text(&self.plan)),
            ("parameters", Json::list(self.estimates.iter().map(estimate))),
            ("correlations", Json::list(self.correlations.iter().map(|row| Json::numbers(row)))),
            ("not_determined", texts(&self.directions)),
            ("quality", Json::object(splits.map(split))),
            ("recordings", Json::list(self.comparisons.iter().map(comparison))),
            ("repairs", texts(&self.repairs)),
            ("iterations", Json::count(self.fit.iterations as usize)),
            ("converged", Json::flag(self.fit.converged)),
            ("complete", Json::flag(self.fit.complete)),
            ("seconds", Json::number(seconds)),
        ])
        .pretty()
    }

    /// The interval of an estimate as text.
    pub fn interval_shown(&self, e: &Estimate) -> String {
        let width = 0.25 * (e.interval.high - e.interval.low);
        format!("{} .. {}", shown(e.interval.low, width), shown(e.interval.high, width))
    }

    /// Strongly correlated pairs of parameters, strongest first.
    pub fn strong_correlations(&self) -> Vec<(&str, &str, f64)> {
        let mut out = Vec::new();
        for (i, a) in self.estimates.iter().enumerate() {
            for (j, b) in self.estimates.iter().enumerate().skip(i + 1) {
                let rho = self.correlations[i][j];
                if rho.abs() > STRONG {
                    out.push((a.name.as_str(), b.name.as_str(), rho));
                }
            }
        }
        out.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        out
    }
}

fn comparisons(problem: &Problem<'_>, x: &[f64]) -> Result<Vec<Comparison>, Failure> {
    let mut out = Vec::new();
    for split in Split::ALL {
        let recordings = problem.recordings(split);
        let all =
            parallel::map(problem.jobs, recordings.len(), |i| problem.predict(recordings[i], x));
        for (r, predicted) in recordings.iter().zip(all) {
            let predicted = predicted?;
            let quality = predicted.iter().zip(&r.signals).zip(problem.sigmas());
            let quality = quality.map(|((p, m), sigma)| {
                let residuals = p.iter().zip(m).map(|(p, m)| (p - m) / sigma);
                residuals.filter(|r| !r.is_nan()).fold(Quality::default(), |q, r| Quality {
                    squares: q.squares + r * r,
                    count: q.count + 1,
                })
            });
            out.push(Comparison {
                name: r.name.clone(),
                split,
                time: r.time.to_vec(),
                measured: r.signals.clone(),
                quality: quality.collect(),
                predicted,
            });
        }
    }
    Ok(out)
}
