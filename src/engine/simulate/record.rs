//! Recording: passes rows and events of a run to a sink.

use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::ir::trajectory::{Column, ColumnStorage, Constant, Event, Trajectory};
use crate::runtime::machine::Machine;

use super::columns::{column_storage, columns};
use super::grid::Grid;
use super::settings::Settings;

/// Receives the results of a run. Rows come in order of time; an event has two.
pub trait Sink {
    /// The recorded variables; called once before all rows.
    fn begin(&mut self, columns: Vec<Column>);
    /// If false, the sink knows the recorded variables, and [`Sink::begin`] gets an empty list.
    fn wants_columns(&self) -> bool {
        true
    }
    /// The approximate number of rows; called once before all rows.
    fn expect(&mut self, _rows: usize) {}
    /// If false, [`Sink::constants`] is not called.
    fn wants_constants(&self) -> bool {
        true
    }
    /// Parameters and constants; called once after `begin`.
    fn constants(&mut self, _: Vec<Constant>) {}
    /// A row: one value for each variable.
    fn row(&mut self, time: f64, values: &[f64]);
    /// How each column is determined; called once before the rows. A sink that returns true
    /// receives only the first row completely, and of all others only the independent columns
    /// ([`Sink::own_columns`]).
    fn column_storage(&mut self, _: Vec<ColumnStorage>) -> bool {
        false
    }
    /// As [`Sink::rows`] for the independent columns, in column-major order: columns start `stride`
    /// values apart.
    fn own_columns(&mut self, _times: &[f64], _values: &[f64], _stride: usize) {}
    /// Called once after the last row, also if the run failed.
    fn end(&mut self) {}
    /// Several consecutive rows, for sinks that process them faster together. Rows may be delayed,
    /// but never past a subsequent event or the end of the run.
    fn rows(&mut self, times: &[f64], values: &[f64]) {
        let columns = values.len() / times.len().max(1);
        for (row, time) in times.iter().enumerate() {
            self.row(*time, &values[row * columns..(row + 1) * columns]);
        }
    }
    /// The sensitivities of the last row, if requested: value by value, input by input.
    fn slopes(&mut self, _slopes: &[f64]) {}
    /// An event.
    fn event(&mut self, event: Event);
    /// A line printed by the model: to the file of this name, or to the terminal if it is empty.
    fn print(&mut self, _line: &str, _file: &str) {}
    /// Called after each step with its end time, s. Return false to end the run.
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

/// Announces the recorded variables of a program.
pub fn begin(program: &Program, sink: &mut dyn Sink) {
    let columns = if sink.wants_columns() { columns(program) } else { Vec::new() };
    sink.begin(columns);
}

/// Number of events whose rows are included in the estimated row count.
const EXPECTED_EVENTS: usize = 64;

/// Maximum number of values in a block of rows, chosen to fit into the L1 cache.
const BLOCK_VALUES: usize = 1 << 14;
/// Maximum number of rows in a block.
const BLOCK_ROWS: usize = 64;

/// Collects rows in blocks, and tracks the output grid.
pub struct Recorder {
    slots: Vec<(VarId, Slot)>,
    /// The independent variables, if only they are recorded after the first row.
    own: Option<Vec<(VarId, Slot)>>,
    narrowed: bool,
    /// Times of the rows in the block.
    times: Vec<f64>,
    /// Values of the block: row-major, or column-major if narrowed.
    block: Vec<f64>,
    /// Capacity in rows.
    rows: usize,
    /// Distance between the values of a row.
    stride: usize,
    /// Time of the last row.
    last: f64,
    grid: Grid,
}

/// Values per cache line.
const LINE: usize = 8;

/// Copies the values in these slots; true if all are finite.
fn copy<'a>(
    places: impl Iterator<Item = &'a mut f64>,
    slots: &[(VarId, Slot)],
    memory: &[f64],
) -> bool {
    let mut is_fine = true;
    for (place, (_, slot)) in places.zip(slots) {
        *place = memory[*slot as usize];
        is_fine &= place.is_finite();
    }
    is_fine
}

