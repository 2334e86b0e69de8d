//! The workflow of a diagnosis, from a plan file to a verdict and an amended model.
//!
//! Any front end can call [`run`]: it prints nothing, reads no environment and never ends the process.
//! Diagnostics accumulate in the [`Session`], progress goes to the [`Observer`].

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

use crate::base::diag::{Diagnostic, did_you_mean};
use crate::base::source::Span;
use crate::calibrate::memory::Memory;
use crate::calibrate::observer::{Event, Observer};
use crate::calibrate::problem::{Problem, record_signals};
use crate::calibrate::run::{CalibrationError, check_start, inputs, original};
use crate::driver::compile::{CompileError, Session};

use super::amended_model::{AmendedModel, amended};
use super::balance::{Balance, Profile, balances, contributions};
use super::catalogue::{Effect, PARAMETER, of_folder, unknowns};
use super::cause::CatalogueCause;
use super::next_experiment::{NextExperiment, next_experiment};
use super::noise::noise;
use super::place::why_nowhere;
use super::policy::SearchPolicy;
use super::residual::test_sums;
use super::result::{Diagnosis, Verdict};
use super::rivals::{Sensor, sensors};
use super::search::{Search, diagnose};
use super::separate_starts::{SeparateStarts, separate_starts};
use super::study::{DiagnosisError, Study};
use super::surroundings::surround;

/// What to diagnose, and how.
#[derive(Clone, Debug)]
pub struct Request {
    /// The plan file.
    pub plan: PathBuf,
    /// What takes the place of files.
    pub memory: Arc<Memory>,
    /// Folder of the recordings; the plan's own if not given.
    pub data: Option<PathBuf>,
    /// Folder of further effects.
    pub effects: Option<PathBuf>,
    /// The value of `MODELICAPATH`.
    pub modelica_path: Option<OsString>,
    /// Limits, thresholds and stopping rules.
    pub policy: SearchPolicy,
    /// Also find the recording that would tell most.
    pub next: bool,
}

/// A finished diagnosis.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The study.
    pub study: Study,
    /// The result of the search.
    pub diagnosis: Diagnosis,
    /// The balances of the model without effects, if they were examined.
    pub balances: Vec<Balance>,
    /// The contribution of the first effect, recording by recording, if balances were examined.
    pub contributions: Vec<Profile>,
    /// The source of the model's file.
    pub original: String,
    /// The amended model, if the effects found explain the misfit.
    pub amended: Option<AmendedModel>,
    /// The diagnosis was not cancelled.
    pub complete: bool,
    /// Variables whose measurement would tell the effects that were found from those that explain as much.
    pub sensors: Vec<Sensor>,
    /// States whose starts would explain a misfit that is unexplained, if each recording had its own.
    pub starts: Option<SeparateStarts>,
    /// The recording that would tell most, if it was asked for; `None` within if there is nothing to choose.
    pub next: Option<Option<NextExperiment>>,
}

impl Outcome {
    /// The verdict.
    pub fn verdict(&self) -> Verdict {
        self.diagnosis.verdict(&self.study.policy)
    }

    /// True if the effects that were found explain the misfit.
    pub fn is_explained(&self) -> bool {
        self.verdict() == Verdict::EffectFound
    }
}

