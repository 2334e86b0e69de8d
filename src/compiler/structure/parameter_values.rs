//! The values of expressions at the values of the parameters that are known at compile time.

use crate::base::index::{FastMap, Id};
use crate::ir::dae::Dae;
use crate::ir::expr::{Const, ExprId, Graph, Node, VarId};
use crate::symbolic::gradient::{Leaf, gradient};
use crate::symbolic::rewrite::Rewriter;
use crate::symbolic::{eval, linear};

/// The known parameters, and the values of expressions of them.
pub struct ParameterValues {
    literals: FastMap<VarId, ExprId>,
    /// The values of the first expressions of the graph; operands have lower numbers.
    numbers: Vec<Option<f64>>,
}

impl ParameterValues {
    /// The parameters whose values are literals, or follow from such.
    pub fn of(dae: &mut Dae) -> ParameterValues {
        let mut literals: FastMap<VarId, ExprId> = FastMap::default();
        let mut rewriter = Rewriter::new();
        for k in 0..dae.parameters.len() {
            let (v, e) = dae.parameters[k];
            let value = rewriter.apply(&mut dae.graph, e, &mut |g, n| match g.node(n) {
                Node::Var(p) => literals.get(&p).copied(),
                _ => None,
            });
            if dae.variables[v].vanishes {
                literals.insert(v, dae.graph.real(0.0));
            } else if dae.graph.as_const(value).is_some() {
                literals.insert(v, value);
            }
        }
        ParameterValues { literals, numbers: Vec::new() }
    }

    /// The literal of each known parameter.
    pub fn into_literals(self) -> FastMap<VarId, ExprId> {
        self.literals
    }

    /// The value of a known parameter.
    pub fn literal(&self, graph: &Graph, v: VarId) -> Option<f64> {
        graph.as_const(*self.literals.get(&v)?).map(Const::register)
    }

    /// The value of an expression; `None` if it depends on more than known parameters. Booleans
    /// are 0 and 1.
    pub fn number(&mut self, graph: &Graph, e: ExprId) -> Option<f64> {
        while self.numbers.len() <= e.idx() {
            let next = ExprId::from_usize(self.numbers.len());
            self.numbers.push(self.evaluate(graph, next));
        }
        self.numbers[e.idx()]
    }

    /// The coefficients of a residual by unknowns, at the place of each, if it is linear in them; `value` gives the
    /// values of the coefficients.
    pub fn coefficients(
        &mut self,
        graph: &mut Graph,
        residual: ExprId,
        place: &FastMap<VarId, usize>,
        mut value: impl FnMut(&mut Self, &Graph, ExprId) -> Option<f64>,
    ) -> Option<Vec<f64>> {
        if linear::hidden_variables(graph, residual).iter().any(|v| place.contains_key(v)) {
            return None;
        }
        let wanted = |leaf| matches!(leaf, Leaf::Var(v) if place.contains_key(&v));
        let mut row = vec![0.0; place.len()];
        for (leaf, partial) in gradient(graph, residual, wanted) {
            let Leaf::Var(v) = leaf else { continue };
            row[place[&v]] = value(self, graph, partial).filter(|x| x.is_finite())?;
        }
        Some(row)
    }

    /// The value of an expression at the values of the parameters and some values of everything
    /// else: expressions that vanish there vanish in general. Variables in `zero` are 0.
    pub fn sample(&self, graph: &Graph, root: ExprId, zero: impl Fn(VarId) -> bool) -> f64 {
        self.sample_of(graph, root, 0, zero)
    }

    /// The same at the point of this number.
    pub fn sample_of(
        &self,
        graph: &Graph,
        root: ExprId,
        point: usize,
        zero: impl Fn(VarId) -> bool,
    ) -> f64 {
        // Fractions of the golden ratio are far from all simple relations, and so are those of the square root of 2.
        let shift = point as f64 * std::f64::consts::SQRT_2;
        let any = |k: usize| 0.5 + (k as f64 * 0.618_033_988_749_894_9 + shift).fract();
        let variable = |v: VarId| match zero(v) {
            true => Some(0.0),
            false => self.literal(graph, v).or_else(|| Some(any(v.idx()))),
        };
        let mut values: FastMap<ExprId, f64> = FastMap::default();
        for e in graph.postorder([root]) {
            let of = |a: ExprId| values.get(&a).copied();
            let value = evaluate(graph, e, of, variable);
            values.insert(e, value.unwrap_or_else(|| any(e.idx())));
        }
        values[&root]
    }

    fn evaluate(&self, graph: &Graph, e: ExprId) -> Option<f64> {
        evaluate(graph, e, |a| self.numbers[a.idx()], |v| self.literal(graph, v))
    }
}

/// The value of a node, from the values of its operands and of variables.
pub fn evaluate(
    graph: &Graph,
    e: ExprId,
    of: impl Fn(ExprId) -> Option<f64>,
    variable: impl Fn(VarId) -> Option<f64>,
) -> Option<f64> {
    match graph.node(e) {
        Node::Const(c) => Some(c.register()),
        Node::Var(v) => variable(v),
        Node::Unary(op, a) => of(a).map(|a| eval::unary(op, a, graph.externals())),
        Node::Binary(op, a, b) => Some(eval::binary(op, of(a)?, of(b)?, graph.externals())),
        Node::If(c, a, b) => of(if of(c)? != 0.0 { a } else { b }),
        Node::NoEvent(a) => of(a),
        _ => None,
    }
}
