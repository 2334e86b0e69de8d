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
pub struct Extreme {
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
const LOOKS: f64 = 5.0;
/// Looks at a step at most.
const MOST_LOOKS: f64 = 1e4;
/// The place of an extreme value, as a part of the distance of two looks. The value is then exact to the square of
/// it.
const SHARPNESS: f64 = 1e-6;

/// The extreme values so far.
#[derive(Default)]
pub struct Extremes {
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

impl Extremes {
    /// Nothing found yet, in a run that begins at `start`, s, and whose course does not change within `spacing`, s.
    pub fn new(program: &Program, wanted: &[Extreme], start: f64, spacing: f64) -> Self {
        let of = |e: &Extreme| Wanted {
            slot: program.slot(e.variable),
            sign: if e.greatest { 1.0 } else { -1.0 },
            after: e.after.map(|v| program.slot(v)),
            before: e.before.map(|v| program.slot(v)),
            best: None,
        };
        let wanted = wanted.iter().map(of).collect();
        Extremes { wanted, spacing, reached: start, ..Extremes::default() }
    }

    /// What was found, in the order asked for; none where the variable never counted.
    pub fn found(&self) -> Vec<Option<f64>> {
        self.wanted.iter().map(|w| w.best.map(|best| w.sign * best)).collect()
    }
}

impl Simulation<'_, '_> {
    /// Counts the values in the memory.
    pub(super) fn heed_extremes(&mut self) {
        let instance = &self.model.instance;
        for w in &mut self.extremes.wanted {
            let counts = w.after.is_none_or(|slot| instance.get(slot) != 0.0)
                && w.before.is_none_or(|slot| instance.get(slot) == 0.0);
            let value = w.sign * instance.get(w.slot);
            if counts && value.is_finite() && w.best.is_none_or(|best| value > best) {
                w.best = Some(value);
            }
        }
    }

    /// Looks at the last step up to `end`, s.
    pub(super) fn seek_extremes(&mut self, end: f64) -> Result<(), Failure> {
        if self.extremes.wanted.is_empty() {
            return Ok(());
        }
        let begin = self.extremes.reached.max(self.stepper_begin());
        if end <= begin {
            return Ok(());
        }
        self.extremes.reached = end;
        let looks = ((end - begin) / self.extremes.spacing).ceil().clamp(LOOKS, MOST_LOOKS);
        let mut times = std::mem::take(&mut self.extremes.times);
        let mut values = std::mem::take(&mut self.extremes.values);
        times.clear();
        values.clear();
        let width = self.extremes.wanted.len();
        for k in 0..=looks as usize {
            let t =
                if k as f64 == looks { end } else { begin + (end - begin) * (k as f64 / looks) };
            self.go_to(t)?;
            times.push(t);
            let instance = &self.model.instance;
            values.extend(self.extremes.wanted.iter().map(|w| w.sign * instance.get(w.slot)));
            self.heed_extremes();
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
                if self.extremes.wanted[k].best.is_some_and(promising) {
                    self.seek_extreme(k, points[0].0, points[2].0)?;
                }
            }
        }
        self.extremes.times = times;
        self.extremes.values = values;
        Ok(())
    }

    /// The greatest value of one variable in a part of the last step.
    fn seek_extreme(&mut self, k: usize, begin: f64, end: f64) -> Result<(), Failure> {
        let (slot, sign) = (self.extremes.wanted[k].slot, self.extremes.wanted[k].sign);
        let mut failed = None;
        let value = |t: f64| match self.go_to(t) {
            Ok(()) => sign * self.model.instance.get(slot),
            Err(failure) => {
                failed.get_or_insert(failure);
                f64::NAN
            }
        };
        let (t, _) = maximum(value, begin, end, SHARPNESS * (end - begin));
        if let Some(failure) = failed {
            return Err(failure);
        }
        self.go_to(t)?;
        self.heed_extremes();
        Ok(())
    }

    fn stepper_begin(&self) -> f64 {
        use crate::integrate::stepper::Stepper;
        self.stepper.t_previous()
    }
}
