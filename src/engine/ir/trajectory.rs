//! The result of a run: named columns over time, and the events between them.
//!
//! *Holds:* one row per recorded instant, all values in SI units; at an event two rows with the
//! same time, the left and the right limit in this order; the events in order of time.
//! *Never holds:* NaN or an infinity; a time that decreases; a column longer or shorter than the
//! time; two columns of one name.
//! *Made by:* `simulate`, and `io` from files of measurements. *Read by:* `report`, `measure`, `calibrate`.

use std::collections::BTreeMap;
use std::sync::Arc;

use thiserror::Error;

/// The type of the values of a column; all are stored as `f64`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// A Real that moves between events.
    Continuous,
    /// A Real that moves only at events.
    Discrete,
    /// 0 for false, 1 for true.
    Boolean,
    /// An Integer.
    Integer,
}

/// One recorded variable.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Column {
    /// Full dotted name; elements of arrays as `a[1]` or `a[1,2]`.
    pub name: String,
    /// Unit of the values, SI, such as `m/s2`; empty where there is none.
    pub unit: String,
    /// Unit the model wants shown, such as `bar`; empty where it has no wish.
    pub display_unit: String,
    /// The comment at the declaration; may be empty.
    pub description: String,
    /// The type of the values.
    pub kind: Kind,
}

impl Column {
    /// A continuous column without wishes: the name and the SI unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Column {
            name: name.into(),
            unit: unit.into(),
            display_unit: String::new(),
            description: String::new(),
            kind: Kind::Continuous,
        }
    }
}

/// The part of a column that is known before the simulation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ColumnStorage {
    /// It goes its own way.
    Own,
    /// It keeps the value of the first row.
    Constant,
    /// It is an earlier column, or that column's negative.
    Alias {
        /// Position of the other column, which goes its own way.
        of: usize,
        /// Values have the other sign.
        negated: bool,
    },
}

/// A parameter or a constant, which has no column in a table.
#[derive(Clone, PartialEq, Debug)]
pub struct Constant {
    /// Its name and units.
    pub column: Column,
    /// Its value, SI.
    pub value: f64,
}

/// Something that happened at one instant.
#[derive(Clone, PartialEq, Debug)]
pub struct Event {
    /// When, s.
    pub time: f64,
    /// What, in the user's names, such as `piston.s >= s_max became true`.
    pub what: String,
    /// Where it is written, as `file:line:column`; empty if nowhere.
    pub place: String,
}

/// A run, column by column.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Trajectory {
    /// The variables.
    pub columns: Vec<Column>,
    /// Time of each row, s.
    pub time: Vec<f64>,
    /// One vector per column, each as long as `time`; columns that are equal share one.
    pub data: Vec<Arc<Vec<f64>>>,
    /// The events in order of time.
    pub events: Vec<Event>,
    /// While rows are added: how columns that are not stored yet follow from others.
    pub(crate) column_storage: Vec<ColumnStorage>,
}

/// A broken contract of [`Trajectory`]: a bug in the stage that made it.
#[derive(Clone, PartialEq, Error, Debug)]
pub enum Fault {
    /// `data` and `columns` differ in number.
    #[error("{columns} columns are named but {data} are filled")]
    ColumnCount {
        /// Number of names.
        columns: usize,
        /// Number of value vectors.
        data: usize,
    },
    /// A column is not as long as the time.
    #[error("`{name}` has {found} values for {expected} times")]
    Length {
        /// The column.
        name: String,
        /// Number of its values.
        found: usize,
        /// Number of times.
        expected: usize,
    },
    /// Two columns have one name.
    #[error("two columns are called `{name}`")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A value, a time or the time of an event is NaN or infinite.
    #[error("`{name}` is {value} at time {time} s")]
    NotFinite {
        /// The column, `time`, or `event`.
        name: String,
        /// NaN or an infinity.
        value: f64,
        /// Time of the row, s.
        time: f64,
    },
    /// A row or an event is earlier than the one before it.
    #[error("{what} goes back from {before} s to {after} s")]
    TimeDecreases {
        /// `time` or `event`.
        what: &'static str,
        /// The earlier entry's time, s.
        before: f64,
        /// The later entry's time, s.
        after: f64,
    },
}

