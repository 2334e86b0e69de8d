//! Events that pile up at shorter and shorter intervals, as the bounces of a ball do (Zeno).
//!
//! The solution ends where they pile up. What the model says beyond is found by giving its relations a
//! margin, so that the last bounces do not leave the border any more: a model that knows a state of rest
//! enters it then (K. H. Johansson et al., *On the regularization of Zeno hybrid automata*, Systems &
//! Control Letters 38, 1999, sec. 4). One that does not falls through the border, and the run ends.

use crate::ir::trajectory::Event;

use super::iterate::EventEffects;
use crate::simulate::failure::Failure;
use crate::simulate::run::Simulation;

/// Parts of the last events of which each must be shorter than the one before.
const PARTS: usize = 4;
/// The last part must be so much shorter than the first.
const SHRINKAGE: f64 = 0.8;
/// So many margins beyond the border nothing rests there.
const BEYOND: f64 = 1e6;

/// A relation whose events have piled up.
pub struct Accumulation {
    /// The relation.
    relation: u32,
    /// Its value after its last event at which something other than relations changed.
    truth: bool,
    /// What to say if the solution goes on beyond its border.
    failure: Failure,
}

/// True if events at these times, in order, come at shorter and shorter intervals.
pub fn intervals_shrink(times: &[f64]) -> bool {
    let parts = times.chunks_exact((times.len() / PARTS).max(2));
    let lengths: Vec<f64> = parts.map(|part| part[part.len() - 1] - part[0]).collect();
    let falls = lengths.windows(2).all(|pair| pair[1] < pair[0]);
    falls && lengths[lengths.len() - 1] < SHRINKAGE * lengths[0]
}

impl Simulation<'_, '_> {
    /// Goes on beyond a pile of events, which are those of `relations`; `failure` says that they have no
    /// end. False if their margins are large already.
    pub(crate) fn widen_at_accumulation(
        &mut self,
        (relation, truth): (u32, bool),
        relations: impl Iterator<Item = u32>,
        failure: Failure,
    ) -> bool {
        if !self.locator.widen_hysteresis(relations) {
            return false;
        }
        let hysteresis = self.locator.hysteresis(relation);
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

    /// Forgets the last pile at an event that changes something without its relation: the model has come to
    /// rest there.
    pub(crate) fn clear_accumulation(&mut self, flipped: &[(u32, bool)], effects: EventEffects) {
        let is_at_rest = |accumulation: &Accumulation| {
            effects.acted && flipped.iter().all(|f| f.0 != accumulation.relation)
        };
        if self.accumulation.as_ref().is_some_and(is_at_rest) {
            self.accumulation = None;
        }
    }

    /// Fails if the solution went on beyond the border at which events have piled up.
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
