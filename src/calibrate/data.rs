//! Recordings: the measurements, their conditions and their noise.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::source::Span;
use crate::io::csv::TextTable;

use super::cause::RecordingCause;
use super::noise::{self, third_differences};
use super::plan::Plan;
use super::unit::Unit;
use super::window::{Cut, InitialSignal};
use crate::numeric::smoothing::smoothed;
use crate::numeric::time_series::{Interpolation, TimeSeries};

/// Largest share of a recording that repairs may drop.
const REPAIRABLE: f64 = 0.05;

/// The use of a recording.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Split {
    /// Fitted.
    Train,
    /// Never fitted; decides between models.
    Validation,
    /// Seen by no fit and no decision, only reported at the end.
    Test,
}

impl Split {
    /// All, in the order of reports.
    pub const ALL: [Split; 3] = [Split::Train, Split::Validation, Split::Test];

    /// The use that a plan or a table names; training if it names none.
    pub fn named(name: Option<&str>) -> Option<Split> {
        let Some(name) = name else { return Some(Split::Train) };
        Split::ALL.into_iter().find(|split| split.name() == name)
    }

    /// Its name in tables and reports.
    pub fn name(self) -> &'static str {
        match self {
            Split::Train => "train",
            Split::Validation => "validation",
            Split::Test => "test",
        }
    }
}

/// One recording.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The recording that contains it as a window; its own name if it is whole.
    pub of: String,
    /// Its name.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    /// Its use.
    pub split: Split,
    /// One value in SI units for each condition of the plan.
    pub conditions: Vec<f64>,
    /// One value in SI units for each start of the plan.
    pub starts: Vec<f64>,
    /// One signal in SI units for each input of the plan.
    pub courses: Vec<Arc<TimeSeries>>,
    /// Start of its run, s; without it, the start time of the model or, if that is earlier, the first instant.
    pub start: Option<f64>,
    /// Instants, s, rising.
    pub time: Arc<[f64]>,
    /// Signal by signal, in the unit of its column; NaN where there is no value.
    pub signals: Vec<Vec<f64>>,
}

/// All recordings of a plan.
#[derive(Clone, Debug)]
pub struct Data {
    /// In the order of the table.
    pub recordings: Vec<Recording>,
    /// Standard deviation of each signal's noise, in the unit of its column.
    pub sigmas: Vec<f64>,
    /// Descriptions of the repairs.
    pub repairs: Vec<String>,
}

impl Data {
    /// The recordings of one kind.
    pub fn of(&self, split: Split) -> impl Iterator<Item = &Recording> {
        self.recordings.iter().filter(move |r| r.split == split)
    }

    /// The kinds to report: training and validation, and the test if there are recordings for it.
    pub fn splits(&self) -> impl Iterator<Item = Split> {
        let has_test = self.of(Split::Test).next().is_some();
        Split::ALL.into_iter().filter(move |split| has_test || *split != Split::Test)
    }

    /// Names of the recordings of one kind before they were cut into windows.
    pub fn wholes(&self, split: Split) -> Vec<&str> {
        let mut out: Vec<&str> = Vec::new();
        for r in self.of(split) {
            if out.last() != Some(&r.of.as_str()) {
                out.push(&r.of);
            }
        }
        out
    }
}

/// Reads all recordings of a plan. Errors are added to `problems`.
pub fn read(plan: &Plan, problems: &mut Problems) -> Option<Data> {
    let before = problems.error_count();
    let mut repairs = Vec::new();
    let mut recordings = listed(plan, problems, &mut repairs);
    if !plan.table.is_empty() {
        let (path, table) = plan.memory.table(plan);
        let table = match table {
            Ok(table) => table,
            Err(why) => {
                problems.push(why);
                return None;
            }
        };
        recordings.extend(tabled(plan, &path, &table, problems, &mut repairs));
    }
    if problems.error_count() > before {
        return None;
    }
    for (k, signal) in plan.signals.iter().enumerate() {
        if recordings.iter().all(|r| r.signals[k].iter().all(|value| value.is_nan())) {
            let cause = RecordingCause::NeverMeasured { column: signal.column.clone() };
            problems.push(Diagnostic::new(cause, signal.span));
        }
    }
    let sigmas = sigmas(plan, &recordings, problems, &mut repairs);
    (problems.error_count() == before).then_some(Data { recordings, sigmas, repairs })
}

