//! State machines.
use crate::base::diag::Diagnostic;
use crate::ir::flat::FlatModel;

pub fn elaborate(_flat: &mut FlatModel, _problems: &mut Vec<Diagnostic>) {}
