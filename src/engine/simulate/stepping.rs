//! A run that is advanced from outside, from one communication point to the next.
//!
//! In: a [`Program`], [`Settings`], and instants to advance to. Out: the values of all variables there. A model
//! without inputs takes the steps of an ordinary run, whatever the instants are: the integrator may be ahead
//! of the communication point, and values there come from its dense output.

use std::sync::LazyLock;

use crate::base::diag::Diagnostic;
use crate::base::source::SourceMap;
use crate::base::wire::wire_struct;
use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::ir::trajectory::{Column, Event};
use crate::runtime::delay::DelayBuffers;
use crate::runtime::input_signals::InputSignals;
use crate::runtime::machine::Machine;
use crate::runtime::spatial_distribution::TransportLines;

use super::event::instant::Cause;
use super::event::time_events::Clocks;
use super::failure::{Failure, of_fault};
use super::record::Sink;
use super::run::{Due, Simulation};
use super::settings::Settings;
use super::state_selection::StateSelector;

/// No sources: places are not reported.
static NOWHERE: LazyLock<SourceMap> = LazyLock::new(SourceMap::default);

/// A sink that records nothing.
struct Unrecorded;

impl Sink for Unrecorded {
    fn begin(&mut self, _: Vec<Column>) {}
    fn wants_constants(&self) -> bool {
        false
    }
    fn row(&mut self, _: f64, _: &[f64]) {}
    fn event(&mut self, _: Event) {}
}

/// Why [`Stepping::advance`] returned.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Arrival {
    /// The communication point is reached.
    Reached,
    /// An event is due at this instant, s; it has not been executed.
    EventDue(f64),
    /// The model terminated the run at this instant, s.
    Ended(f64),
}

/// The state of a run at a communication point.
#[derive(Clone)]
pub struct Snapshot {
    /// The instant, s.
    pub t: f64,
    /// The states.
    pub y: Vec<f64>,
    /// All values.
    pub memory: Vec<f64>,
    /// Histories of delayed variables.
    pub delays: DelayBuffers,
    /// Profiles of transport lines.
    pub transports: TransportLines,
    /// Clocks.
    pub clocks: Clocks,
    /// The selected states.
    pub selection: StateSelector,
}

wire_struct!(Snapshot { t, y, memory, delays, transports, clocks, selection });

/// A run between communication points.
pub struct Stepping<'p> {
    simulation: Simulation<'p, 'static>,
    /// Found by the integrator, which is ahead of the communication point.
    pending: Option<Due>,
    /// The last communication point, s.
    now: f64,
    /// The integrator may be ahead of the communication point.
    may_be_ahead: bool,
    /// Length of the run as announced, s.
    span: f64,
}

impl<'p> Stepping<'p> {
    /// Initializes a run. With `may_be_ahead` inputs must not change.
    pub fn begin(
        program: &'p Program,
        settings: &Settings,
        may_be_ahead: bool,
    ) -> Result<Self, Failure> {
        // Without size: nothing is allocated, nothing is leaked.
        let sink = Box::leak(Box::new(Unrecorded));
        let mut simulation = Simulation::begin(program, settings, &[], &NOWHERE, sink)?;
        // From here on inputs are set, not driven.
        simulation.system.machine.input_signals = InputSignals::default();
        simulation.restart()?;
        let may_be_ahead = may_be_ahead && !simulation.system.machine.has_history();
        let now = settings.start;
        let span = settings.stop - settings.start;
        Ok(Stepping { simulation, pending: None, now, may_be_ahead, span })
    }

