//! Functions without events (section 12.4 of the specification): relations and roundings inside a
//! function generate no events; those in its arguments do, as anywhere.
//!
//! An inlined function is one expression with its arguments, so it is closed by `noEvent` as a whole
//! only where no argument makes events. Otherwise each operator that the function adds is closed by
//! itself, unless its operands change at events only.

use super::Evaluator;
use super::value::Value;
use crate::base::index::{FastMap, FastSet};
use crate::ir::ast::Variability;
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, Unary};
use crate::symbolic::rewrite::Rewriter;

/// Relations of arguments below one relation of the function that are distinguished by cases.
const MAX_CASES: usize = 4;

/// `noEvent` within `noEvent` that is followed.
const MOST_NESTED: usize = 20;

/// How an expression behaves at events and between them.
#[derive(Clone, Copy, Default)]
pub struct EventBehaviour {
    /// It reads variables that change between events.
    reads: bool,
    /// It changes between events itself: a relation does not, for its changes are events.
    moves: bool,
    /// It makes events.
    live: bool,
}

/// How expressions behave at events and between them.
#[derive(Default)]
pub struct Events {
    /// Of each expression, by its number.
    of_nodes: Vec<EventBehaviour>,
    /// Results of functions of discrete type that change between events, since their arguments do.
    pub(super) moving_results: FastSet<ExprId>,
}

