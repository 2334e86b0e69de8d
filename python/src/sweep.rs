//! Many runs of one model: the rows of a table, in memory.

use std::path::PathBuf;
use std::sync::Arc;

use mocc::driver::compile::Session;
use mocc::io::records::{Cell, Field, Type};
use mocc::ir::flat::Experiment;
use mocc::ir::program::SystemForm;
use mocc::ir::trajectory::Column;
use mocc::simulate::settings::Settings;
use mocc::sweep::design::Design;
use mocc::sweep::error::SweepError;
use mocc::sweep::pool::cores;
use mocc::sweep::runs;
use mocc::sweep::variant::{Model, Variants};
use mocc::sweep::vary::{Axis, Values};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::background;
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

/// A sweep, compiled and ready to run.
#[pyclass(frozen)]
pub struct Sweep(Arc<Inner>);

struct Inner {
    design: Design,
    variants: Variants,
    settings: Settings,
    measures: Vec<Column>,
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
    ) -> PyResult<Sweep> {
        let request = request(file, text, model, settings, folders);
        let axes: Vec<Axis> = vary.into_iter().map(axis).collect();
        let made = background::run(py, move |_| {
            let design = match sample {
                None => Design::grid(axes),
                Some((count, seed)) => Design::latin_hypercube(axes, count, seed),
            };
            let design = design.map_err(|why| wrong(&why))?;
            let model = Model {
                request: mocc::driver::compile::Request { form: SystemForm::Ode, ..request },
                measures,
                keep: None,
            };
            let mut session = Session { parameters_vary: true, ..Session::default() };
            let base = model.compile(&[], &mut session);
            let mut base = base.map_err(|error| Trouble::of_session(error, &session))?;
            let experiment = base.program.blocks.dae.experiment;
            let (stop, interval, tolerance, method) = options;
            let mut settings = Settings::of(&Experiment {
                start: experiment.start,
                stop: stop.or(experiment.stop),
                interval: interval.or(experiment.interval),
                tolerance: tolerance.or(experiment.tolerance),
            });
            // The package only passes names that exist.
            settings.method = method_named(&method).unwrap_or_default();
            let measures = base.plan.columns.clone();
            base.sources = std::mem::take(&mut session.sources);
            let variants = Variants::new(model, base, &design.axes, design.count);
            let mut session = Session { parameters_vary: true, ..Session::default() };
            let checked = variants.check(&design.values(0), &mut session);
            checked.map_err(|error| Trouble::of_session(error, &session))?;
            Ok(Inner { design, variants, settings: settings.without_grid(), measures })
        })?;
        made.map(|inner| Sweep(Arc::new(inner))).map_err(|trouble: Trouble| trouble.raise(py))
    }

    /// Number of runs.
    fn __len__(&self) -> usize {
        self.0.design.count as usize
    }

    /// Name, type, unit and description of each column of the table.
    fn fields(&self) -> Vec<(String, &'static str, String, String)> {
        let name = |ty| match ty {
            Type::Real => "Real",
            Type::Integer => "Integer",
            Type::Text => "String",
        };
        let all = self.0.sweep(1).fields().into_iter();
        all.map(|Field { name: n, ty, unit, description }| (n, name(ty), unit, description))
            .collect()
    }

    /// The rows of the runs from `begin` to `end`, counted from 0, on so many threads, or on all cores.
    fn rows<'py>(
        &self,
        py: Python<'py>,
        begin: u64,
        end: u64,
        jobs: Option<usize>,
    ) -> PyResult<Vec<Bound<'py, PyTuple>>> {
        let inner = Arc::clone(&self.0);
        let found = background::run(py, move |cancelled| {
            let sweep = inner.sweep(jobs.unwrap_or_else(cores).max(1));
            let mut rows = Vec::new();
            let outcome = sweep.rows(begin..end, &|| cancelled.is_set(), |_, cells| {
                rows.push(cells);
                Ok(())
            });
            outcome.map(|()| rows).map_err(|why| wrong(&why))
        })?;
        let rows = found.map_err(|trouble| trouble.raise(py))?;
        rows.into_iter().map(|cells| row(py, cells)).collect()
    }
}

impl Inner {
    fn sweep(&self, jobs: usize) -> runs::Sweep<'_> {
        runs::Sweep {
            design: &self.design,
            variants: &self.variants,
            settings: self.settings.clone(),
            traces: None,
            measures: self.measures.clone(),
            jobs,
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

fn row(py: Python<'_>, cells: Vec<Cell>) -> PyResult<Bound<'_, PyTuple>> {
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

fn wrong(why: &SweepError) -> Trouble {
    Trouble::plain(Kind::Request, why.to_string())
}
