//! The walks over expressions: every operand of a node, every node below some roots, every expression of a
//! model.
//!
//! A stage that looks at all expressions calls `for_each_expression`, one that replaces them
//! `map_expressions`: a new place for an expression is added here once, and every stage sees it.

use super::blocks::{Assignment, Block, Blocks};
use super::dae::{self, Dae};
use super::expr::{ExprId, Graph, Node, VarId};
use super::flat::{
    self, Action, Assert, Delay, EquationKind, FlatModel, Function, Statement, Transport,
    WhenBranch,
};
use crate::base::index::{FastSet, Id};
use crate::base::visited::VisitedSet;

impl Graph {
    /// Calls `visit` with each direct operand, in order.
    #[inline]
    pub fn for_each_operand(&self, e: ExprId, mut visit: impl FnMut(ExprId)) {
        match self.node(e) {
            Node::Const(_)
            | Node::Time
            | Node::Var(_)
            | Node::Der(_)
            | Node::Pre(_)
            | Node::Initial
            | Node::Terminal
            | Node::Relation(_)
            | Node::Recorded(..) => {}
            Node::Unary(_, a) | Node::NoEvent(a) | Node::Smooth(_, a) => visit(a),
            Node::Binary(_, a, b) | Node::Homotopy(a, b) | Node::Sample(a, b) => {
                visit(a);
                visit(b);
            }
            Node::If(c, a, b) => {
                visit(c);
                visit(a);
                visit(b);
            }
            Node::Call { args, .. } | Node::Clocked(_, args) => {
                self.list(args).iter().copied().for_each(visit);
            }
        }
    }

    /// All nodes below `roots`, operands before users, each once. Iterative: depth costs no stack.
    pub fn postorder(&self, roots: impl IntoIterator<Item = ExprId>) -> Vec<ExprId> {
        VisitedSet::traverse(self.len(), |seen| {
            let mut order = Vec::new();
            // Calls for several outputs share their arguments, which may be many.
            let mut lists = FastSet::default();
            let mut stack: Vec<(ExprId, bool)> = Vec::new();
            for root in roots {
                stack.push((root, false));
                while let Some((e, done)) = stack.pop() {
                    if done {
                        order.push(e);
                    } else if seen.insert(e.idx()) {
                        if let Node::Call { args, .. } = self.node(e)
                            && !lists.insert(args)
                        {
                            order.push(e);
                            continue;
                        }
                        stack.push((e, true));
                        let first = stack.len();
                        self.for_each_operand(e, |a| {
                            if !seen.contains(a.idx()) {
                                stack.push((a, false));
                            }
                        });
                        stack[first..].reverse();
                    }
                }
            }
            order
        })
    }

    /// Visits all nodes below `roots`, users before operands, each once, the last root and the last operand
    /// first. `enter` says whether the operands of a node are visited, and may add nodes to visit instead.
    pub fn descend(
        &self,
        roots: impl IntoIterator<Item = ExprId>,
        mut enter: impl FnMut(ExprId, &mut Vec<ExprId>) -> bool,
    ) {
        VisitedSet::traverse(self.len(), |seen| {
            let mut lists = FastSet::default();
            let mut pending: Vec<ExprId> = roots.into_iter().collect();
            while let Some(e) = pending.pop() {
                if !seen.insert(e.idx()) || !enter(e, &mut pending) {
                    continue;
                }
                match self.node(e) {
                    Node::Call { args, .. } if !lists.insert(args) => {}
                    _ => self.for_each_operand(e, |a| pending.push(a)),
                }
            }
        });
    }

    /// Whether `found` holds for a node at or below `roots`.
    pub fn any(
        &self,
        roots: impl IntoIterator<Item = ExprId>,
        mut found: impl FnMut(ExprId, Node) -> bool,
    ) -> bool {
        let mut any = false;
        self.descend(roots, |e, pending| {
            any = any || found(e, self.node(e));
            if any {
                pending.clear();
            }
            !any
        });
        any
    }

    /// Whether `holds` is true for every node at or below `roots`.
    pub fn all(
        &self,
        roots: impl IntoIterator<Item = ExprId>,
        mut holds: impl FnMut(ExprId, Node) -> bool,
    ) -> bool {
        !self.any(roots, |e, node| !holds(e, node))
    }

    /// The variables (not `der`, not `pre`) below `e`, in order of first use.
    pub fn variables(&self, e: ExprId) -> Vec<VarId> {
        VisitedSet::traverse(self.len(), |seen| {
            let mut found = Vec::new();
            let mut lists = FastSet::default();
            let mut stack = vec![e];
            while let Some(e) = stack.pop() {
                if !seen.insert(e.idx()) {
                    continue;
                }
                match self.node(e) {
                    Node::Var(v) => found.push(v),
                    Node::Call { args, .. } if !lists.insert(args) => {}
                    _ => {
                        let first = stack.len();
                        self.for_each_operand(e, |a| stack.push(a));
                        stack[first..].reverse();
                    }
                }
            }
            found
        })
    }
}

