//! What the process is doing, for messages of whoever ends it: a limit of time or memory.
//!
//! Stages note it where their cost grows; a note costs a formatted text, so loops note rarely.

use std::sync::{Mutex, PoisonError};

static NOTE: Mutex<String> = Mutex::new(String::new());

/// Replaces the note.
pub fn note(text: String) {
    *NOTE.lock().unwrap_or_else(PoisonError::into_inner) = text;
}

/// The last note; empty if there is none.
pub fn last() -> String {
    NOTE.lock().unwrap_or_else(PoisonError::into_inner).clone()
}
