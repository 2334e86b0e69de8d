//! Relations that switch again and again: where both sides lead back the solution stays between them,
//! and switching without end is reported.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::integrate::stepper::Stepper;
use crate::ir::expr::Binary;
use crate::ir::program::Watch;
use crate::ir::trajectory::Event;

use super::iterate::Settled;
use super::sliding::Sliding;
use super::zeno::shortens;
use crate::simulate::failure::{Failure, of_fault};
use crate::simulate::run::Simulation;

/// So many events in so short a time are chattering, not physics.
const CHATTER_EVENTS: usize = 64;
/// The short time, as a part of the whole run.
const CHATTER_SPAN: f64 = 1e-7;

/// The part of the short time that is no time at all.
const AT_ONCE: f64 = 1e-13;
/// So many events of one relation alone in the short time, and its two sides are asked whether they
/// meet.
const MEETING_EVENTS: u32 = 4;
/// Halvings of a step to find the end of a motion along a surface.
const HALVINGS: u32 = 50;

/// The times of the last events, to notice chattering.
pub struct Recent {
    times: [f64; CHATTER_EVENTS],
    at: usize,
    span: f64,
    /// The relations that switched at them.
    flipped: Vec<u32>,
    /// The last relation that switched alone, how often in a row, and since when.
    alone: Option<(u32, u32, f64)>,
    /// The last relation at whose switching something other than relations changed, and its value then.
    acting: Option<(u32, bool)>,
}

impl Recent {
    /// No event yet, in a run of this length.
    pub fn new(length: f64) -> Self {
        let times = [f64::NEG_INFINITY; CHATTER_EVENTS];
        Recent {
            times,
            at: 0,
            span: CHATTER_SPAN * length,
            flipped: Vec::new(),
            alone: None,
            acting: None,
        }
    }

    /// True if the last events pile up.
    fn piles_up(&self) -> bool {
        let (later, earlier) = self.times.split_at(self.at);
        shortens(&[earlier, later].concat())
    }
}

