//! A model between an integrator and its events: what FMI calls Model Exchange.
//!
//! In: time, states and inputs from the importer. Out: derivatives, event indicators, and the effects of
//! events. Relations are held between events, as in an ordinary run.
//!
//! An event indicator is the distance of a relation from its change: positive while its value is held, and
//! negative beyond a small margin on the other side. So it is never zero at the end of an event, and an
//! importer that looks for changes of sign sees each change of a relation once.

use crate::ir::expr::{Binary, VarId};
use crate::ir::flat::AssertionLevel;
use crate::ir::program::{Program, RelationTrigger, Slot};
use crate::runtime::input_signals::InputSignals;
use crate::runtime::machine::{Fault, Machine};
use crate::runtime::tangent::Tangents;
use crate::simulate::event::iterate::{EventEffects, EventError, iterate};
use crate::simulate::event::time_events::Clocks;
use crate::simulate::failure::assertion::{message_text, violated};
use crate::simulate::failure::{Failure, event_failure, of_fault, start_failure};
use crate::simulate::run::initialise_with_histories;
use crate::simulate::settings::Settings;
use crate::simulate::state_selection::StateSelector;
use crate::simulate::stepping::Snapshot;
use crate::simulate::system::{HybridSystem, is_domain_fault};

/// Margin of an event indicator, relative to its largest value at events.
const MARGIN: f64 = 1e-12;
/// Smallest value that the margin refers to.
const LEAST_REACH: f64 = 1e-9;
/// Maximum number of times that readers of transport lines may change segments at one instant.
const MAX_SEGMENT_CHANGES: u32 = 100;

/// A distance as importers get it. That of a transport line to a border of its segments has no bound where there is no
/// border; its sign alone is then passed on, for FMI knows finite numbers only.
pub(super) fn near(distance: f64) -> f64 {
    if distance.abs() >= f64::MAX { distance.signum() } else { distance }
}

/// How much of the memory belongs to the current point.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Evaluated {
    Nothing,
    Derivatives,
    Indicators,
    All,
}

/// Result of an event.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Update {
    /// The states jumped.
    pub states_changed: bool,
    /// The model ends the run, with this message.
    pub terminated: Option<String>,
    /// The next instant at which the importer must stop, s.
    pub next_time: Option<f64>,
}

/// A model between events, see the module.
pub struct Exchange<'p> {
    program: &'p Program,
    system: HybridSystem<'p>,
    clocks: Clocks,
    selection: StateSelector,
    t: f64,
    /// The instant up to which histories are recorded.
    recorded: f64,
    y: Vec<f64>,
    evaluated: Evaluated,
    /// Relations that an integrator can change, and whether a rising indicator makes them true.
    monitored: Vec<(u32, bool)>,
    /// For each of them the largest distance from its border at events, and the margin beyond it.
    reach: Vec<f64>,
    margins: Vec<f64>,
    /// Effects of the initialization, reported by the first event.
    at_start: EventEffects,
    reported: Vec<bool>,
    /// Messages of assertions that do not end the run. Cleared by the reader.
    pub warnings: Vec<String>,
    tangents: Option<Tangents>,
}

impl<'p> Exchange<'p> {
    /// Initializes a model.
    pub fn begin(program: &'p Program, settings: &Settings) -> Result<Self, Failure> {
        let mut system = HybridSystem::new(program);
        let started = initialise_with_histories(&mut system, settings);
        let (clocks, selection, at_start) =
            started.map_err(|why| start_failure(&system.machine, why, settings.start))?;
        // From here on inputs are set, not driven.
        system.machine.input_signals = InputSignals::default();
        let monitored = monitored(program);
        let mut y = vec![0.0; program.order().max(1)];
        y[..program.order()].copy_from_slice(system.machine.states());
        let mut begun = Exchange {
            program,
            system,
            clocks,
            selection,
            t: settings.start,
            recorded: settings.start,
            y,
            evaluated: Evaluated::Nothing,
            reach: vec![0.0; monitored.len()],
            margins: vec![0.0; monitored.len()],
            monitored,
            at_start,
            reported: vec![false; program.events.asserts.len()],
            warnings: Vec::new(),
            tangents: None,
        };
        begun.evaluate()?;
        begun.renew_margins();
        Ok(begun)
    }

