//! `mocc`: a compiler and simulator for an equation-based modelling language (a Modelica subset).
//!
//! ```text
//!             text        ast          library       instance        flat          dae         blocks       program
//!  lib/*.mo ──► parse ───► resolve ───► instantiate ───► flatten ───► lower ───► structure ───► codegen ──┐
//!  model.mol                                                                                              ▼
//!    cli ──► driver  (calls the row above, then)                        report ◄── trajectory ◄──── simulate ◄── integrate
//! ```
//!
//! The modules stand in reading order, each with a sentence; its own page says more, and
//! ARCHITECTURE.md what it may import.

// ---- Ground floor ----

// Spans, diagnostics, interned names, typed indices.
pub mod base;
// The representations between the stages.
pub mod ir;
// Algebra on expressions.
pub mod symbolic;
// Graphs of integers and arrays of floats.
pub mod math;

// ---- The pipeline, front to back ----

// Text to syntax tree.
pub mod parse;
// Text to the same text, in order.
pub mod format;
// Names of classes to their texts.
pub mod resolve;
// Classes and modifications to component instances.
pub mod instantiate;
// Instances to scalar variables and equations.
pub mod flatten;
// Do the units of a flat model agree?
pub mod units;
// Flat model to hybrid differential-algebraic system.
pub mod lower;
// Index reduction, sorting, tearing.
pub mod structure;
// Sorted blocks to code.
pub mod codegen;
// Integration of semi-explicit systems in time.
pub mod integrate;
// Initialisation, events, trajectories.
pub mod simulate;
// Tables and figures.
pub mod report;

// ---- The program ----

// Derived quantities of a run.
pub mod measure;
// The recipe: from files to a compiled model.
pub mod driver;
// Many runs of one model.
pub mod sweep;
// Parameters from recordings.
pub mod calibrate;
// What a model lacks, from recordings.
pub mod diagnose;
// The command line.
pub mod cli;
