//! Writes results on a separate thread, while the run continues.
//!
//! The rows arrive in the order in which they were sent, so the file has the same bytes as without the
//! thread. The queue is bounded: if the file is slower than the run, the run waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{Builder, JoinHandle};

use crate::io::csv::TableError;
use crate::io::results::Results;

/// Blocks of rows on their way at most.
const WAITING: usize = 8;
/// Numbers of a block, at least: runs with many events send their rows one by one.
const BLOCK: usize = 4096;

/// Some rows.
#[derive(Default)]
struct Rows {
    times: Vec<f64>,
    values: Vec<f64>,
}

/// A file of results that is being written. Dropped before [`Writer::end`] it waits for its thread,
/// which leaves nothing.
pub struct Writer {
    /// None once no more rows will come.
    rows: Option<SyncSender<Rows>>,
    /// Rows of the next block.
    pending: Rows,
    /// Blocks that have been written, to be used again.
    written: Receiver<Rows>,
    failed: Arc<AtomicBool>,
    /// None once it was waited for.
    thread: Option<JoinHandle<Result<Results, TableError>>>,
}

impl Writer {
    /// Writes to these results, whose parameters and constants are known.
    pub fn begin(results: Results) -> Result<Writer, TableError> {
        let (rows, waiting) = sync_channel(WAITING);
        let (back, written) = channel();
        let failed = Arc::new(AtomicBool::new(false));
        let told = Arc::clone(&failed);
        let work = move || write(results, &waiting, &back, &told);
        let thread = Builder::new().name("write".into()).spawn(work)?;
        let pending = Rows::default();
        Ok(Writer { rows: Some(rows), pending, written, failed, thread: Some(thread) })
    }

    /// Sends rows on their way, one after the other.
    pub fn rows(&mut self, times: &[f64], values: &[f64]) {
        self.pending.times.extend_from_slice(times);
        self.pending.values.extend_from_slice(values);
        if self.pending.times.len() + self.pending.values.len() >= BLOCK {
            self.send();
        }
    }

    fn send(&mut self) {
        let mut empty = self.written.try_recv().unwrap_or_default();
        empty.times.clear();
        empty.values.clear();
        let block = std::mem::replace(&mut self.pending, empty);
        // If the thread has ended, `end` returns the reason.
        let _ = self.rows.as_ref().map(|rows| rows.send(block));
    }

    /// True once a row could not be written.
    pub fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    /// Waits until the queue is written; returns the results, or why they could not be written.
    pub fn end(mut self) -> Result<Results, TableError> {
        self.send();
        self.rows = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(outcome)) => outcome,
            Some(Err(panic)) => std::panic::resume_unwind(panic),
            None => unreachable!("a thread is waited for once"),
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.rows = None;
        // Drops the result and, with it, the file.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

fn write(
    mut results: Results,
    waiting: &Receiver<Rows>,
    back: &Sender<Rows>,
    failed: &AtomicBool,
) -> Result<Results, TableError> {
    while let Ok(block) = waiting.recv() {
        let columns = block.values.len() / block.times.len().max(1);
        for (row, time) in block.times.iter().enumerate() {
            let written = results.row(*time, &block.values[row * columns..(row + 1) * columns]);
            if written.is_err() {
                failed.store(true, Ordering::Relaxed);
            }
            written?;
        }
        // Nobody may want it any more.
        let _ = back.send(block);
    }
    Ok(results)
}
