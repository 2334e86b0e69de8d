//! The tests that see mocc from outside, in one binary.
mod checks;
