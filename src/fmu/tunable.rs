//! Parameters that may change while a model runs.
//!
//! Every Real parameter may, from one event to the next, except those that decide when clocks tick or how long delays are:
//! these instants are already planned.

use crate::base::index::FastSet;
use crate::ir::expr::{Type, VarId};
use crate::ir::program::{Program, Slot};

use super::dependencies::Dependencies;

/// The tunable parameters of a program.
pub fn tunable(program: &Program) -> FastSet<VarId> {
    let variables = &program.blocks.dae.variables;
    let real: Vec<(VarId, Slot)> = program
        .layout
        .parameter_inputs
        .iter()
        .copied()
        .filter(|(v, _)| variables[*v].ty == Type::Real && !variables[*v].structural)
        .collect();
    let known: Vec<Slot> = real.iter().map(|(_, slot)| *slot).collect();
    let traced = Dependencies::trace_parameters(program, &known);
    let clocks = program.events.clocks.iter().flat_map(|c| [c.start, c.interval]);
    let delays = program.layout.delays.iter().map(|d| d.delay);
    let planned: FastSet<usize> = clocks.chain(delays).flat_map(|slot| traced.of(slot)).collect();
    let all = real.into_iter().enumerate().filter(|(k, _)| !planned.contains(k));
    all.map(|(_, (v, _))| v).collect()
}
