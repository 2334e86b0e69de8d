//! The runs themselves, and their rows.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::design::Design;
use super::error::SweepError;
use super::pool;
use super::variant::{Compiled, Variants, in_one_line};
use super::vary::Value;
use crate::io::csv::TableError;
use crate::io::format::Format;
use crate::io::journal::Journal;
use crate::io::records::{Cell, Field, Records, Type, line, row};
use crate::io::results::{Header, Results};
use crate::ir::trajectory::{Column, Constant, Event};
use crate::measure::observe::Observer;
use crate::simulate::columns::{column_storage, columns};
use crate::simulate::failure::FailureKind;
use crate::simulate::record::Sink;
use crate::simulate::run::simulate_to;
use crate::simulate::settings::Settings;

/// A sweep, ready to run.
pub struct Sweep<'a> {
    /// Which values in which run.
    pub design: &'a Design,
    /// The programs.
    pub variants: &'a Variants,
    /// Settings of all runs.
    pub settings: Settings,
    /// Folder for the trajectories of the runs, if they are kept.
    pub traces: Option<PathBuf>,
    /// Names and units of the measures.
    pub measures: Vec<Column>,
    /// Threads.
    pub jobs: usize,
}

/// The outcome of a run.
#[derive(Clone, PartialEq, Debug)]
pub struct Outcome {
    /// The measures, or why the run failed.
    pub measures: Result<Vec<Option<f64>>, String>,
    /// Steps of the integrator.
    pub steps: u64,
    /// Events.
    pub events: u64,
}

/// How many runs ended how.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Tally {
    /// Rows of the table.
    pub runs: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Number and reason of the first that failed.
    pub first: Option<(i64, String)>,
}

/// The columns that every table has, beside those of what varies and of measures.
pub const FIXED_COLUMNS: [&str; 5] = ["run", "status", "error", "steps", "events"];

