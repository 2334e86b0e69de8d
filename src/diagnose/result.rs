//! The result of a diagnosis: hypotheses with and without effects, and the verdict.

use crate::calibrate::data::{Data, Split};

use super::catalogue::Effect;
use super::hypothesis::{ChosenEffect, Hypothesis, groups};
use super::noise::Noise;
use super::policy::SearchPolicy;
use super::rank::Scored;
use super::study::Study;

/// The result of a search for missing effects.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The model without any effect.
    pub before: Hypothesis,
    /// The model with the accepted effects.
    pub after: Hypothesis,
    /// The score tests in order; in each the best first, one entry for each effect and place.
    pub rankings: Vec<Vec<Scored>>,
    /// The most promising pairs of effects, if pairs were scored.
    pub pairs: Vec<Vec<Scored>>,
    /// The hypotheses that were fitted and not accepted.
    pub rejected: Vec<Hypothesis>,
    /// The noise that the residuals show; empty until the search has ended.
    pub noise: Noise,
}

impl Diagnosis {
    /// A diagnosis that has not found anything yet.
    pub fn new(before: Hypothesis) -> Diagnosis {
        let (rankings, pairs, rejected) = (Vec::new(), Vec::new(), Vec::new());
        let noise = Noise::default();
        Diagnosis { after: before.clone(), before, rankings, pairs, rejected, noise }
    }

    /// The verdict.
    pub fn verdict(&self, policy: &SearchPolicy) -> Verdict {
        let (before, after) = (self.before.chi2_validation(), self.after.chi2_validation());
        let left = after.max(self.after.chi2_train());
        if self.after.effects.is_empty() {
            let limit = 1.0 + 2.0 * (policy.resolved_train - 1.0);
            let complete = self.before.chi2_train() < limit || self.noise.is_all();
            return if complete { Verdict::Complete } else { Verdict::Unexplained };
        }
        let explained = (before - after) / (before - 1.0).max(f64::MIN_POSITIVE);
        let resolved = left < policy.resolved_validation;
        if resolved
            || self.noise.is_all()
            || explained >= policy.explained_share && left < policy.explained_limit
        {
            Verdict::EffectFound
        } else {
            Verdict::Unexplained
        }
    }

    /// The verdict with its evidence, in one line.
    pub fn evidence(&self, study: &Study) -> String {
        let verdict = self.verdict(&study.policy);
        let found = sentences(&study.effects, &self.after.effects).join(" ");
        let explanation = match (found.is_empty(), verdict) {
            (true, _) => String::new(),
            (_, Verdict::Unexplained) => format!("partial explanation: {found} "),
            _ => format!("{found} "),
        };
        let (train, validation) = (self.after.chi2_train(), self.after.chi2_validation());
        format!(
            "{}, {explanation}reduced chi-square {train:.4} (train), {validation:.4} (validation)",
            verdict.name()
        )
    }
}

/// The outcome in one word.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// The model lacks nothing.
    Complete,
    /// The missing effects were found.
    EffectFound,
    /// Residuals remain that no effect explains.
    Unexplained,
}

impl Verdict {
    /// Its name in `diagnosis.json`.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Complete => "complete",
            Verdict::EffectFound => "effect_found",
            Verdict::Unexplained => "unexplained",
        }
    }
}

/// A sentence for each effect.
pub fn sentences(effects: &[Effect], chosen: &[ChosenEffect]) -> Vec<String> {
    let one = |group: &[ChosenEffect]| {
        let at: Vec<&str> =
            group.iter().flat_map(|c| c.place.at.iter().map(String::as_str)).collect();
        let over = group[0].place.binds.first().map_or("", |(_, variable)| variable);
        let sentence = effects[group[0].effect].explains.replace("%at", &at.join(", "));
        sentence.replace("%over", over)
    };
    groups(chosen).map(one).collect()
}

/// The fitted parameters of the effects: full name, value, standard error and unit.
pub fn estimates(effects: &[Effect], hypothesis: &Hypothesis) -> Vec<(String, f64, f64, String)> {
    let names = hypothesis.effects.iter().flat_map(|c| {
        let effect = &effects[c.effect];
        c.fitted.iter().map(move |p| (c.full_name(p), unit(effect, p)))
    });
    let one = |(name, unit): (String, String)| {
        let (value, error) = hypothesis.estimate(&name)?;
        Some((name, value, error, unit))
    };
    names.filter_map(one).collect()
}

/// The unit of an effect's parameter.
pub fn unit(effect: &Effect, parameter: &str) -> String {
    effect.units.iter().find(|(n, _)| n == parameter).map_or(String::new(), |(_, u)| u.clone())
}

/// Root of the mean square of a signal over all windows of one recording, in the unit of its column.
pub fn rmse_of(
    data: &Data,
    hypothesis: &Hypothesis,
    split: Split,
    signal: usize,
    recording: &str,
) -> f64 {
    let sums = hypothesis.sums(split);
    let belongs: Vec<bool> = data.of(split).map(|r| r.of == recording).collect();
    sums.of_part(signal, |i| belongs.get(i).copied().unwrap_or(true)) * data.sigmas[signal]
}
