//! The shared library of an FMU, by its C functions. Sole user of `libloading`; only the child process calls it.
//!
//! In: a library and operations in terms of both versions of FMI. Out: their results, or the call that failed with
//! its status and the messages of the FMU.

#![allow(unsafe_code)] // Only here: calls foreign code by the signatures of the standard.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr;
use std::sync::Mutex;

use libloading::Library;

use super::description::{Group, Passing};
use super::message::Load;

/// Most messages of the FMU that are kept.
const MOST_MESSAGES: usize = 20;
/// Longest message, bytes.
const LONGEST_MESSAGE: usize = 2000;
/// Most iterations of one event.
const MOST_ITERATIONS: usize = 10_000;

/// The last messages of the FMU; it may send them from any thread.
static MESSAGES: Mutex<Vec<String>> = Mutex::new(Vec::new());

fn keep(text: &str) {
    let Ok(mut messages) = MESSAGES.lock() else { return };
    if messages.len() >= MOST_MESSAGES {
        messages.remove(0);
    }
    messages.push(text.chars().take(LONGEST_MESSAGE).collect());
}

/// The messages since the last call.
pub fn messages() -> Vec<String> {
    MESSAGES.lock().map(|mut all| std::mem::take(&mut *all)).unwrap_or_default()
}

/// Why the library is of no use.
#[derive(Clone, PartialEq, Debug)]
pub enum Trouble {
    /// It cannot be loaded, or lacks a function.
    NotLoaded(String),
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

/// The memory and the logger of FMI 2.
#[repr(C)]
struct Callbacks {
    logger: unsafe extern "C" fn(
        *mut c_void,
        *const c_char,
        c_int,
        *const c_char,
        *const c_char,
        *const c_char,
    ),
    allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free: unsafe extern "C" fn(*mut c_void),
    finished: *const c_void,
    environment: *mut c_void,
}

unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
}

/// The logger of FMI 2 takes the arguments of `printf`. Only a lone `%s` is filled in: the first argument after the
/// format, if there is one, comes like a fixed one on the platforms of the child process.
unsafe extern "C" fn log_second(
    _: *mut c_void,
    _: *const c_char,
    _: c_int,
    _: *const c_char,
    format: *const c_char,
    first: *const c_char,
) {
    if format.is_null() {
        return;
    }
    // SAFETY: the standard promises a string that ends with zero.
    let text = unsafe { CStr::from_ptr(format) }.to_string_lossy();
    if text == "%s" && !first.is_null() {
        // SAFETY: the format says that the argument is such a string.
        keep(&unsafe { CStr::from_ptr(first) }.to_string_lossy());
    } else {
        keep(&text);
    }
}

unsafe extern "C" fn log_third(_: *mut c_void, _: c_int, _: *const c_char, text: *const c_char) {
    if !text.is_null() {
        // SAFETY: the standard promises a string that ends with zero.
        keep(&unsafe { CStr::from_ptr(text) }.to_string_lossy());
    }
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
            Ok(function) => checked(name, unsafe { function($self.instance $(, $arg)*) }),
            Err(why) => Err(Trouble::NotLoaded(why.to_string())),
        }
    }};
}

