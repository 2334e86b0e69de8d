//! Reads test files.
//!
//! A file names a model and holds tests; a test is a run, or a run for each combination of varied parameters, and what is
//! expected of it. `docs/guide/test.md` describes the keys.

use std::path::{Path, PathBuf};

use super::cause::TestCause;
use super::files;
use crate::base::diag::{Diagnostic, Problems};
use crate::base::document::{Item, Section};
use crate::base::source::SourceMap;
use crate::base::toml_file::{Reader, read as read_toml};
use crate::compare::tolerance::Tolerance;
use crate::driver::quantity::{self, Quantity};

/// A run of a test, and what is expected of it.
#[derive(Clone, PartialEq, Debug)]
pub struct Test {
    /// The test file.
    pub file: PathBuf,
    /// Its name, with the varied parameters in brackets.
    pub name: String,
    /// The file of the model; none if the model is one of a library.
    pub model: Option<PathBuf>,
    /// Full name of the model; without it the last one of the file.
    pub model_name: Option<String>,
    /// Folders of libraries.
    pub libraries: Vec<PathBuf>,
    /// `NAME=VALUE`.
    pub settings: Vec<String>,
    /// End of the run, s.
    pub stop: Option<f64>,
    /// Time between rows, s.
    pub interval: Option<f64>,
    /// Relative tolerance of the integration.
    pub tolerance: Option<f64>,
    /// What is expected.
    pub expected: Expected,
}

/// The expectations of a test.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Expected {
    /// The codes of all diagnostics, sorted; without it there may be warnings, but no errors.
    pub diagnostics: Option<Vec<String>>,
    /// A snapshot of the flat model.
    pub flat: bool,
    /// A snapshot of states and sorted blocks.
    pub blocks: bool,
    /// A snapshot of the events, which may move by this time, s; without it a part of the simulated time.
    pub events: Option<Option<f64>>,
    /// Traces.
    pub traces: Option<Traces>,
    /// Measures within bounds.
    pub measures: Vec<Bounded>,
}

/// Variables over time that are compared with a snapshot or with a file.
#[derive(Clone, PartialEq, Debug)]
pub struct Traces {
    /// Names, in which `*` means any characters; empty: the variables of the model itself.
    pub variables: Vec<String>,
    /// The tolerance of all variables.
    pub tolerance: Tolerance,
    /// Variables with tolerances of their own.
    pub each: Vec<(String, Tolerance)>,
    /// A result of another program instead of a snapshot.
    pub reference: Option<PathBuf>,
    /// Variables that have another name in the reference.
    pub names: Vec<(String, String)>,
}

/// A measure and its bounds.
#[derive(Clone, PartialEq, Debug)]
pub struct Bounded {
    /// Its name.
    pub name: String,
    /// Its expression, as after `--measure`.
    pub expression: String,
    /// Its least value.
    pub min: Option<Quantity>,
    /// Its greatest value.
    pub max: Option<Quantity>,
    /// Its condition must never become true.
    pub never: bool,
}

const TOP: [&str; 5] = ["model", "name", "libraries", "tolerances", "test"];
/// The keys of each test, wherever it is written.
pub(super) const TEST: [&str; 11] = [
    "set",
    "vary",
    "stop",
    "interval",
    "tolerance",
    "diagnostics",
    "flat",
    "blocks",
    "events",
    "traces",
    "measures",
];
/// The keys of a test in a file, before the others.
const SUBJECT: [&str; 3] = ["name", "model", "model_name"];
const TOLERANCES: [&str; 3] = ["relative", "absolute", "time"];

/// Reads a test file. None if it has errors, which are added to `problems`.
pub fn read(
    path: &Path,
    text: &str,
    sources: &mut SourceMap,
    problems: &mut Problems,
) -> Option<Vec<Test>> {
    read_toml(path, text, sources, problems, |reader, root| tests(reader, &root, path))
}