/// Reports if no recording is for training.
pub fn check_training(plan: &Plan, data: &Data, problems: &mut Problems) -> Option<()> {
    let found = data.of(Split::Train).next();
    if found.is_none() {
        let path = plan.folder.join(&plan.table).display().to_string();
        problems.push(Diagnostic::new(RecordingCause::NoTraining { path }, Span::NONE));
    }
    found.map(|_| ())
}

/// The recordings that the plan itself lists. A file that several are parts of is read once.
fn listed(plan: &Plan, problems: &mut Problems, repairs: &mut Vec<String>) -> Vec<Recording> {
    let mut files: Vec<(&str, Option<FileContent>)> = Vec::new();
    let mut out = Vec::new();
    for entry in &plan.listed {
        let path = plan.folder.join(&entry.file);
        if !files.iter().any(|(known, _)| *known == entry.file) {
            files.push((&entry.file, measured(plan, &entry.file, problems, repairs)));
        }
        let of_file = files.iter().find(|(known, _)| *known == entry.file);
        let Some(measured) = of_file.and_then(|(_, m)| m.as_ref()) else { continue };
        let whole = Recording {
            of: entry.name.clone(),
            name: entry.name.clone(),
            path: path.clone(),
            split: entry.split,
            conditions: plan.conditions.iter().map(|_| f64::NAN).collect(),
            starts: Vec::new(),
            courses: measured.courses.clone(),
            start: Some(0.0),
            time: Arc::clone(&measured.time),
            signals: measured.signals.clone(),
        };
        let cut = Cut {
            part: entry.part,
            window: entry.window.unwrap_or(plan.window),
            skip: entry.skip.unwrap_or(plan.skip),
            every: plan.every,
        };
        let before = out.len();
        out.extend(cut.apply(&whole, &measured.initial_signals));
        if out.len() == before {
            let (path, name) = (path.display().to_string(), entry.name.clone());
            problems.push(Diagnostic::new(RecordingCause::NoRows { path, name }, Span::NONE));
        }
    }
    out
}

fn tabled(
    plan: &Plan,
    path: &Path,
    table: &TextTable,
    problems: &mut Problems,
    repairs: &mut Vec<String>,
) -> Vec<Recording> {
    let mut column = |name: &str, span: Span| column(&table.names, path, name, span, problems);
    let file = column(&plan.file_column, Span::NONE);
    let name = plan.name_column.as_ref().map(|c| column(c, Span::NONE));
    let split = plan.split_column.as_ref().map(|c| column(c, Span::NONE));
    let conditions: Vec<_> = plan.conditions.iter().map(|c| column(&c.column, c.span)).collect();
    let (Some(file), false) = (file, conditions.contains(&None)) else { return Vec::new() };
    let mut out = Vec::new();
    for (line, row) in &table.rows {
        let place = || format!("{}:{line}", path.display());
        let named = split.flatten().map(|k| row[k].as_str());
        let Some(split) = Split::named(named) else {
            let found = named.unwrap_or_default().to_owned();
            let cause = RecordingCause::UnknownSplit { place: place(), found };
            problems.push(Diagnostic::new(cause, Span::NONE));
            continue;
        };
        let mut values = Vec::new();
        for (k, condition) in conditions.iter().flatten().zip(&plan.conditions) {
            match row[*k].parse::<f64>().ok().filter(|x| x.is_finite()) {
                Some(value) => values.push(condition.unit.to_si(value)),
                None => {
                    let cause = RecordingCause::ConditionNotANumber {
                        place: place(),
                        found: row[*k].clone(),
                        column: condition.column.clone(),
                    };
                    problems.push(Diagnostic::new(cause, Span::NONE));
                }
            }
        }
        let name = name.flatten().map_or_else(|| row[file].clone(), |k| row[k].clone());
        let source = plan.folder.join(&row[file]);
        let Some(measured) = measured(plan, &row[file], problems, repairs) else { continue };
        let FileContent { time, signals, courses, initial_signals } = measured;
        let conditions = values;
        let whole = Recording {
            of: name.clone(),
            name,
            path: source,
            split,
            conditions,
            starts: initial_signals.iter().map(|b| b.at(time[0])).collect(),
            courses,
            start: None,
            time,
            signals,
        };
        if plan.window.is_finite() || plan.skip > 0.0 || plan.every > 1 {
            let part = (f64::NEG_INFINITY, f64::INFINITY);
            let cut = Cut { part, window: plan.window, skip: plan.skip, every: plan.every };
            out.extend(cut.apply(&whole, &initial_signals));
        } else {
            out.push(whole);
        }
    }
    out
}

