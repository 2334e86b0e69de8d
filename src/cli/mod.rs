//! The command line: parses arguments, calls the library, prints and writes. Arguments in, exit status out.

/// As that of the standard library, but for a reader who has gone: then nobody misses the line.
macro_rules! eprint {
    ($($text:tt)*) => { $crate::cli::to_standard_error(format_args!($($text)*)) };
}
/// As [`eprint!`], with the end of the line.
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::cli::to_standard_error(format_args!("{}\n", format_args!($($text)*))) };
}

mod args;
mod bode;
mod budget;
mod calibrate;
mod check;
mod compare;
mod completions;
mod diagnose;
mod doc;
mod evaluate;
mod explain;
mod export;
mod fmu_host;
mod format;
mod import;
mod interrupt;
mod library;
mod linear_text;
mod linearize;
mod lsp;
mod new;
mod optimize;
mod other_means;
mod plan;
mod plot;
mod plot_table;
mod progress;
mod report;
mod run_summary;
mod running;
mod show;
mod simulate;
mod standard;
mod start_text;
mod stream;
pub mod sweep;
mod terminal;
mod test;
mod wanted_unit;
mod watch;
mod writer;

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use crate::base::diag::{Problems, Severity};
use crate::base::render::{Style, render_all, visible};
use crate::base::source::SourceMap;
use crate::driver::compile::{CompileError, Session};
use crate::driver::project::{self, Project};
use crate::simulate::failure::FailureKind;

use args::model::is_standard;

/// The exit status of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// Done.
    Done = 0,
    /// The model is wrong.
    Model = 1,
    /// The command line is wrong, or a file cannot be read or written.
    Usage = 2,
    /// The numerics failed.
    Numerics = 3,
    /// mocc has a bug.
    Bug = 4,
    /// Ctrl-C ended the run; the results so far are written. 128 plus the number of the signal.
    Interrupted = 130,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        ExitCode::from(status as u8)
    }
}

impl From<CompileError> for Status {
    fn from(error: CompileError) -> Self {
        match error {
            CompileError::Model => Status::Model,
            CompileError::Request => Status::Usage,
        }
    }
}

impl From<FailureKind> for Status {
    fn from(kind: FailureKind) -> Self {
        match kind {
            FailureKind::Numerics | FailureKind::Assertion => Status::Numerics,
            FailureKind::Settings => Status::Usage,
            FailureKind::Bug => Status::Bug,
        }
    }
}

/// Deep models recurse deeply: the work runs on a thread with a stack of its own.
const STACK: usize = 1 << 30;

/// Runs the command that the arguments name, the first of which is the name of the program. This is the whole
/// program for any process that offers it.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> Status {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let work = move || run(arguments);
    let worker = std::thread::Builder::new().name("mocc".into()).stack_size(STACK).spawn(work);
    match worker {
        Ok(worker) => worker.join().unwrap_or_else(|_| {
            eprintln!("this is a bug in mocc, please report it with the model and the command");
            Status::Bug
        }),
        Err(why) => {
            eprintln!("error: cannot start: {why}");
            Status::Usage
        }
    }
}

fn run(arguments: Vec<OsString>) -> Status {
    fmu_host::set_program();
    if let [_, word] = arguments.as_slice()
        && word == fmu_host::COMMAND
    {
        return fmu_host::run();
    }
    let status = match args::read(arguments) {
        Ok(command) => carry_out(command),
        Err(status) => return status,
    };
    explain::print_hint();
    status
}

