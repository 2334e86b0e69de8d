//! Compiles and runs a case, and compares.

use std::fmt::Write;

use mocc::base::diag::{Diagnostic, Severity};
use mocc::base::render::{Style, render, render_all};
use mocc::base::source::SourceMap;
use mocc::driver::compile::{CompileError, Request, Session};
use mocc::ir::program::SystemForm;
use mocc::ir::trajectory::Trajectory;
use mocc::simulate::failure::FailureKind;
use mocc::simulate::run::simulate;
use mocc::simulate::settings::{DEFAULT_INTERVALS, Method, Settings};

use super::case::{Run, TestCase};
use super::directive::{Claim, Options, Printed, Rows, Tolerance, Verb};
use super::formula::{Formula, Scope, holds};
use crate::checks::door::Scratch;

/// What a case came to.
#[derive(Default)]
pub struct Verdict {
    /// `FILE:LINE: CASE: ...`.
    pub wrong: Vec<String>,
    /// Everything that is compared as a whole; empty if nothing is.
    pub snapshot: String,
}

/// What one run left behind.
#[derive(Default)]
struct Made {
    status: i32,
    /// Rendered problems.
    messages: String,
    /// Their heads and messages, each with its line in the file.
    problems: Vec<(Option<usize>, String, String)>,
    flat: String,
    structure: String,
    trajectory: Option<Trajectory>,
}

/// Runs a case.
pub fn judge(case: &TestCase) -> Verdict {
    let mut verdict = Verdict::default();
    let scratch = Scratch::new();
    for (k, run) in case.runs.iter().enumerate() {
        let mut made = make(case, run, &case.model, &scratch);
        if k == 0 {
            compare_problems(case, &made, &mut verdict);
            verdict.snapshot = snapshot(case, &mut made);
        } else if made.problems.iter().any(|(_, head, _)| head.starts_with("error")) {
            verdict.complain(case, case.line, format!("a further run fails:\n{}", made.messages));
        }
        claims(case, run, &made, "", &mut verdict);
        if run.options.also_flat {
            let made = make(case, run, &made.flat, &scratch);
            if made.trajectory.is_none() {
                let why = format!("the flat model does not run:\n{}", made.messages);
                verdict.complain(case, case.line, why);
            }
            claims(case, run, &made, " in the flat model", &mut verdict);
        }
    }
    verdict
}

impl Verdict {
    fn complain(&mut self, case: &TestCase, line: usize, why: impl std::fmt::Display) {
        self.wrong.push(format!("{}:{line}: {}: {why}", case.file, case.name));
    }
}

fn make(case: &TestCase, run: &Run, model: &str, scratch: &Scratch) -> Made {
    let options = &run.options;
    let is_flat = !std::ptr::eq(model, case.model.as_str());
    let name = if is_flat { "flat.mo".to_string() } else { format!("{}.mo", case.topic) };
    let file = scratch.file(&name, model);
    let form = if options.dae { SystemForm::Dae } else { SystemForm::Ode };
    let request = match is_flat {
        true => Request { file: Some(file), form, ..Request::default() },
        false => Request {
            file: Some(file),
            form,
            model: options.model.clone(),
            settings: options.settings.clone(),
            ..Request::default()
        },
    };
    let mut made = Made::default();
    let mut session = Session::default();
    let mut warnings: Vec<Diagnostic> = Vec::new();
    let outcome = match run.verb {
        Verb::Check => {
            let units = if options.strict_units { Severity::Error } else { Severity::Warning };
            session.check(&request, units)
        }
        Verb::Flatten => session.flatten(&request).map(|_| ()),
        Verb::Run => session.compile(&request).map(|program| {
            let settings = settings(options, Settings::of(&program.blocks.dae.experiment), || {
                program.blocks.dae.experiment.interval.is_some()
            });
            match simulate(&program, &settings, &session.sources) {
                Ok(run) => {
                    run.trajectory.verify().expect("a trajectory in order");
                    warnings = run.statistics.warnings;
                    made.trajectory = Some(run.trajectory);
                }
                Err(failure) => {
                    made.status = match failure.kind {
                        FailureKind::Numerics | FailureKind::Assertion => 3,
                        FailureKind::Settings => 2,
                        FailureKind::Bug => 4,
                    };
                    warnings = vec![*failure.diagnostic];
                }
            }
        }),
    };
    match outcome {
        Ok(()) => {}
        Err(CompileError::Model) => made.status = 1,
        Err(CompileError::Request) => made.status = 2,
    }
    made.messages = render_all(&session.problems, &session.sources, Style::Plain);
    for warning in &warnings {
        let text = render(warning, &session.sources, Style::Plain);
        write!(made.messages, "{text}\n\n").expect("a String takes all");
    }
    let folder = format!("{}/", scratch.path().display());
    made.messages = made.messages.replace(&folder, "");
    for problem in session.problems.iter().chain(&warnings) {
        made.problems.push(describe(case, problem, &session.sources, &folder));
    }
    if needs(case, run, Printed::Flat)
        && !is_flat
        && let Ok(flat) = Session::default().flatten(&request)
    {
        made.flat = mocc::flatten::print::print(&flat).expect("the text is not too long");
    }
    if needs(case, run, Printed::Structure) && !is_flat {
        let mut session = Session::default();
        if let Ok(blocks) = session.flatten(&request).and_then(|flat| session.sort(flat)) {
            let text = mocc::structure::print::print(&blocks, &session.sources);
            made.structure = text.replace(&folder, "");
        }
    }
    made
}

