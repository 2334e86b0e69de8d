//! FMI 2.0.5.

// The names and the numbers of arguments are those of the standard.
#![allow(non_snake_case, clippy::too_many_arguments)]

use std::ffi::{c_char, c_int, c_void};

use mocc::fmu::instance::{Kind, Refusal};
use mocc::ir::expr::Type;
use mocc::simulate::stepping::Arrival;

use crate::component::{
    Component, DISCARD, ERROR, Logger, Logger2, OK, folder, free, free_state, get_numbers,
    get_strings, guarded, instantiate, places_at, put, read_state, restore_state, save_state,
    set_numbers, state_size, values_at, write_state,
};

/// Callbacks of the importer.
#[repr(C)]
pub struct Callbacks {
    logger: Option<Logger2>,
    allocate: *const c_void,
    free: *const c_void,
    finished: *const c_void,
    environment: *mut c_void,
}

/// Result of an event.
#[repr(C)]
pub struct EventInfo {
    update_needed: c_int,
    terminate: c_int,
    nominals_changed: c_int,
    values_changed: c_int,
    next_defined: c_int,
    next: f64,
}

fn is_real(ty: Type) -> bool {
    ty == Type::Real
}

fn is_whole(ty: Type) -> bool {
    matches!(ty, Type::Integer | Type::Enumeration(_))
}

fn is_boolean(ty: Type) -> bool {
    ty == Type::Boolean
}

/// Declares C functions that have a pointer to a component first.
macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident($c:ident $(, $arg:ident: $ty:ty)*) $body:expr;)*) => {
        $($(#[$doc])*
        #[unsafe(no_mangle)]
        pub extern "C" fn $name($c: *mut c_void $(, $arg: $ty)*) -> c_int {
            $body
        })*
    };
}

/// The platform.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// The version.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// A new instance.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    token: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    logging: c_int,
) -> *mut c_void {
    let logger = match values_at(callbacks, 1).first() {
        Some(Callbacks { logger: Some(logger), environment, .. }) => {
            Logger::Second(*logger, *environment)
        }
        _ => Logger::Silent,
    };
    let kind = if kind == 0 { Kind::Exchange } else { Kind::Stepping { events: false } };
    instantiate(name, token, folder(resources), (kind, false), logger, logging != 0)
}

/// Frees an instance.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(c: *mut c_void) {
    free(c);
}

/// Makes a step; the status may be that the model has ended.
fn step(component: &mut Component, from: f64, size: f64) -> Result<bool, Refusal> {
    let arrival = component.with(|instance| instance.step(from, size))?;
    match arrival {
        Arrival::Reached => component.reached = from + size,
        Arrival::EventDue(at) => component.reached = at,
        Arrival::Ended(at) => {
            component.reached = at;
            component.ended = true;
            let message = component.with(|instance| instance.terminated().map(str::to_owned));
            let text = format!("the model ended the run: {}", message.unwrap_or_default());
            component.say(OK, "logEvents", &text);
        }
    }
    Ok(component.ended)
}

