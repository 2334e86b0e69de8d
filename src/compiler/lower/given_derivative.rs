//! Equations of variables whose derivatives are given (`flat::GivenDerivative`): they do not define aliases, and the
//! equation of the derivative takes the place of the differentiated one.

use super::classify::declaration_origin;
use super::rewriting::{RelationMode, Rewriting};
use super::{Equal, continuous_equation};
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::ir::dae::{EqId, Equation, VariableKind};
use crate::ir::expr::{Node, Type, VarId};
use crate::ir::flat::{FlatModel, GivenDerivative};

/// Takes the equations of such variables out, and adds those that name their derivatives. Returns the other equations
/// first.
pub fn set_aside(flat: &mut FlatModel, equal: Vec<Equal>) -> (Vec<Equal>, FastMap<VarId, Equal>) {
    let mut given = FastMap::default();
    if flat.given_derivatives.is_empty() {
        return (equal, given);
    }
    let own: FastSet<VarId> = flat.given_derivatives.iter().map(|g| g.variable).collect();
    // First the names of the derivatives: whatever else is one becomes an alias of it.
    let mut others = Vec::with_capacity(equal.len());
    for g in &flat.given_derivatives {
        let Some(derivative) = g.derivative else { continue };
        let lhs = flat.graph.var(derivative, Type::Real);
        let rhs = flat.graph.der(g.variable);
        let origin = declaration_origin(&flat.variables[g.variable]);
        others.push(Equal { lhs, rhs, origin });
    }
    for e in equal {
        match flat.graph.node(e.lhs) {
            Node::Var(v) if own.contains(&v) && !given.contains_key(&v) => {
                given.insert(v, e);
            }
            _ => others.push(e),
        }
    }
    (others, given)
}

/// Appends the equations that were set aside, each before the one of its derivative.
pub fn append(
    order: &[GivenDerivative],
    mut given: FastMap<VarId, Equal>,
    equations: &mut IndexVec<EqId, Equation>,
    r: &mut Rewriting<'_>,
) {
    let mut appended: FastMap<VarId, EqId> = FastMap::default();
    // Derivatives are made before the variables that they belong to.
    for g in order.iter().rev() {
        let Some(Equal { lhs, rhs, origin }) = given.remove(&g.variable) else { continue };
        let [lhs, rhs] = [lhs, rhs].map(|side| r.apply(side, RelationMode::Events, &origin));
        let equation = continuous_equation(lhs, rhs, origin, r);
        appended.insert(g.variable, equations.push(equation));
    }
    for g in order {
        let Some(derivative) = g.derivative else { continue };
        if is_derivative(derivative, g.variable, r)
            && let (Some(of), Some(own)) = (appended.get(&g.variable), appended.get(&derivative))
            && of < own
        {
            equations[*own].derivative_of = Some(*of);
        }
    }
}

/// Whether a variable has become the derivative of another one: it has not if that is an input, for example.
fn is_derivative(derivative: VarId, of: VarId, r: &Rewriting<'_>) -> bool {
    let (Some(derivative), Some(of)) = (r.representative(derivative), r.representative(of)) else {
        return false;
    };
    r.variables[of.variable].kind
        == VariableKind::Differentiated { derivative: derivative.variable }
}
