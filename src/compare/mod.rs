//! The comparison of two runs.
//!
//! In: two [`Trajectory`](crate::ir::trajectory::Trajectory) values, one of which is the reference. Out: the variables
//! that leave the tube around the reference ([`tube`]), and the events that moved, came or went ([`events`]).
//! [`thin`] keeps the rows of a run that a reference needs.

pub mod events;
pub mod thin;
pub mod tolerance;
pub mod tube;
