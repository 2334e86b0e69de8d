//! Zeno behaviour: events that accumulate at ever shorter intervals, like the bounces of a ball.
//!
//! The solution ends at the accumulation point. To continue beyond it, the relations get a
//! hysteresis, so that the last bounces no longer leave the threshold: a model with a state of rest
//! enters it (K. H. Johansson et al., *On the regularization of Zeno hybrid automata*, Systems &
//! Control Letters 38, 1999, sec. 4). A model without one passes the threshold, and the run fails.

use crate::base::diag::Diagnostic;
use crate::base::index::FastSet;
use crate::ir::dae::Dae;
use crate::ir::expr::{Node, VarId};
use crate::ir::program::RelationTrigger;
use crate::ir::trajectory::Event;

use super::iterate::EventEffects;
use crate::simulate::cause::RunCause;
use crate::simulate::failure::Failure;
use crate::simulate::run::Simulation;

/// Number of groups of the last events whose durations must decrease.
const PARTS: usize = 4;
/// Maximum ratio of the durations of the last and the first group.
const SHRINKAGE: f64 = 0.8;
/// Distance from the threshold, in units of the hysteresis, that counts as having passed it.
const BEYOND: f64 = 1e6;

/// Number of events at ever shorter intervals that count as bounces.
const BOUNCES: u32 = 6;
/// Maximum ratio of the last and the first interval between bounces that are about to end.
const LAST_BOUNCE: f64 = 1e-2;
/// Intervals after the last bounce within which the next one is expected.
const OVERDUE: f64 = 8.0;
/// Distance beyond the threshold, relative to the height of the bounces, that counts as having
/// passed it.
const DEPTH: f64 = 1e-2;
/// Distance after an event over which it is seen which way it turns the solution, as a fraction of the step.
const FIRST_MOVE: f64 = 1e-6;
/// Distance beyond the threshold, relative to that at the last event, that counts as having passed it.
const FAR: f64 = 1e4;

/// Events of one relation with effects on variables, at ever shorter intervals: the last bounces may
/// be lower than the rounding error of the place at which they start, so that the relation does not
/// become false again and the model falls through its threshold.
#[derive(Clone, Debug, Default)]
pub struct Bounces {
    /// Value of the relation after each event.
    truth: bool,
    /// Digest of all relations after each event: rest is another mode.
    mode: u64,
    count: u32,
    /// Time of the last one, s.
    last: f64,
    /// The last and the first interval, s.
    intervals: (f64, f64),
    /// Largest distance from the threshold between them.
    height: f64,
    /// Indicator after the last one, and how it moves there; 0 once the relation has changed back.
    start: f64,
    turn: f64,
    /// The last one gave a state another value. Others, such as a diode that begins to conduct, may let the
    /// solution turn back.
    is_impact: bool,
}

