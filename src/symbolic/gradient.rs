//! Exact derivatives by reverse accumulation on the expression graph (Griewank & Walther,
//! *Evaluating Derivatives*, 2nd ed., ch. 3): one sweep gives the partials by every variable.

use crate::base::index::FastMap;
use crate::ir::expr::{Binary, Carried, ExprId, Graph, Node, Type, Unary, VarId};

/// A leaf that an expression can be differentiated by.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Leaf {
    /// `time`
    Time,
    /// A variable.
    Var(VarId),
    /// `der(v)`
    Der(VarId),
    /// What a recording says about an input: its derivative of this order.
    Recorded(VarId, u32),
}

/// The partial derivatives of `root` by each leaf below it for which `wanted` holds, in order of
/// leaf. Structurally zero partials are left out. Relations, `pre` and integer-valued functions
/// have derivative zero. Function calls have none here: `lower` inlines what must be
/// differentiated, and codegen differentiates the rest by directional derivatives.
pub fn gradient(
    graph: &mut Graph,
    root: ExprId,
    wanted: impl Fn(Leaf) -> bool,
) -> Vec<(Leaf, ExprId)> {
    let order = graph.postorder([root]);
    let mut depends: FastMap<ExprId, bool> = FastMap::default();
    for &e in &order {
        // What recordings say about inputs is given.
        let mut d = leaf(graph, e).is_some_and(|l| !matches!(l, Leaf::Recorded(..)) && wanted(l));
        graph.for_each_operand(e, |a| d |= depends[&a]);
        depends.insert(e, d);
    }
    let mut adjoint: FastMap<ExprId, ExprId> = FastMap::default();
    let one = graph.real(1.0);
    adjoint.insert(root, one);
    let mut result = Vec::new();
    for &e in order.iter().rev() {
        if !depends[&e] {
            continue;
        }
        let Some(&seed) = adjoint.get(&e) else { continue };
        if let Some(l) = leaf(graph, e) {
            if graph.as_number(seed) != Some(0.0) {
                result.push((l, seed));
            }
            continue;
        }
        for (operand, partial) in partials(graph, e, seed) {
            if depends[&operand] {
                let total = match adjoint.get(&operand) {
                    Some(&so_far) => graph.add(so_far, partial),
                    None => partial,
                };
                adjoint.insert(operand, total);
            }
        }
    }
    result.sort_by_key(|(l, _)| *l);
    result
}

fn leaf(graph: &Graph, e: ExprId) -> Option<Leaf> {
    match graph.node(e) {
        Node::Time => Some(Leaf::Time),
        Node::Var(v) => Some(Leaf::Var(v)),
        Node::Der(v) => Some(Leaf::Der(v)),
        Node::Recorded(v, order) => Some(Leaf::Recorded(v, order)),
        _ => None,
    }
}

/// `seed * d e / d operand` for each operand that has one.
fn partials(g: &mut Graph, e: ExprId, seed: ExprId) -> Vec<(ExprId, ExprId)> {
    match g.node(e) {
        Node::Unary(op, a) => match unary_partial(g, op, a, e) {
            Some(d) => vec![(a, g.mul(seed, d))],
            None => vec![],
        },
        Node::Binary(op, a, b) => binary_partials(g, op, a, b, e, seed),
        Node::If(c, a, b) => {
            let zero = g.real(0.0);
            let when_true = g.if_then_else(c, seed, zero);
            let when_false = g.if_then_else(c, zero, seed);
            vec![(a, when_true), (b, when_false)]
        }
        // Derivatives of relations never count, so what `noEvent` guards needs no guard here
        // except that conditions inside stay literal.
        Node::NoEvent(a) | Node::Smooth(_, a) => vec![(a, seed)],
        Node::Homotopy(a, _) => vec![(a, seed)],
        _ => vec![],
    }
}

fn unary_partial(g: &mut Graph, op: Unary, a: ExprId, e: ExprId) -> Option<ExprId> {
    let one = g.real(1.0);
    Some(match op {
        Unary::Neg => g.real(-1.0),
        Unary::Sin => g.unary(Unary::Cos, a),
        Unary::Cos => {
            let s = g.unary(Unary::Sin, a);
            g.neg(s)
        }
        Unary::Tan => {
            let square = g.mul(e, e);
            g.add(one, square)
        }
        Unary::Asin | Unary::Acos => {
            let square = g.mul(a, a);
            let rest = g.sub(one, square);
            let root = g.unary(Unary::Sqrt, rest);
            let d = g.div(one, root);
            if op == Unary::Asin { d } else { g.neg(d) }
        }
        Unary::Atan => {
            let square = g.mul(a, a);
            let sum = g.add(one, square);
            g.div(one, sum)
        }
        Unary::Sinh => g.unary(Unary::Cosh, a),
        Unary::Cosh => g.unary(Unary::Sinh, a),
        Unary::Tanh => {
            let square = g.mul(e, e);
            g.sub(one, square)
        }
        Unary::Exp => e,
        Unary::Log => g.div(one, a),
        Unary::Log10 => {
            let factor = g.real(std::f64::consts::LOG10_E);
            g.div(factor, a)
        }
        Unary::Sqrt => {
            let half = g.real(0.5);
            g.div(half, e)
        }
        Unary::Abs => g.unary(Unary::Sign, a),
        Unary::Not
        | Unary::Sign
        | Unary::Floor
        | Unary::Ceil
        | Unary::ToInteger
        | Unary::Ordinal
        | Unary::Text(_) => return None,
        Unary::Native(f) => {
            let derivative = f.derivative(0)?;
            g.unary(Unary::Native(derivative), a)
        }
        Unary::Carried(what) => {
            let order = what.order.saturating_add(1);
            g.unary(Unary::Carried(Carried { order, ..what }), a)
        }
    })
}

