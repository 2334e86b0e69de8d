//! Chains of `semiLinear` that share a flow, and zero flows (Modelica 3.6, section 3.7.4.5).
//!
//! `y = semiLinear(x, a, s)` and `y = semiLinear(x, s, b)` do not determine `s` if `x` is 0. They
//! are equivalent to `s = if x >= 0 then a else b` and `y = semiLinear(x, a, b)`, which do.

use super::Equal;
use super::alias::Signed;
use super::rewriting::Rewriting;
use crate::ir::expr::{Binary, ExprId, Node, Unary, VarId};

/// `y = ±semiLinear(x, positive, negative)`, in representatives.
struct SemiLinearEquation {
    /// The position of the equation.
    place: usize,
    y: VarId,
    x: VarId,
    opposite: bool,
    positive: ExprId,
    negative: ExprId,
}

/// Merges chains; the number of equations does not change.
pub fn merge_chains(equations: &mut [Equal], r: &mut Rewriting<'_>) {
    resolve_zero_flow(equations, r);
    let mut found: Vec<SemiLinearEquation> =
        (0..equations.len()).filter_map(|k| semi_linear_equation(&equations[k], k, r)).collect();
    while let Some((first, second)) = adjacent(&found, r) {
        let (e, f) = (&found[first], &found[second]);
        let (a, s, b) = (e.positive, e.negative, f.negative);
        let x = r.graph.var(e.x, r.variables[e.x].ty);
        let y = r.graph.var(e.y, r.variables[e.y].ty);
        let zero = r.graph.real(0.0);
        let forward = r.graph.binary(Binary::GreaterEqual, x, zero);
        let (by_a, by_b) = (r.graph.mul(a, x), r.graph.mul(b, x));
        let mut joined = r.graph.if_then_else(forward, by_a, by_b);
        joined = r.graph.smooth(0, joined);
        if e.opposite {
            joined = r.graph.neg(joined);
        }
        let between = r.graph.if_then_else(forward, a, b);
        (equations[e.place].lhs, equations[e.place].rhs) = (s, between);
        (equations[f.place].lhs, equations[f.place].rhs) = (y, joined);
        let semi_linear_equation = SemiLinearEquation { positive: a, ..found.remove(second) };
        let at = if second < first { first - 1 } else { first };
        found[at] = semi_linear_equation;
    }
}

/// Without a flow, `x = 0`, `y = 0` and `y = semiLinear(x, a, b)` leave `a` or `b` undetermined:
/// replaces the last equation by `a = b`.
fn resolve_zero_flow(equations: &mut [Equal], r: &Rewriting<'_>) {
    let is_zero = |e: ExprId| match r.graph.node(e) {
        Node::Var(v) => r.is_zero(v),
        Node::Unary(Unary::Neg, a) => matches!(r.graph.node(a), Node::Var(v) if r.is_zero(v)),
        _ => r.graph.as_number(e) == Some(0.0),
    };
    for e in equations {
        for (side, other) in [(e.lhs, e.rhs), (e.rhs, e.lhs)] {
            if let Some((x, a, b)) = parts(other, r)
                && is_zero(side)
                && is_zero(x)
            {
                (e.lhs, e.rhs) = (a, b);
                break;
            }
        }
    }
}

/// Two equations with the same `y` and `x` where the first ends with the value that the second
/// starts with.
fn adjacent(found: &[SemiLinearEquation], r: &Rewriting<'_>) -> Option<(usize, usize)> {
    for (i, e) in found.iter().enumerate() {
        let Some(s) = signed(e.negative, r) else { continue };
        let same = |f: &SemiLinearEquation| (f.y, f.x, f.opposite) == (e.y, e.x, e.opposite);
        let found = found
            .iter()
            .enumerate()
            .find(|(j, f)| *j != i && same(f) && signed(f.positive, r) == Some(s));
        // A closed loop is not a chain.
        if let Some((j, f)) = found
            && signed(f.negative, r) != Some(s)
            && signed(e.positive, r) != Some(s)
        {
            return Some((i, j));
        }
    }
    None
}

fn semi_linear_equation(
    equation: &Equal,
    place: usize,
    r: &Rewriting<'_>,
) -> Option<SemiLinearEquation> {
    [(equation.lhs, equation.rhs), (equation.rhs, equation.lhs)].into_iter().find_map(
        |(side, other)| {
            let y = signed(side, r)?;
            let (x, mut positive, mut negative) = semi_linear(other, r)?;
            // `semiLinear(-x, p, n) = -semiLinear(x, n, p)`
            if x.negative {
                std::mem::swap(&mut positive, &mut negative);
            }
            let opposite = y.negative ^ x.negative;
            Some(SemiLinearEquation {
                place,
                y: y.variable,
                x: x.variable,
                opposite,
                positive,
                negative,
            })
        },
    )
}

/// Like [`parts`], where x is a variable.
fn semi_linear(e: ExprId, r: &Rewriting<'_>) -> Option<(Signed, ExprId, ExprId)> {
    let (x, p, n) = parts(e, r)?;
    Some((signed(x, r)?, p, n))
}

/// `if x >= 0 then p*x else n*x`: x, p and n.
fn parts(e: ExprId, r: &Rewriting<'_>) -> Option<(ExprId, ExprId, ExprId)> {
    let e = match r.graph.node(e) {
        Node::Smooth(_, inner) => inner,
        _ => e,
    };
    let Node::If(c, a, b) = r.graph.node(e) else { return None };
    let Node::Binary(Binary::GreaterEqual, x, zero) = r.graph.node(c) else { return None };
    if r.graph.as_number(zero) != Some(0.0) {
        return None;
    }
    let factor = |branch: ExprId| -> Option<ExprId> {
        let (product, x) = match (r.graph.node(branch), r.graph.node(x)) {
            (Node::Unary(Unary::Neg, product), Node::Unary(Unary::Neg, x)) => (product, x),
            _ => (branch, x),
        };
        match r.graph.node(product) {
            Node::Binary(Binary::Mul, p, q) if q == x => Some(p),
            Node::Binary(Binary::Mul, p, q) if p == x => Some(q),
            _ => None,
        }
    };
    Some((x, factor(a)?, factor(b)?))
}

/// A variable or its negative, as its representative.
fn signed(e: ExprId, r: &Rewriting<'_>) -> Option<Signed> {
    let (v, negative) = match r.graph.node(e) {
        Node::Var(v) => (v, false),
        Node::Unary(Unary::Neg, a) => match r.graph.node(a) {
            Node::Var(v) => (v, true),
            _ => return None,
        },
        _ => return None,
    };
    let s = r.representative(v)?;
    Some(Signed { variable: s.variable, negative: s.negative ^ negative })
}
