//! Threads that compute answers and checks, one after the other each, while the server goes on listening.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Sender, channel};

/// Deep models recurse deeply.
const STACK: usize = 1 << 30;

/// What a thread computes; false if nobody waits for more.
type Job = Box<dyn FnOnce() -> bool + Send>;

/// A thread that computes one job after the other.
pub struct Worker(Sender<Job>);

impl Worker {
    /// Starts a thread.
    pub fn start(name: &str) -> io::Result<Worker> {
        let (sender, jobs) = channel::<Job>();
        let work = move || {
            while let Ok(job) = jobs.recv() {
                if !job() {
                    break;
                }
            }
        };
        std::thread::Builder::new().name(name.into()).stack_size(STACK).spawn(work)?;
        Ok(Worker(sender))
    }

    /// Computes a value and sends it; without a value if the computation panics, which is a bug.
    pub fn run<T: Send + 'static, E: Send + 'static>(
        &self,
        by: impl FnOnce() -> T + Send + 'static,
        event: impl FnOnce(Option<T>) -> E + Send + 'static,
        out: &Sender<E>,
    ) {
        let out = out.clone();
        let job = move || out.send(event(catch_unwind(AssertUnwindSafe(by)).ok())).is_ok();
        // The thread ends with the server only.
        let _ = self.0.send(Box::new(job));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_a_job_but_not_the_thread() {
        let worker = Worker::start("test").unwrap();
        let (out, events) = channel();
        worker.run(|| -> i32 { panic!("expected by the test") }, |value| value, &out);
        worker.run(|| 7, |value| value, &out);
        assert_eq!((events.recv().unwrap(), events.recv().unwrap()), (None, Some(7)));
    }
}
