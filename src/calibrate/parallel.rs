//! Independent work on several cores. Results come in order, whatever the number of cores.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// Stack of a thread that may compile models, bytes; only what is used is allocated.
const STACK: usize = 1 << 30;
/// Time between two looks at whether to go on.
const PATIENCE: Duration = Duration::from_millis(20);

/// Number of cores.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// `work(0), ..., work(count - 1)`, on at most `jobs` threads.
pub fn map<T: Send>(jobs: usize, count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    if jobs <= 1 || count <= 1 {
        return (0..count).map(work).collect();
    }
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..jobs.min(count) {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(place) = results.get(i) else { break };
                    let result = work(i);
                    // Nothing panics while it holds this lock.
                    if let Ok(mut place) = place.lock() {
                        *place = Some(result);
                    }
                }
            });
        }
    });
    results.into_iter().filter_map(|r| r.into_inner().ok().flatten()).collect()
}

/// The same on threads that may compile models, while `may_continue` says so, which the calling thread asks from time to
/// time. Work that had not begun by then has no result.
pub fn map_while<T: Send>(
    jobs: usize,
    count: usize,
    may_continue: impl Fn() -> bool,
    work: impl Fn(usize) -> T + Sync,
) -> Vec<Option<T>> {
    if jobs <= 1 || count <= 1 {
        return (0..count).map(|i| may_continue().then(|| work(i))).collect();
    }
    let (next, is_stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let results: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    let caller = std::thread::current();
    let run = || {
        while !is_stopped.load(Ordering::Relaxed) {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(place) = results.get(i) else { break };
            let result = work(i);
            if let Ok(mut place) = place.lock() {
                *place = Some(result);
            }
        }
        caller.unpark();
    };
    std::thread::scope(|scope| {
        let spawn = |_| std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, run).ok();
        let workers: Vec<_> = (0..jobs.min(count)).filter_map(spawn).collect();
        if workers.is_empty() {
            run();
        }
        while workers.iter().any(|w| !w.is_finished()) {
            is_stopped.fetch_or(!may_continue(), Ordering::Relaxed);
            std::thread::park_timeout(PATIENCE);
        }
    });
    results.into_iter().map(|r| r.into_inner().ok().flatten()).collect()
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    #[test]
    fn results_come_in_order() {
        for jobs in [1, 2, 7] {
            let squares = super::map(jobs, 100, |i| i * i);
            assert!(squares.iter().enumerate().all(|(i, s)| *s == i * i) && squares.len() == 100);
        }
    }

    #[test]
    fn work_ends_where_it_is_not_to_go_on() {
        let all = super::map_while(2, 50, || true, |i| 3 * i);
        assert!(all.iter().enumerate().all(|(i, t)| *t == Some(3 * i)) && all.len() == 50);
        assert_eq!(super::map_while(1, 3, || false, |i| i), [None; 3]);
        // Two workers have begun one piece each when the caller looks for the first time, at most.
        let looks = Cell::new(0);
        let look = || {
            looks.set(looks.get() + 1);
            false
        };
        let work = |_| std::thread::sleep(super::PATIENCE);
        let done = super::map_while(2, 100, look, work);
        assert!(done.iter().flatten().count() < 10 && looks.get() > 0);
    }
}
