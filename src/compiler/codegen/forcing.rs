//! Derivatives of the right side by what it reads of parameters and discrete variables, at constant states: the term
//! `df/dp` of the variational equations `s' = df/dx s + df/dp`.
//!
//! They are expressions like those of the Jacobian, and share its subexpressions. A run that is differentiated by the
//! inputs in question multiplies them by the derivatives of those parameters and variables, which change at events only.

use crate::base::index::{FastMap, FastSet};
use crate::ir::dae::VariableKind;
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::program::Forcing;

use super::SortedBlocks;
use super::emit::Emitter;
use super::jacobian;

/// Emits the derivatives that a run needs that is differentiated by the parameters `by`; `needed` and `torn_blocks` as
/// for [`jacobian::of_system`], whose layer is still open. `None` if the right side reads what has no derivative here:
/// the left limit of a variable, or a function outside of the program.
pub fn of_system(
    e: &mut Emitter,
    blocks: &SortedBlocks,
    needed: &[usize],
    torn_blocks: &FastMap<usize, u32>,
    by: &[VarId],
) -> Option<Forcing> {
    if by.is_empty() || !blocks.algebraics.is_empty() {
        return None;
    }
    let seeds = seeds(e, blocks, needed, by)?;
    e.floor = e.push_layer();
    let entries = jacobian::of_system(e, blocks, needed, torn_blocks, &seeds);
    let tape = e.pop_discard();
    let seeds = seeds.iter().map(|v| e.slot(*v)).collect();
    Some(Forcing { inputs: by.to_vec(), seeds, tape, entries })
}

/// The parameters and discrete variables that the right side reads and that may change with `by`, ascending.
fn seeds(
    e: &mut Emitter,
    blocks: &SortedBlocks,
    needed: &[usize],
    by: &[VarId],
) -> Option<Vec<VarId>> {
    let mut values: Vec<ExprId> = Vec::new();
    needed.iter().for_each(|i| values.extend(blocks.continuous[*i].expressions()));
    values.extend(blocks.states.iter().map(|s| e.read(s.derivative)).collect::<Vec<_>>());
    if reads_left_limits(e, &values)
        || e.dae.graph.externals().all().iter().any(|f| f.hides_derivatives())
    {
        return None;
    }
    let affected = affected(e, by);
    let is_seed = |v: &VarId| {
        e.dae.variables.get(*v).is_some_and(|x| {
            x.ty == Type::Real
                && match x.kind {
                    VariableKind::Parameter => affected.contains(v),
                    VariableKind::InitialParameter | VariableKind::Discrete => true,
                    _ => false,
                }
        })
    };
    let mut seeds: Vec<VarId> = e.reads(&values).into_iter().filter(is_seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    Some(seeds)
}

/// True if the left limit of a Real variable occurs below `values`.
fn reads_left_limits(e: &Emitter, values: &[ExprId]) -> bool {
    let graph = &e.dae.graph;
    let mut found = false;
    graph.descend(values.iter().copied(), |node, pending| {
        match graph.node(node) {
            Node::Var(v) => pending.extend(e.substitutions.get(v)),
            Node::Pre(_) => found |= graph.ty(node) == Type::Real,
            _ => {}
        }
        true
    });
    found
}

/// The parameters whose values depend on `by`.
fn affected(e: &Emitter, by: &[VarId]) -> FastSet<VarId> {
    let mut all: FastSet<VarId> = by.iter().copied().collect();
    for (v, value) in &e.dae.parameters {
        if e.reads(&[*value]).iter().any(|read| all.contains(read)) {
            all.insert(*v);
        }
    }
    all
}
