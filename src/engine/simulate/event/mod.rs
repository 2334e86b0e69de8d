//! Events: locating them, executing them, and handling sequences of events that do not end.
//!
//! In: a step of the integrator with its dense output. Out: the instant at which the first relation
//! changes and the state after event iteration (Modelica specification 3.6, appendix B).
//! [`locate`] finds the instant, also between probes that agree ([`dips`]), [`instant`] executes the event there, [`iterate`] iterates its
//! discrete equations, and [`relation_search`] solves relations and equations together. At the start, [`relation_start`]
//! gives relations the values with which they begin.
//! [`chattering`] and [`sliding`] handle relations that switch back and forth, [`zeno`] those that
//! switch ever faster, [`duplicate_event`] those that an event itself switches back.

pub mod chattering;
pub mod dips;
pub mod duplicate_event;
pub mod instant;
pub mod iterate;
pub mod locate;
pub mod relation_search;
pub mod relation_start;
pub mod sliding;
pub mod time_events;
pub mod zeno;
