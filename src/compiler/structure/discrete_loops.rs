//! Discrete variables that only refer to each other: `a = b; b = a`, or `n = m + 1; m = n - 1`.
//!
//! In: the discrete equations. Out: an error for each circle of equations that says no more than that
//! a variable equals itself, so that its value is whatever it starts with; a warning if nothing else
//! reads the variables.

use super::error::{self, Consequence};
use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet};
use crate::ir::blocks::Source;
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::symbolic::eval;
use crate::symbolic::rewrite::Rewriter;

/// Equations in a circle that are followed.
const MAX_LENGTH: usize = 64;
/// Larger expressions are not followed.
const MAX_NODES: usize = 20;

/// Reports circles of discrete equations that determine nothing.
pub fn report(dae: &mut Dae, problems: &mut Problems) {
    let equation: FastMap<VarId, usize> =
        dae.discrete.iter().enumerate().map(|(k, d)| (d.variable, k)).collect();
    let mut met: FastSet<VarId> = FastSet::default();
    for k in 0..dae.discrete.len() {
        if met.contains(&dae.discrete[k].variable) {
            continue;
        }
        let Some(circle) = circle(dae, &equation, k) else { continue };
        met.extend(circle.iter().map(|k| dae.discrete[*k].variable));
        let members: Vec<VarId> = circle.iter().map(|k| dae.discrete[*k].variable).collect();
        let sources: Vec<Source> = circle.iter().copied().map(Source::Discrete).collect();
        let consequence = match is_read(dae, &circle, &members) {
            true => Consequence::Arbitrary,
            false => Consequence::None,
        };
        problems.push(error::dependent_block(dae, &sources, &members, consequence));
    }
}

/// The equations that lead from a variable back to itself and nothing else, if they do.
fn circle(dae: &mut Dae, equation: &FastMap<VarId, usize>, first: usize) -> Option<Vec<usize>> {
    let own = dae.discrete[first].variable;
    let mut circle = vec![first];
    let mut at = dae.discrete[first].value;
    while circle.len() <= MAX_LENGTH {
        let nodes = dae.graph.postorder([at]);
        let reads = |node: &ExprId| match dae.graph.node(*node) {
            Node::Var(v) => Some(Some(v)),
            Node::Const(_) | Node::Unary(..) | Node::Binary(..) => None,
            // Time, `pre`, relations and calls are known or have a value of their own.
            _ => Some(None),
        };
        let mut read = nodes.iter().filter_map(reads);
        let (Some(Some(v)), None) = (read.next(), read.next()) else { return None };
        if nodes.len() > MAX_NODES {
            return None;
        }
        if v == own {
            return is_open(dae, at, own).then_some(circle);
        }
        let next = *equation.get(&v).filter(|k| !circle.contains(k))?;
        let value = dae.discrete[next].value;
        at = Rewriter::new().apply(&mut dae.graph, at, &mut |graph, e| {
            (graph.node(e) == Node::Var(v)).then_some(value)
        });
        circle.push(next);
    }
    None
}

/// True if more than one value of the variable equals an expression that reads nothing else.
fn is_open(dae: &Dae, root: ExprId, own: VarId) -> bool {
    let candidates: &[f64] = match dae.variables[own].ty {
        Type::Boolean => &[0.0, 1.0],
        _ => &[0.0, 1.0, 2.0, 7.0, -3.0],
    };
    let graph = &dae.graph;
    let solves = |x: &&f64| {
        let mut values: FastMap<ExprId, f64> = FastMap::default();
        for e in graph.postorder([root]) {
            let of = |a: &ExprId| values.get(a).copied().unwrap_or(f64::NAN);
            let value = match graph.node(e) {
                Node::Const(c) => c.register(),
                Node::Var(_) => **x,
                Node::Unary(op, a) => eval::unary(op, of(&a), graph.externals()),
                Node::Binary(op, a, b) => eval::binary(op, of(&a), of(&b), graph.externals()),
                _ => f64::NAN,
            };
            values.insert(e, value);
        }
        values[&root] == **x
    };
    candidates.iter().filter(solves).count() > 1
}

/// True if something other than the circle reads one of its variables.
fn is_read(dae: &Dae, circle: &[usize], members: &[VarId]) -> bool {
    let others = dae.discrete.iter().enumerate().filter(|(k, _)| !circle.contains(k));
    let mut roots: Vec<ExprId> = others.map(|(_, d)| d.value).collect();
    roots.extend(dae.equations.iter().map(|e| e.residual));
    roots.extend(dae.relations.iter().flat_map(|r| [r.lhs, r.rhs]));
    roots.extend(dae.reinits.iter().map(|r| r.value));
    roots.extend(dae.asserts.iter().map(|a| a.assert.condition));
    dae.graph.any(roots, |_, node| matches!(node, Node::Var(v) if members.contains(&v)))
}
