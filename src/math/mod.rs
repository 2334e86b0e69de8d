//! Mathematics that knows no equations: graphs of integers and arrays of floats.
pub mod graph;
pub mod numeric;
