//! Initial equations (Modelica 3.6, section 8.6).

use super::rewriting::{RelationMode, Rewriting};
use super::{DiscreteEquations, error};
use crate::base::index::{FastSet, IndexVec};
use crate::ir::dae::{self, VariableKind};
use crate::ir::expr::{Const, ExprId, Node, Type, VarId};
use crate::ir::flat::{Equation, EquationKind, Origin, Variability, Variable};
use crate::symbolic::gradient::Leaf;
use crate::symbolic::linear;
use crate::symbolic::rewrite::Rewriter;

/// The initial equations of continuous variables and parameters. An equation for the first value of
/// a discrete variable becomes part of that variable's equation, under the condition `initial()`.
pub fn equations(
    (flat, variables): (&[Equation], &IndexVec<VarId, Variable>),
    discrete: &mut DiscreteEquations,
    r: &mut Rewriting<'_>,
) -> Vec<dae::Equation> {
    let mut equations = Vec::new();
    let mut pre = PreEquations::default();
    starts_by_initialization(variables, &mut pre, r);
    for equation in flat {
        let origin = &equation.origin;
        match &equation.kind {
            EquationKind::Equal(a, b) => {
                equal((*a, *b), origin, (discrete, &mut equations, &mut pre), variables, r);
            }
            EquationKind::Algorithm { outputs, values } => {
                for (v, value) in outputs.iter().zip(values) {
                    let lhs = r.graph.var(*v, r.variables[*v].ty);
                    let destinations = (&mut *discrete, &mut equations, &mut pre);
                    equal((lhs, *value), origin, destinations, variables, r);
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
        let mut rewriter = Rewriter::new();
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
    /// Takes a value that depends on time or on variables, unless the variable has another one.
    fn vary(&mut self, v: VarId, value: ExprId, origin: &Origin, r: &mut Rewriting<'_>) {
        match self.varying.iter().find(|(w, _)| *w == v) {
            Some((_, known)) if *known == value => {}
            None if !self.given.contains(&v) => self.varying.push((v, value)),
            _ => r.problems.push(error::two_first_values(&r.variables[v], origin)),
        }
    }

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
            let mut rewriter = Rewriter::new();
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

/// Where an initial equation goes: to the equation of a discrete variable, to those of continuous ones, or to those of
/// `pre` values.
type Destinations<'a> =
    (&'a mut DiscreteEquations, &'a mut Vec<dae::Equation>, &'a mut PreEquations);

fn equal(
    (a, b): (ExprId, ExprId),
    origin: &Origin,
    (discrete, equations, pre): Destinations<'_>,
    variables: &IndexVec<VarId, Variable>,
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
            Node::Pre(v)
                if r.variability(value) <= Variability::Parameter
                    && !is_found_by_initialization(value, variables, r) =>
            {
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
                pre.vary(v, value, origin, r);
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
    if let Some((v, value)) = solved_for_pre(residual, r) {
        pre.vary(v, value, origin, r);
        return;
    }
    let origin = origin.clone();
    equations.push(dae::Equation { lhs, rhs, residual, origin, derivative_of: None });
}

/// The discrete variable whose `pre` value occurs in a residual, alone of its kind and linearly, with the value that makes
/// the residual zero.
fn solved_for_pre(residual: ExprId, r: &mut Rewriting<'_>) -> Option<(VarId, ExprId)> {
    let mut of_pre = pre_variables(residual, r);
    of_pre.dedup();
    let [v] = of_pre[..] else { return None };
    let is_named = r.graph.variables(residual).contains(&v);
    if is_named || r.variables[v].kind != VariableKind::Discrete {
        return None;
    }
    let own = r.graph.var(v, r.variables[v].ty);
    let named = Rewriter::new().apply(r.graph, residual, &mut |g, n| match g.node(n) {
        Node::Pre(_) => Some(own),
        _ => None,
    });
    let (coefficient, rest) = linear::split(r.graph, named, Leaf::Var(v))?;
    r.graph.as_number(coefficient).filter(|c| *c != 0.0)?;
    let quotient = r.graph.div(rest, coefficient);
    Some((v, r.graph.neg(quotient)))
}

/// Fixed starts of discrete variables that parameters with `fixed = false` determine: their `pre` values are found by the
/// initialization, too.
fn starts_by_initialization(
    variables: &IndexVec<VarId, Variable>,
    pre: &mut PreEquations,
    r: &Rewriting<'_>,
) {
    for (v, x) in r.variables.enumerate() {
        let is_fixed = x.kind == VariableKind::Discrete && x.fixed == Some(true);
        let start = x.start.filter(|_| is_fixed);
        let by_initialization = start.filter(|e| is_found_by_initialization(*e, variables, r));
        pre.varying.extend(by_initialization.map(|start| (v, start)));
    }
}

/// True if an expression depends on a parameter with `fixed = false`, also through other parameters.
fn is_found_by_initialization(
    e: ExprId,
    variables: &IndexVec<VarId, Variable>,
    r: &Rewriting<'_>,
) -> bool {
    let mut seen: FastSet<VarId> = FastSet::default();
    let mut open = vec![e];
    while let Some(e) = open.pop() {
        for v in r.graph.variables(e) {
            if r.variables[v].kind == VariableKind::InitialParameter {
                return true;
            }
            let x = variables.get(v).filter(|x| x.variability <= Variability::Parameter);
            if let Some(bound) = x.and_then(|x| x.binding).filter(|_| seen.insert(v)) {
                open.push(bound);
            }
        }
    }
    false
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
