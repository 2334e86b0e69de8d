//! Which equations must be differentiated, and how often, until the highest derivatives are
//! determined.
//!
//! C. C. Pantelides, "The consistent initialization of differential-algebraic systems", SIAM J.
//! Sci. Stat. Comput. 9(2), 1988, algorithm 4.1, with the paper's symbols: the list A leads from a
//! variable to its derivative, the list B from an equation to its differentiated equation. The
//! number of differentiations of each equation is the least possible and does not depend on the
//! order of the equations.

use super::augment::AugmentingSearch;
use super::bipartite::{Bipartite, Col, Row};
use super::matching::{Matching, maximum};
use crate::base::index::{Id, IndexVec};

/// A system that determines its highest derivatives. The rows and columns of the original system
/// keep their numbers; new ones follow.
#[derive(Clone, Debug)]
pub struct Reduction {
    /// The original rows, followed by the differentiated ones. A differentiated row is
    /// incident to the columns of its origin and to their derivatives.
    pub incidence: Bipartite,
    /// The list A: the derivative of each column, if it occurs.
    pub derivative: IndexVec<Col, Option<Col>>,
    /// The list B: the row that results from differentiating a row, if that was necessary.
    pub differentiated: IndexVec<Row, Option<Row>>,
    /// The assignment between rows that are not differentiated any more and columns that are
    /// highest derivatives. All such rows are matched; a column is free only if the original system
    /// has fewer rows than unknowns.
    pub matching: Matching,
}

/// Why the highest derivatives cannot be determined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StructurallySingular {
    /// Even if all derivatives of a variable are identified with the variable itself, some
    /// equations have too few unknowns: differentiation would never terminate.
    #[error("{} equations for {} unknowns", rows.len(), cols.len())]
    TooFewUnknowns {
        /// A minimal set of equations, ascending, with one unknown too few.
        rows: Vec<Row>,
        /// The unknowns of these equations, ascending, each given by its lowest derivative.
        cols: Vec<Col>,
    },
    /// An equation that is not differentiable would have to be differentiated.
    #[error("an equation that has no derivative must be differentiated")]
    NotDifferentiable {
        /// The equation without derivative.
        row: Row,
        /// The equations, ascending and of the original system, that together constrain variables
        /// whose derivatives occur; `row` is one of them.
        rows: Vec<Row>,
    },
}

/// Differentiates rows until the highest derivatives are structurally determined.
///
/// - `incidence`: rows over all unknowns, the derivatives among them having columns of their own.
/// - `derivative`: the list A of that system; columns beyond its end have no derivative.
/// - `fixed`: rows that may not be differentiated.
/// - `given`: pairs of rows, the second of which takes the place of the derivative of the first: the first determines
///   the variable whose derivative the second determines.
///
/// Always terminates, because a system for which it would not is found to be singular first
/// (Pantelides 1988, section 4: the system extended by ẋ = dx/dt must not be singular).
pub fn pantelides(
    incidence: &Bipartite,
    derivative: &IndexVec<Col, Option<Col>>,
    fixed: &[Row],
    given: &[(Row, Row)],
) -> Result<Reduction, StructurallySingular> {
    let mut derivative = derivative.clone();
    derivative.resize(incidence.col_count(), None);
    let mut differentiated = IndexVec::filled(None, incidence.row_count());
    for &(row, of_derivative) in given {
        differentiated[row] = Some(of_derivative);
    }
    let is_highest = |row: Row| differentiated[row].is_none();
    check_determined(incidence, &derivative, is_highest)?;

    let empty = Matching::empty(incidence);
    let mut left_out = IndexVec::filled(false, incidence.edge_count());
    for edge in given.iter().flat_map(|(row, _)| incidence.edges(*row)) {
        left_out[edge] = true;
    }
    let allowed = |edge, col| derivative[col].is_none() && !left_out[edge];
    let matching = maximum(incidence, allowed, empty);
    let unmatched: Vec<Row> = matching.free_rows().filter(|row| is_highest(*row)).collect();
    let mut system = GrowingSystem {
        graph: incidence.clone(),
        matching,
        derivative,
        differentiated,
        origin: incidence.rows().collect(),
        fixed: IndexVec::filled(false, incidence.row_count()),
    };
    for &row in fixed {
        system.fixed[row] = true;
    }
    let mut search = AugmentingSearch::new();
    for first in unmatched {
        let mut row = first;
        while !system.match_highest(&mut search, row) {
            row = system.differentiate(row, search.rows(), search.cols())?;
        }
    }
    Ok(system.into_reduction())
}

