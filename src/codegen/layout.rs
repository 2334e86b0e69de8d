//! The memory map.

use crate::base::index::{FastSet, Id};
use crate::ir::blocks::{Assignment, Block, Source};
use crate::ir::dae::Kind;
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::program::Slot;

use super::Order;
use super::emit::Emitter;

/// Gives every variable, flag and input its cell; what is integrated stands in a row.
pub fn allocate(e: &mut Emitter, blocks: &Order) {
    e.layout.time = e.cell(0.0);
    e.layout.initial = e.cell(0.0);
    e.layout.terminal = e.cell(0.0);
    let count = e.dae.variables.len();
    let mut slots: Vec<Option<Slot>> = vec![None; count];
    let components = blocks.components();
    e.layout.states = e.cells(components.len(), 0.0);
    for (i, v) in components.into_iter().enumerate() {
        slots[v.idx()] = Some(e.layout.states + i as Slot);
    }
    e.layout.variables = slots
        .into_iter()
        .enumerate()
        .map(|(v, s)| {
            s.unwrap_or_else(|| e.cell(resting_value(e.dae.variables[VarId::from_usize(v)].ty)))
        })
        .collect();
    e.layout.derivatives = blocks.states.iter().map(|s| e.slot(s.derivative)).collect();
    let algebraics = blocks.algebraics.len();
    let residuals = e.cells(algebraics, 0.0);
    e.layout.derivatives.extend(residuals..residuals + algebraics as Slot);
    let relations = e.dae.relations.len();
    e.layout.relations = e.cells(relations, 0.0);
    e.layout.fresh = e.cells(relations, 0.0);
    e.layout.gaps = e.cells(relations, 0.0);
    allocate_pre(e, blocks);
    allocate_inputs(e, blocks);
}

/// `pre` of discrete variables, and of all others of which it is read.
fn allocate_pre(e: &mut Emitter, blocks: &Order) {
    let mut read: FastSet<VarId> = FastSet::default();
    for node in e.dae.graph.postorder(roots(e, blocks)) {
        if let Node::Pre(v) = e.dae.graph.node(node) {
            read.insert(v);
        }
    }
    for v in e.dae.variables.ids() {
        let kind = e.dae.variables[v].kind;
        let moves = !matches!(kind, Kind::Parameter | Kind::Eliminated);
        if kind == Kind::Discrete || (moves && read.contains(&v)) {
            let cell = e.cell(0.0);
            e.layout.pre.push((v, e.slot(v), cell));
            e.pre.insert(v, cell);
        }
    }
}

/// Cells for the values that a run may give: NaN where it does not.
fn allocate_inputs(e: &mut Emitter, blocks: &Order) {
    for k in 0..e.dae.parameters.len() {
        let v = e.dae.parameters[k].0;
        let cell = e.cell(f64::NAN);
        e.layout.parameter_inputs.push((v, cell));
    }
    let mut started: FastSet<VarId> = FastSet::default();
    for_each_assignment(&blocks.initial, &mut |a| {
        if let Source::Start(v) = a.source {
            started.insert(v);
        }
    });
    for v in e.dae.variables.ids() {
        let variable = &e.dae.variables[v];
        if matches!(variable.kind, Kind::Parameter | Kind::Eliminated) {
            continue;
        }
        if variable.start.is_some() || started.contains(&v) {
            let input = e.cell(f64::NAN);
            let start = e.cell(0.0);
            e.layout.starts.push((v, input, start));
            e.starts.insert(v, start);
        }
    }
}

/// Calls `visit` with every assignment, those inside of torn and mixed blocks too.
pub fn for_each_assignment(blocks: &[Block], visit: &mut impl FnMut(&Assignment)) {
    for block in blocks {
        match block {
            Block::Assign(a) => visit(a),
            Block::Torn(t) => t.explicit.iter().for_each(&mut *visit),
            Block::Mixed(parts) => for_each_assignment(parts, visit),
        }
    }
}

/// All expressions of a block.
pub fn block_values(block: &Block, out: &mut Vec<ExprId>) {
    match block {
        Block::Assign(a) => out.push(a.value),
        Block::Torn(t) => {
            out.extend(t.explicit.iter().map(|a| a.value));
            out.extend(t.residuals.iter().map(|r| r.value));
        }
        Block::Mixed(parts) => parts.iter().for_each(|p| block_values(p, out)),
    }
}

/// All variables that a block determines.
pub fn block_unknowns(block: &Block, out: &mut Vec<VarId>) {
    match block {
        Block::Assign(a) => out.push(a.variable),
        Block::Torn(t) => {
            out.extend(&t.unknowns);
            out.extend(t.explicit.iter().map(|a| a.variable));
        }
        Block::Mixed(parts) => parts.iter().for_each(|p| block_unknowns(p, out)),
    }
}

/// The value of a variable without start value: zero, false, or the first literal.
pub fn resting_value(ty: Type) -> f64 {
    if matches!(ty, Type::Enumeration(_)) { 1.0 } else { 0.0 }
}

fn roots(e: &Emitter, blocks: &Order) -> Vec<ExprId> {
    let mut all = Vec::new();
    for block in blocks.initial.iter().chain(&blocks.event).chain(&blocks.continuous) {
        block_values(block, &mut all);
    }
    let dae = &e.dae;
    all.extend(dae.relations.iter().flat_map(|r| [r.lhs, r.rhs]));
    all.extend(dae.reinits.iter().flat_map(|r| [r.active, r.value]));
    all.extend(dae.asserts.iter().map(|a| a.assert.condition));
    all.extend(dae.asserts.iter().filter_map(|a| a.active));
    all.extend(dae.terminates.iter().map(|t| t.active));
    all.extend(dae.eliminated.iter().map(|(_, value)| *value));
    all
}
