//! Events: where relations change, what happens at that instant, and how event sequences that
//! never settle are treated.
//!
//! In: a step of the integrator with its dense output. Out: the instant at which the first relation
//! changes and the state after event iteration (Modelica specification 3.6, appendix B).
//! [`iterate`] locates and iterates, [`relation_search`] solves relations and equations together,
//! [`chattering`] and [`sliding`] treat relations that switch back and forth, [`zeno`] and
//! [`duplicate_event`] those that switch ever faster.

pub mod chattering;
pub mod duplicate_event;
pub mod instant;
pub mod iterate;
pub mod relation_search;
pub mod sliding;
pub mod time_events;
pub mod zeno;
