//! What a run may choose, with its only defaults.

use std::sync::Arc;

use crate::integrate::options::DEFAULT_MAX_STEPS;
use crate::ir::expr::VarId;
use crate::ir::flat::Experiment;
use crate::numeric::time_series::TimeSeries;
use crate::runtime::jit::tiering::Execution;

use super::extrema::ExtremumRequest;

/// Default end of a run, s.
pub const DEFAULT_STOP: f64 = 1.0;
/// Default number of intervals between rows.
pub const DEFAULT_INTERVALS: f64 = 500.0;
/// Default relative tolerance.
pub const DEFAULT_TOLERANCE: f64 = 1e-6;

/// An integration method, or the choice of one.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Method {
    /// By what the model is made of, see `simulate::method`.
    #[default]
    Auto,
    /// Radau IIA of order 5: stiff systems, many events.
    Radau,
    /// Backward differentiation of order 1 to 5: large stiff systems that are smooth for long.
    Bdf,
    /// Dormand and Prince's explicit method of order 5: systems that are not stiff.
    Dopri,
}

/// Choices for one run.
#[derive(Clone, PartialEq, Debug)]
pub struct Settings {
    /// Begin, s.
    pub start: f64,
    /// End, s; not before `start`.
    pub stop: f64,
    /// Time between two rows, s; positive.
    pub interval: f64,
    /// Tolerated relative error of a step, without unit, between 1e-14 and 1.
    pub tolerance: f64,
    /// The integration method.
    pub method: Method,
    /// Values for parameters.
    pub parameters: Vec<(VarId, f64)>,
    /// Values for starts.
    pub starts: Vec<(VarId, f64)>,
    /// What recordings say about inputs of the program; those without a course rest at 0.
    pub courses: Vec<(VarId, Arc<TimeSeries>)>,
    /// How tapes are run; the results are the same.
    pub execution: Execution,
    /// Instants of the rows, s, instead of equal intervals: ascending, none after `stop`. Events have
    /// their rows besides.
    pub instants: Option<Arc<[f64]>>,
    /// Extreme values that are wanted, found in [`Statistics`](super::run::Statistics).
    pub extrema: Vec<ExtremumRequest>,
    /// Variables do not turn twice within this time, s; without it, within `interval`.
    pub spacing: Option<f64>,
    /// Steps of the integrator, rejected ones too, after which the run is given up.
    pub most_steps: u64,
}

impl Settings {
    /// What the model asks for, with defaults where it does not.
    pub fn of(experiment: &Experiment) -> Self {
        let start = experiment.start.unwrap_or(0.0);
        let stop = experiment.stop.unwrap_or(start + DEFAULT_STOP);
        Settings {
            start,
            stop,
            interval: experiment.interval.unwrap_or((stop - start) / DEFAULT_INTERVALS),
            tolerance: experiment.tolerance.unwrap_or(DEFAULT_TOLERANCE),
            method: Method::default(),
            parameters: Vec::new(),
            starts: Vec::new(),
            courses: Vec::new(),
            execution: Execution::default(),
            instants: None,
            extrema: Vec::new(),
            spacing: None,
            most_steps: DEFAULT_MAX_STEPS,
        }
    }

    /// What is out of range, if anything.
    pub fn fault(&self) -> Option<String> {
        let Settings { start, stop, interval, tolerance, .. } = self;
        if !(start.is_finite() && stop.is_finite() && stop >= start) {
            return Some(format!("the run can not go from {start} s to {stop} s"));
        }
        if (interval.is_nan() || *interval <= 0.0) && stop > start {
            return Some(format!("the interval between rows is {interval} s, not positive"));
        }
        if !(1e-14..1.0).contains(tolerance) {
            return Some(format!("the tolerance {tolerance} is not between 1e-14 and 1"));
        }
        None
    }
}
