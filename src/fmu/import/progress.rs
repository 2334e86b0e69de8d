//! The rows and events of a run on their way from the child process of an FMU: together, and at least every tenth of a
//! second while there are steps, so that the run can be followed and ended.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

use super::message::{Answer, Item, send};
use crate::ir::foreign::{Counters, ForeignObserver};

/// Longest time between two messages while there are steps.
const PERIOD: Duration = Duration::from_millis(100);
/// Numbers of rows in a message at most.
const MOST_NUMBERS: usize = 1 << 15;

/// What has not been sent yet.
pub struct Progress {
    stream: UnixStream,
    buffer: Vec<u8>,
    /// Where the instant that the run has come to is noted, for the message about an FMU that crashes.
    file: Option<File>,
    items: Vec<Item>,
    /// Numbers in `items`.
    count: usize,
    t: f64,
    counters: Counters,
    sent: Instant,
    is_lost: bool,
}

impl Progress {
    /// Sends to this stream, and notes instants in a file.
    pub fn new(stream: UnixStream, file: &Path) -> Progress {
        Progress {
            stream,
            buffer: Vec::new(),
            // Without the file the message names the last instant that was sent.
            file: File::create(file).ok(),
            items: Vec::new(),
            count: 0,
            t: 0.0,
            counters: Counters::default(),
            sent: Instant::now(),
            is_lost: false,
        }
    }

    /// A run begins.
    pub fn begin(&mut self) {
        self.sent = Instant::now();
        self.counters = Counters::default();
        if let Some(file) = &self.file {
            let _ = file.set_len(0);
        }
    }

    /// Sends the rest.
    pub fn flush(&mut self) {
        if !self.items.is_empty() {
            self.send();
        }
    }

    fn send(&mut self) {
        let items = std::mem::take(&mut self.items);
        let answer = Answer::Progress(self.t, self.counters, items);
        self.is_lost |= send(&mut self.stream, &answer, &mut self.buffer).is_err();
        self.count = 0;
        self.sent = Instant::now();
    }

    fn note(&mut self, t: f64) {
        self.t = t;
        if let Some(file) = &self.file {
            let _ = file.write_all_at(&t.to_le_bytes(), 0);
        }
    }
}

impl ForeignObserver for Progress {
    fn row(&mut self, t: f64, values: &[f64]) -> bool {
        self.items.push(Item::Row(t, values.to_vec()));
        self.count += values.len() + 1;
        if self.count > MOST_NUMBERS {
            self.send();
        }
        !self.is_lost
    }

    fn event(&mut self, t: f64, what: String) {
        self.items.push(Item::Event(t, what));
    }

    fn goes_on(&mut self, t: f64, counters: &Counters) -> bool {
        self.note(t);
        self.counters = *counters;
        if self.sent.elapsed() > PERIOD {
            self.send();
        }
        !self.is_lost
    }
}
