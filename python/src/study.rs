//! Calibration and diagnosis with recordings in memory or in files.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use mocc::calibrate::elsewhere::{self, Elsewhere, Way};
use mocc::calibrate::memory::{Memory, NumberTable};
use mocc::calibrate::page;
use mocc::calibrate::policy::FitPolicy;
use mocc::calibrate::run::{self as calibration, check_start};
use mocc::diagnose::policy::SearchPolicy;
use mocc::diagnose::{self as search, page as search_page, summary as search_summary};
use mocc::driver::compile::Session;
use mocc::io::csv::TextTable;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::background::{self, Cancelled, Watch, spawn, wait};
use crate::error::{Kind, Trouble, lost, warnings};
use crate::run::{bytes, numbers};
use crate::sweep::{Folders, packed};
use crate::values::Values;

/// The name of a recording, and its columns with their numbers.
type Frame<'py> = (String, Vec<(String, Bound<'py, PyBytes>)>);
/// Names of columns, and rows of text.
type Strings = (Vec<String>, Vec<Vec<String>>);

fn memory(
    plan: Option<String>,
    model: Option<String>,
    table: Option<Strings>,
    recordings: Vec<Frame<'_>>,
    folders: Folders<'_>,
    way: Way,
) -> Arc<Memory> {
    let table = table.map(|(names, rows)| {
        let rows = rows.into_iter().enumerate().map(|(k, row)| (k as u64 + 1, row));
        TextTable { names, rows: rows.collect() }
    });
    let recordings = recordings.into_iter().map(|(name, columns)| {
        let (names, columns) =
            columns.into_iter().map(|(name, values)| (name, numbers(values.as_bytes()))).unzip();
        (name, NumberTable { names, columns })
    });
    let (recordings, packed) = (recordings.collect(), packed(folders));
    let (files, fmus) = (Vec::new(), Vec::new());
    Arc::new(Memory { plan, model, table, recordings, files, packed, fmus, elsewhere: way })
}

/// Other processes, as a Python function has them: of a problem and its tasks, as bytes, it makes the answers, as bytes.
struct Spread {
    function: Py<PyAny>,
    cancelled: Cancelled,
    /// The exception that the function has raised.
    raised: Mutex<Option<PyErr>>,
}

impl Spread {
    fn new(function: Option<Py<PyAny>>, cancelled: &Cancelled) -> Option<Arc<Spread>> {
        let (cancelled, raised) = (cancelled.clone(), Mutex::default());
        function.map(|function| Arc::new(Spread { function, cancelled, raised }))
    }

    /// As a way to other processes.
    fn way(this: &Option<Arc<Spread>>) -> Way {
        Way(this.clone().map(|spread| spread as Arc<dyn Elsewhere>))
    }

    /// Raises what the function has raised.
    fn check(this: &Option<Arc<Spread>>) -> PyResult<()> {
        let raised = this.as_ref().and_then(|s| match s.raised.lock() {
            Ok(mut raised) => raised.take(),
            Err(_) => None,
        });
        raised.map_or(Ok(()), Err)
    }
}

impl Elsewhere for Spread {
    fn answers(
        &self,
        problem: &[u8],
        tasks: Vec<Vec<u8>>,
    ) -> Result<Vec<Option<Vec<f64>>>, String> {
        const NONE: &str = "other processes do not answer";
        if self.cancelled.is_set() {
            return Err(NONE.to_owned());
        }
        let answers = Python::attach(|py| {
            let tasks: Vec<_> = tasks.iter().map(|task| PyBytes::new(py, task)).collect();
            let answers = self.function.call1(py, (PyBytes::new(py, problem), tasks))?;
            let answers: Vec<Option<Bound<'_, PyBytes>>> = answers.extract(py)?;
            Ok::<_, PyErr>(
                answers.into_iter().map(|a| a.map(|bytes| numbers(bytes.as_bytes()))).collect(),
            )
        });
        answers.map_err(|why| {
            self.cancelled.set();
            if let Ok(mut raised) = self.raised.lock() {
                raised.get_or_insert(why);
            }
            NONE.to_owned()
        })
    }
}

/// Files by their paths.
type Files<'py> = Vec<(PathBuf, Bound<'py, PyBytes>)>;

