//! The call of the FMU that runs now, for the message about one that does not return.

use std::sync::{Mutex, PoisonError};

/// Calls so far, and the name of the one that runs; empty between calls.
static CURRENT: Mutex<(u64, &str)> = Mutex::new((0, ""));

/// What is known while the library is loaded, which is no call but runs code of the FMU.
pub const LOADING: &str = "loading of its shared library";

/// A call while it runs.
pub struct CurrentCall(());

impl CurrentCall {
    /// A call begins; it ends when the value is dropped.
    pub fn enter(name: &'static str) -> CurrentCall {
        let mut current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
        *current = (current.0 + 1, name);
        CurrentCall(())
    }
}

impl Drop for CurrentCall {
    fn drop(&mut self) {
        CURRENT.lock().unwrap_or_else(PoisonError::into_inner).1 = "";
    }
}

/// The number of the last call, and its name if it still runs.
pub fn current_call() -> (u64, &'static str) {
    *CURRENT.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_is_known_while_it_runs() {
        let call = CurrentCall::enter("fmi3DoStep");
        let (number, name) = current_call();
        assert_eq!(name, "fmi3DoStep");
        drop(call);
        assert_eq!(current_call(), (number, ""));
        let _next = CurrentCall::enter(LOADING);
        assert_eq!(current_call(), (number + 1, LOADING));
    }
}