fn needs(case: &TestCase, run: &Run, printed: Printed) -> bool {
    let shown = match printed {
        Printed::Flat => case.shows_flat || run.options.also_flat,
        Printed::Structure => case.shows_structure,
        Printed::Messages => false,
    };
    shown
        || run
            .claims
            .iter()
            .any(|(_, c)| matches!(c, Claim::Contains { what, .. } if *what == printed))
}

fn settings(
    options: &Options,
    mut settings: Settings,
    has_interval: impl FnOnce() -> bool,
) -> Settings {
    if let Some(stop) = options.stop {
        settings.stop = stop;
        if !has_interval() {
            settings.interval = (stop - settings.start) / DEFAULT_INTERVALS;
        }
    }
    settings.interval = options.interval.unwrap_or(settings.interval);
    settings.tolerance = options.tolerance.unwrap_or(settings.tolerance);
    settings.method = match options.method.as_deref() {
        None => settings.method,
        Some("radau") => Method::Radau,
        Some("bdf") => Method::Bdf,
        Some("dopri") => Method::Dopri,
        Some(other) => panic!("`{other}` is not a method"),
    };
    settings
}

/// The line in the file of a problem, its head with its place, and its message.
fn describe(
    case: &TestCase,
    d: &Diagnostic,
    sources: &SourceMap,
    folder: &str,
) -> (Option<usize>, String, String) {
    let severity = match d.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let head = format!("{severity}[{}]", d.code);
    let span = d.primary.0;
    let Some(file) = sources.get(span.file) else {
        return (None, head, d.message.clone());
    };
    let (line, column) = file.line_column(span.start);
    let (last, end) = file.line_column(span.end);
    let columns = match () {
        () if last > line => format!("{column}-"),
        () if end > column + 1 => format!("{column}-{}", end - 1),
        () => column.to_string(),
    };
    let path = file.path.display().to_string();
    match path.strip_prefix(folder) {
        Some(_) => {
            let line = case.lines.get(line - 1).copied().unwrap_or(case.line);
            (Some(line), format!("{head} {line}:{columns}"), d.message.clone())
        }
        None => (None, format!("{head} {path}:{line}:{columns}"), d.message.clone()),
    }
}

fn compare_problems(case: &TestCase, made: &Made, verdict: &mut Verdict) {
    let mut left: Vec<_> = made.problems.iter().collect();
    for expected in &case.problems {
        let fits = |(_, head, message): &&(Option<usize>, String, String)| {
            *head == expected.shown && expected.message.as_ref().is_none_or(|m| m == message)
        };
        match left.iter().position(fits) {
            Some(k) => {
                left.remove(k);
            }
            None => {
                let message = expected.message.as_deref().unwrap_or_default();
                let why = format!("{} {message} is not reported", expected.shown);
                verdict.complain(case, expected.line, why);
            }
        }
    }
    for (line, head, message) in left {
        let why = format!("{head} is not expected: {message}");
        verdict.complain(case, line.unwrap_or(case.line), why);
    }
    if made.status != case.status {
        let why = format!("exit status {} instead of {}", made.status, case.status);
        verdict.complain(case, case.line, why);
    }
    if made.messages.contains("a bug in mocc") {
        verdict.complain(case, case.line, &made.messages);
    }
}

/// The model and everything that the case wants to be compared as a whole.
fn snapshot(case: &TestCase, made: &mut Made) -> String {
    let mut parts: Vec<(&str, String)> = Vec::new();
    if !case.problems.is_empty() {
        parts.push(("", made.messages.clone()));
    }
    if case.shows_flat {
        parts.push((" flat", made.flat.clone()));
    }
    if case.shows_structure {
        // The blocks at events are those between events where nothing is discrete.
        let (head, tail) = made.structure.split_once("at events:").unwrap_or_default();
        let (_, between) = tail.split_once("between events:").unwrap_or_default();
        parts.push((" structure", format!("{head}between events:{between}")));
    }
    let mut out = String::new();
    for (what, text) in parts {
        if out.is_empty() {
            out.push_str(&case.model);
        }
        out.push_str(&format!("----{what}\n{}\n", text.trim_end()));
    }
    out
}

