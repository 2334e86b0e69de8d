//! A model, recordings and free parameters: the residuals that a fit minimises.
//!
//! A residual is the difference between a variable and the signal that measures it, in units of the sensor's
//! noise. Its derivatives are propagated with the run (`simulate::sensitivity`): they are exact, even across
//! events. Where they do not exist, central differences take their place.

use std::sync::Arc;

use crate::base::diag::{Diagnostic, Problems, did_you_mean};
use crate::base::source::{SourceMap, Span};
use crate::codegen::recording;
use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Event};
use crate::numeric::least_squares::{NormalEquations, Residuals};
use crate::runtime::jit::tiering::Execution;
use crate::runtime::machine::Machine;
use crate::simulate::failure::Failure;
use crate::simulate::record::Sink;
use crate::simulate::run::{simulate_to, simulate_with_sensitivities};
use crate::simulate::sensitivity::Input;
use crate::simulate::settings::Settings;

use super::data::{Data, Recording, Split};
use super::parallel;
use super::plan::{Free, Plan};
use super::unit::Unit;

/// Steps after which a run is abandoned, besides those for each row of the recording.
const MAX_STEPS: u64 = 100_000;
/// Further steps for each row of the recording.
const MAX_STEPS_PER_ROW: u64 = 100;

/// Factor around its start within which a positive parameter without bounds is searched.
const DEFAULT_RANGE: f64 = 50.0;
/// Displacement of a parameter for central differences, in coordinates of the search: the third root of the
/// solver's tolerance balances its noise against truncation.
const DISPLACEMENT: f64 = 1e-2;

/// The coordinate of a parameter in the search.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Scale {
    /// Positive parameters: `value = size * x` below `x = 1`, so that the data still have an influence on a
    /// value close to zero, and `value = size * exp(x - 1)` above.
    Positive {
        /// Value at `x = 1`.
        size: f64,
    },
    /// `value = size * x`
    Linear {
        /// Value at `x = 1`.
        size: f64,
    },
}

impl Scale {
    /// The value at `x`.
    pub fn value(self, x: f64) -> f64 {
        match self {
            Scale::Positive { size } if x > 1.0 => size * (x - 1.0).exp(),
            Scale::Positive { size } | Scale::Linear { size } => size * x,
        }
    }

    /// The coordinate of a value.
    pub fn place(self, value: f64) -> f64 {
        match self {
            Scale::Positive { size } if value > size => 1.0 + (value / size).ln(),
            Scale::Positive { size } | Scale::Linear { size } => value / size,
        }
    }

    /// Derivative of the value by its coordinate, at this value.
    pub fn slope(self, value: f64) -> f64 {
        match self {
            Scale::Positive { size } if value > size => value,
            Scale::Positive { size } | Scale::Linear { size } => size,
        }
    }
}

/// A free parameter in the search.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its unit, as the model declares it.
    pub unit: String,
    /// Inputs of the program that take its value.
    pub targets: Vec<Input>,
    /// Its coordinate in the search.
    pub scale: Scale,
    /// Its start.
    pub start: f64,
    /// Its bounds.
    pub bounds: (f64, f64),
    /// The only signal that it acts on, and the position of the recorded variable through which it does.
    pub acts_on: Option<(usize, usize)>,
}

impl Parameter {
    /// Its bounds in coordinates of the search.
    pub fn range(&self) -> (f64, f64) {
        (self.scale.place(self.bounds.0), self.scale.place(self.bounds.1))
    }
}

/// A signal and its variable.
#[derive(Clone, Copy, Debug)]
struct Channel {
    /// Position among the recorded variables.
    column: usize,
    unit: Unit,
    sigma: f64,
}

/// Everything that residuals depend on, except for the values of the parameters. Threads share it.
pub struct Problem<'a> {
    /// The compiled model, which records the variables of the signals.
    pub program: &'a Program,
    sources: &'a SourceMap,
    data: &'a Data,
    /// The free parameters.
    pub parameters: Vec<Parameter>,
    conditions: Vec<VarId>,
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
}

/// Sums over the recordings of one kind.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    /// Sum of squared residuals, in units of the noise, by recording and signal.
    pub squares: Vec<Vec<f64>>,
    /// Number of residuals, by recording and signal.
    pub counts: Vec<Vec<usize>>,
}

impl Sums {
    /// Sum of all squares.
    pub fn total(&self) -> f64 {
        self.squares.iter().flatten().sum()
    }

