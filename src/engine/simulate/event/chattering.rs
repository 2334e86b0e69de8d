//! Chattering: relations that switch back and forth in rapid succession. If the solution returns
//! from both sides, it slides along the threshold; otherwise chattering is an error.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::expr::Binary;
use crate::ir::program::RelationTrigger;
use crate::ir::trajectory::Event;

use super::iterate::EventEffects;
use super::sliding::Sliding;
use super::zeno::intervals_shrink;
use crate::simulate::cause::RunCause;
use crate::simulate::failure::{Failure, of_fault};
use crate::simulate::run::Simulation;

/// Number of events within [`CHATTER_SPAN`] that count as chattering.
const CHATTER_EVENTS: usize = 64;
/// Time span of chattering, as a fraction of the run.
const CHATTER_SPAN: f64 = 1e-7;

/// Fraction of the time span below which events count as simultaneous.
const INSTANTANEOUS: f64 = 1e-13;
/// Number of events of a single relation within the time span after which sliding is tested.
const SLIDING_EVENTS: u32 = 4;
/// Bisections of a step to locate the end of sliding.
const HALVINGS: u32 = 50;

/// Recent events, for detecting chattering.
pub struct EventHistory {
    times: [f64; CHATTER_EVENTS],
    at: usize,
    span: f64,
    /// The relations that changed in them.
    flipped: Vec<u32>,
    /// The last relation that changed as the only one, how often in succession, and since when.
    single: Option<(u32, u32, f64)>,
    /// The last relation whose change had effects on variables, and its new value.
    acting: Option<(u32, bool)>,
    /// When that was, s.
    acted_at: f64,
    /// The failure that a hysteresis avoided so far.
    pub(crate) avoided: Option<Failure>,
}

impl EventHistory {
    /// An empty history, for a run of this length.
    pub fn new(length: f64) -> Self {
        let times = [f64::NEG_INFINITY; CHATTER_EVENTS];
        EventHistory {
            times,
            at: 0,
            span: CHATTER_SPAN * length,
            flipped: Vec::new(),
            single: None,
            acting: None,
            acted_at: f64::NEG_INFINITY,
            avoided: None,
        }
    }

    /// True if the last events accumulate.
    fn accumulates(&self) -> bool {
        let (later, earlier) = self.times.split_at(self.at);
        intervals_shrink(&[earlier, later].concat())
    }
}

impl Simulation<'_, '_> {
    /// Starts sliding along the surface of a relation that repeatedly changed as the only one, if
    /// the derivatives on both sides point towards it; true if so.
    pub(crate) fn try_sliding(
        &mut self,
        t: f64,
        flipped: &[(u32, bool)],
        effects: EventEffects,
    ) -> Result<bool, Failure> {
        let &[(k, truth)] = flipped else {
            self.history.single = None;
            return Ok(false);
        };
        // Loops solved by the integrator would need two solutions at once.
        let has_algebraics = !self.program.algebraics.is_empty();
        if has_algebraics
            || effects.acted
            || self.program.events.relation_triggers[k as usize] != RelationTrigger::State
        {
            self.history.single = None;
            return Ok(false);
        }
        let (times, since) = match self.history.single {
            Some((last, times, since)) if last == k && t - since <= self.history.span => {
                (times + 1, since)
            }
            _ => (1, t),
        };
        self.history.single = Some((k, times, since));
        if times < SLIDING_EVENTS {
            return Ok(false);
        }
        let op = self.program.blocks.dae.relations[k as usize].op;
        let rising = matches!(op, Binary::Greater | Binary::GreaterEqual);
        let machine = &mut self.system.machine;
        let mut sliding = Sliding::along(k, machine, self.stop - self.start);
        let n = self.program.order();
        let rates = sliding.rates(machine, t, &self.y[..n]);
        if !rates.is_ok_and(|rates| rates.point_inward(rising)) {
            let back = sliding.switch(machine, usize::from(truth));
            back.map_err(|f| of_fault(&self.system.machine, f, t))?;
            return Ok(false);
        }
        self.system.sliding = Some(sliding);
        self.enter_surface(t, truth)?;
        self.locator.ignore(Some(k));
        self.history.single = None;
        let evaluated = self.system.evaluate_all(t, &self.y);
        evaluated.map_err(|f| of_fault(&self.system.machine, f, t))?;
        self.report_sliding(t, k, "stays where it switches");
        Ok(true)
    }

