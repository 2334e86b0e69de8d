//! Replacement of leaves, following the sharing of the graph.

use crate::base::index::FastMap;
use crate::ir::expr::{ExprId, Graph};

/// A rewriting in progress: the result for each node. Reusable over many roots.
#[derive(Default)]
pub struct Rewriter {
    done: FastMap<ExprId, ExprId>,
}

impl Rewriter {
    /// Nothing rewritten yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Rewrites `root`. `replace` sees every node before its operands and may give another
    /// expression for it, which is not rewritten again.
    pub fn apply(
        &mut self,
        graph: &mut Graph,
        root: ExprId,
        replace: &mut impl FnMut(&mut Graph, ExprId) -> Option<ExprId>,
    ) -> ExprId {
        let mut stack = vec![(root, false)];
        let mut operands = Vec::new();
        while let Some((e, ready)) = stack.pop() {
            if self.done.contains_key(&e) {
                continue;
            }
            if ready {
                operands.clear();
                graph.for_each_operand(e, |a| operands.push(self.done[&a]));
                let new = graph.rebuild(e, &operands);
                self.done.insert(e, new);
            } else if let Some(new) = replace(graph, e) {
                self.done.insert(e, new);
            } else {
                let before = stack.len();
                stack.push((e, true));
                graph.for_each_operand(e, |a| stack.push((a, false)));
                if stack.len() == before + 1 {
                    stack.pop();
                    self.done.insert(e, e);
                }
            }
        }
        self.done[&root]
    }
}
