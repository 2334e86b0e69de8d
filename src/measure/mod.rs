//! Derived quantities of a run: `t_switch = when(spool.s > 0.95*s_max)`.
//!
//! *In:* texts `NAME = EXPRESSION` ([`text`]). *Out:* a model that extends the user's model by what they need
//! ([`model`]), and after a run their values ([`observe`]).
//!
//! The functions of a measure turn the course of an expression into one number. What they are of becomes
//! a variable of the extended model: so it is compiled, differentiated and checked like everything else in
//! the model. Conditions become Booleans that stay true, whose first change is an event and found as exactly
//! as any; integrals become states; extreme values are sought on the polynomials of the steps
//! (`simulate::extrema`). The arithmetic between the functions becomes the binding of a parameter, which is
//! evaluated after the run.
pub mod error;
pub mod formula;
pub mod model;
pub mod observe;
pub mod text;