    /// Ends sliding if the last step should have left the surface; the instant at which it leaves.
    pub(crate) fn end_of_sliding(&mut self) -> Result<Option<f64>, Failure> {
        let Some(mut sliding) = self.system.sliding.take() else { return Ok(None) };
        let (mut sliding_at, mut left_at) = (self.stepper.t_previous(), self.stepper.t());
        let n = self.program.order();
        let mut weight_at = |s: &mut Self, t: f64| {
            s.stepper.interpolate(t, &mut s.y);
            let rates = sliding.rates(&mut s.system.machine, t, &s.y[..n]);
            rates.map(|r| r.weight()).map_err(|f| of_fault(&s.system.machine, f, t))
        };
        let is_sliding = |weight: f64| (0.0..=1.0).contains(&weight);
        let mut weight = weight_at(self, left_at)?;
        if is_sliding(weight) {
            self.system.sliding = Some(sliding);
            return Ok(None);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (sliding_at + left_at);
            let there = weight_at(self, middle)?;
            if is_sliding(there) {
                sliding_at = middle;
            } else {
                (left_at, weight) = (middle, there);
            }
        }
        let (t, k) = (left_at, sliding.relation());
        self.system.sliding = Some(sliding);
        self.advance_sensitivities()?;
        self.record_grid(t, true)?;
        self.stepper.interpolate(t, &mut self.y);
        if let Some(sliding) = self.system.sliding.take() {
            self.leave_surface(&sliding, t, weight > 0.5)?;
        }
        self.t = t;
        self.report_sliding(t, k, "switches again");
        self.restart()?;
        Ok(Some(t))
    }

    fn report_sliding(&mut self, t: f64, k: u32, what: &str) {
        let what = format!("{} {what}", self.relation_text(k));
        let place = self.place(self.relation_span(k));
        self.recorder.flush(self.sink);
        self.sink.event(Event { time: t, what, place });
    }

    pub(crate) fn check_chattering(
        &mut self,
        t: f64,
        flipped: &[(u32, bool)],
        effects: EventEffects,
    ) -> Result<(), Failure> {
        let history = &mut self.history;
        if effects.acted {
            history.acting = flipped.first().copied();
            history.acted_at = t;
        }
        let oldest = history.times[history.at];
        history.times[history.at] = t;
        history.at = (history.at + 1) % CHATTER_EVENTS;
        history.flipped.extend(flipped.iter().map(|f| f.0));
        if t - oldest > history.span {
            // Twice as many as may matter, so that the list is rarely trimmed.
            let kept = 2 * CHATTER_EVENTS;
            let excess = history.flipped.len().saturating_sub(kept);
            history.flipped.drain(..if excess > kept { excess } else { 0 });
            return Ok(());
        }
        let mut relations = std::mem::take(&mut history.flipped);
        relations.sort_unstable();
        relations.dedup();
        relations.retain(|k| {
            self.program.events.relation_triggers[*k as usize] == RelationTrigger::State
        });
        // Simultaneous changes are rounding errors of operands at the threshold.
        let instantaneous = t - oldest <= INSTANTANEOUS * self.history.span;
        let accumulated =
            self.history.acting.filter(|_| !instantaneous && self.history.accumulates());
        // Without effects on variables, the solution moves between the borders of a hysteresis as
        // it slides along the threshold.
        let is_harmless = self.history.acted_at < oldest;
        let failure =
            self.chattering_failure(t, t - oldest, accumulated.or(flipped.first().copied()));
        let continues = match accumulated {
            Some(accumulated) => {
                self.widen_at_accumulation(accumulated, relations.into_iter(), failure.clone())
            }
            None => {
                (instantaneous || is_harmless)
                    && self.locator.widen_hysteresis(relations.into_iter())
            }
        };
        if continues {
            self.history.times = [f64::NEG_INFINITY; CHATTER_EVENTS];
            if !instantaneous && accumulated.is_none() {
                self.history.avoided = Some(failure);
            }
            return Ok(());
        }
        Err(failure)
    }

    /// The failure of a chattering relation.
    fn chattering_failure(
        &mut self,
        t: f64,
        duration: f64,
        relation: Option<(u32, bool)>,
    ) -> Failure {
        let k = relation.map(|f| f.0);
        let relation =
            k.map_or_else(|| "a relation".to_owned(), |k| format!("`{}`", self.relation_text(k)));
        let span = k.map_or(Span::NONE, |k| self.relation_span(k));
        let cause = RunCause::Chattering { time: t, relation, events: CHATTER_EVENTS, duration };
        let diagnostic = Diagnostic::new(cause, span).label("this relation chatters");
        let diagnostic = if self.program.algebraics.is_empty() {
            diagnostic
        } else {
            diagnostic.note("in the reduced mode a solution can stay where both branches lead back")
        };
        Failure::numerics(t, diagnostic)
    }
}
