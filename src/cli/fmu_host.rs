//! The hidden command `mocc fmu-host`: the child process in which an FMU runs.

use std::ffi::OsString;
use std::path::Path;
use std::time::Duration;

use super::Status;
use crate::fmu::import::remote;
pub use crate::fmu::import::remote::COMMAND;

/// Part of the time limit of a command that is left to report an FMU that does not return.
const RESERVE: Duration = Duration::from_millis(200);

/// Serves the process that has started this one.
pub fn run() -> Status {
    #[cfg(unix)]
    let served = crate::fmu::import::host::serve().map_err(|e| e.to_string());
    #[cfg(not(unix))]
    let served = Err::<(), _>("FMUs run on Linux and macOS only".to_owned());
    match served {
        Ok(()) => Status::Done,
        Err(why) => {
            eprintln!("error: `mocc {COMMAND}` is started by mocc itself: {why}");
            Status::Usage
        }
    }
}

/// Child processes run the same program: the binary, or Python with the package.
pub fn set_program() {
    let Ok(program) = std::env::current_exe() else { return };
    let is_python = Path::new(&program)
        .file_name()
        .is_some_and(|name| name.to_string_lossy().to_lowercase().starts_with("python"));
    let mut words: Vec<OsString> = vec![program.into()];
    if is_python {
        words.extend(["-m".into(), "mocc".into()]);
    }
    remote::set_program(words);
}

/// FMUs have a little less time than the command itself, which then ends in good order.
pub fn set_limit(seconds: f64) {
    remote::set_limit(seconds, RESERVE);
}
