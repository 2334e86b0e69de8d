//! The command line: arguments in, exit status out.
pub mod args;
pub mod calibrate;
pub mod check;
pub mod diagnose;
pub mod format;
pub mod interrupt;
pub mod plot;
pub mod progress;
pub mod report;
pub mod running;
pub mod show;
pub mod simulate;
pub mod stream;
pub mod sweep;
pub mod writer;

use std::process::ExitCode;

use crate::base::render::{Style, render_all};
use crate::driver::compile::{Session, Wrong};

/// What a command ends with.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// Done.
    Done = 0,
    /// The model is wrong.
    Model = 1,
    /// The command line is wrong, or a file can not be read or written.
    Usage = 2,
    /// The numerics failed.
    Numerics = 3,
    /// mocc is wrong.
    Bug = 4,
    /// Ctrl-C ended the run; what was computed is written. 128 and the number of the signal.
    Interrupted = 130,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        ExitCode::from(status as u8)
    }
}

impl From<Wrong> for Status {
    fn from(wrong: Wrong) -> Self {
        match wrong {
            Wrong::Model => Status::Model,
            Wrong::Request => Status::Usage,
        }
    }
}

/// Runs the command that the arguments name.
pub fn run() -> Status {
    match args::read() {
        args::Command::Simulate(options) => simulate::run(&options),
        args::Command::Report(options) => report::run(&options),
        args::Command::Calibrate(options) => calibrate::run(&options),
        args::Command::Diagnose(options) => diagnose::run(&options),
        args::Command::Plot(options) => plot::run(&options),
        args::Command::Sweep(options) => sweep::run(&options),
        args::Command::Check(options) => check::run(&options),
        args::Command::Format(options) => format::run(&options),
        args::Command::Flatten(options) => show::flatten(&options),
        args::Command::Structure(options) => show::structure(&options),
    }
}

/// Writes what there is to say about the model to the standard error, in colours on a terminal.
fn say(session: &Session) {
    let text = render_all(&session.problems, &session.sources, style());
    eprint!("{text}");
    let errors = session.problems.error_count();
    if errors > 1 {
        eprintln!("{errors} errors");
    }
}

/// Writes a result to the standard output. Who reads it may stop early: that is no failure.
fn print(text: &str) -> Status {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(why) if why.kind() != ErrorKind::BrokenPipe => {
            eprintln!("error: cannot write to the standard output: {why}");
            Status::Usage
        }
        _ => Status::Done,
    }
}

fn style() -> Style {
    use std::io::IsTerminal;
    if std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        Style::Coloured
    } else {
        Style::Plain
    }
}
