//! The summary of a diagnosis for the terminal.

use crate::calibrate::table::{rmse_shown, shown};

use super::fixed_value::{CorrectedValue, corrected_value};
use super::grade::{Grade, grade};
use super::hypothesis::groups;
use super::next_text::lines;
use super::result::{Verdict, estimates, sentences};
use super::run::Outcome;

/// The summary for the terminal.
pub fn summary(outcome: &Outcome, seconds: f64) -> String {
    let Outcome { study, diagnosis, .. } = outcome;
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let mut out = format!("{}: {}\n", study.base, outcome.verdict().name());
    if !outcome.complete {
        out.push_str(&format!("  {ENDED_EARLY}\n"));
    }
    for (sentence, group) in
        sentences(&study.effects, &after.effects).into_iter().zip(groups(&after.effects))
    {
        out.push_str(&format!("  {}{sentence}\n", partial(outcome)));
        if let Some(grade) = grade(outcome, group).filter(|g| *g != Grade::Established) {
            out.push_str(&format!("    {}\n", grade.meaning()));
        }
    }
    for corrected in after.effects.iter().filter_map(|c| corrected_value(study, after, c)) {
        let CorrectedValue { parameter, in_model, value, error } = corrected;
        let unit = study.unit(&parameter);
        let line = format!("    {parameter} = {} ± {error:.1e} {unit}", shown(value, error));
        out.push_str(&format!("{}, {in_model} in the model\n", line.trim_end()));
    }
    let is_value = |name: &str| {
        let own = after.effects.iter().find(|c| c.fitted.iter().any(|p| c.full_name(p) == name));
        own.is_some_and(|c| study.effects[c.effect].is_other_value())
    };
    for (name, value, error, unit) in estimates(&study.effects, after) {
        if is_value(&name) {
            continue;
        }
        let error_shown = match error.is_finite() {
            true => format!(" ± {error:.1e}"),
            false => String::new(),
        };
        let unit = if unit == "1" { "" } else { &unit };
        let line = format!("    {name} = {}{error_shown} {unit}", shown(value, error));
        let remark = match (after.is_at_bound(&name), error.is_finite()) {
            (true, _) => ", at its bound",
            (false, false) => ", not determined",
            (false, true) => "",
        };
        out.push_str(&format!("{}{remark}\n", line.trim_end()));
    }
    for (name, value) in at_bounds(outcome) {
        let unit = study.unit(name);
        let line = format!("  the fit has left {name} at its bound: {value} {unit}");
        out.push_str(&format!("{}\n", line.trim_end()));
    }
    for limit in study.limits() {
        out.push_str(&format!("  {limit}\n"));
    }
    out.push_str("  reduced chi-square       before      after\n");
    let pairs = study.data.splits().map(|s| (s.name(), before.chi2(s), after.chi2(s)));
    for (name, before, after) in pairs {
        out.push_str(&format!("    {name:<12} {before:16.4} {after:10.4}\n"));
    }
    out.push_str("  rmse                     before      after\n");
    for split in study.data.splits() {
        for (k, signal) in study.plan.signals.iter().enumerate() {
            let label = format!("{}, {}", signal.column, split.name());
            let [before, after] = [before, after].map(|hypothesis| {
                rmse_shown(hypothesis.sums(split).of_signal(k) * study.data.sigmas[k])
            });
            let unit = &signal.unit_name;
            out.push_str(&format!("    {label:<19} {before:>9} {after:>10} {unit}\n"));
        }
    }
    if outcome.verdict() == Verdict::Complete {
        let limit = study.policy.validation_limit(after.validation.count());
        // Where the plan declares another noise than there is, that of the fitted recordings is the measure.
        if after.chi2_validation() > limit * after.chi2_train().max(1.0) {
            out.push_str("  the recordings that were never fitted are described worse\n");
        }
    }
    for line in noise_lines(outcome) {
        out.push_str(&format!("  {line}\n"));
    }
    for line in lines(outcome) {
        out.push_str(&format!("  {line}\n"));
    }
    for repair in &study.data.repairs {
        out.push_str(&format!("  {repair}\n"));
    }
    out.push_str(&format!("  {seconds:.1} s\n"));
    out
}

/// The free parameters of the plan that the best fit has pushed against their bounds, with their values in SI units.
fn at_bounds(outcome: &Outcome) -> Vec<(&str, f64)> {
    let after = &outcome.diagnosis.after;
    let names = outcome.study.plan.free.iter().filter_map(|free| free.targets.first());
    let at_bound = names.filter(|name| after.is_at_bound(name));
    at_bound.filter_map(|name| Some((name.as_str(), after.estimate(name)?.0))).collect()
}

/// Remark on a result of a search that was ended early.
pub const ENDED_EARLY: &str = "the search was ended early: this is the best verdict so far";

/// What precedes the sentence about an effect that leaves structure unexplained.
pub fn partial(outcome: &Outcome) -> &'static str {
    if outcome.verdict() == Verdict::Unexplained { "partial explanation: " } else { "" }
}

/// A line for each signal with noticeably more or less noise than the plan declares.
pub fn noise_lines(outcome: &Outcome) -> Vec<String> {
    let factors = outcome.diagnosis.noise.factors(&outcome.study);
    let line = |(column, factor): (&str, f64)| {
        format!("the noise of {column} is {factor:.2} times what the plan says")
    };
    factors.into_iter().map(line).collect()
}

/// A text with a capital letter at its start.
pub fn sentence_case(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    first + characters.as_str()
}
