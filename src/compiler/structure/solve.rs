//! Solves an equation symbolically for one of its unknowns.

use crate::base::index::FastMap;
use crate::ir::blocks::Source;
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, Unary, VarId};
use crate::symbolic::eval;
use crate::symbolic::gradient::Leaf;
use crate::symbolic::linear;

/// The value of `v` by the equation, if the equation is linear in it with a coefficient that cannot
/// vanish during simulation.
pub fn explicit(dae: &mut Dae, source: Source, v: VarId) -> Option<ExprId> {
    let (lhs, rhs, residual) = match source {
        Source::Continuous(id) => {
            let e = &dae.equations[id];
            (e.lhs, e.rhs, e.residual)
        }
        Source::Initial(i) => {
            let e = &dae.initial[i];
            (e.lhs, e.rhs, e.residual)
        }
        Source::Discrete(i) => {
            let d = &dae.discrete[i];
            let (own, value) = (d.variable, d.value);
            let reads_itself = dae.graph.variables(value).contains(&own);
            return (own == v && !reads_itself).then_some(value);
        }
        Source::Start(own) => {
            let start = start(dae, own);
            return (own == v).then_some(start);
        }
    };
    // An equation already written as an assignment keeps its form.
    let is_v = |dae: &Dae, e| dae.graph.node(e) == Node::Var(v);
    for (side, other) in [(lhs, rhs), (rhs, lhs)] {
        if is_v(dae, side) && !dae.graph.variables(other).contains(&v) {
            return Some(other);
        }
    }
    // `a = b / v` becomes `v = b / a`, which needs no iteration.
    for (side, other) in [(lhs, rhs), (rhs, lhs)] {
        if let Node::Binary(Binary::Div, b, divisor) = dae.graph.node(side)
            && is_v(dae, divisor)
            && ![b, other].into_iter().any(|e| dae.graph.variables(e).contains(&v))
            && is_never_zero(dae, b)
        {
            return Some(dae.graph.div(b, other));
        }
    }
    let Some((coefficient, rest)) = linear::split(&mut dae.graph, residual, Leaf::Var(v)) else {
        return inverted(dae, lhs, rhs, v).or_else(|| inverted(dae, rhs, lhs, v));
    };
    if !is_never_zero(dae, coefficient) {
        return None;
    }
    if dae.graph.as_number(coefficient) == Some(-1.0) {
        return Some(rest);
    }
    if let Node::Unary(Unary::Neg, c) = dae.graph.node(coefficient) {
        return Some(dae.graph.div(rest, c));
    }
    let opposite = dae.graph.neg(rest);
    Some(dae.graph.div(opposite, coefficient))
}

/// The value of `v` by `side = other`, if `v` stands in one place of `side` alone, inside of logarithms and exponential
/// functions, sums, and products with what cannot vanish. The inverse functions exist for all values, or are refused
/// at run time as the functions are.
fn inverted(dae: &mut Dae, side: ExprId, other: ExprId, v: VarId) -> Option<ExprId> {
    let (mut side, mut value) = (side, other);
    let reads = |dae: &Dae, e: ExprId| dae.graph.any([e], |_, node| node == Node::Var(v));
    if reads(dae, other) {
        return None;
    }
    while dae.graph.node(side) != Node::Var(v) {
        (side, value) = match dae.graph.node(side) {
            Node::Unary(Unary::Log, a) => (a, dae.graph.unary(Unary::Exp, value)),
            Node::Unary(Unary::Exp, a) => (a, dae.graph.unary(Unary::Log, value)),
            Node::Unary(Unary::Log10, a) => {
                let ten = dae.graph.real(10.0);
                (a, dae.graph.pow(ten, value))
            }
            Node::Unary(Unary::Neg, a) => (a, dae.graph.neg(value)),
            Node::Binary(op, a, b) => match (op, reads(dae, a), reads(dae, b)) {
                (Binary::Add, true, false) => (a, dae.graph.sub(value, b)),
                (Binary::Add, false, true) => (b, dae.graph.sub(value, a)),
                (Binary::Sub, true, false) => (a, dae.graph.add(value, b)),
                (Binary::Sub, false, true) => (b, dae.graph.sub(a, value)),
                (Binary::Mul, true, false) if is_never_zero(dae, b) => (a, dae.graph.div(value, b)),
                (Binary::Mul, false, true) if is_never_zero(dae, a) => (b, dae.graph.div(value, a)),
                (Binary::Div, true, false) => (a, dae.graph.mul(value, b)),
                _ => return None,
            },
            _ => return None,
        };
    }
    Some(value)
}