/// A part of a model, by shared or by exclusive reference: the walk over its expressions reads or replaces them.
trait Part {
    /// A reference to an expression.
    type Place;
    /// Calls `visit` with every expression of the part.
    fn walk(self, visit: &mut dyn FnMut(Self::Place));
}

/// Implements a walk for both kinds of reference; the body is the same.
macro_rules! part {
    ($part:ty, |$this:ident, $visit:ident| $body:block) => {
        // The body is written once for `&` and `&mut`; only `into_iter` means the right thing in both.
        #[allow(clippy::into_iter_on_ref)]
        impl<'a> Part for &'a $part {
            type Place = &'a ExprId;
            fn walk(self, $visit: &mut dyn FnMut(&'a ExprId)) {
                let $this = self;
                $body
            }
        }
        #[allow(clippy::into_iter_on_ref)]
        impl<'a> Part for &'a mut $part {
            type Place = &'a mut ExprId;
            fn walk(self, $visit: &mut dyn FnMut(&'a mut ExprId)) {
                let $this = self;
                $body
            }
        }
    };
}

// ---- The flat model ----

part!(Assert, |this, visit| {
    let Assert { condition, message, level: _ } = this;
    visit(condition);
    visit(message);
});

part!(Action, |this, visit| {
    match this {
        Action::Assign(_, value) => visit(value),
        Action::Reinit { state: _, value, guard } | Action::Terminate { message: value, guard } => {
            visit(value);
            if let Some(guard) = guard {
                visit(guard);
            }
        }
        Action::Assert(assert) => assert.walk(visit),
    }
});

part!(EquationKind, |this, visit| {
    match this {
        EquationKind::Equal(a, b) => {
            visit(a);
            visit(b);
        }
        EquationKind::Algorithm { outputs: _, values } => values.into_iter().for_each(visit),
        EquationKind::Assert(assert) => assert.walk(visit),
        EquationKind::When(branches) => {
            for WhenBranch { conditions, actions } in branches {
                conditions.into_iter().for_each(&mut *visit);
                actions.into_iter().for_each(|action| action.walk(visit));
            }
        }
    }
});

part!(flat::Variable, |this, visit| {
    let flat::Variable { binding, start, min, max, nominal, .. } = this;
    for attribute in [binding, start, min, max, nominal] {
        attribute.into_iter().for_each(&mut *visit);
    }
});

part!(Transport, |this, visit| {
    let Transport { initial, longest, .. } = this;
    for (place, value) in initial {
        visit(place);
        visit(value);
    }
    longest.into_iter().for_each(visit);
});

part!(FlatModel, |this, visit| {
    let FlatModel {
        variables, equations, initial_equations, delays, transports, transitions, ..
    } = this;
    variables.into_iter().for_each(|v| v.walk(visit));
    for flat::Equation { kind, origin: _ } in equations.into_iter().chain(initial_equations) {
        kind.walk(visit);
    }
    for Delay { time, .. } in delays {
        visit(time);
    }
    transports.into_iter().for_each(|line| line.walk(visit));
    for flat::Transition { condition, .. } in transitions {
        visit(condition);
    }
});

part!(Statement, |this, visit| {
    match this {
        Statement::Assign(_, value) => visit(value),
        Statement::If(condition, a, b) => {
            visit(condition);
            a.into_iter().chain(b).for_each(|s| s.walk(visit));
        }
        Statement::While(condition, body) => {
            visit(condition);
            body.into_iter().for_each(|s| s.walk(visit));
        }
        Statement::Assert(assert, _) => assert.walk(visit),
        Statement::Break | Statement::Return => {}
    }
});

impl FlatModel {
    /// Calls `visit` with every expression of the model but those of its functions, whose variables are their
    /// own.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        self.walk(&mut |e| visit(*e));
    }

    /// Replaces every expression of the model but those of its functions.
    pub fn map_expressions(&mut self, replace: &mut dyn FnMut(&mut Graph, ExprId) -> ExprId) {
        let mut graph = std::mem::take(&mut self.graph);
        self.walk(&mut |e| *e = replace(&mut graph, *e));
        self.graph = graph;
    }
}

impl flat::Equation {
    /// Replaces every expression of the equation.
    pub fn map_expressions(&mut self, replace: &mut dyn FnMut(ExprId) -> ExprId) {
        (&mut self.kind).walk(&mut |e: &mut ExprId| *e = replace(*e));
    }

    /// Calls `visit` with every expression of the equation.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        self.kind.walk(&mut |e| visit(*e));
    }
}

impl Action {
    /// Calls `visit` with every expression of the action.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        self.walk(&mut |e| visit(*e));
    }
}

impl Function {
    /// Calls `visit` with every expression of the body.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        self.body.iter().for_each(|statement| statement.walk(&mut |e| visit(*e)));
    }
}

// ---- The differential-algebraic system ----