impl Simulation<'_, '_> {
    /// Stays on the surface of a relation that switched alone several times in no time, if its two
    /// sides meet there; true if so.
    pub(crate) fn slides(
        &mut self,
        t: f64,
        flipped: &[(u32, bool)],
        settled: Settled,
    ) -> Result<bool, Failure> {
        let &[(k, truth)] = flipped else {
            self.recent.alone = None;
            return Ok(false);
        };
        // Loops that the integrator solves would have two solutions at once there.
        let implicit = !self.program.algebraics.is_empty();
        if implicit || settled.acted || self.program.watches[k as usize] != Watch::State {
            self.recent.alone = None;
            return Ok(false);
        }
        let (times, since) = match self.recent.alone {
            Some((last, times, since)) if last == k && t - since <= self.recent.span => {
                (times + 1, since)
            }
            _ => (1, t),
        };
        self.recent.alone = Some((k, times, since));
        if times < MEETING_EVENTS {
            return Ok(false);
        }
        let op = self.program.blocks.dae.relations[k as usize].op;
        let rising = matches!(op, Binary::Greater | Binary::GreaterEqual);
        let instance = &mut self.model.instance;
        let mut sliding = Sliding::along(k, instance, self.stop - self.start);
        let n = self.program.order();
        let rates = sliding.rates(instance, t, &self.y[..n]);
        if !rates.is_ok_and(|rates| rates.meet(rising)) {
            let back = sliding.switch(instance, usize::from(truth));
            back.map_err(|f| of_fault(&self.model.instance, f, t))?;
            return Ok(false);
        }
        self.model.sliding = Some(sliding);
        self.enter_surface(t, truth)?;
        self.search.ignore(Some(k));
        self.recent.alone = None;
        let evaluated = self.model.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.model.instance, f, t))?;
        self.tell_of_sliding(t, k, "stays where it switches");
        Ok(true)
    }

    /// Leaves a surface that the last step should not have followed to its end; where it left.
    pub(crate) fn end_of_sliding(&mut self) -> Result<Option<f64>, Failure> {
        let Some(mut sliding) = self.model.sliding.take() else { return Ok(None) };
        let (mut inside, mut outside) = (self.stepper.t_previous(), self.stepper.t());
        let n = self.program.order();
        let mut part_at = |s: &mut Self, t: f64| {
            s.stepper.interpolate(t, &mut s.y);
            let rates = sliding.rates(&mut s.model.instance, t, &s.y[..n]);
            rates.map(|r| r.part()).map_err(|f| of_fault(&s.model.instance, f, t))
        };
        let is_inside = |part: f64| (0.0..=1.0).contains(&part);
        let mut part = part_at(self, outside)?;
        if is_inside(part) {
            self.model.sliding = Some(sliding);
            return Ok(None);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            let there = part_at(self, middle)?;
            if is_inside(there) {
                inside = middle;
            } else {
                (outside, part) = (middle, there);
            }
        }
        let (t, k) = (outside, sliding.relation());
        self.model.sliding = Some(sliding);
        self.vary()?;
        self.record_grid(t, true)?;
        self.stepper.interpolate(t, &mut self.y);
        if let Some(sliding) = self.model.sliding.take() {
            self.leave_surface(&sliding, t, part > 0.5)?;
        }
        self.t = t;
        self.tell_of_sliding(t, k, "switches again");
        self.restart()?;
        Ok(Some(t))
    }

    fn tell_of_sliding(&mut self, t: f64, k: u32, what: &str) {
        let what = format!("{} {what}", self.relation_text(k));
        let place = self.place(self.relation_span(k));
        self.recorder.flush(self.sink);
        self.sink.event(Event { time: t, what, place });
    }

    pub(crate) fn guard_against_chattering(
        &mut self,
        t: f64,
        flipped: &[(u32, bool)],
        settled: Settled,
    ) -> Result<(), Failure> {
        let recent = &mut self.recent;
        if settled.acted {
            recent.acting = flipped.first().copied();
        }
        let oldest = recent.times[recent.at];
        recent.times[recent.at] = t;
        recent.at = (recent.at + 1) % CHATTER_EVENTS;
        recent.flipped.extend(flipped.iter().map(|f| f.0));
        if t - oldest > recent.span {
            // Twice as many as may matter, so that the list is cut seldom.
            let kept = 2 * CHATTER_EVENTS;
            let excess = recent.flipped.len().saturating_sub(kept);
            recent.flipped.drain(..if excess > kept { excess } else { 0 });
            return Ok(());
        }
        let mut relations = std::mem::take(&mut recent.flipped);
        relations.sort_unstable();
        relations.dedup();
        relations.retain(|k| self.program.watches[*k as usize] == Watch::State);
        // What switches in no time at all switches by rounding of operands that rest at the border.
        let at_once = t - oldest <= AT_ONCE * self.recent.span;
        let piled = self.recent.acting.filter(|_| !at_once && self.recent.piles_up());
        let failure = self.chatters(t, t - oldest, piled.or(flipped.first().copied()));
        let goes_on = match piled {
            Some(piled) => self.passes_pile(piled, relations.into_iter(), failure.clone()),
            None => at_once && self.search.widen(relations.into_iter()),
        };
        if goes_on {
            self.recent.times = [f64::NEG_INFINITY; CHATTER_EVENTS];
            return Ok(());
        }
        Err(failure)
    }

    /// Says that a relation switches without end.
    fn chatters(&mut self, t: f64, duration: f64, relation: Option<(u32, bool)>) -> Failure {
        let k = relation.map(|f| f.0);
        let what =
            k.map_or_else(|| "a relation".to_owned(), |k| format!("`{}`", self.relation_text(k)));
        let span = k.map_or(Span::NONE, |k| self.relation_span(k));
        let message = format!(
            "at time {t} s {what} switches without end: {CHATTER_EVENTS} events within {duration:e} s"
        );
        let diagnostic = Diagnostic::error("MO0911", span, message)
            .label("this relation chatters")
            .help("give the two branches a hysteresis or a smooth transition, or model the state between them (locked, resting) explicitly");
        let diagnostic = if self.program.algebraics.is_empty() {
            diagnostic
        } else {
            diagnostic.note("in the reduced mode a solution can stay where both branches lead back")
        };
        Failure::numerics(t, diagnostic)
    }
}
