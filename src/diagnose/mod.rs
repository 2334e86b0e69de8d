//! Finding what a model lacks.
pub mod attempt;
pub mod balance;
pub mod case;
pub mod effect;
pub mod level;
pub mod page;
pub mod pairs;
pub mod place;
pub mod preference;
pub mod rank;
pub mod residual;
pub mod result;
pub mod revise;
pub mod score;
pub mod search;
pub mod shape;
pub mod text;