/// Why a run has no outcome.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The plan, the recordings or the model are wrong, or the start cannot be simulated.
    #[error(transparent)]
    Setup(#[from] CalibrationError),
    /// The search cannot begin.
    #[error(transparent)]
    Search(#[from] DiagnosisError),
}

impl From<CompileError> for RunError {
    fn from(error: CompileError) -> Self {
        RunError::Setup(error.into())
    }
}

/// Diagnoses the model of a plan.
pub fn run(
    request: &Request,
    session: &mut Session,
    observer: &dyn Observer,
) -> Result<Outcome, RunError> {
    let (mut study, unknowns) = prepare(request, session)?;
    let original = original(&study.plan)?;
    observer.start(&session.problems, &session.sources).map_err(CalibrationError::Refused)?;
    study.plan.cancellation = observer.cancellation();
    let mut diagnosis = diagnose(&study, observer)?;
    let corrections = diagnosis.noise.corrections(&study.policy);
    let is_complete = diagnosis.noise.is_all() && diagnosis.after.effects.is_empty();
    if let Some(factors) = corrections.filter(|_| !is_complete) {
        study.correct_noise(factors);
        diagnosis = diagnose(&study, observer)?;
    }
    let complete = !observer.is_cancelled();
    diagnosis.noise = noise(&study, &diagnosis.after);
    diagnosis.before.test = test_sums(&study, &diagnosis.before);
    diagnosis.after.test = test_sums(&study, &diagnosis.after);
    let (mut all, mut contributed) = (Vec::new(), Vec::new());
    if complete && diagnosis.verdict(&study.policy) != Verdict::Complete {
        all = balances(&study, &unknowns, &diagnosis.before);
        contributed = contributions(&study, &unknowns, &diagnosis.after);
        observer.event(&Event::Note(&format!("{} balances examined", all.len())));
    }
    let is_explained = diagnosis.verdict(&study.policy) != Verdict::Unexplained;
    let starts = match complete && !is_explained {
        true => separate_starts(&Search::new(&study, observer), &diagnosis.before),
        false => None,
    };
    let amended = amended(&study, &diagnosis, &original).filter(|_| is_explained);
    let (balances, contributions) = (all, contributed);
    let sensors = if complete { sensors(&study, &diagnosis) } else { Vec::new() };
    let next = (request.next && complete).then(|| next_experiment(&study, &diagnosis));
    Ok(Outcome {
        study,
        diagnosis,
        balances,
        contributions,
        original,
        amended,
        complete,
        sensors,
        starts,
        next,
    })
}

/// Errors: the search is restricted to effects that do not exist.
fn refuse_unknown(study: &Study, session: &mut Session) -> Result<(), CompileError> {
    let is_known = |name: &String| study.effects.iter().any(|effect| effect.is_called(name));
    let unknown: Vec<&String> = study.policy.only.iter().filter(|name| !is_known(name)).collect();
    for name in &unknown {
        let short =
            |effect: &Effect| effect.name().rsplit('.').next().unwrap_or_default().to_owned();
        let mut names: Vec<String> = study.effects.iter().map(short).collect();
        names.push(PARAMETER.to_owned());
        let near = did_you_mean(name, names.iter().map(String::as_str)).map(str::to_owned);
        let cause = CatalogueCause::UnknownEffect { name: (*name).clone(), near };
        session.problems.push(Diagnostic::new(cause, Span::NONE));
    }
    if unknown.is_empty() { Ok(()) } else { Err(CompileError::Request) }
}

/// Reads and checks everything before the search: the study, and the unknown inflows for balances.
fn prepare(request: &Request, session: &mut Session) -> Result<(Study, Vec<Effect>), RunError> {
    let folder = request.data.as_deref();
    let (mut plan, data) = inputs(&request.plan, folder, &request.memory, session)?;
    surround(session, &mut plan, &data)?;
    let mut compiled = plan.request(request.modelica_path.clone());
    compiled.folders.extend(request.effects.clone());
    let own = match &request.effects {
        Some(folder) => of_folder(session, &compiled, folder)?,
        None => Vec::new(),
    };
    let (mut flat, inventory) = session.flatten_with_inventory(&compiled)?;
    let (form, recorded) = (compiled.form, compiled.recorded.clone());
    let unknowns = unknowns(session, &Study::packages(&compiled, &own));
    let policy = request.policy.clone();
    let mut study = Study::new(session, (compiled, &own), (&flat, inventory), (plan, data), policy);
    refuse_unknown(&study, session)?;
    session.drive(&mut flat, &recorded)?;
    let mut program = session.compile_flat(flat, form)?;
    record_signals(&mut program, &study.plan);
    let problem =
        Problem::new(&program, &session.sources, &study.plan, &study.data, &mut session.problems);
    check_start(&problem.ok_or(CompileError::Request)?).map_err(CalibrationError::from)?;
    for effect in study.effects.iter().chain(&unknowns).filter(|e| own.contains(&e.class)) {
        if study.places(effect, &study.plan).is_empty() {
            let (class, why) = (effect.class.clone(), why_nowhere(effect, &study.inventory));
            let cause = CatalogueCause::FitsNowhere { class, why };
            session.problems.push(Diagnostic::new(cause, effect.span.unwrap_or(Span::NONE)));
        }
    }
    study.read_at_terminals();
    Ok((study, unknowns))
}
