//! The system between the simplified and the actual one: section 3.7.4.4 of the Modelica
//! specification.
//!
//! `homotopy(actual, simplified)` means `actual`. Where initialisation does not find its solution, it
//! is led there from that of the simplified system: `(1 - lambda) simplified + lambda actual`, with
//! `lambda` as one more parameter of a second model.

use std::sync::Arc;

use crate::base::name::name;
use crate::ir::expr::{ExprId, Graph, Node, Type, VarId};
use crate::ir::flat::{Action, EquationKind, FlatModel, Variability, Variable};
use crate::symbolic::rewrite::Rewriter;

/// The name of the parameter, which no name of a user can be.
pub const LAMBDA: &str = "$lambda";

/// The model with `lambda`, if `homotopy` occurs in its equations.
pub fn between(flat: &FlatModel) -> Option<FlatModel> {
    let occurs = flat.graph.ids().any(|e| matches!(flat.graph.node(e), Node::Homotopy(..)));
    if !occurs {
        return None;
    }
    let mut model = flat.clone();
    let one = model.graph.real(1.0);
    let lambda = model.variables.push(parameter(one, &model));
    let mut rewriter = Rewriter::new();
    let FlatModel { graph, variables, equations, initial_equations, .. } = &mut model;
    let mut apply = |e: &mut ExprId| *e = blended(graph, &mut rewriter, *e, lambda);
    for v in variables.iter_mut() {
        v.binding.iter_mut().for_each(&mut apply);
    }
    for equation in equations.iter_mut().chain(initial_equations) {
        match &mut equation.kind {
            EquationKind::Equal(a, b) => [a, b].into_iter().for_each(&mut apply),
            EquationKind::When(branches) => {
                for branch in branches {
                    branch.conditions.iter_mut().for_each(&mut apply);
                    for action in &mut branch.actions {
                        match action {
                            Action::Assign(_, value) => apply(value),
                            Action::Reinit { value, .. } => apply(value),
                            Action::Assert(_) | Action::Terminate(_) => {}
                        }
                    }
                }
            }
            EquationKind::Algorithm { values, .. } => values.iter_mut().for_each(&mut apply),
            EquationKind::Assert(_) => {}
        }
    }
    Some(model)
}

fn blended(graph: &mut Graph, rewriter: &mut Rewriter, root: ExprId, lambda: VarId) -> ExprId {
    rewriter.apply(graph, root, &mut |graph, e| {
        let Node::Homotopy(actual, simplified) = graph.node(e) else { return None };
        // Of nested homotopies the outermost counts.
        let [actual, simplified] =
            [actual, simplified].map(|side| without(graph, &mut Rewriter::new(), side));
        let lambda = graph.var(lambda, Type::Real);
        let one = graph.real(1.0);
        let rest = graph.sub(one, lambda);
        let [a, b] = [graph.mul(lambda, actual), graph.mul(rest, simplified)];
        Some(graph.add(a, b))
    })
}

fn without(graph: &mut Graph, rewriter: &mut Rewriter, root: ExprId) -> ExprId {
    rewriter.apply(graph, root, &mut |graph, e| match graph.node(e) {
        Node::Homotopy(actual, _) => Some(without(graph, &mut Rewriter::new(), actual)),
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