/// The column of which each column is a derivative of some order, itself if of order zero.
pub fn lowest(derivative: &IndexVec<Col, Option<Col>>) -> IndexVec<Col, Col> {
    let mut lowest: IndexVec<Col, Col> = derivative.ids().collect();
    let mut is_derivative = IndexVec::filled(false, derivative.len());
    for &col in derivative.iter().flatten() {
        is_derivative[col] = true;
    }
    for col in derivative.ids().filter(|&col| !is_derivative[col]) {
        let mut next = derivative[col];
        while let Some(higher) = next {
            lowest[higher] = col;
            next = derivative[higher];
        }
    }
    lowest
}

/// Finds a row, of those that are `counted`, without an unknown of its own even if derivatives count as the variable
/// itself.
fn check_determined(
    incidence: &Bipartite,
    derivative: &IndexVec<Col, Option<Col>>,
    counted: impl Fn(Row) -> bool,
) -> Result<(), StructurallySingular> {
    let lowest = lowest(derivative);
    let collapsed = Bipartite::from_rows(
        incidence.col_count(),
        incidence.rows().map(|row| {
            let cols: &[Col] = if counted(row) { incidence.cols(row) } else { &[] };
            cols.iter().map(|&col| lowest[col])
        }),
    );
    let mut matching = maximum(&collapsed, |_, _| true, Matching::empty(&collapsed));
    let Some(row) = matching.free_rows().find(|row| counted(*row)) else { return Ok(()) };
    let mut search = AugmentingSearch::new();
    search.augment(&collapsed, &mut matching, row, |_, _| true);
    Err(StructurallySingular::TooFewUnknowns {
        rows: ascending(search.rows()),
        cols: ascending(search.cols()),
    })
}

/// The growing system.
struct GrowingSystem {
    graph: Bipartite,
    matching: Matching,
    derivative: IndexVec<Col, Option<Col>>,
    differentiated: IndexVec<Row, Option<Row>>,
    /// The original row of which each row is a derivative.
    origin: IndexVec<Row, Row>,
    /// Original rows that have no derivative.
    fixed: IndexVec<Row, bool>,
}

impl GrowingSystem {
    /// The procedure AUGMENTPATH: columns whose derivative occurs count as known.
    fn match_highest(&mut self, search: &mut AugmentingSearch, row: Row) -> bool {
        let derivative = &self.derivative;
        search.discard_marks();
        search.augment(&self.graph, &mut self.matching, row, |_, col| derivative[col].is_none())
    }

    /// Differentiates the coloured columns and rows, carries the assignment over to the
    /// derivatives, and returns the derivative of `start`.
    fn differentiate(
        &mut self,
        start: Row,
        rows: &[Row],
        cols: &[Col],
    ) -> Result<Row, StructurallySingular> {
        let rows = ascending(rows);
        if let Some(&row) = rows.iter().find(|&&row| self.fixed[self.origin[row]]) {
            let mut origins: Vec<Row> = rows.iter().map(|&row| self.origin[row]).collect();
            origins.sort_unstable();
            origins.dedup();
            return Err(StructurallySingular::NotDifferentiable {
                row: self.origin[row],
                rows: origins,
            });
        }
        let cols = ascending(cols);
        for &col in &cols {
            let derivative = self.derivative.push(None);
            self.derivative[col] = Some(derivative);
        }
        let mut derivative_of_start = start;
        for &row in &rows {
            let mut incident = self.graph.cols(row).to_vec();
            incident.extend(self.graph.cols(row).iter().filter_map(|&col| self.derivative[col]));
            let derivative = self.graph.push_row(incident);
            self.differentiated.push(None);
            self.differentiated[row] = Some(derivative);
            self.origin.push(self.origin[row]);
            if row == start {
                derivative_of_start = derivative;
            }
        }
        self.matching.grow(&self.graph);
        for &col in &cols {
            let row = self.matching.col_to_row[col].and_then(|row| self.differentiated[row]);
            if let (Some(row), Some(derivative)) = (row, self.derivative[col]) {
                self.matching.join(row, derivative);
            }
        }
        Ok(derivative_of_start)
    }

    fn into_reduction(mut self) -> Reduction {
        for row in self.graph.rows() {
            if self.differentiated[row].is_some() {
                self.matching.separate(row);
            }
        }
        Reduction {
            incidence: self.graph,
            derivative: self.derivative,
            differentiated: self.differentiated,
            matching: self.matching,
        }
    }
}

