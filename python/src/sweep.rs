//! Many runs of one model: the rows of a table, as lines of a journal.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mocc::cli::sweep::{Command, files_named};
use mocc::driver::compile::{Request, Session};
use mocc::driver::packed::Packed;
use mocc::io::journal::{self as file, Found};
use mocc::io::records::{Cell, Field, Type, line, row};
use mocc::ir::flat::Experiment;
use mocc::ir::program::SystemForm;
use mocc::runtime::host::arithmetic;
use mocc::simulate::settings::Settings;
use mocc::sweep::design::Design;
use mocc::sweep::error::SweepError;
use mocc::sweep::pool::cores;
use mocc::sweep::prepared::Prepared;
use mocc::sweep::variant::Model;
use mocc::sweep::vary::{Axis, Values};
use pyo3::exceptions::PySystemExit;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::background::{self, Cancelled, spawn, wait};
use crate::error::{Kind, Trouble};
use crate::model::{Setting, method_named, request};

/// The values of a parameter: a range to sample, or a list.
#[derive(FromPyObject)]
pub enum Points {
    /// Lowest and highest value, SI.
    Range((f64, f64)),
    /// The values.
    Levels(Vec<Setting>),
}

/// Options of all runs: stop, interval and tolerance.
type Options = (Option<f64>, Option<f64>, Option<f64>, String);

/// Folders with their files.
pub type Folders<'py> = Vec<(PathBuf, Vec<(PathBuf, Bound<'py, PyBytes>)>)>;

/// Folders in memory.
pub fn packed(folders: Folders<'_>) -> Packed {
    Packed::new(folders.into_iter().map(|(name, files)| {
        let files = files.into_iter().map(|(path, bytes)| (path, bytes.as_bytes().to_vec()));
        (name, files.collect())
    }))
}

/// A sweep, compiled and ready to run.
#[pyclass(frozen)]
pub struct Sweep(Arc<Inner>);

enum Inner {
    /// Of the package.
    Own(Prepared),
    /// Of the command line.
    Command(Command),
}

#[pymethods]
impl Sweep {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "all are named in the Python package")]
    fn new(
        py: Python<'_>,
        file: Option<PathBuf>,
        text: Option<String>,
        model: Option<String>,
        settings: Vec<String>,
        folders: Vec<PathBuf>,
        vary: Vec<(String, Points)>,
        sample: Option<(u64, u64)>,
        measures: Vec<String>,
        options: Options,
        files: Folders<'_>,
    ) -> PyResult<Sweep> {
        let request = Request {
            form: SystemForm::Ode,
            packed: packed(files),
            ..request(file, text, model, settings, folders)
        };
        let axes: Vec<Axis> = vary.into_iter().map(axis).collect();
        let what = format!("{:?}", (&request.settings, &axes, sample, &measures, &options));
        let made = background::run(py, move |_| {
            let design = match sample {
                None => Design::grid(axes),
                Some((count, seed)) => Design::latin_hypercube(axes, count, seed),
            };
            let design = design.map_err(|why| wrong(&why))?;
            let model = Model { request, measures, keep: None };
            let mut session = Session { parameters_vary: true, ..Session::default() };
            let (stop, interval, tolerance, method) = options;
            let settings = |experiment: &Experiment| {
                let mut settings = Settings::of(&Experiment {
                    start: experiment.start,
                    stop: stop.or(experiment.stop),
                    interval: interval.or(experiment.interval),
                    tolerance: tolerance.or(experiment.tolerance),
                });
                // The package only passes names that exist.
                settings.method = method_named(&method).unwrap_or_default();
                settings.without_grid()
            };
            let made = Prepared::new(model, design, settings, &what, |_| {}, &mut session);
            made.map_err(|error| Trouble::of_session(error, &session))
        })?;
        let made = made.map_err(|trouble: Trouble| trouble.raise(py))?;
        Ok(Sweep(Arc::new(Inner::Own(made))))
    }

    /// The sweep of a command line, whose first argument is the name of the program, with its model's file and the folders
    /// of libraries in memory. What is wrong is on the standard error, and ends the process.
    #[staticmethod]
    fn command(
        py: Python<'_>,
        arguments: Vec<OsString>,
        text: Option<String>,
        files: Folders<'_>,
    ) -> PyResult<Sweep> {
        let packed = packed(files);
        let made = background::run(py, move |_| Command::named(arguments, text, &packed))?;
        let made = made.map_err(|status| PySystemExit::new_err(status as u8))?;
        Ok(Sweep(Arc::new(Inner::Command(made))))
    }

    /// Number of runs.
    fn __len__(&self) -> usize {
        self.0.prepared().design.count as usize
    }

    /// Name, type, unit and description of each column of the table.
    fn fields(&self) -> Vec<(String, &'static str, String, String)> {
        let name = |ty| match ty {
            Type::Real => "Real",
            Type::Integer => "Integer",
            Type::Text => "String",
        };
        let all = self.0.fields().into_iter();
        all.map(|Field { name: n, ty, unit, description }| (n, name(ty), unit, description))
            .collect()
    }

    /// The lines of the runs from `begin` to `end`, counted from 0, on so many threads, or on all cores. `tell` is called
    /// with each of them, in order.
    fn lines(
        &self,
        py: Python<'_>,
        begin: u64,
        end: u64,
        jobs: Option<usize>,
        tell: Option<Py<PyAny>>,
    ) -> PyResult<Vec<String>> {
        let inner = Arc::clone(&self.0);
        let cancelled = Cancelled::default();
        let (answer, answers) = channel();
        let (notes, heard) = channel();
        let (told, is_heard) = (cancelled.clone(), tell.is_some());
        spawn(move || {
            let sweep = inner.prepared().sweep(jobs.unwrap_or_else(cores).max(1));
            let mut lines = Vec::new();
            let outcome = sweep.rows(begin..end, &|| told.is_set(), |_, cells| {
                let text = line(&cells);
                if is_heard {
                    // Nobody may listen any more.
                    let _ = notes.send(text.clone());
                }
                lines.push(text);
                Ok(())
            });
            // Nobody may wait any more.
            let _ = answer.send(outcome.map(|()| lines).map_err(|why| wrong(&why)));
        })?;
        let found = wait(py, &answers, &cancelled, tell.as_ref().map(|tell| (&heard, tell)))?;
        found.map_err(|trouble| trouble.raise(py))
    }

    /// The values of a line.
    fn row<'py>(&self, py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyTuple>> {
        let cells = row(text, &self.0.fields());
        let cells = cells.map_err(|why| wrong(&why.into()).raise(py))?;
        let cell = |cell: Cell| {
            Ok::<_, PyErr>(match cell {
                Cell::Missing => py.None(),
                Cell::Real(x) => x.into_pyobject(py)?.into_any().unbind(),
                Cell::Integer(n) => n.into_pyobject(py)?.into_any().unbind(),
                Cell::Text(text) => text.into_pyobject(py)?.into_any().unbind(),
            })
        };
        PyTuple::new(py, cells.into_iter().map(cell).collect::<Result<Vec<_>, _>>()?)
    }

    /// The journal of this sweep: the file, or that of the command line.
    fn journal(&self, py: Python<'_>, path: Option<PathBuf>) -> PyResult<Journal> {
        let raise = |why: SweepError| wrong(&why).raise(py);
        let found = match (&path, &*self.0) {
            (None, Inner::Command(command)) => command.journal().map_err(raise)?,
            (None, Inner::Own(_)) => {
                return Err(Trouble::plain(Kind::Internal, "no path").raise(py));
            }
            (Some(path), inner) => {
                let fingerprint = inner.prepared().fingerprint.0;
                let shown = path.display().to_string();
                match file::Journal::open(path, fingerprint, arithmetic()) {
                    Ok(Found::Ours(journal)) => journal,
                    Ok(Found::Other) => return Err(raise(SweepError::Other { journal: shown })),
                    Ok(Found::Foreign) => {
                        return Err(raise(SweepError::Foreign { journal: shown }));
                    }
                    Err(why) => return Err(raise(why.into())),
                }
            }
        };
        Ok(Journal(Mutex::new(Some(found))))
    }

    /// Trajectories of runs are written to files.
    fn keeps_trajectories(&self) -> bool {
        matches!(&*self.0, Inner::Command(command) if command.keeps_trajectories())
    }

    /// Writes the table of the command line from its journal, prints what it did, and returns the exit status.
    fn finish(&self, journal: &Journal, done: u64, seconds: f64, how: &str) -> u8 {
        match (&*self.0, journal.lock().take()) {
            (Inner::Command(command), Some(journal)) => {
                command.finish(journal, done, seconds, how) as u8
            }
            _ => mocc::cli::Status::Bug as u8,
        }
    }
}