fn tests(r: &mut Reader<'_>, root: &Section<'_>, path: &Path) -> Vec<Test> {
    r.known(root, &TOP);
    let base = path.parent().unwrap_or(Path::new(""));
    let model = r.text(root, "model").map(|file| base.join(file));
    let name = r.text(root, "name");
    let folders = r.texts(root, "libraries").unwrap_or_default();
    let libraries: Vec<PathBuf> = folders.into_iter().map(|folder| base.join(folder)).collect();
    let general = tolerances(r, root);
    let sections = r.sections(root, "test");
    if root.get("test").is_none() {
        r.missing("[[test]]", root);
    }
    let mut out = Vec::new();
    for section in sections {
        r.known(&section, &[&SUBJECT[..], &TEST].concat());
        let title = r.required(&section, "name");
        let own_model = r.text(&section, "model").map(|file| base.join(file));
        let model_name = r.text(&section, "model_name").or_else(|| name.clone());
        let file = match own_model.or_else(|| model.clone()) {
            Some(file) => Some(file),
            None if model_name.is_some() => None,
            None => own_file(r, &section, path),
        };
        let libraries = libraries.clone();
        let subject = Subject { file: path, model: file, model_name, libraries };
        add_runs(r, &section, title, subject, general, &mut out);
    }
    out
}

/// What a test is about.
pub(super) struct Subject<'p> {
    /// The file of the test.
    pub file: &'p Path,
    /// The file of the model.
    pub model: Option<PathBuf>,
    /// Full name of the model.
    pub model_name: Option<String>,
    /// Folders of libraries.
    pub libraries: Vec<PathBuf>,
}

/// Adds the runs of a test to those of its file.
pub(super) fn add_runs(
    r: &mut Reader<'_>,
    section: &Section<'_>,
    title: String,
    subject: Subject<'_>,
    general: Tolerance,
    out: &mut Vec<Test>,
) {
    let base = subject.file.parent().unwrap_or(Path::new(""));
    let test = Test {
        file: subject.file.to_owned(),
        model: subject.model,
        model_name: subject.model_name,
        libraries: subject.libraries,
        settings: r.settings(section, "set"),
        stop: r.size(section, "stop"),
        interval: r.size(section, "interval"),
        tolerance: r.size(section, "tolerance"),
        expected: expected(r, section, &title, general, base),
        name: title,
    };
    for run in varied(r, section, test) {
        let stem = file_name(&run.name);
        if out.iter().any(|known| file_name(&known.name) == stem) {
            let cause = TestCause::DuplicateTest { name: run.name.clone() };
            r.report(Diagnostic::new(cause, section.place()));
        }
        out.push(run);
    }
}

/// The tolerances for all tests of a file.
pub(super) fn tolerances(r: &mut Reader<'_>, root: &Section<'_>) -> Tolerance {
    let general = Tolerance::default();
    let Some(section) = r.section(root, "tolerances") else { return general };
    r.known(&section, &TOLERANCES);
    tolerance(r, &section, general)
}

/// The file of the same name as that of the tests.
fn own_file(r: &mut Reader<'_>, section: &Section<'_>, path: &Path) -> Option<PathBuf> {
    let stem = files::stem(path);
    let candidates =
        ["mol", "mo"].map(|extension| path.with_file_name(format!("{stem}.{extension}")));
    let found = candidates.iter().find(|file| files::exists(file)).cloned();
    if found.is_none() {
        let wanted = candidates.map(|file| format!("`{}`", file.display())).join(" nor ");
        let place = section.place();
        r.report(Diagnostic::new(TestCause::NoModelOfTests { wanted }, place));
    }
    found
}

/// A test for each combination of the values in `vary`.
fn varied(r: &mut Reader<'_>, section: &Section<'_>, test: Test) -> Vec<Test> {
    let Some(vary) = r.section(section, "vary") else { return vec![test] };
    let mut runs = vec![(Vec::new(), test)];
    for (name, item) in vary.entries() {
        let values =
            item.list().and_then(|list| list.iter().map(Item::written).collect::<Option<Vec<_>>>());
        let Some(values) = values.filter(|values| !values.is_empty()) else {
            r.wrong(&name, item, "a list of values");
            continue;
        };
        let with = |(labels, test): &(Vec<String>, Test), value: &String| {
            let (mut labels, mut test) = (labels.clone(), test.clone());
            labels.push(format!("{name}={value}"));
            test.settings.push(format!("{name}={value}"));
            (labels, test)
        };
        runs = runs.iter().flat_map(|run| values.iter().map(move |v| with(run, v))).collect();
    }
    let named = |(labels, test): (Vec<String>, Test)| Test {
        name: format!("{}[{}]", test.name, labels.join(", ")),
        ..test
    };
    runs.into_iter().map(named).collect()
}

