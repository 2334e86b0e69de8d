//! Rows and events on their way out.

use std::sync::Arc;

use crate::codegen::interp::Instance;
use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::ir::trajectory::{Column, Constant, Event, Trajectory};

use super::settings::Settings;

/// Takes what a run records. `row` is called in order of time, at events twice.
pub trait Sink {
    /// The variables, once before all rows.
    fn begin(&mut self, columns: Vec<Column>);
    /// About how many rows there will be, once before all rows.
    fn expect(&mut self, _rows: usize) {}
    /// Parameters and constants, once after `begin`.
    fn constants(&mut self, _: Vec<Constant>) {}
    /// One value for each variable.
    fn row(&mut self, time: f64, values: &[f64]);
    /// The derivatives of the last row, if the run is differentiated: value by value, input by input.
    fn slopes(&mut self, _slopes: &[f64]) {}
    /// Something happened.
    fn event(&mut self, event: Event);
    /// Called after each step with the time that it reached, s. False ends the run there.
    fn goes_on(&mut self, _: f64) -> bool {
        true
    }
}

impl Sink for Trajectory {
    fn begin(&mut self, columns: Vec<Column>) {
        self.begin_again(columns);
    }
    fn expect(&mut self, rows: usize) {
        self.reserve(rows);
    }
    fn row(&mut self, time: f64, values: &[f64]) {
        self.push(time, values);
    }
    fn event(&mut self, event: Event) {
        self.events.push(event);
    }
}

/// Events for whose rows there is room from the start.
const EXPECTED_EVENTS: usize = 64;

/// What is recorded, and the next instant of the output grid.
pub struct Recorder {
    cells: Vec<(VarId, Slot)>,
    row: Vec<f64>,
    next: u64,
    count: u64,
    start: f64,
    stop: f64,
    interval: f64,
    instants: Option<Arc<[f64]>>,
}

impl Recorder {
    /// Records what the program says, at the instants that the settings ask for.
    pub fn new(program: &Program, settings: &Settings) -> Self {
        let Settings { start, stop, interval, .. } = *settings;
        let instants = settings.instants.clone();
        let cells: Vec<(VarId, Slot)> =
            program.recorded.iter().map(|&v| (v, program.slot(v))).collect();
        // A last interval that is only rounding is none.
        let intervals = (stop - start) / interval;
        let count = if stop > start { (intervals - 1e-9).ceil() as u64 } else { 0 };
        let row = vec![0.0; cells.len()];
        // The start has its row already.
        let passed = |list: &Arc<[f64]>| list.partition_point(|t| *t <= start) as u64;
        let next = instants.as_ref().map_or(1, passed);
        Recorder { row, cells, next, count, start, stop, interval, instants }
    }

    /// The next instant of the grid if it lies before `end`, or at it if `inclusive`.
    pub fn due(&self, end: f64, inclusive: bool) -> Option<f64> {
        if let Some(list) = &self.instants {
            let at = *list.get(self.next as usize)?;
            return (at < end || (inclusive && at <= end)).then_some(at);
        }
        let at = match self.next.cmp(&self.count) {
            std::cmp::Ordering::Less => self.start + self.next as f64 * self.interval,
            std::cmp::Ordering::Equal => self.stop,
            std::cmp::Ordering::Greater => return None,
        };
        (at < end || (inclusive && at == end)).then_some(at)
    }

    /// Rows that are due, and two for each of a few events.
    pub fn expected_rows(&self) -> usize {
        const MOST: u64 = 1 << 20;
        let due = self.instants.as_ref().map_or(self.count, |list| list.len() as u64);
        (due.min(MOST) + 1) as usize + 2 * EXPECTED_EVENTS
    }

    /// Goes on to the next instant of the grid.
    pub fn advance(&mut self) {
        self.next += 1;
    }

    /// Takes the values of a row; the variable that is not finite if there is one.
    pub fn take(&mut self, instance: &Instance<'_>) -> Result<(), VarId> {
        for (value, (v, slot)) in self.row.iter_mut().zip(&self.cells) {
            *value = instance.get(*slot);
            if !value.is_finite() {
                return Err(*v);
            }
        }
        Ok(())
    }

    /// Writes the row that was taken last.
    pub fn put(&self, time: f64, sink: &mut dyn Sink) {
        sink.row(time, &self.row);
    }
}
