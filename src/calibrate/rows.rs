//! The rows of a run at the instants of a recording.

use std::sync::Arc;

use super::cancellation::Cancellation;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::trajectory::{Column, Event};
use crate::simulate::cause::RunCause;
use crate::simulate::failure::Failure;
use crate::simulate::record::Sink;
use crate::simulate::run::Statistics;

/// Collects the rows at the instants of a recording.
#[derive(Clone)]
pub struct Rows {
    instants: Arc<[f64]>,
    /// The next instant.
    next: usize,
    /// The last row belongs to an instant.
    taken: bool,
    /// Number of recorded variables.
    pub width: usize,
    /// Values, row by row.
    pub values: Vec<f64>,
    /// Derivatives by the inputs, row by row and variable by variable.
    pub slopes: Vec<f64>,
    cancellation: Cancellation,
    /// Nobody waits for the run any more.
    is_cancelled: bool,
}

impl Rows {
    /// The rows of a run at `instants`, of `width` variables with derivatives by `inputs` inputs, and its statistics.
    /// Errors: that of the run, or that it has no row at one of the instants, as when it is cancelled.
    pub fn of(
        cancellation: &Cancellation,
        instants: Arc<[f64]>,
        [width, inputs]: [usize; 2],
        run: impl FnOnce(&mut Rows) -> Result<Statistics, Failure>,
    ) -> Result<(Rows, Statistics), Failure> {
        let n = instants.len();
        let (values, slopes) = (vec![0.0; n * width], vec![0.0; n * width * inputs]);
        let mut rows = Rows {
            instants,
            next: 0,
            taken: false,
            width,
            values,
            slopes,
            cancellation: cancellation.clone(),
            is_cancelled: false,
        };
        let statistics = run(&mut rows)?;
        match rows.missing() {
            None => Ok((rows, statistics)),
            Some(_) if rows.is_cancelled => Err(Failure::settings("the run was cancelled".into())),
            Some(row) => Err(incomplete(row, &statistics)),
        }
    }

    /// The first instant without a row, s.
    fn missing(&self) -> Option<f64> {
        self.instants.get(self.next).copied()
    }
}

/// Why a run without a row is of no use: the model ended it, or mocc lost the row.
fn incomplete(row: f64, statistics: &Statistics) -> Failure {
    let time = statistics.end;
    match &statistics.terminated {
        Some(why) => {
            let cause = RunCause::EndsBeforeRow { time, row, why: why.clone() };
            Failure::numerics(time, Diagnostic::new(cause, Span::NONE))
        }
        None => Failure::bug(row, format!("the run to {time} s has no row at {row} s")),
    }
}

impl Sink for Rows {
    fn begin(&mut self, _columns: Vec<Column>) {}

    fn row(&mut self, time: f64, values: &[f64]) {
        let again = self.next > 0 && self.instants[self.next - 1] == time;
        self.taken = again || self.instants.get(self.next) == Some(&time);
        if !self.taken {
            return;
        }
        self.next += usize::from(!again);
        let at = (self.next - 1) * self.width;
        self.values[at..at + self.width].copy_from_slice(values);
    }

    fn slopes(&mut self, slopes: &[f64]) {
        if self.taken && self.next > 0 {
            let at = (self.next - 1) * slopes.len();
            self.slopes[at..at + slopes.len()].copy_from_slice(slopes);
        }
    }

    fn event(&mut self, _event: Event) {}

    fn goes_on(&mut self, _: f64) -> bool {
        self.is_cancelled = self.cancellation.is_requested();
        !self.is_cancelled
    }
}