functions! {
    /// Chooses what is logged.
    fmi2SetDebugLogging(c, on: c_int, n: usize, categories: *const *const c_char) guarded(c, |component| {
        component.log_only(on != 0, values_at(categories, n));
        Ok(())
    });
    /// Announces the run.
    fmi2SetupExperiment(c, has_tolerance: c_int, tolerance: f64, start: f64, has_stop: c_int, stop: f64)
        guarded(c, |component| {
            component.reached = start;
            component.with(|instance| {
                let tolerance = (has_tolerance != 0 && tolerance > 0.0).then_some(tolerance);
                instance.set_up(tolerance, start, (has_stop != 0).then_some(stop))
            })
        });
    /// See FMI.
    fmi2EnterInitializationMode(c) guarded(c, |component| component.with(|i| i.enter_initialization()));
    /// See FMI.
    fmi2ExitInitializationMode(c) guarded(c, |component| component.with(|i| i.exit_initialization()));
    /// See FMI.
    fmi2Terminate(c) guarded(c, |component| {
        component.with(|i| i.terminate());
        Ok(())
    });
    /// See FMI.
    fmi2Reset(c) guarded(c, |component| {
        component.ended = false;
        component.with(|i| i.reset());
        Ok(())
    });
    /// See FMI.
    fmi2GetReal(c, vr: *const u32, n: usize, values: *mut f64)
        get_numbers(c, values_at(vr, n), places_at(values, n), is_real, |x| x);
    /// See FMI.
    fmi2GetInteger(c, vr: *const u32, n: usize, values: *mut c_int)
        get_numbers(c, values_at(vr, n), places_at(values, n), is_whole, |x| x as c_int);
    /// See FMI.
    fmi2GetBoolean(c, vr: *const u32, n: usize, values: *mut c_int)
        get_numbers(c, values_at(vr, n), places_at(values, n), is_boolean, |x| c_int::from(x != 0.0));
    /// See FMI.
    fmi2GetString(c, vr: *const u32, n: usize, values: *mut *const c_char)
        get_strings(c, values_at(vr, n), places_at(values, n));
    /// See FMI.
    fmi2SetReal(c, vr: *const u32, n: usize, values: *const f64)
        set_numbers(c, values_at(vr, n), values_at(values, n), is_real, |x| x);
    /// See FMI.
    fmi2SetInteger(c, vr: *const u32, n: usize, values: *const c_int)
        set_numbers(c, values_at(vr, n), values_at(values, n), is_whole, f64::from);
    /// See FMI.
    fmi2SetBoolean(c, vr: *const u32, n: usize, values: *const c_int)
        set_numbers(c, values_at(vr, n), values_at(values, n), is_boolean, |x| f64::from(u8::from(x != 0)));
    /// Strings are fixed when a model is exported.
    fmi2SetString(c, _vr: *const u32, n: usize, _values: *const *const c_char) guarded(c, |_| match n {
        0 => Ok(()),
        _ => Err(Refusal::of("strings of the model cannot be set")),
    });
    /// See FMI.
    fmi2GetFMUstate(c, state: *mut *mut c_void) save_state(c, state);
    /// See FMI.
    fmi2SetFMUstate(c, state: *mut c_void) restore_state(c, state);
    /// See FMI.
    fmi2FreeFMUstate(c, state: *mut *mut c_void) free_state(c, state);
    /// See FMI.
    fmi2SerializedFMUstateSize(c, state: *mut c_void, size: *mut usize) state_size(c, state, size);
    /// See FMI.
    fmi2SerializeFMUstate(c, state: *mut c_void, bytes: *mut u8, size: usize)
        write_state(c, state, bytes, size);
    /// See FMI.
    fmi2DeSerializeFMUstate(c, bytes: *const u8, size: usize, state: *mut *mut c_void)
        read_state(c, bytes, size, state);
    /// See FMI.
    fmi2GetDirectionalDerivative(
        c, unknowns: *const u32, m: usize, knowns: *const u32, n: usize, seed: *const f64, out: *mut f64
    ) guarded(c, |component| component.with(|instance| {
        let (unknowns, knowns) = (values_at(unknowns, m), values_at(knowns, n));
        instance.directional(unknowns, knowns, values_at(seed, n), places_at(out, m))
    }));
    /// See FMI.
    fmi2EnterEventMode(c) guarded(c, |component| component.with(|i| i.enter_event_mode()));
    /// See FMI.
    fmi2NewDiscreteStates(c, info: *mut EventInfo) guarded(c, |component| {
        let update = component.with(|i| i.update())?;
        if let Some(text) = &update.terminated {
            component.say(OK, "logEvents", &format!("the model ended the run: {text}"));
        }
        put(info, EventInfo {
            update_needed: 0,
            terminate: c_int::from(update.terminated.is_some()),
            nominals_changed: 0,
            values_changed: c_int::from(update.states_changed),
            next_defined: c_int::from(update.next_time.is_some()),
            next: update.next_time.unwrap_or(0.0),
        });
        Ok(())
    });
    /// See FMI.
    fmi2EnterContinuousTimeMode(c) guarded(c, |component| component.with(|i| i.enter_continuous_mode()));
    /// See FMI.
    fmi2CompletedIntegratorStep(c, _final: c_int, event: *mut c_int, terminate: *mut c_int)
        guarded(c, |component| {
            let due = component.with(|i| i.complete_step())?;
            put(event, c_int::from(due));
            put(terminate, 0);
            Ok(())
        });
    /// See FMI.
    fmi2SetTime(c, t: f64) guarded(c, |component| component.with(|i| {
        i.exchange()?.set_time(t);
        Ok(())
    }));
    /// See FMI.
    fmi2SetContinuousStates(c, x: *const f64, n: usize)
        guarded(c, |component| component.with(|i| set_states(i.exchange()?, values_at(x, n))));
    /// See FMI.
    fmi2GetDerivatives(c, dx: *mut f64, n: usize)
        guarded(c, |component| component.with(|i| Ok(i.exchange()?.derivatives(places_at(dx, n))?)));
    /// See FMI.
    fmi2GetEventIndicators(c, z: *mut f64, n: usize)
        guarded(c, |component| component.with(|i| Ok(i.exchange()?.indicators(places_at(z, n))?)));
    /// See FMI.
    fmi2GetContinuousStates(c, x: *mut f64, n: usize) guarded(c, |component| component.with(|i| {
        copy(i.exchange()?.states(), places_at(x, n))
    }));
    /// See FMI.
    fmi2GetNominalsOfContinuousStates(c, x: *mut f64, n: usize) guarded(c, |component| component.with(|i| {
        copy(&i.exchange()?.nominals(), places_at(x, n))
    }));
    /// Inputs are held between communication points.
    fmi2SetRealInputDerivatives(
        c, _vr: *const u32, n: usize, _order: *const c_int, _values: *const f64
    ) guarded(c, |_| match n {
        0 => Ok(()),
        _ => Err(Refusal::of("inputs are not interpolated")),
    });
    /// See FMI.
    fmi2GetRealOutputDerivatives(
        c, _vr: *const u32, n: usize, _order: *const c_int, _values: *mut f64
    ) guarded(c, |_| match n {
        0 => Ok(()),
        _ => Err(Refusal::of("derivatives of outputs are not provided")),
    });
    /// See FMI.
    fmi2DoStep(c, from: f64, size: f64, _final: c_int) {
        let mut ended = false;
        let status = guarded(c, |component| {
            ended = step(component, from, size)?;
            Ok(())
        });
        if status == OK && ended { DISCARD } else { status }
    };
    /// Steps are complete when they return.
    fmi2CancelStep(_c) ERROR;
    /// See FMI.
    fmi2GetStatus(_c, _kind: c_int, _value: *mut c_int) DISCARD;
    /// See FMI.
    fmi2GetRealStatus(c, kind: c_int, value: *mut f64) guarded(c, |component| match kind {
        2 => {
            put(value, component.reached);
            Ok(())
        }
        _ => Err(Refusal::of("this status is not a Real")),
    });
    /// See FMI.
    fmi2GetIntegerStatus(_c, _kind: c_int, _value: *mut c_int) DISCARD;
    /// See FMI.
    fmi2GetBooleanStatus(c, kind: c_int, value: *mut c_int) guarded(c, |component| match kind {
        3 => {
            put(value, c_int::from(component.ended));
            Ok(())
        }
        _ => Err(Refusal::of("this status is not a Boolean")),
    });
    /// See FMI.
    fmi2GetStringStatus(_c, _kind: c_int, _value: *mut *const c_char) DISCARD;
}

/// Sets all states.
pub fn set_states(
    exchange: &mut mocc::fmu::exchange::Exchange<'_>,
    states: &[f64],
) -> Result<(), Refusal> {
    if states.len() != exchange.order() {
        let own = exchange.order();
        return Err(Refusal::of(format!("the model has {own} states, not {}", states.len())));
    }
    exchange.set_states(states);
    Ok(())
}

/// Copies all values.
pub fn copy(from: &[f64], to: &mut [f64]) -> Result<(), Refusal> {
    if from.len() != to.len() {
        return Err(Refusal::of(format!("the model has {} states, not {}", from.len(), to.len())));
    }
    to.copy_from_slice(from);
    Ok(())
}
