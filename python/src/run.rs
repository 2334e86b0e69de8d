//! A run: its columns, events and statistics.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use mocc::base::render::{Style, render};
use mocc::io::printout::Printout;
use mocc::ir::trajectory::{Column, ColumnStorage, Event, Kind, Trajectory, position};
use mocc::report::plot;
use mocc::report::plot::choice::default_figure;
use mocc::report::plot::figure::{PlotError, PlotSpec};
use mocc::simulate::record::Sink;
use mocc::simulate::run::{Statistics, simulate_to};
use mocc::simulate::settings::Settings;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyDict, PyTuple};

use crate::arrow;
use crate::background::PERIOD;
use crate::error::{Kind as Wrong, Trouble};
use crate::model::Compiled;
use crate::own_rows::OwnRows;
use crate::values::Values;

/// Name, unit, display unit, description and kind of a column.
type Head = (String, String, String, String, String);
/// Time, cause and place of an event.
type Happened = (f64, String, String);

/// The rows and events of a run.
#[pyclass(frozen)]
pub struct Run {
    columns: Arc<Vec<Column>>,
    time: Arc<Vec<f64>>,
    data: Vec<Arc<Vec<f64>>>,
    events: Vec<Event>,
}

#[pymethods]
impl Run {
    /// Name, unit, display unit, description and kind of each column.
    fn columns(&self) -> Vec<Head> {
        self.columns.iter().map(head).collect()
    }

    /// The instants, s.
    fn time(&self) -> Values {
        Values(Arc::clone(&self.time))
    }

    /// The values of a column.
    fn values(&self, column: usize) -> Option<Values> {
        self.data.get(column).map(|values| Values(Arc::clone(values)))
    }

    /// The position of a column; spaces in names do not count.
    fn position(&self, name: &str) -> Option<usize> {
        position(&self.columns, name)
    }

    /// The events in order of time.
    fn events(&self) -> Vec<Happened> {
        self.events.iter().map(|e| (e.time, e.what.clone(), e.place.clone())).collect()
    }

    /// A capsule with a stream of the Arrow C data interface.
    fn stream<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let time = (Column::new("time", "s"), Arc::clone(&self.time));
        let columns = self.columns.iter().cloned().zip(self.data.iter().cloned());
        arrow::capsule(py, std::iter::once(time).chain(columns).collect())
    }

    /// The figure of these variables, or of a default choice, as SVG; `None` if nothing moves.
    fn svg(
        &self,
        py: Python<'_>,
        title: &str,
        names: Option<Vec<String>>,
        size: (Option<u32>, Option<u32>),
        events: bool,
    ) -> PyResult<Option<String>> {
        let drawn = py.detach(|| {
            let run = self.trajectory();
            let spec = figure(&run, title, names.as_deref(), size, events)?;
            spec.map(|spec| plot::svg(&run, &spec)).transpose()
        });
        drawn.map_err(|why| wrong_figure(py, &why))
    }

    /// Writes the figure to a file, as SVG or PNG by its extension; false if nothing moves.
    fn draw(
        &self,
        py: Python<'_>,
        path: PathBuf,
        title: &str,
        names: Option<Vec<String>>,
        size: (Option<u32>, Option<u32>),
        events: bool,
    ) -> PyResult<bool> {
        let drawn = py.detach(|| {
            let run = self.trajectory();
            let spec = figure(&run, title, names.as_deref(), size, events)?;
            spec.map(|spec| plot::plot(&run, &spec, &path)).transpose()
        });
        drawn.map(|done| done.is_some()).map_err(|why| wrong_figure(py, &why))
    }

    /// Everything, for `of_parts`: columns that share their memory come once.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let mut vectors: Vec<&Arc<Vec<f64>>> = Vec::new();
        let mut places = Vec::new();
        for values in &self.data {
            let known = vectors.iter().position(|v| Arc::ptr_eq(v, values));
            places.push(known.unwrap_or_else(|| {
                vectors.push(values);
                vectors.len() - 1
            }));
        }
        let vectors: Vec<_> = vectors.into_iter().map(|v| bytes(py, v)).collect();
        (self.columns(), bytes(py, &self.time), vectors, places, self.events()).into_pyobject(py)
    }

    /// The run of these parts.
    #[staticmethod]
    fn of_parts(
        columns: Vec<Head>,
        time: &Bound<'_, PyBytes>,
        vectors: Vec<Bound<'_, PyBytes>>,
        places: Vec<usize>,
        events: Vec<Happened>,
    ) -> Run {
        let vectors: Vec<_> = vectors.iter().map(|v| Arc::new(numbers(v.as_bytes()))).collect();
        let column = |(name, unit, display_unit, description, kind): Head| {
            let kind =
                KINDS.into_iter().find(|(_, k)| *k == kind).map_or(Kind::Continuous, |k| k.0);
            Column { name, unit, display_unit, description, kind }
        };
        let event = |(time, what, place): Happened| Event { time, what, place };
        Run {
            columns: Arc::new(columns.into_iter().map(column).collect()),
            time: Arc::new(numbers(time.as_bytes())),
            data: places.into_iter().filter_map(|k| vectors.get(k).cloned()).collect(),
            events: events.into_iter().map(event).collect(),
        }
    }
}

