//! Finding where relations switch, and the iteration of the discrete part (appendix B of the
//! Modelica specification).

use crate::integrate::stepper::Stepper;
use crate::ir::expr::VarId;
use crate::ir::flat::Level;
use crate::ir::program::{Program, Slot, Tape, Watch};
use crate::numeric::root::locate;
use crate::runtime::machine::{Fault, Instance};

use super::relation_search::{is_restless, sweep};
use super::time_events::Clocks;
use crate::simulate::failure::assertion::text_of;
use crate::simulate::system::Model;

/// Event iterations at one instant before the model is given up.
pub const ITERATION_LIMIT: u32 = 100;
/// Points inside of a step, as fractions, at which relations are looked at besides its end.
const LOOKS: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// Failed evaluations within one step before the search gives up.
const TRIALS: u32 = 100;
/// Length of the interval in which a switching is enclosed, in spacings of doubles at its time.
const ENCLOSURE: f64 = 4.0;

/// The relations that are searched.
pub struct Search {
    relations: Vec<u32>,
    point: Vec<f64>,
    /// Not searched for the time being.
    ignored: Option<u32>,
    /// How far each relation must be beyond its border to count as switched.
    margins: Vec<f64>,
}

/// The first margin of a relation that chatters, in units of its operands.
const FIRST_MARGIN: f64 = 1e-13;
/// How much it grows while the relation goes on to chatter, and the largest.
const MARGIN_GROWTH: f64 = 100.0;
/// See [`MARGIN_GROWTH`].
const LARGEST_MARGIN: f64 = 1e-7;

/// How an event iteration ended.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Settled {
    /// A discrete variable, a relation or a state changed.
    pub changed: bool,
    /// Position of an active `terminate`.
    pub terminate: Option<usize>,
    /// Position of a failed assertion in a when-clause.
    pub failed: Option<usize>,
    /// Something other than relations changed.
    pub acted: bool,
}

impl Settled {
    /// This, and what came after it at the same instant.
    pub fn before(self, later: Settled) -> Settled {
        Settled {
            changed: self.changed | later.changed,
            terminate: self.terminate.or(later.terminate),
            failed: self.failed.or(later.failed),
            acted: self.acted | later.acted,
        }
    }
}

/// Why an event iteration could not be finished.
#[derive(Clone, PartialEq, Debug)]
pub enum Unsettled {
    /// A tape failed.
    Fault(Fault),
    /// Variables and relations that keep changing.
    Restless(Vec<VarId>, Vec<u32>),
}

impl From<Fault> for Unsettled {
    fn from(fault: Fault) -> Self {
        Unsettled::Fault(fault)
    }
}

impl Search {
    /// All relations that depend on the trajectory.
    pub fn new(program: &Program) -> Self {
        let relations = (0..program.watches.len() as u32)
            .filter(|k| program.watches[*k as usize] == Watch::State)
            .collect();
        let margins = vec![0.0; program.watches.len()];
        Search { relations, point: vec![0.0; program.order().max(1)], ignored: None, margins }
    }

    /// Gives relations that chatter a margin, as others have a hysteresis: what is smaller is rounding of
    /// operands that rest at the border. False if they have a large one already.
    pub fn widen(&mut self, relations: impl Iterator<Item = u32>) -> bool {
        let mut widened = false;
        for k in relations {
            let margin = &mut self.margins[k as usize];
            let wider = (*margin * MARGIN_GROWTH).max(FIRST_MARGIN);
            if wider <= LARGEST_MARGIN {
                *margin = wider;
                widened = true;
            }
        }
        widened
    }

    /// How far a relation must be beyond its border to count as switched.
    pub fn margin(&self, relation: u32) -> f64 {
        self.margins[relation as usize]
    }

    /// Leaves a relation out of the search, or none.
    pub fn ignore(&mut self, relation: Option<u32>) {
        self.ignored = relation;
    }

    /// Searches an ignored relation again as soon as it agrees with its held value.
    pub fn heed(&mut self, instance: &Instance<'_>) {
        let layout = &instance.program.layout;
        self.ignored = self
            .ignored
            .filter(|k| instance.get(layout.fresh + k) != instance.get(layout.relations + k));
    }

