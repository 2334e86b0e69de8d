//! The amended model: the original with the effects that were found.

use crate::calibrate::evaluate::{MEASURED, sensors_text};
use crate::ir::flat::Experiment;

use super::fixed_value::corrected_value;
use super::hypothesis::{ChosenEffect, Hypothesis, groups};
use super::model_source::{Attached, Extension, ParameterValue};
use super::place::Place;
use super::result::{Diagnosis, sentences, unit};
use super::study::Study;
use super::terminal_reading::TerminalReading;

/// The amended model.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct AmendedModel {
    /// Its name, `NAME_with_EFFECT`.
    pub name: String,
    /// The original source, followed by the model that extends it.
    pub source: String,
}

/// The amended model; `original` is the source of the model's file. `None` if no effect was found.
pub fn amended(study: &Study, diagnosis: &Diagnosis, original: &str) -> Option<AmendedModel> {
    let hypothesis = &diagnosis.after;
    let last = hypothesis.effects.last()?;
    let short = |class: &str| class.rsplit('.').next().unwrap_or(class).to_owned();
    let mut name = short(&study.base);
    for group in groups(&hypothesis.effects) {
        name.push_str(if group[0].name == last.name { "_with_" } else { "_and_" });
        name.push_str(&short(&study.effects[group[0].effect].class));
    }
    let mut values = Vec::new();
    // A parameter of single recordings has no value in the model.
    for free in study.plan.free.iter().filter(|f| f.only.is_none()) {
        for target in &free.targets {
            let Some((value, error)) = hypothesis.estimate(target) else { continue };
            let comment = format!("+- {error:.2e}");
            values.push(ParameterValue { name: target.clone(), value, comment });
        }
    }
    let (readings, unchanged) = readings(study, hypothesis);
    let with_own_readings = |chosen: &ChosenEffect| {
        let mut chosen = chosen.clone();
        for (_, variable) in &mut chosen.place.binds {
            let own = unchanged.iter().find(|r| r.name == *variable);
            own.into_iter().for_each(|r| variable.clone_from(&r.variable));
        }
        chosen
    };
    let is_value = |c: &&ChosenEffect| study.effects[c.effect].is_other_value();
    let all: Vec<ChosenEffect> = hypothesis.effects.iter().map(with_own_readings).collect();
    let (other_values, effects): (Vec<_>, Vec<_>) = all.iter().partition(is_value);
    values.extend(other_values.into_iter().filter_map(|c| other_value(study, hypothesis, c)));
    let attached: Vec<Attached<'_>> =
        effects.into_iter().map(|c| with_estimates(study, hypothesis, c)).collect();
    let experiment = experiment(&study.experiment);
    let measured = measured(study, hypothesis, &readings);
    let description = sentences(&study.effects, &hypothesis.effects).join(" ").replace('"', "'");
    let extension = Extension {
        name: &name,
        base: &study.base,
        description: &description,
        experiment: experiment.as_deref(),
        measured: measured.as_deref(),
        values: &values,
        readings: &readings,
        followers: &[],
    };
    let added = extension.source(&attached);
    let source = format!("{}\n\n// Found by mocc diagnose:\n{added}", original.trim_end());
    Some(AmendedModel { name, source })
}

/// The value of a parameter that is not the one of the model.
fn other_value(
    study: &Study,
    hypothesis: &Hypothesis,
    chosen: &ChosenEffect,
) -> Option<ParameterValue> {
    let corrected = corrected_value(study, hypothesis, chosen)?;
    let comment = format!("+- {:.2e}, instead of {}", corrected.error, corrected.in_model);
    Some(ParameterValue { name: corrected.parameter, value: corrected.value, comment })
}

/// An effect with its estimates, and their standard errors as comments.
fn with_estimates<'a>(
    study: &'a Study,
    hypothesis: &Hypothesis,
    chosen: &'a ChosenEffect,
) -> Attached<'a> {
    let effect = &study.effects[chosen.effect];
    let mut values = Vec::new();
    let mut comments = Vec::new();
    for parameter in &chosen.fitted {
        let full = chosen.full_name(parameter);
        let Some((value, error)) = hypothesis.estimate(&full) else { continue };
        values.push((parameter.clone(), value));
        let base = parameter.split('[').next().unwrap_or(parameter).to_owned();
        let unit = unit(effect, parameter);
        let unit = if unit == "1" { String::new() } else { unit };
        comments.push((base, format!("+- {error:.2e} {unit}").trim_end().to_owned()));
    }
    let fixed = chosen.fixed.iter().filter(|(p, _)| !chosen.fitted.contains(p));
    values.extend(fixed.cloned());
    Attached { comments, ..Attached::new(effect, &chosen.place, chosen.prefix.clone(), values) }
}

/// The sensors that read what effects change at the terminals of components, and those that read what the plan names.
fn readings(
    study: &Study,
    hypothesis: &Hypothesis,
) -> (Vec<TerminalReading>, Vec<TerminalReading>) {
    let effects = hypothesis.effects.iter().filter(|c| study.effects[c.effect].in_series);
    let places: Vec<&Place> = effects.map(|c| &c.place).collect();
    let is_changed = |r: &TerminalReading| places.iter().any(|place| r.is_changed_by(place));
    study.readings.iter().cloned().partition(is_changed)
}

/// The entry of the annotation `__mocc` that names the outputs of the sensors that effects are part of.
fn measured(
    study: &Study,
    hypothesis: &Hypothesis,
    readings: &[TerminalReading],
) -> Option<String> {
    let signals = hypothesis.plan.signals.iter().zip(&study.plan.signals);
    let is_reading = |variable: &String| readings.iter().any(|r| r.name == *variable);
    let sensors: Vec<(&str, &str)> = signals
        .filter(|(own, planned)| own.variable != planned.variable || is_reading(&own.variable))
        .map(|(own, _)| (own.column.as_str(), own.variable.as_str()))
        .collect();
    (!sensors.is_empty()).then(|| format!("{MEASURED} = \"{}\"", sensors_text(&sensors)))
}

/// The experiment annotation, if it says anything.
fn experiment(experiment: &Experiment) -> Option<String> {
    let items = [
        ("StartTime", experiment.start),
        ("StopTime", experiment.stop),
        ("Interval", experiment.interval),
        ("Tolerance", experiment.tolerance),
    ];
    let items: Vec<String> =
        items.iter().filter_map(|(n, v)| v.map(|v| format!("{n} = {v}"))).collect();
    (!items.is_empty()).then(|| format!("experiment({})", items.join(", ")))
}
