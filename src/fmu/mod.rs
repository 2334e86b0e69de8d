//! Functional Mock-up Units.
pub mod disclosure;
pub mod program_wire;
