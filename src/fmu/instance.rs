//! One instance of an FMU: its phase, its variables, and the two ways to run it.
//!
//! In: calls of an importer, as FMI orders them. Out: values, or a [`Refusal`] in the names of the model. A
//! value reference is the number of a variable and 1; 0 is time.

use std::sync::Arc;

use crate::base::index::Id;
use crate::base::name::string_of_id;
use crate::base::wire::{Reader, Wire};
use crate::ir::dae::VariableKind;
use crate::ir::expr::{Type, VarId};
use crate::ir::program::{Program, RelationTrigger, Slot};
use crate::numeric::time_series::{Interpolation, TimeSeries};
use crate::runtime::jit::tiering::Execution;
use crate::runtime::machine::Machine;
use crate::simulate::failure::{Failure, FailureKind};
use crate::simulate::settings::Settings;
use crate::simulate::stepping::{Arrival, Snapshot, Stepping};

use super::exchange::{Exchange, Update, count_indicators};
use super::interface::{FIRST_DERIVATIVE, FIRST_INDICATOR};

/// Who integrates.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// The importer: Model Exchange.
    Exchange,
    /// The FMU: Co-Simulation. `events` are left to the importer.
    Stepping {
        /// The importer handles events: it enters event mode when one is due.
        events: bool,
    },
}

/// What may be called.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Phase {
    /// Parameters and start values may be set.
    Instantiated,
    /// The same, and values may be read.
    Initializing,
    /// At an event.
    Event,
    /// Between events of Model Exchange.
    Continuous,
    /// Between communication points.
    Step,
    /// Values may be read.
    Terminated,
}

/// How serious a refusal is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Gravity {
    /// The point is out of the domain: another step size may help.
    Discard,
    /// The instance cannot go on.
    Error,
}

/// Why a call has no result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Refusal {
    /// How serious it is.
    pub gravity: Gravity,
    /// The reason, in the names of the model.
    pub text: String,
}

impl Refusal {
    /// An error of the caller.
    pub fn of(text: impl Into<String>) -> Self {
        Refusal { gravity: Gravity::Error, text: text.into() }
    }
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        let numerics = failure.kind == FailureKind::Numerics;
        let gravity = if numerics { Gravity::Discard } else { Gravity::Error };
        Refusal { gravity, text: failure.diagnostic.message.clone() }
    }
}

/// An input of the model.
#[derive(Clone)]
struct Input {
    variable: VarId,
    slot: Slot,
    /// It varies between events.
    is_driven: bool,
    value: Option<f64>,
}

/// The saved state of an instance.
#[derive(Clone)]
pub struct Saved {
    phase: u8,
    parameters: Vec<(VarId, f64)>,
    starts: Vec<(VarId, f64)>,
    limits: [f64; 3],
    inputs: Vec<Option<f64>>,
    stepping: Option<Snapshot>,
    exchange: Option<(Snapshot, Vec<f64>, Vec<f64>)>,
}

crate::base::wire::wire_struct!(Saved {
    phase,
    parameters,
    starts,
    limits,
    inputs,
    stepping,
    exchange
});

const PHASES: [Phase; 6] = [
    Phase::Instantiated,
    Phase::Initializing,
    Phase::Event,
    Phase::Continuous,
    Phase::Step,
    Phase::Terminated,
];

/// An instance, see the module.
pub struct Instance<'p> {
    program: &'p Program,
    kind: Kind,
    phase: Phase,
    settings: Settings,
    inputs: Vec<Input>,
    exchange: Option<Exchange<'p>>,
    stepping: Option<Stepping<'p>>,
    /// The values at the communication point are in the memory.
    is_evaluated: bool,
    inputs_changed: bool,
    /// Warnings of the model. Cleared by the reader.
    pub warnings: Vec<String>,
}

type Outcome<T> = Result<T, Refusal>;

impl<'p> Instance<'p> {
    /// A new instance.
    pub fn new(program: &'p Program, kind: Kind) -> Self {
        Instance {
            program,
            kind,
            phase: Phase::Instantiated,
            settings: Settings::executed(&program.blocks.dae.experiment, Execution::Interpreted),
            inputs: inputs(program),
            exchange: None,
            stepping: None,
            is_evaluated: false,
            inputs_changed: false,
            warnings: Vec::new(),
        }
    }

