//! Algebraic loops that are left to the integrator.
//!
//! In a program of [`Form::Implicit`](crate::ir::program::Form) the tearing variables of the loops
//! that derivatives depend on become components of the integrated system, and the residuals of the
//! loops its algebraic rows: `M y' = f(t, y)` with a singular `M`. A loop is then no longer iterated
//! to rounding errors at every stage, but once for the whole step, together with the states; and its
//! matrix is a part of the sparse matrix of the step. The index stays one: the Jacobian of the
//! residuals by the tearing variables is the matrix that the loop itself would have been solved with.
//!
//! *K. E. Brenan, S. L. Campbell, L. R. Petzold, Numerical Solution of Initial-Value Problems in
//! Differential-Algebraic Equations, 1996, sec. 2.4 and 5.1; W. Braun, F. Casella, B. Bachmann, "Solving
//! large-scale Modelica models: new approaches and experimental results using OpenModelica", 12th
//! International Modelica Conference 2017.*

use crate::base::index::{FastSet, Id};
use crate::ir::blocks::{Block, Torn};
use crate::ir::expr::{ExprId, VarId};
use crate::ir::program::{Algebraic, source_span};

use super::Order;
use super::block::compile_assignment;
use super::emit::{Emitter, HELD, MOVING};
use super::layout::{block_unknowns, block_values};
use super::sequence::{Needs, begin};

/// The unknowns of the loops between events that derivatives depend on and that do not rest between
/// events, with their equations, in order of the blocks.
pub fn find(e: &mut Emitter, blocks: &Order) -> Vec<Algebraic> {
    begin(e, true);
    e.moving = MOVING;
    for state in &blocks.states {
        e.levels[state.variable.idx()] = Some(MOVING);
    }
    let derivatives: Vec<ExprId> = blocks.states.iter().map(|s| e.read(s.derivative)).collect();
    let needed = Needs::new(e, &blocks.continuous).below(e, &derivatives);
    let mut found = Vec::new();
    for (block, needed) in blocks.continuous.iter().zip(needed) {
        let (mut own, mut values) = (Vec::new(), Vec::new());
        block_unknowns(block, &mut own);
        block_values(block, &mut values);
        let own_set: FastSet<VarId> = own.iter().copied().collect();
        let level = e.level_of(&values, |v| own_set.contains(&v)).max(HELD);
        for v in own {
            e.levels[v.idx()] = Some(level);
        }
        if let (Block::Torn(torn), true) = (block, needed && level > HELD) {
            let pairs = torn.unknowns.iter().zip(&torn.residuals);
            found.extend(pairs.map(|(v, r)| Algebraic {
                variable: *v,
                residual: r.value,
                source: r.source,
            }));
        }
    }
    // The sequences are compiled from the beginning afterwards.
    e.levels.fill(None);
    e.moving = HELD;
    found
}

/// The position of the first unknown of a loop among `algebraics`, if the integrator solves it.
pub fn position(algebraics: &[Algebraic], torn: &Torn) -> Option<usize> {
    let first = torn.unknowns.first()?;
    algebraics.iter().position(|a| a.variable == *first)
}

/// Emits the explicit part of a loop and its residuals, the first of which belongs to component
/// `row`, to the layers that their operands ask for.
pub fn compile(e: &mut Emitter, torn: &Torn, row: usize) {
    for a in &torn.explicit {
        compile_assignment(e, a);
    }
    for (k, r) in torn.residuals.iter().enumerate() {
        e.span = source_span(&e.dae, r.source);
        let cell = e.layout.derivatives[row + k];
        e.emit_to(cell, r.value);
    }
}
