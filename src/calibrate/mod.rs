//! Fitting a model to recordings.
pub mod data;
pub mod fit;
pub mod parallel;
pub mod plan;
pub mod problem;
pub mod unit;
