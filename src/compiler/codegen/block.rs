//! Compiles blocks: assignments, torn blocks, and mixed blocks.

use crate::base::index::{FastSet, Id};
use crate::ir::blocks::{Assignment, Block, Source, Torn};
use crate::ir::dae::VariableKind;
use crate::ir::expr::{Binary, ExprId, Node, Type, Unary, VarId};
use crate::ir::program::{
    BlockPosition, DiscreteUnknown, Entry, MixedBlock, Op, Slot, TornBlock, source_span,
};

use super::emit::{DISCRETE, Emitter, Level, PARAMETER};
use super::jacobian;
use super::relation::{evaluate_relation, relations_in};

/// Emits a block to the layer determined by its operands.
pub fn compile_block(e: &mut Emitter, block: &Block, place: BlockPosition) {
    match block {
        Block::Assign(a) => compile_assignment(e, a),
        Block::Torn(t) => compile_torn(e, t, place),
        Block::Mixed(parts) => compile_mixed(e, parts, &[], place),
    }
}

/// Emits an assignment.
pub fn compile_assignment(e: &mut Emitter, a: &Assignment) {
    e.span = source_span(&e.dae, a.source);
    if let Source::Start(v) = a.source
        && let Some(&start) = e.start_slots.get(&v)
    {
        let dst = e.slot(a.variable);
        e.push(DISCRETE, Op::Copy, dst, start, start);
        e.levels[a.variable.idx()] = Some(DISCRETE);
        return;
    }
    e.assign(a.variable, a.value);
}

fn compile_torn(e: &mut Emitter, torn: &Torn, place: BlockPosition) {
    let torn = &with_start_slots(e, torn);
    let block = Block::Torn(torn.clone());
    let (own, values) = (block.unknowns(), block.expressions());
    let own_set: FastSet<VarId> = own.iter().copied().collect();
    let inputs = e.level_of(&values, |v| own_set.contains(&v));
    let target = e.layer_for(inputs.max(DISCRETE));

    let layer = e.push_layer();
    for &v in &torn.unknowns {
        e.levels[v.idx()] = Some(layer);
    }
    for a in &torn.explicit {
        compile_assignment(e, a);
    }
    let mut residuals = Vec::new();
    for r in &torn.residuals {
        e.span = source_span(&e.dae, r.source);
        residuals.push(e.emit(r.value).0);
    }
    let entries = jacobian::of_torn(e, torn);
    e.push_layer();
    let mut jacobian = Vec::new();
    for (row, column, value) in entries {
        jacobian.push(Entry { row, column, slot: e.emit(value).0 });
    }
    let jacobian_tape = e.pop_discard();
    let residual_tape = e.pop_merge(target);
    for &v in &own {
        e.levels[v.idx()] = e.levels[v.idx()].map(|l| if l == layer { target } else { l });
    }
    let nominals = torn.unknowns.iter().map(|v| nominal(e, *v)).collect();
    let bounds = torn.unknowns.iter().map(|v| bounds(e, *v)).collect();
    let torn_block = TornBlock {
        slots: torn.unknowns.iter().map(|v| e.slot(*v)).collect(),
        unknowns: torn.unknowns.clone(),
        residual_tape,
        residuals,
        jacobian_tape,
        jacobian,
        nominals,
        bounds,
        linear: torn.linear,
        place,
    };
    e.routines.torn_blocks.push(torn_block);
    e.push(target, Op::Solve, 0, (e.routines.torn_blocks.len() - 1) as Slot, 0);
}

/// Makes residuals `v - start` read the slot of the start value, which a run may set.
fn with_start_slots(e: &mut Emitter, torn: &Torn) -> Torn {
    let mut torn = torn.clone();
    for r in &mut torn.residuals {
        if let Source::Start(v) = r.source
            && let Some(&slot) = e.start_slots.get(&v)
        {
            let start = e.auxiliary(Some(PARAMETER));
            e.layout.variables[start.idx()] = slot;
            let (own, start) = (e.read(v), e.dae.graph.var(start, Type::Real));
            r.value = e.dae.graph.sub(own, start);
        }
    }
    torn
}

