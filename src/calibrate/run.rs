//! The workflow of a calibration, from a plan file to a calibrated model.
//!
//! Any front end can call [`run`]: it prints nothing, reads no environment and never ends the process.
//! Diagnostics accumulate in the [`Session`], progress goes to the [`Observer`].

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::driver::compile::{CompileError, Session};
use crate::driver::files;
use crate::driver::foreign::{is_fmu, not_allowed};
use crate::ir::program::Program;
use crate::simulate::failure::Failure;

use super::data::{self, Data, Split};
use super::fit::{self, Fit};
use super::memory::Memory;
use super::observer::{Event, Observer};
use super::plan::Plan;
use super::policy::FitPolicy;
use super::problem::{Problem, record_signals};
use super::profile::{self, Interval, Profiles};
use super::recording_number::number_where_declared;
use super::result::Calibration;
use super::statistics::{Statistics, reduced};
use super::{calibrated_model, plan_file, result};

/// What to calibrate, and how.
#[derive(Clone, Debug)]
pub struct Request {
    /// The plan file.
    pub plan: PathBuf,
    /// What takes the place of files.
    pub memory: Arc<Memory>,
    /// Folder of the recordings; the plan's own if not given.
    pub data: Option<PathBuf>,
    /// The value of `MODELICAPATH`.
    pub modelica_path: Option<OsString>,
    /// Follow the likelihood profiles for confidence intervals; otherwise take them from standard errors.
    pub profiles: bool,
    /// Limits, thresholds and stopping rules.
    pub policy: FitPolicy,
}

/// A finished calibration.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Estimates, their errors and the quality of the fit.
    pub calibration: Calibration,
    /// The model's file, followed by a model that extends it with the estimates; for an FMU the command that runs it
    /// with them.
    pub model: String,
    /// The file of the model.
    pub model_path: PathBuf,
    /// The fitted values, in the order of the problem's parameters and in their units.
    pub values: Vec<f64>,
    /// Their covariance, row by row; zero for those at a bound.
    pub covariance: Vec<f64>,
}

/// A plan, its recordings and its program, from which problems are made.
pub struct Prepared {
    /// The plan.
    pub plan: Plan,
    /// The recordings.
    pub data: Data,
    /// The compiled model, which records the variables of the signals.
    pub program: Program,
    /// The source of the model's file.
    pub original: String,
}

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// A file cannot be read.
    #[error("cannot read {}: {why}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// The plan, the recordings or the model are wrong; the diagnostics of the session say how.
    #[error(transparent)]
    Invalid(#[from] CompileError),
    /// The observer refused to start, for this reason.
    #[error("{0}")]
    Refused(String),
    /// A recording cannot be simulated at the start, or its derivatives cannot be computed.
    #[error("{}", .0.diagnostic.message)]
    Failed(Box<Failure>),
}

impl From<Failure> for CalibrationError {
    fn from(failure: Failure) -> Self {
        CalibrationError::Failed(Box::new(failure))
    }
}

/// Calibrates the model of a plan.
pub fn run(
    request: &Request,
    session: &mut Session,
    observer: &dyn Observer,
) -> Result<Outcome, CalibrationError> {
    let prepared = prepare(request, session)?;
    let mut problem = prepared.problem(&session.sources, &mut session.problems)?;
    check_start(&problem)?;
    observer.start(&session.problems, &session.sources).map_err(CalibrationError::Refused)?;
    calibrate(&prepared, &mut problem, request, observer)
}

/// Reads and compiles everything that a request names.
pub fn prepare(request: &Request, session: &mut Session) -> Result<Prepared, CalibrationError> {
    let folder = request.data.as_deref();
    let (mut plan, mut data) = inputs(&request.plan, folder, &request.memory, session)?;
    let mut program = session.compile(&plan.request(request.modelica_path.clone()))?;
    number_where_declared(&program, &mut plan, &mut data);
    record_signals(&mut program, &plan);
    let original = original(&plan)?;
    Ok(Prepared { plan, data, program, original })
}

impl Prepared {
    /// The residuals to minimise. Everything that the plan names must exist in the program.
    pub fn problem<'a>(
        &'a self,
        sources: &'a SourceMap,
        problems: &mut Problems,
    ) -> Result<Problem<'a>, CalibrationError> {
        let Prepared { plan, data, program, .. } = self;
        let problem = Problem::new(program, sources, plan, data, problems);
        Ok(problem.ok_or(CompileError::Request)?)
    }
}

/// Fits the parameters of a problem.
pub fn calibrate(
    prepared: &Prepared,
    problem: &mut Problem<'_>,
    request: &Request,
    observer: &dyn Observer,
) -> Result<Outcome, CalibrationError> {
    let Prepared { plan, data, program, original } = prepared;
    let fitted = fit_with_intervals(problem, request, observer)?;
    let of = (&fitted.statistics, fitted.intervals.as_slice());
    let summary = result::FitSummary {
        iterations: fitted.fit.iterations,
        converged: fitted.fit.converged,
        complete: !observer.is_cancelled(),
    };
    let calibration = Calibration::new(problem, plan, &data.repairs, &fitted.fit, of, summary)?;
    let model = match is_fmu(&plan.model) {
        true => calibrated_model::command(plan, &calibration),
        false => calibrated_model::text(original, program, plan, &calibration),
    };
    let values = problem.values(&fitted.fit.x);
    let covariance = fitted.statistics.covariance_of(&problem.parameters, &values);
    Ok(Outcome { calibration, model, model_path: plan.model.clone(), values, covariance })
}

