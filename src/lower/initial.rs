//! Initial equations (Modelica 3.6, section 8.6).

use super::rewriting::{RelationMode, Rewriting};
use super::{DiscreteEquations, error};
use crate::base::index::FastSet;
use crate::ir::dae::{self, VariableKind};
use crate::ir::expr::{Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{Equation, EquationKind, Origin, Variability};

/// The initial equations of continuous variables and parameters. An equation for the first value of
/// a discrete variable becomes part of that variable's equation, under the condition `initial()`.
pub fn equations(
    flat: &[Equation],
    discrete: &mut DiscreteEquations,
    r: &mut Rewriting<'_>,
) -> Vec<dae::Equation> {
    let mut equations = Vec::new();
    let mut pre = PreEquations::default();
    for equation in flat {
        let origin = &equation.origin;
        match &equation.kind {
            EquationKind::Equal(a, b) => {
                equal(*a, *b, origin, discrete, &mut equations, &mut pre, r);
            }
            EquationKind::Algorithm { outputs, values } => {
                for (v, value) in outputs.iter().zip(values) {
                    let lhs = r.graph.var(*v, r.variables[*v].ty);
                    equal(lhs, *value, origin, discrete, &mut equations, &mut pre, r);
                }
            }
            EquationKind::When(_) => r.problems.push(error::initial_when(origin)),
            // Added to the assertions of the model under the condition `initial()`.
            EquationKind::Assert(_) => {}
        }
    }
    pre.resolve(r);
    for (v, value) in pre.varying {
        set_initial_pre(v, value, discrete, r);
    }
    equations
}

/// Replaces `pre(v)` during initialization by the value of an initial equation that depends on time
/// or variables.
fn set_initial_pre(
    v: VarId,
    value: ExprId,
    discrete: &mut DiscreteEquations,
    r: &mut Rewriting<'_>,
) {
    let initial = r.graph.intern(Node::Initial, Type::Boolean);
    for d in &mut discrete.list {
        let mut rewriter = crate::symbolic::rewrite::Rewriter::new();
        let at_start = rewriter.apply(r.graph, d.value, &mut |g, n| match g.node(n) {
            Node::Pre(w) if w == v => Some(value),
            _ => None,
        });
        d.value = r.graph.if_then_else(initial, at_start, d.value);
    }
}

/// Initial equations between `pre` values, such as `pre(a) = pre(b)`: one side takes the value of
/// the other.
#[derive(Default)]
struct PreEquations {
    /// Variables whose `pre` value is determined by other initial equations.
    given: FastSet<VarId>,
    open: Vec<(VarId, ExprId)>,
    /// Values that depend on time or on variables.
    varying: Vec<(VarId, ExprId)>,
}

impl PreEquations {
    /// Assigns values in an order in which each is known before it is used; without another value,
    /// the start value counts.
    fn resolve(&mut self, r: &mut Rewriting<'_>) {
        while !self.open.is_empty() {
            let known = |e: ExprId, pre: &PreEquations, r: &Rewriting<'_>| {
                pre_variables(e, r).iter().all(|w| pre.given.contains(w))
            };
            let mut place = None;
            for (k, &(v, e)) in self.open.iter().enumerate() {
                let other = match r.graph.node(e) {
                    Node::Pre(w) => Some(w),
                    _ => None,
                };
                if known(e, self, r) && !self.given.contains(&v) {
                    place = Some((k, v, e));
                } else if let Some(w) = other
                    && self.given.contains(&v)
                    && !self.given.contains(&w)
                {
                    let read = r.graph.pre(v, r.variables[v].ty);
                    place = Some((k, w, read));
                }
                if place.is_some() {
                    break;
                }
            }
            let (k, v, e) = place.unwrap_or((0, self.open[0].0, self.open[0].1));
            self.open.remove(k);
            if !self.given.insert(v) {
                continue;
            }
            let mut rewriter = crate::symbolic::rewrite::Rewriter::new();
            let variables = &*r.variables;
            let start = rewriter.apply(r.graph, e, &mut |g, n| match g.node(n) {
                Node::Pre(w) => Some(variables[w].start.unwrap_or_else(|| match g.ty(n) {
                    Type::Boolean => g.boolean(false),
                    Type::Integer => g.integer(0),
                    _ => g.real(0.0),
                })),
                _ => None,
            });
            r.variables[v].start = Some(start);
        }
    }
}

/// The variables whose `pre` values occur in an expression.
fn pre_variables(e: ExprId, r: &Rewriting<'_>) -> Vec<VarId> {
    let nodes = r.graph.postorder([e]);
    nodes
        .into_iter()
        .filter_map(|n| match r.graph.node(n) {
            Node::Pre(w) => Some(w),
            _ => None,
        })
        .collect()
}

/// True if the expression contains only `pre` values and parameters.
fn is_pre_expression(e: ExprId, r: &Rewriting<'_>) -> bool {
    r.graph.all([e], |_, node| match node {
        Node::Var(v) => r.variables[v].kind == VariableKind::Parameter,
        Node::Pre(_) | Node::Const(_) | Node::Unary(..) | Node::Binary(..) | Node::If(..) => true,
        _ => false,
    })
}

#[allow(clippy::too_many_arguments, reason = "the destinations of an equation")]
fn equal(
    a: ExprId,
    b: ExprId,
    origin: &Origin,
    discrete: &mut DiscreteEquations,
    equations: &mut Vec<dae::Equation>,
    pre: &mut PreEquations,
    r: &mut Rewriting<'_>,
) {
    let lhs = r.apply(a, RelationMode::Literal, origin);
    let rhs = r.apply(b, RelationMode::Literal, origin);
    for (side, value) in [(lhs, rhs), (rhs, lhs)] {
        let is_initial_parameter = |e| match r.graph.node(e) {
            Node::Var(w) => r.variables[w].kind == VariableKind::InitialParameter,
            _ => false,
        };
        match r.graph.node(side) {
            // A variable with a fixed start value determines a parameter with `fixed = false`.
            Node::Var(v) if r.variables[v].fixed == Some(true) && is_initial_parameter(value) => {}
            Node::Var(v) if r.variables[v].kind == VariableKind::Discrete => {
                return first_value(v, value, origin, discrete, r);
            }
            Node::Pre(v) if r.variability(value) <= Variability::Parameter => {
                let is_given = pre.given.contains(&v) || r.variables[v].fixed == Some(true);
                refuse_another(v, value, is_given, origin, r);
                r.variables[v].start = Some(value);
                pre.given.insert(v);
                return;
            }
            Node::Pre(v) if is_pre_expression(value, r) => {
                pre.open.push((v, value));
                return;
            }
            Node::Pre(v) if r.variables[v].kind == VariableKind::Discrete => {
                pre.varying.push((v, value));
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

/// Reports a first value that differs from the one that a variable has already.
fn refuse_another(v: VarId, value: ExprId, is_given: bool, origin: &Origin, r: &mut Rewriting<'_>) {
    let number = |e: ExprId| r.graph.as_const(e).map(Const::register);
    let known = r.variables[v].start.filter(|_| is_given).and_then(number);
    if let (Some(known), Some(value)) = (known, number(value))
        && known != value
    {
        r.problems.push(error::two_first_values(&r.variables[v], origin));
    }
}

fn first_value(
    v: VarId,
    value: ExprId,
    origin: &Origin,
    discrete: &mut DiscreteEquations,
    r: &mut Rewriting<'_>,
) {
    if r.variability(value) <= Variability::Parameter {
        let is_given = r.variables[v].fixed == Some(true);
        refuse_another(v, value, is_given, origin, r);
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
