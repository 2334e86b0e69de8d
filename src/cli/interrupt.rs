//! Ctrl-C and, on Unix, the signal SIGTERM: the run ends after the current step, and the results so far are written. A call of
//! an FMU that does not return is given up. Sole user of `ctrlc` and `signal-hook`.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Status;
use crate::fmu::import::remote::give_up_calls;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// From here on Ctrl-C requests an end of the run; a second one ends the process at once, in case a step
/// takes too long. The same holds for SIGTERM, with which batch systems announce the end of a job.
pub fn listen() {
    // Without the handlers the process ends; files are never left half written.
    let _ = ctrlc::set_handler(request);
    #[cfg(unix)]
    listen_for_termination();
}

#[cfg(unix)]
fn listen_for_termination() {
    use signal_hook::{consts::SIGTERM, iterator::Signals};

    let Ok(mut signals) = Signals::new([SIGTERM]) else { return };
    let listener = std::thread::Builder::new().name("signals".to_owned());
    let _ = listener.spawn(move || signals.forever().for_each(|_| request()));
}

fn request() {
    if REQUESTED.swap(true, Ordering::Relaxed) {
        std::process::exit(Status::Interrupted as i32);
    }
    give_up_calls();
}

/// Whether Ctrl-C was pressed, or SIGTERM sent, since [`listen`].
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
