//! Questions about expressions of a model with clocks.

use crate::base::index::FastSet;
use crate::ir::clock::ClockOperator;
use crate::ir::expr::{Const, ExprId, Graph, Node, VarId};
use crate::ir::flat::{FlatModel, Variability};
use crate::symbolic::rewrite::Rewriter;

/// Whether a variable is an unknown: neither constant nor parameter.
pub fn is_unknown(flat: &FlatModel, v: VarId) -> bool {
    flat.variables[v].variability > Variability::Parameter
}

/// Whether an expression never changes.
pub fn is_fixed(flat: &FlatModel, e: ExprId) -> bool {
    flat.graph.all([e], |_, node| match node {
        Node::Var(v) => !is_unknown(flat, v),
        Node::Time | Node::Der(_) | Node::Pre(_) | Node::Initial | Node::Terminal => false,
        Node::Sample(..) | Node::Clocked(..) | Node::Recorded(..) => false,
        _ => true,
    })
}

/// The value of a parameter expression at the values in the model, if these are known.
pub fn known(flat: &mut FlatModel, e: ExprId) -> Option<Const> {
    let mut value = e;
    for _ in 0..32 {
        if let Some(c) = flat.graph.as_const(value) {
            return Some(c);
        }
        let variables = &flat.variables;
        let next = Rewriter::new().apply(&mut flat.graph, value, &mut |g, n| match g.node(n) {
            Node::Var(v) if variables[v].variability <= Variability::Parameter => {
                variables[v].binding
            }
            _ => None,
        });
        if next == value {
            return None;
        }
        value = next;
    }
    None
}

/// The operator and its operands, if the expression is one of clocks.
pub fn clocked(graph: &Graph, e: ExprId) -> Option<(ClockOperator, Vec<ExprId>)> {
    match graph.node(e) {
        Node::Clocked(op, args) => Some((op, graph.list(args).to_vec())),
        _ => None,
    }
}

/// The variable that an expression is.
pub fn variable(graph: &Graph, e: ExprId) -> Option<VarId> {
    match graph.node(e) {
        Node::Var(v) => Some(v),
        _ => None,
    }
}

/// The variables below `roots` whose current value is read.
pub fn read(graph: &Graph, roots: impl IntoIterator<Item = ExprId>) -> FastSet<VarId> {
    graph.postorder(roots).into_iter().filter_map(|e| variable(graph, e)).collect()
}