/// The content of a file.
struct FileContent {
    time: Arc<[f64]>,
    /// Signal by signal.
    signals: Vec<Vec<f64>>,
    /// Input by input.
    courses: Vec<Arc<TimeSeries>>,
    /// Start by start.
    initial_signals: Vec<InitialSignal>,
}

/// Instants, values, and if these were smoothed, rates.
type Trace = (Vec<f64>, Vec<f64>, Option<Vec<f64>>);

/// The source of the values of a signal or an input.
#[derive(Clone, Copy)]
enum Source {
    /// The column at this position.
    Column(usize),
    /// A constant in place of a missing column.
    Absent(f64),
}

/// A column in SI units, through the rows where it has a value, perhaps smoothed.
fn column_course(time: &[f64], values: &[f64], unit: Unit, smooth: f64) -> Option<Trace> {
    let there = time.iter().zip(values).filter(|(_, v)| !v.is_nan());
    let (times, values): (Vec<f64>, Vec<f64>) = there.map(|(t, v)| (*t, unit.to_si(*v))).unzip();
    if times.is_empty() {
        return None;
    }
    if smooth == 0.0 {
        return Some((times, values, None));
    }
    let (values, rates) = smoothed(&times, &values, smooth);
    Some((times, values, Some(rates)))
}

/// Time and signals of one file.
fn measured(
    plan: &Plan,
    file: &str,
    problems: &mut Problems,
    repairs: &mut Vec<String>,
) -> Option<FileContent> {
    let (path, table) = plan.memory.rows(plan, file);
    let path = path.as_path();
    let table = match table {
        Ok(table) => table,
        Err(why) => {
            problems.push(why);
            return None;
        }
    };
    let names = table.names();
    let at = column(names, path, &plan.time, Span::NONE, problems);
    let signals = plan.signals.iter().map(|s| (&s.column, s.span, None));
    let inputs = plan.inputs.iter().map(|i| (&i.column, i.span, i.absent));
    let starts = plan.starts.iter().map(|b| (&b.column, b.span, None));
    let named = signals.chain(inputs).chain(starts);
    let mut source = |(name, span, absent): (&String, Span, Option<f64>)| match absent {
        Some(value) if !names.contains(name) => Some(Source::Absent(value)),
        _ => column(names, path, name, span, problems).map(Source::Column),
    };
    let columns: Vec<_> = named.map(&mut source).collect();
    let columns: Vec<Source> = columns.into_iter().collect::<Option<_>>()?;
    let at = at?;
    let mut time: Vec<f64> = Vec::with_capacity(table.count());
    let mut signals = vec![Vec::with_capacity(table.count()); columns.len()];
    let (mut dropped, mut repeated, mut missing) = (0usize, 0usize, 0usize);
    let (mut first_dropped, mut first_missing) = (None, None);
    for row in 0..table.count() {
        let number = |k: usize| table.number(row, k);
        let t = number(at).map(|t| plan.time_unit.to_si(t));
        // The clock of a logger may be coarser than its sampling: of rows with equal time, the first counts.
        if t.is_some() && t == time.last().copied() {
            repeated += 1;
            continue;
        }
        let rises = |t: &f64| time.last().is_none_or(|last| t > last);
        let Some(t) = t.filter(rises) else {
            dropped += 1;
            first_dropped = first_dropped.or(Some(table.line(row)));
            continue;
        };
        time.push(t);
        for (signal, source) in signals.iter_mut().zip(&columns) {
            let value = match source {
                Source::Column(k) => number(*k),
                Source::Absent(value) => Some(*value),
            };
            if value.is_none() {
                missing += 1;
                first_missing = first_missing.or(Some(table.line(row)));
            }
            signal.push(value.unwrap_or(f64::NAN));
        }
    }
    let rows = table.count().max(1);
    let place = |line: Option<u64>| format!("{}:{}", path.display(), line.unwrap_or(1));
    if time.len() < 2 || dropped as f64 > REPAIRABLE * rows as f64 {
        let (place, rows) = (place(first_dropped), table.count());
        let cause = RecordingCause::TimeNotIncreasing { place, dropped, rows };
        problems.push(Diagnostic::new(cause, Span::NONE));
        return None;
    }
    if missing as f64 > 0.5 * (rows * columns.len()) as f64 {
        let cause = RecordingCause::MostlyMissing { place: place(first_missing) };
        problems.push(Diagnostic::new(cause, Span::NONE));
        return None;
    }
    let counted = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    if dropped > 0 {
        let (rows, place) = (counted(dropped, "row"), place(first_dropped));
        repairs.push(format!("{place}: {rows} skipped: the time does not increase"));
    }
    if repeated > 0 {
        let rows = counted(repeated, "row");
        repairs.push(format!("{}: {rows} skipped: same time as the row before", path.display()));
    }
    if missing > 0 {
        let (values, place) = (counted(missing, "value"), place(first_missing));
        repairs.push(format!("{place}: {values} skipped: not a number"));
    }
    if let Some(gap) = gap(&time) {
        repairs.push(format!("{}: nothing was recorded for {gap:.3e} s", path.display()));
    }
    let mut rest = signals.split_off(plan.signals.len()).into_iter();
    for (signal, values) in plan.signals.iter().zip(&mut signals).filter(|(s, _)| s.smooth > 0.0) {
        let there: Vec<usize> = (0..time.len()).filter(|k| !values[*k].is_nan()).collect();
        let pick = |all: &[f64]| there.iter().map(|k| all[*k]).collect::<Vec<f64>>();
        let (smooth, _) = smoothed(&pick(&time), &pick(values), signal.smooth);
        for (k, value) in there.iter().zip(smooth) {
            values[*k] = value;
        }
    }
    let mut courses = Vec::new();
    let mut initial_signals = Vec::new();
    for input in &plan.inputs {
        let found = column_course(&time, &rest.next()?, input.unit, input.smooth);
        let Some((times, values, _)) = found else {
            problems.push(empty(path, &input.column, input.span));
            continue;
        };
        let last = times.len() - 1;
        let counts = |k: usize| k.is_multiple_of(input.every) || k == last;
        let pick = |all: &[f64]| -> Vec<f64> {
            all.iter().enumerate().filter(|(k, _)| counts(*k)).map(|(_, x)| *x).collect()
        };
        let (times, values) = (pick(&times), pick(&values));
        courses.push(Arc::new(TimeSeries::new(times.into(), values, input.interpolation)));
    }
    for begin in &plan.starts {
        let found = column_course(&time, &rest.next()?, begin.unit, begin.smooth);
        let Some((times, values, rates)) = found else {
            problems.push(empty(path, &begin.column, begin.span));
            continue;
        };
        let (values, order) = match (begin.rate, rates) {
            (true, Some(rates)) => (rates, 0),
            (rate, _) => (values, usize::from(rate)),
        };
        initial_signals.push(InitialSignal {
            series: TimeSeries::new(times.into(), values, Interpolation::Linear),
            order: order as u8,
        });
    }
    Some(FileContent { time: time.into(), signals, courses, initial_signals })
}

