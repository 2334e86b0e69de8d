//! What happens at one instant: the event iteration, what is recorded and told of it, and how the run goes
//! on.

use crate::integrate::stepper::Stepper;
use crate::ir::program::{Slot, Watch};
use crate::ir::trajectory::Event;

use super::duplicate_event::nothing_moved;
use super::iterate::{Settled, Unsettled, settle};
use crate::simulate::failure::{Failure, of_fault, unsettled};
use crate::simulate::run::Simulation;
use crate::simulate::system::of_domain;

/// First shift of an event that its evaluation does not confirm, in spacings of doubles.
const NUDGE: f64 = 8.0;
/// How often an event is looked at a little later before all combinations of its relations are tried.
const PATIENCE: u32 = 4;
/// How often readers of what is carried may come to other pieces at one instant.
const MOST_ARRIVALS: u32 = 100;

/// What leads to an event.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// A relation on the trajectory switches.
    State,
    /// An instant known in advance.
    Time,
}

/// Where an event iteration came to rest.
struct Arrived {
    /// The instant, s.
    t: f64,
    /// A clock has ticked.
    ticked: bool,
    /// Relations that led there.
    triggers: Vec<u32>,
    settled: Settled,
    /// The memory at its left limit.
    before: Vec<f64>,
}

impl Simulation<'_, '_> {
    /// Everything that happens at one instant of the last step.
    pub(crate) fn event(&mut self, t: f64, cause: Cause) -> Result<(), Failure> {
        self.vary()?;
        self.note_delayed(t, false)?;
        self.record_grid(t, false)?;
        // Whatever happens, both sides are looked at anew.
        if let Some(mut sliding) = self.model.sliding.take() {
            self.arrive_from_surface(&mut sliding, t);
        }
        self.search.ignore(None);
        let held = self.held_relations();
        let Arrived { t, ticked, triggers, settled, before } = self.come_to_rest(t, cause)?;
        self.t = t;
        let n = self.program.order();
        self.y[..n].copy_from_slice(self.model.instance.states());
        let flipped = self.flipped(&held, &triggers);
        let echoes = !ticked && self.echoes(t, &flipped, settled, &before)?;
        self.model.instance.release(before);
        if settled.changed && !echoes {
            self.put_row(t);
            self.depart(t)?;
            self.record(t)?;
            while self.recorder.due(t, true).is_some() {
                self.recorder.advance();
            }
        } else {
            self.record_grid(t, true)?;
            self.go_to(t)?;
            self.depart(t)?;
        }
        self.note_delayed(t, true)?;
        if !echoes {
            self.echo.remember(t, &flipped);
            self.announce(t, cause, ticked, &flipped, settled);
        }
        if !ticked && !self.slides(t, &flipped, settled)? {
            self.leave_pile(&flipped, settled);
            self.guard_against_chattering(t, &flipped, settled)?;
        }
        self.check_assertions(t)?;
        self.act_on(settled, t)?;
        if !self.ended && t < self.stop {
            if !self.selection.is_empty() {
                let evaluated = self.model.evaluate_all(t, &self.y);
                evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
                self.renew(t)?;
            }
            self.restart()?;
        }
        Ok(())
    }

    /// Goes to an instant, or as little beyond it as it takes, and iterates there until nothing changes.
    fn come_to_rest(&mut self, mut t: f64, cause: Cause) -> Result<Arrived, Failure> {
        let mut nudge =
            NUDGE * f64::EPSILON * t.abs().max(self.stepper.t() - self.stepper.t_previous());
        let (mut ticked, mut nudges) = (false, 0);
        let mut triggers: Vec<u32> = Vec::new();
        loop {
            self.go_to(t)?;
            self.take_row(t)?;
            self.look(t)?;
            triggers.extend(self.search.switched(&self.model.instance));
            let derivatives = self.arrive(t, cause);
            ticked |= self.clocks.raise(&mut self.model.instance, t);
            let instance = &mut self.model.instance;
            if instance.delayed.pass(t, &instance.memory) {
                instance.delayed.place(t, &mut instance.memory);
            }
            let passed = instance.transports.pass(&mut instance.memory);
            let before = self.model.instance.keep();
            self.model.instance.said.clear();
            let may_wait = cause == Cause::State && t < self.stepper.t() && !passed;
            let settled = self.settle_readers(!may_wait || nudges >= PATIENCE, passed);
            if let Some(s) = &mut self.sensitivity {
                s.detach(&mut self.model.instance);
            }
            match settled {
                // Where relations meet, rounding may turn one by the other: a little later it will not.
                Err(Unsettled::Restless(..)) if may_wait => {
                    self.model.instance.memory.copy_from_slice(&before);
                    if let Some(s) = &mut self.sensitivity {
                        s.restore(derivatives.as_ref());
                    }
                }
                // The event sequence may round an operand to the other side: a little later it will not.
                Ok(settled) if !settled.changed && may_wait => {}
                Ok(settled) => return Ok(Arrived { t, ticked, triggers, settled, before }),
                Err(u) => return Err(unsettled(&self.model.instance, u, t)),
            }
            self.model.instance.release(before);
            t = (t + nudge).min(self.stepper.t());
            (nudge, nudges) = (4.0 * nudge, nudges + 1);
        }
    }

