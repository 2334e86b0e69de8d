//! The end of a search in the middle of a run.
//!
//! A search ends between its steps. A single run may take minutes: with many directions, or with an effect that makes the
//! model stiff. While a search is on, runs ask after each of their steps whether anybody still waits for them.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether runs are to end early.
#[derive(Clone, Default)]
pub struct Cancellation {
    asked: Option<Arc<dyn Fn() -> bool + Send + Sync>>,
    is_armed: Arc<AtomicBool>,
}

impl Cancellation {
    /// Requested when `asked` says so; not armed yet.
    pub fn when(asked: impl Fn() -> bool + Send + Sync + 'static) -> Cancellation {
        Cancellation { asked: Some(Arc::new(asked)), is_armed: Arc::default() }
    }

    /// From now on, runs may end early.
    pub fn arm(&self) {
        self.is_armed.store(true, Ordering::Relaxed);
    }

    /// From now on, runs go on to their ends: results are written.
    pub fn disarm(&self) {
        self.is_armed.store(false, Ordering::Relaxed);
    }

    /// Whether a run is to end now.
    pub fn is_requested(&self) -> bool {
        let asked = self.asked.as_ref().filter(|_| self.is_armed.load(Ordering::Relaxed));
        asked.is_some_and(|asked| asked())
    }
}

impl fmt::Debug for Cancellation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Cancellation({})", self.is_armed.load(Ordering::Relaxed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_ends_only_while_a_search_is_on() {
        let cancellation = Cancellation::when(|| true);
        assert!(!cancellation.is_requested());
        let other = cancellation.clone();
        cancellation.arm();
        assert!(other.is_requested());
        other.disarm();
        assert!(!cancellation.is_requested());
        Cancellation::default().arm();
        assert!(!Cancellation::default().is_requested());
    }
}
