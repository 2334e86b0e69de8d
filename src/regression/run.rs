//! Runs tests: a model and expectations in, those that do not hold out.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::Path;
use std::time::{Duration, Instant};

use super::files;
use super::snapshot::{BLOCKS, EVENTS, FLAT, Snapshot, TRACES, parsed, printed};
use super::test_file::{Bounded, Test, Traces};
use super::traces::{compare, picture, selected};
use crate::base::diag::Problems;
use crate::base::render::{Style, render_all};
use crate::compare::events::{Listed, changes};
use crate::compare::thin::thinned;
use crate::compare::tolerance::Tolerance;
use crate::driver::compile::{Request, Session};
use crate::driver::project;
use crate::driver::quantity::Quantity;
use crate::io::csv::text_of;
use crate::io::format::Format;
use crate::ir::flat::Experiment;
use crate::ir::program::Program;
use crate::ir::trajectory::Trajectory;
use crate::measure::observe::Observer;
use crate::report::chart::Chart;
use crate::simulate::run::simulate_to;
use crate::simulate::settings::Settings;

/// The outcome of a test.
#[derive(Clone, PartialEq, Debug)]
pub struct Outcome {
    /// The expectations that do not hold; empty if the test passed.
    pub findings: Vec<Finding>,
    /// How long it took.
    pub elapsed: Duration,
}

/// An expectation that does not hold.
#[derive(Clone, PartialEq, Debug)]
pub struct Finding {
    /// The key of the expectation in the test file, or `run`.
    pub expectation: &'static str,
    /// Sentences, one a line.
    pub message: String,
    /// The snapshot that differs or is missing, if accepting it is all that is needed.
    pub snapshot: Option<Snapshot>,
    /// The traces before and now.
    pub picture: Option<Chart>,
}

impl Finding {
    fn new(expectation: &'static str, message: impl Into<String>) -> Finding {
        Finding { expectation, message: message.into(), snapshot: None, picture: None }
    }
}

/// Runs a test. `modelica_path` is the value of `MODELICAPATH`.
pub fn run(test: &Test, modelica_path: Option<OsString>) -> Outcome {
    let begun = Instant::now();
    let mut findings = Vec::new();
    let mut session = Session::default();
    let project = project::of(test.model.as_deref(), &mut session.sources, &mut session.problems);
    let request = Request {
        folders: test.libraries.iter().chain(&project.libraries).cloned().collect(),
        readable: project.allow_read,
        modelica_path,
        settings: test.settings.clone(),
        check_units: test.expected.diagnostics.is_some(),
        ..Request::new(test.model.clone(), test.model_name.clone())
    };
    let trajectory = simulated(test, &request, &mut session);
    diagnostics(test, &session, trajectory.is_some(), &mut findings);
    if let Some(trajectory) = trajectory {
        if let Some(shift) = test.expected.events {
            findings.extend(events(test, &trajectory, shift));
        }
        if let Some(traces) = &test.expected.traces {
            findings.extend(trace(test, traces, &trajectory));
        }
        if !test.expected.measures.is_empty() {
            measures(test, &request, &mut findings);
        }
        if test.expected.flat || test.expected.blocks {
            texts(test, &request, &mut findings);
        }
    }
    Outcome { findings, elapsed: begun.elapsed() }
}

/// Compiles and runs the model. Diagnostics of the run join those of the session.
fn simulated(test: &Test, request: &Request, session: &mut Session) -> Option<Trajectory> {
    let program = session.compile(request).ok()?;
    let mut trajectory = Trajectory::default();
    let settings = settings(test, &program);
    match simulate_to(&program, &settings, &session.sources, &mut trajectory) {
        Ok(statistics) => {
            statistics.warnings.into_iter().for_each(|w| session.problems.push(w));
            Some(trajectory)
        }
        Err(failure) => {
            session.problems.push(*failure.diagnostic);
            None
        }
    }
}

