//! An instance as a C pointer, with its logger.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use mocc::fmu::instance::{Gravity, Instance, Kind, Refusal, Saved};
use mocc::fmu::package;
use mocc::ir::program::Program;

/// Status codes; both versions have the same numbers.
pub const OK: c_int = 0;
/// See [`OK`].
pub const WARNING: c_int = 1;
/// See [`OK`].
pub const DISCARD: c_int = 2;
/// See [`OK`].
pub const ERROR: c_int = 3;
/// See [`OK`].
pub const FATAL: c_int = 4;

/// The logger of FMI 2: environment, name of the instance, status, category, format.
pub type Logger2 =
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);
/// The logger of FMI 3: environment, status, category, message.
pub type Logger3 = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

/// A logger of the importer.
#[derive(Clone, Copy)]
pub enum Logger {
    /// None.
    Silent,
    /// FMI 2.
    Second(Logger2, *mut c_void),
    /// FMI 3.
    Third(Logger3, *mut c_void),
}

self_cell::self_cell!(
    struct Owned {
        owner: Box<Program>,
        #[not_covariant]
        dependent: Instance,
    }
);

/// An instance, see the module.
pub struct Component {
    owned: Owned,
    name: CString,
    logger: Logger,
    logging: bool,
    /// Categories that are logged; all if none are named.
    categories: Vec<String>,
    /// The strings that the last call returned.
    pub strings: Vec<CString>,
    /// The end of the last step, s.
    pub reached: f64,
    /// The model ended the run.
    pub ended: bool,
    /// The importer accepts that a step ends early.
    may_return_early: bool,
}

/// Text for C: without zeros inside.
pub fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// The text behind a pointer; `None` if it is null or not UTF-8.
pub fn text_at<'a>(pointer: *const c_char) -> Option<&'a str> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: not null; the importer passes strings that end with zero, as FMI asks for.
    unsafe { CStr::from_ptr(pointer) }.to_str().ok()
}

/// The `n` values behind a pointer; none if it is null.
pub fn values_at<'a, T>(pointer: *const T, n: usize) -> &'a [T] {
    if pointer.is_null() || n == 0 {
        return &[];
    }
    // SAFETY: not null; the importer passes arrays of the length that it names, as FMI asks for.
    unsafe { std::slice::from_raw_parts(pointer, n) }
}

/// The `n` places behind a pointer; none if it is null.
pub fn places_at<'a, T>(pointer: *mut T, n: usize) -> &'a mut [T] {
    if pointer.is_null() || n == 0 {
        return &mut [];
    }
    // SAFETY: as for `values_at`; the importer does not read the array during the call.
    unsafe { std::slice::from_raw_parts_mut(pointer, n) }
}

/// Writes to a place of the importer, unless it is null.
pub fn put<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: not null; the importer passes places that may be written, as FMI asks for.
        unsafe { place.write(value) };
    }
}

impl Logger {
    fn say(self, name: &CStr, status: c_int, category: &str, text: &str) {
        let category = c_text(category);
        match self {
            Logger::Silent => {}
            Logger::Second(function, environment) => {
                // The message is a format of `printf`.
                let text = c_text(&text.replace('%', "%%"));
                // SAFETY: a function of the importer with this signature, as FMI asks for.
                unsafe {
                    function(environment, name.as_ptr(), status, category.as_ptr(), text.as_ptr());
                }
            }
            Logger::Third(function, environment) => {
                let text = c_text(text);
                // SAFETY: as above.
                unsafe { function(environment, status, category.as_ptr(), text.as_ptr()) };
            }
        }
    }
}

impl Component {
    /// Whether to say that a step has ended early, before its end.
    pub fn returns_early(&self, end: f64) -> bool {
        self.may_return_early && self.reached < end
    }
}

/// A new instance as a pointer; null, with a message, if there is none.
pub fn instantiate(
    name: *const c_char,
    token: *const c_char,
    resources: Option<PathBuf>,
    (kind, may_return_early): (Kind, bool),
    logger: Logger,
    logging: bool,
) -> *mut c_void {
    let name = c_text(text_at(name).unwrap_or("FMU"));
    let made = catch_unwind(AssertUnwindSafe(|| {
        let token = text_at(token).ok_or("the importer passed no token")?;
        let folder = resources.ok_or("the importer passed no folder of resources")?;
        let program = load(&folder, token)?;
        let owned = Owned::new(Box::new(program), |program| Instance::new(program, kind));
        Ok::<_, String>(Component {
            owned,
            name: name.clone(),
            logger,
            logging,
            categories: Vec::new(),
            strings: Vec::new(),
            reached: 0.0,
            ended: false,
            may_return_early,
        })
    }));
    let why = match made {
        Ok(Ok(component)) => return Box::into_raw(Box::new(component)).cast(),
        Ok(Err(why)) => why,
        Err(_) => "this is a bug in mocc, please report it with the model".to_owned(),
    };
    logger.say(&name, ERROR, "logStatusError", &why);
    std::ptr::null_mut()
}

