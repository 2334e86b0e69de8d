//! Executes an event: iterates at its instant, records and reports it, and restarts the
//! integration.

use crate::ir::program::{RelationTrigger, Slot};
use crate::ir::trajectory::Event;

use super::duplicate_event::is_unchanged;
use super::iterate::{EventEffects, EventError, iterate};
use crate::simulate::failure::{Failure, event_failure, of_fault};
use crate::simulate::run::Simulation;
use crate::simulate::system::is_domain_fault;

/// First shift of an instant whose event iteration does not confirm the event, in spacings of
/// doubles.
const FIRST_SHIFT: f64 = 8.0;
/// Number of shifts before all combinations of the relations are tried.
const SHIFTS_BEFORE_SEARCH: u32 = 4;
/// Maximum number of times that readers of transport lines may change segments at one instant.
const MAX_SEGMENT_CHANGES: u32 = 100;

/// Cause of an event.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// A state-dependent relation changes.
    State,
    /// An instant known in advance.
    Time,
}

/// Result of the iteration at an event.
struct EventPoint {
    /// The instant, s.
    t: f64,
    /// A clock has ticked.
    ticked: bool,
    /// Relations that triggered the event.
    triggers: Vec<u32>,
    effects: EventEffects,
    /// The memory at the left limit.
    before: Vec<f64>,
}

impl Simulation<'_, '_> {
    /// Executes the event at an instant within the last step.
    pub(crate) fn event(&mut self, t: f64, cause: Cause) -> Result<(), Failure> {
        self.advance_sensitivities()?;
        self.record_history(t, false)?;
        self.record_grid(t, false)?;
        // Any event ends sliding: both sides are reevaluated.
        if let Some(mut sliding) = self.system.sliding.take() {
            self.arrive_from_surface(&mut sliding, t);
        }
        self.locator.ignore(None);
        let before_event = self.relation_values();
        let EventPoint { t, ticked, triggers, effects, before } = self.iterate_at(t, cause)?;
        self.t = t;
        let n = self.program.order();
        self.y[..n].copy_from_slice(self.system.machine.states());
        let flipped = self.flipped(&before_event, &triggers);
        let is_duplicate = !ticked && self.is_duplicate(t, &flipped, effects, &before)?;
        self.system.machine.recycle(before);
        if effects.changed && !is_duplicate {
            self.put_row(t);
            self.depart(t)?;
            self.record(t)?;
            while self.recorder.due(t, true).is_some() {
                self.recorder.advance();
            }
        } else {
            self.record_grid(t, true)?;
            self.evaluate_at(t)?;
            self.depart(t)?;
        }
        self.record_history(t, true)?;
        if !is_duplicate {
            self.duplicates.record(t, &flipped);
            self.report_event(t, cause, ticked, &flipped, effects);
        }
        self.count_bounce(t, &flipped, effects);
        if !ticked && !self.try_sliding(t, &flipped, effects)? {
            self.clear_accumulation(&flipped, effects);
            self.check_chattering(t, &flipped, effects)?;
        }
        self.check_integers(t)?;
        self.check_assertions(t)?;
        self.handle_effects(effects, t)?;
        self.watch_event(t)?;
        if !self.ended && t < self.stop {
            if !self.selection.is_empty() {
                let evaluated = self.system.evaluate_all(t, &self.y);
                evaluated.map_err(|f| of_fault(&self.system.machine, f, t))?;
                self.reselect_states(t)?;
            }
            self.restart()?;
        }
        Ok(())
    }

    /// Iterates at an instant, shifting it slightly until the iteration converges.
    fn iterate_at(&mut self, mut t: f64, cause: Cause) -> Result<EventPoint, Failure> {
        let mut shift =
            FIRST_SHIFT * f64::EPSILON * t.abs().max(self.stepper.t() - self.stepper.t_previous());
        let (mut ticked, mut shifts) = (false, 0);
        let mut triggers: Vec<u32> = Vec::new();
        loop {
            self.evaluate_at(t)?;
            self.take_row(t)?;
            self.evaluate_sensitivities(t)?;
            triggers.extend(self.locator.switched(&self.system.machine));
            self.arrive(t, cause);
            ticked |= self.clocks.raise(&mut self.system.machine, t);
            let machine = &mut self.system.machine;
            if machine.delays.advance_past(t, &machine.memory) {
                machine.delays.write_slots(t, &mut machine.memory);
            }
            if machine.input_signals.advance_past(t, &machine.memory) {
                machine.input_signals.write_slots(t, &mut machine.memory);
            }
            let passed = machine.transports.advance_past(&mut machine.memory);
            let before = self.system.machine.snapshot();
            self.system.machine.assertion_messages.clear();
            let may_shift = cause == Cause::State && t < self.stepper.t() && !passed;
            let effects =
                self.iterate_with_transport(!may_shift || shifts >= SHIFTS_BEFORE_SEARCH, passed);
            if let Some(s) = &mut self.sensitivity {
                s.detach(&mut self.system.machine);
            }
            match effects {
                // At the intersection of relations, rounding in one may flip the other: retry
                // slightly later.
                Err(EventError::NotConverged(..)) if may_shift => {
                    self.system.machine.restore_from(&before);
                    if let Some(s) = &mut self.sensitivity {
                        s.restore();
                    }
                }
                // The event sequence may round an operand to the other side: retry slightly later.
                Ok(effects) if !effects.changed && may_shift => {}
                Ok(effects) => return Ok(EventPoint { t, ticked, triggers, effects, before }),
                Err(u) => return Err(event_failure(&self.system.machine, u, t)),
            }
            self.system.machine.recycle(before);
            t = (t + shift).min(self.stepper.t());
            (shift, shifts) = (4.0 * shift, shifts + 1);
        }
    }

