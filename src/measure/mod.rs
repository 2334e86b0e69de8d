//! Derived quantities of a run: `t_switch = when(spool.s > 0.95*s_max)`.
//!
//! *In:* strings `NAME = EXPRESSION` ([`text`]). *Out:* a model that extends the user's model with the
//! variables they need ([`model`]) and, after a run, their values ([`observe`]).
//!
//! The functions of a measure turn the trajectory of an expression into one number. Their arguments become
//! variables of the extended model, which are compiled, differentiated and checked like all others.
//! Conditions become latched Booleans, whose first change is located as an event; integrals become states;
//! extreme values are found on the polynomials of the steps (`simulate::extrema`). The arithmetic between the
//! functions becomes the binding of a parameter, which is evaluated after the run. [`slopes`] are their derivatives.
pub mod error;
pub mod formula;
pub mod model;
pub mod observe;
pub mod slopes;
pub mod text;
