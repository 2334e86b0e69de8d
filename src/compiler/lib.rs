//! The compiler of mocc, from the text of a model to a program. It runs nothing and draws nothing.
//!
//! The modules are listed in reading order, one sentence each; a module's own page says more, and ARCHITECTURE.md says
//! what it may import.

// Modules of the crate below have the same paths here.
use mocc_engine::{base, define_id, external, graph, io, ir, numeric, symbolic};

// Text to syntax tree.
pub mod parse;
// Text to the same text, formatted.
pub mod format;
// Class names to class definitions.
pub mod resolve;
// Names to classes, and what classes have after inheritance.
pub mod classes;
// The specification's rules that only report.
pub mod rules;
// Expressions, functions and algorithms to values.
pub mod evaluate;
// Classes and modifications to component instances.
pub mod instantiate;
// Instances to scalar variables and equations.
pub mod flatten;
// A flat model with clocks and state machines to one without.
pub mod clocks;
// Unit checking of a flat model.
pub mod units;
// Flat model to hybrid differential-algebraic system.
pub mod lower;
// Index reduction, sorting, tearing.
pub mod structure;
// Sorted blocks to a program.
pub mod codegen;

#[cfg(test)]
mod tests;
