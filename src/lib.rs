//! `mocc`: a compiler and simulator for an equation-based modelling language (a Modelica subset).
//!
//! The map of the crate, in the order of the pipeline; ARCHITECTURE.md draws it.

// Ground floor.
pub mod base;
pub mod ir;
pub mod math;
pub mod symbolic;

// From flat equations to sorted blocks.
pub mod lower;
pub mod structure;

// From sorted blocks to a trajectory.
pub mod codegen;
pub mod integrate;
pub mod simulate;

// From a trajectory to files.
pub mod report;