impl Run {
    /// A run of these columns and rows.
    pub fn new(
        columns: Arc<Vec<Column>>,
        time: Vec<f64>,
        data: Vec<Arc<Vec<f64>>>,
        events: Vec<Event>,
    ) -> Run {
        Run { columns, time: Arc::new(time), data, events }
    }

    fn trajectory(&self) -> Trajectory {
        let mut run = Trajectory::new(self.columns.to_vec());
        run.time = self.time.to_vec();
        run.data.clone_from(&self.data);
        run.events.clone_from(&self.events);
        run
    }
}

/// Runs a program; returns the run, its statistics, warnings, and the lines that the model printed.
pub fn simulate<'py>(
    py: Python<'py>,
    compiled: &Compiled,
    settings: &Settings,
    right_limits: bool,
) -> PyResult<Bound<'py, PyTuple>> {
    let Compiled { program, sources, .. } = compiled;
    let mut recording = Recording {
        rows: OwnRows::new(right_limits),
        has_begun: false,
        events: Vec::new(),
        printed: Vec::new(),
        printout: Printout::new(Path::new(""), &[]),
        looked: Instant::now(),
        raised: None,
    };
    let outcome = py.detach(|| simulate_to(program, settings, sources, &mut recording));
    if let Some(raised) = recording.raised {
        return Err(raised);
    }
    let run = match recording.has_begun {
        true => recording.rows.run(compiled.columns(), recording.events),
        false => OwnRows::default().run(Arc::default(), Vec::new()),
    };
    let statistics = match outcome {
        Ok(statistics) => statistics,
        Err(failure) => {
            let exception = Trouble::of_failure(&failure, sources).exception(py)?;
            // Everything before the failure is valid.
            exception.setattr("_run", run)?;
            return Err(PyErr::from_value(exception));
        }
    };
    let shown = |d| render(d, sources, Style::Plain);
    let warnings: Vec<String> = statistics.warnings.iter().map(shown).collect();
    (run, facts(py, &statistics)?, warnings, recording.printed).into_pyobject(py)
}

