//! Events that pile up at shorter and shorter intervals, as the bounces of a ball do (Zeno).
//!
//! The solution ends where they pile up. What the model says beyond is found by giving its relations a
//! margin, so that the last bounces do not leave the border any more: a model that knows a state of rest
//! enters it then (K. H. Johansson et al., *On the regularization of Zeno hybrid automata*, Systems &
//! Control Letters 38, 1999, sec. 4). One that does not falls through the border, and the run ends.

use crate::ir::trajectory::Event;

use super::iterate::Settled;
use crate::simulate::failure::Failure;
use crate::simulate::run::Simulation;

/// Parts of the last events of which each must be shorter than the one before.
const PARTS: usize = 4;
/// The last part must be so much shorter than the first.
const SHORTER: f64 = 0.8;
/// So many margins beyond the border nothing rests there.
const FAR: f64 = 1e6;

/// A relation whose events have piled up.
pub struct Pile {
    /// The relation.
    relation: u32,
    /// Its value after its last event at which something other than relations changed.
    truth: bool,
    /// What to say if the solution goes on beyond its border.
    failure: Failure,
}

/// True if events at these times, in order, come at shorter and shorter intervals.
pub fn shortens(times: &[f64]) -> bool {
    let parts = times.chunks_exact((times.len() / PARTS).max(2));
    let lengths: Vec<f64> = parts.map(|part| part[part.len() - 1] - part[0]).collect();
    let falls = lengths.windows(2).all(|pair| pair[1] < pair[0]);
    falls && lengths[lengths.len() - 1] < SHORTER * lengths[0]
}

impl Simulation<'_, '_> {
    /// Goes on beyond a pile of events, which are those of `relations`; `failure` says that they have no
    /// end. False if their margins are large already.
    pub(crate) fn passes_pile(
        &mut self,
        (relation, truth): (u32, bool),
        relations: impl Iterator<Item = u32>,
        failure: Failure,
    ) -> bool {
        if !self.search.widen(relations) {
            return false;
        }
        let margin = self.search.margin(relation);
        let text = self.relation_text(relation);
        let what = format!(
            "{text} switches at shorter and shorter intervals; from here on only {margin:e} beyond its border"
        );
        let place = self.place(self.relation_span(relation));
        self.recorder.flush(self.sink);
        self.sink.event(Event { time: failure.time, what, place });
        self.pile = Some(Pile { relation, truth, failure });
        true
    }

    /// Forgets the last pile at an event that changes something without its relation: the model has come to
    /// rest there.
    pub(crate) fn leave_pile(&mut self, flipped: &[(u32, bool)], settled: Settled) {
        let rests = |pile: &Pile| settled.acted && flipped.iter().all(|f| f.0 != pile.relation);
        if self.pile.as_ref().is_some_and(rests) {
            self.pile = None;
        }
    }

    /// Fails if the solution went on beyond the border at which events have piled up.
    pub(crate) fn check_pile(&mut self) -> Result<(), Failure> {
        let Some(pile) = &self.pile else { return Ok(()) };
        let (instance, layout) = (&self.model.instance, &self.program.layout);
        let gap = instance.get(layout.gaps + pile.relation).abs();
        if gap <= FAR * self.search.margin(pile.relation) {
            return Ok(());
        }
        let truth = instance.get(layout.relations + pile.relation) != 0.0;
        match self.pile.take() {
            Some(pile) if pile.truth == truth => Err(pile.failure),
            _ => Ok(()),
        }
    }
}