fn claims(case: &TestCase, run: &Run, made: &Made, kind: &str, verdict: &mut Verdict) {
    for (line, claim) in &run.claims {
        let mut wrong = Vec::new();
        match claim {
            Claim::Accepted => {
                if made.status != 0 {
                    wrong.push(format!("the model is not accepted:\n{}", made.messages));
                }
            }
            Claim::Contains { what, count, text } => {
                // Of a flat model printed again nothing is expected.
                if kind.is_empty() {
                    wrong.extend(contained(made, *what, *count, text));
                }
            }
            _ => match &made.trajectory {
                None => wrong.push("there are no values".to_string()),
                Some(trajectory) => of_trajectory(case, trajectory, claim, &mut wrong),
            },
        }
        for why in wrong {
            verdict.complain(case, *line, format!("{why}{kind}"));
        }
    }
}

fn contained(made: &Made, what: Printed, count: Option<usize>, text: &str) -> Option<String> {
    let printed = match what {
        Printed::Flat => &made.flat,
        Printed::Structure => &made.structure,
        Printed::Messages => &made.messages,
    };
    let found = printed.matches(text).count();
    let good = count.map_or(found > 0, |count| found == count);
    let expected = count.map_or("at least 1".to_string(), |c| c.to_string());
    (!good).then(|| format!("`{text}` occurs {found} times instead of {expected} in\n{printed}"))
}

fn of_trajectory(case: &TestCase, trajectory: &Trajectory, claim: &Claim, wrong: &mut Vec<String>) {
    let judged = match claim {
        Claim::Values { found, rows, relation, expected, tolerance } => {
            let compare = Comparison { case, trajectory, relation, tolerance: *tolerance };
            compare.values(found, rows, expected, wrong)
        }
        Claim::Events { what, count, times, tolerance } => {
            let compare = Comparison { case, trajectory, relation: "=", tolerance: *tolerance };
            compare.events(what, *count, times, wrong)
        }
        Claim::Rows { relation, count, condition } => {
            let compare = Comparison { case, trajectory, relation, tolerance: Tolerance::Exact };
            compare.rows(*count, condition.as_ref(), wrong)
        }
        Claim::Column { name, present } => {
            if column(trajectory, name).is_some() != *present {
                let has = if *present { "no" } else { "a" };
                wrong.push(format!("there is {has} column `{name}`"));
            }
            Ok(())
        }
        Claim::Accepted | Claim::Contains { .. } => Ok(()),
    };
    if let Err(why) = judged {
        wrong.push(why);
    }
}

/// The values of a column; flat models quote names with dots.
fn column<'t>(trajectory: &'t Trajectory, name: &str) -> Option<&'t [f64]> {
    let quoted = || {
        let plain = |c: &&mocc::ir::trajectory::Column| c.name.replace('\'', "") == name;
        trajectory.columns.iter().find(plain).and_then(|c| trajectory.values(&c.name))
    };
    trajectory.values(name).or_else(quoted)
}

/// The time of the first event is `event[1]`.
fn event_time(trajectory: &Trajectory, name: &str) -> Option<f64> {
    let number: usize = name.strip_prefix("event[")?.strip_suffix(']')?.parse().ok()?;
    trajectory.events.get(number.checked_sub(1)?).map(|e| e.time)
}

struct Comparison<'a> {
    case: &'a TestCase,
    trajectory: &'a Trajectory,
    relation: &'a str,
    tolerance: Tolerance,
}