impl Trajectory {
    /// A run of these variables without rows yet.
    pub fn new(columns: Vec<Column>) -> Self {
        let data = columns.iter().map(|_| Arc::default()).collect();
        Trajectory { columns, data, ..Trajectory::default() }
    }
    /// Forgets everything for a run of these variables; memory is used again where it can be.
    pub fn begin_again(&mut self, columns: Vec<Column>) {
        self.columns = columns;
        self.time.clear();
        self.events.clear();
        self.column_storage.clear();
        // Backwards: what shares a vector with a column before it leaves the memory to that one.
        for column in self.data.iter_mut().rev() {
            match Arc::get_mut(column) {
                Some(values) => values.clear(),
                None => *column = Arc::default(),
            }
        }
        self.data.resize_with(self.columns.len(), Arc::default);
    }
    /// Makes room for so many rows more, but where a column will share the vector of another.
    pub fn reserve(&mut self, rows: usize) {
        self.time.reserve(rows);
        for (k, column) in self.data.iter_mut().enumerate() {
            if !matches!(
                self.column_storage.get(k),
                Some(ColumnStorage::Alias { negated: false, .. })
            ) {
                Arc::make_mut(column).reserve(rows);
            }
        }
    }
    /// Appends a row; `values` in the order of `columns`. [`Trajectory::verify`] finds a wrong length.
    pub fn push(&mut self, time: f64, values: &[f64]) {
        self.time.push(time);
        let cells = self.data.iter_mut().zip(values);
        cells.for_each(|(column, &value)| Arc::make_mut(column).push(value));
    }
    /// From the second row on only columns that go their own way will come, by
    /// [`Trajectory::push_own_columns`]; until [`Trajectory::complete`] the others are shorter.
    pub fn expect_storage(&mut self, column_storage: Vec<ColumnStorage>) {
        self.column_storage = column_storage;
    }
    /// Appends rows without the columns whose course is known; the values of each column begin `stride`
    /// after those of the one before.
    pub fn push_own_columns(&mut self, times: &[f64], values: &[f64], stride: usize) {
        self.time.extend_from_slice(times);
        let own = self
            .data
            .iter_mut()
            .zip(&self.column_storage)
            .filter(|(_, c)| **c == ColumnStorage::Own);
        for (values, (column, _)) in values.chunks(stride.max(1)).zip(own) {
            Arc::make_mut(column).extend_from_slice(&values[..times.len()]);
        }
    }
    /// Fills the columns whose course is known.
    pub fn complete(&mut self) {
        let rows = self.time.len();
        for (k, course) in std::mem::take(&mut self.column_storage).into_iter().enumerate() {
            let (before, after) = self.data.split_at_mut(k);
            let Some(column) = after.first_mut() else { break };
            match course {
                ColumnStorage::Own => {}
                ColumnStorage::Constant => {
                    let value = column.first().copied().unwrap_or_default();
                    Arc::make_mut(column).resize(rows, value);
                }
                ColumnStorage::Alias { of, negated: false } => *column = before[of].clone(),
                ColumnStorage::Alias { of, negated: true } => {
                    let column = Arc::make_mut(column);
                    column.clear();
                    column.extend(before[of].iter().map(|x| -x));
                }
            }
        }
    }
    /// Keeps one row of each instant, the last: at an event the right limit. Times then increase strictly. Before
    /// [`Trajectory::complete`] this costs least: only the columns with rows of their own are shortened.
    pub fn keep_right_limits(&mut self) {
        let is_left = |pair: &[f64]| pair[0] == pair[1];
        let left = self.time.windows(2).enumerate().filter(|(_, pair)| is_left(pair));
        let left: Vec<usize> = left.map(|(row, _)| row).collect();
        if left.is_empty() {
            return;
        }
        if !self.column_storage.is_empty() {
            for (column, storage) in self.data.iter_mut().zip(&self.column_storage) {
                if *storage == ColumnStorage::Own {
                    remove_rows(Arc::make_mut(column), &left);
                }
            }
            remove_rows(&mut self.time, &left);
            return;
        }
        // Columns that share a vector go on sharing it. Only its first holder keeps it meanwhile, so that it is changed
        // in place.
        let mut first: BTreeMap<*const Vec<f64>, usize> = BTreeMap::new();
        let mut twins = Vec::new();
        for k in 0..self.data.len() {
            if Arc::strong_count(&self.data[k]) > 1 {
                let at = *first.entry(Arc::as_ptr(&self.data[k])).or_insert(k);
                if at < k {
                    self.data[k] = Arc::default();
                    twins.push((k, at));
                }
            }
        }
        let mut is_twin = twins.iter().map(|(k, _)| *k).peekable();
        for (k, column) in self.data.iter_mut().enumerate() {
            if is_twin.next_if_eq(&k).is_none() {
                remove_rows(Arc::make_mut(column), &left);
            }
        }
        for (k, at) in twins {
            self.data[k] = Arc::clone(&self.data[at]);
        }
        remove_rows(&mut self.time, &left);
    }
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.time.len()
    }
    /// Position of the column of this name; spaces do not count, so `a[1, 2]` finds `a[1,2]`.
    pub fn position(&self, name: &str) -> Option<usize> {
        position(&self.columns, name)
    }
    /// The values of the column of this name; spaces do not count.
    pub fn values(&self, name: &str) -> Option<&[f64]> {
        self.data.get(self.position(name)?).map(|values| values.as_slice())
    }
    /// Checks the contract at the head of this file.
    pub fn verify(&self) -> Result<(), Fault> {
        if self.columns.len() != self.data.len() {
            return Err(Fault::ColumnCount { columns: self.columns.len(), data: self.data.len() });
        }
        let mut names: Vec<&str> = self.columns.iter().map(|c| c.name.as_str()).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Fault::DuplicateName { name: pair[0].to_owned() });
        }
        ascending("time", &self.time)?;
        for (column, values) in self.columns.iter().zip(&self.data) {
            let name = || column.name.clone();
            let (found, expected) = (values.len(), self.rows());
            if found != expected {
                return Err(Fault::Length { name: name(), found, expected });
            }
            if let Some(row) = values.iter().position(|v| !v.is_finite()) {
                let (value, time) = (values[row], self.time[row]);
                return Err(Fault::NotFinite { name: name(), value, time });
            }
        }
        let instants: Vec<f64> = self.events.iter().map(|e| e.time).collect();
        ascending("event", &instants)
    }
}

