//! The result of a calibration: estimates, and how well the model then explains each signal of each
//! recording; as JSON.

use crate::io::json::Json;
use crate::simulate::failure::Failure;

use super::data::Split;
use super::fit::Fit;
use super::own_fit::OwnValue;
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

    /// Of two sets of values together.
    pub fn plus(self, other: Quality) -> Quality {
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
    /// The recording that contains it as a window; itself if it is whole.
    pub of: String,
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

/// The values that a recording has for itself.
#[derive(Clone, PartialEq, Debug)]
pub struct OwnValues {
    /// The recording.
    pub recording: String,
    /// Its use.
    pub split: Split,
    /// The values, in the order of the plan.
    pub values: Vec<OwnValue>,
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
    /// The estimates of the parameters that are the same for all recordings, in the order of the plan.
    pub estimates: Vec<Estimate>,
    /// The values that the recordings have for themselves.
    pub own: Vec<OwnValues>,
    /// Number of values that were fitted to the training recordings and are not at a bound.
    pub fitted: usize,
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
        let shared: Vec<usize> = (0..problem.parameters.len())
            .filter(|i| problem.parameters[*i].only.is_none())
            .collect();
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
        let row = |i: &usize| -> Vec<f64> {
            shared.iter().map(|j| statistics.correlation(*i, *j)).collect()
        };
        let correlations = shared.iter().map(row).collect();
        Ok(Calibration {
            model: problem.program.blocks.dae.name.clone(),
            plan: plan.path.display().to_string(),
            estimates: shared.iter().map(|i| estimate(*i)).collect(),
            own: own_values(problem, &fit.x, &statistics.errors)?,
            fitted: statistics.at_bound.iter().filter(|held| !**held).count(),
            correlations,
            directions: statistics.directions.clone(),
            channels: channels(problem, plan),
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
        reduced(all.squares, all.count, self.fitted)
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
        let signals = |of: &dyn Fn(usize) -> Quality| qualities_json(&self.channels, of);
        let comparison = |c: &Comparison| comparison_json(&self.channels, c);
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
            ("each", Json::list(self.own.iter().map(own_json))),
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

/// The signals of a plan.
pub fn channels(problem: &Problem<'_>, plan: &Plan) -> Vec<Channel> {
    let variables = &problem.program.blocks.dae.variables;
    let all = plan.signals.iter().zip(problem.sigmas()).map(|(s, sigma)| Channel {
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
    all.collect()
}

/// The quality of each signal as JSON.
pub fn qualities_json(channels: &[Channel], of: &dyn Fn(usize) -> Quality) -> Json {
    Json::object(channels.iter().enumerate().map(|(k, c)| {
        let q = of(k);
        let members = [
            ("rmse", Json::number(q.rmse(c.sigma))),
            ("unit", Json::text(&c.unit)),
            ("reduced_chi_square", Json::number(q.reduced())),
            ("values", Json::count(q.count)),
        ];
        (c.column.clone(), Json::object(members))
    }))
}

/// The quality of a recording as JSON.
pub fn comparison_json(channels: &[Channel], c: &Comparison) -> Json {
    Json::object([
        ("recording", Json::text(&c.name)),
        ("split", Json::text(c.split.name())),
        ("reduced_chi_square", Json::number(c.whole().reduced())),
        ("signals", qualities_json(channels, &|k| c.quality[k])),
    ])
}

/// The values that a recording has for itself as JSON.
pub fn own_json(own: &OwnValues) -> Json {
    let value = |v: &OwnValue| {
        let members = [
            ("value", Json::number(v.value)),
            ("standard_error", Json::number(v.error)),
            ("unit", Json::text(&v.unit)),
        ];
        (v.name.clone(), Json::object(members))
    };
    Json::object([
        ("recording", Json::text(&own.recording)),
        ("split", Json::text(own.split.name())),
        ("parameters", Json::object(own.values.iter().map(value))),
    ])
}

/// The values that each recording has for itself; `errors` are the standard errors of the free parameters.
pub fn own_values(
    problem: &Problem<'_>,
    x: &[f64],
    errors: &[f64],
) -> Result<Vec<OwnValues>, Failure> {
    let mut out: Vec<OwnValues> = Vec::new();
    if problem.own.is_empty() {
        return Ok(out);
    }
    let values = problem.values(x);
    for split in Split::ALL {
        for recording in problem.recordings(split) {
            let of = &recording.of;
            if out.last().is_some_and(|last| last.recording == *of && last.split == split) {
                continue;
            }
            let fitted = problem.parameters.iter().enumerate();
            let fitted = fitted.filter(|(_, p)| p.only.is_some() && p.acts_in(recording));
            let mut own: Vec<OwnValue> = fitted
                .zip(&problem.own)
                .map(|((i, p), own)| OwnValue {
                    name: own.name.clone(),
                    unit: p.unit.clone(),
                    value: values[i],
                    error: errors[i],
                })
                .collect();
            if own.is_empty() {
                own = problem.own_values(recording, x)?;
            }
            out.push(OwnValues { recording: of.clone(), split, values: own });
        }
    }
    Ok(out)
}

/// Simulates every recording and compares it with the model.
pub fn comparisons(problem: &Problem<'_>, x: &[f64]) -> Result<Vec<Comparison>, Failure> {
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
                of: r.of.clone(),
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