impl Evaluator<'_> {
    /// Determines the behaviour of each expression so far; operands precede their users.
    pub(super) fn note_behaviours(&mut self) {
        for k in self.events.of_nodes.len()..self.graph.len() {
            let behaviour = self.behaviour_of_node(ExprId(k as u32));
            self.events.of_nodes.push(behaviour);
        }
    }

    fn behaviour_of_node(&self, e: ExprId) -> EventBehaviour {
        let mut all = EventBehaviour::default();
        self.graph.for_each_operand(e, |a| {
            let of = self.events.of_nodes[a.0 as usize];
            all.reads |= of.reads;
            all.moves |= of.moves;
            all.live |= of.live;
        });
        match self.graph.node(e) {
            Node::Var(v) => {
                let moves = self.variable_variability(v) == Variability::Continuous;
                EventBehaviour { reads: moves, moves, live: false }
            }
            Node::Time | Node::Der(_) | Node::Recorded(..) => {
                EventBehaviour { reads: true, moves: true, live: false }
            }
            Node::Sample(..) | Node::Clocked(..) => EventBehaviour::default(),
            Node::NoEvent(_) | Node::Smooth(..) => {
                EventBehaviour { moves: all.reads, live: false, ..all }
            }
            Node::Binary(Binary::Mod | Binary::Rem, ..) => {
                EventBehaviour { live: all.live || all.moves, ..all }
            }
            _ if makes_events(&self.graph, e) => {
                EventBehaviour { moves: false, live: all.live || all.moves, ..all }
            }
            _ => all,
        }
    }

    fn behaviour(&self, e: ExprId) -> EventBehaviour {
        self.events.of_nodes[e.0 as usize]
    }

    /// Whether an expression, noted before, changes between events, be it by steps that `noEvent` hides.
    pub(super) fn moves(&self, e: ExprId) -> bool {
        self.behaviour(e).moves
    }

    /// The operators in arguments that make events.
    pub(crate) fn events_of_arguments(&mut self, arguments: &[Option<Value>]) -> FastSet<ExprId> {
        self.note_behaviours();
        let mut roots = Vec::new();
        for value in arguments.iter().flatten() {
            value.for_each_scalar(&mut |e| roots.push(e));
        }
        self.events_below(roots, |_| true)
    }

    /// The operators at or below `roots` that make events, of those that are `wanted`.
    fn events_below(
        &self,
        mut roots: Vec<ExprId>,
        wanted: impl Fn(ExprId) -> bool,
    ) -> FastSet<ExprId> {
        let mut seen = FastSet::default();
        let mut found = FastSet::default();
        while let Some(e) = roots.pop() {
            if !self.behaviour(e).live || !seen.insert(e) {
                continue;
            }
            if makes_events(&self.graph, e) && wanted(e) {
                found.insert(e);
            }
            self.graph.for_each_operand(e, |a| roots.push(a));
        }
        found
    }

    /// The result of a function, without events except those of its arguments.
    pub(crate) fn without_events(&mut self, result: &Value, given: &FastSet<ExprId>) -> Value {
        self.note_behaviours();
        let mut roots = Vec::new();
        result.for_each_scalar(&mut |e| roots.push(e));
        let mut closed: FastMap<ExprId, ExprId> = FastMap::default();
        let mut operands = Vec::new();
        for e in self.graph.postorder(roots) {
            if given.contains(&e) || !self.behaviour(e).live {
                closed.insert(e, e);
                continue;
            }
            operands.clear();
            self.graph.for_each_operand(e, |a| operands.push(closed[&a]));
            let rebuilt = self.graph.rebuild(e, &operands);
            self.note_behaviours();
            let new = match makes_events(&self.graph, rebuilt) && self.has_moving_operand(rebuilt) {
                true if !given.contains(&rebuilt) => self.close(rebuilt, given),
                _ => rebuilt,
            };
            closed.insert(e, new);
        }
        result.each_scalar(&mut |e| closed[&e])
    }

    /// Whether an operand changes between events.
    fn has_moving_operand(&self, e: ExprId) -> bool {
        let mut moves = false;
        self.graph.for_each_operand(e, |a| moves |= self.behaviour(a).moves);
        moves
    }

    /// `noEvent(e)`, where relations of arguments in `e` keep their events: a case for each.
    fn close(&mut self, e: ExprId, given: &FastSet<ExprId>) -> ExprId {
        let cases =
            self.events_below(vec![e], |n| given.contains(&n) && self.graph.ty(n) == Type::Boolean);
        let mut cases: Vec<ExprId> = cases.into_iter().collect();
        cases.sort_unstable();
        if cases.len() > MAX_CASES {
            return self.graph.no_event(e);
        }
        self.by_cases(e, &cases)
    }

    /// The last case is the outermost: operands precede their users.
    fn by_cases(&mut self, e: ExprId, cases: &[ExprId]) -> ExprId {
        let Some((case, rest)) = cases.split_last() else { return self.graph.no_event(e) };
        let [yes, no] = [true, false].map(|holds| {
            let value = self.graph.boolean(holds);
            let settled = Rewriter::new()
                .apply(&mut self.graph, e, &mut |_, n| (n == *case).then_some(value));
            self.by_cases(settled, rest)
        });
        self.graph.if_then_else(*case, yes, no)
    }

    /// A field of a record that a function computes, or one of several outputs. An Integer, such as the phase of a
    /// medium, would change between events without those of the comparisons that it is made of: it gets them back. If
    /// they are hidden in a loop, an event is where its value changes.
    pub(crate) fn with_own_events(&mut self, field: &Value) -> Value {
        field.each_scalar(&mut |e| {
            if self.graph.ty(e) != Type::Integer || !self.changes_between_events(e) {
                return e;
            }
            let with_events = self.without_no_event(e);
            if !self.changes_between_events(with_events) {
                return with_events;
            }
            let (number, half) = (self.graph.as_real(e), self.graph.real(0.5));
            let above = self.graph.add(number, half);
            self.graph.unary(Unary::ToInteger, above)
        })
    }

    fn without_no_event(&mut self, mut e: ExprId) -> ExprId {
        for _ in 0..MOST_NESTED {
            let mut found = false;
            e = Rewriter::new().apply(&mut self.graph, e, &mut |graph, n| match graph.node(n) {
                Node::NoEvent(inner) => {
                    found = true;
                    Some(inner)
                }
                _ => None,
            });
            if !found {
                break;
            }
        }
        e
    }

    /// Notes the scalars of discrete type in a result that change between events, because the
    /// arguments of the function do.
    pub(crate) fn note_moving_results(&mut self, result: &Value) {
        self.note_behaviours();
        let mut moving = Vec::new();
        result.for_each_scalar(&mut |e| {
            let discrete = !matches!(self.graph.ty(e), Type::Real | Type::String);
            if discrete && self.behaviour(e).moves {
                moving.push(e);
            }
        });
        self.events.moving_results.extend(moving);
    }
}

/// The operators whose value jumps where their operands do not.
fn makes_events(graph: &Graph, e: ExprId) -> bool {
    match graph.node(e) {
        Node::Binary(op, ..) => op.is_relation() || op.shape().makes_events(),
        Node::Unary(op, _) => op.shape().makes_events(),
        _ => false,
    }
}
