//! The recording that would tell most: the conditions under which the hypotheses that are left differ most, or
//! under which the parameter that is known worst would be determined best.
//!
//! Hypotheses are separated by the sum of squares that a rival would leave in a recording of the best one, after
//! its parameters have adapted to it as far as the recordings at hand allow (the discrimination criterion of
//! Box and Hill 1967 in the form of Atkinson and Fedorov 1975; Atkinson, Donev and Tobias, *Optimum Experimental
//! Designs, with SAS*, 2007, chapters 9 and 20). A parameter is narrowed by what the recording adds to the
//! information matrix. Both are linearised at the fitted parameters.

use crate::base::diag::Problems;
use crate::calibrate::data::{Recording, Split};
use crate::calibrate::parallel;
use crate::calibrate::plan::Condition;
use crate::calibrate::plan::RECORDING_NUMBER;
use crate::calibrate::problem::Problem;
use crate::calibrate::statistics::standard_errors;
use crate::numeric::halton::Halton;
use crate::numeric::least_squares::NormalEquations;

use super::hypothesis::{Hypothesis, attached};
use super::result::Diagnosis;
use super::rivals::rivals;
use super::study::Study;

/// Conditions that are tried.
const TRIED: usize = 48;
/// A condition that covers more than this factor is spaced by its logarithm.
const LOGARITHMIC: f64 = 30.0;
/// Damping of the step by which a rival adapts: enough for directions that nothing determines.
const DAMPING: f64 = 1e-9;

/// The recording that would tell most.
#[derive(Clone, Debug)]
pub struct NextExperiment {
    /// Its conditions.
    pub conditions: Vec<ConditionValue>,
    /// The hypotheses that it tells from the best one.
    pub rivals: Vec<Hypothesis>,
    /// The sum of squares by which the best hypothesis is expected to surpass the closest rival, here and on average
    /// over all conditions; none without rivals.
    pub separation: Option<Gain>,
    /// The parameter that is known worst, and its standard error with the recording.
    pub narrowed: Option<Narrowed>,
    /// The readings that each hypothesis predicts: the best first, then the rivals.
    pub predictions: Vec<Prediction>,
}

/// A condition and its value.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionValue {
    /// The column of the table.
    pub column: String,
    /// The value in the unit of the column.
    pub value: f64,
    /// That unit.
    pub unit: String,
}

/// An expected gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// By the recording.
    pub best: f64,
    /// By a recording under random conditions.
    pub random: f64,
}

/// A parameter that a recording would determine better.
#[derive(Clone, Debug, PartialEq)]
pub struct Narrowed {
    /// Its full name.
    pub parameter: String,
    /// Its standard error now; infinite if nothing determines it.
    pub error: f64,
    /// With the recording, or another one.
    pub expected: Gain,
}

/// The readings that a hypothesis predicts.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// Instants, s.
    pub time: Vec<f64>,
    /// Signal by signal, in the unit of its column.
    pub signals: Vec<Vec<f64>>,
}

