//! Initial equations: Modelica 3.6, section 8.6.

use super::event::{Mode, Rewriting};
use super::{Discrete, error};
use crate::ir::dae::{self, Kind};
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{Equation, EquationKind, Origin, Variability};

/// The initial equations of continuous variables and parameters. One that gives a discrete variable
/// its first value goes into that variable's equation, as what holds while `initial()`.
pub fn equations(
    flat: &[Equation],
    discrete: &mut Discrete,
    r: &mut Rewriting<'_>,
) -> Vec<dae::Equation> {
    let mut equations = Vec::new();
    for equation in flat {
        let origin = &equation.origin;
        match &equation.kind {
            EquationKind::Equal(a, b) => equal(*a, *b, origin, discrete, &mut equations, r),
            EquationKind::Algorithm { outputs, values } => {
                for (v, value) in outputs.iter().zip(values) {
                    let lhs = r.graph.var(*v, r.variables[*v].ty);
                    equal(lhs, *value, origin, discrete, &mut equations, r);
                }
            }
            EquationKind::When(_) => r.problems.push(error::initial_when(origin)),
            // Checked at the start anyway, together with all others.
            EquationKind::Assert(_) => {}
        }
    }
    equations
}

fn equal(
    a: ExprId,
    b: ExprId,
    origin: &Origin,
    discrete: &mut Discrete,
    equations: &mut Vec<dae::Equation>,
    r: &mut Rewriting<'_>,
) {
    let lhs = r.apply(a, Mode::Literal, origin);
    let rhs = r.apply(b, Mode::Literal, origin);
    for (side, value) in [(lhs, rhs), (rhs, lhs)] {
        match r.graph.node(side) {
            Node::Var(v) if r.variables[v].kind == Kind::Discrete => {
                return first_value(v, value, origin, discrete, r);
            }
            Node::Pre(v) if r.variability(value) <= Variability::Parameter => {
                r.variables[v].start = Some(value);
                return;
            }
            _ => {}
        }
    }
    if r.graph.common_type(lhs, rhs) != Type::Real {
        r.problems.push(error::initial_discrete(origin));
        return;
    }
    let residual = r.graph.sub(lhs, rhs);
    let origin = origin.clone();
    equations.push(dae::Equation { lhs, rhs, residual, origin, derivative_of: None });
}

fn first_value(
    v: VarId,
    value: ExprId,
    origin: &Origin,
    discrete: &mut Discrete,
    r: &mut Rewriting<'_>,
) {
    if r.variability(value) <= Variability::Parameter {
        r.variables[v].start = Some(value);
    }
    let Some(&place) = discrete.of.get(&v) else {
        r.problems.push(error::initial_discrete(origin));
        return;
    };
    let initial = r.graph.intern(Node::Initial, Type::Boolean);
    let later = discrete.list[place].value;
    discrete.list[place].value = r.graph.if_then_else(initial, value, later);
}
