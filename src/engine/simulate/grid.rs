//! The instants of the rows of a run: equidistant ones, or a list.

use std::sync::Arc;

/// The instants after the start, each with its number.
pub struct Grid {
    next: u64,
    count: u64,
    start: f64,
    stop: f64,
    interval: f64,
    instants: Option<Arc<[f64]>>,
}

impl Grid {
    /// The instants from `start` to `stop`, s, at this distance, s, or those of the list. The start itself is not among
    /// them.
    pub fn new([start, stop]: [f64; 2], interval: f64, instants: Option<Arc<[f64]>>) -> Self {
        // Ignore a last interval of the size of rounding errors.
        let intervals = (stop - start) / interval;
        let count = if stop > start { (intervals - 1e-9).ceil() as u64 } else { 0 };
        let passed = |list: &Arc<[f64]>| list.partition_point(|t| *t <= start) as u64;
        let next = instants.as_ref().map_or(1, passed);
        Grid { next, count, start, stop, interval, instants }
    }

    /// The next instant, if it is before `end`, or equal to it if `inclusive`.
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

    /// Advances to the next instant.
    pub fn advance(&mut self) {
        self.next += 1;
    }

    /// Number of all instants with the start.
    pub fn total(&self) -> u64 {
        self.instants.as_ref().map_or(self.count, |list| list.len() as u64) + 1
    }
}
