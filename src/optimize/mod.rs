//! Design parameters that make a measure of a run least or greatest, under limits on other measures.
//!
//! *In:* a plan file ([`plan`]). *Out:* the best design of several searches, before and after ([`result`]), as text, JSON,
//! a page ([`page`]) and an amended model ([`amended`]). [`run`] is the whole workflow for any front end.
//!
//! [`problem`] turns a point of the search into measures and their derivatives: exact ones from the sensitivities of the
//! run, else differences. The search is [`crate::numeric::sqp`].

pub mod amended;
pub mod cause;
pub mod page;
pub mod plan;
pub mod problem;
pub mod result;
pub mod run;
