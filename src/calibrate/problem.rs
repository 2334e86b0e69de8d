//! A model, recordings and free parameters: the residuals that a fit minimises.
//!
//! A residual is the difference between a variable and the signal that measures it, in units of the sensor's
//! noise. Its derivatives are propagated with the run (`simulate::sensitivity`): they are exact, even across
//! events. Where they do not exist, central differences take their place.

use std::sync::Arc;

use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::source::SourceMap;
use crate::codegen::recording;
use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::numeric::least_squares::{NormalEquations, Residuals};
use crate::runtime::jit::tiering::Execution;
use crate::runtime::machine::Machine;
use crate::simulate::failure::Failure;
use crate::simulate::run::{simulate_to, simulate_with_known_sensitivities};
use crate::simulate::sensitivity::Input;
use crate::simulate::settings::Settings;

use super::cause::PlanCause;
use super::data::{Data, Recording, Split};
use super::elsewhere::{self, Elsewhere, Wanted};
use super::parallel;
use super::parameter::{Parameter, input, parameter};
use super::plan::{Plan, RECORDING_NUMBER};
use super::rows::Rows;
use super::sums::Sums;
use super::unit::Unit;
use super::unit_check;

/// Steps after which a run is abandoned, besides those for each row of the recording.
const MAX_STEPS: u64 = 100_000;
/// Further steps for each row of the recording.
const MAX_STEPS_PER_ROW: u64 = 100;

/// A signal and its variable.
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// Position among the recorded variables.
    column: usize,
    unit: Unit,
    sigma: f64,
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

/// A parameter that the runs of a recording take.
struct Taken<'p> {
    parameter: &'p Parameter,
    value: f64,
    /// It is one that the recording has for itself.
    is_own: bool,
    /// Its position among those of its kind.
    index: usize,
}

