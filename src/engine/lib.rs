//! The engine of mocc: representations of models, numerical methods and file formats, and the simulation of compiled
//! models. It knows nothing of the language's text.
//!
//! The modules are listed in reading order, one sentence each; a module's own page says more, and ARCHITECTURE.md says
//! what it may import.

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

// ---- The simulator ----

// Evaluates a program: interpreter, machine code, derivatives.
pub mod runtime;
// Integration of semi-explicit systems in time.
pub mod integrate;
// Initialization, events, trajectories.
pub mod simulate;
