//! Relations: held ones evaluated afresh, searched ones watched.

use crate::ir::dae::Trigger;
use crate::ir::expr::{Binary, ExprId, Node};
use crate::ir::program::{Sequence, Slot, Watch};
use crate::symbolic::gradient::{Leaf, gradient};

use super::emit::Emitter;

/// Emits the truth and the distance from switching of searched relations, and instants of others.
pub fn watch_relations(e: &mut Emitter) {
    for k in 0..e.dae.relations.len() {
        let relation = e.dae.relations[k].clone();
        e.span = relation.origin.span;
        let watch = match relation.trigger {
            Trigger::Discrete => Watch::Discrete,
            Trigger::Time { instant } => Watch::Time(e.emit(instant).0),
            Trigger::State => {
                let truth = e.dae.graph.binary(relation.op, relation.lhs, relation.rhs);
                e.emit_to(e.layout.fresh + k as Slot, truth);
                let gap = e.dae.graph.sub(relation.lhs, relation.rhs);
                e.emit_to(e.layout.gaps + k as Slot, gap);
                Watch::State
            }
        };
        e.watches.push(watch);
    }
}

/// Emits the truth of relation `k` to its cell.
pub fn evaluate_relation(e: &mut Emitter, k: usize, sequence: Sequence) {
    let relation = e.dae.relations[k].clone();
    e.span = relation.origin.span;
    let literal = e.dae.graph.binary(relation.op, relation.lhs, relation.rhs);
    let truth = match relation.trigger {
        Trigger::Time { instant } if sequence == Sequence::Event => {
            right_limit(e, literal, relation.op, relation.lhs, relation.rhs, instant)
        }
        _ => literal,
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

/// A comparison with time as it holds just after this instant, whatever the rounding: `time > t1`
/// is true at the event at `t1` already, otherwise it would never switch.
fn right_limit(
    e: &mut Emitter,
    literal: ExprId,
    op: Binary,
    lhs: ExprId,
    rhs: ExprId,
    instant: ExprId,
) -> ExprId {
    let g = &mut e.dae.graph;
    let gap = g.sub(lhs, rhs);
    let slope = gradient(g, gap, |leaf| leaf == Leaf::Time);
    let Some(&(_, slope)) = slope.first() else { return literal };
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
