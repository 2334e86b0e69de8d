//! Exact derivatives by reverse accumulation on the expression graph (Griewank & Walther,
//! *Evaluating Derivatives*, 2nd ed., ch. 3): one sweep gives the partials by every variable.

use super::arithmetic::Arithmetic;
use crate::base::index::FastMap;
use crate::ir::builtin::{binary_builtins, unary_builtins};
use crate::ir::expr::{Binary, Carried, ExprId, FunctionId, Graph, Node, Type, Unary, VarId};

/// A leaf that an expression can be differentiated by.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Leaf {
    /// `time`
    Time,
    /// A variable.
    Var(VarId),
    /// `der(v)`
    Der(VarId),
    /// The recorded derivative of an input of this order.
    Recorded(VarId, u32),
}

/// The partial derivatives of `root` by each leaf below it for which `wanted` holds, in order of
/// leaf. Structurally zero partials are left out. Relations, `pre` and integer-valued functions
/// have derivative zero. Function calls have none here: `structure` inlines what must be
/// differentiated, and codegen has functions for the derivatives of the others.
pub fn gradient(
    graph: &mut Graph,
    root: ExprId,
    wanted: impl Fn(Leaf) -> bool,
) -> Vec<(Leaf, ExprId)> {
    gradient_by(graph, root, &wanted)
}