/// Compares the measures with their bounds, in a run of their own: their conditions have events.
fn measures(test: &Test, request: &Request, findings: &mut Vec<Finding>) {
    let texts = test.expected.measures.iter().map(|m| format!("{} = {}", m.name, m.expression));
    let mut session = Session::default();
    let compiled = session.compile_measured(request, &texts.collect::<Vec<_>>());
    let outcome = compiled.ok().and_then(|(program, plan)| {
        let mut settings = settings(test, &program);
        plan.ask(&mut settings);
        let mut rows = Trajectory::default();
        let mut observer = Observer::new(&plan, &program, &mut rows);
        match simulate_to(&program, &settings, &session.sources, &mut observer) {
            Ok(statistics) => {
                let values = plan.evaluate(&program, &settings, &observer, &statistics);
                let units = plan.columns.iter().map(|c| c.unit.clone());
                Some(values.into_iter().zip(units).collect::<Vec<_>>())
            }
            Err(failure) => {
                session.problems.push(*failure.diagnostic);
                None
            }
        }
    });
    match outcome {
        Some(values) => {
            let pairs = test.expected.measures.iter().zip(values);
            findings.extend(
                pairs.filter_map(|(bounded, (value, unit))| measure(bounded, value, &unit)),
            );
        }
        None => {
            let text = render_all(&session.problems, &session.sources, Style::Plain);
            findings.push(Finding::new("measures", text.trim_end()));
        }
    }
}

fn settings(test: &Test, program: &Program) -> Settings {
    let experiment = &program.blocks.dae.experiment;
    Settings::of(&Experiment {
        start: experiment.start,
        stop: test.stop.or(experiment.stop),
        interval: test.interval.or(experiment.interval),
        tolerance: test.tolerance.or(experiment.tolerance),
    })
}

/// Compares the codes of all diagnostics, or reports errors.
fn diagnostics(test: &Test, session: &Session, ended: bool, findings: &mut Vec<Finding>) {
    let shown = |problems: &Problems| render_all(problems, &session.sources, Style::Plain);
    let Some(expected) = &test.expected.diagnostics else {
        if !ended {
            findings.push(Finding::new("run", shown(&session.problems).trim_end()));
        }
        return;
    };
    let expected: BTreeSet<&str> = expected.iter().map(String::as_str).collect();
    let found: BTreeSet<&str> = session.problems.iter().map(|d| d.code).collect();
    let missing: Vec<&str> = expected.difference(&found).copied().collect();
    let mut lines = Vec::new();
    if !missing.is_empty() {
        lines.push(format!("{} was expected and is not reported", missing.join(", ")));
    }
    let mut others = Problems::new();
    let unexpected = session.problems.iter().filter(|d| !expected.contains(d.code));
    unexpected.for_each(|d| others.push(d.clone()));
    if others.iter().next().is_some() {
        lines.push(shown(&others).trim_end().to_owned());
    }
    if !lines.is_empty() {
        findings.push(Finding::new("diagnostics", lines.join("\n")));
    }
}

/// Compares the snapshots of the flat model and of the blocks.
fn texts(test: &Test, request: &Request, findings: &mut Vec<Finding>) {
    let mut session = Session::default();
    let Ok(flat) = session.flatten(request) else { return };
    if test.expected.flat {
        match crate::flatten::print::print(&flat) {
            Ok(text) => findings.extend(snapshot("flat", FLAT, test, text)),
            Err(why) => findings.push(Finding::new("flat", why.to_string())),
        }
    }
    if test.expected.blocks
        && let Ok(blocks) = session.sort(flat)
    {
        let text = crate::structure::print::print(&blocks, &session.sources);
        findings.extend(snapshot("blocks", BLOCKS, test, without_folders(&text, test)));
    }
}

/// Places in files by the name of the file alone: a snapshot must not depend on where the test runs.
fn without_folders(text: &str, test: &Test) -> String {
    let folders = test.model.iter().filter_map(|file| file.parent());
    let mut out = text.to_owned();
    for folder in folders.chain(test.libraries.iter().map(|f| f.as_path())) {
        if folder != Path::new("") {
            out = out.replace(&format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR), "");
        }
    }
    out
}

/// Compares a text with its snapshot.
fn snapshot(key: &'static str, kind: &str, test: &Test, after: String) -> Option<Finding> {
    let path = Snapshot::path(test, kind);
    let before = match files::text(&path) {
        Ok(before) => before.map(|text| text.replace("\r\n", "\n")),
        Err(why) => return Some(Finding::new(key, why)),
    };
    if before.as_deref() == Some(after.as_str()) {
        return None;
    }
    let message = match &before {
        None => missing(&path),
        Some(_) => format!("differs from {}", path.display()),
    };
    let snapshot = Some(Snapshot { path, before, after });
    Some(Finding { snapshot, ..Finding::new(key, message) })
}

fn missing(path: &Path) -> String {
    format!("there is no snapshot {} yet; `mocc test --update` writes it", path.display())
}

