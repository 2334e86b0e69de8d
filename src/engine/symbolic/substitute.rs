//! The body of a function in place of a call.

use super::rewrite::Rewriter;
use crate::ir::expr::{ExprId, Graph, Node};

impl Graph {
    /// Expressions over the inputs of a function, which are its first locals, for these arguments.
    pub fn with_arguments(&mut self, roots: &[ExprId], arguments: &[ExprId]) -> Vec<ExprId> {
        let mut rewriter = Rewriter::new();
        let mut replace = |graph: &mut Graph, e: ExprId| match graph.node(e) {
            Node::Var(v) => arguments.get(v.0 as usize).copied(),
            _ => None,
        };
        roots.iter().map(|e| rewriter.apply(self, *e, &mut replace)).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::ir::expr::{Graph, Type, VarId};

    #[test]
    fn arguments_replace_inputs_and_the_result_is_simplified() {
        let mut g = Graph::new();
        let [x, y, z] = [0, 1, 7].map(|k| g.var(VarId(k), Type::Real));
        let product = g.mul(x, y);
        let body = g.add(product, x);
        let two = g.real(2.0);
        let expected = g.mul(two, z);
        let expected = g.add(expected, two);
        let zero = g.real(0.0);
        assert_eq!(g.with_arguments(&[body, x], &[two, z]), [expected, two]);
        assert_eq!(g.with_arguments(&[body], &[zero, z]), [zero]);
    }
}
