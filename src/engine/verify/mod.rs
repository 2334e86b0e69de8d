//! The contracts of the representations, made executable: each representation in, the list of its violations
//! out.
//!
//! The head of each file in `ir` states what the representation holds and never holds; the file of the same name
//! here checks it, in time that grows with the size of the representation. [`after`] runs a check after a stage
//! in builds with debug assertions. A violation is a bug in mocc, never a mistake in a model.

pub mod ast;
pub mod blocks;
pub mod dae;
pub mod expressions;
pub mod flat;
pub mod function;
pub mod instance;
pub mod program;
pub mod trajectory;

/// Violations beyond this number are not listed.
const MOST_LISTED: usize = 20;

/// Panics if a stage left a representation that breaks its contract. Does nothing in builds without debug
/// assertions.
pub fn after(stage: &str, representation: &str, check: impl FnOnce() -> Vec<String>) {
    if cfg!(debug_assertions) {
        let violations = check();
        assert!(violations.is_empty(), "{}", report(stage, representation, &violations));
    }
}

/// The violations that a stage left in a representation, as the text of a bug message; long lists are cut.
pub fn report(stage: &str, representation: &str, violations: &[String]) -> String {
    let mut text = format!("`{stage}` broke the contract of `ir::{representation}`:");
    for violation in violations.iter().take(MOST_LISTED) {
        text.push_str("\n  ");
        text.push_str(violation);
    }
    if violations.len() > MOST_LISTED {
        text.push_str(&format!("\n  and {} more", violations.len() - MOST_LISTED));
    }
    text
}
