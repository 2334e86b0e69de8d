//! The terminal as the observer of a calibration or a diagnosis.

use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::time::Instant;

use super::progress::Working;
use super::{Status, interrupt, running, say, say_problems};
use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::calibrate::observer::{Event, Observer};
use crate::calibrate::run::CalibrationError;
use crate::driver::compile::Session;
use crate::io::atomic_file::create_folder;

/// Shows diagnostics and progress on the standard error, creates the folder of the results, and cancels on
/// Ctrl-C.
pub struct Terminal {
    folder: PathBuf,
    /// When the command began, if notes are to be shown.
    log_since: Option<Instant>,
    /// Everything was checked, and the diagnostics are on the screen.
    started: Cell<bool>,
    working: RefCell<Option<Working>>,
}

impl Terminal {
    /// A terminal for a command whose results go to `folder`. Notes are shown if `log_since` is given, with the
    /// time since then.
    pub fn new(folder: PathBuf, log_since: Option<Instant>) -> Terminal {
        let (started, working) = (Cell::new(false), RefCell::new(None));
        Terminal { folder, log_since, started, working }
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
            (Event::Note(text), Some(since)) => {
                eprintln!("{:7.2} s  {text}", since.elapsed().as_secs_f64());
            }
            (Event::Note(_), None) => {}
            (Event::Step { .. } | Event::Interval { .. }, _) => {
                if let Some(working) = &*self.working.borrow() {
                    working.say(event.to_string());
                }
            }
        }
    }

    fn is_cancelled(&self) -> bool {
        interrupt::is_requested()
    }
}