    /// Number of all residuals.
    pub fn count(&self) -> usize {
        self.counts.iter().flatten().sum()
    }

    /// Reduced sum of squares of each recording.
    pub fn by_recording(&self) -> Vec<f64> {
        let mean = |(s, c): (&Vec<f64>, &Vec<usize>)| {
            s.iter().sum::<f64>() / c.iter().sum::<usize>().max(1) as f64
        };
        self.squares.iter().zip(&self.counts).map(mean).collect()
    }

    /// Root of the mean square of a signal, in units of the noise.
    pub fn of_signal(&self, k: usize) -> f64 {
        self.of_part(k, |_| true)
    }

    /// The same over the recordings that `belongs` selects by position.
    pub fn of_part(&self, k: usize, belongs: impl Fn(usize) -> bool) -> f64 {
        let picked = || (0..self.squares.len()).filter(|i| belongs(*i));
        let sum: f64 = picked().map(|i| self.squares[i][k]).sum();
        let count: usize = picked().map(|i| self.counts[i][k]).sum();
        (sum / count.max(1) as f64).sqrt()
    }
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
        let before = problems.error_count();
        let mut conditions = Vec::new();
        for c in &plan.conditions {
            match input(program, &c.parameter, c.span, problems) {
                Some(Input::Parameter(v)) => conditions.push(v),
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
                    let message = format!("the model has no variable `{wanted}`");
                    let all = program.blocks.dae.variables.enumerate();
                    let all: Vec<&str> = all.map(|(v, _)| program.name(v)).collect();
                    let d = Diagnostic::error("MO1014", signal.span, message);
                    problems.push(match did_you_mean(wanted, all) {
                        Some(near) => d.help(format!("did you mean `{near}`?")),
                        None => d.help("name a variable that moves, as in the model's results"),
                    });
                }
            }
        }
        let mut machine = Machine::new(program);
        let evaluated = machine.run(&program.tapes.parameters).is_ok();
        let parameters: Vec<Parameter> =
            plan.free.iter().filter_map(|f| parameter(program, &machine, f, problems)).collect();
        if problems.error_count() > before || !evaluated {
            return None;
        }
        let mut settings = Settings::of(&program.blocks.dae.experiment);
        // Thousands of runs: machine code pays.
        settings.execution = Execution::translated(program);
        let jobs = parallel::cores();
        Some(Problem {
            program,
            sources,
            data,
            parameters,
            conditions,
            starts,
            driven,
            channels,
            settings,
            trimmed: Vec::new(),
            stopped: false,
            jobs,
        })
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

    /// Settings of a run under the conditions of a recording.
    pub fn settings(&self, recording: &Recording, values: &[f64]) -> Settings {
        let mut settings = self.settings.clone();
        let conditions = self.conditions.iter().copied().zip(recording.conditions.iter().copied());
        settings.parameters = conditions.filter(|(_, value)| !value.is_nan()).collect();
        for (target, value) in self.starts.iter().zip(&recording.starts) {
            match *target {
                Input::Parameter(v) => settings.parameters.push((v, *value)),
                Input::Start(v) => settings.starts.push((v, *value)),
            }
        }
        let courses = recording.courses.iter().cloned();
        settings.courses = self.driven.iter().copied().zip(courses).collect();
        for (p, value) in self.parameters.iter().zip(values) {
            for target in &p.targets {
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
        // A search passes through values at which a run would take hours; no minimum lies there.
        settings.most_steps = MAX_STEPS + MAX_STEPS_PER_ROW * recording.time.len() as u64;
        settings
    }

    /// The variables of the signals at the instants of a recording, signal by signal, in the units of
    /// the columns.
    pub fn predict(&self, recording: &Recording, x: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        let settings = self.settings(recording, &self.values(x));
        let mut rows = Rows::new(recording.time.clone(), self.program.recorded.len(), 0);
        simulate_to(self.program, &settings, self.sources, &mut rows)?;
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
        let settings = self.settings(recording, &self.values(x));
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
        let mut predicted = self.predict(recording, x)?;
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
        let values = self.values(x);
        let of_run = |i: usize| {
            let recording = recordings[i];
            let settings = self.settings(recording, &values);
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
        let recordings = self.recordings(split);
        let all = parallel::map(self.jobs, recordings.len(), |i| self.residuals(recordings[i], x));
        let mut sums = Sums::default();
        for residuals in all {
            let residuals = residuals?;
            let valid = |r: &Vec<f64>| r.iter().filter(|r| !r.is_nan()).count();
            let square = |r: &Vec<f64>| r.iter().filter(|r| !r.is_nan()).map(|r| r * r).sum();
            sums.counts.push(residuals.iter().map(valid).collect());
            sums.squares.push(residuals.iter().map(square).collect());
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
        let recordings = self.fitted();
        let all = parallel::map(self.jobs, recordings.len(), |i| self.residuals(recordings[i], x));
        let mut sum = 0.0;
        for residuals in all {
            sum += residuals?.iter().flatten().filter(|r| !r.is_nan()).map(|r| r * r).sum::<f64>();
        }
        Ok(sum)
    }

    /// The normal equations of the training recordings that are not trimmed.
    pub fn normal(&self, x: &[f64]) -> Result<NormalEquations, Failure> {
        let recordings = self.fitted();
        let each = parallel::map(self.jobs, recordings.len(), |i| self.normal_of(recordings[i], x));
        let mut sum = NormalEquations::new(self.parameters.len());
        for normal in each {
            sum.merge(&normal?);
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
        mut take: impl FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let values = self.values(x);
        let settings = self.settings(recording, &values);
        let inputs: Vec<Input> =
            self.parameters.iter().flat_map(|p| p.targets.iter().copied()).collect();
        let width = self.program.recorded.len();
        let mut rows = Rows::new(recording.time.clone(), width, inputs.len());
        let run =
            simulate_with_sensitivities(self.program, &settings, &inputs, self.sources, &mut rows);
        match run {
            Ok(_) => {}
            Err(failure) if failure.is_without_derivatives() => {
                return self.each_difference(recording, x, take);
            }
            Err(failure) => return Err(failure),
        }
        let factors: Vec<f64> =
            self.parameters.iter().zip(&values).map(|(p, v)| p.scale.slope(*v)).collect();
        let mut slopes = vec![0.0; self.parameters.len()];
        for k in 0..recording.time.len() {
            let row = &rows.values[k * width..(k + 1) * width];
            let all = &rows.slopes[k * width * inputs.len()..(k + 1) * width * inputs.len()];
            for (channel, (c, signal)) in self.channels.iter().zip(&recording.signals).enumerate() {
                if signal[k].is_nan() {
                    continue;
                }
                let residual = (c.unit.of_si(row[c.column]) - signal[k]) / c.sigma;
                let mut first = 0;
                for ((slope, p), factor) in slopes.iter_mut().zip(&self.parameters).zip(&factors) {
                    let column = match p.acts_on {
                        Some((only, _)) if only != channel => None,
                        Some((_, column)) => Some(column),
                        None => Some(c.column),
                    };
                    let sum: f64 = column.map_or(0.0, |column| {
                        let at = column * inputs.len() + first;
                        all[at..at + p.targets.len()].iter().sum()
                    });
                    first += p.targets.len();
                    *slope = sum * factor / (c.unit.factor * c.sigma);
                }
                take(residual, &slopes);
            }
        }
        Ok(())
    }

    /// As `each_slope`, by central differences.
    fn each_difference(
        &self,
        recording: &Recording,
        x: &[f64],
        mut take: impl FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let here = self.residuals(recording, x)?;
        let mut moved = x.to_vec();
        let mut by = Vec::with_capacity(x.len());
        for j in 0..x.len() {
            moved[j] = x[j] + DISPLACEMENT;
            let above = self.residuals(recording, &moved)?;
            moved[j] = x[j] - DISPLACEMENT;
            let below = self.residuals(recording, &moved)?;
            moved[j] = x[j];
            by.push((above, below));
        }
        let mut slopes = vec![0.0; x.len()];
        for k in 0..recording.time.len() {
            for (c, signal) in here.iter().enumerate() {
                if signal[k].is_nan() {
                    continue;
                }
                for (slope, (above, below)) in slopes.iter_mut().zip(&by) {
                    *slope = (above[c][k] - below[c][k]) / (2.0 * DISPLACEMENT);
                }
                take(signal[k], &slopes);
            }
        }
        Ok(())
    }
}

impl Residuals for Problem<'_> {
    fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
        Problem::normal(self, x).ok()
    }

    fn cost(&mut self, x: &[f64]) -> Option<f64> {
        self.cost_of_fitted(x).ok()
    }
}

/// The input of the program that a name in the plan refers to.
fn input(program: &Program, wanted: &str, span: Span, problems: &mut Problems) -> Option<Input> {
    let start = wanted.strip_prefix("start(").and_then(|rest| rest.strip_suffix(')'));
    let name = start.unwrap_or(wanted).trim();
    let layout = &program.layout;
    let variables = &program.blocks.dae.variables;
    let parameters = || layout.parameter_inputs.iter().map(|(v, _)| *v);
    let starts = || layout.starts.iter().map(|(v, ..)| *v);
    let found = match start {
        None => parameters().find(|v| program.name(*v) == name).map(Input::Parameter),
        Some(_) => starts().find(|v| program.name(*v) == name).map(Input::Start),
    };
    if found.is_none() {
        let exists = variables.iter().any(|v| v.name == name);
        let what = if start.is_some() { "start value" } else { "parameter" };
        let message = if exists {
            format!("`{name}` is not a {what} that can be set without recompiling")
        } else {
            format!("the model has no {what} `{name}`")
        };
        let d = Diagnostic::error("MO1015", span, message);
        let names: Vec<&str> = match start {
            None => parameters().map(|v| program.name(v)).collect(),
            Some(_) => starts().map(|v| program.name(v)).collect(),
        };
        problems.push(match did_you_mean(name, names) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help("name a real parameter that is not final and fixes no structure"),
        });
    }
    found
}

fn parameter(
    program: &Program,
    machine: &Machine<'_>,
    free: &Free,
    problems: &mut Problems,
) -> Option<Parameter> {
    let targets: Option<Vec<Input>> =
        free.targets.iter().map(|t| input(program, t, free.span, problems)).collect();
    let targets = targets?;
    let (v, declared) = match targets.first()? {
        Input::Parameter(v) => (*v, machine.value(*v)),
        Input::Start(v) => {
            let starts = &program.layout.starts;
            let (.., cell) = starts.iter().find(|(s, ..)| s == v)?;
            (*v, machine.get(*cell))
        }
    };
    let start = free.start.unwrap_or(declared);
    let positive = start > 0.0 && free.min.is_none_or(|m| m >= 0.0);
    let (scale, wide) = if positive {
        (Scale::Positive { size: start }, (start / DEFAULT_RANGE, start * DEFAULT_RANGE))
    } else {
        let span = free.max.zip(free.min).map_or(1.0, |(a, b)| 0.25 * (a - b));
        let size = if start == 0.0 { span } else { start.abs() };
        (Scale::Linear { size }, (f64::NEG_INFINITY, f64::INFINITY))
    };
    let bounds = (free.min.unwrap_or(wide.0), free.max.unwrap_or(wide.1));
    let unit = program.blocks.dae.variables[v].unit.to_string();
    let acts_on = free.acts_on.as_ref().and_then(|(signal, variable)| {
        let column = program.recorded.iter().position(|v| program.name(*v) == variable)?;
        Some((*signal, column))
    });
    Some(Parameter { name: free.name.clone(), unit, targets, scale, start, bounds, acts_on })
}

/// Collects the rows at the instants of a recording.
struct Rows {
    instants: Arc<[f64]>,
    /// The next instant.
    next: usize,
    /// The last row belongs to an instant.
    taken: bool,
    width: usize,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Rows {
    fn new(instants: Arc<[f64]>, width: usize, inputs: usize) -> Self {
        let n = instants.len();
        let (values, slopes) = (vec![0.0; n * width], vec![0.0; n * width * inputs]);
        Rows { instants, next: 0, taken: false, width, values, slopes }
    }
}

impl Sink for Rows {
    fn begin(&mut self, _columns: Vec<Column>) {}

    fn row(&mut self, time: f64, values: &[f64]) {
        let again = self.next > 0 && self.instants[self.next - 1] == time;
        self.taken = again || self.instants.get(self.next) == Some(&time);
        if !self.taken {
            return;
        }
        self.next += usize::from(!again);
        let at = (self.next - 1) * self.width;
        self.values[at..at + self.width].copy_from_slice(values);
    }

    fn slopes(&mut self, slopes: &[f64]) {
        if self.taken && self.next > 0 {
            let at = (self.next - 1) * slopes.len();
            self.slopes[at..at + slopes.len()].copy_from_slice(slopes);
        }
    }

    fn event(&mut self, _event: Event) {}
}
