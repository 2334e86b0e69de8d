//! Functional Mock-up Units: models for other tools.
//!
//! In: a program. Out: the archive of an FMU ([`export`](mod@export)), and in the importer's process its instances
//! ([`instance`]), which the shared library of the workspace member `fmu/` offers as C functions.
//!
//! Sources: Functional Mock-up Interface 2.0.5 and 3.0.2, Modelica Association.

pub mod archive;
pub mod cause;
pub mod dependencies;
pub mod description;
pub mod disclosure;
pub mod exchange;
pub mod export;
pub mod import;
pub mod instance;
pub mod interface;
pub mod package;
pub mod terminals;
pub mod tunable;