fn ascending<I: Id>(ids: &[I]) -> Vec<I> {
    let mut ids = ids.to_vec();
    ids.sort_unstable();
    ids
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::test_graphs::{Xorshift, graph_of, list_a, random_square, rigid_chain};

    /// How often each original row was differentiated.
    fn counts(rows: usize, reduction: &Reduction) -> Vec<usize> {
        let derivatives = |row| {
            std::iter::successors(reduction.differentiated[row], |&r| reduction.differentiated[r])
        };
        (0..rows).map(|row| derivatives(Row::from_usize(row)).count()).collect()
    }

    /// Pantelides 1988, p. 222-225: the pendulum x' = w, y' = z, w' = T x, z' = T y - g,
    /// x² + y² = L², with the variables x y w z x' y' w' z' T numbered from 0 instead of 1.
    #[test]
    fn pendulum_of_the_paper() {
        let rows: [&[u32]; 5] = [&[4, 2], &[5, 3], &[6, 0, 8], &[7, 1, 8], &[0, 1]];
        let graph = graph_of(9, &rows);
        let a = list_a(9, &[(0, 4), (1, 5), (2, 6), (3, 7)]);
        let reduction = pantelides(&graph, &a, &[], &[]).unwrap();
        // The constraint 5 gives 6; then 1, 2 and 6 give 7, 8 and 9, with x'' = 10 and y'' = 11.
        let one_based = |list: Vec<Option<usize>>| -> Vec<usize> {
            list.into_iter().map(|entry| entry.map_or(0, |i| i + 1)).collect()
        };
        let a = reduction.derivative.iter().map(|col| col.map(Id::idx)).collect();
        assert_eq!(one_based(a), [5, 6, 7, 8, 10, 11, 0, 0, 0, 0, 0]);
        let b = reduction.differentiated.iter().map(|row| row.map(Id::idx)).collect();
        assert_eq!(one_based(b), [7, 8, 0, 0, 6, 9, 0, 0, 0]);
        let assign = reduction.matching.col_to_row.iter().map(|row| row.map(Id::idx)).collect();
        assert_eq!(one_based(assign), [0, 0, 0, 0, 0, 0, 7, 4, 3, 9, 8]);
        assert_eq!(reduction.incidence.cols(Row(8)), [0, 1, 4, 5, 9, 10].map(Col));
    }

    /// The linear example of Mattsson and Söderlind 1993: x1 + x2 + u1 = 0, x1 + x2 + x3 + u2 = 0,
    /// x1 + x3' + x4 + u3 = 0, 2 x1'' + x2'' + x3'' + x4' + u4 = 0; differentiated 2, 2, 1, 0
    /// times.
    #[test]
    fn linear_system_of_mattsson_and_soderlind() {
        // x1 x1' x1'' x2 x2' x2'' x3 x3' x3'' x4 x4'
        let rows: [&[u32]; 4] = [&[0, 3], &[0, 3, 6], &[0, 7, 9], &[2, 5, 8, 10]];
        let a = list_a(11, &[(0, 1), (1, 2), (3, 4), (4, 5), (6, 7), (7, 8), (9, 10)]);
        let reduction = pantelides(&graph_of(11, &rows), &a, &[], &[]).unwrap();
        assert_eq!(counts(4, &reduction), [2, 2, 1, 0]);
        assert_eq!(reduction.derivative.len(), 11);
        assert_eq!(reduction.matching.cardinality(), 4);
    }

    #[test]
    fn an_ordinary_differential_equation_stays_as_it_is() {
        // x' = y, y = x.
        let graph = graph_of(3, &[&[1, 2], &[0, 2]]);
        let reduction = pantelides(&graph, &list_a(3, &[(0, 1)]), &[], &[]).unwrap();
        assert_eq!(reduction.incidence, graph);
        assert_eq!(reduction.differentiated.as_slice(), [None, None]);
        assert_eq!(reduction.matching.row_to_col.as_slice(), [Some(Col(1)), Some(Col(2))]);
    }

    #[test]
    fn three_equations_for_a_variable_with_derivative_are_singular() {
        // x' = 1, x = y, y = 2, x + y = 3 z, z' = z.
        let rows: [&[u32]; 5] = [&[1], &[0, 2], &[2], &[0, 2, 3], &[3, 4]];
        let a = list_a(5, &[(0, 1), (3, 4)]);
        let Err(error) = pantelides(&graph_of(5, &rows), &a, &[], &[]) else {
            panic!("is singular")
        };
        let StructurallySingular::TooFewUnknowns { rows, cols } = error else { panic!("{error}") };
        assert_eq!(rows.len(), cols.len() + 1);
        assert_eq!(rows, [0, 1, 2].map(Row));
        assert_eq!(cols, [0, 2].map(Col));
    }

    #[test]
    fn a_fixed_row_is_an_error_only_in_a_constraint() {
        // x' = u, y' = v, x = y, u = 1.
        let graph = graph_of(6, &[&[2, 4], &[3, 5], &[0, 1], &[4]]);
        let a = list_a(6, &[(0, 2), (1, 3)]);
        assert_eq!(counts(4, &pantelides(&graph, &a, &[Row(3)], &[]).unwrap()), [0, 0, 1, 0]);
        let error = pantelides(&graph, &a, &[Row(2)], &[]).unwrap_err();
        assert_eq!(
            error,
            StructurallySingular::NotDifferentiable { row: Row(2), rows: vec![Row(2)] }
        );
    }

    /// x = u, x' = w with given derivative; u = f(t), w = g(t), y = x'', so that the row of w is differentiated and the row
    /// of u is not.
    #[test]
    fn a_given_derivative_takes_the_place_of_the_differentiated_row() {
        // x x' x'' u w y
        let graph = graph_of(6, &[&[0, 3], &[1, 4], &[3], &[4], &[2, 5]]);
        let a = list_a(6, &[(0, 1), (1, 2)]);
        let reduction = pantelides(&graph, &a, &[], &[(Row(0), Row(1))]).unwrap();
        assert_eq!(counts(5, &reduction), [2, 1, 0, 1, 0]);
        assert_eq!(reduction.differentiated[Row(0)], Some(Row(1)));
        assert!(reduction.derivative[Col(3)].is_none() && reduction.derivative[Col(4)].is_some());
        assert_eq!(reduction.matching.row_to_col[Row(2)], Some(Col(3)));
    }

    /// Pryce, "A simple structural analysis method for DAEs", BIT 41(2), 2001: the numbers of
    /// differentiations are the smallest c >= 0 with d_j - c_i >= s_ij, equality on a transversal
    /// of largest weight. Here by brute force over all c up to 3 and the optimum of the dual.
    #[test]
    fn differentiations_agree_with_the_smallest_dual_solution_of_pryce() {
        let mut random = Xorshift::new(1988);
        let mut differentiated = 0;
        for round in 0..200 {
            let n = 3;
            let variables = random_square(&mut random, n, round % 7);
            // Variable j of order 0..=2 is columns 3 j .. 3 j + 3.
            let orders: Vec<Vec<Option<usize>>> = variables
                .rows()
                .map(|row| {
                    let order = |j| variables.edge(row, Col(j)).map(|_| random.below(3));
                    (0..n as u32).map(order).collect()
                })
                .collect();
            let signature = |i: usize, j: usize| orders[i][j];
            let row = |i: usize| {
                (0..n).filter_map(move |j| Some(Col::from_usize(3 * j + signature(i, j)?)))
            };
            // Columns for the orders that occur nowhere must not exist, so cut the lists.
            let highest = |j: usize| (0..n).filter_map(|i| signature(i, j)).max().unwrap_or(0);
            let mut a = IndexVec::filled(None, 3 * n);
            for j in 0..n {
                for order in 0..highest(j) {
                    a[Col::from_usize(3 * j + order)] = Some(Col::from_usize(3 * j + order + 1));
                }
            }
            let graph = Bipartite::from_rows(3 * n, (0..n).map(row));
            let found = counts(n, &pantelides(&graph, &a, &[], &[]).unwrap());
            let expected = smallest_dual(n, &signature);
            assert_eq!(found, expected, "{orders:?}");
            differentiated += usize::from(expected.iter().any(|&c| c > 0));
        }
        assert!(differentiated > 50);
    }

    fn smallest_dual(n: usize, signature: &impl Fn(usize, usize) -> Option<usize>) -> Vec<usize> {
        let mut best: Option<(usize, usize, Vec<usize>)> = None;
        for code in 0..7_usize.pow(n as u32) {
            let c: Vec<usize> = (0..n).map(|i| code / 7_usize.pow(i as u32) % 7).collect();
            let d = |j: usize| (0..n).filter_map(|i| Some(c[i] + signature(i, j)?)).max();
            let total: usize = (0..n).map(|j| d(j).unwrap_or(0)).sum::<usize>() + 7 * n;
            let objective = total - c.iter().sum::<usize>();
            let candidate = (objective, c.iter().sum(), c);
            if best.as_ref().is_none_or(|best| candidate < *best) {
                best = Some(candidate);
            }
        }
        best.map(|(_, _, c)| c).unwrap_or_default()
    }

    /// n masses on a line, x_i' = v_i, v_i' = F_i - F_(i+1), rigidly joined by x_i = x_(i+1): every
    /// joint is differentiated twice and every velocity equation once. A quadratic algorithm would
    /// not finish in reasonable time.
    #[test]
    fn a_hundred_thousand_constraints_in_a_chain() {
        let n = 100_000;
        let (graph, a) = rigid_chain(n);
        let reduction = pantelides(&graph, &a, &[], &[]).unwrap();
        let counts = counts(3 * n - 1, &reduction);
        assert!(counts[..n].iter().all(|&count| count == 1));
        assert!(counts[n..2 * n].iter().all(|&count| count == 0));
        assert!(counts[2 * n..].iter().all(|&count| count == 2));
    }
}
