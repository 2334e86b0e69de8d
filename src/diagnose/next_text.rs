//! The next experiment and the sensors that would help, in words.

use crate::calibrate::table::rmse_shown;

use super::hypothesis::{ChosenEffect, Hypothesis, groups};
use super::next_experiment::{Gain, NextExperiment};
use super::rivals::{Sensor, rivals};
use super::run::Outcome;
use super::separate_starts::SeparateStarts;
use super::study::Study;

/// Lines about the effects that cannot be told apart, the sensors that would tell them apart, starts that differ and the next
/// experiment.
pub fn lines(outcome: &Outcome) -> Vec<String> {
    let rivals = rivals(&outcome.study, &outcome.diagnosis);
    let mut out: Vec<String> = rivals
        .iter()
        .map(|h| format!("the recordings support as well: {}", label(&outcome.study, h)))
        .collect();
    out.extend(outcome.sensors.iter().map(sensor));
    out.extend(outcome.starts.as_ref().map(starts));
    match &outcome.next {
        None => {}
        Some(None) => out.push(
            "next experiment: the plan has no conditions that vary between recordings, so there is nothing to choose"
                .to_owned(),
        ),
        Some(Some(next)) => out.extend(experiment(&outcome.study, next)),
    }
    out
}

fn starts(starts: &SeparateStarts) -> String {
    let quoted: Vec<String> = starts.states.iter().map(|s| format!("\"start({s})\"")).collect();
    format!(
        "the recordings may begin in other states: with {} in [free.each] the model without effects leaves a reduced chi-square of {:.4} (train) and {:.4} (validation)",
        quoted.join(" and "),
        starts.train,
        starts.validation
    )
}

fn sensor(sensor: &Sensor) -> String {
    let difference = format!("{} {}", rmse_shown(sensor.difference), sensor.unit);
    let share = match sensor.share {
        share if share > 1.0 => "more than its range".to_owned(),
        share => format!("{:.0} % of its range", 100.0 * share),
    };
    format!(
        "a sensor of {} would tell them apart: they differ by up to {}, {share}",
        sensor.variable,
        difference.trim_end()
    )
}

fn experiment(study: &Study, next: &NextExperiment) -> Vec<String> {
    let conditions: Vec<String> = next
        .conditions
        .iter()
        .map(|c| match c.unit.as_str() {
            "" | "1" => format!("{} = {}", c.column, c.value),
            unit => format!("{} = {} {unit}", c.column, c.value),
        })
        .collect();
    let mut out = vec![format!("next experiment: {}", conditions.join(", "))];
    if let Some(Gain { best, random }) = next.separation {
        let rivals: Vec<String> = next.rivals.iter().map(|r| label(study, r)).collect();
        out.push(format!(
            "  tells it from {}: expected chi-square difference {best:.3e}, {random:.3e} under random conditions",
            rivals.join(", ")
        ));
    }
    if let Some(narrowed) = &next.narrowed {
        let Gain { best, random } = narrowed.expected;
        out.push(format!(
            "  narrows {}: standard error {:.1e} to {best:.1e}, {random:.1e} under random conditions",
            narrowed.parameter, narrowed.error
        ));
    }
    out
}

/// The effects of a hypothesis and their places.
pub fn label(study: &Study, hypothesis: &Hypothesis) -> String {
    let one = |group: &[ChosenEffect]| {
        if let [only] = group {
            return study.label(only.effect, &only.place);
        }
        let at: Vec<&str> =
            group.iter().flat_map(|c| c.place.at.iter().map(String::as_str)).collect();
        format!("{} at {}", study.effects[group[0].effect].name(), at.join(", "))
    };
    let all: Vec<String> = groups(&hypothesis.effects).map(one).collect();
    if all.is_empty() { "the model without effects".to_owned() } else { all.join(" and ") }
}