/// The same, compiled once and not for each `wanted`.
fn gradient_by(
    graph: &mut Graph,
    root: ExprId,
    wanted: &dyn Fn(Leaf) -> bool,
) -> Vec<(Leaf, ExprId)> {
    let order = graph.postorder([root]);
    let mut depends: FastMap<ExprId, bool> = FastMap::default();
    for &e in &order {
        // Recorded inputs are given.
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
pub fn partials(g: &mut Graph, e: ExprId, seed: ExprId) -> Vec<(ExprId, ExprId)> {
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

fn unary_partial(graph: &mut Graph, op: Unary, x: ExprId, value: ExprId) -> Option<ExprId> {
    macro_rules! derivative {
        (($a:ident, $y:ident, $g:ident) $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slope:expr })*) => {
            match op {
                $(Unary::$op => {
                    #[allow(unused_variables)]
                    let ($a, $y, $g) = (x, value, graph);
                    $slope
                })*
                Unary::Text(_) => None,
                Unary::External(f) => {
                    let derivative = graph.external_derivative(f, 0)?;
                    Some(graph.unary(Unary::External(derivative), x))
                }
                Unary::Carried(what) => {
                    let order = what.order.saturating_add(1);
                    Some(graph.unary(Unary::Carried(Carried { order, ..what }), x))
                }
            }
        };
    }
    unary_builtins!(derivative)
}

fn binary_partials(
    graph: &mut Graph,
    op: Binary,
    x: ExprId,
    y: ExprId,
    value: ExprId,
    around: ExprId,
) -> Vec<(ExprId, ExprId)> {
    macro_rules! derivatives {
        (($a:ident, $b:ident, $y:ident, $g:ident, $seed:ident)
         $($(#[$doc:meta])* $op:ident { $facts:tt $value:expr; $slopes:expr; $chain:expr })*) => {
            match op {
                $(Binary::$op => {
                    #[allow(unused_variables)]
                    let ($a, $b, $y, $g, $seed) = (x, y, value, graph, around);
                    $chain
                })*
                Binary::External(f) => [0, 1].map(|k| {
                    let derivative = graph.external_derivative(f, k)?;
                    let d = graph.binary(Binary::External(derivative), x, y);
                    Some(graph.mul(around, d))
                }),
            }
        };
    }
    let by: [Option<ExprId>; 2] = binary_builtins!(derivatives);
    [x, y].into_iter().zip(by).filter_map(|(operand, d)| Some((operand, d?))).collect()
}

/// The chain rule for `y = a / b`.
fn divided(g: &mut Graph, b: ExprId, y: ExprId, seed: ExprId) -> [Option<ExprId>; 2] {
    let by_a = g.div(seed, b);
    let product = g.mul(by_a, y);
    [Some(by_a), Some(g.neg(product))]
}

/// The chain rule for `y = a ^ b`: by the exponent only where it is not a literal, so that `x ^ 2` needs no
/// logarithm.
fn power_chain(
    g: &mut Graph,
    a: ExprId,
    b: ExprId,
    y: ExprId,
    seed: ExprId,
) -> [Option<ExprId>; 2] {
    let one = g.real(1.0);
    let less = g.sub(b, one);
    let lower = g.pow(a, less);
    let scaled = g.mul(b, lower);
    let by_a = g.mul(seed, scaled);
    if g.as_number(b).is_some() {
        return [Some(by_a), None];
    }
    let log = g.unary(Unary::Log, a);
    let product = g.mul(y, log);
    [Some(by_a), Some(g.mul(seed, product))]
}

/// The chain rule for `atan2(a, b)`.
fn angle(g: &mut Graph, a: ExprId, b: ExprId, seed: ExprId) -> [Option<ExprId>; 2] {
    let aa = g.mul(a, a);
    let bb = g.mul(b, b);
    let sum = g.add(aa, bb);
    let scaled = g.div(seed, sum);
    let by_a = g.mul(scaled, b);
    let product = g.mul(scaled, a);
    [Some(by_a), Some(g.neg(product))]
}

/// The chain rule for `min` and `max`, which are `a` where `relation` holds.
fn chosen(
    g: &mut Graph,
    relation: Binary,
    a: ExprId,
    b: ExprId,
    seed: ExprId,
) -> [Option<ExprId>; 2] {
    let c = first_chosen(g, relation, a, b);
    let zero = g.real(0.0);
    let by_a = g.if_then_else(c, seed, zero);
    [Some(by_a), Some(g.if_then_else(c, zero, seed))]
}

/// The chain rule for `y = a - q * b`, where `q` is constant between jumps.
fn remainder(g: &mut Graph, a: ExprId, b: ExprId, y: ExprId, seed: ExprId) -> [Option<ExprId>; 2] {
    let difference = g.sub(a, y);
    let quotient = g.div(difference, b);
    let product = g.mul(seed, quotient);
    [Some(seed), Some(g.neg(product))]
}

/// The total derivative by time. `rate` gives the derivative of a variable, `None` if it is constant
/// in time.
pub fn time_derivative(
    graph: &mut Graph,
    root: ExprId,
    rate: impl FnMut(&mut Graph, Leaf) -> Option<ExprId>,
) -> ExprId {
    time_derivative_through(graph, root, rate, |_, _| None)
}

/// As [`time_derivative`], with derivatives of calls.
pub fn time_derivative_through(
    graph: &mut Graph,
    root: ExprId,
    mut rate: impl FnMut(&mut Graph, Leaf) -> Option<ExprId>,
    call: impl FnMut(&mut Graph, &CallRate<'_>) -> Option<ExprId>,
) -> ExprId {
    let one = graph.real(1.0);
    let of_leaf = |graph: &mut Graph, leaf| match leaf {
        Leaf::Time => Some(one),
        Leaf::Recorded(v, order) => Some(graph.intern(Node::Recorded(v, order + 1), Type::Real)),
        leaf => rate(graph, leaf),
    };
    forward_derivative_through(graph, root, of_leaf, call)
}

/// A call whose derivative along a direction is wanted.
pub struct CallRate<'a> {
    /// The function.
    pub function: FunctionId,
    /// Which of its outputs.
    pub output: u32,
    /// Its arguments.
    pub args: &'a [ExprId],
    /// The derivatives of the arguments, `None` for zero.
    pub rates: &'a [Option<ExprId>],
}

/// The derivative along a direction, of which `rate` gives the components, `None` for zero. Forward
/// accumulation: an alternative is differentiated branch by branch, so that an infinite derivative in the
/// branch not taken does not spoil the other.
pub fn forward_derivative(
    graph: &mut Graph,
    root: ExprId,
    rate: impl FnMut(&mut Graph, Leaf) -> Option<ExprId>,
) -> ExprId {
    forward_derivative_through(graph, root, rate, |_, _| None)
}

/// As [`forward_derivative`], with derivatives of calls.
pub fn forward_derivative_through(
    graph: &mut Graph,
    root: ExprId,
    mut rate: impl FnMut(&mut Graph, Leaf) -> Option<ExprId>,
    mut call: impl FnMut(&mut Graph, &CallRate<'_>) -> Option<ExprId>,
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
            Node::Call { function, output, args } => {
                let args = graph.list(args).to_vec();
                let rates: Vec<Option<ExprId>> = args.iter().map(|a| rates[a]).collect();
                call(graph, &CallRate { function, output, args: &args, rates: &rates })
            }
            Node::Binary(op @ (Binary::Min | Binary::Max), a, b) => {
                let least = op == Binary::Min;
                let relation = if least { Binary::LessEqual } else { Binary::GreaterEqual };
                let c = first_chosen(graph, relation, a, b);
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

/// Whether `min` or `max` is its first operand, which is so where `relation` holds.
fn first_chosen(g: &mut Graph, relation: Binary, a: ExprId, b: ExprId) -> ExprId {
    let c = g.binary(relation, a, b);
    g.no_event(c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::external::Externals;
    use crate::symbolic::{eval, partial};

    /// Evaluates an expression of `x = Var(0)` alone.
    fn value(g: &Graph, root: ExprId, x: f64) -> f64 {
        let mut v: FastMap<ExprId, f64> = FastMap::default();
        for e in g.postorder([root]) {
            let y = match g.node(e) {
                Node::Const(c) => c.register(),
                Node::Var(_) => x,
                Node::Unary(op, a) => eval::unary(op, v[&a], g.externals()),
                Node::Binary(op, a, b) => eval::binary(op, v[&a], v[&b], g.externals()),
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

    /// The derivative by `x` of an expression, as a formula and by central differences of fourth order.
    fn compare(g: &mut Graph, e: ExprId, x: f64) {
        let d = gradient(g, e, |_| true);
        let formula = d.first().map_or(0.0, |(_, d)| value(g, *d, x));
        let [h, k] = [1e-3, 2e-3].map(|h| (value(g, e, x + h) - value(g, e, x - h)) / (2.0 * h));
        let difference = (4.0 * h - k) / 3.0;
        let near = (formula - difference).abs() < 1e-8 * (1.0 + formula.abs());
        assert!(near, "{:?} at {x}: {formula}, by differences {difference}", g.node(e));
    }

    #[test]
    fn every_unary_operator_agrees_with_differences() {
        let mut g = Graph::new();
        let x = g.var(VarId(0), Type::Real);
        // The number of a literal is not a function of a Real.
        for op in Unary::TABLE.iter().filter(|op| **op != Unary::Ordinal) {
            let e = g.unary(*op, x);
            let domain = op.facts().expect("a row").domain;
            for at in [-2.3, -0.8, -0.4, 0.2, 0.43, 0.8, 1.2, 3.9] {
                if domain.contains(at) {
                    compare(&mut g, e, at);
                }
            }
        }
    }

    #[test]
    fn every_binary_operator_agrees_with_differences() {
        let mut g = Graph::new();
        let x = g.var(VarId(0), Type::Real);
        let c = g.real(0.7);
        for op in Binary::TABLE {
            for e in [g.binary(*op, x, c), g.binary(*op, c, x)] {
                for at in [0.2, 0.43, 1.2, 4.7] {
                    compare(&mut g, e, at);
                }
            }
        }
    }

    #[test]
    fn formulas_and_numbers_are_the_same_derivative() {
        let none = &Externals::EMPTY;
        let mut g = Graph::new();
        let x = g.var(VarId(0), Type::Real);
        for op in Unary::TABLE {
            let e = g.unary(*op, x);
            let d = gradient(&mut g, e, |_| true);
            let at = 0.43;
            let formula = d.first().map_or(0.0, |(_, d)| value(&g, *d, at));
            assert_eq!(
                formula,
                partial::unary(*op, at, eval::unary(*op, at, none), none),
                "{op:?}"
            );
        }
        for op in Binary::TABLE {
            let (a, b) = (0.43, 0.7);
            let literals = [a, b].map(|value| g.real(value));
            let numbers = partial::binary(*op, a, b, eval::binary(*op, a, b, none), none);
            let by_a = g.binary(*op, x, literals[1]);
            let by_b = g.binary(*op, literals[0], x);
            for (e, at, number) in [(by_a, a, numbers.0), (by_b, b, numbers.1)] {
                let d = gradient(&mut g, e, |_| true);
                let formula = d.first().map_or(0.0, |(_, d)| value(&g, *d, at));
                assert!((formula - number).abs() < 1e-14, "{op:?}: {formula} {number}");
            }
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
