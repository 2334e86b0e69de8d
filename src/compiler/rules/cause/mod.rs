//! Causes that rules of the specification report, by topic.

pub mod element;
pub mod specialized_class;
