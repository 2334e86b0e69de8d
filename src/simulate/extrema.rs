//! The greatest and the least value that a variable takes during a run, between its rows too.
//!
//! After each step the variables are looked at on the polynomial of the step. Where a parabola through three
//! neighbouring looks promises more than the best value so far, its maximum is sought there. At an event both
//! sides count.

use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::numeric::brent::{maximum, vertex};

use super::failure::Failure;
use super::run::Simulation;

/// An extreme value that is wanted.
#[derive(Clone, PartialEq, Debug)]
pub struct ExtremumRequest {
    /// Of this variable.
    pub variable: VarId,
    /// The greatest value rather than the least.
    pub greatest: bool,
    /// Counts only while this Boolean is true.
    pub after: Option<VarId>,
    /// Counts only while this Boolean is false.
    pub before: Option<VarId>,
}

/// Looks at a step at least, one of them at its begin.
const MIN_PROBES: f64 = 5.0;
/// Looks at a step at most.
const MAX_PROBES: f64 = 1e4;
/// The place of an extreme value, as a part of the distance of two looks. The value is then exact to the square of
/// it.
const LOCATION_TOLERANCE: f64 = 1e-6;

/// The extreme values so far.
#[derive(Default)]
pub struct ExtremaSearch {
    wanted: Vec<Wanted>,
    /// Greatest distance of two looks, s.
    spacing: f64,
    /// Everything up to here has been looked at, s.
    reached: f64,
    times: Vec<f64>,
    /// For each look the values of all that is wanted, signed so that the greatest counts.
    values: Vec<f64>,
}

struct Wanted {
    slot: Slot,
    sign: f64,
    after: Option<Slot>,
    before: Option<Slot>,
    best: Option<f64>,
}

impl ExtremaSearch {
    /// Nothing found yet, in a run that begins at `start`, s, and whose course does not change within `spacing`, s.
    pub fn new(program: &Program, wanted: &[ExtremumRequest], start: f64, spacing: f64) -> Self {
        let of = |e: &ExtremumRequest| Wanted {
            slot: program.slot(e.variable),
            sign: if e.greatest { 1.0 } else { -1.0 },
            after: e.after.map(|v| program.slot(v)),
            before: e.before.map(|v| program.slot(v)),
            best: None,
        };
        let wanted = wanted.iter().map(of).collect();
        ExtremaSearch { wanted, spacing, reached: start, ..ExtremaSearch::default() }
    }

    /// What was found, in the order asked for; none where the variable never counted.
    pub fn found(&self) -> Vec<Option<f64>> {
        self.wanted.iter().map(|w| w.best.map(|best| w.sign * best)).collect()
    }
}

impl Simulation<'_, '_> {
    /// Counts the values in the memory.
    pub(super) fn update_extrema(&mut self) {
        let machine = &self.system.machine;
        for w in &mut self.extrema.wanted {
            let counts = w.after.is_none_or(|slot| machine.get(slot) != 0.0)
                && w.before.is_none_or(|slot| machine.get(slot) == 0.0);
            let value = w.sign * machine.get(w.slot);
            if counts && value.is_finite() && w.best.is_none_or(|best| value > best) {
                w.best = Some(value);
            }
        }
    }

    /// Looks at the last step up to `end`, s.
    pub(super) fn search_extrema(&mut self, end: f64) -> Result<(), Failure> {
        if self.extrema.wanted.is_empty() {
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
        let width = self.extrema.wanted.len();
        for k in 0..=probes as usize {
            let t =
                if k as f64 == probes { end } else { begin + (end - begin) * (k as f64 / probes) };
            self.evaluate_at(t)?;
            times.push(t);
            let machine = &self.system.machine;
            values.extend(self.extrema.wanted.iter().map(|w| w.sign * machine.get(w.slot)));
            self.update_extrema();
        }
        // Whether a value counts changes at events only.
        for k in 0..width {
            let at = |i: usize| (times[i], values[i * width + k]);
            for i in 2..times.len() {
                let points = [at(i - 2), at(i - 1), at(i)];
                let promising = |best: f64| {
                    vertex(points).is_some_and(|(t, height)| {
                        (points[0].0..=points[2].0).contains(&t) && height > best
                    })
                };
                if self.extrema.wanted[k].best.is_some_and(promising) {
                    self.refine_extremum(k, points[0].0, points[2].0)?;
                }
            }
        }
        self.extrema.times = times;
        self.extrema.values = values;
        Ok(())
    }

    /// The greatest value of one variable in a part of the last step.
    fn refine_extremum(&mut self, k: usize, begin: f64, end: f64) -> Result<(), Failure> {
        let (slot, sign) = (self.extrema.wanted[k].slot, self.extrema.wanted[k].sign);
        let mut failed = None;
        let value = |t: f64| match self.evaluate_at(t) {
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
        self.evaluate_at(t)?;
        self.update_extrema();
        Ok(())
    }

    fn stepper_begin(&self) -> f64 {
        use crate::integrate::stepper::Stepper;
        self.stepper.t_previous()
    }
}