/// Compares the events with their snapshot.
fn events(test: &Test, run: &Trajectory, shift: Option<f64>) -> Option<Finding> {
    let found: Vec<Listed> = run.events.iter().map(|e| (e.time, e.what.clone())).collect();
    let finding = snapshot("events", EVENTS, test, printed(&found))?;
    let Some(before) = finding.snapshot.as_ref().and_then(|s| s.before.as_deref()) else {
        return Some(finding);
    };
    let shift = Tolerance { time: shift, ..Tolerance::default() }.shift(&run.time);
    let lines = match parsed(before) {
        Ok(expected) => {
            let changes = changes(&found, &expected, shift);
            changes.iter().map(|(_, change)| change.to_string()).collect::<Vec<_>>()
        }
        Err(why) => vec![format!("{}: {why}", Snapshot::path(test, EVENTS).display())],
    };
    (!lines.is_empty()).then(|| Finding { message: lines.join("\n"), ..finding })
}

/// Compares traces with their snapshot, or with a file of another program.
fn trace(test: &Test, traces: &Traces, run: &Trajectory) -> Option<Finding> {
    let key = "traces";
    let columns = match selected(traces, &run.columns) {
        Ok(columns) => columns,
        Err(why) => return Some(Finding::new(key, why)),
    };
    let is_snapshot = traces.reference.is_none();
    let path = traces.reference.clone().unwrap_or_else(|| Snapshot::path(test, TRACES));
    let mut after = String::new();
    if is_snapshot {
        match text_of(&thinned(run, &columns)) {
            Ok(text) => after = text,
            Err(why) => return Some(Finding::new(key, why.to_string())),
        }
        if !files::exists(&path) {
            let snapshot = Snapshot { before: None, after, path: path.clone() };
            return Some(Finding { snapshot: Some(snapshot), ..Finding::new(key, missing(&path)) });
        }
    }
    let named = |name: &str| {
        let of_run = |own: &str| run.position(own).is_some();
        of_run(name) || traces.names.iter().any(|(_, other)| other == name)
    };
    let reference = match Format::read(&path, &named) {
        Ok(reference) => reference,
        Err(why) => return Some(Finding::new(key, why)),
    };
    let mut found = compare(run, &columns, &reference, &traces.names);
    if is_snapshot {
        // A variable that is no longer recorded, or no longer asked for.
        for gone in reference
            .columns
            .iter()
            .filter(|c| !columns.iter().any(|(k, _)| run.columns[*k].name == c.name))
        {
            found
                .messages
                .push(format!("`{}` of the snapshot is not compared any more", gone.name));
        }
    }
    if found.messages.is_empty() {
        return None;
    }
    let picture =
        (!found.departures.is_empty()).then(|| picture(&test.name, run, &reference, &found));
    let before = files::text(&path).ok().flatten().filter(|_| is_snapshot);
    let snapshot = is_snapshot.then_some(Snapshot { path, before, after });
    Some(Finding { snapshot, picture, ..Finding::new(key, found.messages.join("\n")) })
}

/// Compares a measure with its bounds.
///
/// A bound whose unit measures something else is an error of its own; the unit of a composed measure is not known.
fn measure(bounded: &Bounded, value: Option<f64>, unit: &str) -> Option<Finding> {
    let Bounded { name, min, max, never, .. } = bounded;
    let own = |bound: &Option<Quantity>| match bound {
        None => Ok(None),
        Some(bound) if unit.is_empty() => Ok(Some(bound.value)),
        Some(bound) => bound.in_unit(unit).map(Some).ok_or_else(|| {
            format!("`{name}` is in `{unit}`, which `{}` does not measure", bound.unit)
        }),
    };
    let (min, max) = match (own(min), own(max)) {
        (Ok(min), Ok(max)) => (min, max),
        (Err(why), _) | (_, Err(why)) => return Some(Finding::new("measures", why)),
    };
    let message = match value {
        None if *never => return None,
        None => format!("`{name}` has no value: its condition never became true"),
        Some(value) if *never => format!("`{name}` = {value}, but must not happen"),
        Some(value) => match (min, max) {
            (Some(min), _) if value < min => format!("`{name}` = {value} is less than {min}"),
            (_, Some(max)) if value > max => format!("`{name}` = {value} is greater than {max}"),
            _ => return None,
        },
    };
    Some(Finding::new("measures", message))
}
