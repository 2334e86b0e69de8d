//! Work on a thread of its own, while the thread that called waits without the interpreter lock and listens to Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use mocc::base::diag::Problems;
use mocc::base::source::SourceMap;
use mocc::calibrate::cancellation::Cancellation;
use mocc::calibrate::observer::{Event, Observer};
use pyo3::prelude::*;

use crate::error::lost;

/// Time between two looks at the signals of the process.
pub const PERIOD: Duration = Duration::from_millis(50);
/// Time that cancelled work has to end before it is abandoned.
const GRACE: Duration = Duration::from_secs(2);
/// Stack of a thread: the compiler recurses deeply. Only the used part takes memory.
const STACK: usize = 1 << 30;

/// Tells work that nobody waits for it any more.
#[derive(Clone, Default)]
pub struct Cancelled(Arc<AtomicBool>);

impl Cancelled {
    /// Whether the work is to end.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Tells it to end.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Starts a thread.
pub fn spawn(work: impl FnOnce() + Send + 'static) -> PyResult<()> {
    let builder = std::thread::Builder::new().name("mocc".into()).stack_size(STACK);
    builder.spawn(work).map(drop).map_err(PyErr::from)
}

/// Does the work on a thread and waits for its result. Errors: `KeyboardInterrupt`, or whatever else the handler of a
/// signal raises.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Cancelled) -> T + Send + 'static,
) -> PyResult<T> {
    let cancelled = Cancelled::default();
    let (answer, answers) = channel();
    let told = cancelled.clone();
    spawn(move || {
        // Nobody may wait any more.
        let _ = answer.send(work(&told));
    })?;
    wait(py, &answers, &cancelled, None)
}

/// Waits for an answer, and passes notes on to a Python function.
pub fn wait<T: Send>(
    py: Python<'_>,
    answers: &Receiver<T>,
    cancelled: &Cancelled,
    progress: Option<(&Receiver<String>, &Py<PyAny>)>,
) -> PyResult<T> {
    let receive = |time: Duration| {
        // A receiver belongs to one thread, which this one is.
        let answers = Lent(answers);
        py.detach(move || answers.get().recv_timeout(time))
    };
    loop {
        let answer = receive(PERIOD);
        let mut heard = Ok(());
        if let Some((notes, function)) = progress {
            heard = notes.try_iter().try_for_each(|note| function.call1(py, (note,)).map(drop));
        }
        match answer {
            Ok(answer) => return heard.map(|()| answer),
            Err(RecvTimeoutError::Disconnected) => return Err(lost()),
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(why) = heard.and_then(|()| py.check_signals()) {
            cancelled.set();
            let _ = receive(GRACE);
            return Err(why);
        }
    }
}

/// A receiver that goes through `detach` and comes back on the same thread.
struct Lent<'a, T>(&'a Receiver<T>);

#[allow(unsafe_code)] // `detach` runs its closure on the calling thread.
unsafe impl<T: Send> Send for Lent<'_, T> {}

impl<'a, T> Lent<'a, T> {
    fn get(&self) -> &'a Receiver<T> {
        self.0
    }
}

/// Watches a calibration or a diagnosis for Python.
pub struct Watch {
    /// Set by Ctrl-C.
    pub cancelled: Cancelled,
    /// When the work is to end with the results so far.
    pub deadline: Option<Instant>,
    /// Takes progress as text.
    pub notes: std::sync::mpsc::Sender<String>,
}

impl Observer for Watch {
    fn start(&self, _: &Problems, _: &SourceMap) -> Result<(), String> {
        Ok(())
    }

    fn event(&self, event: &Event<'_>) {
        // Nobody may listen.
        let _ = self.notes.send(event.to_string());
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.is_set() || self.deadline.is_some_and(|at| Instant::now() >= at)
    }

    fn cancellation(&self) -> Cancellation {
        let (cancelled, deadline) = (self.cancelled.clone(), self.deadline);
        Cancellation::when(move || {
            cancelled.is_set() || deadline.is_some_and(|at| Instant::now() >= at)
        })
    }
}