    /// The machine with the values at the current point, after [`Exchange::evaluate`].
    pub fn machine(&self) -> &Machine<'p> {
        &self.system.machine
    }

    /// The current time, s.
    pub fn time(&self) -> f64 {
        self.t
    }

    /// Sets the time, s.
    pub fn set_time(&mut self, t: f64) {
        self.t = t;
        self.evaluated = Evaluated::Nothing;
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.program.order()
    }

    /// The states.
    pub fn states(&self) -> &[f64] {
        &self.y[..self.program.order()]
    }

    /// Sets the states; as many as there are.
    pub fn set_states(&mut self, states: &[f64]) {
        self.y[..states.len()].copy_from_slice(states);
        self.evaluated = Evaluated::Nothing;
    }

    /// Sets the state with this number.
    pub fn set_state(&mut self, number: usize, value: f64) {
        self.y[number] = value;
        self.evaluated = Evaluated::Nothing;
    }

    /// Sets an input.
    pub fn set_input(&mut self, slot: Slot, value: f64) {
        self.system.machine.set(slot, value);
        self.evaluated = Evaluated::Nothing;
    }

    /// Changes a parameter, and those that are computed from it.
    pub fn set_parameter(&mut self, v: VarId, value: f64) -> Result<(), Failure> {
        let machine = &mut self.system.machine;
        machine.set_parameter(v, value);
        let computed = machine.run(&self.program.tapes.parameters);
        self.evaluated = Evaluated::Nothing;
        computed.map_err(|fault| of_fault(&self.system.machine, fault, self.t))
    }

    /// The nominal values of the states.
    pub fn nominals(&self) -> Vec<f64> {
        let sizes = self.program.layout.nominals.iter().map(|slot| {
            let size = self.system.machine.get(*slot).abs();
            if size > 0.0 && size.is_finite() { size } else { 1.0 }
        });
        sizes.take(self.program.order()).collect()
    }

    /// The derivatives of the states.
    pub fn derivatives(&mut self, out: &mut [f64]) -> Result<(), Failure> {
        if self.evaluated == Evaluated::Nothing {
            let n = self.program.order();
            let machine = &mut self.system.machine;
            let mut found = machine.derivatives(self.t, &self.y[..n], &mut out[..n]);
            if found.is_err_and(is_domain_fault) {
                // A held branch must extend slightly beyond its border.
                machine.clamp_domain = true;
                found = machine.derivatives(self.t, &self.y[..n], &mut out[..n]);
                machine.clamp_domain = false;
            }
            self.explained(found)?;
            self.evaluated = Evaluated::Derivatives;
        }
        for (d, slot) in out.iter_mut().zip(&self.program.layout.derivatives) {
            *d = self.system.machine.get(*slot);
        }
        Ok(())
    }

    /// Number of event indicators.
    pub fn count_indicators(&self) -> usize {
        self.monitored.len()
    }

    /// The event indicators.
    pub fn indicators(&mut self, out: &mut [f64]) -> Result<(), Failure> {
        self.evaluate_to(Evaluated::Indicators)?;
        for (k, z) in out.iter_mut().enumerate().take(self.monitored.len()) {
            let (distance, held) = self.distance(k);
            *z = distance + if held { self.margins[k] } else { -self.margins[k] };
        }
        Ok(())
    }

    /// Evaluates all variables at the current point.
    pub fn evaluate(&mut self) -> Result<(), Failure> {
        self.evaluate_to(Evaluated::All)
    }

    fn evaluate_to(&mut self, wanted: Evaluated) -> Result<(), Failure> {
        if self.evaluated >= wanted {
            return Ok(());
        }
        let (t, system) = (self.t, &mut self.system);
        let mut found = match wanted {
            Evaluated::All => system.evaluate_all(t, &self.y),
            _ => system.evaluate_roots(t, &self.y),
        };
        if found.is_err_and(is_domain_fault) {
            found = system.evaluate_all_clamped(t, &self.y);
        }
        self.explained(found)?;
        self.evaluated = wanted;
        Ok(())
    }

    fn explained(&self, found: Result<(), Fault>) -> Result<(), Failure> {
        found.map_err(|fault| of_fault(&self.system.machine, fault, self.t))
    }

    /// How far relation `k` of the monitored ones is on the side where it is true, and its held value.
    fn distance(&self, k: usize) -> (f64, bool) {
        let (relation, rises) = self.monitored[k];
        let layout = &self.program.layout;
        let difference = near(self.system.machine.get(layout.indicators + relation));
        let held = self.system.machine.get(layout.relations + relation) != 0.0;
        (if rises { difference } else { -difference }, held)
    }

    /// Chooses the margins at the end of an event. A relation that did not follow its operands, because
    /// rounding in the event put them on the other side, gets a margin that they must cross again.
    fn renew_margins(&mut self) {
        for k in 0..self.monitored.len() {
            let (distance, held) = self.distance(k);
            if distance.is_finite() {
                self.reach[k] = self.reach[k].max(distance.abs());
            }
            let margin = MARGIN * self.reach[k].max(LEAST_REACH);
            let beyond = if held { -distance } else { distance };
            self.margins[k] = if beyond >= margin { 2.0 * beyond } else { margin };
        }
    }

    /// Concludes a step of the importer's integrator; true if an event must follow.
    pub fn complete_step(&mut self) -> Result<bool, Failure> {
        self.evaluate()?;
        self.record_histories(false);
        self.check_assertions()?;
        let crossed = (0..self.monitored.len()).any(|k| {
            let (distance, held) = self.distance(k);
            if held { distance < -self.margins[k] } else { distance > self.margins[k] }
        });
        Ok(crossed)
    }

    fn record_histories(&mut self, after_event: bool) {
        let machine = &mut self.system.machine;
        if machine.has_history() {
            // Values of the step that ends here may still be asked for; a restored state may lie before the last one.
            let needed = self.recorded.min(self.t);
            machine.delays.record(self.t, &machine.memory, after_event, needed);
            self.recorded = self.t;
            machine.transports.record(self.t, &machine.memory, after_event);
        }
    }

    /// Executes an event at the current point.
    pub fn update(&mut self) -> Result<Update, Failure> {
        self.evaluate()?;
        self.record_histories(false);
        let t = self.t;
        let machine = &mut self.system.machine;
        while self.clocks.raise(machine, t)
            && self.clocks.next_instant(machine, f64::NEG_INFINITY) < t
        {}
        if machine.delays.advance_past(t, &machine.memory) {
            machine.delays.write_slots(t, &mut machine.memory);
        }
        machine.transports.advance_past(&mut machine.memory);
        machine.assertion_messages.clear();
        let mut effects = self.iterate()?;
        for _ in 0..MAX_SEGMENT_CHANGES {
            let machine = &mut self.system.machine;
            if !machine.transports.advance_past(&mut machine.memory) {
                break;
            }
            effects = effects.before(self.iterate()?);
        }
        let effects = std::mem::take(&mut self.at_start).before(effects);
        let n = self.program.order();
        let before = self.y.clone();
        self.y[..n].copy_from_slice(self.system.machine.states());
        self.evaluated = Evaluated::Nothing;
        self.evaluate()?;
        self.record_histories(true);
        self.renew_margins();
        for (k, text) in std::mem::take(&mut self.system.machine.assertion_messages) {
            self.warn(k, text);
        }
        if let Some(k) = effects.failed {
            return Err(violated(self.program, &self.system.machine.memory, k, t));
        }
        self.check_assertions()?;
        let terminated = effects.terminate.map(|k| {
            let message = self.program.blocks.dae.terminates[k].message;
            message_text(self.program, &self.system.machine.memory, message)
        });
        Ok(Update {
            states_changed: self.y != before,
            terminated,
            next_time: Some(self.next_time()).filter(|at| at.is_finite()),
        })
    }

    fn iterate(&mut self) -> Result<EventEffects, Failure> {
        let machine = &mut self.system.machine;
        let mut outcome = iterate(machine, &self.clocks, true);
        if let Err(EventError::Fault(fault)) = outcome
            && is_domain_fault(fault)
        {
            machine.clamp_domain = true;
            outcome = iterate(machine, &self.clocks, true);
            machine.clamp_domain = false;
        }
        outcome.map_err(|why| event_failure(&self.system.machine, why, self.t))
    }

    /// The next time event, s. With a history it comes before a step could need values that are not yet known.
    fn next_time(&self) -> f64 {
        let machine = &self.system.machine;
        let instant = self.clocks.next_instant(machine, self.t);
        let delayed = machine.delays.next_breakpoint(&machine.memory);
        let known = machine.delays.shortest_delay(&machine.memory);
        let moved = machine.transports.max_step(&machine.memory);
        instant.min(delayed).min(self.t + known.min(moved))
    }

    /// Checks the assertions outside of when-clauses.
    fn check_assertions(&mut self) -> Result<(), Failure> {
        for k in 0..self.program.events.asserts.len() {
            let slots = self.program.events.asserts[k];
            if slots.at_events || self.system.machine.get(slots.condition) != 0.0 {
                continue;
            }
            let assert = &self.program.blocks.dae.asserts[k].assert;
            let memory = &self.system.machine.memory;
            if assert.level == AssertionLevel::Error {
                return Err(violated(self.program, memory, k, self.t));
            }
            if !self.reported[k] {
                let text = message_text(self.program, memory, assert.message);
                self.warn(k, text);
            }
        }
        Ok(())
    }

    /// Keeps a message: warnings once, printed lines always.
    fn warn(&mut self, k: usize, text: String) {
        let repeated = std::mem::replace(&mut self.reported[k], true);
        let level = self.program.blocks.dae.asserts[k].assert.level;
        if !repeated || matches!(level, AssertionLevel::Print(_)) {
            self.warnings.push(text);
        }
    }

    /// Derivatives of `unknowns` along a direction of `knowns`, with relations held; slots both.
    pub fn directional(
        &mut self,
        unknowns: &[Slot],
        knowns: &[Slot],
        seed: &[f64],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.evaluate()?;
        let slots = self.program.image.len();
        let mut tangents = match self.tangents.take() {
            Some(mut tangents) => {
                tangents.clear_all();
                tangents
            }
            None => Tangents::new(slots, 1),
        };
        for (slot, dv) in knowns.iter().zip(seed) {
            tangents.of_mut(*slot)[0] += dv;
        }
        let tapes = &self.program.tapes;
        for tape in [&tapes.rhs, &tapes.roots, &tapes.outputs] {
            let propagated = tangents.propagate(&mut self.system.machine, tape);
            propagated.map_err(|f| of_fault(&self.system.machine, f, self.t))?;
        }
        for (slot, dz) in unknowns.iter().zip(out) {
            *dz = tangents.of(*slot)[0];
        }
        self.tangents = Some(tangents);
        Ok(())
    }

    /// The state, and what only indicators need.
    pub fn save(&self) -> (Snapshot, Vec<f64>, Vec<f64>) {
        let machine = &self.system.machine;
        let snapshot = Snapshot {
            t: self.t,
            y: self.y.clone(),
            memory: machine.memory.clone(),
            delays: machine.delays.clone(),
            transports: machine.transports.clone(),
            clocks: self.clocks.clone(),
            selection: self.selection.clone(),
        };
        (snapshot, self.reach.clone(), self.margins.clone())
    }

    /// Restores a saved state.
    pub fn restore(&mut self, (saved, reach, margins): &(Snapshot, Vec<f64>, Vec<f64>)) {
        let machine = &mut self.system.machine;
        machine.memory.clone_from(&saved.memory);
        machine.delays = saved.delays.clone();
        machine.transports = saved.transports.clone();
        machine.fault = None;
        machine.relation_solutions.clear();
        self.clocks = saved.clocks.clone();
        self.selection = saved.selection.clone();
        self.t = saved.t;
        self.y.clone_from(&saved.y);
        self.reach.clone_from(reach);
        self.margins.clone_from(margins);
        self.evaluated = Evaluated::Nothing;
    }
}

/// The relations that an integrator can change, and whether each is true above its border.
fn monitored(program: &Program) -> Vec<(u32, bool)> {
    let triggers = program.events.relation_triggers.iter().zip(&program.blocks.dae.relations);
    let all = triggers.enumerate().filter(|(_, (trigger, _))| **trigger == RelationTrigger::State);
    let rises = |op: Binary| matches!(op, Binary::Greater | Binary::GreaterEqual);
    all.map(|(k, (_, relation))| (k as u32, rises(relation.op))).collect()
}

/// Number of event indicators of a program.
pub fn count_indicators(program: &Program) -> usize {
    monitored(program).len()
}
