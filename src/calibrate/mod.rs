//! Fitting a model to recordings.
pub mod calibration;
pub mod data;
pub mod fit;
pub mod model;
pub mod modification;
pub mod page;
pub mod parallel;
pub mod plan;
pub mod problem;
pub mod profile;
pub mod statistics;
pub mod unit;
