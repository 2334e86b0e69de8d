//! Sorts the values of constants and parameters so that each depends only on earlier ones.

use super::classify::declaration_origin;
use super::error;
use super::rewriting::{RelationMode, Rewriting};
use crate::base::index::{FastMap, IndexVec};
use crate::graph::scc;
use crate::ir::dae::{self, VariableKind};
use crate::ir::expr::{Binary, Const, ExprId, Node, Type, Unary, VarId};
use crate::ir::flat::{Variability, Variable};
use crate::symbolic::rewrite::Rewriter;

crate::define_id! {
    /// A parameter with a value, in order of declaration.
    struct ParameterPosition
}

/// The parameters with their values in order of evaluation. A parameter that depends on one with
/// `fixed = false` is determined by initialization, too: its value becomes an initial equation.
pub fn ordered(
    flat: &IndexVec<VarId, Variable>,
    initial: &mut Vec<dae::Equation>,
    r: &mut Rewriting<'_>,
) -> Vec<(VarId, ExprId)> {
    let values = values(flat, r);
    let position: FastMap<VarId, ParameterPosition> =
        values.iter().enumerate().map(|(i, (v, _))| (*v, ParameterPosition(i as u32))).collect();
    let reads: Vec<Vec<VarId>> = values.iter().map(|(_, e)| r.graph.variables(*e)).collect();
    let needs = reads.iter().enumerate().flat_map(|(i, read)| {
        let position = &position;
        read.iter().filter_map(move |v| Some((ParameterPosition(i as u32), *position.get(v)?)))
    });
    let order = match scc::topological_order(values.len(), needs) {
        Ok(order) => order,
        Err(cycle) => {
            let cycle: Vec<&Variable> =
                cycle.iter().map(|p| &flat[values[p.0 as usize].0]).collect();
            r.problems.push(error::parameter_cycle(&cycle));
            return values;
        }
    };
    let mut list = Vec::with_capacity(values.len());
    let mut known = KnownValues::default();
    for position in order {
        let (v, value) = values[position.0 as usize];
        let is_initial = |v: &VarId| r.variables[*v].kind == VariableKind::InitialParameter;
        if reads[position.0 as usize].iter().any(is_initial) {
            r.variables[v].kind = VariableKind::InitialParameter;
            r.variables[v].start = None;
            let lhs = r.graph.var(v, flat[v].ty);
            let residual = r.graph.sub(lhs, value);
            let origin = declaration_origin(&flat[v]);
            initial.push(dae::Equation { lhs, rhs: value, residual, origin, derivative_of: None });
        } else {
            r.variables[v].vanishes = known.vanishes(v, value, r);
            list.push((v, value));
        }
    }
    list
}

/// The values of parameters that are known at compile time.
#[derive(Default)]
struct KnownValues {
    values: FastMap<VarId, ExprId>,
}

impl KnownValues {
    /// Records the value of a parameter if it can be evaluated; returns whether it is 0.
    fn vanishes(&mut self, v: VarId, value: ExprId, r: &mut Rewriting<'_>) -> bool {
        let values = &self.values;
        let known = Rewriter::new().apply(r.graph, value, &mut |g, n| match g.node(n) {
            Node::Var(p) => values.get(&p).copied(),
            _ => None,
        });
        let number = r.graph.as_const(known).and_then(Const::number);
        if number.is_some() {
            self.values.insert(v, known);
        }
        number == Some(0.0) || self.is_zero_by_form(value, r)
    }

    /// True for the literal 0, a parameter that vanishes, products with one, and for sines and
    /// cosines whose argument is a zero up to rounding.
    fn is_zero_by_form(&self, value: ExprId, r: &Rewriting<'_>) -> bool {
        match r.graph.node(value) {
            Node::Const(c) => c.number() == Some(0.0),
            Node::Var(v) => r.variables[v].vanishes,
            Node::Unary(Unary::Neg, a) => self.is_zero_by_form(a, r),
            Node::Unary(op @ (Unary::Sin | Unary::Cos), a) => {
                let argument = match r.graph.node(a) {
                    Node::Var(v) => self.values.get(&v).copied().unwrap_or(a),
                    _ => a,
                };
                let at = r.graph.as_number(argument);
                let value = |x: f64| if op == Unary::Sin { x.sin() } else { x.cos() };
                at.is_some_and(|x| value(x).abs() <= f64::EPSILON * x.abs())
            }
            Node::Binary(Binary::Mul, a, b) => {
                self.is_zero_by_form(a, r) || self.is_zero_by_form(b, r)
            }
            // 0/0 is not a number.
            Node::Binary(Binary::Div, a, b) => {
                self.is_zero_by_form(a, r) && !self.is_zero_by_form(b, r)
            }
            _ => false,
        }
    }
}

fn values(flat: &IndexVec<VarId, Variable>, r: &mut Rewriting<'_>) -> Vec<(VarId, ExprId)> {
    let mut values = Vec::new();
    for (id, v) in flat.enumerate() {
        if r.variables[id].kind != VariableKind::Parameter {
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
        let value = r.apply(value, RelationMode::Literal, &declaration_origin(v));
        if r.variability(value) > Variability::Parameter {
            let culprit = r.graph.variables(value).into_iter().find(|w| {
                !matches!(
                    r.variables[*w].kind,
                    VariableKind::Parameter | VariableKind::InitialParameter
                )
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