fn empty(path: &Path, column: &str, span: Span) -> Diagnostic {
    let (path, column) = (path.display().to_string(), column.to_owned());
    Diagnostic::new(RecordingCause::EmptyColumn { path, column }, span)
}

/// The longest interval, if it is much longer than the median.
fn gap(time: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    let (usual, longest) = (steps[steps.len() / 2], steps[steps.len() - 1]);
    (longest > 10.0 * usual).then_some(longest)
}

fn sigmas(
    plan: &Plan,
    recordings: &[Recording],
    problems: &mut Problems,
    repairs: &mut Vec<String>,
) -> Vec<f64> {
    let only_test = recordings.iter().all(|r| r.split == Split::Test);
    let mut sigma = |(k, signal): (usize, &super::plan::Signal)| {
        signal.sigma.unwrap_or_else(|| {
            // Nothing may depend on the recordings of the test.
            let is_seen = |r: &&Recording| r.split != Split::Test || only_test;
            let seen = recordings.iter().filter(is_seen);
            let all = seen.flat_map(|r| third_differences(&r.signals[k]));
            let sigma = noise::estimate(all.collect());
            if sigma > 0.0 {
                let unit = &signal.unit_name;
                repairs
                    .push(format!("noise of `{}` estimated as {sigma:.3e} {unit}", signal.column));
            } else {
                let column = signal.column.clone();
                let cause = RecordingCause::UnknownNoise { column, is_smoothed: false };
                problems.push(Diagnostic::new(cause, signal.span));
            }
            sigma
        })
    };
    plan.signals.iter().enumerate().map(&mut sigma).collect()
}

fn column(
    names: &[String],
    path: &Path,
    name: &str,
    span: Span,
    problems: &mut Problems,
) -> Option<usize> {
    let found = names.iter().position(|n| n == name);
    if found.is_none() {
        let near = did_you_mean(name, names.iter().map(String::as_str));
        let cause = RecordingCause::UnknownColumn {
            path: path.display().to_string(),
            column: name.to_owned(),
            near: near.map(str::to_owned),
            columns: names.join(", "),
        };
        problems.push(Diagnostic::new(cause, span));
    }
    found
}