fn with_files(memory: Arc<Memory>, files: Files<'_>) -> Arc<Memory> {
    let files = files.into_iter().map(|(path, bytes)| (path, bytes.as_bytes().to_vec()));
    Arc::new(Memory { files: files.collect(), ..Arc::unwrap_or_clone(memory) })
}

/// The same with FMUs, or folders with FMUs, that the user allows to run.
fn with_fmus(memory: Arc<Memory>, fmus: Vec<PathBuf>) -> Arc<Memory> {
    Arc::new(Memory { fmus, ..Arc::unwrap_or_clone(memory) })
}

/// The files of a study: the model's, the folders of libraries, and tables and recordings that are not in memory.
#[pyfunction]
pub fn study_files(
    py: Python<'_>,
    plan: PathBuf,
    plan_text: Option<String>,
    model_text: Option<String>,
    table: Option<Strings>,
    recordings: Vec<Frame<'_>>,
    folder: Option<PathBuf>,
) -> PyResult<(PathBuf, Vec<PathBuf>, Vec<PathBuf>)> {
    let memory = memory(plan_text, model_text, table, recordings, Vec::new(), Way::default());
    let found = background::run(py, move |_| {
        let mut session = Session { parameters_vary: true, ..Session::default() };
        let found = calibration::inputs(&plan, folder.as_deref(), &memory, &mut session);
        let (plan, data) = found.map_err(|error| Trouble::of_calibration(&error, &session))?;
        let mut files: Vec<PathBuf> = data.recordings.iter().map(|r| r.path.clone()).collect();
        if !plan.table.is_empty() {
            files.push(plan.folder.join(&plan.table));
        }
        files.sort();
        files.dedup();
        files.retain(|path| path.is_file());
        Ok((plan.model, plan.libraries, files))
    })?;
    found.map_err(|trouble: Trouble| trouble.raise(py))
}

/// A process that evaluates recordings for others.
#[pyclass(frozen)]
pub struct Worker(Arc<elsewhere::Worker>);

#[pymethods]
impl Worker {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "all are named in the Python package")]
    fn new(
        py: Python<'_>,
        plan: PathBuf,
        plan_text: Option<String>,
        model_text: Option<String>,
        table: Option<Strings>,
        recordings: Vec<Frame<'_>>,
        folder: Option<PathBuf>,
        effects: Option<PathBuf>,
        folders: Folders<'_>,
        files: Files<'_>,
    ) -> PyResult<Worker> {
        let memory = memory(plan_text, model_text, table, recordings, folders, Way::default());
        let memory = with_files(memory, files);
        let request = calibration::Request {
            plan,
            memory,
            data: folder,
            modelica_path: std::env::var_os("MODELICAPATH"),
            profiles: false,
            policy: FitPolicy::default(),
        };
        let made = background::run(py, move |_| {
            let mut session = Session { parameters_vary: true, ..Session::default() };
            let made = elsewhere::Worker::new(&request, effects, &mut session);
            made.map_err(|error| Trouble::of_calibration(&error, &session))
        })?;
        made.map(|w| Worker(Arc::new(w))).map_err(|trouble: Trouble| trouble.raise(py))
    }

    /// The answers to tasks of a problem, as bytes; `None` for a recording that cannot be simulated.
    fn answers<'py>(
        &self,
        py: Python<'py>,
        problem: Vec<u8>,
        tasks: Vec<Vec<u8>>,
    ) -> PyResult<Vec<Option<Bound<'py, PyBytes>>>> {
        let worker = Arc::clone(&self.0);
        let found = background::run(py, move |_| {
            let one = |task: &Vec<u8>| worker.answer(&problem, task);
            tasks.iter().map(one).collect::<Result<Vec<_>, String>>()
        })?;
        let found = found.map_err(|why| Trouble::plain(Kind::Request, why).raise(py))?;
        Ok(found.into_iter().map(|answer| answer.map(|all| bytes(py, &all))).collect())
    }
}