    /// True if there is nothing to search.
    pub fn is_empty(&self) -> bool {
        self.relations.is_empty()
    }

    /// The first instant in the last step at which a relation has switched, enclosed from the right.
    pub fn first_switch(
        &mut self,
        model: &mut Model<'_>,
        stepper: &dyn Stepper,
    ) -> Result<Option<f64>, Fault> {
        if self.relations.is_empty() {
            return Ok(None);
        }
        let (t0, t1) = (stepper.t_previous(), stepper.t());
        let quiet = if self.ignored.is_none() { model.quiet_until(t0, t1) } else { None };
        let mut left = quiet.unwrap_or(t0);
        let mut trials = TRIALS;
        let looks = LOOKS.map(|look| t0 + look * (t1 - t0)).into_iter();
        for target in looks.filter(|_| quiet.is_none()).chain([t1]) {
            let mut right = target;
            while left < target {
                match self.evaluate(model, stepper, right) {
                    Ok(()) if self.switched(&model.instance).next().is_some() => {
                        return Ok(Some(self.enclose(model, stepper, left, right)));
                    }
                    Ok(()) => (left, right) = (right, target),
                    // A held branch may end before the step does, but not before it is left.
                    Err(fault) => {
                        trials = trials.saturating_sub(1);
                        right = left + 0.5 * (right - left);
                        if trials > 0 && left < right {
                            continue;
                        }
                        // Between the ends the interpolation may leave the domain; its end counts.
                        if target < t1 {
                            break;
                        }
                        return Err(fault);
                    }
                }
            }
        }
        Ok(None)
    }

    /// Shrinks the interval around the first switching and returns its right end.
    fn enclose(
        &mut self,
        model: &mut Model<'_>,
        stepper: &dyn Stepper,
        left: f64,
        right: f64,
    ) -> f64 {
        let candidates: Vec<u32> = self.switched(&model.instance).collect();
        let at_right = self.progress(&model.instance, &candidates);
        // Left of it all candidates are as they are held.
        let at_left = match self.evaluate(model, stepper, left) {
            Ok(()) => -self.nearest(&model.instance, &candidates),
            Err(_) => -f64::MIN_POSITIVE,
        };
        let tolerance = ENCLOSURE * f64::EPSILON * right.abs().max(right - left);
        let signed = |t: f64| match self.evaluate(model, stepper, t) {
            Ok(()) if self.switched(&model.instance).next().is_some() => {
                self.progress(&model.instance, &candidates)
            }
            Ok(()) => -self.nearest(&model.instance, &candidates),
            Err(_) => f64::MIN_POSITIVE,
        };
        locate(signed, (left, at_left), (right, at_right), tolerance).map_or(right, |b| b.right)
    }

    fn evaluate(
        &mut self,
        model: &mut Model<'_>,
        stepper: &dyn Stepper,
        t: f64,
    ) -> Result<(), Fault> {
        if t == stepper.t() {
            if model.stands_at(t, stepper.y()) {
                return Ok(());
            }
            self.point.copy_from_slice(stepper.y());
        } else {
            stepper.interpolate(t, &mut self.point);
        }
        model.evaluate_roots_beyond(t, &self.point)
    }

    /// Relations whose value, as evaluated last, differs from the held one.
    pub fn switched<'a>(&'a self, instance: &'a Instance<'_>) -> impl Iterator<Item = u32> + 'a {
        let layout = &instance.program.layout;
        self.relations
            .iter()
            .copied()
            .filter(|k| self.ignored != Some(*k))
            .filter(|k| instance.get(layout.fresh + k) != instance.get(layout.relations + k))
            .filter(|k| {
                let margin = self.margins[*k as usize];
                margin == 0.0 || instance.get(layout.gaps + k).abs() > margin
            })
    }

    /// How far the switched candidates are beyond; positive.
    fn progress(&self, instance: &Instance<'_>, candidates: &[u32]) -> f64 {
        let gaps = instance.program.layout.gaps;
        let switched = self.switched(instance).filter(|k| candidates.contains(k));
        let far = switched.map(|k| instance.get(gaps + k).abs()).fold(0.0, f64::max);
        if far > 0.0 && far.is_finite() { far } else { f64::MIN_POSITIVE }
    }

    /// How far the nearest candidate is from switching; not negative.
    fn nearest(&self, instance: &Instance<'_>, candidates: &[u32]) -> f64 {
        let gaps = instance.program.layout.gaps;
        let near = candidates.iter().map(|k| instance.get(gaps + k).abs());
        let near = near.fold(f64::INFINITY, f64::min);
        if near.is_finite() { near } else { f64::MIN_POSITIVE }
    }
}

