//! Making an instance: loads the library and calls the function of the version of FMI.

use std::ffi::{CString, c_char, c_int, c_void};
use std::ptr;

use libloading::Library as AnyLibrary;
use libloading::os::unix::{Library, RTLD_LAZY, RTLD_LOCAL, RTLD_NOW};

use super::current_call::{CurrentCall, LOADING};
use super::log::{Callbacks, log_third};
use super::{Instance, Trouble, python};
use crate::fmu::import::message::Load;

/// The logger of FMI 3.
type Log = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

impl Instance {
    /// Loads the library and makes an instance.
    pub fn new(load: &Load) -> Result<Instance, Trouble> {
        let library = opened(&load.library)?;
        let callbacks = Box::new(Callbacks::new());
        let instance = match load.third {
            true => third(&library, load)?,
            false => second(&library, load, &callbacks)?,
        };
        if instance.is_null() {
            return Err(Trouble::NotInstantiated);
        }
        Ok(Instance { library, third: load.third, instance, _callbacks: callbacks })
    }
}

/// Keeps a library in memory, so that further instances need not load it again. What is wrong with it is reported
/// with its first instance.
pub fn keep_loaded(load: &Load) {
    if let Ok(library) = opened(&load.library) {
        std::mem::forget(library);
    }
}

/// Loads a library, and Python first if it needs that.
fn opened(path: &str) -> Result<AnyLibrary, Trouble> {
    let _call = CurrentCall::enter(LOADING);
    // SAFETY: the user has named the FMU, and its code runs in a process of its own.
    let open = |flags| unsafe { Library::open(Some(path), flags | RTLD_LOCAL) };
    // At first with all its functions, or the lack of Python would show when the first is called.
    match open(RTLD_NOW).map_err(|e| detailed(&e)) {
        Ok(library) => return Ok(library.into()),
        Err(why) if python::is_missed(&why) => python::start().map_err(Trouble::NeedsPython)?,
        Err(_) => {}
    }
    let library = open(RTLD_LAZY).map_err(|e| Trouble::NotLoaded(detailed(&e)))?;
    Ok(library.into())
}

fn string(text: &str) -> CString {
    CString::new(text).unwrap_or_default()
}

fn missing(error: libloading::Error) -> Trouble {
    Trouble::NotLoaded(detailed(&error))
}

/// An instance by FMI 2.
fn second(
    library: &AnyLibrary,
    load: &Load,
    callbacks: &Callbacks,
) -> Result<*mut c_void, Trouble> {
    type Make = unsafe extern "C" fn(
        *const c_char,
        c_int,
        *const c_char,
        *const c_char,
        *const Callbacks,
        c_int,
        c_int,
    ) -> *mut c_void;
    let (name, token, resources) =
        (string("mocc"), string(&load.token), string(&uri(&load.resources)));
    let kind = c_int::from(load.shape.steps_itself);
    // SAFETY: signature of FMI 2.0; strings and callbacks live long enough.
    unsafe {
        let make = library.get::<Make>(b"fmi2Instantiate").map_err(missing)?;
        let _call = CurrentCall::enter("fmi2Instantiate");
        Ok(make(name.as_ptr(), kind, token.as_ptr(), resources.as_ptr(), callbacks, 0, 0))
    }
}

/// An instance by FMI 3.
fn third(library: &AnyLibrary, load: &Load) -> Result<*mut c_void, Trouble> {
    type Exchange = unsafe extern "C" fn(
        *const c_char,
        *const c_char,
        *const c_char,
        bool,
        bool,
        *mut c_void,
        Log,
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
        Log,
        *const c_void,
    ) -> *mut c_void;
    let folder = format!("{}/", load.resources.trim_end_matches('/'));
    let kept = [string("mocc"), string(&load.token), string(&folder)];
    let [name, token, resources] = kept.each_ref().map(|text| text.as_ptr());
    let (none, unused) = (ptr::null_mut(), ptr::null());
    // SAFETY: signatures of FMI 3.0; all strings live through the call.
    unsafe {
        if load.shape.steps_itself {
            let make = library.get::<Stepping>(b"fmi3InstantiateCoSimulation").map_err(missing)?;
            let _call = CurrentCall::enter("fmi3InstantiateCoSimulation");
            let (visible, logging, events, early) = (false, false, false, false);
            return Ok(make(
                name,
                token,
                resources,
                visible,
                logging,
                events,
                early,
                ptr::null(),
                0,
                none,
                log_third,
                unused,
            ));
        }
        let make = library.get::<Exchange>(b"fmi3InstantiateModelExchange").map_err(missing)?;
        let _call = CurrentCall::enter("fmi3InstantiateModelExchange");
        Ok(make(name, token, resources, false, false, none, log_third))
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