impl Comparison<'_> {
    fn values(
        &self,
        found: &[Formula],
        rows: &Rows,
        expected: &[Formula],
        wrong: &mut Vec<String>,
    ) -> Result<(), String> {
        let time = &self.trajectory.time;
        let count = time.len();
        let pick = |k: usize| &expected[if expected.len() == 1 { 0 } else { k }];
        match rows {
            Rows::First | Rows::Last => {
                let row = if *rows == Rows::First { 0 } else { count - 1 };
                for (k, formula) in found.iter().enumerate() {
                    wrong.extend(self.row(formula, row, pick(k))?);
                }
            }
            Rows::At(times) => {
                for (t, at) in times.iter().enumerate() {
                    let row = self.row_at(self.at(at, 0)?)?;
                    for (k, formula) in found.iter().enumerate() {
                        let expected = pick(if times.len() > 1 { t } else { k });
                        wrong.extend(self.row(formula, row, expected)?);
                    }
                }
            }
            Rows::Each(condition) => {
                let mut compared = 0;
                for row in 0..count {
                    if let Some(condition) = condition
                        && self.at(condition, row)? == 0.0
                    {
                        continue;
                    }
                    compared += 1;
                    for (k, formula) in found.iter().enumerate() {
                        wrong.extend(self.row(formula, row, pick(k))?);
                    }
                }
                if compared == 0 {
                    wrong.push("the condition holds in no row".to_string());
                }
                // The first rows say enough.
                wrong.truncate(3);
            }
        }
        Ok(())
    }

    /// The last row at or before a time.
    fn row_at(&self, at: f64) -> Result<usize, String> {
        let time = &self.trajectory.time;
        let end = *time.last().ok_or("the run has no rows")?;
        if at > end + 1e-9 * end.abs() {
            return Err(format!("the run ends at {end} s, before {at} s"));
        }
        match time.partition_point(|t| *t <= at + 1e-12 * at.abs()) {
            0 => Err(format!("the run begins after {at} s")),
            after => Ok(after - 1),
        }
    }

    /// The value of a formula in a row.
    fn at(&self, formula: &Formula, row: usize) -> Result<f64, String> {
        let columns = |name: &str| match name {
            "time" => Some(self.trajectory.time[row]),
            _ => column(self.trajectory, name)
                .map(|values| values[row])
                .or_else(|| event_time(self.trajectory, name)),
        };
        formula.evaluate(Scope::new(&self.case.functions, &columns))
    }

    fn row(
        &self,
        formula: &Formula,
        row: usize,
        expected: &Formula,
    ) -> Result<Option<String>, String> {
        let (found, wanted) = (self.at(formula, row)?, self.at(expected, row)?);
        let time = self.trajectory.time[row];
        Ok((!self.agrees(found, wanted)).then(|| {
            let name = match formula {
                Formula::Name(name) => format!("`{name}`"),
                _ => "the value".to_string(),
            };
            let relation = match self.relation {
                "=" => "instead of".to_string(),
                relation => format!("and not {relation}"),
            };
            format!("{name} is {found} {relation} {wanted} at {time} s{}", self.off(found, wanted))
        }))
    }

    fn off(&self, found: f64, wanted: f64) -> String {
        match self.tolerance {
            Tolerance::Exact => String::new(),
            Tolerance::Absolute(t) => {
                format!(" (off by {:.1e}, not {t:e})", (found - wanted).abs())
            }
            Tolerance::Relative(t) => {
                let off = (found - wanted).abs() / wanted.abs().max(f64::MIN_POSITIVE);
                format!(" (off by {off:.1e} of it, not {t:e})")
            }
        }
    }

    fn agrees(&self, found: f64, wanted: f64) -> bool {
        match self.tolerance {
            Tolerance::Exact => holds(self.relation, found, wanted),
            Tolerance::Absolute(t) => (found - wanted).abs() <= t,
            Tolerance::Relative(t) => {
                (found - wanted).abs() <= t * wanted.abs().max(f64::MIN_POSITIVE)
            }
        }
    }

    fn rows(
        &self,
        count: usize,
        condition: Option<&Formula>,
        wrong: &mut Vec<String>,
    ) -> Result<(), String> {
        let mut found = 0;
        for row in 0..self.trajectory.rows() {
            let counts = condition.map_or(Ok(1.0), |c| self.at(c, row))?;
            found += usize::from(counts != 0.0);
        }
        if !holds(self.relation, found as f64, count as f64) {
            wrong.push(format!("{found} rows, not {} {count}", self.relation));
        }
        Ok(())
    }

    /// The events whose description contains a string: how many, and when. One formula is about all
    /// of them, the `k`-th at a time that depends on `k`.
    fn events(
        &self,
        what: &str,
        count: Option<(&str, usize)>,
        times: &[Formula],
        wrong: &mut Vec<String>,
    ) -> Result<(), String> {
        let all = &self.trajectory.events;
        let events: Vec<_> = all.iter().filter(|e| e.what.contains(what)).collect();
        let listed = (times.len() > 1).then_some(("=", times.len()));
        if let Some((relation, count)) = count.or(listed)
            && !holds(relation, events.len() as f64, count as f64)
        {
            wrong.push(format!("{} events, not {relation} {count}: {events:?}", events.len()));
            return Ok(());
        }
        if events.is_empty() && !times.is_empty() {
            return Err("there are no such events".to_string());
        }
        for (k, event) in events.iter().enumerate() {
            let Some(formula) = times.get(if times.len() > 1 { k } else { 0 }) else { break };
            let none = |name: &str| (name == "k").then_some((k + 1) as f64);
            let wanted = formula.evaluate(Scope::new(&self.case.functions, &none))?;
            if !self.agrees(event.time, wanted) {
                let off = self.off(event.time, wanted);
                wrong.push(format!(
                    "event {} is at {} instead of {wanted}{off}",
                    k + 1,
                    event.time
                ));
            }
        }
        Ok(())
    }
}
