//! The terminal as the observer of a calibration or a diagnosis.

use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::time::Instant;

use super::progress::Working;
use super::{Status, interrupt, running, say, say_problems};
use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::calibrate::cancellation::Cancellation;
use crate::calibrate::observer::{Event, Observer};
use crate::calibrate::run::CalibrationError;
use crate::driver::compile::Session;
use crate::io::atomic_file::create_folder;

/// Shows diagnostics and progress on the standard error, creates the folder of the results, and cancels on
/// Ctrl-C.
pub struct Terminal {
    folder: PathBuf,
    /// When the command began, if notes are to be shown.
    pub log_since: Option<Instant>,
    /// When the run is cancelled.
    pub deadline: Option<Instant>,
    /// The best result so far.
    best: RefCell<String>,
    /// Everything was checked, and the diagnostics are on the screen.
    started: Cell<bool>,
    working: RefCell<Option<Working>>,
}

impl Terminal {
    /// A terminal for a command whose results go to `folder`.
    pub fn new(folder: PathBuf) -> Terminal {
        let (started, working) = (Cell::new(false), RefCell::new(None));
        let best = RefCell::new(String::new());
        Terminal { folder, log_since: None, deadline: None, best, started, working }
    }

    /// Replaces the progress line.
    fn say(&self, what: &str) {
        if let Some(working) = &*self.working.borrow() {
            working.say(what.to_owned());
        }
    }

    /// Removes the progress line.
    pub fn finish(&self) {
        self.working.replace(None);
    }

    /// Shows why there is no result.
    pub fn failed(&self, error: &CalibrationError, session: &Session) -> Status {
        self.finish();
        if !self.started.get() {
            say(session);
        }
        match error {
            CalibrationError::Invalid(error) => (*error).into(),
            CalibrationError::Failed(failure) => running::failed(failure, &session.sources),
            CalibrationError::Unreadable { .. } | CalibrationError::Refused(_) => {
                eprintln!("error: {error}");
                Status::Usage
            }
        }
    }
}

impl Observer for Terminal {
    fn start(&self, problems: &Problems, sources: &SourceMap) -> Result<(), String> {
        self.started.set(true);
        say_problems(problems, sources);
        // From here on Ctrl-C requests an end, so that the results so far can be written.
        interrupt::listen();
        create_folder(&self.folder).map_err(|e| e.to_string())?;
        self.working.replace(Some(Working::new()));
        Ok(())
    }

    fn event(&self, event: &Event<'_>) {
        match (event, self.log_since) {
            (Event::Note(_) | Event::Best(_), Some(since)) => {
                eprintln!("{:7.2} s  {event}", since.elapsed().as_secs_f64());
            }
            (Event::Best(_), None) => {
                self.best.replace(event.to_string());
                self.say(&self.best.borrow());
            }
            (Event::Note(text), None) => {
                let best = self.best.borrow();
                self.say(&format!(
                    "{best}{}{}",
                    if best.is_empty() { "" } else { "; " },
                    text.trim()
                ));
            }
            (Event::Step { .. } | Event::Interval { .. }, _) => self.say(&event.to_string()),
        }
    }

    fn is_cancelled(&self) -> bool {
        interrupt::is_requested() || self.deadline.is_some_and(|at| Instant::now() >= at)
    }

    fn cancellation(&self) -> Cancellation {
        let deadline = self.deadline;
        Cancellation::when(move || {
            interrupt::is_requested() || deadline.is_some_and(|at| Instant::now() >= at)
        })
    }
}
