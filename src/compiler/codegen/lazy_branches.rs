//! Finds the expressions of a function that are needed in one branch of an `if` only, so that code
//! with jumps computes them only if the branch is taken. Selections by the same condition share their branches:
//! expressions that two outputs of a function need in the same region of a medium are computed in that region only.

use crate::base::index::FastMap;
use crate::ir::expr::{Binary, ExprId, FunctionId, Graph, ListId, Node, Type, Unary};
use crate::symbolic::dominance::Nesting;

/// The expressions below some roots, grouped by the branch in which they are computed.
pub struct Schedule {
    /// The unconditional part, and nested branches of `if` expressions.
    places: Nesting,
    /// The expressions of each branch, operands first.
    expressions: Vec<Vec<ExprId>>,
    /// The branches of each selection, taken if the condition holds and if it does not.
    branches: FastMap<ExprId, [usize; 2]>,
}

/// A condition whose operands that call functions are computed only where the operand before does not decide.
pub fn short_circuit(graph: &mut Graph, e: ExprId) -> ExprId {
    let calls = |graph: &Graph, e| graph.any([e], |_, node| matches!(node, Node::Call { .. }));
    match graph.node(e) {
        Node::Unary(Unary::Not, a) => {
            let a = short_circuit(graph, a);
            graph.intern(Node::Unary(Unary::Not, a), Type::Boolean)
        }
        Node::Binary(op @ (Binary::And | Binary::Or), a, b) if calls(graph, b) => {
            let (a, b) = (short_circuit(graph, a), short_circuit(graph, b));
            let decided = graph.boolean(op == Binary::Or);
            let chosen = if op == Binary::Or { [decided, b] } else { [b, decided] };
            graph.intern(Node::If(a, chosen[0], chosen[1]), Type::Boolean)
        }
        _ => e,
    }
}

/// All outputs of a call are computed at once.
type Called = (FunctionId, ListId);

impl Schedule {
    /// Schedules all expressions below `roots`.
    pub fn of(graph: &Graph, roots: &[ExprId]) -> Schedule {
        let mut schedule = Schedule {
            places: Nesting::default(),
            expressions: Vec::new(),
            branches: FastMap::default(),
        };
        // Operands have lower numbers, so users are visited before them.
        let mut below = graph.postorder(roots.iter().copied());
        below.sort_unstable();
        let mut at: FastMap<ExprId, usize> = roots.iter().map(|e| (*e, 0)).collect();
        let mut calls: FastMap<Called, usize> = FastMap::default();
        let mut outputs: FastMap<Called, Vec<ExprId>> = FastMap::default();
        let mut shared: FastMap<(usize, ExprId), [usize; 2]> = FastMap::default();
        for &e in &below {
            if let Node::Call { function, args, .. } = graph.node(e) {
                outputs.entry((function, args)).or_default().push(e);
            }
        }
        for &e in below.iter().rev() {
            let Some(&place) = at.get(&e) else { continue };
            let mut used = |schedule: &mut Schedule, e: ExprId, place: usize| {
                at.entry(e).and_modify(|p| *p = schedule.places.common(*p, place)).or_insert(place);
            };
            match graph.node(e) {
                Node::If(c, a, b) => {
                    used(&mut schedule, c, place);
                    let places = &mut schedule.places;
                    let branches = *shared
                        .entry((place, c))
                        .or_insert_with(|| [places.inside(place), places.inside(place)]);
                    schedule.branches.insert(e, branches);
                    used(&mut schedule, a, branches[0]);
                    used(&mut schedule, b, branches[1]);
                }
                Node::Call { function, args, .. } => {
                    let known = calls.entry((function, args)).or_insert(place);
                    *known = schedule.places.common(*known, place);
                    let place = *known;
                    graph.list(args).iter().for_each(|a| used(&mut schedule, *a, place));
                }
                _ => graph.for_each_operand(e, |a| used(&mut schedule, a, place)),
            }
        }
        for (call, all) in &outputs {
            for e in all {
                at.insert(*e, calls[call]);
            }
        }
        schedule.expressions = vec![Vec::new(); schedule.places.count()];
        for e in below {
            schedule.expressions[at[&e]].push(e);
        }
        schedule
    }

    /// The expressions that are always computed.
    pub fn always(&self) -> &[ExprId] {
        &self.expressions[0]
    }

    /// The expressions that only a branch of a selection needs, or of an earlier one by the same condition.
    pub fn in_branch(&self, e: ExprId, holds: bool) -> &[ExprId] {
        let Some(branches) = self.branches.get(&e) else { return &[] };
        let all = &self.expressions[branches[usize::from(!holds)]];
        // The operands of later selections by the same condition may not be computed yet.
        &all[..all.partition_point(|n| *n < e)]
    }
}
