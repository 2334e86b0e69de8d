//! Limits of time and memory: a thread watches the process and ends it with a message, before the
//! system does so without one.

use std::time::{Duration, Instant};

use super::Status;
use super::args::model::Limits;
use crate::base::activity;
use crate::driver::memory;

/// Time between two looks.
const PERIOD: Duration = Duration::from_millis(50);
/// Default limit of memory, as a fraction of that of the machine.
const DEFAULT_SHARE: f64 = 0.75;
/// Bytes in a gigabyte.
const GIGABYTE: f64 = 1e9;

/// Starts to watch the limits; without given ones, three quarters of the machine's memory.
pub fn watch(limits: &Limits) {
    let started_at = Instant::now();
    let most_memory = limits
        .max_memory
        .map(|gigabytes| gigabytes * GIGABYTE)
        .or_else(|| Some(DEFAULT_SHARE * memory::installed()? as f64));
    let most_seconds = limits.max_seconds;
    if most_memory.is_none() && most_seconds.is_none() {
        return;
    }
    let look = move || {
        loop {
            std::thread::sleep(PERIOD);
            let elapsed = started_at.elapsed().as_secs_f64();
            if let Some(most) = most_seconds.filter(|most| elapsed > *most) {
                end(&format!("the limit of {most} s is reached"), "--max-seconds");
            }
            let resident = memory::resident().map_or(0.0, |bytes| bytes as f64);
            if let Some(most) = most_memory.filter(|most| resident > *most) {
                let gigabytes = most / GIGABYTE;
                let what = format!(
                    "the limit of {gigabytes:.1} GB of memory is reached after {elapsed:.1} s"
                );
                end(&what, "--max-memory");
            }
        }
    };
    // Without the thread there are no limits.
    let _ = std::thread::Builder::new().name("budget".to_owned()).spawn(look);
}

/// Ends the process with a message.
fn end(what: &str, flag: &str) -> ! {
    let doing = match activity::last() {
        text if text.is_empty() => String::new(),
        text => format!(", {text}"),
    };
    eprintln!("error: {what}{doing}");
    eprintln!("  = help: make the model smaller, or raise the limit with `{flag}`");
    std::process::exit(Status::Model as i32);
}
