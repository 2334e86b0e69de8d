//! FMI 3.0.2.

// The names and the numbers of arguments are those of the standard.
#![allow(non_snake_case, clippy::too_many_arguments)]

use std::ffi::{c_char, c_int, c_void};

use mocc::fmu::exchange::count_indicators;
use mocc::fmu::instance::{Kind, Refusal};
use mocc::ir::expr::Type;
use mocc::simulate::stepping::Arrival;

use crate::component::{
    Logger, Logger3, OK, folder, free, free_state, get_numbers, get_strings, guarded, instantiate,
    places_at, put, read_state, restore_state, save_state, set_numbers, state_size, values_at,
    write_state,
};
use crate::second::{copy, set_states};

fn is_real(ty: Type) -> bool {
    ty == Type::Real
}

fn is_integer(ty: Type) -> bool {
    ty == Type::Integer
}

fn is_enumeration(ty: Type) -> bool {
    matches!(ty, Type::Enumeration(_))
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

/// Types that no variable of a model has.
macro_rules! absent {
    ($($get:ident $set:ident $ty:ty;)*) => {
        functions! { $(
            /// No variable has this type.
            $get(c, _vr: *const u32, n: usize, _values: *mut $ty, _m: usize) none(c, n);
            /// No variable has this type.
            $set(c, _vr: *const u32, n: usize, _values: *const $ty, _m: usize) none(c, n);
        )* }
    };
}

fn none(c: *mut c_void, n: usize) -> c_int {
    guarded(c, |_| match n {
        0 => Ok(()),
        _ => Err(Refusal::of("no variable of the model has this type")),
    })
}

absent! {
    fmi3GetFloat32 fmi3SetFloat32 f32;
    fmi3GetInt8 fmi3SetInt8 i8;
    fmi3GetUInt8 fmi3SetUInt8 u8;
    fmi3GetInt16 fmi3SetInt16 i16;
    fmi3GetUInt16 fmi3SetUInt16 u16;
    fmi3GetUInt32 fmi3SetUInt32 u32;
    fmi3GetUInt64 fmi3SetUInt64 u64;
}

/// The version.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

fn logger(function: Option<Logger3>, environment: *mut c_void) -> Logger {
    function.map_or(Logger::Silent, |function| Logger::Third(function, environment))
}

/// A new instance for Model Exchange.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    logging: bool,
    environment: *mut c_void,
    log: Option<Logger3>,
) -> *mut c_void {
    let log = logger(log, environment);
    instantiate(name, token, folder(resources), (Kind::Exchange, false), log, logging)
}

/// A new instance for Co-Simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateCoSimulation(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    logging: bool,
    events: bool,
    early_return: bool,
    _intermediate: *const u32,
    _count: usize,
    environment: *mut c_void,
    log: Option<Logger3>,
    _update: *const c_void,
) -> *mut c_void {
    let log = logger(log, environment);
    // Without early return a step cannot end at an event within it.
    let kind = Kind::Stepping { events: events && early_return };
    instantiate(name, token, folder(resources), (kind, early_return), log, logging)
}

/// Scheduled Execution is not offered.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _environment: *mut c_void,
    _log: Option<Logger3>,
    _update: *const c_void,
    _lock: *const c_void,
    _unlock: *const c_void,
) -> *mut c_void {
    std::ptr::null_mut()
}

/// Frees an instance.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeInstance(c: *mut c_void) {
    free(c);
}

fn refused(c: *mut c_void, what: &str) -> c_int {
    guarded(c, |_| Err(Refusal::of(format!("{what} are not part of the model"))))
}

