//! Which expressions of a function are computed in one branch of an `if` alone: with jumps, only what is taken
//! need be.

use crate::base::index::FastMap;
use crate::ir::expr::{ExprId, FunctionId, Graph, ListId, Node};
use crate::symbolic::dominance::Nesting;

/// The expressions below some roots by the place where they are computed.
pub struct Plan {
    /// Always, and branches of an `if`.
    places: Nesting,
    /// By place its expressions, operands first.
    expressions: Vec<Vec<ExprId>>,
    branches: FastMap<(ExprId, bool), usize>,
}

/// All outputs of a call are computed at once.
type Called = (FunctionId, ListId);

impl Plan {
    /// What stands below `roots`.
    pub fn of(graph: &Graph, roots: &[ExprId]) -> Plan {
        let mut plan = Plan {
            places: Nesting::default(),
            expressions: Vec::new(),
            branches: FastMap::default(),
        };
        // Operands have lower numbers: users are met before them.
        let mut below = graph.postorder(roots.iter().copied());
        below.sort_unstable();
        let mut at: FastMap<ExprId, usize> = roots.iter().map(|e| (*e, 0)).collect();
        let mut calls: FastMap<Called, usize> = FastMap::default();
        let mut outputs: FastMap<Called, Vec<ExprId>> = FastMap::default();
        for &e in &below {
            if let Node::Call { function, args, .. } = graph.node(e) {
                outputs.entry((function, args)).or_default().push(e);
            }
        }
        for &e in below.iter().rev() {
            let Some(&place) = at.get(&e) else { continue };
            let mut used = |plan: &mut Plan, e: ExprId, place: usize| {
                at.entry(e).and_modify(|p| *p = plan.places.common(*p, place)).or_insert(place);
            };
            match graph.node(e) {
                Node::If(c, a, b) => {
                    used(&mut plan, c, place);
                    for (branch, holds) in [(a, true), (b, false)] {
                        let inside = plan.branch(e, holds, place);
                        used(&mut plan, branch, inside);
                    }
                }
                Node::Call { function, args, .. } => {
                    let known = calls.entry((function, args)).or_insert(place);
                    *known = plan.places.common(*known, place);
                    let place = *known;
                    graph.list(args).iter().for_each(|a| used(&mut plan, *a, place));
                }
                _ => graph.for_each_operand(e, |a| used(&mut plan, a, place)),
            }
        }
        for (call, all) in &outputs {
            for e in all {
                at.insert(*e, calls[call]);
            }
        }
        plan.expressions = vec![Vec::new(); plan.places.count()];
        for e in below {
            plan.expressions[at[&e]].push(e);
        }
        plan
    }

    /// What is always computed.
    pub fn always(&self) -> &[ExprId] {
        &self.expressions[0]
    }

    /// What is computed in a branch of an `if` alone.
    pub fn in_branch(&self, e: ExprId, holds: bool) -> &[ExprId] {
        self.branches.get(&(e, holds)).map_or(&[], |place| &self.expressions[*place])
    }

    fn branch(&mut self, e: ExprId, holds: bool, around: usize) -> usize {
        let places = &mut self.places;
        *self.branches.entry((e, holds)).or_insert_with(|| places.inside(around))
    }
}
