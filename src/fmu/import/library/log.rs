//! The messages of an FMU, and the callbacks that FMI 2 asks for.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr;
use std::sync::Mutex;

/// Most messages of the FMU that are kept.
const MOST_MESSAGES: usize = 20;
/// Longest message, bytes.
const LONGEST_MESSAGE: usize = 2000;
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

/// The memory and the logger of FMI 2.
#[repr(C)]
pub(super) struct Callbacks {
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

/// The logger of FMI 3.
pub(super) unsafe extern "C" fn log_third(
    _: *mut c_void,
    _: c_int,
    _: *const c_char,
    text: *const c_char,
) {
    if !text.is_null() {
        // SAFETY: the standard promises a string that ends with zero.
        keep(&unsafe { CStr::from_ptr(text) }.to_string_lossy());
    }
}

impl Callbacks {
    /// Memory of the C library, and the logger.
    pub(super) fn new() -> Callbacks {
        Callbacks {
            logger: log_second,
            allocate: calloc,
            free,
            finished: ptr::null(),
            environment: ptr::null_mut(),
        }
    }
}