functions! {
    /// Chooses what is logged.
    fmi3SetDebugLogging(c, on: bool, n: usize, categories: *const *const c_char) guarded(c, |component| {
        component.log_only(on, values_at(categories, n));
        Ok(())
    });
    /// See FMI.
    fmi3EnterInitializationMode(
        c, has_tolerance: bool, tolerance: f64, start: f64, has_stop: bool, stop: f64
    ) guarded(c, |component| {
        component.reached = start;
        component.with(|instance| {
            let tolerance = (has_tolerance && tolerance > 0.0).then_some(tolerance);
            instance.set_up(tolerance, start, has_stop.then_some(stop))?;
            instance.enter_initialization()
        })
    });
    /// See FMI.
    fmi3ExitInitializationMode(c) guarded(c, |component| component.with(|i| i.exit_initialization()));
    /// See FMI.
    fmi3EnterEventMode(c) guarded(c, |component| component.with(|i| i.enter_event_mode()));
    /// See FMI.
    fmi3Terminate(c) guarded(c, |component| {
        component.with(|i| i.terminate());
        Ok(())
    });
    /// See FMI.
    fmi3Reset(c) guarded(c, |component| {
        component.ended = false;
        component.with(|i| i.reset());
        Ok(())
    });
    /// See FMI.
    fmi3GetFloat64(c, vr: *const u32, n: usize, values: *mut f64, m: usize)
        get_numbers(c, values_at(vr, n), places_at(values, m), is_real, |x| x);
    /// See FMI.
    fmi3SetFloat64(c, vr: *const u32, n: usize, values: *const f64, m: usize)
        set_numbers(c, values_at(vr, n), values_at(values, m), is_real, |x| x);
    /// See FMI.
    fmi3GetInt32(c, vr: *const u32, n: usize, values: *mut i32, m: usize)
        get_numbers(c, values_at(vr, n), places_at(values, m), is_integer, |x| x as i32);
    /// See FMI.
    fmi3SetInt32(c, vr: *const u32, n: usize, values: *const i32, m: usize)
        set_numbers(c, values_at(vr, n), values_at(values, m), is_integer, f64::from);
    /// Enumerations.
    fmi3GetInt64(c, vr: *const u32, n: usize, values: *mut i64, m: usize)
        get_numbers(c, values_at(vr, n), places_at(values, m), is_enumeration, |x| x as i64);
    /// Enumerations.
    fmi3SetInt64(c, vr: *const u32, n: usize, values: *const i64, m: usize)
        set_numbers(c, values_at(vr, n), values_at(values, m), is_enumeration, |x| x as f64);
    /// See FMI.
    fmi3GetBoolean(c, vr: *const u32, n: usize, values: *mut bool, m: usize)
        get_numbers(c, values_at(vr, n), places_at(values, m), is_boolean, |x| x != 0.0);
    /// See FMI.
    fmi3SetBoolean(c, vr: *const u32, n: usize, values: *const bool, m: usize)
        set_numbers(c, values_at(vr, n), values_at(values, m), is_boolean, |x| f64::from(u8::from(x)));
    /// See FMI.
    fmi3GetString(c, vr: *const u32, n: usize, values: *mut *const c_char, m: usize)
        get_strings(c, values_at(vr, n), places_at(values, m));
    /// Strings are fixed when a model is exported.
    fmi3SetString(c, _vr: *const u32, n: usize, _values: *const *const c_char, _m: usize)
        guarded(c, |_| match n {
            0 => Ok(()),
            _ => Err(Refusal::of("strings of the model cannot be set")),
        });
    /// No variable has this type.
    fmi3GetBinary(
        c, _vr: *const u32, n: usize, _sizes: *mut usize, _values: *mut *const u8, _m: usize
    ) none(c, n);
    /// No variable has this type.
    fmi3SetBinary(
        c, _vr: *const u32, n: usize, _sizes: *const usize, _values: *const *const u8, _m: usize
    ) none(c, n);
    /// No variable has this type.
    fmi3GetClock(c, _vr: *const u32, n: usize, _values: *mut bool) none(c, n);
    /// No variable has this type.
    fmi3SetClock(c, _vr: *const u32, n: usize, _values: *const bool) none(c, n);
    /// The model description holds the dependencies.
    fmi3GetNumberOfVariableDependencies(c, _vr: u32, _n: *mut usize)
        refused(c, "dependencies at run time");
    /// The model description holds the dependencies.
    fmi3GetVariableDependencies(
        c, _vr: u32, _own: *mut usize, _on: *mut u32, _elements: *mut usize, _kinds: *mut c_int, _n: usize
    ) refused(c, "dependencies at run time");
    /// See FMI.
    fmi3GetFMUState(c, state: *mut *mut c_void) save_state(c, state);
    /// See FMI.
    fmi3SetFMUState(c, state: *mut c_void) restore_state(c, state);
    /// See FMI.
    fmi3FreeFMUState(c, state: *mut *mut c_void) free_state(c, state);
    /// See FMI.
    fmi3SerializedFMUStateSize(c, state: *mut c_void, size: *mut usize) state_size(c, state, size);
    /// See FMI.
    fmi3SerializeFMUState(c, state: *mut c_void, bytes: *mut u8, size: usize)
        write_state(c, state, bytes, size);
    /// See FMI.
    fmi3DeserializeFMUState(c, bytes: *const u8, size: usize, state: *mut *mut c_void)
        read_state(c, bytes, size, state);
    /// See FMI.
    fmi3GetDirectionalDerivative(
        c, unknowns: *const u32, m: usize, knowns: *const u32, n: usize, seed: *const f64, seeds: usize,
        out: *mut f64, outs: usize
    ) guarded(c, |component| component.with(|instance| {
        let (unknowns, knowns) = (values_at(unknowns, m), values_at(knowns, n));
        instance.directional(unknowns, knowns, values_at(seed, seeds), places_at(out, outs))
    }));
    /// See FMI.
    fmi3GetAdjointDerivative(
        c, unknowns: *const u32, m: usize, knowns: *const u32, n: usize, seed: *const f64, seeds: usize,
        out: *mut f64, outs: usize
    ) guarded(c, |component| component.with(|instance| {
        let (unknowns, knowns) = (values_at(unknowns, m), values_at(knowns, n));
        instance.adjoint(unknowns, knowns, values_at(seed, seeds), places_at(out, outs))
    }));
    /// There are no structural parameters.
    fmi3EnterConfigurationMode(c) guarded(c, |_| Ok(()));
    /// There are no structural parameters.
    fmi3ExitConfigurationMode(c) guarded(c, |_| Ok(()));
    /// There are no clocks.
    fmi3GetIntervalDecimal(c, _vr: *const u32, n: usize, _x: *mut f64, _q: *mut c_int) none(c, n);
    /// There are no clocks.
    fmi3GetIntervalFraction(
        c, _vr: *const u32, n: usize, _x: *mut u64, _r: *mut u64, _q: *mut c_int
    ) none(c, n);
    /// There are no clocks.
    fmi3GetShiftDecimal(c, _vr: *const u32, n: usize, _x: *mut f64) none(c, n);
    /// There are no clocks.
    fmi3GetShiftFraction(c, _vr: *const u32, n: usize, _x: *mut u64, _r: *mut u64) none(c, n);
    /// There are no clocks.
    fmi3SetIntervalDecimal(c, _vr: *const u32, n: usize, _x: *const f64) none(c, n);
    /// There are no clocks.
    fmi3SetIntervalFraction(c, _vr: *const u32, n: usize, _x: *const u64, _r: *const u64) none(c, n);
    /// There are no clocks.
    fmi3SetShiftDecimal(c, _vr: *const u32, n: usize, _x: *const f64) none(c, n);
    /// There are no clocks.
    fmi3SetShiftFraction(c, _vr: *const u32, n: usize, _x: *const u64, _r: *const u64) none(c, n);
    /// Discrete states are evaluated when they are updated.
    fmi3EvaluateDiscreteStates(c) guarded(c, |_| Ok(()));
    /// See FMI.
    fmi3UpdateDiscreteStates(
        c, needed: *mut bool, terminate: *mut bool, nominals: *mut bool, values: *mut bool,
        next_defined: *mut bool, next: *mut f64
    ) guarded(c, |component| {
        let update = component.with(|i| i.update())?;
        if let Some(text) = &update.terminated {
            component.say(OK, "logEvents", &format!("the model ended the run: {text}"));
        }
        put(needed, false);
        put(terminate, update.terminated.is_some());
        put(nominals, false);
        put(values, update.states_changed);
        put(next_defined, update.next_time.is_some());
        put(next, update.next_time.unwrap_or(0.0));
        Ok(())
    });
    /// See FMI.
    fmi3EnterContinuousTimeMode(c) guarded(c, |component| component.with(|i| i.enter_continuous_mode()));
    /// See FMI.
    fmi3CompletedIntegratorStep(c, _final: bool, event: *mut bool, terminate: *mut bool)
        guarded(c, |component| {
            let due = component.with(|i| i.complete_step())?;
            put(event, due);
            put(terminate, false);
            Ok(())
        });
    /// See FMI.
    fmi3SetTime(c, t: f64) guarded(c, |component| component.with(|i| {
        i.exchange()?.set_time(t);
        Ok(())
    }));
    /// See FMI.
    fmi3SetContinuousStates(c, x: *const f64, n: usize)
        guarded(c, |component| component.with(|i| set_states(i.exchange()?, values_at(x, n))));
    /// See FMI.
    fmi3GetContinuousStateDerivatives(c, dx: *mut f64, n: usize)
        guarded(c, |component| component.with(|i| Ok(i.exchange()?.derivatives(places_at(dx, n))?)));
    /// See FMI.
    fmi3GetEventIndicators(c, z: *mut f64, n: usize)
        guarded(c, |component| component.with(|i| Ok(i.exchange()?.indicators(places_at(z, n))?)));
    /// See FMI.
    fmi3GetContinuousStates(c, x: *mut f64, n: usize) guarded(c, |component| component.with(|i| {
        copy(i.exchange()?.states(), places_at(x, n))
    }));
    /// See FMI.
    fmi3GetNominalsOfContinuousStates(c, x: *mut f64, n: usize) guarded(c, |component| component.with(|i| {
        copy(&i.exchange()?.nominals(), places_at(x, n))
    }));
    /// See FMI.
    fmi3GetNumberOfEventIndicators(c, n: *mut usize) guarded(c, |component| {
        put(n, component.with(|i| count_indicators(i.program())));
        Ok(())
    });
    /// See FMI.
    fmi3GetNumberOfContinuousStates(c, n: *mut usize) guarded(c, |component| {
        put(n, component.with(|i| i.program().order()));
        Ok(())
    });
    /// See FMI.
    fmi3EnterStepMode(c) guarded(c, |component| component.with(|i| i.enter_step_mode()));
    /// Derivatives of outputs are not provided.
    fmi3GetOutputDerivatives(
        c, _vr: *const u32, n: usize, _orders: *const i32, _values: *mut f64, _m: usize
    ) none(c, n);
    /// See FMI.
    fmi3DoStep(
        c, from: f64, size: f64, _final: bool, event: *mut bool, terminate: *mut bool, early: *mut bool,
        reached: *mut f64
    ) guarded(c, |component| {
        let arrival = component.with(|instance| instance.step(from, size))?;
        let (at, is_event, ended) = match arrival {
            Arrival::Reached => (from + size, false, false),
            Arrival::EventDue(at) => (at, true, false),
            Arrival::Ended(at) => (at, false, true),
        };
        if ended {
            let message = component.with(|instance| instance.terminated().map(str::to_owned));
            let text = format!("the model ended the run: {}", message.unwrap_or_default());
            component.say(OK, "logEvents", &text);
        }
        component.reached = at;
        put(event, is_event);
        put(terminate, ended);
        // A model that has ended says so in any case.
        put(early, component.returns_early(from + size));
        put(reached, at);
        Ok(())
    });
    /// Scheduled Execution is not offered.
    fmi3ActivateModelPartition(c, _clock: u32, _t: f64) refused(c, "model partitions");
}
