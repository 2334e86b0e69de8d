//! The child process of an FMU: carries out the orders that it reads from its standard input, which is a socket.
//!
//! Its answers go the same way. If mocc ends without an order to do so, even while the FMU does not return, the
//! child removes the folder of the FMU and ends. A call that takes long is named in a file in that folder, for the
//! message about one that does not return.

use std::io::{self, BufReader};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Barrier};
use std::time::Duration;

use super::hosted::{CallFault, Hosted};
use super::library::current_call::current_call;
use super::library::process::end_at_once;
use super::library::{Trouble, keep_loaded, messages};
use super::message::{Answer, FailedCall, Load, Order, receive, send};
use super::progress::Progress;
use crate::ir::foreign::{AfterStep, ForeignInstance, Obstacle};
use crate::simulate::foreign::coupled::Coupled;
use crate::simulate::foreign::{Met, carry_out};

/// Time between two looks after the parent process and the call that runs.
const LOOK: Duration = Duration::from_millis(100);
/// Time in which the parent process has gone if the stream ends without an order.
const FAREWELL: Duration = Duration::from_secs(1);

/// The instance, and what drives it.
enum Work {
    /// Before its run, or between its own steps.
    Plain(Box<Hosted>),
    /// mocc integrates it from step to step.
    Coupled(Box<Coupled<Hosted>>),
}

/// Serves until the end of the stream. Errors: the standard input is not a socket.
pub fn serve() -> io::Result<()> {
    let mut stream = BufReader::new(UnixStream::from(io::stdin().as_fd().try_clone_to_owned()?));
    let mut buffer = Vec::new();
    let mut work: Option<Work> = None;
    let mut progress: Option<Progress> = None;
    while let Ok(order) = receive::<Order>(&mut stream, &mut buffer) {
        let answer = match order {
            Order::Leave => return Ok(()),
            Order::Load(load) => {
                if progress.is_none() {
                    progress = Some(begin(&load, stream.get_ref())?);
                    keep_loaded(&load);
                }
                // The instance of the last run goes first: an FMU may allow only one.
                work = None;
                match Hosted::new(*load) {
                    Ok(made) => {
                        work = Some(Work::Plain(Box::new(made)));
                        Answer::Done
                    }
                    Err(trouble) => answer_of(trouble),
                }
            }
            Order::Run(task) => match (&mut work, &mut progress) {
                (Some(Work::Plain(instance)), Some(progress)) => {
                    progress.begin();
                    let outcome = carry_out(&instance.shape(), &mut **instance, &task, progress);
                    progress.flush();
                    outcome.map_or_else(failed, Answer::Ended)
                }
                _ => answer_of(Trouble::NotInstantiated),
            },
            Order::Begin(span, values) => match work.take() {
                Some(Work::Plain(instance)) => match first(*instance, span, &values) {
                    Ok((new, answer)) => {
                        work = Some(new);
                        answer
                    }
                    Err(met) => failed(met),
                },
                _ => answer_of(Trouble::NotInstantiated),
            },
            Order::Step(t, size, inputs) => match &mut work {
                Some(work) => work.step(t, size, &inputs).unwrap_or_else(failed),
                None => answer_of(Trouble::NotInstantiated),
            },
        };
        if send(stream.get_mut(), &answer, &mut buffer).is_err() {
            break;
        }
    }
    // The thread that looks after the parent removes the folder when it has gone.
    std::thread::sleep(FAREWELL);
    Ok(())
}

/// Looks after the parent process from now on; the channel for the rows of runs.
fn begin(load: &Load, stream: &UnixStream) -> io::Result<Progress> {
    let folder = PathBuf::from(&load.folder);
    let progress = Progress::new(stream.try_clone()?, &time_file(&folder, std::process::id()));
    watch(folder);
    Ok(progress)
}

