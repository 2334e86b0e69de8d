//! Linear combinations of derivatives: `c1 * der(x1) + c2 * der(x2) = f` is equivalent to
//! `der(w) = f` with `w = c1 * x1 + c2 * x2`.
//!
//! The balance of a node with several storage terms has this form. If its derivatives occur in no
//! other equation, constraints relate the terms to each other; with `w` as the state, the
//! constraints are solved as they are instead of being differentiated, which matters if their
//! derivatives are steep or discontinuous.

use super::solve;
use crate::base::index::FastMap;
use crate::ir::dae::{Dae, EqId, Equation, Variable, VariableKind};
use crate::ir::expr::{ExprId, Type, VarId};
use crate::ir::flat::StateSelect;
use crate::symbolic::gradient::Leaf;
use crate::symbolic::linear;

/// An equation with a combination of derivatives that occur in no other equation.
pub struct DerivativeCombination {
    equation: EqId,
    rates: Vec<VarId>,
}

/// The combinations in a system. Empty if the system contains `reinit`: a term may then jump while
/// the others do not (Modelica 3.6, section 8.3.6), which a common state would prevent.
pub fn find(dae: &Dae) -> Vec<DerivativeCombination> {
    if !dae.reinits.is_empty() {
        return Vec::new();
    }
    // The number of occurrences of each derivative.
    let mut occurrences: FastMap<VarId, usize> = FastMap::default();
    let mut combinations: Vec<DerivativeCombination> = Vec::new();
    for (equation, e) in dae.equations.enumerate() {
        let mut rates = dae.graph.variables(e.residual);
        rates.retain(|v| dae.variables[*v].derivative_of.is_some());
        for v in &rates {
            *occurrences.entry(*v).or_insert(0) += 1;
        }
        // A derivative that is given must stay as it is.
        if rates.len() > 1 && e.derivative_of.is_none() {
            rates.sort_unstable();
            combinations.push(DerivativeCombination { equation, rates });
        }
    }
    let is_algebraic = |v: VarId| dae.variables[v].kind == VariableKind::Algebraic;
    combinations.retain(|sum| sum.rates.iter().all(|v| occurrences[v] == 1 && is_algebraic(*v)));
    combinations
}

/// Introduces a state for every combination with constant coefficients.
pub fn introduce_states(dae: &mut Dae, combinations: &[DerivativeCombination]) {
    for DerivativeCombination { equation, rates } in combinations {
        if let Some((coefficients, rest)) = split(dae, *equation, rates) {
            replace(dae, *equation, rates, &coefficients, rest);
        }
    }
}

/// The coefficients of the derivatives, if they are constant, and the remainder of the equation.
fn split(dae: &mut Dae, id: EqId, rates: &[VarId]) -> Option<(Vec<ExprId>, ExprId)> {
    let mut rest = dae.equations[id].residual;
    let mut coefficients = Vec::with_capacity(rates.len());
    for v in rates {
        let (coefficient, without) = linear::split(&mut dae.graph, rest, Leaf::Var(*v))?;
        if !solve::is_parameter_expression(dae, coefficient)
            || !solve::is_never_zero(dae, coefficient)
        {
            return None;
        }
        coefficients.push(coefficient);
        rest = without;
    }
    Some((coefficients, rest))
}

fn replace(dae: &mut Dae, id: EqId, rates: &[VarId], coefficients: &[ExprId], rest: ExprId) {
    let name = format!("$sum{}", id.0 + 1);
    let mut sum =
        Variable::new(name, Type::Real, VariableKind::Algebraic, dae.equations[id].origin.span);
    sum.hidden = true;
    sum.state_select = StateSelect::Prefer;
    let sum = dae.variables.push(sum);
    let rate = Variable::derivative(sum, &dae.variables[sum], VariableKind::Algebraic);
    let rate = dae.variables.push(rate);
    dae.variables[sum].kind = VariableKind::Differentiated { derivative: rate };

    let mut terms = Vec::with_capacity(rates.len());
    for (v, coefficient) in rates.iter().zip(coefficients) {
        if let Some(of) = dae.variables[*v].derivative_of {
            let of = dae.graph.var(of, Type::Real);
            terms.push(dae.graph.mul(*coefficient, of));
        }
    }
    let value = dae.graph.sum(terms);
    let origin = dae.equations[id].origin.clone();
    let lhs = dae.graph.var(sum, Type::Real);
    let residual = dae.graph.sub(lhs, value);
    dae.equations.push(Equation {
        lhs,
        rhs: value,
        residual,
        origin: origin.clone(),
        derivative_of: None,
    });
    let lhs = dae.graph.var(rate, Type::Real);
    let rhs = dae.graph.neg(rest);
    let residual = dae.graph.add(lhs, rest);
    dae.equations[id] = Equation { lhs, rhs, residual, origin, derivative_of: None };
}