    /// The event at the end of the run, for `when terminal()`.
    pub(crate) fn terminal_event(&mut self) -> Result<(), Failure> {
        let t = self.t;
        let terminal = self.program.layout.terminal;
        self.system.machine.set(terminal, 1.0);
        let outcome = iterate(&mut self.system.machine, &self.clocks, true);
        let effects = outcome.map_err(|u| event_failure(&self.system.machine, u, t))?;
        if effects.changed {
            let n = self.program.order();
            self.y[..n].copy_from_slice(self.system.machine.states());
            self.record(t)?;
        }
        self.handle_effects(effects, t)
    }

    /// Repeats the event iteration while readers of transport lines change segments.
    fn iterate_with_transport(
        &mut self,
        exhaustive: bool,
        passed: bool,
    ) -> Result<EventEffects, EventError> {
        let mut effects = self.iterate_clamped(exhaustive)?;
        effects.changed |= passed;
        for _ in 0..MAX_SEGMENT_CHANGES {
            let machine = &mut self.system.machine;
            if !machine.transports.advance_past(&mut machine.memory) {
                break;
            }
            let again = self.iterate_clamped(true)?;
            effects = EventEffects { changed: true, ..effects }.before(again);
        }
        Ok(effects)
    }

    /// The event iteration, with clamped arguments if it fails otherwise: intermediate steps
    /// combine new relations with old branches.
    fn iterate_clamped(&mut self, exhaustive: bool) -> Result<EventEffects, EventError> {
        let mut outcome = iterate(&mut self.system.machine, &self.clocks, exhaustive);
        if let Err(EventError::Fault(fault)) = outcome
            && is_domain_fault(fault)
        {
            self.system.machine.clamp_domain = true;
            outcome = iterate(&mut self.system.machine, &self.clocks, exhaustive);
            self.system.machine.clamp_domain = false;
        }
        outcome
    }

    fn relation_values(&self) -> Vec<f64> {
        let first = self.program.layout.relations;
        (0..self.program.events.relation_triggers.len() as Slot)
            .map(|k| self.system.machine.get(first + k))
            .collect()
    }

    /// Relations that triggered the event or changed in it, with their new value.
    fn flipped(&self, before_event: &[f64], triggers: &[u32]) -> Vec<(u32, bool)> {
        let now = self.relation_values();
        let pairs = before_event.iter().zip(&now).enumerate();
        let changed = pairs.filter(|(k, (a, b))| a != b || triggers.contains(&(*k as u32)));
        changed.map(|(k, (before, _))| (k as u32, *before == 0.0)).collect()
    }

    /// True if this event only flips back relations of the previous event and changes nothing else.
    fn is_duplicate(
        &mut self,
        t: f64,
        flipped: &[(u32, bool)],
        effects: EventEffects,
        before: &[f64],
    ) -> Result<bool, Failure> {
        let ends_run = effects.failed.is_some() || effects.terminate.is_some();
        if !effects.changed || ends_run || !self.duplicates.matches(t, flipped) {
            return Ok(false);
        }
        let evaluated = self.system.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.system.machine, f, t))?;
        Ok(is_unchanged(self.program, before, &self.system.machine.memory))
    }

    /// Counts the event and reports it to the sink.
    fn report_event(
        &mut self,
        t: f64,
        cause: Cause,
        ticked: bool,
        flipped: &[(u32, bool)],
        effects: EventEffects,
    ) {
        // A change that the event iteration does not confirm is a rounding error, not an event.
        if !effects.changed {
            return;
        }
        self.recorder.flush(self.sink);
        match cause {
            Cause::State => self.statistics.state_events += 1,
            Cause::Time => self.statistics.time_events += 1,
        }
        for &(k, truth) in flipped {
            if self.program.events.relation_triggers[k as usize] == RelationTrigger::Discrete {
                continue;
            }
            let what = format!("{} became {truth}", self.relation_text(k));
            let place = self.place(self.relation_span(k));
            self.sink.event(Event { time: t, what, place });
        }
        if ticked {
            let event = Event { time: t, what: "sample".to_owned(), place: String::new() };
            self.sink.event(event);
        } else if flipped.is_empty() {
            let event = Event { time: t, what: "time event".to_owned(), place: String::new() };
            self.sink.event(event);
        }
    }
}