/// The plan of a file and its recordings, perhaps from another folder.
pub fn inputs(
    path: &Path,
    folder: Option<&Path>,
    memory: &Arc<Memory>,
    session: &mut Session,
) -> Result<(Plan, Data), CalibrationError> {
    let mut plan = read_plan(path, folder, memory, session)?;
    let data = data::read(&plan, &mut session.problems).ok_or(CompileError::Request)?;
    data::check_training(&plan, &data, &mut session.problems).ok_or(CompileError::Request)?;
    plan.free_each(&data);
    Ok((plan, data))
}

/// The plan of a file, perhaps with recordings from another folder.
pub fn read_plan(
    path: &Path,
    folder: Option<&Path>,
    memory: &Arc<Memory>,
    session: &mut Session,
) -> Result<Plan, CalibrationError> {
    let text = memory.plan.clone().map_or_else(|| read(path), Ok)?;
    let plan = plan_file::read(path, &text, &mut session.sources, &mut session.problems);
    let mut plan = plan.ok_or(CompileError::Request)?;
    plan.memory = Arc::clone(memory);
    if let Some(folder) = folder {
        plan.folder = folder.to_owned();
    }
    check_fmu(&plan.model, memory, session)?;
    Ok(plan)
}

/// A plan does not decide whether foreign code runs.
pub fn check_fmu(model: &Path, memory: &Memory, session: &mut Session) -> Result<(), CompileError> {
    // What does not exist is reported where it is read.
    if !is_fmu(model) || !model.exists() || files::allows_fmu(&memory.fmus, model) {
        return Ok(());
    }
    session.problems.push(not_allowed(model));
    Err(CompileError::Request)
}

/// The source of the model's file; an FMU has none.
pub fn original(plan: &Plan) -> Result<String, CalibrationError> {
    if is_fmu(&plan.model) {
        return Ok(String::new());
    }
    plan.memory.model.clone().map_or_else(|| read(&plan.model), Ok)
}

/// The text of a file.
pub fn read(path: &Path) -> Result<String, CalibrationError> {
    let unreadable = |why| CalibrationError::Unreadable { path: path.to_owned(), why };
    files::read(path).map_err(unreadable)
}

/// Simulates the training recordings at the start; fails with the first one that cannot be simulated.
pub fn check_start(problem: &Problem<'_>) -> Result<(), Failure> {
    let start = problem.start();
    let Err(failure) = problem.sums(Split::Train, &start) else { return Ok(()) };
    let named = problem.recordings(Split::Train).into_iter().find_map(|r| {
        let mut failure = problem.predict(r, &start).err()?;
        let note = format!("so recording `{}` cannot be simulated at the start values", r.name);
        *failure.diagnostic = failure.diagnostic.note(note).note(OTHER_STARTS);
        Some(failure)
    });
    Err(named.unwrap_or(failure))
}

/// What may help against a failure before any parameter was fitted.
const OTHER_STARTS: &str = "other `start` values in `[free]` may avoid this; so may runs that begin again from the recording: \
                            `window` with `[starts]`";

/// A fit with all that is derived from it.
struct Fitted {
    fit: Fit,
    statistics: Statistics,
    intervals: Vec<Interval>,
}

/// Fits, then follows the profiles. If a profile runs into a better minimum, the fit resumes there.
fn fit_with_intervals(
    problem: &mut Problem<'_>,
    request: &Request,
    observer: &dyn Observer,
) -> Result<Fitted, Failure> {
    let policy = &request.policy;
    let count = problem.count(Split::Train);
    let free = problem.parameters.len();
    let mut steps = 0;
    let mut on_step = |_: u32, cost: f64| {
        steps += 1;
        observer.event(&Event::Step { number: steps, chi2: reduced(cost, count, free) });
        !observer.is_cancelled()
    };
    let Some(mut fit) = fit::fit(problem, policy, &mut on_step) else {
        // The start has been simulated, so only derivatives can be missing.
        let why = problem.normal(&problem.start()).err();
        return Err(why.unwrap_or_else(|| Failure::bug(0.0, "the fit has no result")));
    };
    let mut intervals = None;
    for _ in 0..=policy.profile_restarts {
        if !request.profiles || observer.is_cancelled() {
            break;
        }
        let statistics = Statistics::new(&fit.normal, &problem.parameters, &fit.x);
        let mut goes_on = |i: usize| {
            let parameter = problem.parameters[i].name.as_str();
            observer.event(&Event::Interval { parameter, number: i + 1, count: free });
            !observer.is_cancelled()
        };
        match profile::profile(problem, policy, &fit, &statistics, &mut goes_on) {
            Profiles::Intervals(found) => {
                intervals = Some(found);
                break;
            }
            Profiles::Better(x) => match fit::search(problem, &x, &policy.full, &mut on_step) {
                Some(better) => fit = better,
                None => break,
            },
        }
    }
    fit.iterations = steps;
    let statistics = Statistics::new(&fit.normal, &problem.parameters, &fit.x);
    let intervals = intervals.unwrap_or_else(|| profile::quadratic(problem, &fit, &statistics));
    Ok(Fitted { fit, statistics, intervals })
}