impl Inner {
    fn prepared(&self) -> &Prepared {
        match self {
            Inner::Own(prepared) => prepared,
            Inner::Command(command) => &command.prepared,
        }
    }

    fn fields(&self) -> Vec<Field> {
        self.prepared().sweep(1).fields()
    }
}

/// The file of model and the folders of libraries of a command line for a sweep, and the address of the cluster.
#[pyfunction]
pub fn sweep_files(
    arguments: Vec<OsString>,
) -> PyResult<(Option<PathBuf>, Vec<PathBuf>, Option<String>)> {
    files_named(arguments).map_err(|status| PySystemExit::new_err(status as u8))
}

/// A journal, open until it is closed or removed.
#[pyclass(frozen)]
pub struct Journal(Mutex<Option<file::Journal>>);

#[pymethods]
impl Journal {
    /// Its lines.
    fn lines(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let mut all = Vec::new();
        self.with(py, |journal| {
            journal.for_each(|line| {
                all.push(line.to_owned());
                true
            })
        })?;
        Ok(all)
    }

    /// Appends lines.
    fn push(&self, py: Python<'_>, lines: Vec<String>) -> PyResult<()> {
        self.with(py, |journal| lines.iter().try_for_each(|line| journal.push(line)))
    }

    /// Closes the file; it remains.
    fn close(&self) {
        self.lock().take();
    }

    /// Removes the file.
    fn remove(&self, py: Python<'_>) -> PyResult<()> {
        let removed = self.lock().take().map(file::Journal::remove);
        removed.unwrap_or(Ok(())).map_err(|why| wrong(&why.into()).raise(py))
    }
}

impl Journal {
    fn lock(&self) -> MutexGuard<'_, Option<file::Journal>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn with(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut file::Journal) -> Result<(), file::JournalError>,
    ) -> PyResult<()> {
        match &mut *self.lock() {
            Some(journal) => work(journal).map_err(|why| wrong(&why.into()).raise(py)),
            None => Err(Trouble::plain(Kind::Internal, "the journal is closed").raise(py)),
        }
    }
}

fn axis((name, points): (String, Points)) -> Axis {
    let values = match points {
        Points::Range((from, to)) => Values::Range { from, to, count: None },
        Points::Levels(list) => Values::Levels(list.into_iter().map(Setting::value).collect()),
    };
    let text = name.clone();
    Axis { name, text, values }
}

fn wrong(why: &SweepError) -> Trouble {
    Trouble::plain(Kind::Request, why.to_string())
}
