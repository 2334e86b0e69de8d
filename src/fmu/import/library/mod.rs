//! The shared library of an FMU, by its C functions. Sole user of `libloading`; only the child process loads one.
//!
//! In: a library and operations in terms of both versions of FMI. Out: their results, or the call that failed with
//! its status and the messages of the FMU.

#![allow(unsafe_code)] // Only here: calls foreign code by the signatures of the standard.

pub mod current_call;
mod log;
pub mod process;
mod python;

use std::ffi::{c_int, c_void};

use libloading::Library;

use self::current_call::CurrentCall;
use self::log::Callbacks;
pub use self::log::messages;

/// Most iterations of one event.
const MOST_ITERATIONS: usize = 10_000;

/// Why the library is of no use.
#[derive(Clone, PartialEq, Debug)]
pub enum Trouble {
    /// It cannot be loaded, or lacks a function.
    NotLoaded(String),
    /// It is written in Python, which cannot be loaded for this reason.
    NeedsPython(String),
    /// It made no instance.
    NotInstantiated,
    /// A call returned a status that is not a success; `discard` may be avoided.
    Failed {
        /// The C function.
        call: &'static str,
        /// The name of the status.
        status: &'static str,
    },
}

/// Result of an event in FMI 2.
#[repr(C)]
#[derive(Default)]
struct EventInfo {
    update_needed: c_int,
    terminate: c_int,
    nominals_changed: c_int,
    values_changed: c_int,
    next_defined: c_int,
    next: f64,
}

/// The outcome of an event iteration.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Updated {
    /// The next time event, s.
    pub next: Option<f64>,
    /// The run ends.
    pub ends: bool,
}

/// An instance of an FMU.
pub struct Instance {
    library: Library,
    third: bool,
    instance: *mut c_void,
    /// Kept, since the FMU may keep a pointer to it.
    _callbacks: Box<Callbacks>,
}

type Status = c_int;

/// The names of statuses, by their number.
fn status_name(status: Status) -> &'static str {
    match status {
        2 => "discard",
        3 => "error",
        4 => "fatal",
        5 => "pending",
        _ => "of an unknown number",
    }
}

fn checked(call: &'static str, status: Status) -> Result<(), Trouble> {
    match status {
        0 | 1 => Ok(()),
        _ => Err(Trouble::Failed { call, status: status_name(status) }),
    }
}

/// Calls a function of the instance that returns a status.
macro_rules! call {
    ($self:ident, $name:literal $(, $arg:expr => $ty:ty)*) => {{
        let name: &'static str = $name;
        // SAFETY: the standard fixes the signature of the function of this name.
        let function = unsafe {
            $self.library.get::<unsafe extern "C" fn(*mut c_void $(, $ty)*) -> Status>(name.as_bytes())
        };
        match function {
            // SAFETY: the instance is alive, and pointers are valid for the length that goes with them.
            Ok(function) => {
                let _call = $crate::fmu::import::library::current_call::CurrentCall::enter(name);
                checked(name, unsafe { function($self.instance $(, $arg)*) })
            }
            Err(why) => Err(Trouble::NotLoaded(why.to_string())),
        }
    }};
}

// They use the macro.
mod instantiate;
mod values;

pub use self::instantiate::keep_loaded;

impl Instance {
    /// Enters the initialization mode.
    pub fn enter_initialization(&self, span: [f64; 3]) -> Result<(), Trouble> {
        let [start, stop, tolerance] = span;
        let has_stop = stop.is_finite();
        if self.third {
            return call!(self, "fmi3EnterInitializationMode",
                true => bool, tolerance => f64, start => f64, has_stop => bool, stop => f64);
        }
        call!(self, "fmi2SetupExperiment",
            1 => c_int, tolerance => f64, start => f64, c_int::from(has_stop) => c_int, stop => f64)?;
        call!(self, "fmi2EnterInitializationMode")
    }

    /// Leaves the initialization mode.
    pub fn exit_initialization(&self) -> Result<(), Trouble> {
        match self.third {
            true => call!(self, "fmi3ExitInitializationMode"),
            false => call!(self, "fmi2ExitInitializationMode"),
        }
    }

