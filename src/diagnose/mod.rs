//! Finding what a model lacks.
pub mod effect;
pub mod place;
pub mod score;
pub mod search;
pub mod text;