/// Whether a discrete variable follows from a relation, through other discrete variables.
fn reads_relation(dae: &Dae, flag: VarId, relation: u32) -> bool {
    let mut pending = vec![flag];
    let mut met = FastSet::default();
    while let Some(v) = pending.pop() {
        if !met.insert(v) {
            continue;
        }
        for equation in dae.discrete.iter().filter(|d| d.variable == v) {
            let is_read = |_, node| matches!(node, Node::Relation(k) if k == relation);
            if dae.graph.any([equation.value], is_read) {
                return true;
            }
            pending.extend(dae.graph.variables(equation.value));
        }
    }
    false
}

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

    /// Counts an event as a bounce of the relations that changed in it.
    pub(crate) fn count_bounce(&mut self, t: f64, flipped: &[(u32, bool)], effects: EventEffects) {
        for &(k, truth) in flipped {
            let bounces = &mut self.bounces[k as usize];
            if truth != bounces.truth {
                bounces.turn = 0.0;
            }
        }
        if !effects.acted {
            return;
        }
        let first = self.program.layout.relations as usize;
        let count = self.program.events.relation_triggers.len();
        let relations = &self.system.machine.memory[first..first + count];
        // FNV-1a.
        let mode = relations.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, value| {
            (hash ^ u64::from(*value != 0.0)).wrapping_mul(0x0100_0000_01b3)
        });
        for &(k, truth) in flipped {
            if self.program.events.relation_triggers[k as usize] != RelationTrigger::State {
                continue;
            }
            let bounces = &mut self.bounces[k as usize];
            // Between two bounces the relation changes back.
            if bounces.count > 0 && truth != bounces.truth {
                continue;
            }
            let interval = t - bounces.last;
            let goes_on = bounces.count > 0
                && mode == bounces.mode
                && (bounces.count == 1
                    || interval < bounces.intervals.0
                    // The last ones are of the size of rounding errors.
                    || interval < LAST_BOUNCE * bounces.intervals.1);
            if goes_on {
                bounces.count += 1;
                let longest = if bounces.count == 2 { interval } else { bounces.intervals.1 };
                bounces.intervals = (interval, longest);
                (bounces.last, bounces.turn) = (t, 0.0);
            } else {
                *bounces = Bounces { truth, mode, last: t, count: 1, ..Bounces::default() };
            }
            bounces.is_impact = effects.reinitialized;
        }
    }

    /// In the first step after a bounce: which way the solution leaves the threshold.
    pub(crate) fn note_turns(&mut self) -> Result<(), Failure> {
        let (t0, t1) = (self.stepper.t_previous(), self.stepper.t());
        let begins = |b: &Bounces| b.is_impact && b.last == t0;
        if !self.bounces.iter().any(begins) {
            return Ok(());
        }
        let first = self.program.layout.indicators as usize;
        let range = first..first + self.bounces.len();
        self.evaluate_at(t0)?;
        let starts = self.system.machine.memory[range.clone()].to_vec();
        self.evaluate_at(t0 + FIRST_MOVE * (t1 - t0))?;
        let moved = &self.system.machine.memory[range];
        for ((bounces, start), moved) in self.bounces.iter_mut().zip(starts).zip(moved) {
            if begins(bounces) {
                (bounces.start, bounces.turn) = (start, moved - start);
            }
        }
        self.evaluate_at(t1)
    }

    /// Fails if the solution has passed a threshold at which it bounced: one that an event turned away from
    /// it, but from which it did not get away before it came back, or one of many bounces.
    fn check_bounces(&mut self) -> Result<(), Failure> {
        let (machine, layout) = (&self.system.machine, &self.program.layout);
        let t = machine.get(layout.time);
        let mut passed = None;
        for (bounces, k) in self.bounces.iter_mut().zip(0..).filter(|(b, _)| b.count > 0) {
            let indicator = machine.get(layout.indicators + k);
            let distance = indicator.abs();
            if (machine.get(layout.relations + k) != 0.0) != bounces.truth {
                bounces.height = bounces.height.max(distance);
                bounces.turn = 0.0;
                continue;
            }
            let came_back = indicator * bounces.turn < 0.0 && distance > FAR * bounces.start.abs();
            let (interval, longest) = bounces.intervals;
            let ends = bounces.count >= BOUNCES && interval < LAST_BOUNCE * longest;
            let is_overdue = t - bounces.last > OVERDUE * interval;
            if (came_back || ends && is_overdue) && distance > DEPTH * bounces.height {
                passed = Some((k, bounces.count, bounces.last));
            }
        }
        let Some((k, events, time)) = passed else { return Ok(()) };
        if !self.is_still_due(k) {
            self.bounces[k as usize] = Bounces::default();
            return Ok(());
        }
        let relation = self.relation_text(k);
        let cause = RunCause::PassedThrough { time, relation, events };
        let diagnostic = Diagnostic::new(cause, self.relation_span(k))
            .label("after its last change nothing holds the solution");
        Err(Failure::numerics(time, diagnostic))
    }

    /// False if a relation may keep its value, because the condition that turned the solution back needs more than
    /// that and does not hold: a limiter with `when x > max and der(x) < 0` leaves its limit for good when `x` is below.
    fn is_still_due(&self, relation: u32) -> bool {
        let dae = &self.program.blocks.dae;
        let reinits = dae.reinits.iter();
        let flags: Vec<VarId> = reinits.flat_map(|r| dae.graph.variables(r.active)).collect();
        let mut is_turned = false;
        for flag in flags {
            if reads_relation(dae, flag, relation) {
                is_turned = true;
                if self.system.machine.value(flag) != 0.0 {
                    return true;
                }
            }
        }
        !is_turned
    }

    /// Fails if the solution has passed the threshold at which events accumulated.
    pub(crate) fn check_accumulation(&mut self) -> Result<(), Failure> {
        self.check_bounces()?;
        let Some(accumulation) = &self.accumulation else { return Ok(()) };
        let (machine, layout) = (&self.system.machine, &self.program.layout);
        let indicator = machine.get(layout.indicators + accumulation.relation).abs();
        if indicator <= BEYOND * self.locator.hysteresis(accumulation.relation) {
            return Ok(());
        }
        let truth = machine.get(layout.relations + accumulation.relation) != 0.0;
        if !self.is_still_due(accumulation.relation) {
            self.accumulation = None;
            return Ok(());
        }
        match self.accumulation.take() {
            Some(accumulation) if accumulation.truth == truth => Err(accumulation.failure),
            _ => Ok(()),
        }
    }
}
