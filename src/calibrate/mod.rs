//! Fitting the parameters of a model to recordings.
//!
//! *In:* a plan file ([`plan`], [`plan_file`]), the recordings that it names ([`data`]) and the program of its model.
//! *Out:* estimates with standard errors and confidence intervals ([`result`]), a page ([`page`]) and the
//! calibrated model as text ([`calibrated_model`]). [`run`] is the whole workflow for any front end.
//!
//! [`problem`] turns parameters into residuals ([`recording_run`]) and their derivatives ([`slopes`]), for all
//! recordings together ([`objective`]), [`fit`] minimises them under the
//! rules of [`policy`], [`statistics`] and [`profile`] say how well the data determine the result.
pub mod calibrated_model;
pub mod cancellation;
pub mod cause;
pub mod data;
mod difference;
pub mod elsewhere;
pub mod evaluate;
pub mod extended_source;
pub mod fit;
pub mod memory;
pub mod modification;
pub mod noise;
pub mod objective;
pub mod observer;
pub mod own_fit;
pub mod page;
pub mod parallel;
pub mod parameter;
pub mod plan;
pub mod plan_file;
pub mod policy;
pub mod problem;
pub mod profile;
pub mod recording_number;
pub mod recording_run;
pub mod residual_vector;
pub mod result;
pub mod rows;
pub mod run;
pub mod skeleton;
pub mod slopes;
pub mod statistics;
pub mod sums;
pub mod table;
pub mod unit;
pub mod unit_check;
pub mod window;