    /// Enters the event mode.
    pub fn enter_event_mode(&self) -> Result<(), Trouble> {
        match self.third {
            true => call!(self, "fmi3EnterEventMode"),
            false => call!(self, "fmi2EnterEventMode"),
        }
    }

    /// Iterates the discrete states to their fixed point.
    pub fn update(&self) -> Result<Updated, Trouble> {
        for _ in 0..MOST_ITERATIONS {
            let mut info = EventInfo::default();
            let (again, ends, next) = if self.third {
                let (mut again, mut ends, mut nominals, mut values, mut defined) =
                    (false, false, false, false, false);
                let mut next = 0.0;
                call!(self, "fmi3UpdateDiscreteStates",
                    &mut again => *mut bool, &mut ends => *mut bool, &mut nominals => *mut bool,
                    &mut values => *mut bool, &mut defined => *mut bool, &mut next => *mut f64)?;
                (again, ends, defined.then_some(next))
            } else {
                call!(self, "fmi2NewDiscreteStates", &mut info => *mut EventInfo)?;
                let next = (info.next_defined != 0).then_some(info.next);
                (info.update_needed != 0, info.terminate != 0, next)
            };
            if !again || ends {
                return Ok(Updated { next, ends });
            }
        }
        let call = match self.third {
            true => "fmi3UpdateDiscreteStates",
            false => "fmi2NewDiscreteStates",
        };
        Err(Trouble::Failed { call, status: "again and again that a further iteration is needed" })
    }

    /// Enters the continuous-time mode.
    pub fn enter_continuous_mode(&self) -> Result<(), Trouble> {
        match self.third {
            true => call!(self, "fmi3EnterContinuousTimeMode"),
            false => call!(self, "fmi2EnterContinuousTimeMode"),
        }
    }

    /// Sets the time, s.
    pub fn set_time(&self, t: f64) -> Result<(), Trouble> {
        match self.third {
            true => call!(self, "fmi3SetTime", t => f64),
            false => call!(self, "fmi2SetTime", t => f64),
        }
    }

    /// Sets the continuous states.
    pub fn set_states(&self, x: &[f64]) -> Result<(), Trouble> {
        match (self.third, x.is_empty()) {
            (_, true) => Ok(()),
            (true, _) => call!(self, "fmi3SetContinuousStates",
                x.as_ptr() => *const f64, x.len() => usize),
            (false, _) => call!(self, "fmi2SetContinuousStates",
                x.as_ptr() => *const f64, x.len() => usize),
        }
    }

    /// Gets the continuous states.
    pub fn states(&self, x: &mut [f64]) -> Result<(), Trouble> {
        match (self.third, x.is_empty()) {
            (_, true) => Ok(()),
            (true, _) => call!(self, "fmi3GetContinuousStates",
                x.as_mut_ptr() => *mut f64, x.len() => usize),
            (false, _) => call!(self, "fmi2GetContinuousStates",
                x.as_mut_ptr() => *mut f64, x.len() => usize),
        }
    }

    /// Gets the nominal values of the continuous states.
    pub fn nominals(&self, x: &mut [f64]) -> Result<(), Trouble> {
        match (self.third, x.is_empty()) {
            (_, true) => Ok(()),
            (true, _) => call!(self, "fmi3GetNominalsOfContinuousStates",
                x.as_mut_ptr() => *mut f64, x.len() => usize),
            (false, _) => call!(self, "fmi2GetNominalsOfContinuousStates",
                x.as_mut_ptr() => *mut f64, x.len() => usize),
        }
    }

    /// Gets the derivatives of the continuous states.
    pub fn derivatives(&self, x: &mut [f64]) -> Result<(), Trouble> {
        match (self.third, x.is_empty()) {
            (_, true) => Ok(()),
            (true, _) => call!(self, "fmi3GetContinuousStateDerivatives",
                x.as_mut_ptr() => *mut f64, x.len() => usize),
            (false, _) => call!(self, "fmi2GetDerivatives",
                x.as_mut_ptr() => *mut f64, x.len() => usize),
        }
    }

