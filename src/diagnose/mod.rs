//! Finding what a model lacks.
pub mod balance;
pub mod effect;
pub mod page;
pub mod place;
pub mod rank;
pub mod residual;
pub mod result;
pub mod score;
pub mod search;
pub mod text;
