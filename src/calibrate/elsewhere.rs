//! Runs of recordings in other processes: the same numbers, whoever computes them.
//!
//! A front end offers an [`Elsewhere`] in [`Memory`](super::memory::Memory). A [`Problem`](super::problem::Problem) then
//! sends each evaluation of a recording there: a description of itself (the generated source, the free parameters, the
//! noise), which a worker compiles once, and where to evaluate. A worker has the plan, the model and the recordings
//! already. A recording that cannot be simulated is simulated again here, for the message.

use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use crate::base::diag::Problems;
use crate::base::source::{SourceMap, Span};
use crate::driver::compile::Session;
use crate::io::wire::{Reader, Writer};
use crate::ir::flat::Experiment;
use crate::ir::program::Program;
use crate::runtime::jit::tiering::Execution;

use super::data::Data;
use super::plan::{Free, Plan};
use super::problem::{Problem, record_signals};
use super::recording_number::{is_numbered, number_recordings};
use super::run::{CalibrationError, Request, inputs};

/// Programs that a worker keeps.
const MAX_PROGRAMS: usize = 12;

/// What a recording is evaluated for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Wanted {
    /// Numbers of residuals, then their sums of squares, signal by signal.
    Squares,
    /// The sum of squares.
    Cost,
    /// The normal equations: matrix, gradient, cost.
    Normal,
    /// All residuals.
    Residuals,
    /// Every residual, followed by its derivatives.
    Rows,
}

impl Wanted {
    const ALL: [Wanted; 5] =
        [Wanted::Squares, Wanted::Cost, Wanted::Normal, Wanted::Residuals, Wanted::Rows];
}

/// Other processes that do the work of this one.
pub trait Elsewhere: Send + Sync {
    /// Does the tasks of a problem; the answers in their order, `None` for a recording that cannot be simulated.
    /// Errors: why there are no answers.
    fn answers(&self, problem: &[u8], tasks: Vec<Vec<u8>>)
    -> Result<Vec<Option<Vec<f64>>>, String>;
}

/// A way to other processes, or none.
#[derive(Clone, Default)]
pub struct Way(pub Option<Arc<dyn Elsewhere>>);

impl fmt::Debug for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Way(Some(..))" } else { "Way(None)" })
    }
}

impl PartialEq for Way {
    /// Results do not depend on who computes them.
    fn eq(&self, _: &Way) -> bool {
        true
    }
}

/// A problem as a message.
pub fn described(program: &Program, sources: &SourceMap, plan: &Plan, data: &Data) -> Arc<[u8]> {
    let mut w = Writer::default();
    let appended = sources.files().find(|f| f.path.as_os_str() == APPENDED);
    w.optional(appended, |w, file| {
        w.text(&file.text);
        w.text(&program.blocks.dae.name);
    });
    let Experiment { start, stop, interval, tolerance } = program.blocks.dae.experiment;
    for x in [start, stop, interval, tolerance] {
        w.optional(x, Writer::number);
    }
    w.count(plan.free.len());
    for free in &plan.free {
        w.text(&free.name);
        w.count(free.targets.len());
        free.targets.iter().for_each(|t| w.text(t));
        for x in [free.start, free.min, free.max, free.around] {
            w.optional(x, Writer::number);
        }
        w.optional(free.acts_on.as_ref(), |w, (signal, variable)| {
            w.count(*signal);
            w.text(variable);
        });
        w.optional(free.only.as_ref(), |w, only| w.text(only));
    }
    w.count(plan.signals.len());
    plan.signals.iter().for_each(|s| w.text(&s.variable));
    w.count(usize::from(is_numbered(plan)));
    w.optional(plan.most_steps, |w, steps| w.count(steps as usize));
    w.count(plan.allowance as usize);
    w.numbers(&data.sigmas);
    w.count(checksum(data) as usize);
    w.0.into()
}

/// The path of a generated source.
const APPENDED: &str = "appended.mo";

/// A sum over everything that the recordings hold, so that a worker with other ones is found out.
fn checksum(data: &Data) -> u64 {
    let mut sum: u64 = 0xcbf2_9ce4_8422_2325;
    let mut add =
        |bits: u64| sum = (sum ^ bits).rotate_left(23).wrapping_mul(0x0000_0100_0000_01b3);
    for r in &data.recordings {
        add(r.time.len() as u64);
        r.name.bytes().for_each(|b| add(u64::from(b)));
        for x in
            r.time.iter().chain(&r.conditions).chain(&r.starts).chain(r.signals.iter().flatten())
        {
            add(if x.is_nan() { 1 } else { x.to_bits() });
        }
    }
    sum
}

/// Where to evaluate a recording, as a message.
pub fn task(recording: usize, wanted: Wanted, x: &[f64]) -> Vec<u8> {
    let mut w = Writer::default();
    w.count(recording);
    w.count(Wanted::ALL.iter().position(|k| *k == wanted).unwrap_or(0));
    w.numbers(x);
    w.0
}

/// A process that does such tasks: the plan, the model and the recordings.
pub struct Worker {
    plan: Plan,
    data: Data,
    /// Folder of further effects.
    effects: Option<PathBuf>,
    modelica_path: Option<OsString>,
    programs: Mutex<Vec<(Vec<u8>, Arc<Described>)>>,
}