/// A calibrated model, ready to compute residuals at other parameters.
#[pyclass(frozen)]
pub struct Calibration {
    /// The result as JSON.
    #[pyo3(get)]
    json: String,
    /// The page.
    #[pyo3(get)]
    page: String,
    /// The model's source with the estimates.
    #[pyo3(get)]
    model: String,
    /// Names of the fitted values.
    #[pyo3(get)]
    names: Vec<String>,
    /// Their units.
    #[pyo3(get)]
    units: Vec<String>,
    /// Their bounds.
    #[pyo3(get)]
    bounds: Vec<(f64, f64)>,
    /// The fitted values.
    #[pyo3(get)]
    values: Vec<f64>,
    /// Their covariance, row by row.
    #[pyo3(get)]
    covariance: Vec<f64>,
    /// Warnings, rendered.
    #[pyo3(get)]
    warnings: Vec<String>,
    /// To the thread that holds the problem; it ends with this object.
    questions: Sender<Question>,
}

/// Values at which residuals or their derivatives are wanted.
struct Question {
    values: Vec<f64>,
    is_jacobian: bool,
    answer: Sender<Result<Vec<f64>, Trouble>>,
}

#[pymethods]
impl Calibration {
    /// The residuals at these values, in units of the noise.
    fn residuals(&self, py: Python<'_>, values: &Bound<'_, PyBytes>) -> PyResult<Values> {
        self.ask(py, values, false)
    }

    /// Their derivatives, row by row.
    fn jacobian(&self, py: Python<'_>, values: &Bound<'_, PyBytes>) -> PyResult<Values> {
        self.ask(py, values, true)
    }
}

impl Calibration {
    fn ask(
        &self,
        py: Python<'_>,
        values: &Bound<'_, PyBytes>,
        is_jacobian: bool,
    ) -> PyResult<Values> {
        let (answer, answers) = channel();
        let values = numbers(values.as_bytes());
        self.questions.send(Question { values, is_jacobian, answer }).map_err(|_| lost())?;
        let found = wait(py, &answers, &Cancelled::default(), None)?;
        found.map(|numbers| Values(Arc::new(numbers))).map_err(|trouble| trouble.raise(py))
    }
}

/// Fits the free parameters of a plan.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "all are named in the Python package")]
pub fn calibrate(
    py: Python<'_>,
    plan: PathBuf,
    plan_text: Option<String>,
    model_text: Option<String>,
    table: Option<Strings>,
    recordings: Vec<Frame<'_>>,
    folder: Option<PathBuf>,
    profiles: bool,
    progress: Option<Py<PyAny>>,
    folders: Folders<'_>,
    files: Files<'_>,
    spread: Option<Py<PyAny>>,
    allow_fmu: Vec<PathBuf>,
) -> PyResult<Calibration> {
    let cancelled = Cancelled::default();
    let spread = Spread::new(spread, &cancelled);
    let memory = memory(plan_text, model_text, table, recordings, folders, Spread::way(&spread));
    let request = calibration::Request {
        plan,
        memory: with_fmus(with_files(memory, files), allow_fmu),
        data: folder,
        modelica_path: std::env::var_os("MODELICAPATH"),
        profiles,
        policy: FitPolicy::default(),
    };
    let (notes, heard) = channel();
    let (answer, answers) = channel();
    let (questions, asked) = channel();
    let watch = Watch { cancelled: cancelled.clone(), deadline: None, notes };
    spawn(move || serve(&request, watch, questions, &asked, &answer))?;
    let progress = progress.as_ref().map(|function| (&heard, function));
    let found = wait(py, &answers, &cancelled, progress)?;
    Spread::check(&spread)?;
    found.map_err(|trouble| trouble.raise(py))
}