/// Makes `pre` of everything its current value.
pub fn remember(instance: &mut Instance<'_>) {
    for k in 0..instance.program.layout.pre.len() {
        let (_, slot, pre) = instance.program.layout.pre[k];
        instance.copy(pre, slot);
    }
}

/// Makes `pre` of what has no fixed past its current value.
fn remember_free(instance: &mut Instance<'_>) {
    for k in 0..instance.program.layout.pre.len() {
        let (v, slot, pre) = instance.program.layout.pre[k];
        if instance.program.blocks.dae.variables[v].fixed != Some(true) {
            instance.copy(pre, slot);
        }
    }
}

/// How values are looked for with which nothing changes any more, in the order in which these are tried.
///
/// At first relations and equations are solved together with the past held. Where that comes to no end,
/// each turn sees what the one before left as its past: so friction gets from sticking to sliding across
/// a maximum that it need not reach again (M. Otter, H. Elmqvist and S. E. Mattsson, "Hybrid modeling in
/// Modelica based on the synchronous data flow principle", CACSD 1999, section 5). At last all
/// combinations of relations are tried, the past held.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Straight,
    InTurns,
    Searching,
}

/// What the first way gives that leads to an end. If none does, the first tells why.
fn by_any_way<'p, T>(
    instance: &mut Instance<'p>,
    thoroughly: bool,
    attempt: impl Fn(&mut Instance<'p>, Way) -> Result<T, Unsettled>,
) -> Result<T, Unsettled> {
    let others = if thoroughly { &[Way::InTurns, Way::Searching][..] } else { &[Way::InTurns] };
    let before = instance.keep();
    let mut outcome = attempt(instance, Way::Straight);
    if outcome.as_ref().is_err_and(is_restless) && instance.tangents.is_none() {
        let told = instance.told();
        for &way in others {
            instance.memory.copy_from_slice(&before);
            let found = attempt(instance, way);
            if found.is_ok() {
                outcome = found;
                break;
            }
        }
        match outcome {
            Ok(_) => instance.forget(told),
            Err(_) => instance.tell(told),
        }
    }
    instance.release(before);
    outcome
}

/// As [`sweep`] over the initial sequence; in turns, `pre(v) = v` where nothing else is said (Modelica
/// 3.6, section 8.6).
pub fn begin<'p>(instance: &mut Instance<'p>) -> Result<(), Unsettled> {
    let program: &'p Program = instance.program;
    let outcome = by_any_way(instance, true, |instance, way| match way {
        Way::InTurns => begin_in_turns(instance),
        _ => sweep(instance, &program.initial, &program.late_initial, way == Way::Searching),
    });
    // Events are about other relations.
    instance.confirmed.clear();
    outcome
}

fn begin_in_turns<'p>(instance: &mut Instance<'p>) -> Result<(), Unsettled> {
    let program: &'p Program = instance.program;
    for _ in 0..ITERATION_LIMIT {
        turn(instance, &program.initial, &program.late_initial)?;
        remember_free(instance);
        if !instance.moved {
            // At rest it is a solution like any.
            return sweep(instance, &program.initial, &program.late_initial, false);
        }
    }
    Err(Unsettled::Restless(Vec::new(), Vec::new()))
}

/// Runs a tape once, relaxed; the instance has moved if mixed blocks or relations did.
fn turn<'p>(instance: &mut Instance<'p>, tape: &'p Tape, late: &[u32]) -> Result<(), Unsettled> {
    let first = instance.program.layout.relations;
    let held: Vec<f64> = late.iter().map(|k| instance.get(first + k)).collect();
    (instance.relaxed, instance.moved) = (true, false);
    let outcome = instance.run(tape);
    instance.relaxed = false;
    outcome?;
    instance.moved |= late.iter().zip(&held).any(|(k, h)| instance.get(first + k) != *h);
    Ok(())
}

