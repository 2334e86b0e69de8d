//! Ctrl-C: the run ends after the step under way, and what was computed is written. Sole user of
//! `ctrlc`.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Status;

static ASKED: AtomicBool = AtomicBool::new(false);

/// From here on Ctrl-C asks the run to end; a second one ends the process at once, for a step that
/// takes too long.
pub fn listen() {
    let handler = || {
        if ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(Status::Interrupted as i32);
        }
    };
    // Without it Ctrl-C ends the process, which leaves no half of a file either.
    let _ = ctrlc::set_handler(handler);
}

/// Whether Ctrl-C was pressed since [`listen`].
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
