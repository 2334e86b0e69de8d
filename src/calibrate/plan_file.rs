//! Reads plan files.

use std::path::Path;
use std::sync::Arc;

use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::document::{Item, Section};
use crate::base::source::{SourceMap, Span};
use crate::base::toml_file::{Reader, read as read_toml};
use crate::numeric::time_series::Interpolation;

use super::cancellation::Cancellation;
use super::cause::{PlanCause, RecordingCause};
use super::data::Split;
use super::plan::{Condition, DrivenInput, Free, InitialValue, ListedRecording, Plan, Signal};
use super::unit::Unit;

/// Reads a plan file. Errors are added to `problems`.
pub fn read(
    path: &Path,
    text: &str,
    sources: &mut SourceMap,
    problems: &mut Problems,
) -> Option<Plan> {
    read_toml(path, text, sources, problems, |r, root| plan(r, &root, path))
}

/// The table of `[free]` with the parameters that are free for each recording; a keyword of Modelica, so no
/// parameter has this name.
const EACH: &str = "each";

const TOP: [&str; 15] = [
    "model",
    "name",
    "libraries",
    "fixed",
    "data",
    "recordings",
    "window",
    "skip",
    "every",
    "conditions",
    "inputs",
    "starts",
    "time",
    "signals",
    "free",
];

/// What entries of the tables of columns and parameters are.
const ENTRY: &str = "a table `{ ... }`";

fn plan(r: &mut Reader<'_>, root: &Section<'_>, path: &Path) -> Plan {
    r.known(root, &TOP);
    let base = path.parent().unwrap_or(Path::new(""));
    let model = r.required(root, "model");
    let recordings = recordings_of(r, root);
    let (mut time, mut time_unit) = (String::new(), None);
    if let Some(at) = required_table(r, root, "time") {
        r.known(&at, &["column", "unit"]);
        time = r.required(&at, "column");
        time_unit = unit(r, &at).map(|(u, _)| u);
    }
    let (free, each) = all_free(r, root);
    let libraries = r.texts(root, "libraries").unwrap_or_default();
    let plan = Plan {
        path: path.to_owned(),
        memory: Arc::default(),
        model: base.join(model),
        fmu: None,
        name: r.text(root, "name"),
        libraries: libraries.into_iter().map(|f| base.join(f)).collect(),
        fixed: r.settings(root, "fixed"),
        folder: base.join(recordings.folder),
        listed: listed(r, root),
        window: window(r, root).unwrap_or(f64::INFINITY),
        skip: positive(r, root, "skip").unwrap_or(0.0),
        every: count(r, root, "every").unwrap_or(1),
        table: recordings.table,
        file_column: recordings.file,
        name_column: recordings.name,
        split_column: recordings.split,
        conditions: conditions(r, root),
        inputs: inputs(r, root),
        starts: starts(r, root),
        time,
        time_unit: time_unit.unwrap_or(Unit::SECOND),
        signals: signals(r, root),
        free,
        each,
        most_steps: None,
        cancellation: Cancellation::default(),
        allowance: 1,
    };
    contradictions(r, &plan);
    plan
}

/// The folder of the recordings, and their table with its columns.
#[derive(Default)]
struct Recordings {
    folder: String,
    table: String,
    file: String,
    name: Option<String>,
    split: Option<String>,
}

fn recordings_of(r: &mut Reader<'_>, root: &Section<'_>) -> Recordings {
    let mut found = Recordings::default();
    let Some(data) = required_table(r, root, "data") else { return found };
    r.known(&data, &["folder", "table", "file", "recording", "split"]);
    found.folder = r.required(&data, "folder");
    if root.get("recordings").is_none() || data.get("table").is_some() {
        found.table = r.required(&data, "table");
        found.file = r.required(&data, "file");
    } else if ["file", "recording", "split"].iter().any(|key| data.get(key).is_some()) {
        // Columns of a table that the plan does not have.
        r.missing("table", &data);
    }
    found.name = r.text(&data, "recording");
    found.split = r.text(&data, "split");
    found
}

fn conditions(r: &mut Reader<'_>, root: &Section<'_>) -> Vec<Condition> {
    let mut out = Vec::new();
    for (column, own) in r.tables(root, "conditions", ENTRY) {
        r.known(&own, &["parameter", "unit"]);
        let parameter = r.required(&own, "parameter");
        if let Some((unit, unit_name)) = unit(r, &own) {
            out.push(Condition { column, parameter, unit, unit_name, span: own.place() });
        }
    }
    out
}

