//! Values of constants and parameters, in an order in which each reads only earlier ones.

use super::classify::declaration_origin;
use super::error;
use super::event::{Mode, Rewriting};
use crate::base::index::{FastMap, IndexVec};
use crate::ir::dae::{self, Kind};
use crate::ir::expr::{Binary, ExprId, Node, Type, Unary, VarId};
use crate::ir::flat::{Variability, Variable};
use crate::math::graph::scc;

crate::define_id! {
    /// A parameter with a value, in order of declaration.
    struct Place
}

/// The parameters with their values in order of evaluation. One that depends on a parameter with
/// `fixed = false` is determined by initialisation too: its value becomes an initial equation.
pub fn ordered(
    flat: &IndexVec<VarId, Variable>,
    initial: &mut Vec<dae::Equation>,
    r: &mut Rewriting<'_>,
) -> Vec<(VarId, ExprId)> {
    let values = values(flat, r);
    let place: FastMap<VarId, Place> =
        values.iter().enumerate().map(|(i, (v, _))| (*v, Place(i as u32))).collect();
    let reads: Vec<Vec<VarId>> = values.iter().map(|(_, e)| r.graph.variables(*e)).collect();
    let needs = reads.iter().enumerate().flat_map(|(i, read)| {
        let place = &place;
        read.iter().filter_map(move |v| Some((Place(i as u32), *place.get(v)?)))
    });
    let order = match scc::order(values.len(), needs) {
        Ok(order) => order,
        Err(cycle) => {
            let cycle: Vec<&Variable> =
                cycle.iter().map(|p| &flat[values[p.0 as usize].0]).collect();
            r.problems.push(error::parameter_cycle(&cycle));
            return values;
        }
    };
    let mut list = Vec::with_capacity(values.len());
    for place in order {
        let (v, value) = values[place.0 as usize];
        let is_initial = |v: &VarId| r.variables[*v].kind == Kind::InitialParameter;
        if reads[place.0 as usize].iter().any(is_initial) {
            r.variables[v].kind = Kind::InitialParameter;
            r.variables[v].start = None;
            let lhs = r.graph.var(v, flat[v].ty);
            let residual = r.graph.sub(lhs, value);
            let origin = declaration_origin(&flat[v]);
            initial.push(dae::Equation { lhs, rhs: value, residual, origin, derivative_of: None });
        } else {
            r.variables[v].vanishes = vanishes(value, r);
            list.push((v, value));
        }
    }
    list
}

/// True for the literal 0, a parameter that vanishes, and products with one.
fn vanishes(value: ExprId, r: &Rewriting<'_>) -> bool {
    match r.graph.node(value) {
        Node::Const(c) => c.number() == Some(0.0),
        Node::Var(v) => r.variables[v].vanishes,
        Node::Unary(Unary::Neg, a) => vanishes(a, r),
        Node::Binary(Binary::Mul, a, b) => vanishes(a, r) || vanishes(b, r),
        Node::Binary(Binary::Div, a, _) => vanishes(a, r),
        _ => false,
    }
}

fn values(flat: &IndexVec<VarId, Variable>, r: &mut Rewriting<'_>) -> Vec<(VarId, ExprId)> {
    let mut values = Vec::new();
    for (id, v) in flat.enumerate() {
        if r.variables[id].kind != Kind::Parameter {
            continue;
        }
        let value = match (v.binding, v.start) {
            (Some(value), _) => value,
            (None, Some(start)) if v.variability == Variability::Parameter => {
                r.problems.push(error::parameter_at_start(v));
                start
            }
            _ => {
                r.problems.push(error::no_value(v));
                continue;
            }
        };
        let value = r.apply(value, Mode::Literal, &declaration_origin(v));
        if r.variability(value) > Variability::Parameter {
            let culprit = r.graph.variables(value).into_iter().find(|w| {
                !matches!(r.variables[*w].kind, Kind::Parameter | Kind::InitialParameter)
            });
            let culprit = culprit.map(|w| r.variables[w].name.clone());
            r.problems.push(error::varying_parameter(v, culprit.as_deref().unwrap_or("time")));
            continue;
        }
        let value = if v.ty == Type::Real { r.graph.as_real(value) } else { value };
        values.push((id, value));
    }
    values
}