/// The recording that would tell most. `None` if the plan has no conditions that vary between its recordings, or if none
/// of those that are tried can be simulated.
pub fn next_experiment(study: &Study, diagnosis: &Diagnosis) -> Option<NextExperiment> {
    let after = &diagnosis.after;
    let rivals: Vec<Hypothesis> = rivals(study, diagnosis).into_iter().cloned().collect();
    let tried = candidates(study)?;
    let best = with_problem(study, after, |problem| {
        let each = parallel::map(problem.jobs, tried.len(), |k| {
            let predicted = problem.predict(&tried[k], &problem.start()).ok()?;
            let information = problem.normal_of(&tried[k], &problem.start()).ok()?;
            Some((predicted, information))
        });
        let known = problem.normal(&problem.start()).ok()?;
        let errors = |more: Option<&NormalEquations>| {
            let mut sum = known.clone();
            if let Some(more) = more {
                sum.merge(&NormalEquations { gradient: vec![0.0; more.n], ..more.clone() });
            }
            standard_errors(&sum, &problem.parameters, &problem.start())
        };
        let with: Vec<Option<Vec<f64>>> =
            each.iter().map(|e| Some(errors(Some(&e.as_ref()?.1)))).collect();
        let predicted: Vec<_> =
            each.into_iter().map(|e| e.map(|(predicted, _)| predicted)).collect();
        Some((predicted, errors(None), with))
    });
    let (predicted, errors, errors_with) = best??;
    let recorded: Vec<Option<Recording>> = tried
        .iter()
        .zip(&predicted)
        .map(|(r, p)| Some(Recording { signals: p.clone()?, ..r.clone() }))
        .collect();
    // Of several rivals, the closest one counts.
    let mut separations: Vec<Option<f64>> =
        predicted.iter().map(|p| p.as_ref().map(|_| f64::INFINITY)).collect();
    for rival in &rivals {
        let own = with_problem(study, rival, |problem| separated(problem, &recorded)).flatten();
        for (least, own) in separations.iter_mut().zip(own?) {
            *least = least.zip(own).map(|(a, b)| a.min(b));
        }
    }
    let worst = worst(after, &errors);
    let narrowing = |k: usize| {
        let expected = errors_with[k].as_ref()?[worst?];
        Some(-expected)
    };
    let value = |k: usize| match rivals.is_empty() {
        true => narrowing(k),
        false => separations[k],
    };
    let chosen = (0..tried.len())
        .filter(|k| value(*k).is_some_and(|v| !v.is_nan()))
        .max_by(|a, b| value(*a).unwrap_or_default().total_cmp(&value(*b).unwrap_or_default()))?;
    let mean = |all: Vec<f64>| {
        let finite: Vec<f64> = all.into_iter().filter(|v| v.is_finite()).collect();
        finite.iter().sum::<f64>() / finite.len().max(1) as f64
    };
    let separation = separations[chosen]
        .filter(|_| !rivals.is_empty())
        .map(|best| Gain { best, random: mean(separations.iter().flatten().copied().collect()) });
    let narrowed = worst.and_then(|i| {
        let all = errors_with.iter().flatten().map(|errors| errors[i]);
        let expected = Gain { best: errors_with[chosen].as_ref()?[i], random: mean(all.collect()) };
        let parameter = after.plan.free[i].name.clone();
        Some(Narrowed { parameter, error: errors[i], expected })
    });
    let chosen = &tried[chosen];
    let prediction = |hypothesis: &Hypothesis| {
        let signals =
            with_problem(study, hypothesis, |p| p.predict(chosen, &p.start()).ok()).flatten()?;
        Some(Prediction { time: chosen.time.to_vec(), signals })
    };
    let predictions: Option<Vec<_>> =
        std::iter::once(after).chain(&rivals).map(prediction).collect();
    let conditions = study
        .plan
        .conditions
        .iter()
        .zip(&chosen.conditions)
        .filter(|(_, value)| !value.is_nan())
        .map(|(c, value)| ConditionValue {
            column: c.column.clone(),
            value: c.unit.of_si(*value),
            unit: c.unit_name.clone(),
        })
        .collect();
    Some(NextExperiment { conditions, rivals, separation, narrowed, predictions: predictions? })
}

/// The parameter that is known worst, by its position: relative to its value, or not determined at all.
fn worst(hypothesis: &Hypothesis, errors: &[f64]) -> Option<usize> {
    let relative = |i: usize| match hypothesis.values[i] {
        0.0 => f64::INFINITY,
        value => errors[i] / value.abs(),
    };
    // One that a single recording has for itself is no property of the model.
    let shared = (0..errors.len()).filter(|i| hypothesis.plan.free[*i].only.is_none());
    shared.max_by(|a, b| relative(*a).total_cmp(&relative(*b)))
}

