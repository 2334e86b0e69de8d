//! Initialization: parameters, the initial equations, and the first event iteration.

use crate::ir::dae::VariableKind;
use crate::ir::expr::VarId;
use crate::ir::program::Slot;
use crate::runtime::machine::Machine;

use super::event::iterate::{
    EventEffects, EventError, collect_actions, iterate, solve_initial, update_pre,
};
use super::event::time_events::Clocks;
use super::failure::precondition;
use super::homotopy;
use super::settings::Settings;
use super::state_selection::StateSelector;

/// Why a run could not be initialized.
#[derive(Clone, PartialEq, Debug)]
pub enum StartError {
    /// The variable is not an input of the program.
    NotAnInput(VarId),
    /// A parameter is not finite.
    Parameter(VarId),
    /// An assertion about parameters is violated.
    Assertion(usize),
    /// The interval of a clock is not positive.
    Clock(usize),
    /// A clock has too many ticks in the run: so many.
    Ticks(usize, f64),
    /// The value of a delayed variable before the start depends on itself, and was not found.
    History(VarId),
    /// The initial sequence or the first event iteration failed.
    Event(EventError),
}

impl From<EventError> for StartError {
    fn from(u: EventError) -> Self {
        StartError::Event(u)
    }
}

/// Result of the initialization.
pub type Start = (Clocks, StateSelector, EventEffects);

/// Initializes all variables: by homotopy from a simplified system if the model provides one, else
/// from the start values.
pub fn initialise(machine: &mut Machine<'_>, settings: &Settings) -> Result<Start, StartError> {
    machine.branch_switch = false;
    let started = from_homotopy(machine, settings);
    let Err(StartError::Event(_)) = started else {
        machine.branch_switch = true;
        return started;
    };
    // If nothing is found, the failure of the first attempt is reported.
    let saved = (machine.memory.clone(), machine.fault_memory.clone(), machine.fault);
    let differs = !machine.program.tapes.initial_by_states.is_empty();
    let mut found = if differs { from_states(machine, settings) } else { started.clone() };
    // Finally, solutions far from the start values are allowed.
    machine.branch_switch = true;
    if found.is_err() {
        found = from_homotopy(machine, settings);
    }
    if found.is_err() && differs {
        found = from_states(machine, settings);
    }
    found.or_else(|_| {
        (machine.memory, machine.fault_memory, machine.fault) = saved;
        started
    })
}

/// Initializes by the sequence whose loops are torn at states.
fn from_states(machine: &mut Machine<'_>, settings: &Settings) -> Result<Start, StartError> {
    machine.starts_by_states = true;
    let started = from_homotopy(machine, settings);
    machine.starts_by_states = false;
    started
}

/// Initializes by homotopy if the model provides a simplified system, else from the start values.
/// Among several solutions, the one reached by homotopy is intended (Modelica specification 3.6,
/// section 3.7.4.4).
fn from_homotopy(machine: &mut Machine<'_>, settings: &Settings) -> Result<Start, StartError> {
    if let Some(continuation) = &machine.program.continuation
        && let Some(guess) = homotopy::follow(
            continuation,
            settings,
            machine.starts_by_states,
            machine.branch_switch,
        )
        && let Ok(start) = initialise_from(machine, settings, &guess)
    {
        return Ok(start);
    }
    initialise_from(machine, settings, &[])
}

/// Effects of assertions and terminations that are active `when initial()`.
fn initial_actions(machine: &mut Machine<'_>) -> EventEffects {
    let mut effects = EventEffects::default();
    machine.assertion_messages.clear();
    let program = machine.program;
    if program.events.asserts.iter().all(|a| !a.at_events) && program.events.terminates.is_empty() {
        return effects;
    }
    // Evaluate actions only: values and derivatives are restored afterwards.
    let (saved_memory, tangents) = (machine.snapshot(), machine.tangents.take());
    update_pre(machine);
    if machine.run(&program.tapes.event).is_ok() {
        collect_actions(machine, &mut effects);
    }
    machine.memory.copy_from_slice(&saved_memory);
    machine.recycle(saved_memory);
    machine.tangents = tangents;
    effects
}

/// Initializes all variables, with the given guesses for the start of iterations.
pub fn initialise_from(
    machine: &mut Machine<'_>,
    settings: &Settings,
    guess: &[(Slot, f64)],
) -> Result<Start, StartError> {
    let program = machine.program;
    machine.memory.copy_from_slice(&program.image);
    machine.transports.write_slots(&mut machine.memory);
    for &(v, value) in &settings.parameters {
        if !machine.set_parameter(v, value) {
            return Err(StartError::NotAnInput(v));
        }
    }
    for &(v, value) in &settings.starts {
        if !machine.set_start(v, value) {
            return Err(StartError::NotAnInput(v));
        }
    }
    machine.set_input_signals(&settings.courses, settings.start);
    machine.set(program.layout.time, settings.start);
    machine.set(program.layout.initial, 1.0);
    machine.run(&program.tapes.parameters).map_err(EventError::Fault)?;
    machine.input_signals.begin(settings.start, &machine.memory);
    // Check assertions about parameters first: their messages are better than those of
    // consequences.
    if let Some(k) = precondition::violated(machine) {
        return Err(StartError::Assertion(k));
    }
    for (v, variable) in program.blocks.dae.variables.enumerate() {
        if variable.kind == VariableKind::Parameter && !machine.value(v).is_finite() {
            machine.fault_memory.copy_from_slice(&machine.memory);
            return Err(StartError::Parameter(v));
        }
    }
    for (k, clock) in program.events.clocks.iter().enumerate() {
        let interval = machine.get(clock.interval);
        if interval.is_nan() || interval <= 0.0 {
            return Err(StartError::Clock(k));
        }
        let ticks = (settings.stop - settings.start.max(machine.get(clock.start))) / interval;
        if ticks > settings.most_ticks {
            return Err(StartError::Ticks(k, ticks));
        }
    }
    // Start values are the guesses of iterations, and `pre` before the first event.
    for &(v, _, start) in &program.layout.starts {
        machine.copy(program.slot(v), start);
    }
    update_pre(machine);
    // Discrete inputs that are driven have other values than those they start with, and delays are known by now.
    machine.input_signals.write_slots(settings.start, &mut machine.memory);
    for &(slot, value) in guess {
        machine.set(slot, value);
    }
    solve_initial(machine)?;
    let selection = StateSelector::begin(machine).map_err(EventError::Fault)?;
    let at_start = initial_actions(machine);
    machine.set(program.layout.initial, 0.0);
    let mut clocks = Clocks::new(machine, settings.start);
    clocks.raise(machine, settings.start);
    let effects = iterate(machine, &clocks, true)?;
    Ok((clocks, selection, at_start.before(effects)))
}
