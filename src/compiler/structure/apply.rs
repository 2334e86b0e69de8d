//! Writes the result of the index reduction back into the system of equations.

use crate::base::index::{Id, IndexVec};
use crate::graph::bipartite::{Col, Row};
use crate::graph::pantelides::Reduction;
use crate::ir::dae::{Dae, EqId, Equation, Variable, VariableKind};
use crate::ir::expr::{ExprId, Graph, VarId};
use crate::symbolic::function_derivative::FunctionDerivatives;
use crate::symbolic::gradient::{Leaf, time_derivative_through};

/// Appends the derivative variables and differentiated equations of a reduction, whose rows are the
/// equations in order. Returns the variable of each column.
pub fn differentiate(
    dae: &mut Dae,
    unknowns: &IndexVec<Col, VarId>,
    reduction: &Reduction,
    functions: &mut FunctionDerivatives,
) -> IndexVec<Col, VarId> {
    let mut variable = unknowns.clone();
    let mut integral = IndexVec::filled(None, reduction.derivative.len());
    for (col, derivative) in reduction.derivative.enumerate() {
        if let Some(derivative) = *derivative {
            integral[derivative] = Some(col);
        }
    }
    for index in unknowns.len()..reduction.derivative.len() {
        // A new column is the derivative of a column with a lower number.
        let Some(of) = integral[Col::from_usize(index)] else { continue };
        let of = variable[of];
        let mut derivative = Variable::derivative(of, &dae.variables[of], VariableKind::Algebraic);
        derivative.hidden = true;
        let derivative = dae.variables.push(derivative);
        dae.variables[of].kind = VariableKind::Differentiated { derivative };
        variable.push(derivative);
    }
    let mut origin: IndexVec<Row, Option<Row>> =
        IndexVec::filled(None, reduction.differentiated.len());
    for (row, differentiated) in reduction.differentiated.enumerate() {
        if let Some(differentiated) = *differentiated {
            origin[differentiated] = Some(row);
        }
    }
    for index in dae.equations.len()..reduction.differentiated.len() {
        let Some(of) = origin[Row::from_usize(index)] else { continue };
        let equation = derivative(dae, EqId::from_usize(of.idx()), functions);
        dae.equations.push(equation);
    }
    variable
}

/// The time derivative of an equation. Discrete variables do not change between events.
fn derivative(dae: &mut Dae, of: EqId, functions: &mut FunctionDerivatives) -> Equation {
    // An equation that was differentiated already calls functions of derivatives.
    functions.add(&mut dae.graph, &mut dae.functions, dae.equations[of].residual);
    let Equation { lhs, rhs, residual, origin, .. } = dae.equations[of].clone();
    let Dae { graph, variables, .. } = dae;
    let [lhs, rhs, residual] = [lhs, rhs, residual].map(|e| {
        let of_leaf = |g: &mut Graph, leaf| rate(g, variables, leaf);
        time_derivative_through(graph, e, of_leaf, |g, call| functions.of_call(g, call))
    });
    Equation { lhs, rhs, residual, origin, derivative_of: Some(of) }
}

fn rate(graph: &mut Graph, variables: &IndexVec<VarId, Variable>, leaf: Leaf) -> Option<ExprId> {
    let Leaf::Var(v) = leaf else { return None };
    match variables[v].kind {
        VariableKind::Differentiated { derivative } => {
            Some(graph.var(derivative, variables[derivative].ty))
        }
        _ => None,
    }
}