impl Sweep<'_> {
    /// The columns of the table.
    pub fn fields(&self) -> Vec<Field> {
        let field = |name: &str, ty, unit: &str, description: &str| Field {
            name: name.to_owned(),
            ty,
            unit: unit.to_owned(),
            description: description.to_owned(),
        };
        let [run, status, error, steps, events] = FIXED_COLUMNS;
        let mut all = vec![field(run, Type::Integer, "", "Number of the run, from 1")];
        for (k, axis) in self.design.axes.iter().enumerate() {
            let ty = if axis.is_numeric() { Type::Real } else { Type::Text };
            all.push(field(&axis.name, ty, &self.variants.unit(k), "varied"));
        }
        for m in &self.measures {
            all.push(field(&m.name, Type::Real, &m.unit, &m.description));
        }
        all.push(field(status, Type::Text, "", "ok or failed"));
        all.push(field(error, Type::Text, "", "Why it failed"));
        all.push(field(steps, Type::Integer, "", "Steps of the integrator"));
        all.push(field(events, Type::Integer, "", "Events"));
        all
    }

    /// Performs those of `runs` that their journal does not hold yet. `on_progress` is called with the number of
    /// lines in the journal; `stop` ends the sweep within a step of each run. Returns false if it was cancelled.
    pub fn run(
        &self,
        runs: Range<u64>,
        journal: &mut Journal,
        stop: &(dyn Fn() -> bool + Sync),
        mut on_progress: impl FnMut(u64),
    ) -> Result<bool, SweepError> {
        let rest = (runs.start + journal.lines).min(runs.end)..runs.end;
        self.rows(rest, stop, |_, cells| {
            journal.push(&line(&cells))?;
            on_progress(journal.lines);
            Ok(())
        })?;
        Ok(journal.lines == runs.end - runs.start)
    }

    /// Performs some of the runs, counted from 0, and passes their rows to `take`, in order. `stop` ends this within a
    /// step of each run, before all rows are passed.
    pub fn rows(
        &self,
        runs: Range<u64>,
        stop: &(dyn Fn() -> bool + Sync),
        mut take: impl FnMut(u64, Vec<Cell>) -> Result<(), SweepError>,
    ) -> Result<(), SweepError> {
        let mut outcome = Ok(());
        pool::in_order(
            self.jobs,
            runs,
            |k| (!stop()).then(|| self.outcome(k, stop)).flatten(),
            |k, found| {
                outcome = found.and_then(|found| take(k, self.cells(k, &found)));
                outcome.is_ok()
            },
        );
        outcome
    }

    /// One run; `None` if it was cancelled.
    pub fn outcome(
        &self,
        k: u64,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Result<Outcome, SweepError>> {
        let values = self.design.values(k);
        let failed = |why| Outcome { measures: Err(why), steps: 0, events: 0 };
        match self.variants.of(&values) {
            Ok(compiled) => self.simulated(k, &values, &compiled, stop),
            Err(why) => Some(Ok(failed(why))),
        }
    }

    fn simulated(
        &self,
        k: u64,
        values: &[Value],
        compiled: &Compiled,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Result<Outcome, SweepError>> {
        let program = &compiled.program;
        let mut settings = self.settings.clone();
        settings.execution = compiled.execution.clone();
        if !self.variants.set(program, values, &mut settings) {
            let why = "with these values, a varied parameter no longer exists".to_owned();
            return Some(Ok(Outcome { measures: Err(why), steps: 0, events: 0 }));
        }
        compiled.plan.ask(&mut settings);
        let mut trace = match self.trace(k, compiled) {
            Ok(trace) => Trace { results: trace, error: None, stop },
            Err(why) => return Some(Err(why.into())),
        };
        let mut observer = Observer::new(&compiled.plan, program, &mut trace);
        let outcome = simulate_to(program, &settings, &compiled.sources, &mut observer);
        let statistics = match outcome {
            Ok(statistics) => statistics,
            Err(failure) => {
                let bug = if failure.kind == FailureKind::Bug { "bug: " } else { "" };
                let why = in_one_line(&failure.diagnostic, &compiled.sources);
                let measures = Err(format!("{bug}{why}"));
                return Some(Ok(Outcome { measures, steps: 0, events: 0 }));
            }
        };
        let measures = compiled.plan.evaluate(program, &settings, &observer, &statistics);
        if let Some(error) = trace.error {
            return Some(Err(error.into()));
        }
        if statistics.interrupted {
            return None;
        }
        if let Some(Err(why)) = trace.results.map(|results| results.finish(statistics.end)) {
            return Some(Err(why.into()));
        }
        Some(Ok(Outcome {
            measures: Ok(measures),
            steps: statistics.integration.steps,
            events: statistics.state_events + statistics.time_events,
        }))
    }

    /// The file for the trajectory of a run.
    fn trace(&self, k: u64, compiled: &Compiled) -> Result<Option<Results>, TableError> {
        let Some(folder) = &self.traces else { return Ok(None) };
        let shown = compiled.plan.shown;
        let path = trace_path(folder, k);
        let columns = &columns(&compiled.program)[..shown];
        let column_storage = column_storage(&compiled.program);
        let header = Header { columns, column_storage: &column_storage[..shown] };
        Results::create(&path, Format::csv(), &header).map(Some)
    }

    /// The row of a run.
    fn cells(&self, k: u64, outcome: &Outcome) -> Vec<Cell> {
        let mut cells = vec![Cell::Integer(k as i64 + 1)];
        for (value, axis) in self.design.values(k).into_iter().zip(&self.design.axes) {
            cells.push(match value {
                Value::Number(x) if axis.is_numeric() => Cell::Real(x),
                value => Cell::Text(value.expression()),
            });
        }
        match &outcome.measures {
            Ok(values) => {
                cells.extend(values.iter().map(|v| v.map_or(Cell::Missing, Cell::Real)));
                cells.extend([Cell::Text("ok".into()), Cell::Missing]);
            }
            Err(why) => {
                cells.extend(self.measures.iter().map(|_| Cell::Missing));
                cells.extend([Cell::Text("failed".into()), Cell::Text(why.clone())]);
            }
        }
        cells.extend([Cell::Integer(outcome.steps as i64), Cell::Integer(outcome.events as i64)]);
        cells
    }

    /// Writes the table from the journals of all runs, in order, line by line; returns how the runs ended.
    pub fn write(&self, journals: &mut [Journal], path: &Path) -> Result<Tally, SweepError> {
        let fields = self.fields();
        let status = fields.len() - 4;
        let mut records = Records::create(path, &fields)?;
        let mut tally = Tally::default();
        let mut outcome = Ok(());
        for journal in journals {
            journal.for_each(|text| {
                let written = row(text, &fields).and_then(|cells| {
                    tally.runs += 1;
                    if let (Cell::Integer(number), Cell::Text(why)) =
                        (&cells[0], &cells[status + 1])
                    {
                        tally.failed += 1;
                        tally.first.get_or_insert_with(|| (*number, why.clone()));
                    }
                    records.row(text, &cells)
                });
                outcome = written;
                outcome.is_ok()
            })?;
        }
        outcome?;
        records.finish()?;
        Ok(tally)
    }
}

/// The file of the trajectory of a run.
pub fn trace_path(folder: &Path, k: u64) -> PathBuf {
    folder.join(format!("{:05}.csv", k + 1))
}

/// Writes the rows of a run to its file.
struct Trace<'a> {
    results: Option<Results>,
    error: Option<TableError>,
    stop: &'a (dyn Fn() -> bool + Sync),
}

impl Sink for Trace<'_> {
    fn begin(&mut self, _: Vec<Column>) {}
    fn constants(&mut self, _: Vec<Constant>) {}
    fn row(&mut self, time: f64, values: &[f64]) {
        if let (Some(results), None) = (&mut self.results, &self.error) {
            self.error = results.row(time, values).err();
        }
    }
    fn event(&mut self, _: Event) {}
    fn goes_on(&mut self, _: f64) -> bool {
        self.error.is_none() && !(self.stop)()
    }
}
