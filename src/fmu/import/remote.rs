//! An instance in a child process, as a run sees it.
//!
//! The child is mocc itself with the hidden command `fmu-host`. Its standard input is a socket, for orders and
//! answers; what the FMU prints goes to the standard error of mocc. An answer that does not come in time, or the end of
//! the child, is a failure of the run, with the name of the FMU and what it was doing.

use std::ffi::OsString;
use std::io::{BufReader, ErrorKind};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use super::host::{call_file, time_file};
use super::library::current_call::LOADING;
use super::library::process::end_group;
use super::message::{Answer, FailedCall, Item, Load, Order, receive, send};
use crate::base::cause::Cause;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::fmu::cause::FmuCause;
use crate::ir::foreign::{
    AfterStep, ForeignFailure, ForeignFault, ForeignFaultKind, ForeignObserver, ForeignOutcome,
    ForeignTask, Obstacle,
};
use crate::simulate::foreign::cause_of;

/// The hidden command of the child.
pub const COMMAND: &str = "fmu-host";
/// Longest time of one call, s.
const LONGEST_CALL: Duration = Duration::from_secs(300);
/// Longest time of one call when the run should end, ms.
const LONGEST_LAST_CALL: u64 = 1000;
/// How often such calls are looked for.
const PERIOD: Duration = Duration::from_millis(100);
/// Time for a child to end by itself.
const LAST_CALL: Duration = Duration::from_secs(2);

/// The program and arguments that start a child.
static PROGRAM: OnceLock<Vec<OsString>> = OnceLock::new();
/// When the command must have ended, and how many seconds it was given.
static LIMIT: Mutex<Option<(Instant, f64)>> = Mutex::new(None);

/// The connections to all children, by their process numbers.
static LINES: Mutex<Vec<Line>> = Mutex::new(Vec::new());
/// Calls that take long have been given up.
static GIVEN_UP: AtomicBool = AtomicBool::new(false);
/// Since when [`Line::busy_since`] counts.
static CLOCK: OnceLock<Instant> = OnceLock::new();

/// A connection that another thread can cut.
struct Line {
    process: u32,
    stream: UnixStream,
    /// When the call that runs began, in ms and from 1; 0 between calls.
    busy_since: Arc<AtomicU64>,
}

/// The time, in ms and from 1.
fn now() -> u64 {
    1 + CLOCK.get_or_init(Instant::now).elapsed().as_millis() as u64
}

/// From here on calls that take long are given up: they end with the fault of an FMU that does not return.
pub fn give_up_calls() {
    GIVEN_UP.store(true, Ordering::Relaxed);
    // Without a thread such calls end after their own limit.
    let _ = std::thread::Builder::new().spawn(|| {
        loop {
            std::thread::sleep(PERIOD);
            cut_long_calls();
        }
    });
}

/// Cuts the connections whose call has run for some time.
fn cut_long_calls() {
    for line in &*LINES.lock().unwrap_or_else(PoisonError::into_inner) {
        let since = line.busy_since.load(Ordering::Relaxed);
        if since > 0 && now().saturating_sub(since) >= LONGEST_LAST_CALL {
            let _ = line.stream.shutdown(std::net::Shutdown::Both);
        }
    }
}

/// Names the program that children run, with its first arguments: any that calls `cli::main`.
pub fn set_program(words: Vec<OsString>) {
    // The first one counts: a process has one program.
    let _ = PROGRAM.set(words);
}

/// Limits the time of all calls together, s from now on; the last part of it is for other things.
pub fn set_limit(seconds: f64, reserve: Duration) {
    let most = Duration::from_secs_f64(seconds.clamp(0.0, 1e9));
    let end = Instant::now().checked_add(most.saturating_sub(reserve));
    *LIMIT.lock().unwrap_or_else(PoisonError::into_inner) = end.map(|end| (end, seconds));
}

/// The time that the next call may take, and the limit to name, s.
fn patience() -> (Duration, f64) {
    let limit = *LIMIT.lock().unwrap_or_else(PoisonError::into_inner);
    match limit {
        Some((end, seconds)) if end < Instant::now() + LONGEST_CALL => {
            let rest = end.saturating_duration_since(Instant::now());
            (rest.max(Duration::from_millis(1)), seconds)
        }
        _ => (LONGEST_CALL, LONGEST_CALL.as_secs_f64()),
    }
}

