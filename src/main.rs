//! The command line: argv to exit code.

use std::process::ExitCode;

use mocc::cli::{Status, run};

/// Deep models recurse deeply: the work runs on a thread with a stack of its own.
const STACK: usize = 1 << 30;

fn main() -> ExitCode {
    let worker = std::thread::Builder::new().name("mocc".into()).stack_size(STACK).spawn(run);
    let status = match worker {
        Ok(worker) => worker.join().unwrap_or_else(|_| {
            eprintln!("this is a bug in mocc, please report it with the model and the command");
            Status::Bug
        }),
        Err(why) => {
            eprintln!("error: cannot start: {why}");
            Status::Usage
        }
    };
    status.into()
}