/// A problem that was described, compiled.
struct Described {
    plan: Plan,
    data: Data,
    sources: SourceMap,
    program: Program,
    execution: Execution,
}

impl Worker {
    /// Reads what a request names.
    pub fn new(
        request: &Request,
        effects: Option<PathBuf>,
        session: &mut Session,
    ) -> Result<Worker, CalibrationError> {
        let folder = request.data.as_deref();
        let (plan, data) = inputs(&request.plan, folder, &request.memory, session)?;
        let modelica_path = request.modelica_path.clone();
        Ok(Worker { plan, data, effects, modelica_path, programs: Mutex::default() })
    }

    /// Does a task: its numbers, or `None` if the recording cannot be simulated. Errors: why the task cannot be done
    /// here at all.
    pub fn answer(&self, problem: &[u8], task: &[u8]) -> Result<Option<Vec<f64>>, String> {
        let described = self.described(problem)?;
        let Described { plan, data, sources, program, execution } = &*described;
        let mut problems = Problems::new();
        let execution = Some(execution.clone());
        let made = Problem::with_execution(program, sources, plan, data, &mut problems, execution);
        let broken = || "a worker cannot read a task; is it of another version?".to_owned();
        let problem = made.ok_or_else(broken)?;
        let mut r = Reader(task);
        let (recording, wanted) = (r.count().ok_or_else(broken)?, r.count().ok_or_else(broken)?);
        let x = r.numbers().ok_or_else(broken)?;
        let recording = data.recordings.get(recording).ok_or_else(broken)?;
        let wanted = Wanted::ALL.get(wanted).ok_or_else(broken)?;
        Ok(problem.evaluated(recording, &x, *wanted).ok())
    }

    fn described(&self, message: &[u8]) -> Result<Arc<Described>, String> {
        let known = || self.programs.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, found)) = known().iter().find(|(m, _)| m == message) {
            return Ok(Arc::clone(found));
        }
        let made = Arc::new(self.compile(message)?);
        let mut all = known();
        if all.len() >= MAX_PROGRAMS {
            all.remove(0);
        }
        all.push((message.to_vec(), Arc::clone(&made)));
        Ok(made)
    }

    fn compile(&self, message: &[u8]) -> Result<Described, String> {
        let broken = || "a worker cannot read a problem; is it of another version?".to_owned();
        let (mut plan, mut data) = (self.plan.clone(), self.data.clone());
        let read = self.read(message, &mut plan, &mut data);
        let (appended, experiment, sum) = read.ok_or_else(broken)?;
        if checksum(&data) != sum {
            return Err("the recordings of a worker differ from those of the client".to_owned());
        }
        let mut request = plan.request(self.modelica_path.clone());
        request.folders.extend(self.effects.clone());
        if let Some((text, name)) = appended {
            request.appended = Some(text);
            request.model = Some(name);
        }
        let mut session = Session { parameters_vary: true, ..Session::default() };
        let compiled = session.compile(&request);
        let mut program = compiled.map_err(|_| {
            let first = session.problems.iter().map(|d| d.message.clone()).next();
            format!("a worker cannot compile the model: {}", first.unwrap_or_default())
        })?;
        program.blocks.dae.experiment = experiment;
        record_signals(&mut program, &plan);
        let execution = Execution::translated(&program);
        Ok(Described { plan, data, sources: session.sources, program, execution })
    }

    /// Changes plan and data as a message says; the generated source, the experiment, and the sum over the recordings.
    fn read(
        &self,
        message: &[u8],
        plan: &mut Plan,
        data: &mut Data,
    ) -> Option<(Option<(String, String)>, Experiment, u64)> {
        let mut r = Reader(message);
        let appended = r.optional(|r| Some((r.text()?, r.text()?)))?;
        let experiment = Experiment {
            start: r.optional(Reader::number)?,
            stop: r.optional(Reader::number)?,
            interval: r.optional(Reader::number)?,
            tolerance: r.optional(Reader::number)?,
        };
        plan.free = r.list(|r| {
            Some(Free {
                name: r.text()?,
                targets: r.list(Reader::text)?,
                start: r.optional(Reader::number)?,
                min: r.optional(Reader::number)?,
                max: r.optional(Reader::number)?,
                around: r.optional(Reader::number)?,
                acts_on: r.optional(|r| Some((r.count()?, r.text()?)))?,
                only: r.optional(Reader::text)?,
                span: Span::NONE,
            })
        })?;
        let variables = r.list(Reader::text)?;
        if variables.len() != plan.signals.len() {
            return None;
        }
        for (signal, variable) in plan.signals.iter_mut().zip(variables) {
            signal.variable = variable;
        }
        // A diagnosis numbers the recordings of its plan.
        if r.count()? == 1 && !is_numbered(plan) {
            number_recordings(plan, data);
        }
        plan.most_steps = r.optional(|r| Some(r.count()? as u64))?;
        plan.allowance = r.count()? as u64;
        data.sigmas = r.numbers()?;
        Some((appended, experiment, r.count()? as u64))
    }
}
