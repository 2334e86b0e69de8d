//! Ctrl-C: the run ends after the current step, and the results so far are written. Sole user of
//! `ctrlc`.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Status;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// From here on Ctrl-C requests an end of the run; a second one ends the process at once, in case a step
/// takes too long.
pub fn listen() {
    let handler = || {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(Status::Interrupted as i32);
        }
    };
    // Without the handler Ctrl-C ends the process; files are never left half written.
    let _ = ctrlc::set_handler(handler);
}

/// Whether Ctrl-C was pressed since [`listen`].
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