fn binary_partials(
    g: &mut Graph,
    op: Binary,
    a: ExprId,
    b: ExprId,
    e: ExprId,
    seed: ExprId,
) -> Vec<(ExprId, ExprId)> {
    match op {
        Binary::Add => vec![(a, seed), (b, seed)],
        Binary::Sub => {
            let minus = g.neg(seed);
            vec![(a, seed), (b, minus)]
        }
        Binary::Mul => {
            let by_a = g.mul(seed, b);
            let by_b = g.mul(seed, a);
            vec![(a, by_a), (b, by_b)]
        }
        Binary::Div => {
            let by_a = g.div(seed, b);
            let product = g.mul(by_a, e);
            let by_b = g.neg(product);
            vec![(a, by_a), (b, by_b)]
        }
        Binary::Pow => power_partials(g, a, b, e, seed),
        Binary::Atan2 => {
            let aa = g.mul(a, a);
            let bb = g.mul(b, b);
            let sum = g.add(aa, bb);
            let scaled = g.div(seed, sum);
            let by_a = g.mul(scaled, b);
            let product = g.mul(scaled, a);
            let by_b = g.neg(product);
            vec![(a, by_a), (b, by_b)]
        }
        Binary::Min | Binary::Max => {
            let c = chosen(g, op, a, b);
            let zero = g.real(0.0);
            let by_a = g.if_then_else(c, seed, zero);
            let by_b = g.if_then_else(c, zero, seed);
            vec![(a, by_a), (b, by_b)]
        }
        // a - floor(a/b)*b and a - trunc(a/b)*b: the quotient is piecewise constant.
        Binary::Mod | Binary::Rem => {
            let diff = g.sub(a, e);
            let quotient = g.div(diff, b);
            let product = g.mul(seed, quotient);
            let by_b = g.neg(product);
            vec![(a, seed), (b, by_b)]
        }
        Binary::Native(f) => {
            let mut by = Vec::new();
            for (k, operand) in [a, b].into_iter().enumerate() {
                if let Some(derivative) = f.derivative(k) {
                    let d = g.binary(Binary::Native(derivative), a, b);
                    by.push((operand, g.mul(seed, d)));
                }
            }
            by
        }
        _ => vec![],
    }
}

/// `d(a^b)`: by the exponent only where it is not a literal, so that `x^2` needs no logarithm.
fn power_partials(
    g: &mut Graph,
    a: ExprId,
    b: ExprId,
    e: ExprId,
    seed: ExprId,
) -> Vec<(ExprId, ExprId)> {
    let one = g.real(1.0);
    let less = g.sub(b, one);
    let lower = g.pow(a, less);
    let scaled = g.mul(b, lower);
    let by_a = g.mul(seed, scaled);
    if g.as_number(b).is_some() {
        return vec![(a, by_a)];
    }
    let log = g.unary(Unary::Log, a);
    let product = g.mul(e, log);
    let by_b = g.mul(seed, product);
    vec![(a, by_a), (b, by_b)]
}

/// The total derivative by time. `rate` gives the derivative of a variable, `None` for what is constant
/// in time.
pub fn time_derivative(
    graph: &mut Graph,
    root: ExprId,
    mut rate: impl FnMut(&mut Graph, Leaf) -> Option<ExprId>,
) -> ExprId {
    let one = graph.real(1.0);
    forward_derivative(graph, root, |graph, leaf| match leaf {
        Leaf::Time => Some(one),
        Leaf::Recorded(v, order) => Some(graph.intern(Node::Recorded(v, order + 1), Type::Real)),
        leaf => rate(graph, leaf),
    })
}