    /// The machine; between [`Stepping::evaluate`] and the next call that advances the run it holds the values
    /// at the communication point.
    pub fn machine(&mut self) -> &mut Machine<'p> {
        &mut self.simulation.system.machine
    }

    /// The last communication point, s.
    pub fn now(&self) -> f64 {
        self.now
    }

    /// Evaluates all variables at the communication point.
    pub fn evaluate(&mut self) -> Result<(), Failure> {
        // After an ordinary step `y` holds the states of the last row of the grid, those of the stepper are meant; after
        // the event that ends the run the stepper is not started again.
        let is_at_event = self.simulation.ended || self.simulation.stepper.t() != self.now;
        if self.simulation.t == self.now && self.pending.is_none() && is_at_event {
            let y = self.simulation.y.clone();
            let evaluated = self.simulation.system.evaluate_all(self.now, &y);
            if evaluated.is_ok() {
                return Ok(());
            }
        }
        let now = self.now;
        self.simulation.evaluate_at(now)
    }

    /// Advances to `target`. `stop_at_events` returns before an event is executed; call
    /// [`Stepping::execute_event`] then.
    pub fn advance(&mut self, target: f64, stop_at_events: bool) -> Result<Arrival, Failure> {
        let simulation = &mut self.simulation;
        simulation.limit = if self.may_be_ahead { f64::INFINITY } else { target };
        // The end of the run is not known: it is always ahead.
        simulation.stop = simulation.stop.max(target + 0.02 * self.span);
        loop {
            if simulation.ended {
                self.now = simulation.t;
                return Ok(Arrival::Ended(simulation.t));
            }
            let due = match self.pending.take() {
                Some(due) => due,
                None if simulation.t >= target => break,
                None => simulation.step_once()?,
            };
            let (at, is_event) = match due {
                Due::Event(at, _) | Due::Breakpoint(at, _) => (at, true),
                Due::Nothing(at) => (at, false),
            };
            if at > target {
                self.pending = Some(due);
                break;
            }
            if is_event && stop_at_events {
                self.pending = Some(due);
                self.now = at;
                return Ok(Arrival::EventDue(at));
            }
            simulation.conclude(due)?;
        }
        self.now = target;
        Ok(Arrival::Reached)
    }

    /// Executes the event that is due at the communication point, or iterates there because inputs have
    /// changed.
    pub fn execute_event(&mut self) -> Result<(), Failure> {
        match self.pending.take() {
            Some(due @ (Due::Event(at, _) | Due::Breakpoint(at, _))) if at == self.now => {
                self.simulation.conclude(due)
            }
            pending => {
                if let Some(Due::Nothing(_)) | None = pending
                    && self.simulation.stepper.t() == self.now
                    && self.simulation.t < self.now
                {
                    self.simulation.conclude(Due::Nothing(self.now))?;
                }
                self.simulation.event(self.now, Cause::Time)
            }
        }
    }

    /// Sets an input at the communication point; [`Stepping::execute_event`] must follow.
    pub fn set_input(&mut self, slot: Slot, value: f64) {
        self.simulation.system.machine.set(slot, value);
    }

    /// Changes a parameter at the communication point, and those that are computed from it;
    /// [`Stepping::execute_event`] must follow.
    pub fn set_parameter(&mut self, v: VarId, value: f64) -> Result<(), Failure> {
        // The integrator may be ahead, where the parameter has its last value.
        let here = self.save()?;
        self.restore(&here)?;
        let machine = &mut self.simulation.system.machine;
        machine.set_parameter(v, value);
        let computed = machine.run(&machine.program.tapes.parameters);
        computed.map_err(|fault| of_fault(&self.simulation.system.machine, fault, self.now))
    }

    /// The next time event, s; infinity if there is none.
    pub fn next_time_event(&self) -> f64 {
        self.simulation.clocks.next_instant(&self.simulation.system.machine, self.now)
    }

    /// The message of the `terminate` that ended the run.
    pub fn terminated(&self) -> Option<&str> {
        self.simulation.statistics.terminated.as_deref()
    }

    /// Number of events so far.
    pub fn events(&self) -> u64 {
        self.simulation.statistics.state_events + self.simulation.statistics.time_events
    }

    /// Warnings since the last call.
    pub fn take_warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.simulation.statistics.warnings)
    }

    /// The state at the communication point.
    pub fn save(&mut self) -> Result<Snapshot, Failure> {
        self.evaluate()?;
        let simulation = &self.simulation;
        let machine = &simulation.system.machine;
        Ok(Snapshot {
            t: self.now,
            y: machine.states().to_vec(),
            memory: machine.memory.clone(),
            delays: machine.delays.clone(),
            transports: machine.transports.clone(),
            clocks: simulation.clocks.clone(),
            selection: simulation.selection.clone(),
        })
    }

    /// Continues from a saved state.
    pub fn restore(&mut self, saved: &Snapshot) -> Result<(), Failure> {
        let simulation = &mut self.simulation;
        let machine = &mut simulation.system.machine;
        machine.memory.clone_from(&saved.memory);
        machine.delays = saved.delays.clone();
        machine.transports = saved.transports.clone();
        machine.fault = None;
        simulation.system.sliding = None;
        simulation.clocks = saved.clocks.clone();
        simulation.selection = saved.selection.clone();
        simulation.t = saved.t;
        let n = simulation.program.order();
        simulation.y[..n].copy_from_slice(&saved.y);
        simulation.ended = false;
        simulation.accumulation = None;
        // Rows before this point are those of another run.
        while simulation.recorder.due(saved.t, true).is_some() {
            simulation.recorder.advance();
        }
        self.pending = None;
        self.now = saved.t;
        let (t, y) = (saved.t, simulation.y.clone());
        let evaluated = simulation.system.evaluate_all(t, &y);
        evaluated.map_err(|f| of_fault(&simulation.system.machine, f, t))?;
        simulation.restart()
    }
}
