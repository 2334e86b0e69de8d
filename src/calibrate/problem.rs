//! A model, recordings and free parameters: the residuals that a fit minimises.
//!
//! A residual is the difference between a variable and the signal that measures it, in units of the sensor's
//! noise. [`super::recording_run`] computes those of a recording, [`super::slopes`] their derivatives, and
//! [`super::objective`] those of all recordings together.

use std::sync::Arc;

use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::source::SourceMap;
use crate::codegen::recording;
use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::runtime::jit::tiering::Execution;
use crate::runtime::machine::Machine;
use crate::simulate::sensitivity::Input;
use crate::simulate::settings::Settings;

use super::cancellation::Cancellation;
use super::cause::PlanCause;
use super::data::{Data, Recording, Split};
use super::elsewhere::{self, Elsewhere};
use super::parallel;
use super::parameter::{Parameter, input, parameter};
use super::plan::{Plan, RECORDING_NUMBER};
use super::unit::Unit;
use super::unit_check;

/// A signal and its variable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    /// Position among the recorded variables.
    pub column: usize,
    /// Unit of the signal.
    pub unit: Unit,
    /// Standard deviation of its noise, in that unit.
    pub sigma: f64,
}

/// Where residuals are evaluated, in coordinates of the search.
#[derive(Clone, Copy, Debug)]
pub struct Point<'x> {
    /// The free parameters.
    pub free: &'x [f64],
    /// The parameters that the recording has for itself; empty for one that is fitted.
    pub own: &'x [f64],
}

/// By which parameters residuals are differentiated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum By {
    /// By the free parameters.
    Free,
    /// By those that the recording has for itself.
    Own,
}

/// Everything that residuals depend on, except for the values of the parameters. Threads share it.
pub struct Problem<'a> {
    /// The compiled model, which records the variables of the signals.
    pub program: &'a Program,
    pub(super) sources: &'a SourceMap,
    pub(super) data: &'a Data,
    /// The free parameters.
    pub parameters: Vec<Parameter>,
    /// Parameters of which a recording has a value of its own, for the recordings that are not fitted: their
    /// values are fitted to them alone ([`super::own_fit`]).
    pub own: Vec<Parameter>,
    /// Parameters that the conditions of the plan set; `None` for the number of the recording, if the program has none.
    pub(super) conditions: Vec<Option<VarId>>,
    /// Inputs of the program that the starts of the recordings set.
    pub(super) starts: Vec<Input>,
    /// Inputs of the model that the recordings drive.
    pub(super) driven: Vec<VarId>,
    pub(super) channels: Vec<Channel>,
    pub(super) settings: Settings,
    /// How many times as many steps as usual a run of a training recording may take.
    pub(super) allowance: u64,
    /// Ends runs in the middle of a search.
    pub(super) cancellation: Cancellation,
    /// Training recordings that are trimmed at present, by position.
    pub trimmed: Vec<usize>,
    /// The run was cancelled: searches return what they have.
    pub stopped: bool,
    /// Threads.
    pub jobs: usize,
    /// Other processes that evaluate recordings, and this problem as they know it.
    pub(super) elsewhere: Option<(Arc<dyn Elsewhere>, Arc<[u8]>)>,
}

/// Restricts the recorded variables of the program to those that the plan compares.
pub fn record_signals(program: &mut Program, plan: &Plan) {
    record_also(program, plan, &[]);
}

/// The same with other variables besides.
pub fn record_also(program: &mut Program, plan: &Plan, others: &[String]) {
    recording::only(program, |name| {
        let acts = plan.free.iter().filter_map(|f| f.acts_on.as_ref());
        plan.signals.iter().any(|s| s.variable == name)
            || acts.map(|(_, v)| v).chain(others).any(|v| v == name)
    });
}

impl<'a> Problem<'a> {
    /// Finds everything that the plan names in the program. What is missing is added to `problems`.
    pub fn new(
        program: &'a Program,
        sources: &'a SourceMap,
        plan: &Plan,
        data: &'a Data,
        problems: &mut Problems,
    ) -> Option<Self> {
        let mut problem = Problem::with_execution(program, sources, plan, data, problems, None)?;
        if let Some(other) = &plan.memory.elsewhere.0 {
            let description = elsewhere::described(program, sources, plan, data);
            problem.elsewhere = Some((Arc::clone(other), description));
        }
        Some(problem)
    }

    /// The same for runs in this process, by code that exists already.
    pub fn with_execution(
        program: &'a Program,
        sources: &'a SourceMap,
        plan: &Plan,
        data: &'a Data,
        problems: &mut Problems,
        execution: Option<Execution>,
    ) -> Option<Self> {
        let before = problems.error_count();
        unit_check::check(program, plan, problems);
        let conditions = conditions(program, plan, problems);
        let mut starts = Vec::new();
        for s in &plan.starts {
            starts.extend(input(program, &s.target, s.span, problems));
        }
        let variables = &program.blocks.dae.variables;
        let named = |name: &str| variables.enumerate().find(|(_, v)| v.name == name);
        // The compiler has checked that they exist.
        let driven: Vec<VarId> =
            plan.inputs.iter().filter_map(|i| Some(named(&i.input)?.0)).collect();
        warn_of_undriven(program, plan, &driven, problems);
        let channels = channels(program, plan, data, problems);
        let mut machine = Machine::new(program);
        let evaluated = machine.run(&program.tapes.parameters).is_ok();
        let parameters: Vec<Parameter> =
            plan.free.iter().filter_map(|f| parameter(program, &machine, f, problems)).collect();
        // Those of the training recordings are among the free ones, and have been checked there.
        let unchecked = &mut Problems::new();
        let problems_of_own =
            if plan.free.iter().any(|f| f.only.is_some()) { unchecked } else { &mut *problems };
        let own: Vec<Parameter> = plan
            .each
            .iter()
            .filter_map(|f| parameter(program, &machine, f, problems_of_own))
            .collect();
        if problems.error_count() > before || !evaluated {
            return None;
        }
        Some(Problem {
            program,
            sources,
            data,
            parameters,
            own,
            conditions,
            starts,
            driven,
            channels,
            settings: settings(program, plan, execution),
            trimmed: Vec::new(),
            allowance: plan.allowance,
            cancellation: plan.cancellation.clone(),
            stopped: false,
            jobs: parallel::cores(),
            elsewhere: None,
        })
    }

