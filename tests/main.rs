//! All integration tests, one binary: each further binary would link the whole crate again.
mod checks;