/// Calibrates, then answers questions until nobody can ask any more.
fn serve(
    request: &calibration::Request,
    watch: Watch,
    questions: Sender<Question>,
    asked: &Receiver<Question>,
    answer: &Sender<Result<Calibration, Trouble>>,
) {
    let started_at = Instant::now();
    // Nobody may wait for an answer any more.
    let failed = |trouble| drop(answer.send(Err(trouble)));
    let mut session = Session { parameters_vary: true, ..Session::default() };
    let prepared = match calibration::prepare(request, &mut session) {
        Ok(prepared) => prepared,
        Err(error) => return failed(Trouble::of_calibration(&error, &session)),
    };
    let mut problem = match prepared.problem(&session.sources, &mut session.problems) {
        Ok(problem) => problem,
        Err(error) => return failed(Trouble::of_calibration(&error, &session)),
    };
    let fitted = check_start(&problem)
        .map_err(Into::into)
        .and_then(|()| calibration::calibrate(&prepared, &mut problem, request, &watch));
    let outcome = match fitted {
        Ok(outcome) => outcome,
        Err(error) => return failed(Trouble::of_calibration(&error, &session)),
    };
    let found = &outcome.calibration;
    let seconds = started_at.elapsed().as_secs_f64();
    let parameters = &problem.parameters;
    let sent = answer.send(Ok(Calibration {
        json: found.json(seconds),
        page: page::html(found, seconds),
        model: outcome.model,
        names: parameters.iter().map(|p| p.name.clone()).collect(),
        units: parameters.iter().map(|p| p.unit.clone()).collect(),
        bounds: parameters.iter().map(|p| p.bounds).collect(),
        values: outcome.values,
        covariance: outcome.covariance,
        warnings: warnings(&session.problems, &session.sources),
        questions,
    }));
    if sent.is_err() {
        return;
    }
    // Whoever listens to the progress need not wait for more, nor other processes for questions.
    drop(watch);
    problem.stay_here();
    for Question { values, is_jacobian, answer } in asked {
        let found = match is_jacobian {
            true => problem.jacobian(&values),
            false => problem.residual_vector(&values),
        };
        let found = found.map_err(|failure| Trouble::of_failure(&failure, &session.sources));
        // Nobody may wait any more.
        let _ = answer.send(found);
    }
}

/// Finds the effects that a model lacks. Returns the result as JSON, the page, a summary, the name and the source of the
/// amended model, and warnings.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "all are named in the Python package")]
pub fn diagnose<'py>(
    py: Python<'py>,
    plan: PathBuf,
    plan_text: Option<String>,
    model_text: Option<String>,
    table: Option<Strings>,
    recordings: Vec<Frame<'py>>,
    folder: Option<PathBuf>,
    effects: Option<PathBuf>,
    only: Vec<String>,
    time_limit: Option<f64>,
    progress: Option<Py<PyAny>>,
    spread: Option<Py<PyAny>>,
    allow_fmu: Vec<PathBuf>,
) -> PyResult<Bound<'py, PyTuple>> {
    let cancelled = Cancelled::default();
    let spread = Spread::new(spread, &cancelled);
    let way = Spread::way(&spread);
    let memory = memory(plan_text, model_text, table, recordings, Vec::new(), way);
    let request = search::run::Request {
        plan,
        memory: with_fmus(memory, allow_fmu),
        data: folder,
        effects,
        modelica_path: std::env::var_os("MODELICAPATH"),
        policy: SearchPolicy { only, ..SearchPolicy::default() },
        next: false,
    };
    let started_at = Instant::now();
    // A limit beyond what the clock can count is none.
    let limit = time_limit.and_then(|s| Duration::try_from_secs_f64(s).ok());
    let (notes, heard) = channel();
    let (answer, answers) = channel();
    let watch = Watch {
        cancelled: cancelled.clone(),
        deadline: limit.and_then(|limit| started_at.checked_add(limit)),
        notes,
    };
    spawn(move || {
        let mut session = Session { parameters_vary: true, ..Session::default() };
        let outcome = search::run::run(&request, &mut session, &watch);
        let outcome =
            outcome.map_err(|error| Trouble::of_diagnosis(&error, &session)).map(|found| {
                let seconds = started_at.elapsed().as_secs_f64();
                let amended = found.amended.as_ref().map(|a| (a.name.clone(), a.source.clone()));
                let file = amended.as_ref().map(|(name, _)| format!("{name}.mol"));
                (
                    search::json::json(&found, file.as_deref(), seconds),
                    search_page::html(&found),
                    search_summary::summary(&found, seconds),
                    amended,
                    warnings(&session.problems, &session.sources),
                )
            });
        // Nobody may wait any more.
        let _ = answer.send(outcome);
    })?;
    let progress = progress.as_ref().map(|function| (&heard, function));
    let found = wait(py, &answers, &cancelled, progress)?;
    Spread::check(&spread)?;
    found.map_err(|trouble| trouble.raise(py))?.into_pyobject(py)
}