fn listed(r: &mut Reader<'_>, root: &Section<'_>) -> Vec<ListedRecording> {
    let mut out = Vec::new();
    for own in r.sections(root, "recordings") {
        r.known(&own, &["file", "name", "split", "from", "to", "window", "skip"]);
        let file = r.required(&own, "file");
        let known = "\"train\", \"validation\" or \"test\"";
        let split = r.value(&own, "split", known, |item| Split::named(Some(&item.text()?)));
        let [from, to] = ["from", "to"].map(|key| r.number(&own, key));
        out.push(ListedRecording {
            name: r.text(&own, "name").unwrap_or_else(|| file.clone()),
            file,
            split: split.or(Split::named(None)).unwrap_or(Split::Train),
            part: (from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY)),
            window: window(r, &own),
            skip: positive(r, &own, "skip"),
        });
    }
    out
}

fn inputs(r: &mut Reader<'_>, root: &Section<'_>) -> Vec<DrivenInput> {
    let mut out = Vec::new();
    for (column, own) in r.tables(root, "inputs", ENTRY) {
        r.known(&own, &["input", "unit", "interpolation", "smooth", "every", "absent"]);
        let input = r.required(&own, "input");
        let wanted = r.required(&own, "interpolation");
        let found = Interpolation::ALL.iter().find(|(name, _)| *name == wanted);
        if found.is_none() && !wanted.is_empty() {
            let known = Interpolation::ALL.map(|(name, _)| name).join(", ");
            report(r, PlanCause::UnknownInterpolation { name: wanted, known }, own.place());
        }
        let smooth = positive(r, &own, "smooth").unwrap_or(0.0);
        let every = count(r, &own, "every").unwrap_or(1).max(1);
        let absent = r.number(&own, "absent");
        if let (Some((unit, _)), Some((_, interpolation))) = (unit(r, &own), found) {
            let (interpolation, span) = (*interpolation, own.place());
            out.push(DrivenInput {
                column,
                input,
                unit,
                interpolation,
                smooth,
                every,
                absent,
                span,
            });
        }
    }
    out
}

fn starts(r: &mut Reader<'_>, root: &Section<'_>) -> Vec<InitialValue> {
    let mut out = Vec::new();
    for (target, own) in r.tables(root, "starts", ENTRY) {
        r.known(&own, &["column", "unit", "rate", "smooth"]);
        let column = r.required(&own, "column");
        let rate = r.flag(&own, "rate");
        let smooth = positive(r, &own, "smooth").unwrap_or(0.0);
        if let Some((unit, _)) = unit(r, &own) {
            out.push(InitialValue { target, column, unit, rate, smooth, span: own.place() });
        }
    }
    out
}

fn signals(r: &mut Reader<'_>, root: &Section<'_>) -> Vec<Signal> {
    let mut out = Vec::new();
    for (column, own) in r.tables(root, "signals", ENTRY) {
        r.known(&own, &["variable", "unit", "sigma", "smooth"]);
        let smooth = positive(r, &own, "smooth").unwrap_or(0.0);
        let variable = r.required(&own, "variable");
        let sigma = r.number(&own, "sigma");
        if sigma.is_some_and(|sigma| !(sigma > 0.0 && sigma.is_finite())) {
            report(r, PlanCause::NoiseNotPositive, place(&own, "sigma"));
        }
        if let Some((unit, unit_name)) = unit(r, &own) {
            let span = own.place();
            out.push(Signal { column, variable, unit, unit_name, sigma, smooth, span });
        }
    }
    if out.is_empty() && r.is_clean() {
        report(r, PlanCause::NoSignals, root.place());
    }
    out
}

/// The parameters that are free for all recordings together, and those that are free for each.
fn all_free(r: &mut Reader<'_>, root: &Section<'_>) -> (Vec<Free>, Vec<Free>) {
    let (each, shared): (Vec<_>, Vec<_>) =
        r.tables(root, "free", ENTRY).into_iter().partition(|(name, _)| name == EACH);
    let of_each = if each.is_empty() {
        Vec::new()
    } else {
        let all = r.section(root, "free");
        all.map(|all| r.tables(&all, EACH, ENTRY)).unwrap_or_default()
    };
    (free(r, shared), free(r, of_each))
}

