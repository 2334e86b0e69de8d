//! `mocc`: a compiler and simulator for an equation-based modelling language (a Modelica subset).
//!
//! ```text
//!             text      ast          definitions   class tables    values          instances        flat       dae         blocks       program
//!  lib/*.mo ──► parse ──► resolve ◄──► classes ◄──► evaluate ◄──► instantiate ◄──► flatten ──► lower ──► structure ──► codegen ──┐
//!  model.mol                                                                                                                     ▼
//!    cli ──► driver  (calls the row above)      io, report ◄── trajectory ◄── simulate ◄── integrate, runtime
//! ```
//!
//! The modules are listed in reading order, one sentence each; a module's own page says more, and
//! ARCHITECTURE.md says what it may import.

// ---- Ground floor ----

// Spans, diagnostics, interned names, typed indices.
pub mod base;
// Graph algorithms on integers.
pub mod graph;
// Numerical methods on floats.
pub mod numeric;
// File formats: CSV, MAT, Parquet, JSON, journals.
pub mod io;
// The Standard Library's C functions: tables, random numbers, strings.
pub mod external;
// The representations between the stages.
pub mod ir;
// Algebra on expressions.
pub mod symbolic;
// The contracts of the representations, checked after each stage.
pub mod verify;

// ---- The compiler, front to back ----

// Text to syntax tree.
pub mod parse;
// Text to the same text, formatted.
pub mod format;
// Class names to class definitions.
pub mod resolve;
// Names to classes, and what classes have after inheritance.
pub mod classes;
pub mod clocks;
// The specification's rules that only report.
pub mod rules;
// Expressions, functions and algorithms to values.
pub mod evaluate;
// Classes and modifications to component instances.
pub mod instantiate;
// Instances to scalar variables and equations.
pub mod flatten;
// Unit checking of a flat model.
pub mod units;
// Flat model to hybrid differential-algebraic system.
pub mod lower;
// Index reduction, sorting, tearing.
pub mod structure;
// Sorted blocks to a program.
pub mod codegen;

// ---- The simulator ----

// Evaluates a program: interpreter, machine code, derivatives.
pub mod runtime;
// Integration of semi-explicit systems in time.
pub mod integrate;
// Initialization, events, trajectories.
pub mod simulate;
// Plots, diagrams and pages.
pub mod report;
// Two runs compared within tolerances.
pub mod compare;

// ---- The program ----

// Derived quantities of a run.
pub mod measure;
// The recipe: from files to a compiled model.
pub mod driver;
// Models for other tools: Functional Mock-up Units.
pub mod fmu;
// Many runs of one model.
pub mod sweep;
// Parameters from recordings.
pub mod calibrate;
// The design that makes a measure least or greatest.
pub mod optimize;
// The effect that a model lacks, from recordings.
pub mod diagnose;
// Tests of a user's own models.
pub mod regression;
// Pages of libraries.
pub mod doc;
// Models in an editor: the language server protocol.
pub mod lsp;
// All causes of diagnostics.
pub mod registry;
// The command line.
pub mod cli;
