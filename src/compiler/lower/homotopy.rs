//! The homotopy between the simplified and the actual system (Modelica 3.6, section 3.7.4.4).
//!
//! `homotopy(actual, simplified)` means `actual`. If initialization cannot solve the actual system
//! directly, it starts from the simplified one and follows the solution of
//! `(1 - lambda) simplified + lambda actual`, with `lambda` as an additional parameter of a second
//! model.

use std::sync::Arc;

use crate::base::name::name;
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::{FlatModel, Variability, Variable};
use crate::symbolic::rewrite::Rewriter;

/// The name of the parameter, which cannot be an identifier of the user.
pub const LAMBDA: &str = "$lambda";

/// The model with `lambda`, if `homotopy` occurs in its equations.
pub fn homotopy_model(flat: &FlatModel) -> Option<FlatModel> {
    let occurs = flat.graph.ids().any(|e| matches!(flat.graph.node(e), Node::Homotopy(..)));
    if !occurs {
        return None;
    }
    let mut model = flat.clone();
    let one = model.graph.real(1.0);
    let lambda = model.variables.push(parameter(one, &model));
    let mut rewriter = Rewriter::new();
    model.map_expressions(&mut |graph, e| blended(graph, &mut rewriter, e, lambda));
    Some(model)
}

fn blended(graph: &mut Graph, rewriter: &mut Rewriter, root: ExprId, lambda: VarId) -> ExprId {
    rewriter.apply(graph, root, &mut |graph, e| {
        let Node::Homotopy(actual, simplified) = graph.node(e) else { return None };
        // Only the outermost of nested homotopies counts.
        let [actual, simplified] =
            [actual, simplified].map(|side| actual_only(graph, &mut Rewriter::new(), side));
        let lambda = graph.var(lambda, Type::Real);
        let one = graph.real(1.0);
        let rest = graph.sub(one, lambda);
        let [a, b] = [graph.mul(lambda, actual), graph.mul(rest, simplified)];
        Some(graph.add(a, b))
    })
}

fn actual_only(graph: &mut Graph, rewriter: &mut Rewriter, root: ExprId) -> ExprId {
    rewriter.apply(graph, root, &mut |graph, e| match graph.node(e) {
        Node::Homotopy(actual, _) => Some(actual_only(graph, &mut Rewriter::new(), actual)),
        _ => None,
    })
}

fn parameter(value: ExprId, model: &FlatModel) -> Variable {
    let full = LAMBDA.to_owned();
    Variable {
        binding: Some(value),
        unit: name("1"),
        description: Some(Arc::from("From the simplified to the actual system")),
        protected: true,
        ..Variable::bare(full, Type::Real, Variability::Parameter, model.span)
    }
}
