//! Propagates initial values through equations that can be solved one after the other.
//!
//! *In:* an over-determined part of the initialization problem. *Out:* whether the equations that
//! are left over hold: for all values of the parameters if they vanish symbolically, else to
//! tolerance at the values that are known at compile time. Equations that cannot be solved one after
//! the other are consistent if they are linear and one of them is a combination of the others; nothing is
//! known about nonlinear ones.

use super::incidence::EquationSystem;
use super::linear_dependence;
use super::parameter_values::ParameterValues;
use super::solve;
use crate::base::index::{FastMap, FastSet};
use crate::graph::bipartite::{Col, Row};
use crate::ir::dae::Dae;
use crate::ir::expr::{Binary, ExprId, Graph, Node, Type, Unary, VarId};
use crate::symbolic::rewrite::Rewriter;

/// Sides that differ by less, relative to the larger one, are equal.
const TOLERANCE: f64 = 1e-6;
/// Differences below this fraction of the largest term are rounding errors.
const ROUNDING: f64 = 1e-12;

/// Whether the rows determine all their unknowns, one after the other or by linear equations, and the one that is
/// not needed holds; `None` if that cannot be told before the simulation, because they are not linear or read values
/// that are not known. The first row is the one that will be left out.
pub fn is_consistent(
    dae: &mut Dae,
    system: &EquationSystem,
    rows: &[Row],
    values: &mut ParameterValues,
) -> Option<bool> {
    let mut propagation = Propagation::new(dae, system, rows);
    let further = propagation.solve();
    let (closed, open): (Vec<Row>, Vec<Row>) =
        further.into_iter().partition(|row| propagation.open[row] == 0);
    let mut verdicts: Vec<Option<bool>> =
        closed.into_iter().map(|row| propagation.holds(row, values)).collect();
    verdicts.push(propagation.open_hold(&open, values));
    if verdicts.contains(&Some(false)) {
        return Some(false);
    }
    verdicts.into_iter().all(|verdict| verdict == Some(true)).then_some(true)
}

/// Whether two expressions are equal: for all parameters, or to tolerance at their values. `None`
/// if a value is unknown.
pub fn agree(graph: &Graph, a: ExprId, b: ExprId, values: &mut ParameterValues) -> Option<bool> {
    if a == b {
        return Some(true);
    }
    let (x, y) = (values.number(graph, a)?, values.number(graph, b)?);
    if !x.is_finite() || !y.is_finite() {
        return None;
    }
    let rounding = ROUNDING * size(graph, a, values).max(size(graph, b, values));
    Some((x - y).abs() <= TOLERANCE * x.abs().max(y.abs()) + rounding)
}

/// The size of the terms of an expression, before they cancel.
fn size(graph: &Graph, root: ExprId, values: &mut ParameterValues) -> f64 {
    let mut sizes: FastMap<ExprId, f64> = FastMap::default();
    for e in graph.postorder([root]) {
        let of = |a: ExprId| sizes[&a];
        let found = match graph.node(e) {
            Node::Unary(Unary::Neg, a) => of(a),
            Node::Binary(Binary::Add | Binary::Sub, a, b) => of(a).max(of(b)),
            Node::Binary(Binary::Mul, a, b) => of(a) * of(b),
            Node::Binary(Binary::Div, a, b) => of(a) / values.number(graph, b).unwrap_or(1.0).abs(),
            _ => values.number(graph, e).unwrap_or(0.0).abs(),
        };
        sizes.insert(e, if found.is_finite() { found } else { 0.0 });
    }
    sizes[&root]
}

/// Values found so far.
struct Propagation<'a> {
    dae: &'a mut Dae,
    system: &'a EquationSystem,
    rows: &'a [Row],
    /// The rows in which each unknown occurs.
    users: FastMap<Col, Vec<Row>>,
    /// The number of unknowns of each row that have no value yet.
    open: FastMap<Row, usize>,
    /// The values of unknowns, as expressions of parameters.
    known: FastMap<VarId, ExprId>,
}

