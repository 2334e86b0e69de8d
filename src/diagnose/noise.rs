//! The noise of the sensors, as the residuals of a hypothesis show it.
//!
//! A plan may declare more or less noise than a sensor has. The residuals are then white all the same, and only
//! their size is another one; what a model lacks leaves structure: over time, over time since the start of a
//! recording, from recording to recording, or with the quantities of the model.

use crate::calibrate::data::{Recording, Split};
use crate::numeric::whiteness::Residuals;

use super::hypothesis::Hypothesis;
use super::policy::SearchPolicy;
use super::residual::of_hypothesis;
use super::study::Study;

/// The noise of a signal.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SignalNoise {
    /// Standard deviation, as a multiple of that of the plan.
    pub factor: f64,
    /// Standard error of the factor, as a share of it.
    pub error: f64,
}

/// The noise of all signals; `None` for a signal whose residuals have structure.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Noise {
    signals: Vec<Option<SignalNoise>>,
}

impl Noise {
    /// True if nothing but noise is left in any signal.
    pub fn is_all(&self) -> bool {
        !self.signals.is_empty() && self.signals.iter().all(Option::is_some)
    }

    /// The factor of a signal, if only noise is left and there is noticeably more or less than the plan
    /// declares.
    pub fn noticeable(&self, signal: usize, policy: &SearchPolicy) -> Option<f64> {
        let SignalNoise { factor, error } = (*self.signals.get(signal)?)?;
        let least = policy.noticeable_noise.max(policy.noise_errors * error);
        ((factor - 1.0).abs() > least * factor.max(1.0)).then_some(factor)
    }

    /// True if only noise is left, and the plan declares noticeably more or less of it.
    pub fn explains_misfit(&self, policy: &SearchPolicy) -> bool {
        self.is_all() && (0..self.signals.len()).any(|k| self.noticeable(k, policy).is_some())
    }

    /// The noticeable factors, 1 for the other signals; `None` if there are none.
    pub fn corrections(&self, policy: &SearchPolicy) -> Option<Vec<f64>> {
        let factors = || (0..self.signals.len()).map(|k| self.noticeable(k, policy));
        let found = factors().any(|factor| factor.is_some());
        found.then(|| factors().map(|factor| factor.unwrap_or(1.0)).collect())
    }

    /// The noticeable factors of the signals whose noise the plan declares, with their columns.
    pub fn factors<'a>(&self, study: &'a Study) -> Vec<(&'a str, f64)> {
        let declared = study.plan.signals.iter().enumerate().filter(|(_, s)| s.sigma.is_some());
        declared
            .filter_map(|(k, s)| Some((s.column.as_str(), self.noticeable(k, &study.policy)?)))
            .collect()
    }
}

/// The noise that the residuals of the training and validation recordings show.
pub fn noise(study: &Study, hypothesis: &Hypothesis) -> Noise {
    let all: Vec<&Recording> = Split::ALL.into_iter().flat_map(|s| study.data.of(s)).collect();
    let residuals = of_hypothesis(study, hypothesis);
    let runs: Vec<Run<'_>> = all
        .into_iter()
        .zip(&residuals)
        .filter(|(recording, _)| recording.split != Split::Test)
        .map(|(recording, residuals)| Run { recording, residuals })
        .collect();
    let count = study.plan.signals.len();
    // The model cannot be simulated.
    if runs.iter().any(|run| run.residuals.len() != count) {
        return Noise::default();
    }
    let others = others(study, &runs);
    let of_signal = |k: usize| {
        let of_runs = runs.iter().map(|run| run.residuals[k].as_slice()).collect();
        let own = Residuals::new(of_runs)?;
        let limit = study.policy.structure_limit;
        // The same share of structure counts as explained where the plan declares the noise that there is.
        let negligible = study.policy.resolved_train - 1.0;
        let sees = |(of, values): &(Option<usize>, Vec<Vec<f64>>)| {
            *of != Some(k) && own.correlation(values, limit) > negligible
        };
        let is_white = own.structure(limit) < negligible && !others.iter().any(sees);
        let factor = own.root_mean_square() * study.corrections.get(k).copied().unwrap_or(1.0);
        let noise = SignalNoise { factor, error: own.relative_error() };
        is_white.then_some(noise)
    };
    Noise { signals: (0..count).map(of_signal).collect() }
}

/// A recording with its residuals.
struct Run<'a> {
    recording: &'a Recording,
    /// Signal by signal.
    residuals: &'a [Vec<f64>],
}

/// What residuals may depend on, run by run: the signals of the model with their squares and changes, the
/// inputs with their squares, and the residuals of the signals, each with its signal.
fn others(study: &Study, runs: &[Run<'_>]) -> Vec<(Option<usize>, Vec<Vec<f64>>)> {
    let squares = |all: &[Vec<f64>]| -> Vec<Vec<f64>> {
        all.iter().map(|run| run.iter().map(|x| x * x).collect()).collect()
    };
    let mut out = Vec::new();
    for (k, sigma) in study.data.sigmas.iter().enumerate() {
        let modelled = |run: &Run<'_>| -> Vec<f64> {
            let both = run.recording.signals[k].iter().zip(&run.residuals[k]);
            both.map(|(measured, residual)| measured + sigma * residual).collect()
        };
        let values: Vec<Vec<f64>> = runs.iter().map(modelled).collect();
        let changes = |run: &Vec<f64>| -> Vec<f64> {
            let first = run.first().map(|_| f64::NAN);
            first.into_iter().chain(run.windows(2).map(|w| w[1] - w[0])).collect()
        };
        out.push((None, values.iter().map(changes).collect()));
        out.push((None, squares(&values)));
        out.push((None, values));
        out.push((Some(k), runs.iter().map(|run| run.residuals[k].clone()).collect()));
    }
    for k in 0..study.plan.inputs.len() {
        let course = |run: &Run<'_>| -> Vec<f64> {
            let series = &run.recording.courses[k];
            run.recording.time.iter().map(|t| series.value(*t, 0)).collect()
        };
        let values: Vec<Vec<f64>> = runs.iter().map(course).collect();
        out.push((None, squares(&values)));
        out.push((None, values));
    }
    out
}