    /// The program.
    pub fn program(&self) -> &'p Program {
        self.program
    }

    /// The current phase.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Forgets everything but the kind.
    pub fn reset(&mut self) {
        *self = Instance::new(self.program, self.kind);
    }

    /// Announces the run.
    pub fn set_up(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Outcome<()> {
        let span = self.settings.stop - self.settings.start;
        self.settings.start = start;
        self.settings.stop = stop.unwrap_or(start + span);
        if let Some(tolerance) = tolerance {
            self.settings.tolerance = tolerance;
        }
        match self.settings.fault() {
            Some(fault) => Err(Refusal::of(fault)),
            None => Ok(()),
        }
    }

    /// From here on values may be read.
    pub fn enter_initialization(&mut self) -> Outcome<()> {
        self.expect(&[Phase::Instantiated], "initialization mode")?;
        self.phase = Phase::Initializing;
        Ok(())
    }

    /// Initializes the model with the values that were set.
    pub fn exit_initialization(&mut self) -> Outcome<()> {
        self.expect(&[Phase::Initializing], "the end of the initialization")?;
        match self.kind {
            Kind::Exchange => {
                self.initialized()?;
                self.phase = Phase::Event;
            }
            Kind::Stepping { events } => {
                let may_be_ahead = self.inputs.is_empty();
                let settings = self.settings_with_inputs();
                let stepping = Stepping::begin(self.program, &settings, may_be_ahead);
                self.stepping = Some(stepping.map_err(fatal)?);
                self.exchange = None;
                self.is_evaluated = false;
                self.phase = if events { Phase::Event } else { Phase::Step };
            }
        }
        self.inputs_changed = false;
        self.collect_warnings();
        Ok(())
    }

    /// Ends the run; values may still be read.
    pub fn terminate(&mut self) {
        self.phase = Phase::Terminated;
    }

    fn expect(&self, phases: &[Phase], what: &str) -> Outcome<()> {
        match phases.contains(&self.phase) {
            true => Ok(()),
            false => Err(Refusal::of(format!("{what} cannot follow the phase {:?}", self.phase))),
        }
    }

    /// The settings of the initialization: inputs have the values that were set.
    fn settings_with_inputs(&self) -> Settings {
        let mut settings = self.settings.clone();
        for input in &self.inputs {
            if input.is_driven {
                let value = input.value.unwrap_or_else(|| self.start_value(input.variable));
                let series =
                    TimeSeries::new([settings.start].into(), vec![value], Interpolation::Linear);
                settings.courses.push((input.variable, Arc::new(series)));
            } else if let Some(value) = input.value {
                settings.starts.push((input.variable, value));
            }
        }
        settings
    }

    /// The start value of a variable, from the parameters that were set.
    fn start_value(&self, v: VarId) -> f64 {
        let starts = &self.program.layout.starts;
        let Some((.., slot)) = starts.iter().find(|(s, ..)| *s == v) else { return 0.0 };
        let mut machine = Machine::new(self.program);
        for &(p, value) in &self.settings.parameters {
            machine.set_parameter(p, value);
        }
        match machine.run(&self.program.tapes.parameters) {
            Ok(()) => machine.get(*slot),
            Err(_) => 0.0,
        }
    }

    /// The initialized model, in the phases before its end.
    fn initialized(&mut self) -> Outcome<&mut Exchange<'p>> {
        if self.exchange.is_none() {
            let settings = self.settings_with_inputs();
            let begun = Exchange::begin(self.program, &settings).map_err(fatal)?;
            self.exchange = Some(begun);
        }
        self.exchange.as_mut().ok_or_else(|| Refusal::of("not initialized"))
    }

    fn collect_warnings(&mut self) {
        if let Some(exchange) = &mut self.exchange {
            self.warnings.append(&mut exchange.warnings);
        }
        if let Some(stepping) = &mut self.stepping {
            let found = stepping.take_warnings();
            self.warnings.extend(found.into_iter().map(|d| d.message));
        }
    }

    /// The machine with current values.
    fn current(&mut self) -> Outcome<&Machine<'p>> {
        if self.stepping.is_some() {
            let Some(stepping) = &mut self.stepping else { return Err(Refusal::of("no run")) };
            if !self.is_evaluated {
                stepping.evaluate()?;
                self.is_evaluated = true;
            }
            return Ok(stepping.machine());
        }
        let exchange = self.initialized()?;
        exchange.evaluate()?;
        Ok(exchange.machine())
    }

    fn time(&self) -> f64 {
        match (&self.stepping, &self.exchange) {
            (Some(stepping), _) => stepping.now(),
            (None, Some(exchange)) => exchange.time(),
            (None, None) => self.settings.start,
        }
    }

    fn variable(&self, reference: u32) -> Outcome<VarId> {
        let v = reference.checked_sub(1).map(VarId);
        let known = v.filter(|v| v.idx() < self.program.blocks.dae.variables.len());
        known.ok_or_else(|| unknown_reference(reference))
    }

    /// The number of a variable: of a Boolean 0 or 1, of a String its id.
    pub fn get(&mut self, reference: u32) -> Outcome<f64> {
        if reference == 0 {
            return Ok(self.time());
        }
        if let Some(k) = reference.checked_sub(FIRST_INDICATOR) {
            return self.indicator(k as usize);
        }
        if let Some(k) = reference.checked_sub(FIRST_DERIVATIVE) {
            let slot = self.program.layout.derivatives.get(k as usize).copied();
            let slot = slot.ok_or_else(|| unknown_reference(reference))?;
            return Ok(self.current()?.get(slot));
        }
        let v = self.variable(reference)?;
        Ok(self.current()?.value(v))
    }

    fn indicator(&mut self, k: usize) -> Outcome<f64> {
        let count = count_indicators(self.program);
        if k >= count {
            return Err(unknown_reference(FIRST_INDICATOR + k as u32));
        }
        if self.stepping.is_some() {
            let state = |trigger: &&RelationTrigger| **trigger == RelationTrigger::State;
            let triggers = self.program.events.relation_triggers.iter().enumerate();
            let at = triggers.filter(|(_, t)| state(t)).nth(k).map_or(0, |(at, _)| at);
            let slot = self.program.layout.indicators + at as Slot;
            return Ok(self.current()?.get(slot));
        }
        let mut all = vec![0.0; count];
        self.initialized()?.indicators(&mut all)?;
        Ok(all[k])
    }

    /// The value of a String.
    pub fn get_string(&mut self, reference: u32) -> Outcome<String> {
        Ok(string_of_id(self.get(reference)? as u32).to_string())
    }

    /// Sets a parameter, a start value or an input, or a state between events of Model Exchange.
    pub fn set(&mut self, reference: u32, value: f64) -> Outcome<()> {
        let v = self.variable(reference)?;
        let name = self.program.name(v);
        if !value.is_finite() {
            return Err(Refusal::of(format!("`{name}` cannot be {value}")));
        }
        if let Some(input) = self.inputs.iter_mut().find(|input| input.variable == v) {
            if input.value != Some(value) {
                input.value = Some(value);
                let slot = input.slot;
                self.inputs_changed = true;
                match (self.phase, &mut self.exchange) {
                    (Phase::Instantiated | Phase::Initializing, _) => self.exchange = None,
                    (_, Some(exchange)) => exchange.set_input(slot, value),
                    _ => {
                        self.is_evaluated = false;
                        if let Some(stepping) = &mut self.stepping {
                            stepping.set_input(slot, value);
                        }
                    }
                }
            }
            return Ok(());
        }
        // CasADi sets the states one by one.
        let state = self.program.blocks.states.iter().position(|s| s.variable == v);
        if let (Some(k), Phase::Continuous, Some(exchange)) =
            (state, self.phase, &mut self.exchange)
        {
            exchange.set_state(k, value);
            return Ok(());
        }
        if !matches!(self.phase, Phase::Instantiated | Phase::Initializing) {
            return Err(Refusal::of(format!("`{name}` can be set before the run only")));
        }
        let layout = &self.program.layout;
        let list = if layout.parameter_inputs.iter().any(|(p, _)| *p == v) {
            &mut self.settings.parameters
        } else if layout.starts.iter().any(|(s, ..)| *s == v) {
            &mut self.settings.starts
        } else {
            return Err(Refusal::of(format!(
                "`{name}` is computed by the model and cannot be set"
            )));
        };
        list.retain(|(p, _)| *p != v);
        list.push((v, value));
        self.exchange = None;
        Ok(())
    }

    /// The type of a variable; time is a Real.
    pub fn type_of(&self, reference: u32) -> Outcome<Type> {
        if reference == 0 || reference >= FIRST_DERIVATIVE {
            return Ok(Type::Real);
        }
        Ok(self.program.blocks.dae.variables[self.variable(reference)?].ty)
    }

    // ---- Model Exchange ----

    /// The model between events.
    pub fn exchange(&mut self) -> Outcome<&mut Exchange<'p>> {
        match self.kind {
            Kind::Exchange => self.initialized(),
            Kind::Stepping { .. } => {
                Err(Refusal::of("the instance was made for Co-Simulation, not Model Exchange"))
            }
        }
    }

    /// From here on [`Instance::update`] may be called.
    pub fn enter_event_mode(&mut self) -> Outcome<()> {
        self.expect(&[Phase::Continuous, Phase::Step, Phase::Event], "event mode")?;
        self.phase = Phase::Event;
        Ok(())
    }

    /// Executes the event at the current point.
    pub fn update(&mut self) -> Outcome<Update> {
        self.expect(&[Phase::Event], "an update of discrete states")?;
        let update = match self.kind {
            Kind::Exchange => self.initialized()?.update().map_err(fatal)?,
            Kind::Stepping { .. } => {
                self.apply_inputs(true)?;
                let Some(stepping) = &mut self.stepping else {
                    return Err(Refusal::of("not initialized"));
                };
                Update {
                    states_changed: false,
                    terminated: stepping.terminated().map(str::to_owned),
                    next_time: Some(stepping.next_time_event()).filter(|at| at.is_finite()),
                }
            }
        };
        self.inputs_changed = false;
        self.collect_warnings();
        Ok(update)
    }

    /// From here on an integrator may set time and states.
    pub fn enter_continuous_mode(&mut self) -> Outcome<()> {
        self.expect(&[Phase::Event], "continuous-time mode")?;
        self.phase = Phase::Continuous;
        Ok(())
    }

    /// Concludes a step of the importer's integrator; true if an event must follow.
    pub fn complete_step(&mut self) -> Outcome<bool> {
        let due = self.exchange()?.complete_step().map_err(fatal)?;
        self.collect_warnings();
        Ok(due)
    }

    // ---- Co-Simulation ----

    /// From here on steps may be made.
    pub fn enter_step_mode(&mut self) -> Outcome<()> {
        self.expect(&[Phase::Event], "step mode")?;
        self.phase = Phase::Step;
        Ok(())
    }

    /// Executes the event that is due, and the effects of inputs.
    fn apply_inputs(&mut self, event_is_due: bool) -> Outcome<()> {
        if let Some(stepping) = &mut self.stepping
            && (self.inputs_changed || event_is_due)
        {
            stepping.execute_event().map_err(fatal)?;
            self.is_evaluated = false;
            self.inputs_changed = false;
        }
        Ok(())
    }

    /// Advances by `step` from `from`; see [`Arrival`].
    pub fn step(&mut self, from: f64, step: f64) -> Outcome<Arrival> {
        self.expect(&[Phase::Step], "a step")?;
        let events = self.kind == (Kind::Stepping { events: true });
        let now = self.time();
        let near = 1e-9 * (step.abs() + now.abs() * 1e-6);
        if (from - now).abs() > near {
            return Err(Refusal::of(format!(
                "the step begins at {from} s, but the model is at {now} s"
            )));
        }
        if !(step > 0.0 && step.is_finite()) {
            return Err(Refusal::of(format!("the step size is {step} s, not positive")));
        }
        self.apply_inputs(false)?;
        let Some(stepping) = &mut self.stepping else { return Err(Refusal::of("not initialized")) };
        self.is_evaluated = false;
        let arrival = stepping.advance(from + step, events);
        self.collect_warnings();
        arrival.map_err(fatal)
    }

    /// The message of the `terminate` that ended the run.
    pub fn terminated(&self) -> Option<&str> {
        self.stepping.as_ref().and_then(|s| s.terminated())
    }

    // ---- Derivatives ----

    /// Derivatives of unknowns along a direction of knowns (states and inputs), with relations held.
    pub fn directional(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        out: &mut [f64],
    ) -> Outcome<()> {
        let known = self.known_slots(knowns)?;
        let unknown = self.unknown_slots(unknowns)?;
        if self.stepping.is_some() {
            return Err(Refusal::of("derivatives are provided in Model Exchange"));
        }
        Ok(self.initialized()?.directional(&unknown, &known, seed, out)?)
    }

    /// The product of the transposed derivative with `seed`: one value for each known.
    pub fn adjoint(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        out: &mut [f64],
    ) -> Outcome<()> {
        let mut column = vec![0.0; unknowns.len()];
        for (known, sum) in knowns.iter().zip(out) {
            self.directional(unknowns, &[*known], &[1.0], &mut column)?;
            *sum = column.iter().zip(seed).map(|(a, b)| a * b).sum();
        }
        Ok(())
    }

    fn known_slots(&self, references: &[u32]) -> Outcome<Vec<Slot>> {
        let states = &self.program.blocks.states;
        let one = |reference: &u32| {
            let v = self.variable(*reference)?;
            if let Some(input) = self.inputs.iter().find(|input| input.variable == v) {
                return Ok(input.slot);
            }
            match states.iter().any(|s| s.variable == v) {
                true => Ok(self.program.slot(v)),
                false => Err(Refusal::of(format!(
                    "`{}` is neither a state nor an input, so there is no derivative by it",
                    self.program.name(v)
                ))),
            }
        };
        references.iter().map(one).collect()
    }

    fn unknown_slots(&self, references: &[u32]) -> Outcome<Vec<Slot>> {
        let one = |reference: &u32| match reference.checked_sub(FIRST_DERIVATIVE) {
            Some(k) => {
                let slot = self.program.layout.derivatives.get(k as usize).copied();
                slot.ok_or_else(|| unknown_reference(*reference))
            }
            None => Ok(self.program.slot(self.variable(*reference)?)),
        };
        references.iter().map(one).collect()
    }

    // ---- States ----

    /// The state of the instance.
    pub fn save(&mut self) -> Outcome<Saved> {
        let phase = PHASES.iter().position(|p| *p == self.phase).unwrap_or_default() as u8;
        let Settings { start, stop, tolerance, .. } = self.settings;
        Ok(Saved {
            phase,
            parameters: self.settings.parameters.clone(),
            starts: self.settings.starts.clone(),
            limits: [start, stop, tolerance],
            inputs: self.inputs.iter().map(|input| input.value).collect(),
            stepping: self.stepping.as_mut().map(Stepping::save).transpose()?,
            exchange: self.exchange.as_ref().map(Exchange::save),
        })
    }

    /// Restores a saved state.
    pub fn restore(&mut self, saved: &Saved) -> Outcome<()> {
        let fits = |s: &Snapshot| {
            s.memory.len() == self.program.image.len() && s.y.len() >= self.program.order()
        };
        let all = saved.stepping.iter().chain(saved.exchange.iter().map(|(s, ..)| s));
        if !all.into_iter().all(fits) || saved.inputs.len() != self.inputs.len() {
            return Err(Refusal::of("the state belongs to another model"));
        }
        self.settings.parameters.clone_from(&saved.parameters);
        self.settings.starts.clone_from(&saved.starts);
        let [start, stop, tolerance] = saved.limits;
        (self.settings.start, self.settings.stop) = (start, stop);
        self.settings.tolerance = tolerance;
        for (input, value) in self.inputs.iter_mut().zip(&saved.inputs) {
            input.value = *value;
        }
        self.phase = *PHASES.get(usize::from(saved.phase)).unwrap_or(&Phase::Instantiated);
        match &saved.exchange {
            Some(state) => self.initialized()?.restore(state),
            None => self.exchange = None,
        }
        match &saved.stepping {
            Some(state) => {
                if self.stepping.is_none() {
                    let settings = self.settings_with_inputs();
                    let ahead = self.inputs.is_empty();
                    let begun = Stepping::begin(self.program, &settings, ahead);
                    self.stepping = Some(begun.map_err(fatal)?);
                }
                if let Some(stepping) = &mut self.stepping {
                    stepping.restore(state)?;
                }
            }
            None => self.stepping = None,
        }
        self.is_evaluated = false;
        self.inputs_changed = false;
        Ok(())
    }
}

