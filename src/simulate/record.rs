//! Rows and events on their way out.

use std::sync::Arc;

use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::ir::trajectory::{Column, ColumnStorage, Constant, Event, Trajectory};
use crate::runtime::machine::Machine;

use super::columns::column_storage;
use super::settings::Settings;

/// Takes what a run records. `row` is called in order of time, at events twice.
pub trait Sink {
    /// The variables, once before all rows.
    fn begin(&mut self, columns: Vec<Column>);
    /// About how many rows there will be, once before all rows.
    fn expect(&mut self, _rows: usize) {}
    /// False: [`Sink::constants`] is not called.
    fn wants_constants(&self) -> bool {
        true
    }
    /// Parameters and constants, once after `begin`.
    fn constants(&mut self, _: Vec<Constant>) {}
    /// One value for each variable.
    fn row(&mut self, time: f64, values: &[f64]);
    /// What is known of the columns, once before the rows. A sink that answers with true gets only the
    /// first row whole; of all others what goes its own way, by [`Sink::own_columns`], and then
    /// [`Sink::end`].
    fn column_storage(&mut self, _: Vec<ColumnStorage>) -> bool {
        false
    }
    /// As [`Sink::rows`], without the columns whose course is known, and column by column: the values of
    /// each begin `stride` after those of the one before.
    fn own_columns(&mut self, _times: &[f64], _values: &[f64], _stride: usize) {}
    /// Called once after the last row, of a run that failed too.
    fn end(&mut self) {}
    /// Several rows, one after the other, for what is faster with many at once. Rows of a run may come
    /// late, but never after an event that follows them, nor after its end.
    fn rows(&mut self, times: &[f64], values: &[f64]) {
        let columns = values.len() / times.len().max(1);
        for (row, time) in times.iter().enumerate() {
            self.row(*time, &values[row * columns..(row + 1) * columns]);
        }
    }
    /// The derivatives of the last row, if the run is differentiated: value by value, input by input.
    fn slopes(&mut self, _slopes: &[f64]) {}
    /// Something happened.
    fn event(&mut self, event: Event);
    /// The model prints a line: to the file of this name, to the terminal if it has none.
    fn print(&mut self, _line: &str, _file: &str) {}
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
    fn wants_constants(&self) -> bool {
        false
    }
    fn column_storage(&mut self, column_storage: Vec<ColumnStorage>) -> bool {
        self.expect_storage(column_storage);
        true
    }
    fn own_columns(&mut self, times: &[f64], values: &[f64], stride: usize) {
        self.push_own_columns(times, values, stride);
    }
    fn end(&mut self) {
        self.complete();
    }
    fn event(&mut self, event: Event) {
        self.events.push(event);
    }
}

/// Events for whose rows there is room from the start.
const EXPECTED_EVENTS: usize = 64;

/// Rows that are handed over together: as many values as a cache near the processor holds.
const BLOCK_VALUES: usize = 1 << 14;
/// And no more rows than this.
const BLOCK_ROWS: usize = 64;

/// What is recorded, and the next instant of the output grid.
pub struct Recorder {
    cells: Vec<(VarId, Slot)>,
    /// What is recorded after the first row, if not all.
    own: Option<Vec<(VarId, Slot)>>,
    narrowed: bool,
    /// Times of the rows that were not handed over yet.
    times: Vec<f64>,
    /// Their values, and room for those of others: row by row, narrowed column by column.
    block: Vec<f64>,
    /// Rows that there is room for.
    rows: usize,
    /// How far the values of one row are apart in the block.
    stride: usize,
    next: u64,
    count: u64,
    start: f64,
    stop: f64,
    interval: f64,
    instants: Option<Arc<[f64]>>,
}

/// Values in a line of the cache.
const LINE: usize = 8;

/// Rows that are handed over together, of so many columns.
fn rows_of_block(columns: usize) -> usize {
    (BLOCK_VALUES / columns.max(1)).clamp(1, BLOCK_ROWS)
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
        let rows = rows_of_block(cells.len());
        let (times, block) = (Vec::with_capacity(rows), vec![0.0; rows * cells.len()]);
        // The start has its row already.
        let passed = |list: &Arc<[f64]>| list.partition_point(|t| *t <= start) as u64;
        let next = instants.as_ref().map_or(1, passed);
        Recorder {
            cells,
            own: None,
            narrowed: false,
            times,
            block,
            rows,
            stride: 1,
            next,
            count,
            start,
            stop,
            interval,
            instants,
        }
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
    pub fn take(&mut self, machine: &Machine<'_>) -> Result<(), VarId> {
        let row = self.times.len();
        let first = if self.narrowed { row } else { row * self.cells.len() };
        let places = self.block[first..].iter_mut().step_by(self.stride);
        let memory = &machine.memory[..];
        let mut fine = true;
        for (place, (_, slot)) in places.zip(&self.cells) {
            *place = memory[*slot as usize];
            fine &= place.is_finite();
        }
        if fine {
            return Ok(());
        }
        let broken = self.cells.iter().find(|(_, slot)| !memory[*slot as usize].is_finite());
        broken.map_or(Ok(()), |(v, _)| Err(*v))
    }

    /// Hands over the row that was taken last, or keeps it for later with those before it.
    pub fn put(&mut self, time: f64, sink: &mut dyn Sink) {
        self.times.push(time);
        if self.times.len() == self.rows {
            self.flush(sink);
        }
    }

    /// Hands over what is left.
    pub fn flush(&mut self, sink: &mut dyn Sink) {
        let Recorder { times, block, stride, .. } = self;
        match (times.is_empty(), self.narrowed) {
            (true, _) => {}
            (false, false) => sink.rows(times, &block[..times.len() * self.cells.len()]),
            (false, true) => sink.own_columns(times, block, *stride),
        }
        self.times.clear();
    }

    /// Tells the sink what is known of the columns.
    pub fn announce_storage(&mut self, program: &Program, sink: &mut dyn Sink) {
        let column_storage = column_storage(program);
        let own = self
            .cells
            .iter()
            .zip(&column_storage)
            .filter(|(_, course)| **course == ColumnStorage::Own);
        let own = own.map(|(cell, _)| *cell).collect();
        self.own = sink.column_storage(column_storage).then_some(own);
    }

    /// Hands over the first row, and goes on with what the sink wants of the others.
    pub fn flush_first(&mut self, sink: &mut dyn Sink) {
        self.flush(sink);
        if let Some(own) = self.own.take() {
            self.rows = rows_of_block(own.len());
            // With an odd number of lines between columns they do not displace each other in the cache.
            self.stride = self.rows.next_multiple_of(2 * LINE) + LINE;
            self.block.resize(self.stride * own.len().max(1), 0.0);
            self.cells = own;
            self.narrowed = true;
        }
    }
}
