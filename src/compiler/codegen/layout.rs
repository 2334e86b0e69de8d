//! Allocates the memory map.

use crate::base::index::{FastSet, Id};
use crate::ir::blocks::Source;
use crate::ir::dae::VariableKind;
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::program::Slot;

use super::SortedBlocks;
use super::emit::Emitter;

/// Allocates a slot for every variable, flag and input; components of the integrator are
/// contiguous.
pub fn allocate(e: &mut Emitter, blocks: &SortedBlocks) {
    e.layout.time = e.new_slot(0.0);
    e.layout.initial = e.new_slot(0.0);
    e.layout.terminal = e.new_slot(0.0);
    let count = e.dae.variables.len();
    let mut slots: Vec<Option<Slot>> = vec![None; count];
    let components = blocks.components();
    e.layout.states = e.new_slots(components.len(), 0.0);
    for (i, v) in components.into_iter().enumerate() {
        slots[v.idx()] = Some(e.layout.states + i as Slot);
    }
    for v in e.dae.variables.ids() {
        if slots[v.idx()].is_none() && e.dae.variables[v].kind != VariableKind::Parameter {
            slots[v.idx()] = Some(e.new_slot(default_start(e.dae.variables[v].ty)));
        }
    }
    // The slots of parameters follow.
    e.layout.variables = slots.into_iter().map(Option::unwrap_or_default).collect();
    e.layout.derivatives = blocks.states.iter().map(|s| e.slot(s.derivative)).collect();
    let algebraics = blocks.algebraics.len();
    let residuals = e.new_slots(algebraics, 0.0);
    e.layout.derivatives.extend(residuals..residuals + algebraics as Slot);
    let relations = e.dae.relations.len();
    e.layout.relations = e.new_slots(relations, 0.0);
    e.layout.candidates = e.new_slots(relations, 0.0);
    e.layout.indicators = e.new_slots(relations, 0.0);
    allocate_pre(e, blocks);
    allocate_inputs(e, blocks);
    allocate_parameters(e);
}

/// Allocates parameters and their inputs, which are contiguous: there may be thousands, as in tables, and they do not
/// change during a run. What they are computed from follows.
fn allocate_parameters(e: &mut Emitter) {
    let first = e.image.len() as Slot;
    for v in e.dae.variables.ids() {
        if e.dae.variables[v].kind == VariableKind::Parameter {
            e.layout.variables[v.idx()] = e.new_slot(default_start(e.dae.variables[v].ty));
        }
    }
    for k in 0..e.dae.parameters.len() {
        let v = e.dae.parameters[k].0;
        let slot = e.new_slot(f64::NAN);
        e.layout.parameter_inputs.push((v, slot));
    }
    e.layout.parameters = (first, e.image.len() as Slot);
}

/// Allocates `pre` of discrete variables, and of all others whose `pre` is read.
fn allocate_pre(e: &mut Emitter, blocks: &SortedBlocks) {
    let mut read: FastSet<VarId> = FastSet::default();
    for node in e.dae.graph.postorder(roots(e, blocks)) {
        if let Node::Pre(v) = e.dae.graph.node(node) {
            read.insert(v);
        }
    }
    for v in e.dae.variables.ids() {
        let kind = e.dae.variables[v].kind;
        let moves = !matches!(kind, VariableKind::Parameter | VariableKind::Eliminated);
        if kind == VariableKind::Discrete || (moves && read.contains(&v)) {
            let slot = e.new_slot(0.0);
            e.layout.pre.push((v, e.slot(v), slot));
            e.pre_slots.insert(v, slot);
        }
    }
}

/// Allocates slots for the values that a run may set; NaN means not set.
fn allocate_inputs(e: &mut Emitter, blocks: &SortedBlocks) {
    let mut started: FastSet<VarId> = FastSet::default();
    for block in &blocks.initial {
        block.for_each_assignment(&mut |a| {
            if let Source::Start(v) = a.source {
                started.insert(v);
            }
        });
    }
    for v in e.dae.variables.ids() {
        let variable = &e.dae.variables[v];
        if matches!(variable.kind, VariableKind::Parameter | VariableKind::Eliminated) {
            continue;
        }
        if variable.start.is_some() || started.contains(&v) {
            let input = e.new_slot(f64::NAN);
            let start = e.new_slot(0.0);
            e.layout.starts.push((v, input, start));
            e.start_slots.insert(v, start);
        }
    }
}

/// The default start value of a type: zero, false, or the first enumeration literal.
pub fn default_start(ty: Type) -> f64 {
    if matches!(ty, Type::Enumeration(_)) { 1.0 } else { 0.0 }
}

fn roots(e: &Emitter, blocks: &SortedBlocks) -> Vec<ExprId> {
    let mut all = Vec::new();
    let starts = blocks.initial.iter().chain(&blocks.initial_by_states);
    for block in starts.chain(&blocks.event).chain(&blocks.continuous) {
        block.for_each_expression(&mut |e| all.push(e));
    }
    e.dae.for_each_equation_expression(&mut |e| all.push(e));
    e.dae.for_each_side_expression(&mut |e| all.push(e));
    all
}
