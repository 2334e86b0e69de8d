//! From a program to a trajectory.
//!
//! What comes in: a [`Program`](crate::ir::program::Program) and [`settings::Settings`]. What goes
//! out: rows and events to a [`record::Sink`], or a [`error::Failure`] in the user's names.
//! Between events relations are held and the integrator sees a smooth system; at events the system
//! is evaluated with fresh relations until nothing changes any more.
//!
//! Sources: Modelica specification 3.6, appendix B (the hybrid system), section 8.6 (initialisation),
//! section 3.7.5 (`sample`, `pre`, `edge`).
pub mod assertion;
pub mod clock;
pub mod columns;
pub mod echo;
pub mod error;
pub mod events;
pub mod explain;
pub mod extremes;
pub mod homotopy;
pub mod initial;
pub mod limits;
pub mod instant;
pub mod meeting;
pub mod method;
mod options;
pub mod piling;
pub mod precondition;
pub mod record;
pub mod relations;
pub mod run;
pub mod selection;
pub mod sensitivity;
pub mod settings;
pub mod sliding;
pub mod surface;
pub mod system;

#[cfg(test)]
mod tests;
