//! Finding where relations switch, and the iteration of the discrete part (appendix B of the
//! Modelica specification).

use crate::integrate::stepper::Stepper;
use crate::ir::expr::VarId;
use crate::ir::flat::Level;
use crate::ir::program::{Program, RelationTrigger, Slot, Tape};
use crate::numeric::root::locate;
use crate::runtime::machine::{Fault, Machine};

use super::relation_search::{may_have_solution, solve_relations};
use super::time_events::Clocks;
use crate::simulate::failure::assertion::message_text;
use crate::simulate::system::HybridSystem;

/// Event iterations at one instant before the model is given up.
pub const ITERATION_LIMIT: u32 = 100;
/// Points inside of a step, as fractions, at which relations are looked at besides its end.
const PROBES: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// Failed evaluations within one step before the search gives up.
const MAX_FAILURES: u32 = 100;
/// Length of the interval in which a switching is enclosed, in spacings of doubles at its time.
const ENCLOSURE_WIDTH: f64 = 4.0;

/// The relations that are searched.
pub struct Locator {
    relations: Vec<u32>,
    point: Vec<f64>,
    /// Not searched for the time being.
    ignored: Option<u32>,
    /// How far each relation must be beyond its border to count as switched.
    hysteresis: Vec<f64>,
}

/// The first margin of a relation that chatters, in units of its operands.
const FIRST_HYSTERESIS: f64 = 1e-13;
/// How much it grows while the relation goes on to chatter, and the largest.
const HYSTERESIS_GROWTH: f64 = 100.0;
/// See [`HYSTERESIS_GROWTH`].
const MAX_HYSTERESIS: f64 = 1e-7;

/// How an event iteration ended.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct EventEffects {
    /// A discrete variable, a relation or a state changed.
    pub changed: bool,
    /// Position of an active `terminate`.
    pub terminate: Option<usize>,
    /// Position of a failed assertion in a when-clause.
    pub failed: Option<usize>,
    /// Something other than relations changed.
    pub acted: bool,
}

impl EventEffects {
    /// This, and what came after it at the same instant.
    pub fn before(self, later: EventEffects) -> EventEffects {
        EventEffects {
            changed: self.changed | later.changed,
            terminate: self.terminate.or(later.terminate),
            failed: self.failed.or(later.failed),
            acted: self.acted | later.acted,
        }
    }
}

/// Why an event iteration could not be finished.
#[derive(Clone, PartialEq, Debug)]
pub enum EventError {
    /// A tape failed.
    Fault(Fault),
    /// Variables and relations that keep changing.
    NotConverged(Vec<VarId>, Vec<u32>),
}

impl From<Fault> for EventError {
    fn from(fault: Fault) -> Self {
        EventError::Fault(fault)
    }
}

impl Locator {
    /// All relations that depend on the trajectory.
    pub fn new(program: &Program) -> Self {
        let relations = (0..program.events.relation_triggers.len() as u32)
            .filter(|k| program.events.relation_triggers[*k as usize] == RelationTrigger::State)
            .collect();
        let hysteresis = vec![0.0; program.events.relation_triggers.len()];
        Locator { relations, point: vec![0.0; program.order().max(1)], ignored: None, hysteresis }
    }

    /// Gives relations that chatter a margin, as others have a hysteresis: what is smaller is rounding of
    /// operands that rest at the border. False if they have a large one already.
    pub fn widen_hysteresis(&mut self, relations: impl Iterator<Item = u32>) -> bool {
        let mut widened = false;
        for k in relations {
            let margin = &mut self.hysteresis[k as usize];
            let wider = (*margin * HYSTERESIS_GROWTH).max(FIRST_HYSTERESIS);
            if wider <= MAX_HYSTERESIS {
                *margin = wider;
                widened = true;
            }
        }
        widened
    }

    /// How far a relation must be beyond its border to count as switched.
    pub fn hysteresis(&self, relation: u32) -> f64 {
        self.hysteresis[relation as usize]
    }

    /// Leaves a relation out of the search, or none.
    pub fn ignore(&mut self, relation: Option<u32>) {
        self.ignored = relation;
    }

    /// Searches an ignored relation again as soon as it agrees with its held value.
    pub fn on_step(&mut self, machine: &Machine<'_>) {
        let layout = &machine.program.layout;
        self.ignored = self
            .ignored
            .filter(|k| machine.get(layout.candidates + k) != machine.get(layout.relations + k));
    }

