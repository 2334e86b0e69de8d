//! The rows of a run at the instants of a recording.

use std::sync::Arc;

use crate::ir::trajectory::{Column, Event};
use crate::simulate::record::Sink;

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
}

impl Rows {
    /// No rows yet, of `width` variables with derivatives by `inputs` inputs.
    pub fn new(instants: Arc<[f64]>, width: usize, inputs: usize) -> Self {
        let n = instants.len();
        let (values, slopes) = (vec![0.0; n * width], vec![0.0; n * width * inputs]);
        Rows { instants, next: 0, taken: false, width, values, slopes }
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
}