/// The parent's end of a child process.
pub struct Remote {
    file: String,
    child: Child,
    stream: BufReader<UnixStream>,
    buffer: Vec<u8>,
    /// The limit that the socket has now.
    timeout: Duration,
    load: Load,
    ended: bool,
    /// See [`Line::busy_since`].
    busy_since: Arc<AtomicU64>,
    /// The watched values after the last step.
    now: Vec<f64>,
    /// The instant that the run has come to, s.
    time: f64,
}

fn fault(cause: impl Cause, messages: &[String], kind: ForeignFaultKind) -> ForeignFault {
    let mut diagnostic = Diagnostic::new(cause, Span::NONE);
    for message in messages {
        diagnostic = diagnostic.note(format!("the FMU says: {}", message.trim().escape_debug()));
    }
    ForeignFault { kind, diagnostic: Box::new(diagnostic) }
}

impl Remote {
    /// Starts a child and loads the FMU in it.
    pub fn start(file: &str, load: Load) -> Result<Remote, ForeignFault> {
        let no_process = |why: String| {
            fault(FmuCause::NoProcess { path: file.to_owned(), why }, &[], ForeignFaultKind::Final)
        };
        let words = PROGRAM.get().filter(|words| !words.is_empty());
        let words = words.ok_or_else(|| no_process("its program is not known".to_owned()))?;
        let failed = |e: std::io::Error| no_process(e.to_string());
        let (own, other) = UnixStream::pair().map_err(failed)?;
        let printed = std::io::stderr();
        let printed = std::os::fd::AsFd::as_fd(&printed).try_clone_to_owned().map_err(failed)?;
        let child = Command::new(&words[0])
            .args(&words[1..])
            .arg(COMMAND)
            .stdin(Stdio::from(OwnedFd::from(other)))
            .stdout(Stdio::from(printed))
            // Ctrl-C is for mocc, which ends the run in good order.
            .process_group(0)
            .spawn()
            .map_err(failed)?;
        let busy_since = Arc::new(AtomicU64::new(0));
        if let Ok(stream) = own.try_clone() {
            let line = Line { process: child.id(), stream, busy_since: Arc::clone(&busy_since) };
            LINES.lock().unwrap_or_else(PoisonError::into_inner).push(line);
        }
        let mut remote = Remote {
            file: file.to_owned(),
            child,
            stream: BufReader::new(own),
            now: Vec::new(),
            time: 0.0,
            buffer: Vec::new(),
            timeout: Duration::ZERO,
            load,
            ended: false,
            busy_since,
        };
        remote.instantiate()?;
        Ok(remote)
    }

    /// Makes an instance. It takes the place of the last one.
    fn instantiate(&mut self) -> Result<(), ForeignFault> {
        let order = Order::Load(Box::new(self.load.clone()));
        self.ask(&order, "while it was instantiated").map(|_| ())
    }

    /// Takes it back to where it was before its initialization; from now on it watches these values.
    pub fn renew(&mut self, watched: &[usize]) -> Result<(), ForeignFault> {
        watched.clone_into(&mut self.load.watched);
        self.instantiate()
    }

    /// One order and its answer. A refusal of the FMU is a fault.
    fn ask(&mut self, order: &Order, doing: &str) -> Result<Answer, ForeignFault> {
        self.send(order, doing)?;
        self.answer(Some(doing))
    }

    fn send(&mut self, order: &Order, doing: &str) -> Result<(), ForeignFault> {
        if self.ended || send(self.stream.get_mut(), order, &mut self.buffer).is_err() {
            return Err(self.has_ended(doing));
        }
        Ok(())
    }

