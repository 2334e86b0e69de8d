//! Ctrl-C: the run ends after the current step, and the results so far are written. A call of an FMU that does not return
//! is given up. Sole user of `ctrlc`.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Status;
use crate::fmu::import::remote::give_up_calls;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// From here on Ctrl-C requests an end of the run; a second one ends the process at once, in case a step
/// takes too long.
pub fn listen() {
    let handler = || {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(Status::Interrupted as i32);
        }
        give_up_calls();
    };
    // Without the handler Ctrl-C ends the process; files are never left half written.
    let _ = ctrlc::set_handler(handler);
}

/// Whether Ctrl-C was pressed since [`listen`].
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