fn expected(
    r: &mut Reader<'_>,
    section: &Section<'_>,
    name: &str,
    general: Tolerance,
    base: &Path,
) -> Expected {
    let diagnostics = r.texts(section, "diagnostics").map(|mut codes| {
        codes.sort();
        codes.dedup();
        codes
    });
    let events = match section.get("events").map(|item| (item.flag(), item)) {
        None | Some((Some(false), _)) => None,
        Some((Some(true), _)) => Some(general.time),
        Some((None, _)) => r.section(section, "events").map(|events| {
            r.known(&events, &["time"]);
            r.size(&events, "time").or(general.time)
        }),
    };
    let traces = match section.get("traces").map(|item| (item.flag(), item.section())) {
        None | Some((Some(false), _)) => None,
        Some((Some(true), _)) => Some(Traces {
            variables: Vec::new(),
            tolerance: general,
            each: Vec::new(),
            reference: None,
            names: Vec::new(),
        }),
        Some((None, _)) => r.section(section, "traces").map(|s| traces(r, &s, general, base)),
    };
    let expected = Expected {
        diagnostics,
        flat: r.flag(section, "flat"),
        blocks: r.flag(section, "blocks"),
        events,
        traces,
        measures: measures(r, section),
    };
    // A test with an unknown key expects what the key was meant to say.
    let is_known = |key: &str| TEST.contains(&key) || SUBJECT.contains(&key);
    if expected == Expected::default() && section.keys().all(|(key, _)| is_known(key)) {
        let cause = TestCause::NothingExpected { name: name.to_owned() };
        let place = section.place();
        r.report(Diagnostic::new(cause, place));
    }
    expected
}

fn traces(r: &mut Reader<'_>, section: &Section<'_>, general: Tolerance, base: &Path) -> Traces {
    r.known(section, &["variables", "relative", "absolute", "time", "each", "reference", "names"]);
    let general = tolerance(r, section, general);
    let mut each = Vec::new();
    for (name, own) in r.tables(section, "each", "a table `{ ... }`") {
        r.known(&own, &TOLERANCES);
        each.push((name, tolerance(r, &own, general)));
    }
    let mut names = Vec::new();
    for (name, item) in r.entries(section, "names") {
        match item.text() {
            Some(other) => names.push((name, other)),
            None => r.wrong(&name, item, "a string in quotes"),
        }
    }
    Traces {
        variables: r.texts(section, "variables").unwrap_or_default(),
        tolerance: general,
        each,
        reference: r.text(section, "reference").map(|file| base.join(file)),
        names,
    }
}

fn tolerance(r: &mut Reader<'_>, section: &Section<'_>, general: Tolerance) -> Tolerance {
    Tolerance {
        relative: r.size(section, "relative").unwrap_or(general.relative),
        absolute: r.size(section, "absolute").unwrap_or(general.absolute),
        time: r.size(section, "time").or(general.time),
    }
}

fn measures(r: &mut Reader<'_>, section: &Section<'_>) -> Vec<Bounded> {
    let mut out = Vec::new();
    for (name, own) in r.tables(section, "measures", "a table `{ ... }`") {
        r.known(&own, &["is", "min", "max", "never"]);
        let expression = r.required(&own, "is");
        let (min, max) = (bound(r, &own, "min"), bound(r, &own, "max"));
        let never = r.flag(&own, "never");
        if let (Some(min), Some(max)) = (&min, &max)
            && min.value > max.value
        {
            r.report(Diagnostic::new(TestCause::EmptyBounds { name: name.clone() }, own.place()));
        }
        if own.get("min").is_none() && own.get("max").is_none() && !never {
            r.report(Diagnostic::new(TestCause::NoBounds { name: name.clone() }, own.place()));
        }
        out.push(Bounded { name, expression, min, max, never });
    }
    out
}

/// A number, or a string with a unit.
fn bound(r: &mut Reader<'_>, section: &Section<'_>, key: &str) -> Option<Quantity> {
    let item = section.get(key)?;
    let value = match item.text() {
        Some(text) => quantity::read(&text),
        None => item.number().map(Quantity::plain),
    };
    if value.is_none() {
        let text = item.written().unwrap_or_else(|| key.to_owned());
        let place = item.place();
        r.report(Diagnostic::new(TestCause::NotAQuantity { text }, place));
    }
    value
}

/// A name as the stem of a file.
pub fn file_name(name: &str) -> String {
    let keep = |c: char| c.is_alphanumeric() || matches!(c, '.' | '-' | '+' | '=');
    let mut out = String::new();
    for c in name.chars() {
        let c = if keep(c) { c } else { '_' };
        if c != '_' || !out.ends_with('_') {
            out.push(c);
        }
    }
    out.trim_matches('_').to_owned()
}
