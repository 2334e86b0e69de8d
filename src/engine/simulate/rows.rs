//! The rows of a run: those of the output grid, within the last step, and those at events.
//!
//! If little of the model is recorded, a row between steps evaluates just that
//! ([`Program::rows`](crate::ir::program::Program::rows)); whatever needs more evaluates everything.

use crate::ir::program::Sequence;

use super::failure::non_finite::Explainer;
use super::failure::{Failure, of_fault};
use super::run::Simulation;
use super::settings::Settings;
use super::system::HybridSystem;

/// True if rows between steps can be evaluated by a tape of their own, and everything that the
/// settings ask for is in it.
pub(super) fn has_own_rows(system: &HybridSystem<'_>, settings: &Settings) -> bool {
    let program = system.machine.program;
    let is_recorded = |v: &_| program.recorded.contains(v);
    let mut extrema = settings.extrema.iter();
    program.rows.is_some()
        && !system.machine.has_history()
        && extrema.all(|e| {
            [e.after, e.before].iter().flatten().all(is_recorded) && is_recorded(&e.variable)
        })
}

impl Simulation<'_, '_> {
    /// Evaluates what rows and extrema need at an instant of the last step, with relations held;
    /// everything if an assertion is violated.
    pub(super) fn evaluate_row_at(&mut self, t: f64) -> Result<(), Failure> {
        if !self.has_own_rows || self.system.sliding.is_some() || self.system.left_domain {
            return self.evaluate_at(t);
        }
        self.interpolate(t);
        if self.system.evaluate_row(t, &self.y).is_ok() && !self.violates_assertions() {
            return Ok(());
        }
        self.evaluate_at(t)
    }

    /// Evaluates everything at the present instant, if the last row did not.
    pub(super) fn complete_memory(&mut self) -> Result<(), Failure> {
        match self.has_own_rows && self.t == self.stepper.t() {
            true => self.evaluate_at(self.t),
            false => Ok(()),
        }
    }

    fn violates_assertions(&self) -> bool {
        let machine = &self.system.machine;
        let mut asserts = self.program.events.asserts.iter();
        asserts.any(|a| !a.at_events && machine.get(a.condition) == 0.0)
    }

    /// Records the rows of the output grid up to `end`, and updates the extrema.
    pub(super) fn record_grid(&mut self, end: f64, inclusive: bool) -> Result<(), Failure> {
        self.search_extrema(end)?;
        while let Some(at) = self.recorder.due(end, inclusive) {
            self.evaluate_row_at(at)?;
            // A long step may end where the assertions hold again.
            self.check_assertions(at)?;
            self.take_row(at)?;
            self.put_row(at);
            self.recorder.advance();
        }
        Ok(())
    }

    /// Records a row at `t` with the states in `self.y`.
    pub(super) fn record(&mut self, t: f64) -> Result<(), Failure> {
        let evaluated = self.system.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.system.machine, f, t))?;
        self.take_row(t)?;
        self.update_extrema(t);
        self.put_row(t);
        Ok(())
    }

    /// Copies the values in the memory to the next row.
    pub(super) fn take_row(&mut self, t: f64) -> Result<(), Failure> {
        let mut taken = self.recorder.take(&self.system.machine);
        if taken.is_err() && self.has_own_rows {
            // For the message.
            self.evaluate_at(t)?;
            taken = self.recorder.take(&self.system.machine);
        }
        if taken.is_err() && self.system.left_domain {
            let evaluated = self.system.evaluate_all_clamped(t, &self.y);
            evaluated.map_err(|f| of_fault(&self.system.machine, f, t))?;
            taken = self.recorder.take(&self.system.machine);
        }
        if taken.is_ok() {
            let (memory, warnings) = (&self.system.machine.memory, &mut self.statistics.warnings);
            self.bound_warnings.check(self.program, memory, t, warnings);
            self.evaluate_row_sensitivities(t)?;
        }
        taken.map_err(|v| {
            let explainer = Explainer::new(self.program, &self.system.machine.memory);
            Failure::numerics(t, explainer.not_finite(v, Sequence::Continuous, t))
        })
    }

    pub(super) fn put_row(&mut self, t: f64) {
        self.statistics.rows += 1;
        self.recorder.put(t, self.sink);
        if let Some(s) = &self.sensitivity {
            self.recorder.flush(self.sink);
            self.sink.slopes(s.slopes());
        }
    }
}
