//! Introduces locals for common subexpressions of functions.

use super::common_subexpressions::MIN_PART_SIZE;
use crate::base::index::{FastMap, FastSet, Id};
use crate::ir::expr::{ExprId, Graph, Node, VarId};
use crate::ir::flat::{Assert, Function, LocalId, Statement};
use crate::symbolic::rewrite::Rewriter;

/// Adds locals for the common subexpressions of a function; `sizes` holds the printed sizes of
/// expressions.
pub(crate) fn in_function(graph: &mut Graph, function: &mut Function, sizes: &[u64]) {
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
    let mut names = LocalNames::default();
    // Successive assignments and assertions share subexpressions until a variable in them changes.
    for at in 0..list.len() {
        if at == 0 || !matches!(list[at - 1], Statement::Assign(..) | Statement::Assert(..)) {
            names = LocalNames::of(graph, &list[at..]);
        }
        match list[at].clone() {
            Statement::Assign(local, value) => {
                let value = names.named(graph, function, value, sizes, &mut out);
                out.push(Statement::Assign(local, value));
                names.invalidate(graph, local);
            }
            Statement::Assert(a, span) => {
                let condition = names.named(graph, function, a.condition, sizes, &mut out);
                let message = names.named(graph, function, a.message, sizes, &mut out);
                out.push(Statement::Assert(Assert { condition, message, ..a }, span));
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

/// The locals that replace subexpressions.
#[derive(Default)]
struct LocalNames {
    /// Number of uses of each subexpression in the statements that share it.
    uses: FastMap<ExprId, u32>,
    names: FastMap<ExprId, ExprId>,
}

impl LocalNames {
    /// No locals yet, for the assignments and assertions at the start of a list.
    fn of(graph: &Graph, list: &[Statement]) -> LocalNames {
        let mut roots: Vec<ExprId> = Vec::new();
        for statement in list {
            match statement {
                Statement::Assign(_, value) => roots.push(*value),
                Statement::Assert(a, _) => roots.extend([a.condition, a.message]),
                _ => break,
            }
        }
        let mut uses: FastMap<ExprId, u32> = FastMap::default();
        for e in graph.postorder(roots.iter().copied()) {
            graph.for_each_operand(e, |a| *uses.entry(a).or_default() += 1);
        }
        roots.into_iter().for_each(|e| *uses.entry(e).or_default() += 1);
        LocalNames { uses, names: FastMap::default() }
    }

    /// Rewrites an expression in terms of locals, which are assigned before it.
    fn named(
        &mut self,
        graph: &mut Graph,
        function: &mut Function,
        root: ExprId,
        sizes: &[u64],
        out: &mut Vec<Statement>,
    ) -> ExprId {
        for e in graph.postorder([root]) {
            let is_long = sizes.get(e.idx()).is_some_and(|s| *s >= MIN_PART_SIZE);
            // A call is printed once for each of its outputs, each time with all arguments.
            let is_call = matches!(graph.node(e), Node::Call { .. });
            let is_shared = self.uses.get(&e).is_some_and(|n| *n > 1);
            if !is_long || !(is_shared || is_call && e != root) || self.names.contains_key(&e) {
                continue;
            }
            let part = self.replaced(graph, e, false);
            let local = function.locals.push(format!("part{}", function.locals.len() + 1));
            out.push(Statement::Assign(local, part));
            let ty = graph.ty(e);
            self.names.insert(e, graph.var(VarId(LocalId::idx(local) as u32), ty));
        }
        self.replaced(graph, root, true)
    }

    /// Discards the subexpressions that read a local whose value has changed.
    fn invalidate(&mut self, graph: &Graph, local: LocalId) {
        let changed = VarId(local.idx() as u32);
        let mut reading: FastSet<ExprId> = FastSet::default();
        for e in graph.postorder(self.names.keys().copied()) {
            let mut reads = graph.node(e) == Node::Var(changed);
            graph.for_each_operand(e, |a| reads |= reading.contains(&a));
            if reads {
                reading.insert(e);
            }
        }
        self.names.retain(|e, _| !reading.contains(e));
    }

    fn replaced(&self, graph: &mut Graph, root: ExprId, itself: bool) -> ExprId {
        Rewriter::new().apply(graph, root, &mut |_, e| {
            (itself || e != root).then(|| self.names.get(&e)).flatten().copied()
        })
    }
}