fn carry_out(command: args::Command) -> Status {
    match &command {
        args::Command::Simulate(options) => budget::watch(&options.limits),
        args::Command::Check(options) => budget::watch(&options.limits),
        _ => budget::watch(&args::model::Limits::default()),
    }
    QUIET.store(is_quiet(&command), std::sync::atomic::Ordering::Relaxed);
    HIDES_WARNINGS.store(hides_warnings(&command), std::sync::atomic::Ordering::Relaxed);
    match command {
        args::Command::Simulate(options) => simulate::run(&options),
        args::Command::Report(options) => report::run(&options),
        args::Command::Watch(options) => watch::run(&options),
        args::Command::Calibrate(options) => calibrate::run(&options),
        args::Command::Diagnose(options) => diagnose::run(&options),
        args::Command::Evaluate(options) => evaluate::run(&options),
        args::Command::Optimize(options) => optimize::run(&options),
        args::Command::Steady(options) => linearize::steady(&options),
        args::Command::Linearize(options) => linearize::run(&options),
        args::Command::Test(options) => test::run(&options),
        args::Command::Compare(options) => compare::run(&options),
        args::Command::New(options) => new::run(&options),
        args::Command::Plan(options) => plan::run(&options),
        args::Command::Lib(options) => library::run(&options),
        args::Command::Doc(options) => doc::run(&options),
        args::Command::Lsp => lsp::run(),
        args::Command::Completions(options) => completions::run(&options),
        args::Command::Man(options) => completions::man(&options),
        args::Command::Plot(options) => plot::run(&options),
        args::Command::Sweep(options) => sweep::run(&options),
        args::Command::Check(options) => check::run(&options),
        args::Command::Explain(options) => explain::run(&options),
        args::Command::Format(options) => format::run(&options),
        args::Command::Flatten(options) => show::flatten(&options),
        args::Command::Export(options) => export::run(&options),
        args::Command::Import(options) => import::run(&options),
        args::Command::Structure(options) => show::structure(&options),
    }
}

/// Whether a command prints nothing but errors. Those that are not here say themselves what they leave out.
fn is_quiet(command: &args::Command) -> bool {
    use args::Command::*;
    match command {
        Sweep(options) => options.quiet,
        Test(options) => options.quiet && !options.json,
        New(options) => options.quiet,
        Plan(options) => options.quiet,
        Lib(options) => options.quiet,
        Man(options) => options.quiet,
        Compare(options) => options.quiet && !options.json,
        Plot(options) => options.quiet,
        Calibrate(options) => options.study.quiet,
        Diagnose(options) => options.study.quiet,
        Evaluate(options) => options.quiet,
        Steady(options) => options.point.quiet,
        Linearize(options) => options.point.quiet,
        Check(options) => options.quiet && !options.json,
        Format(options) => options.quiet,
        Flatten(options) => options.quiet,
        Structure(options) => options.quiet,
        Export(options) => {
            let args::export::Exported::Fmu(options) = &options.what;
            options.quiet
        }
        Import(options) => options.quiet,
        Simulate(_) | Report(_) | Watch(_) | Optimize(_) | Doc(_) | Lsp | Explain(_)
        | Completions(_) => false,
    }
}

/// Whether a command shows no warnings: one that prints nothing but errors.
fn hides_warnings(command: &args::Command) -> bool {
    match command {
        args::Command::Report(options) => options.quiet,
        args::Command::Optimize(options) => options.quiet,
        args::Command::Doc(options) => options.quiet,
        other => is_quiet(other),
    }
}

/// The command in progress shows no warnings.
static HIDES_WARNINGS: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

/// The command in progress prints nothing but errors.
static QUIET: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

fn is_quiet_now() -> bool {
    QUIET.load(std::sync::atomic::Ordering::Relaxed)
}

/// The value of `MODELICAPATH`.
fn modelica_path() -> Option<OsString> {
    std::env::var_os("MODELICAPATH")
}

/// The settings of the project of a file. Errors in them are shown, and end the command.
fn project(file: Option<&Path>) -> Project {
    let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
    let project = project::of(file, &mut sources, &mut problems);
    if !problems.is_empty() {
        say_problems(&problems, &sources);
        std::process::exit(Status::Usage as i32);
    }
    project
}

/// The whole standard input. An error in it is shown, and ends the command.
fn standard_input() -> String {
    match std::io::read_to_string(std::io::stdin()) {
        Ok(text) => text,
        Err(why) => {
            eprintln!("error: cannot read the standard input: {why}");
            std::process::exit(Status::Usage as i32);
        }
    }
}

thread_local! {
    /// What this thread writes to the standard error, while somebody wants it.
    static CAPTURED: std::cell::RefCell<Option<String>> = const { std::cell::RefCell::new(None) };
}

