//! Integrates `M y' = f(t, y)` step by step.
//!
//! In: a [`system::System`] (right side, Jacobian, diagonal of `M`), a start point and
//! [`options::Options`]. Out: accepted steps with dense output, or an [`outcome::Failure`] that
//! names the worst component. Events, output and variable names are left to the caller.
//!
//! Sources: E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I* (2nd
//! ed. 1993); E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II* (2nd ed. 1996).
//!
//! The interface is [`stepper::Stepper`], implemented by [`radau::Radau`] and [`bdf::Bdf`] (stiff
//! systems and index-1 differential-algebraic systems), [`explicit::DormandPrince`] (non-stiff
//! systems) and [`switching::Switching`] (explicit until the system turns out to be stiff).
#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "`!(a < b)` makes NaN fail the test")]

pub mod bdf;
pub mod control;
pub mod explicit;
pub mod matrix;
pub mod options;
pub mod outcome;
pub mod radau;
pub mod stats;
pub mod stepper;
pub mod switching;
pub mod system;
pub mod variational;

#[cfg(test)]
mod problems;