impl Dae {
    /// Calls `visit` with every expression but those of functions.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        self.for_each_equation_expression(visit);
        self.for_each_side_expression(visit);
        self.for_each_message(visit);
    }

    /// Calls `visit` with the expressions of equations and eliminated variables, and with the conditions of
    /// assertions.
    pub fn for_each_equation_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        self.discrete.iter().for_each(|d| visit(d.value));
        for e in self.equations.iter().chain(&self.initial) {
            [e.lhs, e.rhs, e.residual].into_iter().for_each(&mut *visit);
        }
        self.eliminated.iter().for_each(|(_, e)| visit(*e));
        self.asserts.iter().for_each(|a| visit(a.assert.condition));
    }

    /// Calls `visit` with the expressions outside of the equations: attributes, parameters, and conditions of events.
    pub fn for_each_side_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        self.parameters.iter().for_each(|(_, e)| visit(*e));
        for r in &self.relations {
            [r.lhs, r.rhs].into_iter().for_each(&mut *visit);
            if let dae::Trigger::Time { instant } = r.trigger {
                visit(instant);
            }
        }
        self.samples.iter().flat_map(|s| [s.start, s.interval]).for_each(&mut *visit);
        self.reinits.iter().flat_map(|r| [r.active, r.value]).for_each(&mut *visit);
        self.asserts.iter().filter_map(|a| a.active).for_each(&mut *visit);
        self.terminates.iter().for_each(|t| visit(t.active));
        self.delays.iter().for_each(|delay| visit(delay.time));
        self.transports.iter().for_each(|line| line.walk(&mut |e| visit(*e)));
        for v in self.variables.iter() {
            [v.start, v.min, v.max, v.nominal].into_iter().flatten().for_each(&mut *visit);
        }
    }

    /// Calls `visit` with the messages of assertions and terminations.
    pub fn for_each_message(&self, visit: &mut dyn FnMut(ExprId)) {
        self.asserts.iter().for_each(|a| visit(a.assert.message));
        self.terminates.iter().for_each(|t| visit(t.message));
    }
}

// ---- The sorted system ----

impl Blocks {
    /// Calls `visit` with every expression of the system and its blocks but those of functions.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        self.dae.for_each_expression(visit);
        let starts = self.initial.iter().chain(&self.initial_by_states);
        for block in starts.chain(&self.event).chain(&self.continuous) {
            block.for_each_expression(visit);
        }
        self.state_sets.iter().flat_map(|s| &s.jacobian).for_each(|(_, _, e)| visit(*e));
    }
}

impl Block {
    /// Calls `visit` with every expression of the block.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(ExprId)) {
        match self {
            Block::Assign(a) => visit(a.value),
            Block::Torn(t) => {
                t.explicit.iter().for_each(|a| visit(a.value));
                t.residuals.iter().for_each(|r| visit(r.value));
            }
            Block::Mixed(parts) => parts.iter().for_each(|part| part.for_each_expression(visit)),
        }
    }

    /// Every expression of the block.
    pub fn expressions(&self) -> Vec<ExprId> {
        let mut all = Vec::new();
        self.for_each_expression(&mut |e| all.push(e));
        all
    }

    /// Every variable that the block determines.
    pub fn unknowns(&self) -> Vec<VarId> {
        let mut all = Vec::new();
        self.for_each_unknown(&mut |v| all.push(v));
        all
    }

    /// Calls `visit` with every variable that the block determines.
    pub fn for_each_unknown(&self, visit: &mut dyn FnMut(VarId)) {
        match self {
            Block::Assign(a) => visit(a.variable),
            Block::Torn(t) => {
                t.unknowns.iter().copied().for_each(&mut *visit);
                t.explicit.iter().for_each(|a| visit(a.variable));
            }
            Block::Mixed(parts) => parts.iter().for_each(|part| part.for_each_unknown(visit)),
        }
    }

    /// Calls `visit` with every assignment, those inside torn and mixed blocks too.
    pub fn for_each_assignment(&self, visit: &mut dyn FnMut(&Assignment)) {
        match self {
            Block::Assign(a) => visit(a),
            Block::Torn(t) => t.explicit.iter().for_each(visit),
            Block::Mixed(parts) => parts.iter().for_each(|part| part.for_each_assignment(visit)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::expr::{Binary, Type};

    #[test]
    fn walks_visit_each_node_once_and_stop_where_told() {
        let mut g = Graph::new();
        let [x, y] = [0, 1].map(|k| g.var(VarId(k), Type::Real));
        let sum = g.binary(Binary::Add, x, y);
        let root = g.binary(Binary::Mul, sum, sum);
        assert_eq!(g.postorder([root]), [x, y, sum, root]);
        let mut visited = Vec::new();
        g.descend([root], |e, _| {
            visited.push(e);
            true
        });
        assert_eq!(visited, [root, sum, y, x]);
        visited.clear();
        g.descend([root], |e, _| {
            visited.push(e);
            e != sum
        });
        assert_eq!(visited, [root, sum]);
        assert!(g.any([root], |_, node| node == Node::Var(VarId(1))));
        assert!(!g.any([root], |_, node| node == Node::Time));
        assert_eq!(g.variables(root), [VarId(0), VarId(1)]);
    }
}