impl<'a> Propagation<'a> {
    fn new(dae: &'a mut Dae, system: &'a EquationSystem, rows: &'a [Row]) -> Self {
        let mut users: FastMap<Col, Vec<Row>> = FastMap::default();
        let mut open = FastMap::default();
        for &row in rows {
            let cols = system.graph.cols(row);
            open.insert(row, cols.len());
            for &col in cols {
                users.entry(col).or_default().push(row);
            }
        }
        Propagation { dae, system, rows, users, open, known: FastMap::default() }
    }

    /// Solves rows with one open unknown until there are none, and returns the rows that were not
    /// needed.
    fn solve(&mut self) -> Vec<Row> {
        let mut ready: Vec<Row> = self.rows.iter().copied().filter(|r| self.open[r] == 1).collect();
        let mut used: FastSet<Row> = FastSet::default();
        while let Some(row) = ready.pop() {
            let cols = self.system.graph.cols(row);
            let unknown = |col: &&Col| !self.known.contains_key(&self.system.unknowns[**col]);
            let Some(&col) = cols.iter().find(unknown) else { continue };
            let v = self.system.unknowns[col];
            let Some(value) = solve::explicit(self.dae, self.system.sources[row], v) else {
                continue;
            };
            let value = self.substituted(value);
            self.known.insert(v, value);
            used.insert(row);
            for user in &self.users[&col] {
                if let Some(open) = self.open.get_mut(user) {
                    *open -= 1;
                    if *open == 1 {
                        ready.push(*user);
                    }
                }
            }
        }
        self.rows.iter().copied().filter(|row| !used.contains(row)).collect()
    }

    /// Whether the sides of an equation are equal at the values of its unknowns.
    fn holds(&mut self, row: Row, values: &mut ParameterValues) -> Option<bool> {
        let (a, b) = solve::sides(self.dae, self.system.sources[row]);
        let [a, b] = [a, b].map(|side| self.substituted(side));
        let g = &mut self.dae.graph;
        let cancels = g.ty(a) == Type::Real && {
            let difference = g.sub(a, b);
            g.as_number(difference) == Some(0.0)
        };
        if cancels { Some(true) } else { agree(g, a, b, values) }
    }

    /// Whether the equations whose unknowns have no values yet do not contradict each other, if they are linear.
    fn open_hold(&mut self, rows: &[Row], values: &mut ParameterValues) -> Option<bool> {
        if rows.is_empty() {
            return Some(true);
        }
        let mut place = FastMap::default();
        for col in rows.iter().flat_map(|row| self.system.graph.cols(*row)) {
            let v = self.system.unknowns[*col];
            if !self.known.contains_key(&v) {
                let next = place.len();
                place.entry(v).or_insert(next);
            }
        }
        let mut residuals = Vec::with_capacity(rows.len());
        for row in rows {
            let residual = solve::residual(self.dae, self.system.sources[*row]);
            residuals.push(self.substituted(residual));
        }
        let left_out = rows.iter().position(|row| *row == self.rows[0]);
        let graph = &mut self.dae.graph;
        linear_dependence::is_consistent(graph, &residuals, &place, left_out, values)
    }

    /// An expression at the values found so far and at the start time.
    fn substituted(&mut self, e: ExprId) -> ExprId {
        let Dae { graph, relations, experiment, .. } = &mut *self.dae;
        let known = &self.known;
        let compared = Rewriter::new().apply(graph, e, &mut |g, n| match g.node(n) {
            Node::Relation(k) => {
                let relation = &relations[k as usize];
                Some(g.binary(relation.op, relation.lhs, relation.rhs))
            }
            _ => None,
        });
        let start = experiment.start.unwrap_or(0.0);
        Rewriter::new().apply(graph, compared, &mut |g, n| match g.node(n) {
            Node::Var(v) => known.get(&v).copied(),
            Node::Time => Some(g.real(start)),
            Node::Initial => Some(g.boolean(true)),
            _ => None,
        })
    }
}
