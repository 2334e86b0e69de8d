//! Compiles the values with which relations begin at the start.
//!
//! A relation that is read before its operands are known begins with its value at their start values: with the phase of a
//! medium guessed wrong, its equations of state may have no solution.

use crate::base::index::FastSet;
use crate::ir::program::{RelationStart, Sequence};

use super::emit::{DISCRETE, Emitter};
use super::relation::{evaluate_relation, relations_in};

/// A tape for each of these relations, and before it for those that its operands read. Each is a tape of its own: where one
/// cannot be evaluated, as at a pressure of zero, the others still can.
pub fn compile(e: &mut Emitter, relations: &[u32]) -> Vec<RelationStart> {
    for level in e.levels.iter_mut().filter(|level| level.is_none()) {
        // Variables have their start values.
        *level = Some(DISCRETE);
    }
    e.continuous_level = DISCRETE;
    with_operands(e, relations)
        .into_iter()
        .map(|relation| {
            e.push_layer();
            e.floor = DISCRETE;
            evaluate_relation(e, relation as usize, Sequence::Initial);
            RelationStart { relation, tape: e.pop_discard() }
        })
        .collect()
}

/// The relations, each after those that its operands read.
fn with_operands(e: &Emitter, relations: &[u32]) -> Vec<u32> {
    let (mut order, mut entered) = (Vec::new(), FastSet::default());
    let mut pending: Vec<(u32, bool)> = relations.iter().rev().map(|k| (*k, false)).collect();
    while let Some((k, is_ready)) = pending.pop() {
        if is_ready {
            order.push(k);
        } else if entered.insert(k) {
            let relation = &e.dae.relations[k as usize];
            let inner = relations_in(e, &[relation.lhs, relation.rhs]);
            pending.push((k, true));
            pending.extend(inner.into_iter().map(|k| (k, false)));
        }
    }
    order
}
