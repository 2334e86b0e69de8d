//! Compiles relations: their evaluation at events, and their zero-crossing indicators between
//! events.

use crate::ir::dae::Trigger;
use crate::ir::expr::{Binary, ExprId, Node};
use crate::ir::program::{RelationTrigger, Sequence, Slot};
use crate::symbolic::gradient::{Leaf, gradient};

use super::emit::Emitter;

/// Emits candidate values and zero-crossing indicators of state-dependent relations, and the
/// instants of time-dependent ones.
pub fn emit_indicators(e: &mut Emitter) {
    for k in 0..e.dae.relations.len() {
        let relation = e.dae.relations[k].clone();
        e.span = relation.origin.span;
        let trigger = match relation.trigger {
            Trigger::Discrete => RelationTrigger::Discrete,
            Trigger::Time { instant } => RelationTrigger::Time(e.emit(instant).0),
            Trigger::State => {
                let truth = e.dae.graph.binary(relation.op, relation.lhs, relation.rhs);
                e.emit_to(e.layout.candidates + k as Slot, truth);
                let indicator = e.dae.graph.sub(relation.lhs, relation.rhs);
                e.emit_to(e.layout.indicators + k as Slot, indicator);
                RelationTrigger::State
            }
        };
        e.events.relation_triggers.push(trigger);
    }
}

/// Emits the value of relation `k` to its slot.
pub fn evaluate_relation(e: &mut Emitter, k: usize, sequence: Sequence) {
    let relation = e.dae.relations[k].clone();
    e.span = relation.origin.span;
    let comparison = e.dae.graph.binary(relation.op, relation.lhs, relation.rhs);
    let truth = match relation.trigger {
        Trigger::Time { instant } if sequence == Sequence::Event => {
            right_limit(e, comparison, relation.op, relation.lhs, relation.rhs, instant)
        }
        _ => comparison,
    };
    e.emit_to(e.layout.relations + k as Slot, truth);
}

/// The relations that `roots` read, ascending.
pub fn relations_in(e: &Emitter, roots: &[ExprId]) -> Vec<u32> {
    let nodes = e.dae.graph.postorder(roots.iter().copied());
    let mut found: Vec<u32> = nodes
        .into_iter()
        .filter_map(|n| match e.dae.graph.node(n) {
            Node::Relation(k) => Some(k),
            _ => None,
        })
        .collect();
    found.sort_unstable();
    found
}

/// The right limit of a comparison with time at `instant`, independent of rounding: `time > t1` is
/// already true at the event at `t1`, otherwise it would never switch.
fn right_limit(
    e: &mut Emitter,
    comparison: ExprId,
    op: Binary,
    lhs: ExprId,
    rhs: ExprId,
    instant: ExprId,
) -> ExprId {
    let g = &mut e.dae.graph;
    let indicator = g.sub(lhs, rhs);
    let slope = gradient(g, indicator, |leaf| leaf == Leaf::Time);
    let Some(&(_, slope)) = slope.first() else { return comparison };
    let (zero, time) = (g.real(0.0), g.time());
    let passed = g.binary(Binary::GreaterEqual, time, instant);
    let not_passed = g.not(passed);
    let rising = g.binary(Binary::Greater, slope, zero);
    let (after_rise, after_fall) = if matches!(op, Binary::Greater | Binary::GreaterEqual) {
        (passed, not_passed)
    } else {
        (not_passed, passed)
    };
    g.if_then_else(rising, after_rise, after_fall)
}