/// The derivative along a direction, of which `rate` gives the components, `None` for zero. Forward
/// accumulation: an alternative is differentiated branch by branch, so that what is infinite in the
/// branch not taken does not spoil the other.
pub fn forward_derivative(
    graph: &mut Graph,
    root: ExprId,
    mut rate: impl FnMut(&mut Graph, Leaf) -> Option<ExprId>,
) -> ExprId {
    let mut rates: FastMap<ExprId, Option<ExprId>> = FastMap::default();
    let one = graph.real(1.0);
    for e in graph.postorder([root]) {
        let d = match graph.node(e) {
            Node::Time | Node::Var(_) | Node::Der(_) | Node::Recorded(..) => {
                leaf(graph, e).and_then(|l| rate(graph, l))
            }
            Node::NoEvent(a) | Node::Smooth(_, a) | Node::Homotopy(a, _) => rates[&a],
            Node::If(c, a, b) => alternative(graph, c, rates[&a], rates[&b]),
            Node::Binary(op @ (Binary::Min | Binary::Max), a, b) => {
                let c = chosen(graph, op, a, b);
                alternative(graph, c, rates[&a], rates[&b])
            }
            _ => {
                let mut terms = Vec::new();
                for (operand, partial) in partials(graph, e, one) {
                    if let Some(r) = rates[&operand] {
                        terms.push(graph.mul(partial, r));
                    }
                }
                if terms.is_empty() { None } else { Some(graph.sum(terms)) }
            }
        };
        rates.insert(e, d);
    }
    rates[&root].unwrap_or_else(|| graph.real(0.0))
}

fn alternative(g: &mut Graph, c: ExprId, a: Option<ExprId>, b: Option<ExprId>) -> Option<ExprId> {
    if a.is_none() && b.is_none() {
        return None;
    }
    let zero = g.real(0.0);
    Some(g.if_then_else(c, a.unwrap_or(zero), b.unwrap_or(zero)))
}

/// Whether `min` or `max` is its first operand.
fn chosen(g: &mut Graph, op: Binary, a: ExprId, b: ExprId) -> ExprId {
    let relation = if op == Binary::Min { Binary::LessEqual } else { Binary::GreaterEqual };
    let c = g.binary(relation, a, b);
    g.no_event(c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symbolic::eval;

    /// Evaluates an expression of `x = Var(0)` alone.
    fn value(g: &Graph, root: ExprId, x: f64) -> f64 {
        let mut v: FastMap<ExprId, f64> = FastMap::default();
        for e in g.postorder([root]) {
            let y = match g.node(e) {
                Node::Const(c) => c.register(),
                Node::Var(_) => x,
                Node::Unary(op, a) => eval::unary(op, v[&a]),
                Node::Binary(op, a, b) => eval::binary(op, v[&a], v[&b]),
                Node::If(c, a, b) => {
                    if v[&c] != 0.0 {
                        v[&a]
                    } else {
                        v[&b]
                    }
                }
                Node::NoEvent(a) => v[&a],
                other => panic!("{other:?}"),
            };
            v.insert(e, y);
        }
        v[&root]
    }

    #[test]
    fn every_function_agrees_with_central_differences() {
        let mut g = Graph::new();
        let x = g.var(VarId(0), Type::Real);
        let c = g.real(0.7);
        let mut cases = Vec::new();
        for op in [
            Unary::Neg,
            Unary::Sin,
            Unary::Cos,
            Unary::Tan,
            Unary::Asin,
            Unary::Acos,
            Unary::Atan,
            Unary::Sinh,
            Unary::Cosh,
            Unary::Tanh,
            Unary::Exp,
            Unary::Log,
            Unary::Log10,
            Unary::Sqrt,
            Unary::Abs,
        ] {
            cases.push(g.unary(op, x));
        }
        for op in [
            Binary::Add,
            Binary::Sub,
            Binary::Mul,
            Binary::Div,
            Binary::Pow,
            Binary::Atan2,
            Binary::Min,
            Binary::Max,
            Binary::Mod,
            Binary::Rem,
        ] {
            cases.push(g.binary(op, x, c));
            cases.push(g.binary(op, c, x));
        }
        let (x0, h) = (0.43, 1e-6);
        for e in cases {
            let d = gradient(&mut g, e, |_| true);
            let exact = d.first().map_or(0.0, |(_, d)| value(&g, *d, x0));
            let difference = (value(&g, e, x0 + h) - value(&g, e, x0 - h)) / (2.0 * h);
            assert!((exact - difference).abs() < 1e-8 * (1.0 + exact.abs()), "{:?}", g.node(e));
        }
    }

    #[test]
    fn what_is_infinite_in_the_branch_not_taken_does_not_spoil_the_rate() {
        let mut g = Graph::new();
        let x = g.var(VarId(0), Type::Real);
        let zero = g.real(0.0);
        let c = g.binary(Binary::Greater, x, zero);
        let root = g.unary(Unary::Sqrt, x);
        let e = g.if_then_else(c, root, x);
        let one = g.real(1.0);
        let d = time_derivative(&mut g, e, |_, _| Some(one));
        assert_eq!(value(&g, d, 0.0), 1.0);
        assert_eq!(value(&g, d, 4.0), 0.25);
    }
}
