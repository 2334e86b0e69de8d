//! From a program to a trajectory.
//!
//! In: a [`Program`](crate::ir::program::Program) and [`settings::Settings`]. Out: rows and events
//! to a [`record::Sink`], or a [`failure::Failure`] in the user's names. Between events relations
//! are held and the integrator sees a smooth system; at events the discrete equations are iterated
//! to a fixed point.
//!
//! Sources: Modelica specification 3.6, appendix B (the hybrid system), section 8.6
//! (initialization), section 3.7.5 (`sample`, `pre`, `edge`).

pub mod bound_warnings;
pub mod cause;
pub mod columns;
pub mod extrema;
pub mod failure;
pub mod foreign;
pub mod frequency_response;
pub mod grid;
mod history;
pub mod homotopy;
pub mod initialization;
pub mod integers;
pub mod linearize;
pub mod method;
pub mod operating_point;
mod options;
pub mod ports;
pub mod record;
mod rows;
pub mod run;
pub mod sensitivity;
pub mod settable;
pub mod settings;
mod slow_progress;
pub mod state_selection;
pub mod stepping;
pub mod system;
mod time_features;

pub mod event;