/// The sums of squares that a rival leaves in recordings of the best hypothesis, beyond the noise, after it has adapted
/// to them as far as the recordings at hand allow.
fn separated(problem: &Problem<'_>, recorded: &[Option<Recording>]) -> Option<Vec<Option<f64>>> {
    let x = problem.start();
    let known = problem.normal(&x).ok()?;
    Some(parallel::map(problem.jobs, recorded.len(), |k| {
        let mut sum = problem.normal_of(recorded[k].as_ref()?, &x).ok()?;
        let cost = sum.cost;
        sum.merge(&NormalEquations { gradient: vec![0.0; known.n], cost: 0.0, ..known.clone() });
        Some(cost - sum.decrease(DAMPING)?)
    }))
}

/// What a hypothesis tells, compiled for the recordings of a study. `None` if it cannot be.
fn with_problem<T>(
    study: &Study,
    hypothesis: &Hypothesis,
    take: impl FnOnce(&Problem<'_>) -> T,
) -> Option<T> {
    let plan = &hypothesis.plan;
    let (session, program) =
        study.compile(plan, &attached(study, &hypothesis.effects), &[]).ok()?;
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, plan, &study.data, &mut problems)?;
    Some(take(&problem))
}

/// Recordings under conditions within the ranges of those at hand: as long as the longest of them, without readings.
/// `None` if no condition varies.
fn candidates(study: &Study) -> Option<Vec<Recording>> {
    let template = study.data.of(Split::Train).max_by_key(|r| r.time.len())?;
    let ranges: Vec<Range> = study
        .plan
        .conditions
        .iter()
        .enumerate()
        .map(|(k, _)| Range::new(study.data.recordings.iter().map(|r| r.conditions[k])))
        .collect();
    let is_set = |k: &usize| study.plan.conditions[*k].parameter != RECORDING_NUMBER;
    let varied: Vec<usize> =
        (0..ranges.len()).filter(|k| is_set(k) && ranges[*k].values.len() > 1).collect();
    if varied.is_empty() {
        return None;
    }
    let mut points: Vec<Vec<f64>> = Vec::new();
    // The corners first: the best conditions often are extreme.
    let corners = 1usize << varied.len().min(4);
    for corner in 0..corners {
        points.push((0..varied.len()).map(|j| ((corner >> j.min(3)) & 1) as f64).collect());
    }
    let mut halton = Halton::new(varied.len());
    points.extend((corners..TRIED).map(|_| halton.next_point()));
    let candidate = |point: &Vec<f64>| {
        let mut recording = template.clone();
        for (k, share) in varied.iter().zip(point) {
            let unit = &study.plan.conditions[*k];
            recording.conditions[*k] = ranges[*k].at(*share, unit);
        }
        recording.signals = vec![vec![0.0; recording.time.len()]; study.plan.signals.len()];
        recording
    };
    Some(points.iter().map(candidate).collect())
}

/// The values of a condition in the recordings, rising.
struct Range {
    values: Vec<f64>,
}

impl Range {
    fn new(all: impl Iterator<Item = f64>) -> Range {
        let mut values: Vec<f64> = all.filter(|v| !v.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        Range { values }
    }

    /// The value at a share of the range, in SI units, with three digits in the unit of its column. Two values that are
    /// whole numbers are a choice rather than a range.
    fn at(&self, share: f64, condition: &Condition) -> f64 {
        let (low, high) = (self.values[0], self.values[self.values.len() - 1]);
        let is_choice = self.values.len() == 2
            && self.values.iter().all(|v| v.fract() == 0.0 && v.abs() < 10.0);
        if is_choice {
            return if share < 0.5 { low } else { high };
        }
        let value = match low > 0.0 && high / low > LOGARITHMIC {
            true => low * (high / low).powf(share),
            false => low + share * (high - low),
        };
        let shown = condition.unit.of_si(value);
        let rounded = format!("{shown:.2e}").parse().unwrap_or(shown);
        condition.unit.to_si(rounded).clamp(low, high)
    }
}