fn load(folder: &Path, token: &str) -> Result<Program, String> {
    let path = folder.join(package::FILE);
    let bytes =
        std::fs::read(&path).map_err(|why| format!("cannot read {}: {why}", path.display()))?;
    package::read(&bytes, token).map_err(|why| why.to_string())
}

/// The folder behind a URI or a path.
pub fn folder(location: *const c_char) -> Option<PathBuf> {
    let text = text_at(location)?;
    let Some(rest) = text.strip_prefix("file:") else { return Some(PathBuf::from(text)) };
    let rest = rest.strip_prefix("//localhost").or_else(|| rest.strip_prefix("//")).unwrap_or(rest);
    let bytes = rest.as_bytes();
    let (mut out, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let code = bytes.get(at + 1..at + 3).and_then(|hex| std::str::from_utf8(hex).ok());
        let decoded = code.and_then(|hex| u8::from_str_radix(hex, 16).ok());
        match (bytes[at], decoded) {
            (b'%', Some(byte)) => {
                out.push(byte);
                at += 3;
            }
            (byte, _) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8(out).ok().map(PathBuf::from)
}

/// Frees an instance.
pub fn free(pointer: *mut c_void) {
    if !pointer.is_null() {
        // SAFETY: made by `instantiate`, and freed once, as FMI asks for.
        let component = unsafe { Box::from_raw(pointer.cast::<Component>()) };
        let _ = catch_unwind(AssertUnwindSafe(move || drop(component)));
    }
}

impl Component {
    /// Calls with the instance.
    pub fn with<R>(&mut self, call: impl FnOnce(&mut Instance<'_>) -> R) -> R {
        self.owned.with_dependent_mut(|_, instance| call(instance))
    }

    /// Logs a message.
    pub fn say(&self, status: c_int, category: &str, text: &str) {
        let wanted = self.categories.is_empty() || self.categories.iter().any(|c| c == category);
        // What ended a call is always said.
        if status >= ERROR || (self.logging && wanted) {
            self.logger.say(&self.name, status, category, text);
        }
    }

    /// Chooses what is logged.
    pub fn log_only(&mut self, logging: bool, categories: &[*const c_char]) {
        self.logging = logging;
        self.categories =
            categories.iter().filter_map(|c| text_at(*c)).map(str::to_owned).collect();
    }
}

/// Calls with a component, and turns a refusal or a panic into a status and a message.
pub fn guarded(
    pointer: *mut c_void,
    call: impl FnOnce(&mut Component) -> Result<(), Refusal>,
) -> c_int {
    if pointer.is_null() {
        return ERROR;
    }
    // SAFETY: made by `instantiate` and not yet freed; an instance is used by one thread at a time, as FMI
    // asks for.
    let component = unsafe { &mut *pointer.cast::<Component>() };
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        let outcome = call(component);
        let warnings = component.with(|instance| std::mem::take(&mut instance.warnings));
        for text in &warnings {
            component.say(WARNING, "logStatusWarning", text);
        }
        outcome
    }));
    match outcome {
        Ok(Ok(())) => OK,
        Ok(Err(Refusal { gravity: Gravity::Discard, text })) => {
            component.say(DISCARD, "logStatusDiscard", &text);
            DISCARD
        }
        Ok(Err(Refusal { text, .. })) => {
            component.say(ERROR, "logStatusError", &text);
            ERROR
        }
        Err(_) => {
            let text = "this is a bug in mocc, please report it with the model";
            component.say(FATAL, "logStatusError", text);
            FATAL
        }
    }
}

// ---- Calls that both versions have ----

/// Saves the state; a state that exists is replaced.
pub fn save_state(c: *mut c_void, place: *mut *mut c_void) -> c_int {
    guarded(c, |component| {
        if place.is_null() {
            return Err(Refusal::of("there is no place for the state"));
        }
        let saved = component.with(|instance| instance.save())?;
        // SAFETY: not null; holds null or a state that `save_state` made.
        unsafe {
            let old = *place;
            if !old.is_null() {
                drop(Box::from_raw(old.cast::<Saved>()));
            }
            *place = Box::into_raw(Box::new(saved)).cast();
        }
        Ok(())
    })
}