/// Everything that residuals depend on, except for the values of the parameters. Threads share it.
pub struct Problem<'a> {
    /// The compiled model, which records the variables of the signals.
    pub program: &'a Program,
    sources: &'a SourceMap,
    data: &'a Data,
    /// The free parameters.
    pub parameters: Vec<Parameter>,
    /// Parameters of which a recording has a value of its own, for the recordings that are not fitted: their
    /// values are fitted to them alone ([`super::own_fit`]).
    pub own: Vec<Parameter>,
    /// Parameters that the conditions of the plan set; `None` for the number of the recording, if the program has none.
    conditions: Vec<Option<VarId>>,
    /// Inputs of the program that the starts of the recordings set.
    starts: Vec<Input>,
    /// Inputs of the model that the recordings drive.
    driven: Vec<VarId>,
    channels: Vec<Channel>,
    settings: Settings,
    /// Training recordings that are trimmed at present, by position.
    pub trimmed: Vec<usize>,
    /// The run was cancelled: searches return what they have.
    pub stopped: bool,
    /// Threads.
    pub jobs: usize,
    /// Other processes that evaluate recordings, and this problem as they know it.
    elsewhere: Option<(Arc<dyn Elsewhere>, Arc<[u8]>)>,
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
        let mut conditions = Vec::new();
        for c in &plan.conditions {
            let has_it = program.blocks.dae.variables.iter().any(|v| v.name == c.parameter);
            if c.parameter == RECORDING_NUMBER && !has_it {
                conditions.push(None);
                continue;
            }
            match input(program, &c.parameter, c.span, problems) {
                Some(Input::Parameter(v)) => conditions.push(Some(v)),
                Some(Input::Start(_)) | None => {}
            }
        }
        let mut starts = Vec::new();
        for s in &plan.starts {
            starts.extend(input(program, &s.target, s.span, problems));
        }
        let variables = &program.blocks.dae.variables;
        let named = |name: &str| variables.enumerate().find(|(_, v)| v.name == name);
        // The compiler has checked that they exist.
        let driven = plan.inputs.iter().filter_map(|i| Some(named(&i.input)?.0)).collect();
        let mut channels = Vec::new();
        for (signal, sigma) in plan.signals.iter().zip(&data.sigmas) {
            let names = program.recorded.iter().map(|v| program.name(*v));
            match names.clone().position(|n| n == signal.variable) {
                Some(column) => channels.push(Channel { column, unit: signal.unit, sigma: *sigma }),
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
        let mut settings = Settings::of(&program.blocks.dae.experiment);
        settings.spacing = program.blocks.dae.experiment.interval;
        // Thousands of runs: machine code pays, unless others do them.
        settings.execution = match execution {
            Some(execution) => execution,
            None if plan.memory.elsewhere.0.is_some() => Execution::default(),
            None => Execution::translated(program),
        };
        let jobs = parallel::cores();
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
            settings,
            trimmed: Vec::new(),
            stopped: false,
            jobs,
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

    /// The parameters that the runs of a recording take.
    fn taken<'p>(&'p self, recording: &Recording, at: Point<'_>) -> Vec<Taken<'p>> {
        let taken = |is_own: bool| {
            move |(index, (parameter, x)): (usize, (&'p Parameter, &f64))| Taken {
                parameter,
                value: parameter.scale.value(*x),
                is_own,
                index,
            }
        };
        let free = self.parameters.iter().zip(at.free).enumerate();
        let free = free.filter(|(_, (p, _))| p.acts_in(recording));
        let own = self.own.iter().zip(at.own).enumerate();
        free.map(taken(false)).chain(own.map(taken(true))).collect()
    }

    /// Settings of a run under the conditions of a recording.
    fn settings(&self, recording: &Recording, taken: &[Taken<'_>]) -> Settings {
        let mut settings = self.settings.clone();
        let conditions = self.conditions.iter().copied().zip(recording.conditions.iter().copied());
        let set = conditions.filter(|(_, value)| !value.is_nan());
        settings.parameters = set.filter_map(|(v, value)| Some((v?, value))).collect();
        for (target, value) in self.starts.iter().zip(&recording.starts) {
            match *target {
                Input::Parameter(v) => settings.parameters.push((v, *value)),
                Input::Start(v) => settings.starts.push((v, *value)),
            }
        }
        let courses = recording.courses.iter().cloned();
        settings.courses = self.driven.iter().copied().zip(courses).collect();
        for Taken { parameter, value, .. } in taken {
            for target in &parameter.targets {
                match *target {
                    Input::Parameter(v) => settings.parameters.push((v, *value)),
                    Input::Start(v) => settings.starts.push((v, *value)),
                }
            }
        }
        let first = recording.time.first().copied().unwrap_or(settings.start);
        settings.start = recording.start.unwrap_or(settings.start.min(first));
        settings.stop = recording.time.last().copied().unwrap_or(settings.stop);
        settings.instants = Some(recording.time.clone());
        // A model that states no interval is looked at as often as it was recorded.
        let rows = recording.time.len().saturating_sub(1).max(1) as f64;
        settings.spacing = settings.spacing.or(Some((settings.stop - settings.start) / rows));
        // A search passes through values at which a run would take hours; no minimum lies there.
        settings.most_steps = MAX_STEPS + MAX_STEPS_PER_ROW * recording.time.len() as u64;
        settings
    }

    /// The variables of the signals at the instants of a recording, signal by signal, in the units of
    /// the columns.
    pub fn predict(&self, recording: &Recording, x: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        let own = self.own_place(recording, x)?;
        self.predict_at(recording, Point { free: x, own: &own })
    }

    /// The recorded variables at the instants of a recording, in SI units.
    pub(super) fn rows_at(&self, recording: &Recording, at: Point<'_>) -> Result<Rows, Failure> {
        let settings = self.settings(recording, &self.taken(recording, at));
        let mut rows = Rows::new(recording.time.clone(), self.program.recorded.len(), 0);
        simulate_to(self.program, &settings, self.sources, &mut rows)?;
        Ok(rows)
    }

    /// For each signal the recorded variable through which a parameter acts on it, if it does, and the factor from its
    /// unit to the noise of the sensor.
    pub(super) fn channels_of(&self, parameter: &Parameter) -> Vec<(Option<usize>, f64)> {
        let of = |(k, c): (usize, &Channel)| {
            let column = match parameter.acts_on {
                Some((only, _)) if only != k => None,
                Some((_, column)) => Some(column),
                None => Some(c.column),
            };
            (column, 1.0 / (c.unit.factor * c.sigma))
        };
        self.channels.iter().enumerate().map(of).collect()
    }

    /// The tolerance of the runs.
    pub(super) fn tolerance(&self) -> f64 {
        self.settings.tolerance
    }

    fn predict_at(&self, recording: &Recording, at: Point<'_>) -> Result<Vec<Vec<f64>>, Failure> {
        let rows = self.rows_at(recording, at)?;
        let of = |c: &Channel| {
            let values =
                rows.values.chunks_exact(rows.width).map(|row| c.unit.of_si(row[c.column]));
            values.collect()
        };
        Ok(self.channels.iter().map(of).collect())
    }

    /// Other recorded variables at the instants of a recording, variable by variable, in SI units; variables
    /// that are not recorded are skipped.
    pub fn others(
        &self,
        recording: &Recording,
        x: &[f64],
        names: &[String],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let own = self.own_place(recording, x)?;
        let taken = self.taken(recording, Point { free: x, own: &own });
        let settings = self.settings(recording, &taken);
        let width = self.program.recorded.len();
        let mut rows = Rows::new(recording.time.clone(), width, 0);
        simulate_to(self.program, &settings, self.sources, &mut rows)?;
        let column = |name: &String| {
            let k = self.program.recorded.iter().position(|v| self.program.name(*v) == name)?;
            Some(rows.values.chunks_exact(width).map(|row| row[k]).collect())
        };
        Ok(names.iter().filter_map(column).collect())
    }

    /// Residuals of a recording, signal by signal, in units of the noise; NaN without a value.
    pub fn residuals(&self, recording: &Recording, x: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        let own = self.own_place(recording, x)?;
        self.residuals_at(recording, Point { free: x, own: &own })
    }

    /// As `residuals`, with given values of the recording's own parameters.
    pub fn residuals_at(
        &self,
        recording: &Recording,
        at: Point<'_>,
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let mut predicted = self.predict_at(recording, at)?;
        for ((p, measured), c) in predicted.iter_mut().zip(&recording.signals).zip(&self.channels) {
            for (p, m) in p.iter_mut().zip(measured) {
                *p = (*p - m) / c.sigma;
            }
        }
        Ok(predicted)
    }

    /// The least and the greatest value of recorded variables over the training recordings.
    pub fn ranges(&self, x: &[f64], names: &[String]) -> Result<Vec<(f64, f64)>, Failure> {
        let recordings = self.recordings(Split::Train);
        let of_run = |i: usize| {
            let recording = recordings[i];
            let settings =
                self.settings(recording, &self.taken(recording, Point { free: x, own: &[] }));
            let width = self.program.recorded.len();
            let mut rows = Rows::new(recording.time.clone(), width, 0);
            simulate_to(self.program, &settings, self.sources, &mut rows).map(|_| rows.values)
        };
        let runs = parallel::map(self.jobs, recordings.len(), of_run);
        let runs: Vec<Vec<f64>> = runs.into_iter().collect::<Result<_, _>>()?;
        let width = self.program.recorded.len();
        let of = |name: &String| {
            let column = self.program.recorded.iter().position(|v| self.program.name(*v) == name);
            let column = column?;
            let all = runs.iter().flat_map(|run| run.chunks_exact(width).map(move |r| r[column]));
            Some(all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v))))
        };
        Ok(names.iter().map(|n| of(n).unwrap_or((0.0, 0.0))).collect())
    }

    /// Sums of squares over the recordings of one kind; the first failure in their order.
    pub fn sums(&self, split: Split, x: &[f64]) -> Result<Sums, Failure> {
        let mut sums = Sums::default();
        for both in self.each(&self.recordings(split), x, Wanted::Squares) {
            let both = both?;
            let (counts, squares) = both.split_at(both.len() / 2);
            sums.counts.push(counts.iter().map(|n| *n as usize).collect());
            sums.squares.push(squares.to_vec());
        }
        Ok(sums)
    }

    /// The training recordings that are not trimmed.
    fn fitted(&self) -> Vec<&'a Recording> {
        let all = self.data.of(Split::Train).enumerate();
        all.filter(|(i, _)| !self.trimmed.contains(i)).map(|(_, r)| r).collect()
    }

    /// The sum of squares over the training recordings that are not trimmed.
    fn cost_of_fitted(&self, x: &[f64]) -> Result<f64, Failure> {
        let mut sum = 0.0;
        for cost in self.each(&self.fitted(), x, Wanted::Cost) {
            sum += cost?.iter().sum::<f64>();
        }
        Ok(sum)
    }

    /// Evaluates recordings, on all cores or elsewhere; the results in their order.
    pub(super) fn each(
        &self,
        recordings: &[&Recording],
        x: &[f64],
        wanted: Wanted,
    ) -> Vec<Result<Vec<f64>, Failure>> {
        let here = |i: usize| self.evaluated(recordings[i], x, wanted);
        let Some((elsewhere, description)) = &self.elsewhere else {
            return parallel::map(self.jobs, recordings.len(), here);
        };
        let position =
            |r: &&Recording| self.data.recordings.iter().position(|k| std::ptr::eq(k, *r));
        let tasks: Option<Vec<Vec<u8>>> =
            recordings.iter().map(|r| position(r).map(|k| elsewhere::task(k, wanted, x))).collect();
        let Some(tasks) = tasks else {
            return parallel::map(self.jobs, recordings.len(), here);
        };
        match elsewhere.answers(description, tasks) {
            // Simulated again here, a recording that fails says why.
            Ok(all) => {
                let answer =
                    |(i, found): (usize, Option<Vec<f64>>)| found.map_or_else(|| here(i), Ok);
                all.into_iter().enumerate().map(answer).collect()
            }
            Err(why) => recordings.iter().map(|_| Err(Failure::settings(why.clone()))).collect(),
        }
    }

    /// Evaluates a recording in this thread.
    pub fn evaluated(
        &self,
        recording: &Recording,
        x: &[f64],
        wanted: Wanted,
    ) -> Result<Vec<f64>, Failure> {
        let valid = |r: &&f64| !r.is_nan();
        match wanted {
            Wanted::Squares => {
                let residuals = self.residuals(recording, x)?;
                let count = |r: &Vec<f64>| r.iter().filter(valid).count() as f64;
                let square = |r: &Vec<f64>| r.iter().filter(valid).map(|r| r * r).sum();
                Ok(residuals.iter().map(count).chain(residuals.iter().map(square)).collect())
            }
            Wanted::Cost => {
                let residuals = self.residuals(recording, x)?;
                Ok(vec![residuals.iter().flatten().filter(valid).map(|r| r * r).sum::<f64>()])
            }
            Wanted::Normal => {
                let NormalEquations { gram, gradient, cost, .. } = self.normal_of(recording, x)?;
                Ok([gram, gradient, vec![cost]].concat())
            }
            Wanted::Residuals => {
                let residuals = self.residuals(recording, x)?;
                let instants = 0..recording.time.len();
                let at = |k: usize| residuals.iter().map(move |signal| signal[k]);
                Ok(instants.flat_map(at).filter(|r| !r.is_nan()).collect())
            }
            Wanted::Slopes => {
                let mut rows = Vec::new();
                self.each_slope(recording, x, |_, slopes| rows.extend_from_slice(slopes))?;
                Ok(rows)
            }
        }
    }

    /// The normal equations of the training recordings that are not trimmed.
    pub fn normal(&self, x: &[f64]) -> Result<NormalEquations, Failure> {
        self.normal_of_all(&self.fitted(), x)
    }

    /// The normal equations of the recordings of one kind.
    pub fn normal_of_split(&self, split: Split, x: &[f64]) -> Result<NormalEquations, Failure> {
        self.normal_of_all(&self.recordings(split), x)
    }

    fn normal_of_all(
        &self,
        recordings: &[&Recording],
        x: &[f64],
    ) -> Result<NormalEquations, Failure> {
        let n = self.parameters.len();
        let mut sum = NormalEquations::new(n);
        for normal in self.each(recordings, x, Wanted::Normal) {
            let all = normal?;
            let (gram, rest) = all.split_at(n * n);
            let (gradient, cost) = (rest[..n].to_vec(), rest[n]);
            sum.merge(&NormalEquations { n, gram: gram.to_vec(), gradient, cost });
        }
        Ok(sum)
    }

    /// The normal equations of one recording.
    pub fn normal_of(&self, recording: &Recording, x: &[f64]) -> Result<NormalEquations, Failure> {
        let mut normal = NormalEquations::new(self.parameters.len());
        self.each_slope(recording, x, |residual, slopes| normal.add(residual, slopes))?;
        Ok(normal)
    }

    /// Every residual of a recording with its derivatives by the search parameters.
    pub fn each_slope(
        &self,
        recording: &Recording,
        x: &[f64],
        take: impl FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let own = self.own_place(recording, x)?;
        self.each_slope_at(recording, Point { free: x, own: &own }, By::Free, take)
    }

    /// The same by the free parameters, or by the recording's own.
    pub fn each_slope_at(
        &self,
        recording: &Recording,
        at: Point<'_>,
        by: By,
        mut take: impl FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let taken = self.taken(recording, at);
        let settings = self.settings(recording, &taken);
        // Only parameters that the recording takes have derivatives; those of the others are zero.
        let moved: Vec<&Taken<'_>> = taken.iter().filter(|t| t.is_own == (by == By::Own)).collect();
        let inputs: Vec<Input> =
            moved.iter().flat_map(|t| t.parameter.targets.iter().copied()).collect();
        let width = self.program.recorded.len();
        let mut rows = Rows::new(recording.time.clone(), width, inputs.len());
        let (program, sources) = (self.program, self.sources);
        let run =
            simulate_with_known_sensitivities(program, &settings, &inputs, sources, &mut rows);
        let unknown = match run {
            Ok(statistics) => {
                self.differences(recording, at, by, &hidden_parameters(&moved, &statistics.hidden))?
            }
            Err(failure) if failure.is_without_derivatives() => {
                return self.each_difference(recording, at, by, take);
            }
            Err(failure) => return Err(failure),
        };
        let channels: Vec<Vec<(Option<usize>, f64)>> =
            moved.iter().map(|t| self.channels_of(t.parameter)).collect();
        let mut slopes = vec![0.0; self.count_of(by)];
        for k in 0..recording.time.len() {
            let row = &rows.values[k * width..(k + 1) * width];
            let all = &rows.slopes[k * width * inputs.len()..(k + 1) * width * inputs.len()];
            for (channel, (c, signal)) in self.channels.iter().zip(&recording.signals).enumerate() {
                if signal[k].is_nan() {
                    continue;
                }
                let residual = (c.unit.of_si(row[c.column]) - signal[k]) / c.sigma;
                let mut first = 0;
                for (Taken { parameter: p, value, index, .. }, channels) in
                    moved.iter().zip(&channels)
                {
                    let (column, factor) = channels[channel];
                    let sum: f64 = column.map_or(0.0, |column| {
                        let at = column * inputs.len() + first;
                        all[at..at + p.targets.len()].iter().sum()
                    });
                    first += p.targets.len();
                    let known = sum * p.scale.slope(*value) * factor;
                    slopes[*index] = unknown.slope(*index, k, channel).unwrap_or(known);
                }
                take(residual, &slopes);
            }
        }
        Ok(())
    }

    /// As `each_slope_at`, by differences alone.
    fn each_difference(
        &self,
        recording: &Recording,
        at: Point<'_>,
        by: By,
        mut take: impl FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let here = self.residuals_at(recording, at)?;
        let all: Vec<usize> = (0..self.count_of(by)).collect();
        let differences = self.differences(recording, at, by, &all)?;
        let mut slopes = vec![0.0; all.len()];
        for k in 0..recording.time.len() {
            for (c, signal) in here.iter().enumerate().filter(|(_, signal)| !signal[k].is_nan()) {
                for (index, slope) in slopes.iter_mut().enumerate() {
                    *slope = differences.slope(index, k, c).unwrap_or(0.0);
                }
                take(signal[k], &slopes);
            }
        }
        Ok(())
    }

    /// Number of parameters of one kind.
    fn count_of(&self, by: By) -> usize {
        match by {
            By::Free => self.parameters.len(),
            By::Own => self.own.len(),
        }
    }
}

/// The positions of the parameters with an input, of those of all `moved` in order, by which there are no derivatives.
fn hidden_parameters(moved: &[&Taken<'_>], hidden: &[usize]) -> Vec<usize> {
    let mut first = 0;
    let is_hidden = |t: &&&Taken<'_>| {
        let own = first..first + t.parameter.targets.len();
        first = own.end;
        hidden.iter().any(|k| own.contains(k))
    };
    moved.iter().filter(is_hidden).map(|t| t.index).collect()
}

impl Residuals for Problem<'_> {
    fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
        Problem::normal(self, x).ok()
    }

    fn cost(&mut self, x: &[f64]) -> Option<f64> {
        self.cost_of_fitted(x).ok()
    }
}