/// The event iteration at the time and the states that stand in the memory, whose variables hold
/// their left limits. Flags of clocks are raised by the caller. Unless `thoroughly`, not all combinations
/// of relations are tried: a little later it may go without.
pub fn settle(
    instance: &mut Instance<'_>,
    clocks: &Clocks,
    thoroughly: bool,
) -> Result<Settled, Unsettled> {
    // What a failed attempt has said was never said.
    let said = instance.said.len();
    let outcome = by_any_way(instance, thoroughly, |instance, way| {
        instance.said.truncate(said);
        settle_in(instance, clocks, way)
    });
    if outcome.is_err() {
        instance.said.truncate(said);
    }
    outcome
}

fn settle_in(instance: &mut Instance<'_>, clocks: &Clocks, way: Way) -> Result<Settled, Unsettled> {
    let program = instance.program;
    let first = program.layout.relations;
    let count = program.watches.len() as Slot;
    let before: Vec<f64> = (0..count).map(|k| instance.get(first + k)).collect();
    let mut settled = Settled { changed: false, terminate: None, failed: None, acted: false };
    let mut ticking = program.clocks.iter().any(|c| instance.get(c.flag) != 0.0);
    settled.changed |= ticking;
    remember(instance);
    if ticking {
        // The flags are discrete variables themselves: their edge starts at false.
        for clock in &program.clocks {
            for &(_, slot, pre) in &program.layout.pre {
                if slot == clock.flag {
                    instance.set(pre, 0.0);
                }
            }
        }
    }
    let mut restless = Vec::new();
    for _ in 0..ITERATION_LIMIT {
        let mut again = false;
        if way == Way::InTurns {
            turn(instance, &program.event, &program.late_event)?;
            again = instance.moved;
        } else {
            sweep(instance, &program.event, &program.late_event, way == Way::Searching)?;
        }
        note_actions(instance, &mut settled);
        again |= apply_reinits(instance);
        restless.clear();
        for &(v, slot, pre) in &program.layout.pre {
            let discrete = program.blocks.dae.variables[v].kind == crate::ir::dae::Kind::Discrete;
            if discrete && instance.get(slot).to_bits() != instance.get(pre).to_bits() {
                restless.push(v);
            }
        }
        again |= !restless.is_empty();
        settled.changed |= again;
        settled.acted |= again || ticking;
        if ticking {
            clocks.lower(instance);
            again = true;
            ticking = false;
        }
        remember(instance);
        if !again && way == Way::InTurns {
            // At rest it is a solution like any.
            sweep(instance, &program.event, &program.late_event, false)?;
        }
        if !again || settled.failed.is_some() {
            let now = (0..count).map(|k| instance.get(first + k));
            settled.changed |= now.zip(&before).any(|(a, b)| a != *b);
            instance.run(&program.held)?;
            return Ok(settled);
        }
    }
    Err(Unsettled::Restless(restless, Vec::new()))
}

/// Assertions of when-clauses and terminations that are active now.
pub fn note_actions(instance: &mut Instance<'_>, settled: &mut Settled) {
    let program = instance.program;
    for (k, a) in program.asserts.iter().enumerate() {
        let active = a.at_events && instance.get(a.active) != 0.0;
        if !active || instance.get(a.condition) != 0.0 {
            continue;
        }
        let assert = &program.blocks.dae.asserts[k].assert;
        if assert.level != Level::Error {
            let text = text_of(program, &instance.memory, assert.message);
            instance.said.push((k, text));
        } else if settled.failed.is_none() {
            settled.failed = Some(k);
        }
    }
    for (k, slot) in program.terminates.iter().enumerate() {
        if instance.get(*slot) != 0.0 && settled.terminate.is_none() {
            settled.terminate = Some(k);
        }
    }
}

/// Sets the states of active `reinit`s; true if there is any.
fn apply_reinits(instance: &mut Instance<'_>) -> bool {
    let mut any = false;
    for r in &instance.program.reinits {
        if instance.get(r.active) != 0.0 {
            instance.copy(r.state, r.value);
            any = true;
        }
    }
    any
}