    /// The event at the end of the run, for what happens `when terminal()`.
    pub(crate) fn finish(&mut self) -> Result<(), Failure> {
        let t = self.t;
        let terminal = self.program.layout.terminal;
        self.model.instance.set(terminal, 1.0);
        let outcome = settle(&mut self.model.instance, &self.clocks, true);
        let settled = outcome.map_err(|u| unsettled(&self.model.instance, u, t))?;
        if settled.changed {
            let n = self.program.order();
            self.y[..n].copy_from_slice(self.model.instance.states());
            self.record(t)?;
        }
        self.act_on(settled, t)
    }

    /// The event iteration, again while it brings readers of what is carried to other pieces of that.
    fn settle_readers(&mut self, thoroughly: bool, passed: bool) -> Result<Settled, Unsettled> {
        let mut settled = self.settle(thoroughly)?;
        settled.changed |= passed;
        for _ in 0..MOST_ARRIVALS {
            let instance = &mut self.model.instance;
            if !instance.transports.pass(&mut instance.memory) {
                break;
            }
            let again = self.settle(true)?;
            settled = Settled { changed: true, ..settled }.before(again);
        }
        Ok(settled)
    }

    /// The event iteration, beyond the domain of functions where it can not be helped: new
    /// relations and old branches meet in it.
    fn settle(&mut self, thoroughly: bool) -> Result<Settled, Unsettled> {
        let mut outcome = settle(&mut self.model.instance, &self.clocks, thoroughly);
        if let Err(Unsettled::Fault(fault)) = outcome
            && of_domain(fault)
        {
            self.model.instance.inside = true;
            outcome = settle(&mut self.model.instance, &self.clocks, thoroughly);
            self.model.instance.inside = false;
        }
        outcome
    }

    fn held_relations(&self) -> Vec<f64> {
        let first = self.program.layout.relations;
        (0..self.program.watches.len() as Slot)
            .map(|k| self.model.instance.get(first + k))
            .collect()
    }

    /// Relations that led to the event, and those that differ from what was held; with the value
    /// that they took.
    fn flipped(&self, held: &[f64], triggers: &[u32]) -> Vec<(u32, bool)> {
        let now = self.held_relations();
        let pairs = held.iter().zip(&now).enumerate();
        let changed = pairs.filter(|(k, (a, b))| a != b || triggers.contains(&(*k as u32)));
        changed.map(|(k, (before, _))| (k as u32, *before == 0.0)).collect()
    }

    /// Whether this event only turns back what the one before turned, and nothing moves by it.
    fn echoes(
        &mut self,
        t: f64,
        flipped: &[(u32, bool)],
        settled: Settled,
        before: &[f64],
    ) -> Result<bool, Failure> {
        let speaks = settled.failed.is_some() || settled.terminate.is_some();
        if !settled.changed || speaks || !self.echo.may_be(t, flipped) {
            return Ok(false);
        }
        let evaluated = self.model.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
        Ok(nothing_moved(self.program, before, &self.model.instance.memory))
    }

    /// Counts the event and tells the sink.
    fn announce(
        &mut self,
        t: f64,
        cause: Cause,
        ticked: bool,
        flipped: &[(u32, bool)],
        settled: Settled,
    ) {
        // A switching that the event iteration does not confirm is rounding, not an event.
        if !settled.changed {
            return;
        }
        self.recorder.flush(self.sink);
        match cause {
            Cause::State => self.statistics.state_events += 1,
            Cause::Time => self.statistics.time_events += 1,
        }
        for &(k, truth) in flipped {
            if self.program.watches[k as usize] == Watch::Discrete {
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