impl Saved {
    /// The state as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write(&mut bytes);
        bytes
    }

    /// The state from its bytes.
    pub fn from_bytes(bytes: &[u8]) -> Outcome<Self> {
        let mut reader = Reader::new(bytes);
        Saved::read(&mut reader).map_err(|why| Refusal::of(format!("not a saved state: {why}")))
    }
}

fn unknown_reference(reference: u32) -> Refusal {
    Refusal::of(format!("no variable has the value reference {reference}"))
}

/// A failure outside of an integrator's trial step: the instance cannot go on.
fn fatal(failure: Failure) -> Refusal {
    Refusal { gravity: Gravity::Error, ..Refusal::from(failure) }
}

/// The inputs of a program.
fn inputs(program: &Program) -> Vec<Input> {
    let variables = &program.blocks.dae.variables;
    let driven = |v: VarId| {
        let signals = &program.layout.signals;
        signals.iter().find(|(s, order, _)| *s == v && *order == 0).map(|(.., slot)| *slot)
    };
    let all = variables.enumerate().filter(|(v, variable)| {
        let delayed = program.layout.delays.iter().any(|d| d.variable == *v);
        !variable.hidden
            && !delayed
            && (variable.kind == VariableKind::Input || driven(*v).is_some())
    });
    let one = |(v, _): (VarId, _)| Input {
        variable: v,
        slot: driven(v).unwrap_or_else(|| program.slot(v)),
        is_driven: driven(v).is_some(),
        value: None,
    };
    all.map(one).collect()
}