fn free(r: &mut Reader<'_>, entries: Vec<(String, Section<'_>)>) -> Vec<Free> {
    let mut out = Vec::new();
    for (name, own) in entries {
        r.known(&own, &["start", "min", "max", "tied"]);
        let mut targets = r.texts(&own, "tied").unwrap_or_default();
        if targets.is_empty() {
            targets.push(name.clone());
        }
        let [start, min, max] = ["start", "min", "max"].map(|key| r.number(&own, key));
        let low = min.unwrap_or(f64::NEG_INFINITY);
        let high = max.unwrap_or(f64::INFINITY);
        let is_room = low < high;
        if !is_room || start.is_some_and(|s| !(low..=high).contains(&s)) {
            report(r, PlanCause::ContradictoryBounds { name: name.clone() }, own.place());
        }
        let (around, acts_on, only, span) = (None, None, None, own.place());
        out.push(Free { name, targets, start, min, max, around, acts_on, only, span });
    }
    out
}

/// Entries that are valid alone and contradict each other.
fn contradictions(r: &mut Reader<'_>, plan: &Plan) {
    for (k, driven) in plan.inputs.iter().enumerate() {
        if let Some(first) = plan.inputs[..k].iter().find(|d| d.input == driven.input) {
            let (input, first) = (driven.input.clone(), first.column.clone());
            report(r, PlanCause::DrivenTwice { input, first }, driven.span);
        }
    }
    let free = || plan.free.iter().chain(&plan.each);
    let starts = plan.starts.iter().map(|s| (&s.target, s.span));
    let conditions = plan.conditions.iter().map(|c| (&c.parameter, c.span));
    for (target, span) in starts.chain(conditions) {
        if free().any(|f| f.targets.contains(target)) {
            report(r, PlanCause::FreeAndSet { name: target.clone() }, span);
        }
    }
    for (k, later) in free().enumerate() {
        let known = |target: &&String| free().take(k).any(|f| f.targets.contains(target));
        if let Some(target) = later.targets.iter().find(known) {
            report(r, PlanCause::FreeTwice { name: target.clone() }, later.span);
        }
    }
    if let Some(first) = plan.conditions.first().filter(|_| plan.table.is_empty()) {
        report(r, PlanCause::ConditionsWithoutTable, first.span);
    }
    for signal in plan.signals.iter().filter(|s| s.smooth > 0.0 && s.sigma.is_none()) {
        let column = signal.column.clone();
        let cause = RecordingCause::UnknownNoise { column, is_smoothed: true };
        r.report(Diagnostic::new(cause, signal.span));
    }
}

fn report(r: &mut Reader<'_>, cause: PlanCause, place: Span) {
    r.report(Diagnostic::new(cause, place));
}

/// The place of the value of a key, which is there.
fn place(section: &Section<'_>, key: &str) -> Span {
    section.get(key).map_or(section.place(), |item: Item<'_>| item.place())
}

fn required_table<'t>(r: &mut Reader<'_>, root: &Section<'t>, key: &str) -> Option<Section<'t>> {
    if root.get(key).is_none() {
        r.missing(key, root);
    }
    r.section(root, key)
}

/// A number that is not negative.
fn positive(r: &mut Reader<'_>, section: &Section<'_>, key: &str) -> Option<f64> {
    let number = r.number(section, key)?;
    if number >= 0.0 && number.is_finite() {
        return Some(number);
    }
    report(r, PlanCause::NegativeNumber { key: key.to_owned() }, place(section, key));
    None
}

/// The length of windows.
fn window(r: &mut Reader<'_>, section: &Section<'_>) -> Option<f64> {
    let number = r.number(section, "window")?;
    if number > 0.0 {
        return Some(number);
    }
    report(r, PlanCause::WindowNotPositive, place(section, "window"));
    None
}

/// A positive Integer.
fn count(r: &mut Reader<'_>, section: &Section<'_>, key: &str) -> Option<usize> {
    let number = r.number(section, key)?;
    if number >= 1.0 && number.fract() == 0.0 && number < 1e15 {
        return Some(number as usize);
    }
    report(r, PlanCause::NotACount { key: key.to_owned() }, place(section, key));
    None
}

/// A unit and its name.
fn unit(r: &mut Reader<'_>, section: &Section<'_>) -> Option<(Unit, String)> {
    let name = r.required(section, "unit");
    section.get("unit")?.text()?;
    let unit = Unit::of(&name);
    if unit.is_none() {
        let names: Vec<&str> = Unit::names().collect();
        let near = did_you_mean(&name, names.iter().copied()).map(str::to_owned);
        let (unit, known) = (name.clone(), names.join(", "));
        report(r, PlanCause::UnknownUnit { unit, near, known }, place(section, "unit"));
    }
    unit.map(|u| (u, name))
}
