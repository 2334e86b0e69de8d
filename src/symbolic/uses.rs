//! Where expressions stand: how often, and under which conditions alone they are computed.

use super::dominance::Nesting;
use crate::base::index::{FastMap, FastSet};
use crate::ir::expr::{Binary, ExprId, Graph, Node};

/// An expression, and the condition under which it is computed.
pub type Root = (ExprId, Option<ExprId>);

/// Guards beyond which none is made that stands for either of two: their conditions grow with each.
const MOST: usize = 10_000;

/// Whether what stands below a node is not looked at.
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

/// Where expressions stand.
pub struct Uses {
    /// How often each stands somewhere, and the guard under which it does.
    pub of: FastMap<ExprId, (u32, usize)>,
    /// How guards stand in each other, by number; 0 is none.
    pub nesting: Nesting,
    guards: Vec<Guard>,
    numbers: FastMap<(usize, ExprId, bool), usize>,
}

impl Uses {
    /// What stands below these roots.
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

    /// The guard of what is computed under one guard or under another.
    fn either(&mut self, graph: &mut Graph, a: usize, b: usize) -> usize {
        let around = self.nesting.common(a, b);
        if around == a || around == b || self.nesting.count() > MOST {
            return around;
        }
        let [a, b] = [a, b].map(|guard| self.all(graph, guard, around));
        let condition = graph.or(a, b);
        self.inside(around, condition, true)
    }

    /// All conditions of a guard inside of another one, as one.
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

/// All expressions below some, as far as they are looked at.
fn below(graph: &Graph, roots: &[Root], closed: &Closed<'_>) -> Vec<ExprId> {
    let mut seen: FastSet<ExprId> = FastSet::default();
    let mut found = Vec::new();
    let mut stack: Vec<ExprId> = roots.iter().map(|(e, _)| *e).collect();
    while let Some(e) = stack.pop() {
        if seen.insert(e) {
            found.push(e);
            if !closed(graph, e) {
                graph.for_each_operand(e, |a| stack.push(a));
            }
        }
    }
    found
}
