//! The result of a diagnosis: hypotheses with and without effects, and the verdict.

use crate::calibrate::data::{Data, Split};
use crate::calibrate::sums::Sums;

use super::catalogue::Effect;
use super::difference::as_difference;
use super::hypothesis::{ChosenEffect, Hypothesis, bound_variables, groups};
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
        // Many effects that leave something together are a description.
        let are_few = groups(&self.after.effects).count() <= policy.most_that_leave_something;
        let is_nearly_all = explained >= policy.explained_share && left < policy.explained_limit;
        if self.leaves_noise(policy) || are_few && is_nearly_all {
            Verdict::EffectFound
        } else {
            Verdict::Unexplained
        }
    }

    /// True if the residuals that remain are those of the sensors' noise.
    pub fn leaves_noise(&self, policy: &SearchPolicy) -> bool {
        let is_noise = |sums: &Sums, chi2: f64| chi2 < policy.validation_limit(sums.count());
        let (train, validation) = (&self.after.train, &self.after.validation);
        let is_resolved = is_noise(train, self.after.chi2_train())
            && is_noise(validation, self.after.chi2_validation());
        is_resolved || self.noise.is_all()
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
        let effect = &effects[group[0].effect];
        let over = bound_variables(group, |own| effect.is_named_in_law(own));
        let explains = &effects[group[0].effect].explains;
        let sentence = match at.as_slice() {
            [a, b] if group[0].place.is_between() => {
                let between = format!("between {a} and {b}");
                let explains = explains.replace("passes %at", &format!("passes {between}"));
                let wall = format!("wall {between}");
                let rest = explains.strip_prefix("%at").map(|rest| format!("The {wall}{rest}"));
                rest.unwrap_or_else(|| explains.replace("%at", &format!("the {wall}")))
            }
            _ => explains.replace("%at", &at.join(", ")),
        };
        let sentence = sentence.replace("%over", &over.join(" and "));
        let (general, own) =
            (&effects[group[0].effect].law, law(&effects[group[0].effect], &group[0]));
        if general.is_empty() { sentence } else { sentence.replace(general.as_str(), &own) }
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

/// The formula of an effect's law: the variables that it depends on by their names in the model, and the values of
/// parameters that were not fitted.
pub fn law(effect: &Effect, chosen: &ChosenEffect) -> String {
    let value = |word: &str| -> Option<String> {
        let bound = chosen.place.binds.iter().find(|(own, _)| own == word);
        if let Some((_, variable)) = bound.filter(|_| effect.is_named_in_law(word)) {
            let is_difference = as_difference(variable).is_some();
            return Some(if is_difference { format!("({variable})") } else { variable.clone() });
        }
        let is_fitted = chosen.fitted.iter().any(|name| name == word);
        let fixed = chosen.fixed.iter().find(|(name, _)| name == word && !is_fitted);
        fixed
            .filter(|_| effect.has_free_inputs() || effect.formula.is_some())
            .map(|(_, v)| shown(*v))
    };
    // What is counted from zero is itself.
    let mut text = effect.law.clone();
    for (name, _) in chosen.fixed.iter().filter(|(_, v)| *v == 0.0) {
        for variable in name.strip_suffix("_m").into_iter().chain(name.strip_suffix("_lo")) {
            text = text.replace(&format!("({variable} - {name})"), variable);
            text = text.replace(&format!("({variable}_hi - {name})"), &format!("{variable}_hi"));
        }
    }
    let mut out = String::new();
    let mut rest = text.as_str();
    let in_word = |c: char| c.is_alphanumeric() || c == '_';
    while let Some(c) = rest.chars().next() {
        let length = match in_word(c) {
            true => rest.find(|c| !in_word(c)).unwrap_or(rest.len()),
            false => c.len_utf8(),
        };
        let (word, left) = rest.split_at(length);
        out.push_str(&value(word).unwrap_or_else(|| word.to_owned()));
        rest = left;
    }
    out
}

/// A value with four digits.
fn shown(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded < 0.0 { format!("({rounded})") } else { format!("{rounded}") }
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

#[cfg(test)]
mod tests {
    use super::super::place::Place;
    use super::*;

    #[test]
    fn a_law_names_the_variables_of_the_model() {
        let effect = Effect {
            law: "1 + A |((x - x_m)/x_0)|^exponent".into(),
            varies: Some("factor".into()),
            ..Effect::default()
        };
        let chosen = ChosenEffect {
            effect: 0,
            place: Place {
                binds: vec![("x".into(), "arm.w".into())],
                ..Place::at(&["d".to_owned()])
            },
            name: "variation".into(),
            prefix: "variation".into(),
            fixed: vec![("x_m".into(), -2.0), ("x_0".into(), 20.0), ("A".into(), 3.0)],
            fitted: vec!["A".into(), "exponent".into()],
            group: 0,
        };
        assert_eq!(law(&effect, &chosen), "1 + A |((arm.w - (-2))/20)|^exponent");
        let mut from_zero = chosen;
        from_zero.fixed[0].1 = 0.0;
        assert_eq!(law(&effect, &from_zero), "1 + A |(arm.w/20)|^exponent");
    }
}
