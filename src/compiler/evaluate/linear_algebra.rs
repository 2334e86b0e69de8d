//! The functions of LAPACK that solve linear systems: `dgesv`, and `dgelsy` of full rank, whose
//! solution is the shortest one where there are fewer equations than unknowns.
//!
//! They are computed on expressions, so that the matrix may hold parameters and variables: known
//! numbers fold to numbers. Gaussian elimination with partial pivoting and Householder's QR
//! decomposition (Golub & Van Loan, *Matrix Computations*, 4th ed., sections 3.4 and 5.2).

use super::Evaluator;
use super::external::Refusal;
use super::value::Value;
use crate::base::name::Name;
use crate::ir::ast::{Expr, ExprKind, External};
use crate::ir::expr::{Binary, ExprId, Graph, Type, Unary};
use crate::ir::instance::Scope;

/// Operations of the largest elimination.
const MAX_OPERATIONS: usize = 200_000;

/// A matrix of expressions, by rows.
type Matrix = Vec<Vec<ExprId>>;

impl Evaluator<'_> {
    /// Runs a function of LAPACK in the frame of the Modelica function that declares it: the
    /// outputs and their values; `None` if it is not one of those known here.
    pub(super) fn lapack(
        &mut self,
        called: &str,
        external: &External,
        scope: Scope,
    ) -> Option<Result<Vec<(Name, Value)>, Refusal>> {
        // Positions of the matrix, of the right sides that become the solution, of `info`, and of
        // the rank.
        let (matrix, solution, info, rank) = match called {
            "dgesv" => (2, 5, 7, None),
            "dgelsy" => (3, 5, 12, Some(9)),
            _ => return self.lapack_on_factors(called, external),
        };
        let argument = |k: usize| external.args.get(k);
        let local = |k: usize| argument(k).and_then(name_of);
        let (matrix, solution, info) = (argument(matrix)?, local(solution)?, local(info)?);
        let rank = rank.and_then(local);
        let a = self.evaluate(matrix, scope)?;
        let b = self.local(solution)?;
        Some(self.solve_linear(called, &a, &b).map(|(x, order)| {
            let zero = Value::Scalar(self.graph.integer(0));
            let mut results = vec![(solution, x), (info, zero)];
            if let Some(rank) = rank {
                results.push((rank, Value::Scalar(self.graph.integer(order as i64))));
            }
            results
        }))
    }

    fn solve_linear(
        &mut self,
        called: &str,
        a: &Value,
        b: &Value,
    ) -> Result<(Value, usize), Refusal> {
        let (Some(mut rows), Some(mut right)) = (self.matrix_of(a), self.matrix_of(b)) else {
            return Err(Refusal::Unknown);
        };
        let (m, n) = (rows.len(), rows.first().map_or(0, Vec::len));
        if m * n * n.max(right.first().map_or(0, Vec::len)) > MAX_OPERATIONS {
            return Err(Refusal::Wrong("the system is too large".into()));
        }
        if called == "dgelsy" {
            if m < n {
                return self.shortest_solution(&rows, &right, b);
            }
            triangularize(&mut self.graph, &mut rows, &mut right);
        } else {
            eliminate(&mut self.graph, &mut rows, &mut right);
        }
        if !substitute_back(&mut self.graph, &rows, &mut right, n) {
            return Err(Refusal::Wrong("the matrix is singular".into()));
        }
        let elements = right.into_iter().flatten().map(Value::Scalar).collect();
        Ok((Value::array(b.dims().to_vec(), elements), n))
    }

    /// The solution of least length of a system with fewer equations than unknowns, which takes as
    /// many rows of the right side as there are unknowns, and the rank of the matrix. From the
    /// decomposition of the transposed matrix (Golub & Van Loan, section 5.6.2).
    fn shortest_solution(
        &mut self,
        a: &Matrix,
        b: &Matrix,
        shape: &Value,
    ) -> Result<(Value, usize), Refusal> {
        let (m, n) = (a.len(), a.first().map_or(0, Vec::len));
        let g = &mut self.class_graph.graph;
        let mut transposed: Matrix = (0..n).map(|j| a.iter().map(|row| row[j]).collect()).collect();
        let (zero, one) = (g.real(0.0), g.real(1.0));
        let unit = |i: usize| (0..n).map(move |j| if i == j { one } else { zero });
        let mut reflected: Matrix = (0..n).map(|i| unit(i).collect()).collect();
        triangularize(g, &mut transposed, &mut reflected);
        let width = b.first().map_or(0, Vec::len);
        let mut solution = vec![vec![zero; width]; n];
        for j in 0..width {
            let mut along: Vec<ExprId> = Vec::with_capacity(m);
            for i in 0..m {
                if g.as_number(transposed[i][i]) == Some(0.0) {
                    return Err(Refusal::Wrong("the matrix is singular".into()));
                }
                let known: Vec<ExprId> =
                    (0..i).map(|k| g.mul(transposed[k][i], along[k])).collect();
                let known = if known.is_empty() { zero } else { g.sum(known) };
                let rest = g.sub(b[i][j], known);
                along.push(g.div(rest, transposed[i][i]));
            }
            for (i, row) in solution.iter_mut().enumerate() {
                let terms: Vec<ExprId> = (0..m).map(|k| g.mul(reflected[k][i], along[k])).collect();
                row[j] = g.sum(terms);
            }
        }
        let elements = solution.into_iter().flatten().map(Value::Scalar).collect();
        Ok((Value::array(shape.dims().to_vec(), elements), m))
    }

    /// A matrix, or a vector as one column.
    fn matrix_of(&mut self, value: &Value) -> Option<Matrix> {
        let width = match value.dims() {
            [_] => 1,
            [_, n] => *n,
            _ => return None,
        };
        let scalars: Option<Vec<ExprId>> = value.elements().iter().map(Value::scalar).collect();
        let scalars = scalars?.into_iter().map(|e| self.graph.as_real(e)).collect::<Vec<_>>();
        Some(scalars.chunks(width.max(1)).map(<[ExprId]>::to_vec).collect())
    }
}

