//! Blocks: assignments, torn blocks, and mixed blocks.

use crate::base::index::{FastSet, Id};
use crate::ir::blocks::{Assignment, Block, Source, Torn};
use crate::ir::dae::Kind;
use crate::ir::expr::{ExprId, Type, VarId};
use crate::ir::program::{BlockPlace, Entry, Loop, Op, Slot, Solver, Watched, source_span};

use super::emit::{Emitter, HELD, PARAMETER};
use super::jacobian;
use super::layout::{block_unknowns, block_values};
use super::relation::evaluate_relation;

/// Emits one block to the layer that its operands ask for.
pub fn compile_block(e: &mut Emitter, block: &Block, place: BlockPlace) {
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
        && let Some(&start) = e.starts.get(&v)
    {
        let dst = e.slot(a.variable);
        e.push(HELD, Op::Copy, dst, start, start);
        e.levels[a.variable.idx()] = Some(HELD);
        return;
    }
    e.assign(a.variable, a.value);
}

fn compile_torn(e: &mut Emitter, torn: &Torn, place: BlockPlace) {
    let torn = &with_start_cells(e, torn);
    let block = Block::Torn(torn.clone());
    let (mut own, mut values) = (Vec::new(), Vec::new());
    block_unknowns(&block, &mut own);
    block_values(&block, &mut values);
    let own_set: FastSet<VarId> = own.iter().copied().collect();
    let inputs = e.level_of(&values, |v| own_set.contains(&v));
    let target = e.home(inputs.max(HELD));

    let inside = e.push_layer();
    for &v in &torn.unknowns {
        e.levels[v.idx()] = Some(inside);
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
        e.levels[v.idx()] = e.levels[v.idx()].map(|l| if l == inside { target } else { l });
    }
    let nominals = torn.unknowns.iter().map(|v| nominal(e, *v)).collect();
    let bounds = torn.unknowns.iter().map(|v| bounds(e, *v)).collect();
    let solver = Solver {
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
    e.solvers.push(solver);
    e.push(target, Op::Solve, 0, (e.solvers.len() - 1) as Slot, 0);
}

/// Residuals `v - start` read the cell of the start value, which a run may set.
fn with_start_cells(e: &mut Emitter, torn: &Torn) -> Torn {
    let mut torn = torn.clone();
    for r in &mut torn.residuals {
        if let Source::Start(v) = r.source
            && let Some(&cell) = e.starts.get(&v)
        {
            let start = e.auxiliary(Some(PARAMETER));
            e.layout.variables[start.idx()] = cell;
            let (own, start) = (e.read(v), e.dae.graph.var(start, Type::Real));
            r.value = e.dae.graph.sub(own, start);
        }
    }
    torn
}

/// Emits a mixed block whose loop also evaluates `relations`.
pub fn compile_mixed(e: &mut Emitter, parts: &[Block], relations: &[usize], place: BlockPlace) {
    let target = e.home(e.moving.max(HELD));
    let inside = e.push_layer();
    let mut own = Vec::new();
    parts.iter().for_each(|p| block_unknowns(p, &mut own));
    for &v in &own {
        e.levels[v.idx()] = Some(inside);
    }
    for part in parts {
        compile_block(e, part, place);
        // What follows may change what was computed from the variables of the loop.
        e.forget_top();
        let mut assigned = Vec::new();
        block_unknowns(part, &mut assigned);
        for v in assigned {
            e.levels[v.idx()] = Some(inside);
        }
    }
    for &k in relations {
        evaluate_relation(e, k, place.sequence);
    }
    let tape = e.pop_discard();
    let mut watched = Vec::new();
    for &v in &own {
        e.levels[v.idx()] = Some(target);
        if e.dae.variables[v].kind == Kind::Discrete {
            watched.push(Watched::Variable(v, e.slot(v)));
        }
    }
    let first = e.layout.relations;
    watched.extend(relations.iter().map(|&k| Watched::Relation(k as u32, first + k as Slot)));
    e.loops.push(Loop { tape, watched, place });
    e.push(target, Op::Repeat, 0, (e.loops.len() - 1) as Slot, 0);
}

/// The cell of the typical size of a variable; one where it has none.
pub fn nominal(e: &mut Emitter, v: VarId) -> Slot {
    match e.dae.variables[v].nominal {
        Some(value) if e.level_of(&[value], |_| false) == PARAMETER => e.emit(value).0,
        _ => e.literal(1.0),
    }
}

/// The cells of the least and the greatest value of a variable; infinite where it has none.
pub fn bounds(e: &mut Emitter, v: VarId) -> (Slot, Slot) {
    let variable = &e.dae.variables[v];
    let (min, max) = (variable.min, variable.max);
    let mut cell = |bound: Option<ExprId>, none: f64| match bound {
        Some(value) if e.level_of(&[value], |_| false) == PARAMETER => e.emit(value).0,
        _ => e.literal(none),
    };
    (cell(min, f64::NEG_INFINITY), cell(max, f64::INFINITY))
}
