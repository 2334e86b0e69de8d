//! The representations between the stages, in pipeline order.
pub mod ast;
pub mod blocks;
pub mod dae;
pub mod expr;
pub mod flat;
pub mod program;
pub mod trajectory;
