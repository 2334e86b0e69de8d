//! `mocc`: a compiler and simulator for an equation-based modelling language (a Modelica subset).
#![doc = "The map of the crate; ARCHITECTURE.md draws it."]

pub mod base;
pub mod integrate;
pub mod ir;
pub mod math;
