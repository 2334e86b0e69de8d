//! How a front end watches a calibration or a diagnosis, and ends it early.

use std::fmt;

use super::cancellation::Cancellation;

use crate::base::diag::Problems;
use crate::base::source::SourceMap;

/// Progress of a calibration or a diagnosis.
#[derive(Clone, PartialEq, Debug)]
pub enum Event<'a> {
    /// The fit has made a step.
    Step {
        /// Steps so far.
        number: u32,
        /// Reduced sum of squares of the training recordings.
        chi2: f64,
    },
    /// The confidence interval of a parameter comes next.
    Interval {
        /// Its name.
        parameter: &'a str,
        /// Its number, from 1.
        number: usize,
        /// Number of parameters.
        count: usize,
    },
    /// The best result so far, with its evidence.
    Best(&'a str),
    /// Anything else, as a line of a log.
    Note(&'a str),
}

impl fmt::Display for Event<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Event::Step { number, chi2 } => {
                write!(f, "step {number}: reduced chi-square {chi2:.4}")
            }
            Event::Interval { parameter, number, count } => {
                write!(f, "interval of {parameter} ({number} of {count})")
            }
            Event::Best(text) => write!(f, "best so far: {text}"),
            Event::Note(text) => f.write_str(text),
        }
    }
}

/// A front end that watches a calibration or a diagnosis. All methods have defaults: `&()` observes nothing
/// and never cancels.
pub trait Observer {
    /// Called once, after the plan, the recordings and the model have been checked and before the first
    /// fit. A front end shows the warnings of the session and prepares its output here; an error ends the run
    /// before it has cost anything.
    fn start(&self, _problems: &Problems, _sources: &SourceMap) -> Result<(), String> {
        Ok(())
    }

    /// Called while the run makes progress.
    fn event(&self, _event: &Event<'_>) {}

    /// Whether the run is to end. It ends after the current step, and returns what it has found so far.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// The same question for runs, which other threads do.
    fn cancellation(&self) -> Cancellation {
        Cancellation::default()
    }
}

impl Observer for () {}
