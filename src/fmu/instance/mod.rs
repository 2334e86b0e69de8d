//! One instance of an FMU: its phase, its variables, and the two ways to run it.
//!
//! In: calls of an importer, as FMI orders them. Out: values, or a [`Refusal`] in the names of the model. A
//! value reference is the number of a variable and 1; 0 is time.

mod access;
mod derivatives;
mod refusal;
mod saved;

use std::sync::Arc;

use crate::base::index::FastSet;
use crate::ir::dae::VariableKind;
use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::numeric::time_series::{Interpolation, TimeSeries};
use crate::runtime::machine::Machine;
use crate::simulate::settings::Settings;
use crate::simulate::stepping::{Arrival, Stepping};

pub use self::refusal::{Gravity, Refusal};
use self::refusal::{fatal, unknown_reference};
pub use self::saved::Saved;
use super::exchange::{Exchange, Update};

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

/// An input of the model.
#[derive(Clone)]
struct Input {
    variable: VarId,
    slot: Slot,
    /// It varies between events.
    is_driven: bool,
    value: Option<f64>,
}

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
    /// The parameters that may change while the model runs, once somebody has asked for them.
    tunable: Option<FastSet<VarId>>,
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
            settings: Settings::interpreted(&program.blocks.dae.experiment),
            inputs: inputs(program),
            exchange: None,
            stepping: None,
            is_evaluated: false,
            inputs_changed: false,
            tunable: None,
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