    /// The next answer to an order that does this, or to that of a run.
    fn answer(&mut self, doing: Option<&str>) -> Result<Answer, ForeignFault> {
        let (patience, seconds) = patience();
        if patience != self.timeout {
            // The limit only grows shorter near its end; set it when it has changed noticeably.
            self.timeout = patience;
            let _ = self.stream.get_ref().set_read_timeout(Some(patience));
        }
        let begun = now();
        self.busy_since.store(begun, Ordering::Relaxed);
        let answer = receive::<Answer>(&mut self.stream, &mut self.buffer);
        self.busy_since.store(0, Ordering::Relaxed);
        let file = self.file.clone();
        let path = || file.clone();
        match answer {
            Ok(Answer::NotLoaded(why)) => Err(fault(
                FmuCause::NotLoadable { path: path(), why },
                &[],
                ForeignFaultKind::Input,
            )),
            Ok(Answer::NeedsPython(why)) => {
                let cause = FmuCause::NeedsPython { path: path(), why };
                Err(fault(cause, &[], ForeignFaultKind::Input))
            }
            Ok(Answer::NotInstantiated(messages)) => {
                let cause = FmuCause::NotInstantiated { path: path() };
                Err(fault(cause, &messages, ForeignFaultKind::Input))
            }
            Ok(Answer::Failed(failed)) => {
                let FailedCall { time, call, status, messages } = *failed;
                self.time = time;
                let cause = FmuCause::FailedCall { path: path(), call, status };
                Err(fault(cause, &messages, ForeignFaultKind::Final))
            }
            Ok(answer) => {
                if let Answer::Progress(t, ..) | Answer::Stopped(t, _) = answer {
                    self.time = t;
                }
                Ok(answer)
            }
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                let doing = self.long_call(&self.doing(doing));
                self.stop();
                let cause = FmuCause::Hanging { path: path(), seconds, doing };
                Err(fault(cause, &[], ForeignFaultKind::Final))
            }
            Err(_) if GIVEN_UP.load(Ordering::Relaxed) => {
                let doing = self.long_call(&self.doing(doing));
                self.stop();
                let seconds = now().saturating_sub(begun) as f64 / 1e3;
                let cause = FmuCause::Hanging { path: path(), seconds, doing };
                Err(fault(cause, &[], ForeignFaultKind::Final))
            }
            Err(_) => Err(self.has_ended(&self.doing(doing))),
        }
    }

    /// What an order does; a run is at the step that the child has noted.
    fn doing(&self, doing: Option<&str>) -> String {
        let noted = || {
            let file = time_file(Path::new(&self.load.folder), self.child.id());
            let bytes = std::fs::read(file).ok().and_then(|bytes| bytes.try_into().ok());
            bytes.map_or("during initialization".to_owned(), |b| at_time(f64::from_le_bytes(b)))
        };
        doing.map_or_else(noted, str::to_owned)
    }

    /// The call that takes long, as the child names it, and when.
    fn long_call(&self, doing: &str) -> String {
        let file = call_file(Path::new(&self.load.folder), self.child.id());
        match std::fs::read_to_string(file) {
            Ok(name) if name == LOADING => format!("the {name}"),
            Ok(name) if !name.is_empty() => format!("`{name}` {doing}"),
            _ => format!("a call {doing}"),
        }
    }

    /// Ends the child at once, and what the FMU has started in its group.
    fn stop(&mut self) {
        self.ended = true;
        end_group(self.child.id());
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// The child has ended by itself: why.
    fn has_ended(&mut self, doing: &str) -> ForeignFault {
        let how = match (self.ended, self.child.wait()) {
            (true, _) | (_, Err(_)) => "its process ended".to_owned(),
            (_, Ok(status)) => match status.signal() {
                Some(signal) => format!("its process was ended by signal {}", signal_name(signal)),
                None => format!("it ended its process with status {}", status.code().unwrap_or(0)),
            },
        };
        self.ended = true;
        let doing = doing.to_owned();
        fault(
            FmuCause::Crashed { path: self.file.clone(), how, doing },
            &[],
            ForeignFaultKind::Final,
        )
    }

    fn damaged(&self) -> ForeignFault {
        let why = "its messages cannot be read".to_owned();
        fault(FmuCause::NoProcess { path: self.file.clone(), why }, &[], ForeignFaultKind::Final)
    }

    /// A step's answer: the instant that it has reached, and whether the FMU ends the run.
    fn stepped(&mut self, order: &Order, doing: &str) -> Result<AfterStep, ForeignFault> {
        match self.ask(order, doing)? {
            Answer::Stepped(reached, ends, values) => {
                self.now = values;
                Ok(AfterStep { reached, asks_for_event: false, ends })
            }
            Answer::Stopped(time, stop) => {
                Err(fault(cause_of(stop, time), &[], ForeignFaultKind::Final))
            }
            _ => Err(self.damaged()),
        }
    }

    /// Initialises it from `start`, s, on with these values, for steps.
    pub fn begin(
        &mut self,
        [start, stop]: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<(), ForeignFault> {
        let order = Order::Begin([start, stop, tolerance], values.to_vec());
        self.stepped(&order, "during initialization").map(drop)
    }

    /// Steps from `t` by `size`, s, with these inputs.
    pub fn step(
        &mut self,
        t: f64,
        size: f64,
        inputs: &[(usize, f64)],
    ) -> Result<AfterStep, ForeignFault> {
        self.stepped(&Order::Step(t, size, inputs.to_vec()), &at_time(t))
    }

    /// The watched values after the last step.
    pub fn values(&self) -> &[f64] {
        &self.now
    }

    /// Carries out a run. The instance is of no further use until it is [renewed](Self::renew).
    pub fn run(
        &mut self,
        task: &ForeignTask,
        observer: &mut dyn ForeignObserver,
    ) -> Result<ForeignOutcome, ForeignFailure> {
        self.time = task.span[0];
        let followed = self.follow(task, observer);
        followed.map_err(|why| ForeignFailure { time: self.time, why })
    }

    fn follow(
        &mut self,
        task: &ForeignTask,
        observer: &mut dyn ForeignObserver,
    ) -> Result<ForeignOutcome, Obstacle<ForeignFault>> {
        let sent = self.send(&Order::Run(Box::new(task.clone())), "at the start of the run");
        sent.map_err(Obstacle::Fault)?;
        loop {
            let answer = self.answer(None).map_err(Obstacle::Fault)?;
            match answer {
                Answer::Progress(t, counters, items) => {
                    let mut goes_on = true;
                    for item in items {
                        match item {
                            Item::Row(t, values) => goes_on &= observer.row(t, &values),
                            Item::Event(t, what) => observer.event(t, what),
                        }
                    }
                    if !goes_on || !observer.goes_on(t, &counters) {
                        // The child would go on to the end.
                        self.stop();
                        let (end, interrupted) = (t, true);
                        let integrates = !self.load.shape.steps_itself;
                        let method = integrates.then(|| (task.method.clone(), None));
                        let outcome = ForeignOutcome::default();
                        return Ok(ForeignOutcome {
                            counters,
                            method,
                            end,
                            interrupted,
                            ..outcome
                        });
                    }
                }
                Answer::Ended(outcome) => return Ok(outcome),
                Answer::Stopped(_, stop) => return Err(Obstacle::Stop(stop)),
                _ => return Err(Obstacle::Fault(self.damaged())),
            }
        }
    }
}

fn at_time(t: f64) -> String {
    format!("at time {t} s")
}

/// The names of the signals that end faulty programs.
fn signal_name(signal: i32) -> String {
    let name = match signal {
        4 => "SIGILL",
        6 => "SIGABRT",
        7 => "SIGBUS",
        8 => "SIGFPE",
        9 => "SIGKILL",
        11 => "SIGSEGV",
        15 => "SIGTERM",
        _ => return signal.to_string(),
    };
    format!("{signal} ({name})")
}

impl Drop for Remote {
    fn drop(&mut self) {
        let own = self.child.id();
        LINES.lock().unwrap_or_else(PoisonError::into_inner).retain(|line| line.process != own);
        if self.ended {
            return;
        }
        // A child that does not return is killed.
        let _ = send(self.stream.get_mut(), &Order::Leave, &mut self.buffer);
        let _ = self.stream.get_ref().shutdown(std::net::Shutdown::Both);
        let until = Instant::now() + LAST_CALL.min(patience().0);
        while Instant::now() < until {
            if matches!(self.child.try_wait(), Ok(Some(_)) | Err(_)) {
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        self.stop();
    }
}
