//! Algebra on [`crate::ir::expr`]: the only place that knows what the operators mean.
pub mod arithmetic;
pub mod dominance;
pub mod eval;
pub mod function_derivative;
pub mod gradient;
pub mod linear;
pub mod partial;
pub mod print;
pub mod rewrite;
pub mod simplify;
pub mod string;
pub mod substitute;
pub mod uses;
