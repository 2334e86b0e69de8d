//! Parts of expressions that become locals of a function where its text would write them again and again.

use super::share::LARGE;
use crate::base::index::{FastMap, Id};
use crate::ir::expr::{ExprId, Graph, Node, VarId};
use crate::ir::flat::{Function, LocalId, Statement};
use crate::symbolic::rewrite::Rewriter;

/// Gives a function locals for what its assignments share; `sizes` says how long expressions are as texts.
pub(super) fn in_function(graph: &mut Graph, function: &mut Function, sizes: &[u64]) {
    let body = std::mem::take(&mut function.body);
    function.body = in_statements(graph, function, body, sizes);
}

fn in_statements(
    graph: &mut Graph,
    function: &mut Function,
    list: Vec<Statement>,
    sizes: &[u64],
) -> Vec<Statement> {
    let mut out = Vec::with_capacity(list.len());
    for statement in list {
        match statement {
            Statement::Assign(local, value) => {
                let value = named(graph, function, value, sizes, &mut out);
                out.push(Statement::Assign(local, value));
            }
            Statement::If(c, a, b) => {
                let a = in_statements(graph, function, a, sizes);
                let b = in_statements(graph, function, b, sizes);
                out.push(Statement::If(c, a, b));
            }
            Statement::While(c, a) => {
                let a = in_statements(graph, function, a, sizes);
                out.push(Statement::While(c, a));
            }
            other => out.push(other),
        }
    }
    out
}

/// The expression in terms of locals that are assigned before it.
fn named(
    graph: &mut Graph,
    function: &mut Function,
    root: ExprId,
    sizes: &[u64],
    out: &mut Vec<Statement>,
) -> ExprId {
    let order = graph.postorder([root]);
    let mut uses: FastMap<ExprId, u32> = FastMap::default();
    for &e in &order {
        graph.for_each_operand(e, |a| *uses.entry(a).or_default() += 1);
    }
    let mut names: FastMap<ExprId, ExprId> = FastMap::default();
    for &e in &order {
        let is_long = sizes.get(e.idx()).is_some_and(|s| *s >= LARGE);
        // Two outputs of a call are written with its arguments twice.
        let is_call = matches!(graph.node(e), Node::Call { .. });
        if e == root || !is_long || (!is_call && uses.get(&e).is_none_or(|n| *n < 2)) {
            continue;
        }
        let part = replaced(graph, &names, e);
        let local = function.locals.push(format!("part{}", function.locals.len() + 1));
        out.push(Statement::Assign(local, part));
        let ty = graph.ty(e);
        names.insert(e, graph.var(VarId(LocalId::idx(local) as u32), ty));
    }
    replaced(graph, &names, root)
}

fn replaced(graph: &mut Graph, names: &FastMap<ExprId, ExprId>, root: ExprId) -> ExprId {
    Rewriter::new()
        .apply(graph, root, &mut |_, e| (e != root).then(|| names.get(&e)).flatten().copied())
}