    /// Gets the event indicators.
    pub fn indicators(&self, z: &mut [f64]) -> Result<(), Trouble> {
        match (self.third, z.is_empty()) {
            (_, true) => Ok(()),
            (true, _) => call!(self, "fmi3GetEventIndicators",
                z.as_mut_ptr() => *mut f64, z.len() => usize),
            (false, _) => call!(self, "fmi2GetEventIndicators",
                z.as_mut_ptr() => *mut f64, z.len() => usize),
        }
    }

    /// Directional derivatives of `unknowns` along one of `knowns`.
    pub fn directional(
        &self,
        unknowns: &[u32],
        known: u32,
        out: &mut [f64],
    ) -> Result<(), Trouble> {
        let seed = 1.0;
        match self.third {
            true => call!(self, "fmi3GetDirectionalDerivative",
                unknowns.as_ptr() => *const u32, unknowns.len() => usize,
                &known => *const u32, 1 => usize, &seed => *const f64, 1 => usize,
                out.as_mut_ptr() => *mut f64, out.len() => usize),
            false => call!(self, "fmi2GetDirectionalDerivative",
                unknowns.as_ptr() => *const u32, unknowns.len() => usize,
                &known => *const u32, 1 => usize, &seed => *const f64,
                out.as_mut_ptr() => *mut f64),
        }
    }

    /// Reports a step; whether the FMU asks for an event, and whether it ends the run.
    pub fn complete_step(&self) -> Result<(bool, bool), Trouble> {
        if self.third {
            let (mut event, mut ends) = (false, false);
            call!(self, "fmi3CompletedIntegratorStep",
                true => bool, &mut event => *mut bool, &mut ends => *mut bool)?;
            return Ok((event, ends));
        }
        let (mut event, mut ends): (c_int, c_int) = (0, 0);
        call!(self, "fmi2CompletedIntegratorStep",
            1 => c_int, &mut event => *mut c_int, &mut ends => *mut c_int)?;
        Ok((event != 0, ends != 0))
    }

    /// Steps from `t` by `size`, s: the instant reached, and whether the FMU ends the run.
    pub fn step(&self, t: f64, size: f64) -> Result<(f64, bool), Trouble> {
        if self.third {
            let (mut event, mut ends, mut early, mut last) = (false, false, false, t);
            call!(self, "fmi3DoStep", t => f64, size => f64, true => bool,
                &mut event => *mut bool, &mut ends => *mut bool, &mut early => *mut bool,
                &mut last => *mut f64)?;
            // The last successful time is of use only if the step ended early.
            return Ok((if early || ends { last } else { t + size }, ends));
        }
        let done = call!(self, "fmi2DoStep", t => f64, size => f64, 1 => c_int);
        match done {
            Ok(()) => Ok((t + size, false)),
            Err(Trouble::Failed { call: _, status: "discard" }) => {
                // FMI 2 says by `discard` that the run ends, or that only a part of the step was made.
                let (mut last, mut terminated) = (t, 0);
                const LAST_SUCCESSFUL_TIME: c_int = 2;
                const TERMINATED: c_int = 3;
                let _ = call!(self, "fmi2GetRealStatus",
                    LAST_SUCCESSFUL_TIME => c_int, &mut last => *mut f64);
                let _ = call!(self, "fmi2GetBooleanStatus",
                    TERMINATED => c_int, &mut terminated => *mut c_int);
                if terminated != 0 || last > t {
                    Ok((last.max(t), terminated != 0))
                } else {
                    done.map(|()| (t, false))
                }
            }
            Err(trouble) => Err(trouble),
        }
    }

    /// Ends the run and frees the instance.
    pub fn end(&self) {
        let _ = match self.third {
            true => call!(self, "fmi3Terminate"),
            false => call!(self, "fmi2Terminate"),
        };
        self.free();
    }

    fn free(&self) {
        let name: &[u8] = if self.third { b"fmi3FreeInstance" } else { b"fmi2FreeInstance" };
        // SAFETY: the signature of the standard; the instance is not used afterwards.
        unsafe {
            let _call = CurrentCall::enter(match self.third {
                true => "fmi3FreeInstance",
                false => "fmi2FreeInstance",
            });
            if let Ok(f) = self.library.get::<unsafe extern "C" fn(*mut c_void)>(name) {
                f(self.instance);
            }
        }
    }
}
