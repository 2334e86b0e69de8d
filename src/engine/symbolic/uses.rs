//! Uses of expressions: how many, and under which conditions each is needed.

use super::dominance::Nesting;
use crate::base::index::FastMap;
use crate::ir::expr::{Binary, ExprId, Graph, Node};

/// An expression, and the condition under which it is computed.
pub type Root = (ExprId, Option<ExprId>);

/// Maximum number of guards; beyond it two guards are joined by their common one, because the condition
/// of a disjunction grows with each step.
const MOST: usize = 10_000;

/// Whether the operands of a node are ignored.
pub type Closed<'c> = dyn Fn(&Graph, ExprId) -> bool + 'c;

/// A condition that must hold, or must not.
#[derive(Clone, Copy)]
pub struct Guard {
    /// Guards around it.
    pub depth: usize,
    /// The condition.
    pub condition: ExprId,
    /// Whether it must hold.
    pub holds: bool,
}

/// The uses of expressions.
pub struct Uses {
    /// The number of uses of each expression, and the guard around all of them.
    pub of: FastMap<ExprId, (u32, usize)>,
    /// The nesting of guards, by number; 0 means unguarded.
    pub nesting: Nesting,
    guards: Vec<Guard>,
    numbers: FastMap<(usize, ExprId, bool), usize>,
}

impl Uses {
    /// The uses below these roots.
    pub fn of(graph: &mut Graph, roots: &[Root], closed: &Closed<'_>) -> Uses {
        let none = Guard { depth: 0, condition: ExprId(0), holds: true };
        let mut uses = Uses {
            of: FastMap::default(),
            nesting: Nesting::default(),
            guards: vec![none],
            numbers: FastMap::default(),
        };
        let mut below = below(graph, roots, closed);
        for &(root, condition) in roots {
            let guard = condition.map_or(0, |c| uses.inside(0, c, true));
            uses.used(graph, root, guard);
        }
        // Users stand behind their operands.
        below.sort_unstable_by(|a, b| b.cmp(a));
        let mut operands = Vec::new();
        for e in below {
            let Some(&(_, guard)) = uses.of.get(&e) else { continue };
            match graph.node(e) {
                _ if closed(graph, e) => {}
                Node::If(c, a, b) => {
                    uses.used(graph, c, guard);
                    let (yes, no) = (uses.inside(guard, c, true), uses.inside(guard, c, false));
                    uses.used(graph, a, yes);
                    uses.used(graph, b, no);
                }
                Node::Binary(op @ (Binary::And | Binary::Or), a, b) => {
                    uses.used(graph, a, guard);
                    let inside = uses.inside(guard, a, op == Binary::And);
                    uses.used(graph, b, inside);
                }
                _ => {
                    operands.clear();
                    graph.for_each_operand(e, |a| operands.push(a));
                    operands.iter().for_each(|a| uses.used(graph, *a, guard));
                }
            }
        }
        uses
    }

    fn used(&mut self, graph: &mut Graph, e: ExprId, guard: usize) {
        let before = self.of.get(&e).copied();
        let (count, guard) = match before {
            Some((count, other)) => (count + 1, self.either(graph, other, guard)),
            None => (1, guard),
        };
        self.of.insert(e, (count, guard));
    }

    fn inside(&mut self, around: usize, condition: ExprId, holds: bool) -> usize {
        let (nesting, guards) = (&mut self.nesting, &mut self.guards);
        *self.numbers.entry((around, condition, holds)).or_insert_with(|| {
            let number = nesting.inside(around);
            guards.push(Guard { depth: nesting.depth(number), condition, holds });
            number
        })
    }

    /// The guard of an expression that is needed under either of two guards.
    fn either(&mut self, graph: &mut Graph, a: usize, b: usize) -> usize {
        let around = self.nesting.common(a, b);
        if around == a || around == b || self.nesting.count() > MOST {
            return around;
        }
        let [a, b] = [a, b].map(|guard| self.all(graph, guard, around));
        let condition = graph.or(a, b);
        self.inside(around, condition, true)
    }

    /// The conjunction of the conditions of a guard inside another.
    pub fn all(&self, graph: &mut Graph, mut guard: usize, around: usize) -> ExprId {
        let mut all = graph.boolean(true);
        while guard != around {
            let Guard { condition, holds, .. } = self.guards[guard];
            let this = if holds { condition } else { graph.not(condition) };
            all = graph.and(this, all);
            guard = self.nesting.around(guard);
        }
        all
    }

    /// The guards of an expression, the innermost first.
    pub fn guards_of(&self, e: ExprId) -> Vec<Guard> {
        let mut all = Vec::new();
        let mut at = self.of[&e].1;
        while at != 0 {
            all.push(self.guards[at]);
            at = self.nesting.around(at);
        }
        all
    }
}

/// All expressions at or below the roots, except those below closed ones.
fn below(graph: &Graph, roots: &[Root], closed: &Closed<'_>) -> Vec<ExprId> {
    let mut found = Vec::new();
    graph.descend(roots.iter().map(|(e, _)| *e), |e, _| {
        found.push(e);
        !closed(graph, e)
    });
    found
}