    /// From now on evaluates all recordings in this process.
    pub fn stay_here(&mut self) {
        if self.elsewhere.take().is_some() {
            self.settings.execution = Execution::translated(self.program);
        }
    }

    /// The values of the parameters at `x`.
    pub fn values(&self, x: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(x).map(|(p, x)| p.scale.value(*x)).collect()
    }

    /// The start of the search.
    pub fn start(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.scale.place(p.start)).collect()
    }

    /// The bounds of the search.
    pub fn bounds(&self) -> Vec<(f64, f64)> {
        self.parameters.iter().map(Parameter::range).collect()
    }

    /// The recordings of one kind.
    pub fn recordings(&self, split: Split) -> Vec<&'a Recording> {
        self.data.of(split).collect()
    }

    /// The windows of a recording, or itself if it is whole.
    pub fn windows(&self, recording: &Recording) -> Vec<&'a Recording> {
        self.data.of(recording.split).filter(|r| r.of == recording.of).collect()
    }

    /// Number of residuals of one kind of recordings.
    pub fn count(&self, split: Split) -> usize {
        let values = self.data.of(split).flat_map(|r| r.signals.iter().flatten());
        values.filter(|v| !v.is_nan()).count()
    }

    /// Training recordings that a short fit can do without: the others have about `enough` instants, and are
    /// spread evenly over the list.
    pub fn surplus(&self, enough: usize) -> Vec<usize> {
        let lengths: Vec<usize> = self.data.of(Split::Train).map(|r| r.time.len()).collect();
        let total: usize = lengths.iter().sum();
        let kept = (lengths.len() * enough).div_ceil(total.max(1)).max(2);
        if kept >= lengths.len() {
            return Vec::new();
        }
        let is_kept = |i: usize| i * kept / lengths.len() != (i + 1) * kept / lengths.len();
        (0..lengths.len()).filter(|i| !is_kept(*i)).collect()
    }

    /// Standard deviations of the signals' noise, in the units of their columns.
    pub fn sigmas(&self) -> &'a [f64] {
        &self.data.sigmas
    }
}

/// The parameters that the conditions of the plan set.
fn conditions(program: &Program, plan: &Plan, problems: &mut Problems) -> Vec<Option<VarId>> {
    let mut out = Vec::new();
    for c in &plan.conditions {
        let has_it = program.blocks.dae.variables.iter().any(|v| v.name == c.parameter);
        if c.parameter == RECORDING_NUMBER && !has_it {
            out.push(None);
            continue;
        }
        match input(program, &c.parameter, c.span, problems) {
            Some(Input::Parameter(v)) => out.push(Some(v)),
            Some(Input::Start(_)) | None => {}
        }
    }
    out
}

/// Warns of inputs of the model that neither columns nor start values of the plan determine.
fn warn_of_undriven(program: &Program, plan: &Plan, driven: &[VarId], problems: &mut Problems) {
    let variables = program.blocks.dae.variables.enumerate();
    for (v, x) in variables.filter(|(v, x)| x.is_open_input() && !driven.contains(v)) {
        let start = format!("start({})", x.name);
        if !plan.starts.iter().any(|s| s.target == start) && !plan.targets().contains(&start) {
            let cause = PlanCause::NotDriven { input: program.name(v).to_owned() };
            problems.push(Diagnostic::new(cause, x.span));
        }
    }
}

/// The variables of the signals.
fn channels(program: &Program, plan: &Plan, data: &Data, problems: &mut Problems) -> Vec<Channel> {
    let mut out = Vec::new();
    for (signal, sigma) in plan.signals.iter().zip(&data.sigmas) {
        let mut names = program.recorded.iter().map(|v| program.name(*v));
        match names.position(|n| n == signal.variable) {
            Some(column) => out.push(Channel { column, unit: signal.unit, sigma: *sigma }),
            None => {
                let wanted = &signal.variable;
                let all = program.blocks.dae.variables.enumerate();
                let all: Vec<&str> = all.map(|(v, _)| program.name(v)).collect();
                let near = did_you_mean(wanted, all).map(str::to_owned);
                let cause = PlanCause::UnknownVariable { name: wanted.clone(), near };
                problems.push(Diagnostic::new(cause, signal.span));
            }
        }
    }
    out
}

/// The settings of all runs.
fn settings(program: &Program, plan: &Plan, execution: Option<Execution>) -> Settings {
    let mut settings = Settings::of(&program.blocks.dae.experiment);
    settings.spacing = program.blocks.dae.experiment.interval;
    settings.most_steps = plan.most_steps.unwrap_or(settings.most_steps);
    // Thousands of runs: machine code pays, unless others do them.
    settings.execution = match execution {
        Some(execution) => execution,
        None if plan.memory.elsewhere.0.is_some() => Execution::default(),
        None => Execution::translated(program),
    };
    settings
}