/// The state behind a pointer.
fn state_at<'a>(state: *mut c_void) -> Result<&'a Saved, Refusal> {
    if state.is_null() {
        return Err(Refusal::of("there is no state"));
    }
    // SAFETY: made by `save_state` or `read_state`.
    Ok(unsafe { &*state.cast::<Saved>() })
}

/// Restores a state.
pub fn restore_state(c: *mut c_void, state: *mut c_void) -> c_int {
    guarded(c, |component| {
        let saved = state_at(state)?;
        component.ended = false;
        component.with(|instance| instance.restore(saved))
    })
}

/// Frees a state.
pub fn free_state(c: *mut c_void, place: *mut *mut c_void) -> c_int {
    guarded(c, |_| {
        if !place.is_null() {
            // SAFETY: not null; holds null or a state that `save_state` made.
            unsafe {
                let old = std::mem::replace(&mut *place, std::ptr::null_mut());
                if !old.is_null() {
                    drop(Box::from_raw(old.cast::<Saved>()));
                }
            }
        }
        Ok(())
    })
}

/// The number of bytes of a state.
pub fn state_size(c: *mut c_void, state: *mut c_void, size: *mut usize) -> c_int {
    guarded(c, |_| {
        put(size, state_at(state)?.to_bytes().len());
        Ok(())
    })
}

/// The bytes of a state.
pub fn write_state(c: *mut c_void, state: *mut c_void, bytes: *mut u8, size: usize) -> c_int {
    guarded(c, |_| {
        let written = state_at(state)?.to_bytes();
        let places = places_at(bytes, size);
        if places.len() < written.len() {
            return Err(Refusal::of("the place for the serialized state is too small"));
        }
        places[..written.len()].copy_from_slice(&written);
        Ok(())
    })
}

/// The state of bytes.
pub fn read_state(c: *mut c_void, bytes: *const u8, size: usize, place: *mut *mut c_void) -> c_int {
    guarded(c, |_| {
        let saved = Saved::from_bytes(values_at(bytes, size))?;
        put(place, Box::into_raw(Box::new(saved)).cast());
        Ok(())
    })
}

/// Numbers of variables of certain types.
pub fn get_numbers<T>(
    c: *mut c_void,
    references: &[u32],
    places: &mut [T],
    is_type: fn(mocc::ir::expr::Type) -> bool,
    convert: fn(f64) -> T,
) -> c_int {
    guarded(c, |component| {
        component.with(|instance| {
            fits(references.len(), places.len())?;
            for (reference, place) in references.iter().zip(places) {
                check(instance, *reference, is_type)?;
                *place = convert(instance.get(*reference)?);
            }
            Ok(())
        })
    })
}

/// Sets variables of certain types.
pub fn set_numbers<T: Copy>(
    c: *mut c_void,
    references: &[u32],
    values: &[T],
    is_type: fn(mocc::ir::expr::Type) -> bool,
    convert: fn(T) -> f64,
) -> c_int {
    guarded(c, |component| {
        component.with(|instance| {
            fits(references.len(), values.len())?;
            for (reference, value) in references.iter().zip(values) {
                check(instance, *reference, is_type)?;
                instance.set(*reference, convert(*value))?;
            }
            Ok(())
        })
    })
}

fn fits(references: usize, values: usize) -> Result<(), Refusal> {
    match references == values {
        true => Ok(()),
        false => Err(Refusal::of(format!("{references} value references, but {values} values"))),
    }
}

fn check(
    instance: &Instance<'_>,
    reference: u32,
    is_type: fn(mocc::ir::expr::Type) -> bool,
) -> Result<(), Refusal> {
    match is_type(instance.type_of(reference)?) {
        true => Ok(()),
        false => Err(Refusal::of(format!("the value reference {reference} is of another type"))),
    }
}

/// Strings of variables; they live until the next call.
pub fn get_strings(c: *mut c_void, references: &[u32], places: &mut [*const c_char]) -> c_int {
    guarded(c, |component| {
        fits(references.len(), places.len())?;
        let found: Result<Vec<CString>, Refusal> = component.with(|instance| {
            let one = |reference: &u32| {
                check(instance, *reference, |ty| ty == mocc::ir::expr::Type::String)?;
                Ok(c_text(&instance.get_string(*reference)?))
            };
            references.iter().map(one).collect()
        });
        component.strings = found?;
        for (place, text) in places.iter_mut().zip(&component.strings) {
            *place = text.as_ptr();
        }
        Ok(())
    })
}
