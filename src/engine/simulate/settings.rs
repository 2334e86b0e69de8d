//! Settings of a run and their defaults.

use std::sync::Arc;

use crate::integrate::options::{DEFAULT_MAX_STEPS, DEFAULT_RTOL, check_rtol};
use crate::ir::expr::VarId;
use crate::ir::flat::Experiment;
use crate::numeric::time_series::TimeSeries;
use crate::runtime::jit::tiering::Execution;

use super::extrema::ExtremumRequest;
use super::sensitivity::Input;

/// Default stop time, s.
pub const DEFAULT_STOP: f64 = 1.0;
/// Rows of a run at most.
const MAX_ROWS: f64 = 1e9;
/// Default number of intervals between rows.
pub const DEFAULT_INTERVALS: f64 = 500.0;

/// An integration method, or the choice of one.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Method {
    /// Chosen from the structure of the model, see `simulate::method`.
    #[default]
    Auto,
    /// Radau IIA of order 5: stiff systems, many events.
    Radau,
    /// Backward differentiation of order 1 to 5: large stiff systems that are smooth for long.
    Bdf,
    /// Dormand and Prince's explicit method of order 5: systems that are not stiff.
    Dopri,
}

impl Method {
    /// All variants with their names on the command line.
    pub const ALL: [(&'static str, Method); 4] = [
        ("auto", Method::Auto),
        ("radau", Method::Radau),
        ("bdf", Method::Bdf),
        ("dopri", Method::Dopri),
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        Method::ALL[self as usize].0
    }

    /// The method of a name.
    pub fn named(name: &str) -> Option<Method> {
        Method::ALL.iter().find(|(own, _)| *own == name).map(|(_, method)| *method)
    }
}

/// Settings of one run.
#[derive(Clone, PartialEq, Debug)]
pub struct Settings {
    /// Start time, s.
    pub start: f64,
    /// Stop time, s; not before `start`.
    pub stop: f64,
    /// Output interval, s; positive.
    pub interval: f64,
    /// Relative tolerance, see [`Options::rtol`](crate::integrate::options::Options::rtol).
    pub tolerance: f64,
    /// The integration method.
    pub method: Method,
    /// Overridden parameters.
    pub parameters: Vec<(VarId, f64)>,
    /// Overridden start values.
    pub starts: Vec<(VarId, f64)>,
    /// Recorded signals that drive inputs of the program; the other inputs are 0.
    pub courses: Vec<(VarId, Arc<TimeSeries>)>,
    /// How tapes are executed; the results are the same.
    pub execution: Execution,
    /// Instants of the rows, s, instead of an equidistant grid: ascending, none after `stop`.
    /// Events have additional rows.
    pub instants: Option<Arc<[f64]>>,
    /// Requested extrema; the results are in [`Statistics`](super::run::Statistics).
    pub extrema: Vec<ExtremumRequest>,
    /// Minimum distance of extrema, s; `interval` if not given.
    pub spacing: Option<f64>,
    /// Maximum number of steps of the integrator, including rejected ones.
    pub most_steps: u64,
    /// Maximum number of events of the clocks of the run.
    pub most_ticks: f64,
    /// Maximum step, s, positive; a 50th of the run if not given.
    pub max_step: Option<f64>,
}

impl Settings {
    /// The settings of the model's `experiment` annotation, with defaults.
    pub fn of(experiment: &Experiment) -> Self {
        Settings { execution: Execution::default(), ..Settings::interpreted(experiment) }
    }

    /// As [`Settings::of`], for tapes that are interpreted. It has no argument for the execution: where the optimizer
    /// propagates one, a program that only interprets contains the compiler to machine code.
    pub fn interpreted(experiment: &Experiment) -> Self {
        let start = experiment.start.unwrap_or(0.0);
        let stop = experiment.stop.unwrap_or(start + DEFAULT_STOP);
        Settings {
            start,
            stop,
            interval: experiment.interval.unwrap_or((stop - start) / DEFAULT_INTERVALS),
            tolerance: experiment.tolerance.unwrap_or(DEFAULT_RTOL),
            method: Method::default(),
            parameters: Vec::new(),
            starts: Vec::new(),
            courses: Vec::new(),
            execution: Execution::Interpreted,
            instants: None,
            extrema: Vec::new(),
            spacing: None,
            most_steps: DEFAULT_MAX_STEPS,
            most_ticks: f64::INFINITY,
            max_step: None,
        }
    }

    /// Overrides a parameter or a start value.
    pub fn set(&mut self, input: Input, value: f64) {
        match input {
            Input::Parameter(v) => self.parameters.push((v, value)),
            Input::Start(v) => self.starts.push((v, value)),
        }
    }

    /// The same run with rows at the start, at events and at the end only. The distance of extrema remains.
    pub fn without_grid(mut self) -> Self {
        self.spacing = Some(self.spacing.unwrap_or(self.interval));
        if self.stop > self.start {
            self.interval = self.stop - self.start;
        }
        self
    }

    /// A message if a setting is out of range.
    pub fn fault(&self) -> Option<String> {
        let Settings { start, stop, interval, tolerance, .. } = self;
        if !(start.is_finite() && stop.is_finite() && stop >= start) {
            return Some(format!("the simulation cannot go from {start} s to {stop} s"));
        }
        if (interval.is_nan() || *interval <= 0.0) && stop > start {
            return Some(format!("the interval between rows is {interval} s, not positive"));
        }
        let rows = (self.stop - self.start) / interval;
        if rows > MAX_ROWS {
            return Some(format!(
                "the interval between rows is {interval} s: the run would have {rows:.0e} rows, more than {MAX_ROWS:.0e}"
            ));
        }
        if let Some(max_step) = self.max_step
            && (max_step.is_nan() || max_step <= 0.0)
        {
            return Some(format!("the maximum step is {max_step} s, not positive"));
        }
        check_rtol(*tolerance).err().map(|e| e.to_string())
    }
}
