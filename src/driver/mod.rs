//! From a request to a flat model, to sorted blocks, to a program: the recipe, and the files it reads.
pub mod catalogue;
pub mod cause;
pub mod check;
pub mod compile;
mod dotted_name;
pub mod files;
pub mod foreign;
pub mod hints;
pub mod lookup;
pub mod memory;
pub mod packed;
pub mod project;
pub mod quantity;
pub mod replacements;
pub mod stamps;