/// The expression that must be zero.
pub fn residual(dae: &mut Dae, source: Source) -> ExprId {
    match source {
        Source::Continuous(id) => dae.equations[id].residual,
        Source::Initial(i) => dae.initial[i].residual,
        Source::Discrete(_) | Source::Start(_) => {
            let (own, value) = sides(dae, source);
            dae.graph.sub(own, value)
        }
    }
}

/// The two sides of an equation.
pub fn sides(dae: &mut Dae, source: Source) -> (ExprId, ExprId) {
    match source {
        Source::Continuous(id) => (dae.equations[id].lhs, dae.equations[id].rhs),
        Source::Initial(i) => (dae.initial[i].lhs, dae.initial[i].rhs),
        Source::Discrete(i) => {
            let (v, value) = (dae.discrete[i].variable, dae.discrete[i].value);
            (dae.graph.var(v, dae.variables[v].ty), value)
        }
        Source::Start(v) => {
            let start = start(dae, v);
            (dae.graph.var(v, dae.variables[v].ty), start)
        }
    }
}

/// The start value of a variable; zero if it has none.
pub fn start(dae: &mut Dae, v: VarId) -> ExprId {
    match dae.variables[v].start {
        Some(e) => e,
        None => match dae.variables[v].ty {
            Type::Integer => dae.graph.integer(0),
            Type::Boolean => dae.graph.boolean(false),
            _ => dae.graph.real(0.0),
        },
    }
}

/// True for expressions that are nonzero for all values of the variables: literals, parameters,
/// their products, and choices between these. Parameters are assumed to have values for which the
/// model is regular; those that are 0 in the source are assumed to be regular at 0.
pub fn is_never_zero(dae: &Dae, e: ExprId) -> bool {
    facts(dae, e).1
}

/// True if an expression depends only on parameters.
pub fn is_parameter_expression(dae: &Dae, e: ExprId) -> bool {
    facts(dae, e).0
}

fn is_zero_at_zero(graph: &Graph, function: Unary) -> bool {
    function.facts().is_some() && eval::unary(function, 0.0, graph.externals()) == 0.0
}

/// Whether an expression depends only on parameters, and whether it is never zero.
fn facts(dae: &Dae, e: ExprId) -> (bool, bool) {
    let g = &dae.graph;
    let mut facts: FastMap<ExprId, (bool, bool)> = FastMap::default();
    for node in g.postorder([e]) {
        let mut fixed = true;
        g.for_each_operand(node, |a| fixed &= facts[&a].0);
        let nonzero = |a: ExprId| facts[&a].1;
        let fact = match g.node(node) {
            Node::Const(c) => (true, c.number().is_some_and(|x| x != 0.0)),
            Node::Var(v) => {
                let kind = dae.variables[v].kind;
                let is_parameter =
                    matches!(kind, VariableKind::Parameter | VariableKind::InitialParameter);
                (is_parameter, is_parameter && !dae.variables[v].vanishes)
            }
            Node::Unary(Unary::Neg | Unary::Abs, a) => (fixed, nonzero(a)),
            Node::Binary(Binary::Mul, a, b) => (fixed, nonzero(a) && nonzero(b)),
            Node::Binary(Binary::Div, a, b) => (fixed, nonzero(a) && facts[&b].0),
            Node::If(_, a, b) => (fixed, nonzero(a) && nonzero(b)),
            // The operand of a function that is zero at zero, such as that of `sin`.
            Node::Unary(function, a) if is_zero_at_zero(g, function) => (fixed, nonzero(a)),
            Node::Binary(Binary::Pow, a, _) => (fixed, nonzero(a)),
            Node::Unary(..) | Node::Binary(..) | Node::Call { .. } => (fixed, fixed),
            _ => (false, false),
        };
        facts.insert(node, fact);
    }
    facts[&e]
}