/// Initialises an instance for steps.
fn first(
    mut instance: Hosted,
    [start, stop, tolerance]: [f64; 3],
    values: &[(usize, f64)],
) -> Result<(Work, Answer), Met<CallFault>> {
    let mut now = vec![0.0; instance.watched_count()];
    let (shape, inputs) = (instance.shape(), instance.inputs().to_vec());
    let work = match shape.steps_itself {
        true => {
            let fault = |fault| (start, Obstacle::Fault(fault));
            instance.initialise([start, stop], tolerance, values).map_err(fault)?;
            instance.values(None, &mut now).map_err(fault)?;
            Work::Plain(Box::new(instance))
        }
        false => {
            let mut new =
                Coupled::begin(instance, &shape, &inputs, [start, stop], tolerance, values)?;
            new.values(&mut now)?;
            Work::Coupled(Box::new(new))
        }
    };
    Ok((work, Answer::Stepped(start, false, now)))
}

impl Work {
    fn step(
        &mut self,
        t: f64,
        size: f64,
        inputs: &[(usize, f64)],
    ) -> Result<Answer, Met<CallFault>> {
        let AfterStep { reached, ends, .. } = match self {
            Work::Plain(instance) => {
                let stepped = instance.step(t, size, inputs);
                stepped.map_err(|fault| (t, Obstacle::Fault(fault)))?
            }
            Work::Coupled(coupled) => coupled.step(t, size, inputs)?,
        };
        let now = match self {
            Work::Plain(instance) => {
                let mut now = vec![0.0; instance.watched_count()];
                let taken = instance.values(None, &mut now);
                taken.map_err(|fault| (reached, Obstacle::Fault(fault)))?;
                now
            }
            Work::Coupled(coupled) => {
                let mut now = vec![0.0; coupled.instance().watched_count()];
                coupled.values(&mut now)?;
                now
            }
        };
        Ok(Answer::Stepped(reached, ends, now))
    }
}

/// The file in the folder of an FMU in which a child names the call that takes long.
pub fn call_file(folder: &Path, process: u32) -> PathBuf {
    folder.join(format!("call-{process}"))
}

/// The file in the folder of an FMU in which a child notes the instant that its run has come to.
pub fn time_file(folder: &Path, process: u32) -> PathBuf {
    folder.join(format!("time-{process}"))
}

/// The answer about an instance that was not made.
fn answer_of(trouble: Trouble) -> Answer {
    let doing = "while it was instantiated".to_owned();
    failed((0.0, Obstacle::Fault(CallFault { trouble, messages: messages(), doing })))
}

/// The answer about a run that cannot go on.
fn failed((time, why): Met<CallFault>) -> Answer {
    match why {
        Obstacle::Stop(stop) => Answer::Stopped(time, stop),
        Obstacle::Fault(fault) => {
            let CallFault { trouble, messages, doing } = fault;
            match trouble {
                Trouble::NotLoaded(why) => Answer::NotLoaded(why),
                Trouble::NeedsPython(why) => Answer::NeedsPython(why),
                Trouble::NotInstantiated => Answer::NotInstantiated(messages),
                Trouble::Failed { call, status } => {
                    let (call, status) = (format!("`{call}` {doing}"), status.to_owned());
                    let failed = FailedCall { time, call, status, messages };
                    Answer::Failed(Box::new(failed))
                }
            }
        }
    }
}

/// Ends this process when its parent has gone, whatever the FMU does, and removes the folder; until then, names calls
/// that take long.
fn watch(folder: PathBuf) {
    let parent = std::os::unix::process::parent_id();
    let file = call_file(&folder, std::process::id());
    let begun = Arc::new(Barrier::new(2));
    let has_begun = Arc::clone(&begun);
    let look = move || {
        has_begun.wait();
        let (mut last, mut named) = (0, 0);
        loop {
            std::thread::sleep(LOOK);
            if std::os::unix::process::parent_id() != parent {
                let _ = std::fs::remove_dir_all(&folder);
                end_at_once();
            }
            let (number, name) = current_call();
            if number == last && number != named && !name.is_empty() {
                // Without the file the message names the order alone.
                let _ = std::fs::write(&file, name);
                named = number;
            } else if number != last && named != 0 {
                let _ = std::fs::remove_file(&file);
                named = 0;
            }
            last = number;
        }
    };
    // Without the thread only an FMU that hangs outlives its parent.
    if std::thread::Builder::new().name("parent".to_owned()).spawn(look).is_ok() {
        // A thread that begins while a library is loaded waits for the loader, which may never return.
        begun.wait();
    }
}