fn facts<'py>(py: Python<'py>, s: &Statistics) -> PyResult<Bound<'py, PyDict>> {
    let facts = PyDict::new(py);
    let i = &s.integration;
    facts.set_item("method", s.method.method)?;
    facts.set_item("why", &s.method.because)?;
    facts.set_item("end", s.end)?;
    facts.set_item("seconds", s.elapsed.as_secs_f64())?;
    for (name, count) in [
        ("rows", s.rows),
        ("steps", i.steps),
        ("rejected", i.rejected),
        ("convergence_failures", i.convergence_failures),
        ("right_sides", i.rhs),
        ("jacobians", i.jacobians),
        ("decompositions", i.decompositions),
        ("newton_iterations", i.newton_iterations),
        ("state_events", s.state_events),
        ("time_events", s.time_events),
    ] {
        facts.set_item(name, count)?;
    }
    facts.set_item("terminated", &s.terminated)?;
    Ok(facts)
}

/// Keeps all rows, and looks at the signals of the process from time to time.
struct Recording {
    rows: OwnRows,
    has_begun: bool,
    events: Vec<Event>,
    printed: Vec<String>,
    /// New files of the model, in the working directory.
    printout: Printout,
    looked: Instant,
    /// The exception that the handler of a signal has raised, such as `KeyboardInterrupt`.
    raised: Option<PyErr>,
}

impl Sink for Recording {
    fn begin(&mut self, _: Vec<Column>) {
        self.has_begun = true;
    }
    fn wants_columns(&self) -> bool {
        false
    }
    fn expect(&mut self, rows: usize) {
        self.rows.expect(rows);
    }
    fn wants_constants(&self) -> bool {
        false
    }
    fn row(&mut self, time: f64, values: &[f64]) {
        self.rows.row(time, values);
    }
    fn column_storage(&mut self, storage: Vec<ColumnStorage>) -> bool {
        self.rows.storage(storage);
        true
    }
    fn own_columns(&mut self, times: &[f64], values: &[f64], stride: usize) {
        self.rows.own_columns(times, values, stride);
    }
    fn event(&mut self, event: Event) {
        self.events.push(event);
    }
    fn print(&mut self, line: &str, file: &str) {
        if file.is_empty() {
            self.printed.push(line.to_owned());
        } else if let Err(why) = self.printout.append(file, line) {
            self.printed.push(format!("warning: cannot write `{file}`: {why}"));
        }
    }
    fn goes_on(&mut self, _: f64) -> bool {
        if self.looked.elapsed() >= PERIOD {
            self.looked = Instant::now();
            self.raised = Python::attach(|py| py.check_signals()).err();
        }
        self.raised.is_none()
    }
}

const KINDS: [(Kind, &str); 4] = [
    (Kind::Continuous, "continuous"),
    (Kind::Discrete, "discrete"),
    (Kind::Boolean, "Boolean"),
    (Kind::Integer, "Integer"),
];

/// The name of a kind of columns.
pub fn kind_name(kind: Kind) -> &'static str {
    KINDS.into_iter().find(|(k, _)| *k == kind).map_or("continuous", |(_, name)| name)
}

fn head(c: &Column) -> Head {
    let kind = kind_name(c.kind).to_owned();
    (c.name.clone(), c.unit.clone(), c.display_unit.clone(), c.description.clone(), kind)
}

fn figure(
    run: &Trajectory,
    title: &str,
    names: Option<&[String]>,
    (width, height): (Option<u32>, Option<u32>),
    events: bool,
) -> Result<Option<PlotSpec>, PlotError> {
    let spec = default_figure(title, names, run)?;
    Ok(spec.map(|spec| PlotSpec {
        width: width.unwrap_or(spec.width),
        height: height.unwrap_or(spec.height),
        events,
        ..spec
    }))
}

fn wrong_figure(py: Python<'_>, why: &PlotError) -> PyErr {
    Trouble::plain(Wrong::Request, why.to_string()).raise(py)
}

/// Numbers in the order of the machine.
pub fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks::<8>().0.iter().map(|b| f64::from_ne_bytes(*b)).collect()
}

/// The bytes of numbers in the order of the machine.
pub fn bytes<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyBytes> {
    let all: Vec<u8> = values.iter().flat_map(|x| x.to_ne_bytes()).collect();
    PyBytes::new(py, &all)
}
