//! The start of a run: parameters, the initial sequence, and the first event iteration.

use crate::ir::dae::Kind;
use crate::ir::expr::VarId;
use crate::ir::program::Slot;
use crate::runtime::machine::Instance;

use super::event::iterate::{Settled, Unsettled, begin, note_actions, remember, settle};
use super::event::time_events::Clocks;
use super::failure::precondition;
use super::homotopy;
use super::settings::Settings;
use super::state_selection::Selection;

/// What went wrong before the run began.
#[derive(Clone, PartialEq, Debug)]
pub enum NoStart {
    /// This can not be set in a run.
    NotAnInput(VarId),
    /// A parameter is not finite.
    Parameter(VarId),
    /// An assertion about parameters is violated.
    Assertion(usize),
    /// The interval of a clock is not positive.
    Clock(usize),
    /// The initial sequence or the first event iteration failed.
    Unsettled(Unsettled),
}

impl From<Unsettled> for NoStart {
    fn from(u: Unsettled) -> Self {
        NoStart::Unsettled(u)
    }
}

/// What a run begins with.
pub type Start = (Clocks, Selection, Settled);

/// Gives every variable its value at the start: from the solution of the simplified system that the model
/// may offer, or from its guesses.
pub fn initialise(instance: &mut Instance<'_>, settings: &Settings) -> Result<Start, NoStart> {
    instance.leaps = false;
    let begun = from_model(instance, settings);
    instance.leaps = true;
    match begun {
        // At last solutions are looked for that are far from all guesses. If there are none, what is told is
        // how the first attempt ended.
        Err(NoStart::Unsettled(_)) => {
            let told = (instance.memory.clone(), instance.fault_memory.clone(), instance.fault);
            initialise_from(instance, settings, &[]).or_else(|_| {
                (instance.memory, instance.fault_memory, instance.fault) = told;
                begun
            })
        }
        begun => begun,
    }
}

/// The start from the simplified system if the model offers one, else from the guesses. Of several
/// solutions the model means the one to which its simplified system leads (Modelica 3.6, section 3.7.4.4).
fn from_model(instance: &mut Instance<'_>, settings: &Settings) -> Result<Start, NoStart> {
    if let Some(continuation) = &instance.program.continuation
        && let Some(guess) = homotopy::follow(continuation, settings)
        && let Ok(start) = initialise_from(instance, settings, &guess)
    {
        return Ok(start);
    }
    initialise_from(instance, settings, &[])
}

/// What assertions and terminations do that act `when initial()`.
fn actions_at_start(instance: &mut Instance<'_>) -> Settled {
    let mut settled = Settled::default();
    instance.said.clear();
    let program = instance.program;
    if program.asserts.iter().all(|a| !a.at_events) && program.terminates.is_empty() {
        return settled;
    }
    // Looked at only: neither values nor their derivatives come from here.
    let (kept, tangents) = (instance.keep(), instance.tangents.take());
    remember(instance);
    if instance.run(&program.event).is_ok() {
        note_actions(instance, &mut settled);
    }
    instance.memory.copy_from_slice(&kept);
    instance.release(kept);
    instance.tangents = tangents;
    settled
}

/// Gives every variable its value at the start, where iterations begin at the guesses for some cells.
pub fn initialise_from(
    instance: &mut Instance<'_>,
    settings: &Settings,
    guess: &[(Slot, f64)],
) -> Result<Start, NoStart> {
    let program = instance.program;
    instance.memory.copy_from_slice(&program.image);
    instance.transports.place(&mut instance.memory);
    for &(v, value) in &settings.parameters {
        if !instance.set_parameter(v, value) {
            return Err(NoStart::NotAnInput(v));
        }
    }
    for &(v, value) in &settings.starts {
        if !instance.set_start(v, value) {
            return Err(NoStart::NotAnInput(v));
        }
    }
    instance.play(&settings.courses, settings.start);
    instance.set(program.layout.time, settings.start);
    instance.set(program.layout.initial, 1.0);
    instance.run(&program.parameters).map_err(Unsettled::Fault)?;
    // A bad parameter is better explained by the model than by what it leads to.
    if let Some(k) = precondition::violated(instance) {
        return Err(NoStart::Assertion(k));
    }
    for (v, variable) in program.blocks.dae.variables.enumerate() {
        if variable.kind == Kind::Parameter && !instance.value(v).is_finite() {
            instance.fault_memory.copy_from_slice(&instance.memory);
            return Err(NoStart::Parameter(v));
        }
    }
    for (k, clock) in program.clocks.iter().enumerate() {
        let interval = instance.get(clock.interval);
        if interval.is_nan() || interval <= 0.0 {
            return Err(NoStart::Clock(k));
        }
    }
    // Start values are the guesses of iterations, and what `pre` is before the first event.
    for &(v, _, start) in &program.layout.starts {
        instance.copy(program.slot(v), start);
    }
    remember(instance);
    for &(slot, value) in guess {
        instance.set(slot, value);
    }
    begin(instance)?;
    let selection = Selection::begin(instance).map_err(Unsettled::Fault)?;
    let at_start = actions_at_start(instance);
    instance.set(program.layout.initial, 0.0);
    let mut clocks = Clocks::new(instance, settings.start);
    clocks.raise(instance, settings.start);
    let settled = settle(instance, &clocks, true)?;
    Ok((clocks, selection, at_start.before(settled)))
}
