//! Algebraic loops that are left to the integrator.
//!
//! In a program of [`SystemForm::Dae`](crate::ir::program::SystemForm) the tearing variables of the
//! loops that derivatives depend on become components of the integrated system, and the residuals
//! of the loops become its algebraic rows: `M y' = f(t, y)` with a singular `M`. Such a loop is not
//! iterated to rounding error at every stage, but once per step together with the states, and its
//! matrix is part of the sparse matrix of the step. The index remains one: the Jacobian of the
//! residuals with respect to the tearing variables is the matrix of the loop itself.
//!
//! *K. E. Brenan, S. L. Campbell, L. R. Petzold, Numerical Solution of Initial-Value Problems in
//! Differential-Algebraic Equations, 1996, sec. 2.4 and 5.1; W. Braun, F. Casella, B. Bachmann,
//! "Solving large-scale Modelica models: new approaches and experimental results using
//! OpenModelica", 12th International Modelica Conference 2017.*

use crate::base::index::{FastSet, Id};
use crate::ir::blocks::{Block, Torn};
use crate::ir::expr::{ExprId, VarId};
use crate::ir::program::{AlgebraicUnknown, source_span};

use super::SortedBlocks;
use super::block::compile_assignment;
use super::emit::{CONTINUOUS, DISCRETE, Emitter};
use super::sequence::{Dependencies, reset_levels};

/// The unknowns and equations of the continuously varying loops that derivatives depend on, in
/// order of the blocks.
pub fn find(e: &mut Emitter, blocks: &SortedBlocks) -> Vec<AlgebraicUnknown> {
    reset_levels(e, true);
    e.continuous_level = CONTINUOUS;
    for state in &blocks.states {
        e.levels[state.variable.idx()] = Some(CONTINUOUS);
    }
    let derivatives: Vec<ExprId> = blocks.states.iter().map(|s| e.read(s.derivative)).collect();
    let needed = Dependencies::new(e, &blocks.continuous).blocks_for(e, &derivatives);
    let mut found = Vec::new();
    for (block, needed) in blocks.continuous.iter().zip(needed) {
        let (own, values) = (block.unknowns(), block.expressions());
        let own_set: FastSet<VarId> = own.iter().copied().collect();
        let level = e.level_of(&values, |v| own_set.contains(&v)).max(DISCRETE);
        for v in own {
            e.levels[v.idx()] = Some(level);
        }
        if let (Block::Torn(torn), true) = (block, needed && level > DISCRETE) {
            let pairs = torn.unknowns.iter().zip(&torn.residuals);
            found.extend(pairs.map(|(v, r)| AlgebraicUnknown {
                variable: *v,
                residual: r.value,
                source: r.source,
            }));
        }
    }
    // The sequences are compiled from scratch afterwards.
    e.levels.fill(None);
    e.continuous_level = DISCRETE;
    found
}

/// Position of the first unknown of a loop in `algebraics`, if the integrator solves the loop.
pub fn position(algebraics: &[AlgebraicUnknown], torn: &Torn) -> Option<usize> {
    let first = torn.unknowns.first()?;
    algebraics.iter().position(|a| a.variable == *first)
}

/// Emits the explicit part of a loop and its residuals, each to the layer determined by its
/// operands. The first residual belongs to component `row`.
pub fn compile(e: &mut Emitter, torn: &Torn, row: usize) {
    for a in &torn.explicit {
        compile_assignment(e, a);
    }
    for (k, r) in torn.residuals.iter().enumerate() {
        e.span = source_span(&e.dae, r.source);
        let slot = e.layout.derivatives[row + k];
        e.emit_to(slot, r.value);
    }
}