/// Emits a mixed block whose iteration also evaluates `relations`.
pub fn compile_mixed(e: &mut Emitter, parts: &[Block], relations: &[usize], place: BlockPosition) {
    let target = e.layer_for(e.continuous_level.max(DISCRETE));
    let layer = e.push_layer();
    let own: Vec<VarId> = parts.iter().flat_map(Block::unknowns).collect();
    for &v in &own {
        e.levels[v.idx()] = Some(layer);
    }
    let decides = decisions(e, parts, relations);
    compile_parts(e, parts, |i| decides[i], layer, place);
    let decisions = e.pop_discard();
    e.push_layer();
    compile_parts(e, parts, |i| !decides[i], layer, place);
    for &k in relations {
        evaluate_relation(e, k, place.sequence);
    }
    let tape = e.pop_discard();
    let mut discrete_unknowns = Vec::new();
    for &v in &own {
        e.levels[v.idx()] = Some(target);
        if e.dae.variables[v].kind == VariableKind::Discrete {
            discrete_unknowns.push(DiscreteUnknown::Variable(v, e.slot(v)));
        }
    }
    let first = e.layout.relations;
    discrete_unknowns
        .extend(relations.iter().map(|&k| DiscreteUnknown::Relation(k as u32, first + k as Slot)));
    let edges = edges_read(e, &own);
    e.routines.mixed_blocks.push(MixedBlock { decisions, tape, discrete_unknowns, edges, place });
    e.push(target, Op::Iterate, 0, (e.routines.mixed_blocks.len() - 1) as Slot, 0);
}

/// Which blocks determine discrete variables that follow from some relations directly. None if none of them also reads a
/// `pre` value: then nothing but these relations changes from one pass of the event iteration to the next.
pub fn decisions(e: &Emitter, blocks: &[Block], relations: &[usize]) -> Vec<bool> {
    let decides = |block: &Block| {
        let Block::Assign(a) = block else { return false };
        let is_discrete = e.dae.variables[a.variable].kind == VariableKind::Discrete;
        let read = relations_in(e, &[a.value]);
        is_discrete && read.iter().any(|k| relations.contains(&(*k as usize)))
    };
    let reads_pre = |block: &Block| {
        let nodes = e.dae.graph.postorder(block.expressions());
        nodes.into_iter().any(|n| matches!(e.dae.graph.node(n), Node::Pre(_)))
    };
    let mut found: Vec<bool> = blocks.iter().map(decides).collect();
    if !blocks.iter().zip(&found).any(|(block, decides)| *decides && reads_pre(block)) {
        found.fill(false);
    }
    found
}

/// Emits those parts of a mixed block that are wanted by their positions.
fn compile_parts(
    e: &mut Emitter,
    parts: &[Block],
    is_wanted: impl Fn(usize) -> bool,
    layer: Level,
    place: BlockPosition,
) {
    for (_, part) in parts.iter().enumerate().filter(|(i, _)| is_wanted(*i)) {
        compile_block(e, part, place);
        // The remaining parts may change values that were computed from the unknowns of the block.
        e.invalidate_top();
        for v in part.unknowns() {
            e.levels[v.idx()] = Some(layer);
        }
    }
}

/// The Boolean variables that the equations of discrete variables read as `b and not pre(b)`, outside of
/// these variables.
fn edges_read(e: &mut Emitter, own: &[VarId]) -> Vec<(Slot, Slot)> {
    let graph = &e.dae.graph;
    let of_own = e.dae.discrete.iter().filter(|d| own.contains(&d.variable));
    let is_not_before = |n: ExprId, now: ExprId| match (graph.node(n), graph.node(now)) {
        (Node::Unary(Unary::Not, before), Node::Var(v)) => graph.node(before) == Node::Pre(v),
        _ => false,
    };
    let mut found: Vec<VarId> = Vec::new();
    for n in graph.postorder(of_own.map(|d| d.value)) {
        let Node::Binary(Binary::And, a, b) = graph.node(n) else { continue };
        for (now, other) in [(a, b), (b, a)] {
            if let Node::Var(v) = graph.node(now)
                && is_not_before(other, now)
                && !own.contains(&v)
                && !found.contains(&v)
            {
                found.push(v);
            }
        }
    }
    found.into_iter().map(|v| (e.slot(v), e.pre_slot(v))).collect()
}

/// The slot of the nominal value of a variable; 1 if it has none.
pub fn nominal(e: &mut Emitter, v: VarId) -> Slot {
    match e.dae.variables[v].nominal {
        Some(value) if e.level_of(&[value], |_| false) == PARAMETER => e.emit(value).0,
        _ => e.literal(1.0),
    }
}

/// The slots of the bounds of a variable, infinite if it has none.
pub fn bounds(e: &mut Emitter, v: VarId) -> (Slot, Slot) {
    let variable = &e.dae.variables[v];
    let (min, max) = (variable.min, variable.max);
    let mut slot = |bound: Option<ExprId>, none: f64| match bound {
        Some(value) if e.level_of(&[value], |_| false) == PARAMETER => e.emit(value).0,
        _ => e.literal(none),
    };
    (slot(min, f64::NEG_INFINITY), slot(max, f64::INFINITY))
}
