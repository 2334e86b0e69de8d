//! Zeno behaviour: events that accumulate at ever shorter intervals, like the bounces of a ball.
//!
//! The solution ends at the accumulation point. To continue beyond it, the relations get a
//! hysteresis, so that the last bounces no longer leave the threshold: a model with a state of rest
//! enters it (K. H. Johansson et al., *On the regularization of Zeno hybrid automata*, Systems &
//! Control Letters 38, 1999, sec. 4). A model without one passes the threshold, and the run fails.

use crate::ir::trajectory::Event;

use super::iterate::EventEffects;
use crate::simulate::failure::Failure;
use crate::simulate::run::Simulation;

/// Number of groups of the last events whose durations must decrease.
const PARTS: usize = 4;
/// Maximum ratio of the durations of the last and the first group.
const SHRINKAGE: f64 = 0.8;
/// Distance from the threshold, in units of the hysteresis, that counts as having passed it.
const BEYOND: f64 = 1e6;

/// A relation whose events accumulate.
pub struct Accumulation {
    /// The relation.
    relation: u32,
    /// Its value after its last event with effects on variables.
    truth: bool,
    /// The failure to report if the solution passes its threshold.
    failure: Failure,
}

/// True if the intervals between these times, in order, shrink.
pub fn intervals_shrink(times: &[f64]) -> bool {
    let parts = times.chunks_exact((times.len() / PARTS).max(2));
    let lengths: Vec<f64> = parts.map(|part| part[part.len() - 1] - part[0]).collect();
    let falls = lengths.windows(2).all(|pair| pair[1] < pair[0]);
    falls && lengths[lengths.len() - 1] < SHRINKAGE * lengths[0]
}

impl Simulation<'_, '_> {
    /// Continues beyond an accumulation of events of `relations`; `failure` reports that they do
    /// not end. False if their hysteresis has reached the maximum.
    pub(crate) fn widen_at_accumulation(
        &mut self,
        (relation, truth): (u32, bool),
        relations: impl Iterator<Item = u32>,
        failure: Failure,
    ) -> bool {
        if !self.locator.widen_hysteresis(relations) {
            return false;
        }
        let margin = self.locator.hysteresis(relation);
        let text = self.relation_text(relation);
        let what = format!(
            "{text} switches at shorter and shorter intervals; from here on only {margin:e} beyond its border"
        );
        let place = self.place(self.relation_span(relation));
        self.recorder.flush(self.sink);
        self.sink.event(Event { time: failure.time, what, place });
        self.accumulation = Some(Accumulation { relation, truth, failure });
        true
    }

    /// Ends the accumulation at an event with effects that does not involve its relation: the model
    /// has come to rest.
    pub(crate) fn clear_accumulation(&mut self, flipped: &[(u32, bool)], effects: EventEffects) {
        let is_at_rest = |accumulation: &Accumulation| {
            effects.acted && flipped.iter().all(|f| f.0 != accumulation.relation)
        };
        if self.accumulation.as_ref().is_some_and(is_at_rest) {
            self.accumulation = None;
        }
    }

    /// Fails if the solution has passed the threshold at which events accumulated.
    pub(crate) fn check_accumulation(&mut self) -> Result<(), Failure> {
        let Some(accumulation) = &self.accumulation else { return Ok(()) };
        let (machine, layout) = (&self.system.machine, &self.program.layout);
        let indicator = machine.get(layout.indicators + accumulation.relation).abs();
        if indicator <= BEYOND * self.locator.hysteresis(accumulation.relation) {
            return Ok(());
        }
        let truth = machine.get(layout.relations + accumulation.relation) != 0.0;
        match self.accumulation.take() {
            Some(accumulation) if accumulation.truth == truth => Err(accumulation.failure),
            _ => Ok(()),
        }
    }
}
