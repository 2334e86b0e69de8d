//! Extrema of variables over a run, including between its rows.
//!
//! After each step the variables are probed on the dense output. If a parabola through three
//! adjacent probes exceeds the best value so far, the maximum is refined there. At events both
//! limits count.

use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::numeric::brent::{maximum, vertex};

use super::failure::Failure;
use super::run::Simulation;

/// A request for an extremum.
#[derive(Clone, PartialEq, Debug)]
pub struct ExtremumRequest {
    /// The variable.
    pub variable: VarId,
    /// Maximum rather than minimum.
    pub greatest: bool,
    /// Counts only while this Boolean is true.
    pub after: Option<VarId>,
    /// Counts only while this Boolean is false.
    pub before: Option<VarId>,
}

/// Minimum number of intervals between probes of a step.
const MIN_PROBES: f64 = 5.0;
/// Maximum number of intervals between probes of a step.
const MAX_PROBES: f64 = 1e4;
/// Tolerance of the location of an extremum, relative to the distance of probes. The error of its
/// value is of the order of the square.
const LOCATION_TOLERANCE: f64 = 1e-6;

/// The extrema so far.
#[derive(Default)]
pub struct ExtremaSearch {
    tracked: Vec<Tracked>,
    /// Maximum distance of probes, s.
    spacing: f64,
    /// Everything up to this time has been probed, s.
    reached: f64,
    times: Vec<f64>,
    /// For each probe the values of all requests, with sign so that the maximum counts.
    values: Vec<f64>,
}

struct Tracked {
    slot: Slot,
    sign: f64,
    after: Option<Slot>,
    before: Option<Slot>,
    best: Option<f64>,
    /// Time of the best value, s.
    at: f64,
}

impl ExtremaSearch {
    /// A search for a run that starts at `start`, s, and has no extrema closer than `spacing`, s.
    pub fn new(program: &Program, tracked: &[ExtremumRequest], start: f64, spacing: f64) -> Self {
        let of = |e: &ExtremumRequest| Tracked {
            slot: program.slot(e.variable),
            sign: if e.greatest { 1.0 } else { -1.0 },
            after: e.after.map(|v| program.slot(v)),
            before: e.before.map(|v| program.slot(v)),
            best: None,
            at: start,
        };
        let tracked = tracked.iter().map(of).collect();
        ExtremaSearch { tracked, spacing, reached: start, ..ExtremaSearch::default() }
    }

    /// The extrema in the order of the requests; `None` if the condition was never true.
    pub fn found(&self) -> Vec<Option<f64>> {
        self.tracked.iter().map(|w| w.best.map(|best| w.sign * best)).collect()
    }

    /// The time of each extremum, s.
    pub fn times(&self) -> Vec<f64> {
        self.tracked.iter().map(|w| w.at).collect()
    }
}

impl Simulation<'_, '_> {
    /// Updates the extrema by the values in the memory, which are those at `t`, s.
    pub(super) fn update_extrema(&mut self, t: f64) {
        let machine = &self.system.machine;
        for w in &mut self.extrema.tracked {
            let counts = w.after.is_none_or(|slot| machine.get(slot) != 0.0)
                && w.before.is_none_or(|slot| machine.get(slot) == 0.0);
            let value = w.sign * machine.get(w.slot);
            if counts && value.is_finite() && w.best.is_none_or(|best| value > best) {
                w.best = Some(value);
                w.at = t;
            }
        }
    }

    /// Searches the last step up to `end`, s.
    pub(super) fn search_extrema(&mut self, end: f64) -> Result<(), Failure> {
        if self.extrema.tracked.is_empty() {
            return Ok(());
        }
        let begin = self.extrema.reached.max(self.stepper_begin());
        if end <= begin {
            return Ok(());
        }
        self.extrema.reached = end;
        let probes = ((end - begin) / self.extrema.spacing).ceil().clamp(MIN_PROBES, MAX_PROBES);
        let mut times = std::mem::take(&mut self.extrema.times);
        let mut values = std::mem::take(&mut self.extrema.values);
        times.clear();
        values.clear();
        let width = self.extrema.tracked.len();
        for k in 0..=probes as usize {
            let t =
                if k as f64 == probes { end } else { begin + (end - begin) * (k as f64 / probes) };
            self.evaluate_row_at(t)?;
            times.push(t);
            let machine = &self.system.machine;
            values.extend(self.extrema.tracked.iter().map(|w| w.sign * machine.get(w.slot)));
            self.update_extrema(t);
        }
        // Conditions of requests change at events only.
        for k in 0..width {
            let at = |i: usize| (times[i], values[i * width + k]);
            for i in 2..times.len() {
                let points = [at(i - 2), at(i - 1), at(i)];
                let promising = |best: f64| {
                    vertex(points).is_some_and(|(t, height)| {
                        (points[0].0..=points[2].0).contains(&t) && height > best
                    })
                };
                if self.extrema.tracked[k].best.is_some_and(promising) {
                    self.refine_extremum(k, points[0].0, points[2].0)?;
                }
            }
        }
        self.extrema.times = times;
        self.extrema.values = values;
        Ok(())
    }

    /// Refines the maximum of one request within a part of the last step.
    fn refine_extremum(&mut self, k: usize, begin: f64, end: f64) -> Result<(), Failure> {
        let (slot, sign) = (self.extrema.tracked[k].slot, self.extrema.tracked[k].sign);
        let mut failed = None;
        let value = |t: f64| match self.evaluate_row_at(t) {
            Ok(()) => sign * self.system.machine.get(slot),
            Err(failure) => {
                failed.get_or_insert(failure);
                f64::NAN
            }
        };
        let (t, _) = maximum(value, begin, end, LOCATION_TOLERANCE * (end - begin));
        if let Some(failure) = failed {
            return Err(failure);
        }
        self.evaluate_row_at(t)?;
        self.update_extrema(t);
        Ok(())
    }

    fn stepper_begin(&self) -> f64 {
        self.stepper.t_previous()
    }
}