    /// True if there is nothing to search.
    pub fn is_empty(&self) -> bool {
        self.relations.is_empty()
    }

    /// The first instant in the last step at which a relation has switched, enclosed from the right.
    pub fn first_switch(
        &mut self,
        system: &mut HybridSystem<'_>,
        stepper: &dyn Stepper,
    ) -> Result<Option<f64>, Fault> {
        if self.relations.is_empty() {
            return Ok(None);
        }
        let (t0, t1) = (stepper.t_previous(), stepper.t());
        let quiet_until = if self.ignored.is_none() { system.quiet_until(t0, t1) } else { None };
        let mut left = quiet_until.unwrap_or(t0);
        let mut failures_left = MAX_FAILURES;
        let probes = PROBES.map(|fraction| t0 + fraction * (t1 - t0)).into_iter();
        for target in probes.filter(|_| quiet_until.is_none()).chain([t1]) {
            let mut right = target;
            while left < target {
                match self.evaluate(system, stepper, right) {
                    Ok(()) if self.switched(&system.machine).next().is_some() => {
                        return Ok(Some(self.enclose(system, stepper, left, right)));
                    }
                    Ok(()) => (left, right) = (right, target),
                    // A held branch may end before the step does, but not before it is left.
                    Err(fault) => {
                        failures_left = failures_left.saturating_sub(1);
                        right = left + 0.5 * (right - left);
                        if failures_left > 0 && left < right {
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
        system: &mut HybridSystem<'_>,
        stepper: &dyn Stepper,
        left: f64,
        right: f64,
    ) -> f64 {
        let candidates: Vec<u32> = self.switched(&system.machine).collect();
        let at_right = self.largest_overshoot(&system.machine, &candidates);
        // Left of it all candidates are as they are held.
        let at_left = match self.evaluate(system, stepper, left) {
            Ok(()) => -self.smallest_distance(&system.machine, &candidates),
            Err(_) => -f64::MIN_POSITIVE,
        };
        let tolerance = ENCLOSURE_WIDTH * f64::EPSILON * right.abs().max(right - left);
        let signed = |t: f64| match self.evaluate(system, stepper, t) {
            Ok(()) if self.switched(&system.machine).next().is_some() => {
                self.largest_overshoot(&system.machine, &candidates)
            }
            Ok(()) => -self.smallest_distance(&system.machine, &candidates),
            Err(_) => f64::MIN_POSITIVE,
        };
        locate(signed, (left, at_left), (right, at_right), tolerance).map_or(right, |b| b.right)
    }

    fn evaluate(
        &mut self,
        system: &mut HybridSystem<'_>,
        stepper: &dyn Stepper,
        t: f64,
    ) -> Result<(), Fault> {
        if t == stepper.t() {
            if system.is_current_at(t, stepper.y()) {
                return Ok(());
            }
            self.point.copy_from_slice(stepper.y());
        } else {
            stepper.interpolate(t, &mut self.point);
        }
        system.evaluate_roots_clamped(t, &self.point)
    }

    /// Relations whose value, as evaluated last, differs from the held one.
    pub fn switched<'a>(&'a self, machine: &'a Machine<'_>) -> impl Iterator<Item = u32> + 'a {
        let layout = &machine.program.layout;
        self.relations
            .iter()
            .copied()
            .filter(|k| self.ignored != Some(*k))
            .filter(|k| machine.get(layout.candidates + k) != machine.get(layout.relations + k))
            .filter(|k| {
                let margin = self.hysteresis[*k as usize];
                margin == 0.0 || machine.get(layout.indicators + k).abs() > margin
            })
    }

    /// How far the switched candidates are beyond; positive.
    fn largest_overshoot(&self, machine: &Machine<'_>, candidates: &[u32]) -> f64 {
        let indicators = machine.program.layout.indicators;
        let switched = self.switched(machine).filter(|k| candidates.contains(k));
        let far = switched.map(|k| machine.get(indicators + k).abs()).fold(0.0, f64::max);
        if far > 0.0 && far.is_finite() { far } else { f64::MIN_POSITIVE }
    }

    /// How far the nearest candidate is from switching; not negative.
    fn smallest_distance(&self, machine: &Machine<'_>, candidates: &[u32]) -> f64 {
        let indicators = machine.program.layout.indicators;
        let near = candidates.iter().map(|k| machine.get(indicators + k).abs());
        let near = near.fold(f64::INFINITY, f64::min);
        if near.is_finite() { near } else { f64::MIN_POSITIVE }
    }
}

/// Makes `pre` of everything its current value.
pub fn update_pre(machine: &mut Machine<'_>) {
    for k in 0..machine.program.layout.pre.len() {
        let (_, slot, pre) = machine.program.layout.pre[k];
        machine.copy(pre, slot);
    }
}

/// Makes `pre` of what has no fixed past its current value.
fn update_free_pre(machine: &mut Machine<'_>) {
    for k in 0..machine.program.layout.pre.len() {
        let (v, slot, pre) = machine.program.layout.pre[k];
        if machine.program.blocks.dae.variables[v].fixed != Some(true) {
            machine.copy(pre, slot);
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
enum Strategy {
    Direct,
    GaussSeidel,
    Enumerate,
}

/// What the first way gives that leads to an end. If none does, the first tells why.
fn try_strategies<'p, T>(
    machine: &mut Machine<'p>,
    exhaustive: bool,
    attempt: impl Fn(&mut Machine<'p>, Strategy) -> Result<T, EventError>,
) -> Result<T, EventError> {
    let others = if exhaustive {
        &[Strategy::GaussSeidel, Strategy::Enumerate][..]
    } else {
        &[Strategy::GaussSeidel]
    };
    let before = machine.snapshot();
    let mut outcome = attempt(machine, Strategy::Direct);
    if outcome.as_ref().is_err_and(may_have_solution) && machine.tangents.is_none() {
        let saved = machine.save_fault();
        for &strategy in others {
            machine.memory.copy_from_slice(&before);
            let found = attempt(machine, strategy);
            if found.is_ok() {
                outcome = found;
                break;
            }
        }
        match outcome {
            Ok(_) => machine.discard_fault(saved),
            Err(_) => machine.restore_fault(saved),
        }
    }
    machine.recycle(before);
    outcome
}

/// As [`solve_relations`] over the initial sequence; in turns, `pre(v) = v` where nothing else is said (Modelica
/// 3.6, section 8.6).
pub fn solve_initial<'p>(machine: &mut Machine<'p>) -> Result<(), EventError> {
    let program: &'p Program = machine.program;
    let outcome = try_strategies(machine, true, |machine, strategy| match strategy {
        Strategy::GaussSeidel => initial_gauss_seidel(machine),
        _ => solve_relations(
            machine,
            &program.tapes.initial,
            &program.events.lagged_initial,
            strategy == Strategy::Enumerate,
        ),
    });
    // Events are about other relations.
    machine.relation_solutions.clear();
    outcome
}

fn initial_gauss_seidel<'p>(machine: &mut Machine<'p>) -> Result<(), EventError> {
    let program: &'p Program = machine.program;
    for _ in 0..ITERATION_LIMIT {
        relaxed_pass(machine, &program.tapes.initial, &program.events.lagged_initial)?;
        update_free_pre(machine);
        if !machine.still_changing {
            // At rest it is a solution like any.
            return solve_relations(
                machine,
                &program.tapes.initial,
                &program.events.lagged_initial,
                false,
            );
        }
    }
    Err(EventError::NotConverged(Vec::new(), Vec::new()))
}

/// Runs a tape once, relaxed; the instance has moved if mixed blocks or relations did.
fn relaxed_pass<'p>(
    machine: &mut Machine<'p>,
    tape: &'p Tape,
    lagged: &[u32],
) -> Result<(), EventError> {
    let first = machine.program.layout.relations;
    let held: Vec<f64> = lagged.iter().map(|k| machine.get(first + k)).collect();
    (machine.relaxed, machine.still_changing) = (true, false);
    let outcome = machine.run(tape);
    machine.relaxed = false;
    outcome?;
    machine.still_changing |= lagged.iter().zip(&held).any(|(k, h)| machine.get(first + k) != *h);
    Ok(())
}

/// The event iteration at the time and the states that stand in the memory, whose variables hold
/// their left limits. Flags of clocks are raised by the caller. Unless `exhaustive`, not all combinations
/// of relations are tried: a little later it may go without.
pub fn iterate(
    machine: &mut Machine<'_>,
    clocks: &Clocks,
    exhaustive: bool,
) -> Result<EventEffects, EventError> {
    // What a failed attempt has said was never said.
    let messages = machine.assertion_messages.len();
    let outcome = try_strategies(machine, exhaustive, |machine, strategy| {
        machine.assertion_messages.truncate(messages);
        iterate_with(machine, clocks, strategy)
    });
    if outcome.is_err() {
        machine.assertion_messages.truncate(messages);
    }
    outcome
}

fn iterate_with(
    machine: &mut Machine<'_>,
    clocks: &Clocks,
    strategy: Strategy,
) -> Result<EventEffects, EventError> {
    let program = machine.program;
    let first = program.layout.relations;
    let count = program.events.relation_triggers.len() as Slot;
    let before: Vec<f64> = (0..count).map(|k| machine.get(first + k)).collect();
    let mut effects = EventEffects { changed: false, terminate: None, failed: None, acted: false };
    let mut ticking = program.events.clocks.iter().any(|c| machine.get(c.flag) != 0.0);
    effects.changed |= ticking;
    update_pre(machine);
    if ticking {
        // The flags are discrete variables themselves: their edge starts at false.
        for clock in &program.events.clocks {
            for &(_, slot, pre) in &program.layout.pre {
                if slot == clock.flag {
                    machine.set(pre, 0.0);
                }
            }
        }
    }
    let mut changing = Vec::new();
    for _ in 0..ITERATION_LIMIT {
        let mut repeat = false;
        if strategy == Strategy::GaussSeidel {
            relaxed_pass(machine, &program.tapes.event, &program.events.lagged_event)?;
            repeat = machine.still_changing;
        } else {
            solve_relations(
                machine,
                &program.tapes.event,
                &program.events.lagged_event,
                strategy == Strategy::Enumerate,
            )?;
        }
        collect_actions(machine, &mut effects);
        repeat |= apply_reinits(machine);
        changing.clear();
        for &(v, slot, pre) in &program.layout.pre {
            let discrete = program.blocks.dae.variables[v].kind == crate::ir::dae::Kind::Discrete;
            if discrete && machine.get(slot).to_bits() != machine.get(pre).to_bits() {
                changing.push(v);
            }
        }
        repeat |= !changing.is_empty();
        effects.changed |= repeat;
        effects.acted |= repeat || ticking;
        if ticking {
            clocks.lower(machine);
            repeat = true;
            ticking = false;
        }
        update_pre(machine);
        if !repeat && strategy == Strategy::GaussSeidel {
            // At rest it is a solution like any.
            solve_relations(machine, &program.tapes.event, &program.events.lagged_event, false)?;
        }
        if !repeat || effects.failed.is_some() {
            let now = (0..count).map(|k| machine.get(first + k));
            effects.changed |= now.zip(&before).any(|(a, b)| a != *b);
            machine.run(&program.tapes.discrete)?;
            return Ok(effects);
        }
    }
    Err(EventError::NotConverged(changing, Vec::new()))
}

/// Assertions of when-clauses and terminations that are active now.
pub fn collect_actions(machine: &mut Machine<'_>, effects: &mut EventEffects) {
    let program = machine.program;
    for (k, a) in program.events.asserts.iter().enumerate() {
        let active = a.at_events && machine.get(a.active) != 0.0;
        if !active || machine.get(a.condition) != 0.0 {
            continue;
        }
        let assert = &program.blocks.dae.asserts[k].assert;
        if assert.level != Level::Error {
            let text = message_text(program, &machine.memory, assert.message);
            machine.assertion_messages.push((k, text));
        } else if effects.failed.is_none() {
            effects.failed = Some(k);
        }
    }
    for (k, slot) in program.events.terminates.iter().enumerate() {
        if machine.get(*slot) != 0.0 && effects.terminate.is_none() {
            effects.terminate = Some(k);
        }
    }
}

/// Sets the states of active `reinit`s; true if there is any.
fn apply_reinits(machine: &mut Machine<'_>) -> bool {
    let mut any = false;
    for r in &machine.program.events.reinits {
        if machine.get(r.active) != 0.0 {
            machine.copy(r.state, r.value);
            any = true;
        }
    }
    any
}
