//! What a model may take before it is refused: components, scalar variables, and work.
//!
//! Limits that are counted, not measured, are the same on every machine, and name the construct that
//! exceeds them. `--max-size` moves them; those of time and memory are `cli::budget`.

use super::Evaluator;
use super::cause::value::ValueCause;
use crate::base::activity;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;

/// Default number of components, and of scalar variables, of a model: some seconds and one or two gigabytes.
pub const DEFAULT_SIZE: usize = 3_000_000;
/// Steps of work for each component that is allowed: one evaluates an expression, or joins two.
const WORK_PER_SIZE: u64 = 10;
/// New expressions for each component that is allowed; they are kept in memory.
const EXPRESSIONS_PER_SIZE: usize = 4;
/// Steps of work between two notes of the activity.
const NOTE_INTERVAL: u64 = 1 << 20;

/// The budget of a model, and what is spent of it.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Number of components, and of scalar variables, that the model may have.
    pub size: usize,
    /// Steps of work so far.
    pub work: u64,
    /// Executions of functions so far.
    pub calls: u64,
    next_note: u64,
    /// A limit is exceeded, which was reported: nothing more is done.
    pub exhausted: bool,
}

impl Budget {
    /// A budget for this number of components and of scalar variables.
    pub fn new(size: usize) -> Budget {
        Budget { size, work: 0, calls: 0, next_note: NOTE_INTERVAL, exhausted: false }
    }

    /// Steps of work that may be spent.
    pub fn most_work(&self) -> u64 {
        WORK_PER_SIZE.saturating_mul(self.size as u64)
    }
}

impl Default for Budget {
    fn default() -> Budget {
        Budget::new(DEFAULT_SIZE)
    }
}

impl Evaluator<'_> {
    /// Spends steps of work on the construct at `span`; `None` if the budget is exhausted.
    pub(crate) fn spend(&mut self, steps: u64, span: Span) -> Option<()> {
        if self.budget.exhausted {
            return None;
        }
        self.budget.work = self.budget.work.saturating_add(steps);
        if self.budget.work >= self.budget.next_note {
            self.budget.next_note = self.budget.work + NOTE_INTERVAL;
            activity::note(format!("flattening the model, step {}", self.budget.work));
        }
        let most = self.budget.most_work();
        let most_expressions = EXPRESSIONS_PER_SIZE.saturating_mul(self.budget.size);
        if self.budget.work <= most && self.graph.len() <= most_expressions {
            return Some(());
        }
        self.budget.exhausted = true;
        let (variables, components) = (self.instance_of.len(), self.instances.len());
        let cause = ValueCause::TooMuchWork { most, variables, components };
        self.problems.push(Diagnostic::new(cause, span).label("the limit is reached here"));
        None
    }
}