impl Instance {
    /// Loads the library and makes an instance.
    pub fn new(load: &Load) -> Result<Instance, Trouble> {
        // SAFETY: the user has named the FMU, and its code runs in a process of its own.
        let library = unsafe { Library::new(&load.library) };
        let library = library.map_err(|e| Trouble::NotLoaded(detailed(&e)))?;
        let callbacks = Box::new(Callbacks {
            logger: log_second,
            allocate: calloc,
            free,
            finished: ptr::null(),
            environment: ptr::null_mut(),
        });
        let string = |text: &str| CString::new(text).unwrap_or_default();
        let (name, token) = (string("mocc"), string(&load.token));
        let missing = |e: libloading::Error| Trouble::NotLoaded(detailed(&e));
        let instance = if load.third {
            let folder = format!("{}/", load.resources.trim_end_matches('/'));
            let resources = string(&folder);
            type Exchange = unsafe extern "C" fn(
                *const c_char,
                *const c_char,
                *const c_char,
                bool,
                bool,
                *mut c_void,
                unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char),
            ) -> *mut c_void;
            type Stepping = unsafe extern "C" fn(
                *const c_char,
                *const c_char,
                *const c_char,
                bool,
                bool,
                bool,
                bool,
                *const u32,
                usize,
                *mut c_void,
                unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char),
                *const c_void,
            ) -> *mut c_void;
            let (name, token, resources) = (name.as_ptr(), token.as_ptr(), resources.as_ptr());
            let none = ptr::null_mut();
            // SAFETY: signatures of FMI 3.0; all strings live through the call.
            unsafe {
                if load.stepping {
                    let make =
                        library.get::<Stepping>(b"fmi3InstantiateCoSimulation").map_err(missing)?;
                    make(
                        name,
                        token,
                        resources,
                        false,
                        false,
                        false,
                        false,
                        ptr::null(),
                        0,
                        none,
                        log_third,
                        ptr::null(),
                    )
                } else {
                    let make = library
                        .get::<Exchange>(b"fmi3InstantiateModelExchange")
                        .map_err(missing)?;
                    make(name, token, resources, false, false, none, log_third)
                }
            }
        } else {
            type Make = unsafe extern "C" fn(
                *const c_char,
                c_int,
                *const c_char,
                *const c_char,
                *const Callbacks,
                c_int,
                c_int,
            ) -> *mut c_void;
            let resources = string(&uri(&load.resources));
            let kind = c_int::from(load.stepping);
            // SAFETY: signature of FMI 2.0; strings and callbacks live long enough.
            unsafe {
                let make = library.get::<Make>(b"fmi2Instantiate").map_err(missing)?;
                make(name.as_ptr(), kind, token.as_ptr(), resources.as_ptr(), &*callbacks, 0, 0)
            }
        };
        if instance.is_null() {
            return Err(Trouble::NotInstantiated);
        }
        Ok(Instance { library, third: load.third, instance, _callbacks: callbacks })
    }

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
            if let Ok(f) = self.library.get::<unsafe extern "C" fn(*mut c_void)>(name) {
                f(self.instance);
            }
        }
    }

    /// Gets the values of groups of one type, one after the other.
    pub fn get(
        &self,
        passing: Passing,
        groups: &[Group],
        out: &mut Vec<f64>,
    ) -> Result<(), Trouble> {
        let references: Vec<u32> = groups.iter().map(|g| g.reference).collect();
        let count: usize = groups.iter().map(|g| g.count).sum();
        macro_rules! fetch {
            ($name:literal, $ty:ty, $zero:expr, $convert:expr) => {{
                let mut values: Vec<$ty> = vec![$zero; count];
                call!(self, $name, references.as_ptr() => *const u32, references.len() => usize,
                    values.as_mut_ptr() => *mut $ty, count => usize)?;
                let convert: fn($ty) -> f64 = $convert;
                out.extend(values.into_iter().map(convert));
                Ok(())
            }};
        }
        macro_rules! fetch_second {
            ($name:literal, $ty:ty, $zero:expr, $convert:expr) => {{
                let mut values: Vec<$ty> = vec![$zero; count];
                call!(self, $name, references.as_ptr() => *const u32, references.len() => usize,
                    values.as_mut_ptr() => *mut $ty)?;
                let convert: fn($ty) -> f64 = $convert;
                out.extend(values.into_iter().map(convert));
                Ok(())
            }};
        }
        match (self.third, passing) {
            (false, Passing::Float64) => fetch_second!("fmi2GetReal", f64, 0.0, |x| x),
            (false, Passing::Boolean) => {
                fetch_second!("fmi2GetBoolean", c_int, 0, |x| f64::from(u8::from(x != 0)))
            }
            (false, _) => fetch_second!("fmi2GetInteger", c_int, 0, f64::from),
            (true, Passing::Float64) => fetch!("fmi3GetFloat64", f64, 0.0, |x| x),
            (true, Passing::Float32) => fetch!("fmi3GetFloat32", f32, 0.0, f64::from),
            (true, Passing::Int8) => fetch!("fmi3GetInt8", i8, 0, f64::from),
            (true, Passing::UInt8) => fetch!("fmi3GetUInt8", u8, 0, f64::from),
            (true, Passing::Int16) => fetch!("fmi3GetInt16", i16, 0, f64::from),
            (true, Passing::UInt16) => fetch!("fmi3GetUInt16", u16, 0, f64::from),
            (true, Passing::Int32) => fetch!("fmi3GetInt32", i32, 0, f64::from),
            (true, Passing::UInt32) => fetch!("fmi3GetUInt32", u32, 0, f64::from),
            (true, Passing::Int64) => fetch!("fmi3GetInt64", i64, 0, |x| x as f64),
            (true, Passing::UInt64) => fetch!("fmi3GetUInt64", u64, 0, |x| x as f64),
            // Bytes, since a foreign Boolean may be neither 0 nor 1.
            (true, Passing::Boolean) => {
                fetch!("fmi3GetBoolean", u8, 0, |x| f64::from(u8::from(x != 0)))
            }
        }
    }

    /// Sets the values of one group.
    pub fn set(&self, group: &Group, new: &[f64]) -> Result<(), Trouble> {
        let reference = group.reference;
        macro_rules! put {
            ($name:literal, $ty:ty) => {{
                let values: Vec<$ty> = new.iter().map(|x| *x as $ty).collect();
                call!(self, $name, &reference => *const u32, 1 => usize,
                    values.as_ptr() => *const $ty, values.len() => usize)
            }};
        }
        macro_rules! put_second {
            ($name:literal, $ty:ty) => {{
                let values: Vec<$ty> = new.iter().map(|x| *x as $ty).collect();
                call!(self, $name, &reference => *const u32, 1 => usize,
                    values.as_ptr() => *const $ty)
            }};
        }
        match (self.third, group.passing) {
            (false, Passing::Float64) => put_second!("fmi2SetReal", f64),
            (false, Passing::Boolean) => put_second!("fmi2SetBoolean", c_int),
            (false, _) => put_second!("fmi2SetInteger", c_int),
            (true, Passing::Float64) => put!("fmi3SetFloat64", f64),
            (true, Passing::Float32) => put!("fmi3SetFloat32", f32),
            (true, Passing::Int8) => put!("fmi3SetInt8", i8),
            (true, Passing::UInt8) => put!("fmi3SetUInt8", u8),
            (true, Passing::Int16) => put!("fmi3SetInt16", i16),
            (true, Passing::UInt16) => put!("fmi3SetUInt16", u16),
            (true, Passing::Int32) => put!("fmi3SetInt32", i32),
            (true, Passing::UInt32) => put!("fmi3SetUInt32", u32),
            (true, Passing::Int64) => put!("fmi3SetInt64", i64),
            (true, Passing::UInt64) => put!("fmi3SetUInt64", u64),
            (true, Passing::Boolean) => put!("fmi3SetBoolean", u8),
        }
    }
}

/// The path of a folder as the URI that FMI 2 asks for.
fn uri(folder: &str) -> String {
    let mut out = "file://".to_owned();
    for byte in folder.bytes() {
        match byte {
            b'/' | b'-' | b'_' | b'.' | b'~' => out.push(byte as char),
            b if b.is_ascii_alphanumeric() => out.push(b as char),
            b => out.push_str(&format!("%{b:02X}")),
        }
    }
    out
}

/// An error with its cause: the reason of the loader.
fn detailed(error: &libloading::Error) -> String {
    match std::error::Error::source(error) {
        Some(source) => source.to_string(),
        None => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_become_uris() {
        assert_eq!(uri("/tmp/a b/resources"), "file:///tmp/a%20b/resources");
    }
}