/// Does some work, and returns what it wrote to the standard error, too.
fn capture_errors<T>(work: impl FnOnce() -> T) -> (T, String) {
    CAPTURED.set(Some(String::new()));
    let out = work();
    (out, CAPTURED.take().unwrap_or_default())
}

/// Writes to the standard error; a closed pipe or a full disk behind it does not end the command.
fn to_standard_error(text: std::fmt::Arguments<'_>) {
    use std::io::Write;
    CAPTURED.with_borrow_mut(|captured| {
        if let Some(captured) = captured {
            captured.push_str(&text.to_string());
        }
    });
    let _ = std::io::stderr().lock().write_fmt(text);
}

/// Writes the diagnostics of a session to the standard error.
fn say(session: &Session) {
    say_problems(&session.problems, &session.sources);
}

/// Writes diagnostics to the standard error, in colours on a terminal; no warnings where nothing but errors is wanted.
fn say_problems(problems: &Problems, sources: &SourceMap) {
    let mut shown = Problems::new();
    let hides = HIDES_WARNINGS.load(std::sync::atomic::Ordering::Relaxed);
    let all = problems.iter().filter(|d| !hides || d.severity == Severity::Error);
    all.for_each(|d| shown.push(d.clone()));
    eprint!("{}", render_all(&shown, sources, style()));
    explain::remember(problems.sorted());
    let errors = problems.error_count();
    if errors > 1 {
        eprintln!("{errors} errors");
    }
}

/// Writes a text to the standard output, unless the command is to print nothing but errors. On a terminal, characters of
/// the model cannot command it.
fn print(text: &str) -> Status {
    if is_quiet_now() { Status::Done } else { print_result(text) }
}

/// Writes the text that a command is asked for, such as a flat model, however little else it is to print.
fn print_result(text: &str) -> Status {
    use std::io::IsTerminal;
    let is_terminal = std::io::stdout().is_terminal();
    ended(if is_terminal {
        print_bytes(visible(text).as_bytes())
    } else {
        print_bytes(text.as_bytes())
    })
}

/// As [`print`], for a text that may hold escape codes.
fn print_styled(text: &str) -> Status {
    if is_quiet_now() { Status::Done } else { ended(print_bytes(text.as_bytes())) }
}

/// The status after something was written; an error is shown.
fn ended(written: Result<(), String>) -> Status {
    match written {
        Ok(()) => Status::Done,
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}

/// Writes bytes to the standard output, however little the command is to print. A reader that closes the pipe early is no
/// error.
fn print_bytes(bytes: &[u8]) -> Result<(), String> {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(why) if why.kind() != ErrorKind::BrokenPipe => {
            Err(format!("cannot write to the standard output: {why}"))
        }
        _ => Ok(()),
    }
}

/// Writes a file to the standard output, and removes it.
fn print_file(path: &Path) -> Status {
    let bytes = crate::io::atomic_file::take_file(path).map_err(|why| why.to_string());
    ended(bytes.and_then(|bytes| print_bytes(&bytes)))
}

/// Writes a result to a file, or to the standard output if its path is `-`; the line that says so, empty for `-`.
fn write_result(path: &Path, bytes: &[u8]) -> Result<String, String> {
    if is_standard(path) {
        return print_bytes(bytes).map(|()| String::new());
    }
    crate::io::atomic_file::write_file(path, bytes).map_err(|why| why.to_string())?;
    Ok(format!("wrote {}\n", path.display()))
}

/// The path of a plan for messages, and its text if that is the standard input.
fn plan_of(path: &Path) -> (std::path::PathBuf, Option<String>) {
    match is_standard(path) {
        true => ("stdin.toml".into(), Some(standard_input())),
        false => (path.to_owned(), None),
    }
}

/// The style of the standard error.
fn style() -> Style {
    style_of(&std::io::stderr())
}

/// Colours on a terminal, unless the user asks for none.
fn style_of(stream: &impl std::io::IsTerminal) -> Style {
    if stream.is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        Style::Coloured
    } else {
        Style::Plain
    }
}
