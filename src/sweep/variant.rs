//! The programs of a sweep: one for all parameters that are inputs, and one for each value of a structural
//! structure of the model depends on.

use std::sync::{Arc, Mutex, OnceLock};

use super::vary::{Axis, Value};
use crate::base::diag::{Diagnostic, Severity};
use crate::base::source::SourceMap;
use crate::driver::compile::{CompileError, Request, Session};
use crate::ir::program::Program;
use crate::measure::observe::Plan;
use crate::runtime::jit::tiering::Execution;
use crate::simulate::sensitivity::Input;
use crate::simulate::settable::settable;
use crate::simulate::settings::Settings;

/// Programs to keep; more only while more are in use.
const MAX_CACHED: usize = 16;

/// The model of a sweep.
pub struct Model {
    /// The model and the settings of all runs.
    pub request: Request,
    /// Sources of measures.
    pub measures: Vec<String>,
    /// Variables whose trajectories are kept.
    pub keep: Option<Keep>,
}

/// Which variables are kept, by name.
pub type Keep = Arc<dyn Fn(&str) -> bool + Send + Sync>;

/// A program that runs share.
pub struct Compiled {
    /// The code.
    pub program: Program,
    /// The measures.
    pub plan: Plan,
    /// The sources, for messages.
    pub sources: SourceMap,
    /// Interpreted or compiled to machine code.
    pub execution: Execution,
}

/// How an axis enters a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Entry {
    /// As a value for a parameter of the program.
    Parameter,
    /// As a value for a start of the program.
    Start,
    /// The program depends on it.
    Structure,
}

/// All programs of a sweep. Threads share it.
pub struct Variants {
    model: Model,
    names: Vec<String>,
    /// One for each axis.
    pub entries: Vec<Entry>,
    base: Arc<Compiled>,
    others: Mutex<Vec<Cached>>,
}

type Outcome = Arc<OnceLock<Result<Arc<Compiled>, String>>>;

struct Cached {
    values: Vec<String>,
    outcome: Outcome,
}

impl Model {
    /// The program with further settings.
    pub fn compile(
        &self,
        settings: &[String],
        session: &mut Session,
    ) -> Result<Compiled, CompileError> {
        let mut request = self.request.clone();
        request.set(settings);
        let (mut program, mut plan) = session.compile_measured(&request, &self.measures)?;
        match &self.keep {
            Some(keep) => plan.record(&mut program, |name| keep(name)),
            None => plan.record(&mut program, |_| false),
        }
        Ok(Compiled {
            program,
            plan,
            sources: SourceMap::default(),
            execution: Execution::default(),
        })
    }
}

impl Variants {
    /// The programs for these axes, from the one without any of them, and the number of runs.
    pub fn new(model: Model, base: Compiled, axes: &[Axis], runs: u64) -> Self {
        let entries: Vec<Entry> = axes.iter().map(|axis| entry(&base.program, axis)).collect();
        let names = axes.iter().map(|a| a.name.clone()).collect();
        let mut base = base;
        if runs > FEW_RUNS && !entries.contains(&Entry::Structure) {
            base.execution = Execution::translated(&base.program);
        }
        Variants { model, names, entries, base: Arc::new(base), others: Mutex::new(Vec::new()) }
    }

    /// The program of a run, or why there is none.
    pub fn of(&self, values: &[Value]) -> Result<Arc<Compiled>, String> {
        let settings = self.settings(values);
        if settings.is_empty() {
            return Ok(Arc::clone(&self.base));
        }
        let outcome = self.outcome(settings.clone());
        let compile = || {
            let mut session = Session { parameters_vary: true, ..Session::default() };
            match self.model.compile(&settings, &mut session) {
                Ok(mut compiled) => {
                    compiled.sources = session.sources;
                    compiled.execution = Execution::translated(&compiled.program);
                    Ok(Arc::new(compiled))
                }
                Err(_) => Err(first_error(&session)),
            }
        };
        outcome.get_or_init(compile).clone()
    }

    /// The settings with which the program of a run must be compiled, besides those of all runs.
    pub fn settings(&self, values: &[Value]) -> Vec<String> {
        let all = self.names.iter().zip(values).zip(&self.entries);
        all.filter(|(_, entry)| **entry == Entry::Structure)
            .map(|((name, value), _)| format!("{name}={}", value.expression()))
            .collect()
    }

    /// Finds an error that every run would have, such as an unknown parameter: [`CompileError::Request`]. `first` holds
    /// the values of the first run.
    pub fn check(&self, first: &[Value], session: &mut Session) -> Result<(), CompileError> {
        let settings = self.settings(first);
        if settings.is_empty() {
            return Ok(());
        }
        let mut request = self.model.request.clone();
        request.set(&settings);
        match session.flatten(&request) {
            Err(CompileError::Request) => Err(CompileError::Request),
            // An error at these values alone is the outcome of their run.
            Ok(_) | Err(CompileError::Model) => Ok(()),
        }
    }

    /// Gives the run the values that are inputs of its program.
    pub fn set(&self, program: &Program, values: &[Value], settings: &mut Settings) -> bool {
        for ((name, value), entry) in self.names.iter().zip(values).zip(&self.entries) {
            let Value::Number(x) = value else { continue };
            match entry {
                Entry::Structure => {}
                Entry::Parameter | Entry::Start => match settable(program, name) {
                    Some(input) => settings.set(input, *x),
                    None => return false,
                },
            }
        }
        true
    }

    /// The SI unit of an axis; empty if it is not known.
    pub fn unit(&self, axis: usize) -> String {
        let program = &self.base.program;
        let name = &self.names[axis];
        let v = settable(program, name).map(Input::variable);
        v.map_or(String::new(), |v| program.blocks.dae.variables[v].unit.to_string())
    }

    fn outcome(&self, values: Vec<String>) -> Outcome {
        let mut others = match self.others.lock() {
            Ok(others) => others,
            Err(poisoned) => poisoned.into_inner(),
        };
        // The most recent is the last.
        let kept = match others.iter().position(|k| k.values == values) {
            Some(at) => others.remove(at),
            None => Cached { values, outcome: Outcome::default() },
        };
        let outcome = Arc::clone(&kept.outcome);
        others.push(kept);
        if others.len() > MAX_CACHED {
            others.remove(0);
        }
        outcome
    }
}

/// Number of runs up to which compiling to machine code does not pay.
const FEW_RUNS: u64 = 4;

fn entry(program: &Program, axis: &Axis) -> Entry {
    match settable(program, &axis.name).filter(|_| axis.is_numeric()) {
        Some(Input::Parameter(_)) => Entry::Parameter,
        Some(Input::Start(_)) => Entry::Start,
        None => Entry::Structure,
    }
}

/// The first error of a session, in one line.
pub fn first_error(session: &Session) -> String {
    let error = session.problems.iter().find(|d| d.severity == Severity::Error);
    error.map_or_else(|| "cannot be compiled".to_owned(), |d| in_one_line(d, &session.sources))
}

/// A message with code and place, in one line.
pub fn in_one_line(d: &Diagnostic, sources: &SourceMap) -> String {
    let place = sources.place(d.primary.0).map_or(String::new(), |place| format!(" ({place})"));
    format!("{}: {}{place}", d.code, d.message.replace('\n', " "))
}
