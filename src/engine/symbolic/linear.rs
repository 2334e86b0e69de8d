//! Is an expression linear in a variable, and with which coefficient?

use super::gradient::Leaf;
use crate::base::index::{FastMap, FastSet};
use crate::ir::builtin::Shape;
use crate::ir::expr::{Binary, ExprId, Graph, Node, Unary, VarId};

/// `(a, b)` with `e = a * leaf + b`, neither depending on the leaf; `None` if `e` is not linear in it
/// for every value of the other variables. `a` is the literal zero if the leaf does not occur.
pub fn split(graph: &mut Graph, e: ExprId, leaf: Leaf) -> Option<(ExprId, ExprId)> {
    let zero = graph.real(0.0);
    // Only what depends on the leaf has an entry.
    let mut parts: FastMap<ExprId, (ExprId, ExprId)> = FastMap::default();
    for node in graph.postorder([e]) {
        let is_leaf = match graph.node(node) {
            Node::Time => leaf == Leaf::Time,
            Node::Var(v) => leaf == Leaf::Var(v),
            Node::Der(v) => leaf == Leaf::Der(v),
            _ => false,
        };
        if is_leaf {
            let one = graph.real(1.0);
            parts.insert(node, (one, zero));
            continue;
        }
        let mut depends = false;
        graph.for_each_operand(node, |a| depends |= parts.contains_key(&a));
        if depends {
            let of = combine(graph, node, &parts, zero)?;
            parts.insert(node, of);
        }
    }
    Some(parts.get(&e).copied().unwrap_or((zero, e)))
}

fn combine(
    g: &mut Graph,
    node: ExprId,
    parts: &FastMap<ExprId, (ExprId, ExprId)>,
    zero: ExprId,
) -> Option<(ExprId, ExprId)> {
    let part = |e: ExprId| parts.get(&e).copied().unwrap_or((zero, e));
    match g.node(node) {
        Node::Unary(Unary::Neg, a) => {
            let (p, q) = part(a);
            Some((g.neg(p), g.neg(q)))
        }
        Node::Binary(op @ (Binary::Add | Binary::Sub), a, b) => {
            let ((pa, qa), (pb, qb)) = (part(a), part(b));
            Some((g.binary(op, pa, pb), g.binary(op, qa, qb)))
        }
        Node::Binary(Binary::Mul, a, b) => match (parts.get(&a), parts.get(&b)) {
            (Some(&(p, q)), None) => Some((g.mul(p, b), g.mul(q, b))),
            (None, Some(&(p, q))) => Some((g.mul(a, p), g.mul(a, q))),
            _ => None,
        },
        Node::Binary(Binary::Div, a, b) if !parts.contains_key(&b) => {
            let (p, q) = part(a);
            Some((g.div(p, b), g.div(q, b)))
        }
        Node::If(c, a, b) if !parts.contains_key(&c) => {
            let ((pa, qa), (pb, qb)) = (part(a), part(b));
            Some((g.if_then_else(c, pa, pb), g.if_then_else(c, qa, qb)))
        }
        _ => None,
    }
}

/// True if `roots` are, for all values of everything else, linear in the variables for which
/// `unknown` holds together.
pub fn is_linear(
    graph: &Graph,
    roots: impl IntoIterator<Item = ExprId>,
    unknown: impl Fn(VarId) -> bool,
) -> bool {
    let mut dependent: FastSet<ExprId> = FastSet::default();
    for node in graph.postorder(roots) {
        let mut depends = false;
        graph.for_each_operand(node, |a| depends |= dependent.contains(&a));
        let linear = match graph.node(node) {
            Node::Var(v) => {
                depends = unknown(v);
                true
            }
            _ if !depends => true,
            Node::Unary(Unary::Neg, _) | Node::Binary(Binary::Add | Binary::Sub, ..) => true,
            Node::Binary(Binary::Mul, a, b) => !(dependent.contains(&a) && dependent.contains(&b)),
            Node::Binary(Binary::Div, _, b) => !dependent.contains(&b),
            Node::If(c, ..) => !dependent.contains(&c),
            _ => false,
        };
        if !linear {
            return false;
        }
        if depends {
            dependent.insert(node);
        }
    }
    true
}

/// The variables on which `root` depends in a way that [`super::gradient`] does not see: conditions
/// written as operators, functions that jump, arguments of called functions.
pub fn hidden_variables(graph: &Graph, root: ExprId) -> FastSet<VarId> {
    let differentiable = |f| graph.externals().get(f).signature().is_differentiable;
    let mut tops = Vec::new();
    for node in graph.postorder([root]) {
        match graph.node(node) {
            Node::If(c, ..) => tops.push(c),
            Node::Call { .. } | Node::Homotopy(..) => tops.push(node),
            Node::Unary(Unary::External(f), _) if !differentiable(f) => tops.push(node),
            Node::Binary(Binary::External(f), ..) if !differentiable(f) => tops.push(node),
            Node::Unary(op, _) if jumps(op.shape()) => tops.push(node),
            Node::Binary(op, ..) if jumps(op.shape()) => tops.push(node),
            _ => {}
        }
    }
    let mut hidden = FastSet::default();
    for node in graph.postorder(tops) {
        if let Node::Var(v) = graph.node(node) {
            hidden.insert(v);
        }
    }
    hidden
}

fn jumps(shape: Shape) -> bool {
    shape.is_piecewise_constant() || shape.makes_events()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::expr::Type;

    #[test]
    fn coefficient_and_rest() {
        let mut g = Graph::new();
        let [x, y] = [0, 1].map(|i| g.var(VarId(i), Type::Real));
        let by_x = Leaf::Var(VarId(0));
        // 3 (x - y) / 2 - x y  =  (1.5 - y) x - 1.5 y
        let three = g.real(3.0);
        let two = g.real(2.0);
        let difference = g.sub(x, y);
        let scaled = g.mul(three, difference);
        let half = g.div(scaled, two);
        let product = g.mul(x, y);
        let e = g.sub(half, product);
        let (a, b) = split(&mut g, e, by_x).unwrap();
        assert_eq!(g.variables(a), [VarId(1)]);
        assert_eq!(g.variables(b), [VarId(1)]);
        assert!(is_linear(&g, [e], |v| v == VarId(0)));
        assert!(!is_linear(&g, [e], |_| true));
        let square = g.mul(x, x);
        assert_eq!(split(&mut g, square, by_x), None);
        let (a, b) = split(&mut g, y, by_x).unwrap();
        assert_eq!((g.as_number(a), b), (Some(0.0), y));
    }

    #[test]
    fn a_condition_on_the_unknown_is_not_linear() {
        let mut g = Graph::new();
        let x = g.var(VarId(0), Type::Real);
        let zero = g.real(0.0);
        let c = g.binary(Binary::Less, x, zero);
        let two = g.real(2.0);
        let double = g.mul(two, x);
        let e = g.if_then_else(c, double, x);
        assert_eq!(split(&mut g, e, Leaf::Var(VarId(0))), None);
        assert!(!is_linear(&g, [e], |_| true));
        assert!(hidden_variables(&g, e).contains(&VarId(0)));
    }
}
