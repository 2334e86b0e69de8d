//! The rows of a run as they come: only columns that go their own way are stored until its end, each in one vector.
//!
//! In: the first row with all columns, then rows or blocks of the columns that go their own way. Out: a [`Run`], whose
//! columns share the vectors that are equal. Of two rows at one instant the first may be left out.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use mocc::ir::trajectory::{Column, ColumnStorage, Event};

use crate::run::Run;

/// Rows of a run.
#[derive(Default)]
pub struct OwnRows {
    /// Of the rows at one instant only the last is kept: at an event the right limit.
    right_limits: bool,
    storage: Vec<ColumnStorage>,
    /// The first row.
    first: Vec<f64>,
    time: Vec<f64>,
    /// The columns that go their own way, in order.
    own: Vec<Vec<f64>>,
}

impl OwnRows {
    /// No rows yet; of those at one instant all, or only the last.
    pub fn new(right_limits: bool) -> OwnRows {
        OwnRows { right_limits, ..OwnRows::default() }
    }

    /// How columns are determined; called before all rows. Without it, all go their own way.
    pub fn storage(&mut self, storage: Vec<ColumnStorage>) {
        let count = storage.iter().filter(|s| **s == ColumnStorage::Own).count();
        self.own.resize_with(count, Vec::new);
        self.storage = storage;
    }

    /// Makes room for so many rows.
    pub fn expect(&mut self, rows: usize) {
        self.time.reserve(rows);
        self.own.iter_mut().for_each(|column| column.reserve(rows));
    }

    /// A row with all columns.
    pub fn row(&mut self, time: f64, values: &[f64]) {
        if self.first.is_empty() {
            self.first = values.to_vec();
            if self.storage.is_empty() {
                self.storage(vec![ColumnStorage::Own; values.len()]);
            }
        }
        self.leave_out_before(time);
        self.time.push(time);
        let own = values.iter().zip(&self.storage).filter(|(_, s)| **s == ColumnStorage::Own);
        for (column, (value, _)) in self.own.iter_mut().zip(own) {
            column.push(*value);
        }
    }

    /// Rows of the columns that go their own way; those of each begin `stride` after those of the one before.
    pub fn own_columns(&mut self, times: &[f64], values: &[f64], stride: usize) {
        let Some(first) = times.first() else { return };
        self.leave_out_before(*first);
        let kept = self.kept(times);
        for rows in &kept {
            self.time.extend_from_slice(&times[rows.clone()]);
        }
        for (column, values) in self.own.iter_mut().zip(values.chunks(stride.max(1))) {
            for rows in &kept {
                column.extend_from_slice(&values[rows.clone()]);
            }
        }
    }

    /// Removes the last row if it is the left limit at this time.
    fn leave_out_before(&mut self, time: f64) {
        if self.right_limits && self.time.last() == Some(&time) {
            self.time.pop();
            self.own.iter_mut().for_each(|column| {
                column.pop();
            });
        }
    }

    /// The rows of a block that are not left limits.
    fn kept(&self, times: &[f64]) -> Vec<Range<usize>> {
        let mut kept = Vec::new();
        let mut begin = 0;
        for (row, pair) in times.windows(2).enumerate() {
            if self.right_limits && pair[0] == pair[1] {
                kept.push(begin..row);
                begin = row + 1;
            }
        }
        kept.push(begin..times.len());
        kept
    }

    /// The run, with all its columns.
    pub fn run(self, columns: Arc<Vec<Column>>, events: Vec<Event>) -> Run {
        let rows = self.time.len();
        let mut own = self.own.into_iter();
        let mut data: Vec<Arc<Vec<f64>>> = Vec::with_capacity(columns.len());
        // By their bits, and by the column of which they are the negative.
        let mut constants: BTreeMap<u64, Arc<Vec<f64>>> = BTreeMap::new();
        let mut negatives: BTreeMap<usize, Arc<Vec<f64>>> = BTreeMap::new();
        let storage = self.storage.into_iter().chain(std::iter::repeat(ColumnStorage::Own));
        for (k, storage) in storage.take(columns.len()).enumerate() {
            data.push(match storage {
                ColumnStorage::Own => Arc::new(own.next().unwrap_or_default()),
                ColumnStorage::Constant => {
                    let value = self.first.get(k).copied().unwrap_or_default();
                    let made = || Arc::new(vec![value; rows]);
                    Arc::clone(constants.entry(value.to_bits()).or_insert_with(made))
                }
                ColumnStorage::Alias { of, negated: false } => Arc::clone(&data[of]),
                ColumnStorage::Alias { of, negated: true } => {
                    let made = || Arc::new(data[of].iter().map(|x| -x).collect());
                    Arc::clone(negatives.entry(of).or_insert_with(made))
                }
            });
        }
        Run::new(columns, self.time, data, events)
    }
}