/// Number of rows in a block with this many columns.
fn rows_of_block(columns: usize) -> usize {
    (BLOCK_VALUES / columns.max(1)).clamp(1, BLOCK_ROWS)
}

impl Recorder {
    /// Records the variables selected in the program at the instants given by the settings.
    pub fn new(program: &Program, settings: &Settings) -> Self {
        let Settings { start, stop, interval, .. } = *settings;
        let grid = Grid::new([start, stop], interval, settings.instants.clone());
        let slots: Vec<(VarId, Slot)> =
            program.recorded.iter().map(|&v| (v, program.slot(v))).collect();
        let rows = rows_of_block(slots.len());
        let (times, block) = (Vec::with_capacity(rows), vec![0.0; rows * slots.len()]);
        Recorder {
            slots,
            own: None,
            narrowed: false,
            times,
            block,
            rows,
            stride: 1,
            last: f64::NAN,
            grid,
        }
    }

    /// The next instant of the grid, if it is before `end`, or equal to it if `inclusive`.
    pub fn due(&self, end: f64, inclusive: bool) -> Option<f64> {
        self.grid.due(end, inclusive)
    }

    /// The rows of the grid, and two rows for each of some events.
    pub fn expected_rows(&self) -> usize {
        const MAX_ROWS: u64 = 1 << 20;
        self.grid.total().min(MAX_ROWS) as usize + 2 * EXPECTED_EVENTS
    }

    /// Advances to the next instant of the grid.
    pub fn advance(&mut self) {
        self.grid.advance();
    }

    /// True if the last row is at this time.
    pub fn has_row_at(&self, t: f64) -> bool {
        self.last == t
    }

    /// Copies the values of a row; the error is a variable that is not finite.
    pub fn take(&mut self, machine: &Machine<'_>) -> Result<(), VarId> {
        let (row, memory) = (self.times.len(), &machine.memory[..]);
        let is_fine = match self.narrowed {
            true => copy(self.block[row..].iter_mut().step_by(self.stride), &self.slots, memory),
            false => copy(self.block[row * self.slots.len()..].iter_mut(), &self.slots, memory),
        };
        if is_fine {
            return Ok(());
        }
        let broken = self.slots.iter().find(|(_, slot)| !memory[*slot as usize].is_finite());
        broken.map_or(Ok(()), |(v, _)| Err(*v))
    }

    /// Completes the row that was taken last; passes the block to the sink if it is full.
    pub fn put(&mut self, time: f64, sink: &mut dyn Sink) {
        self.times.push(time);
        self.last = time;
        if self.times.len() == self.rows {
            self.flush(sink);
        }
    }

    /// Passes the remaining rows to the sink.
    pub fn flush(&mut self, sink: &mut dyn Sink) {
        let Recorder { times, block, stride, .. } = self;
        match (times.is_empty(), self.narrowed) {
            (true, _) => {}
            (false, false) => sink.rows(times, &block[..times.len() * self.slots.len()]),
            (false, true) => sink.own_columns(times, block, *stride),
        }
        self.times.clear();
    }

    /// Announces to the sink how each column is determined.
    pub fn announce_storage(&mut self, program: &Program, sink: &mut dyn Sink) {
        let column_storage = column_storage(program);
        let own = self
            .slots
            .iter()
            .zip(&column_storage)
            .filter(|(_, storage)| **storage == ColumnStorage::Own);
        let own = own.map(|(cell, _)| *cell).collect();
        self.own = sink.column_storage(column_storage).then_some(own);
    }

    /// Passes the first row to the sink, then narrows recording to independent columns if the sink
    /// supports it.
    pub fn flush_first(&mut self, sink: &mut dyn Sink) {
        self.flush(sink);
        if let Some(own) = self.own.take() {
            self.rows = rows_of_block(own.len());
            // An odd number of cache lines between columns avoids conflicts in the cache.
            self.stride = self.rows.next_multiple_of(2 * LINE) + LINE;
            self.block.resize(self.stride * own.len().max(1), 0.0);
            self.slots = own;
            self.narrowed = true;
        }
    }
}
