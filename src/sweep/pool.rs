//! Independent work on several threads, with results in order.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Condvar, Mutex, MutexGuard};

/// Results per thread that may wait for an earlier one. This bounds the memory.
const MAX_WAITING: u64 = 64;

/// Stack size of a thread: the compiler recurses deeply. Only the used part takes memory.
const STACK: usize = 1 << 30;

/// Number of cores.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Passes the results of `work` for all of `runs` to `take`, in order, on at most `jobs` threads. Ends early if
/// `work` returns `None` or `take` returns false.
pub fn in_order<T: Send>(
    jobs: usize,
    runs: Range<u64>,
    work: impl Fn(u64) -> Option<T> + Sync,
    mut take: impl FnMut(u64, T) -> bool,
) {
    if jobs <= 1 {
        return one_by_one(runs, &work, &mut take);
    }
    let state = State { next: runs.start, taken: runs.start, done: BTreeMap::new(), over: false };
    let shared = Shared { state: Mutex::new(state), changed: Condvar::new() };
    let jobs = jobs.min((runs.end - runs.start).min(1 << 16) as usize);
    std::thread::scope(|scope| {
        let mut started = 0;
        for _ in 0..jobs {
            let builder = std::thread::Builder::new().name("run".into()).stack_size(STACK);
            let body = || shared.work(runs.end, jobs as u64, &work);
            if builder.spawn_scoped(scope, body).is_ok() {
                started += 1;
            }
        }
        // If `take` panics, waiting threads must still be released.
        let _over = Over(&shared);
        if started == 0 {
            return one_by_one(runs.clone(), &work, &mut take);
        }
        for run in runs.clone() {
            let Some(result) = shared.result_of(run) else { return };
            if !take(run, result) {
                return;
            }
        }
    });
}

fn one_by_one<T>(
    runs: Range<u64>,
    work: &impl Fn(u64) -> Option<T>,
    take: &mut impl FnMut(u64, T) -> bool,
) {
    for run in runs {
        let Some(result) = work(run) else { return };
        if !take(run, result) {
            return;
        }
    }
}

struct State<T> {
    /// The next run that no thread works on.
    next: u64,
    /// All runs before this one are taken.
    taken: u64,
    done: BTreeMap<u64, T>,
    over: bool,
}

struct Shared<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
}

/// Ends the work when dropped.
struct Over<'a, T>(&'a Shared<T>);

impl<T> Drop for Over<'_, T> {
    fn drop(&mut self) {
        self.0.lock().over = true;
        self.0.changed.notify_all();
    }
}

impl<T> Shared<T> {
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        // Nothing panics while it holds this lock.
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State<T>>) -> MutexGuard<'a, State<T>> {
        self.changed.wait(state).unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// The work of one thread, run after run.
    fn work(&self, end: u64, jobs: u64, work: &(impl Fn(u64) -> Option<T> + Sync)) {
        // If the work panics, the other threads must be notified.
        let mut over = Some(Over(self));
        loop {
            let run = {
                let mut state = self.lock();
                while !state.over
                    && state.next < end
                    && state.next >= state.taken + MAX_WAITING * jobs
                {
                    state = self.wait(state);
                }
                if state.over || state.next >= end {
                    // The other threads still have work.
                    std::mem::forget(over.take());
                    return;
                }
                state.next += 1;
                state.next - 1
            };
            let Some(result) = work(run) else { return };
            self.lock().done.insert(run, result);
            self.changed.notify_all();
        }
    }

    /// Waits for a result; `None` if the work has ended.
    fn result_of(&self, run: u64) -> Option<T> {
        let mut state = self.lock();
        loop {
            if let Some(result) = state.done.remove(&run) {
                state.taken = run + 1;
                self.changed.notify_all();
                return Some(result);
            }
            if state.over {
                return None;
            }
            state = self.wait(state);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_on_any_number_of_threads() {
        for jobs in [1, 2, 7] {
            let mut taken = Vec::new();
            in_order(
                jobs,
                5..1000,
                |run| Some(run * run),
                |run, square| {
                    taken.push((run, square));
                    true
                },
            );
            assert_eq!(taken, (5..1000).map(|k| (k, k * k)).collect::<Vec<_>>());
        }
    }

    #[test]
    fn it_ends_early_on_both_sides() {
        for jobs in [1, 3] {
            let mut last = None;
            in_order(jobs, 0..1000, Some, |run, _| {
                last = Some(run);
                run < 10
            });
            assert_eq!(last, Some(10));
            let mut count = 0;
            in_order(
                jobs,
                0..1000,
                |run| (run < 20).then_some(run),
                |_, _| {
                    count += 1;
                    true
                },
            );
            assert!(count <= 20);
        }
    }

    #[test]
    fn a_panic_does_not_deadlock() {
        let outcome = std::panic::catch_unwind(|| {
            in_order(
                2,
                0..100,
                |run| if run == 5 { panic!("on purpose") } else { Some(run) },
                |_, _| true,
            );
        });
        assert!(outcome.is_err());
    }
}