/// Removes some rows, in ascending order, of a column.
fn remove_rows(column: &mut Vec<f64>, rows: &[usize]) {
    let mut end = rows[0];
    for (k, row) in rows.iter().enumerate() {
        let next = rows.get(k + 1).copied().unwrap_or(column.len());
        column.copy_within(row + 1..next, end);
        end += next - row - 1;
    }
    column.truncate(end);
}

/// Position of the column called `name`; spaces do not count.
pub fn position(columns: &[Column], name: &str) -> Option<usize> {
    fn letters(text: &str) -> impl Iterator<Item = char> {
        text.chars().filter(|c| !c.is_whitespace())
    }
    columns.iter().position(|c| letters(&c.name).eq(letters(name)))
}

/// All finite, none before its predecessor.
fn ascending(what: &'static str, times: &[f64]) -> Result<(), Fault> {
    if let Some(&time) = times.iter().find(|t| !t.is_finite()) {
        return Err(Fault::NotFinite { name: what.to_owned(), value: time, time });
    }
    match times.windows(2).find(|pair| pair[1] < pair[0]) {
        Some(pair) => Err(Fault::TimeDecreases { what, before: pair[0], after: pair[1] }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn switched() -> Trajectory {
        let mut run = Trajectory::new(vec![Column::new("a[1,2]", "m"), Column::new("b.v", "m/s")]);
        run.push(0.0, &[0.0, 1.0]);
        run.push(0.5, &[0.5, 1.0]);
        run.push(0.5, &[0.5, -1.0]);
        run.push(1.0, &[0.0, -1.0]);
        run.events.push(Event { time: 0.5, what: "bounce".into(), place: String::new() });
        run
    }

    /// Columns that follow from others are filled in after the run, even if the rows came in several blocks.
    #[test]
    fn columns_of_known_course_are_filled_in() {
        let columns = ["a", "twin", "mirror", "c", "b"].map(|n| Column::new(n, "")).to_vec();
        let mut run = Trajectory::new(columns);
        run.expect_storage(vec![
            ColumnStorage::Own,
            ColumnStorage::Alias { of: 0, negated: false },
            ColumnStorage::Alias { of: 0, negated: true },
            ColumnStorage::Constant,
            ColumnStorage::Own,
        ]);
        run.push(0.0, &[1.0, 1.0, -1.0, 7.0, 5.0]);
        run.push_own_columns(&[0.1, 0.2], &[2.0, 3.0, f64::NAN, 6.0, 8.0, f64::NAN], 3);
        run.push_own_columns(&[0.3], &[4.0, 9.0], 1);
        run.complete();
        run.verify().unwrap();
        assert_eq!(run.values("twin"), Some(&[1.0, 2.0, 3.0, 4.0][..]));
        assert_eq!(run.values("mirror"), Some(&[-1.0, -2.0, -3.0, -4.0][..]));
        assert_eq!(run.values("c"), Some(&[7.0; 4][..]));
        assert_eq!(run.values("b"), Some(&[5.0, 6.0, 8.0, 9.0][..]));
        // A run without rows has nothing to fill.
        let mut empty = Trajectory::new(vec![Column::new("c", "")]);
        empty.expect_storage(vec![ColumnStorage::Constant]);
        empty.complete();
        assert_eq!(empty.rows(), 0);
    }

    #[test]
    fn names_are_found_without_regard_to_spaces() {
        let run = switched();
        assert_eq!(run.values("a[1, 2]"), Some(&[0.0, 0.5, 0.5, 0.0][..]));
        assert_eq!(run.position(" b.v"), Some(1));
        assert_eq!(run.position("b"), None);
    }

    #[test]
    fn two_rows_at_an_event_are_its_limits() {
        let run = switched();
        assert_eq!(run.verify(), Ok(()));
        assert_eq!((run.time[1], run.time[2]), (0.5, 0.5));
        assert_eq!(run.values("b.v").map(|v| (v[1], v[2])), Some((1.0, -1.0)));
    }

    #[test]
    fn right_limits_are_kept_and_vectors_stay_shared() {
        let mut run = switched();
        run.columns.push(Column::new("twin", "m/s"));
        run.data.push(run.data[1].clone());
        run.keep_right_limits();
        run.verify().unwrap();
        assert_eq!(run.time, [0.0, 0.5, 1.0]);
        assert_eq!(run.values("b.v"), Some(&[1.0, -1.0, -1.0][..]));
        assert!(Arc::ptr_eq(&run.data[1], &run.data[2]));
        let once = run.clone();
        run.keep_right_limits();
        assert_eq!(run, once);
    }

    #[test]
    fn verify_names_what_is_broken() {
        let broken = |change: fn(&mut Trajectory)| {
            let mut run = switched();
            change(&mut run);
            run.verify().map_err(|fault| fault.to_string())
        };
        assert_eq!(
            broken(|r| Arc::make_mut(&mut r.data[1])[2] = f64::NAN),
            Err("`b.v` is NaN at time 0.5 s".to_owned())
        );
        assert_eq!(
            broken(|r| r.time[3] = 0.25),
            Err("time goes back from 0.5 s to 0.25 s".to_owned())
        );
        assert_eq!(
            broken(|r| r.time[3] = f64::INFINITY),
            Err("`time` is inf at time inf s".to_owned())
        );
        assert_eq!(
            broken(|r| r.push(2.0, &[1.0])),
            Err("`b.v` has 4 values for 5 times".to_owned())
        );
        assert_eq!(
            broken(|r| r.columns[1].name = "a[1,2]".into()),
            Err("two columns are called `a[1,2]`".to_owned())
        );
        assert_eq!(
            broken(|r| r.events[0].time = f64::NAN),
            Err("`event` is NaN at time NaN s".to_owned())
        );
    }
}
