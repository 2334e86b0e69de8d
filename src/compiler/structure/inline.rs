//! The last decision about calls: an equation that must be differentiated gets the bodies of the functions
//! that it calls. Loops and functions that call themselves stay, since they have no formula, and so do large
//! functions, of which a call computes only the branches that are taken.

use crate::base::index::{FastMap, Id};
use crate::base::source::Span;
use crate::ir::dae::{Dae, EqId, GuardedAssert};
use crate::ir::expr::{ExprId, FunctionId, Graph, ListId, Node};
use crate::ir::flat::{Assert, Function, Origin, StraightLine};

/// Nodes up to which a body is inlined.
const LARGEST: usize = 2_000;

/// Inlines the functions that an equation calls; true if there was one.
pub fn calls_of(dae: &mut Dae, equation: EqId) -> bool {
    let mut any = false;
    // A body may call other functions.
    while let Some(bodies) = bodies(dae, equation) {
        any = true;
        let mut inlining = Inlining { bodies, ..Inlining::default() };
        let e = dae.equations[equation].clone();
        let [lhs, rhs, residual] =
            [e.lhs, e.rhs, e.residual].map(|side| inlining.inlined(&mut dae.graph, side));
        let target = &mut dae.equations[equation];
        (target.lhs, target.rhs, target.residual) = (lhs, rhs, residual);
        for (assert, span) in inlining.asserts {
            let origin = Origin { span, component: e.origin.component.clone() };
            dae.asserts.push(GuardedAssert { active: None, assert, origin });
        }
    }
    any
}

/// The bodies of the functions that an equation calls; `None` if it calls none that has a formula.
fn bodies(dae: &Dae, equation: EqId) -> Option<FastMap<FunctionId, StraightLine>> {
    let mut found = FastMap::default();
    for n in dae.graph.postorder([dae.equations[equation].residual]) {
        if let Node::Call { function, .. } = dae.graph.node(n)
            && !found.contains_key(&function)
            && let Some(body) = dae.functions.get(function).and_then(Function::straight_line)
            && dae.graph.postorder(body.outputs.iter().copied()).len() <= LARGEST
            && body.outputs.iter().all(|e| has_formula(&dae.graph, *e))
            && !calls_itself(dae, function)
        {
            found.insert(function, body);
        }
    }
    (!found.is_empty()).then_some(found)
}

fn has_formula(graph: &Graph, e: ExprId) -> bool {
    graph.all([e], |_, node| !matches!(node, Node::Homotopy(..)))
}

fn calls_itself(dae: &Dae, function: FunctionId) -> bool {
    let mut pending = vec![function];
    let mut met = vec![false; dae.functions.len()];
    while let Some(f) = pending.pop() {
        for n in dae.graph.postorder(dae.functions[f].values()) {
            if let Node::Call { function: called, .. } = dae.graph.node(n) {
                if called == function {
                    return true;
                }
                if !std::mem::replace(&mut met[called.idx()], true) {
                    pending.push(called);
                }
            }
        }
    }
    false
}

#[derive(Default)]
struct Inlining {
    bodies: FastMap<FunctionId, StraightLine>,
    done: FastMap<ExprId, ExprId>,
    results: FastMap<(FunctionId, ListId), Vec<ExprId>>,
    asserts: Vec<(Assert, Span)>,
}

impl Inlining {
    fn inlined(&mut self, graph: &mut Graph, root: ExprId) -> ExprId {
        for e in graph.postorder([root]) {
            let mut operands = Vec::new();
            graph.for_each_operand(e, |a| operands.push(self.done[&a]));
            let rebuilt = if operands.is_empty() { e } else { graph.rebuild(e, &operands) };
            let new = match graph.node(rebuilt) {
                Node::Call { function, output, args } => {
                    self.result(graph, function, args, output).unwrap_or(rebuilt)
                }
                _ => rebuilt,
            };
            self.done.insert(e, new);
        }
        self.done[&root]
    }

    fn result(
        &mut self,
        graph: &mut Graph,
        function: FunctionId,
        args: ListId,
        output: u32,
    ) -> Option<ExprId> {
        let body = self.bodies.get(&function)?;
        if let Some(known) = self.results.get(&(function, args)) {
            return known.get(output as usize).copied();
        }
        let arguments = graph.list(args).to_vec();
        let outputs = without_markers(graph, &body.outputs, &arguments);
        for (assert, span) in &body.asserts {
            let [condition, message] =
                without_markers(graph, &[assert.condition, assert.message], &arguments)[..]
            else {
                continue;
            };
            let inactive = graph.not(arguments[0]);
            let condition = graph.or(inactive, condition);
            self.asserts.push((Assert { condition, message, level: assert.level }, *span));
        }
        let result = outputs.get(output as usize).copied();
        self.results.insert((function, args), outputs);
        result
    }
}

/// Expressions of a function for these arguments. Relations in a function have no events, so nothing is left
/// of `noEvent` and `smooth`.
fn without_markers(graph: &mut Graph, roots: &[ExprId], arguments: &[ExprId]) -> Vec<ExprId> {
    let mut done: FastMap<ExprId, ExprId> = FastMap::default();
    for e in graph.postorder(roots.iter().copied()) {
        let new = match graph.node(e) {
            Node::Var(v) => arguments.get(v.idx()).copied().unwrap_or(e),
            Node::NoEvent(a) | Node::Smooth(_, a) => done[&a],
            _ => {
                let mut operands = Vec::new();
                graph.for_each_operand(e, |a| operands.push(done[&a]));
                if operands.is_empty() { e } else { graph.rebuild(e, &operands) }
            }
        };
        done.insert(e, new);
    }
    roots.iter().map(|e| done[e]).collect()
}