pub(super) fn name_of(e: &Expr) -> Option<Name> {
    match &e.kind {
        ExprKind::Ref(r) => r.simple(),
        _ => None,
    }
}

/// Upper triangular form, by elimination with partial pivoting.
fn eliminate(g: &mut Graph, a: &mut Matrix, b: &mut Matrix) {
    let n = a.len();
    for k in 0..n {
        for i in k + 1..n {
            // Of each pair the row with the larger element becomes the pivot.
            let [below, above] = [a[i][k], a[k][k]].map(|e| g.unary(Unary::Abs, e));
            let swap = g.binary(Binary::Greater, below, above);
            let swap = g.no_event(swap);
            for (upper, lower) in columns(a, k, i).chain(columns(b, k, i)) {
                let (x, y) = (*upper, *lower);
                *upper = g.if_then_else(swap, y, x);
                *lower = g.if_then_else(swap, x, y);
            }
        }
        for i in k + 1..n {
            let factor = g.div(a[i][k], a[k][k]);
            a[i][k] = g.real(0.0);
            for (upper, lower) in columns(a, k, i).skip(k + 1).chain(columns(b, k, i)) {
                let product = g.mul(factor, *upper);
                *lower = g.sub(*lower, product);
            }
        }
    }
}

/// The elements of two rows, pair by pair.
fn columns(
    a: &mut Matrix,
    upper: usize,
    lower: usize,
) -> impl Iterator<Item = (&mut ExprId, &mut ExprId)> {
    let (first, second) = a.split_at_mut(lower);
    first[upper].iter_mut().zip(second[0].iter_mut())
}

/// Upper triangular form, by reflections.
fn triangularize(g: &mut Graph, a: &mut Matrix, b: &mut Matrix) {
    let (m, n) = (a.len(), a.first().map_or(0, Vec::len));
    let zero = g.real(0.0);
    for k in 0..n.min(m.saturating_sub(1)) {
        let column: Vec<ExprId> = (k..m).map(|i| a[i][k]).collect();
        let norm = norm(g, &column);
        // v = column + sign(column[0])*norm*e_0 has no cancellation.
        let positive = g.binary(Binary::GreaterEqual, column[0], zero);
        let positive = g.no_event(positive);
        let negative = g.neg(norm);
        let signed = g.if_then_else(positive, norm, negative);
        let mut v = column.clone();
        v[0] = g.add(column[0], signed);
        let squares: Vec<ExprId> = v.iter().map(|x| g.mul(*x, *x)).collect();
        let squared = g.sum(squares);
        for (matrix, from) in [(&mut *a, k), (&mut *b, 0)] {
            for j in from..matrix[k].len() {
                let products: Vec<ExprId> = (k..m).map(|i| g.mul(v[i - k], matrix[i][j])).collect();
                let product = g.sum(products);
                let ratio = g.div(product, squared);
                let two = g.real(2.0);
                let factor = g.mul(two, ratio);
                for i in k..m {
                    let part = g.mul(factor, v[i - k]);
                    matrix[i][j] = g.sub(matrix[i][j], part);
                }
            }
        }
    }
}

fn norm(g: &mut Graph, column: &[ExprId]) -> ExprId {
    let squares: Vec<ExprId> = column.iter().map(|x| g.mul(*x, *x)).collect();
    let sum = g.sum(squares);
    g.unary(Unary::Sqrt, sum)
}

/// The solution of an upper triangular system; false if a pivot is known to be zero.
fn substitute_back(g: &mut Graph, a: &Matrix, b: &mut Matrix, n: usize) -> bool {
    for i in (0..n).rev() {
        if g.as_number(a[i][i]) == Some(0.0) {
            return false;
        }
        for j in 0..b[i].len() {
            let terms = (i + 1..n).map(|k| g.mul(a[i][k], b[k][j])).collect::<Vec<_>>();
            let known = if terms.is_empty() { g.real(0.0) } else { g.sum(terms) };
            let rest = g.sub(b[i][j], known);
            b[i][j] = g.div(rest, a[i][i]);
            debug_assert_eq!(g.ty(b[i][j]), Type::Real);
        }
    }
    true
}
