//! Chains of `semiLinear` that share a flow, and flows that rest: Modelica 3.6, section 3.7.4.1.
//!
//! `y = semiLinear(x, a, s)` and `y = semiLinear(x, s, b)` do not determine `s` where `x` is 0. They
//! say the same as `s = if x >= 0 then a else b` and `y = semiLinear(x, a, b)`, which do.

use super::Equal;
use super::alias::Signed;
use super::event::Rewriting;
use crate::ir::expr::{Binary, ExprId, Node, Unary, VarId};

/// `y = ±semiLinear(x, positive, negative)`, in representatives.
struct Law {
    /// Its equation.
    place: usize,
    y: VarId,
    x: VarId,
    opposite: bool,
    positive: ExprId,
    negative: ExprId,
}

/// Joins chains; as many equations go out as come in.
pub fn join(equations: &mut [Equal], r: &mut Rewriting<'_>) {
    rest(equations, r);
    let mut laws: Vec<Law> =
        (0..equations.len()).filter_map(|k| law(&equations[k], k, r)).collect();
    while let Some((first, second)) = neighbours(&laws, r) {
        let (e, f) = (&laws[first], &laws[second]);
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
        let law = Law { positive: a, ..laws.remove(second) };
        let at = if second < first { first - 1 } else { first };
        laws[at] = law;
    }
}

/// Where nothing flows, `x = 0`, `y = 0` and `y = semiLinear(x, a, b)` leave `a` or `b` open: `a = b` is said in
/// place of the last.
fn rest(equations: &mut [Equal], r: &Rewriting<'_>) {
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

/// Two laws of one `y` and one `x` of which the first ends where the second begins.
fn neighbours(laws: &[Law], r: &Rewriting<'_>) -> Option<(usize, usize)> {
    for (i, e) in laws.iter().enumerate() {
        let Some(s) = signed(e.negative, r) else { continue };
        let same = |f: &Law| (f.y, f.x, f.opposite) == (e.y, e.x, e.opposite);
        let found = laws
            .iter()
            .enumerate()
            .find(|(j, f)| *j != i && same(f) && signed(f.positive, r) == Some(s));
        // What comes back to its beginning is no chain.
        if let Some((j, f)) = found
            && signed(f.negative, r) != Some(s)
            && signed(e.positive, r) != Some(s)
        {
            return Some((i, j));
        }
    }
    None
}

fn law(equation: &Equal, place: usize, r: &Rewriting<'_>) -> Option<Law> {
    [(equation.lhs, equation.rhs), (equation.rhs, equation.lhs)].into_iter().find_map(
        |(side, other)| {
            let y = signed(side, r)?;
            let (x, mut positive, mut negative) = semi_linear(other, r)?;
            // `semiLinear(-x, p, n) = -semiLinear(x, n, p)`
            if x.negative {
                std::mem::swap(&mut positive, &mut negative);
            }
            let opposite = y.negative ^ x.negative;
            Some(Law { place, y: y.variable, x: x.variable, opposite, positive, negative })
        },
    )
}

/// As [`parts`], where x is a variable.
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
