//! The representations between the stages, in pipeline order.
pub mod trajectory;
