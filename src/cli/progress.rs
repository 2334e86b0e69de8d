//! Progress of a run, on a terminal. Sole user of `indicatif`.
//!
//! The run only stores the time it has reached. A separate thread reads it ten times a second and draws, so
//! that a step costs one store in memory, however slow the terminal is.

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{JoinHandle, park_timeout, spawn};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Shorter runs show nothing.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time between two updates.
const PERIOD: Duration = Duration::from_millis(100);
/// Resolution of the bar.
const PARTS: u64 = 10_000;

/// A bar on the standard error; disappears when dropped.
pub struct Progress {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    /// The bits of the time that the run has reached, s, or of the number of finished runs.
    reached: AtomicU64,
    done: AtomicBool,
}

impl Progress {
    /// Progress of a run from `start` to `stop`, s; none if the standard error is not a terminal.
    pub fn of(start: f64, stop: f64) -> Option<Progress> {
        // Four digits of the duration.
        let digits = (3.0 - (stop - start).log10().floor()).clamp(0.0, 15.0) as usize;
        Progress::shown(start, stop, move |time| format!("{time:.digits$} s"))
    }

    /// Progress of many runs, `done` of `all` before it begins; none if the standard error is not a terminal.
    pub fn of_runs(done: u64, all: u64) -> Option<Progress> {
        Progress::shown(done as f64, all as f64, move |reached| format!("{reached} of {all} runs"))
    }

    fn shown(
        start: f64,
        stop: f64,
        text: impl Fn(f64) -> String + Send + 'static,
    ) -> Option<Progress> {
        let visible = std::io::stderr().is_terminal() && stop > start;
        visible.then(|| {
            let reached = AtomicU64::new(start.to_bits());
            let shared = Arc::new(Shared { reached, done: AtomicBool::new(false) });
            let thread = {
                let shared = Arc::clone(&shared);
                spawn(move || draw(&shared, start, stop, &text))
            };
            Progress { shared, thread: Some(thread) }
        })
    }

    /// Sets the time that the run has reached, s, or the number of finished runs.
    pub fn reached(&self, time: f64) {
        self.shared.reached.store(time.to_bits(), Ordering::Relaxed);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.shared.done.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A failure to draw the bar is ignored.
            let _ = thread.join();
        }
    }
}

/// A status line on a terminal for work of unknown length; disappears when dropped.
pub struct Working(Option<ProgressBar>);

impl Default for Working {
    fn default() -> Self {
        Working::new()
    }
}

impl Working {
    /// Shows nothing if the standard error is not a terminal.
    pub fn new() -> Working {
        Working(std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new_spinner();
            if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed:>4}  {msg}") {
                bar.set_style(style);
            }
            bar.enable_steady_tick(PERIOD);
            bar
        }))
    }

    /// Replaces the status line.
    pub fn say(&self, what: String) {
        if let Some(bar) = &self.0 {
            bar.set_message(what);
        }
    }
}

impl Drop for Working {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

fn draw(shared: &Shared, start: f64, stop: f64, text: &dyn Fn(f64) -> String) {
    let is_done = || shared.done.load(Ordering::Acquire);
    let started_at = Instant::now();
    park_timeout(PATIENCE);
    if is_done() {
        return;
    }
    let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr());
    let style = "{bar:30} {percent:>3} %  {msg}";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    while !is_done() {
        let time = f64::from_bits(shared.reached.load(Ordering::Relaxed));
        let part = part(time, start, stop);
        let left = match left(started_at.elapsed(), part) {
            Some(left) => format!(", {} left", HumanDuration(left)),
            None => String::new(),
        };
        bar.set_message(format!("{}{left}", text(time)));
        bar.set_position(part);
        park_timeout(PERIOD);
    }
    bar.finish_and_clear();
}

/// The finished part of the run, of [`PARTS`].
fn part(time: f64, start: f64, stop: f64) -> u64 {
    ((time - start) / (stop - start) * PARTS as f64).clamp(0.0, PARTS as f64) as u64
}

/// The remaining time, extrapolated from the elapsed time; none at the start.
fn left(elapsed: Duration, part: u64) -> Option<Duration> {
    let share = part as f64 / PARTS as f64;
    (part > 0).then(|| elapsed.mul_f64((1.0 - share) / share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_is_that_of_the_run() {
        assert_eq!(part(2.5, 2.0, 4.0), PARTS / 4);
        assert_eq!(part(1.0, 2.0, 4.0), 0);
        assert_eq!(part(9.0, 2.0, 4.0), PARTS);
        assert_eq!(part(f64::NAN, 2.0, 4.0), 0);
    }

    #[test]
    fn the_remaining_time_is_extrapolated() {
        assert_eq!(left(Duration::from_secs(3), PARTS / 4), Some(Duration::from_secs(9)));
        assert_eq!(left(Duration::from_secs(3), PARTS), Some(Duration::ZERO));
        assert_eq!(left(Duration::from_secs(3), 0), None);
    }

    #[test]
    fn a_dropped_bar_is_gone_at_once() {
        // A test has no terminal: only the thread is tested.
        let shared = Arc::new(Shared { reached: AtomicU64::new(0), done: AtomicBool::new(false) });
        let thread = {
            let shared = Arc::clone(&shared);
            spawn(move || draw(&shared, 0.0, 1.0, &|time| format!("{time}")))
        };
        drop(Progress { shared, thread: Some(thread) });
    }
}
