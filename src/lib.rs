//! `mocc`: a compiler and simulator for an equation-based modelling language (a Modelica subset).
//!
//! ```text
//!             text      ast          definitions   class tables    values          instances        flat       dae         blocks       program
//!  lib/*.mo ──► parse ──► resolve ◄──► classes ◄──► evaluate ◄──► instantiate ◄──► flatten ──► lower ──► structure ──► codegen ──┐
//!  model.mol                                                                                                                     ▼
//!    cli ──► driver  (calls the row above)      io, report ◄── trajectory ◄── simulate ◄── integrate, runtime
//! ```
//!
//! The first row, from `parse` to `codegen`, is the crate in `compiler/`; the simulator and everything that stages share is
//! the one in `engine/`. Their modules have the same paths here. Those of this crate are listed in reading order, one
//! sentence each; a module's own page says more, and ARCHITECTURE.md says what it may import.

#[doc(inline)]
pub use mocc_compiler::{
    classes, clocks, codegen, evaluate, flatten, format, instantiate, lower, parse, resolve, rules,
    structure, units,
};
#[doc(inline)]
pub use mocc_engine::{
    base, causes, define_id, external, graph, integrate, io, ir, numeric, runtime, simulate,
    symbolic, verify,
};

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
