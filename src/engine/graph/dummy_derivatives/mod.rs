//! State selection after constraints have been differentiated.
//!
//! S. E. Mattsson and G. Söderlind, "Index reduction in differential-algebraic equations using
//! dummy derivatives", SIAM J. Sci. Comput. 14(3), 1993. Each differentiation of a constraint adds
//! an equation; to balance it, one derivative becomes an ordinary unknown, a *dummy derivative*,
//! and the variable that it differentiates is no longer a state.
//!
//! The dummies must be columns of the ConstraintJacobian of the differentiated equations that form
//! a regular matrix. Independent columns are a matroid, so taking them greedily, the least wanted
//! state first, gives up the least wanted states (J. Edmonds, "Matroids and the greedy algorithm",
//! Math. Programming 1, 1971). Constant coefficients count by their value, the others as
//! indeterminates.

mod greedy;
mod jacobian;

use super::bipartite::{Bipartite, Col, Edge, Row};
use super::pantelides::Reduction;
use crate::base::index::IndexVec;
use greedy::GreedyRound;
use jacobian::ConstraintJacobian;

/// How much the compiler knows about the partial derivative of a row with respect to a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coefficient {
    /// A number known to the compiler.
    Constant(f64),
    /// Constant in time and not zero, but not known to the compiler.
    Parameter,
    /// Varies with time and might vanish.
    Varying,
}

/// The selected states and dummy derivatives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateChoice {
    /// True for the columns that are derivatives but are computed as ordinary unknowns.
    pub is_dummy: IndexVec<Col, bool>,
    /// The columns whose derivative is not a dummy, ascending: the integrator advances these.
    pub states: Vec<Col>,
    /// Number of dummies that had to be selected although their columns depend on the others: not
    /// zero if constraints repeat or contradict each other for all values of the unknowns.
    pub dependent: usize,
    /// The rows that the dummies balance, round by round.
    pub pivots: Vec<Pivot>,
}

/// A constraint and the variable that it determines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pivot {
    /// Distance from the highest derivatives: constraints of different rounds are independent.
    pub round: usize,
    /// The constraint, an original or a differentiated row.
    pub constraint: Row,
    /// The column that it determines: its derivative is a dummy.
    pub determined: Col,
    /// All columns that it might determine, with a derivative each.
    pub candidates: Vec<Col>,
    /// The pivot, or the block of pivots that it belongs to, varies and might become singular.
    pub varying: bool,
    /// The derivative of the constraint by some candidate varies.
    pub nonlinear: bool,
}

/// Chooses the dummy derivatives of a reduced system: as many as there are differentiated rows.
///
/// - `priority`: the preference for each column as a state, the highest most wanted. Columns beyond
///   the end, which the reduction added, inherit the priority of the variable they differentiate.
/// - `coefficient`: for each edge of the *original* rows (they are the first edges of
///   `reduction.incidence`); edges beyond the end are varying. The entry of a differentiated row
///   for a highest derivative is the same partial derivative as the entry of the original row for
///   the variable itself, so the original edges suffice.
///
/// Between columns of equal priority, constant coefficients are preferred, then the lower number.
/// A row takes a column of its own block of the highest derivatives, as in the paper, or any other
/// if the coefficient does not vary.
pub fn choose(
    reduction: &Reduction,
    priority: &IndexVec<Col, i32>,
    coefficient: &IndexVec<Edge, Coefficient>,
) -> StateChoice {
    let chains = Chains::of(reduction);
    let jacobian = ConstraintJacobian::of(reduction, &chains, coefficient);
    let mut is_dummy = IndexVec::filled(false, reduction.derivative.len());
    let mut dependent = 0;
    let mut pivots = Vec::new();

    let mut candidates: Vec<DummyCandidate> = (jacobian.graph.rows())
        .filter(|&top| !jacobian.graph.cols(top).is_empty())
        .filter_map(|top| DummyCandidate { top, dummy: top, state: top }.lowered(&chains))
        .collect();
    // Round k deals with the rows differentiated k times or more, one derivative lower each time.
    for round in 1.. {
        let mut greedy = GreedyRound::new(&jacobian, |row| chains.times[row] >= round);
        if greedy.missing == 0 {
            break;
        }
        let wanted = |candidate: &DummyCandidate| chains.priority(priority, candidate.state);
        candidates.sort_by_key(|candidate| (wanted(candidate), candidate.state));
        let groups: Vec<_> = candidates.chunk_by(|a, b| wanted(a) == wanted(b)).collect();
        greedy.take_independent(&groups);
        dependent += greedy.missing;
        greedy.take_dependent(&candidates);
        candidates.retain(|candidate| greedy.matching.row_to_col[candidate.top].is_some());
        for candidate in &candidates {
            is_dummy[candidate.dummy] = true;
        }
        pivots.extend(jacobian.pivots(&greedy.matching, round, &chains));
        candidates = candidates.iter().filter_map(|candidate| candidate.lowered(&chains)).collect();
    }
    let is_state = |(col, derivative): (Col, &Option<Col>)| {
        derivative.filter(|&derivative| !is_dummy[derivative]).map(|_| col)
    };
    let states = reduction.derivative.enumerate().filter_map(is_state).collect();
    StateChoice { is_dummy, states, dependent, pivots }
}

/// A derivative that may become a dummy in this round.
#[derive(Clone, Copy)]
struct DummyCandidate {
    /// The highest derivative of the same variable, which represents it in the Jacobian.
    top: Col,
    /// The derivative itself.
    dummy: Col,
    /// The variable it differentiates: no longer a state if the candidate is selected.
    state: Col,
}

impl DummyCandidate {
    /// The next lower derivative, unless that is the variable itself.
    fn lowered(self, chains: &Chains) -> Option<DummyCandidate> {
        let state = chains.integral[self.state]?;
        Some(DummyCandidate { top: self.top, dummy: self.state, state })
    }
}

/// The lists A and B read backwards.
struct Chains {
    /// The variable that each column differentiates.
    integral: IndexVec<Col, Option<Col>>,
    /// The row that each row differentiates.
    constraint: IndexVec<Row, Option<Row>>,
    /// The original row of each row.
    origin: IndexVec<Row, Row>,
    /// How many times the original row was differentiated to give each row.
    times: IndexVec<Row, usize>,
}

impl Chains {
    fn of(reduction: &Reduction) -> Chains {
        let mut integral = IndexVec::filled(None, reduction.derivative.len());
        for (col, &derivative) in reduction.derivative.enumerate() {
            if let Some(derivative) = derivative {
                integral[derivative] = Some(col);
            }
        }
        let mut origin: IndexVec<Row, Row> = reduction.incidence.rows().collect();
        let mut times = IndexVec::filled(0, origin.len());
        let mut constraint = IndexVec::filled(None, origin.len());
        // A differentiated row has a higher number than its origin.
        for (row, &differentiated) in reduction.differentiated.enumerate() {
            if let Some(differentiated) = differentiated {
                origin[differentiated] = origin[row];
                times[differentiated] = times[row] + 1;
                constraint[differentiated] = Some(row);
            }
        }
        Chains { integral, constraint, origin, times }
    }

    /// The priority of a column as a state.
    fn priority(&self, given: &IndexVec<Col, i32>, col: Col) -> i32 {
        std::iter::successors(Some(col), |&col| self.integral[col])
            .find_map(|col| given.get(col).copied())
            .unwrap_or(0)
    }

    /// The edge of the original row that has the same partial derivative as (row, col).
    fn original_edge(&self, graph: &Bipartite, row: Row, col: Col) -> Option<Edge> {
        let variable = (0..self.times[row]).try_fold(col, |col, _| self.integral[col])?;
        graph.edge(self.origin[row], variable)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::index::Id;
    use crate::graph::matching::Matching;
    use crate::graph::pantelides::pantelides;
    use crate::graph::test_graphs::{graph_of, list_a, rigid_chain};
    use Coefficient::{Constant, Parameter, Varying};

    fn chosen(
        graph: &Bipartite,
        a: &[(u32, u32)],
        priority: &[i32],
        coefficient: &[Coefficient],
    ) -> (Vec<u32>, Vec<u32>, usize) {
        let reduction = pantelides(graph, &list_a(graph.col_count(), a), &[], &[]).unwrap();
        let priority = priority.iter().copied().collect();
        let coefficient = coefficient.iter().copied().collect();
        let choice = choose(&reduction, &priority, &coefficient);
        let added = reduction.incidence.row_count() - graph.row_count();
        let dummies = choice.is_dummy.enumerate().filter(|(_, dummy)| **dummy);
        let dummies: Vec<u32> = dummies.map(|(col, _)| col.0).collect();
        assert_eq!(dummies.len(), added, "one dummy for each differentiation");
        (choice.states.iter().map(|col| col.0).collect(), dummies, choice.dependent)
    }

    /// Mattsson and Söderlind 1993, the pendulum x'' = F x, y'' = F y - g, x² + y² = L²: either
    /// coordinate and its velocity may be the states.
    #[test]
    fn pendulum() {
        // x x' x'' y y' y'' F
        let graph = graph_of(7, &[&[0, 2, 6], &[3, 5, 6], &[0, 3]]);
        let a = [(0, 1), (1, 2), (3, 4), (4, 5)];
        let varying = [Varying; 8];
        let x_wanted = chosen(&graph, &a, &[1, 1, 0, 0, 0, 0, 0], &varying);
        assert_eq!(x_wanted, (vec![0, 1], vec![4, 5], 0));
        let y_wanted = chosen(&graph, &a, &[0, 0, 0, 1, 1, 0, 0], &varying);
        assert_eq!(y_wanted, (vec![3, 4], vec![1, 2], 0));
    }

    /// The linear example of Mattsson and Söderlind 1993: x1 + x2 + u1 = 0, x1 + x2 + x3 + u2 = 0,
    /// x1 + x3' + x4 + u3 = 0, 2 x1'' + x2'' + x3'' + x4' + u4 = 0. x3 is never a state, nor is x4;
    /// one of x1 and x2 is. The columns of x1, x2 and x4 can be matched but are dependent.
    #[test]
    fn linear_system_of_the_paper_in_which_a_matching_is_not_enough() {
        // x1 x1' x1'' x2 x2' x2'' x3 x3' x3'' x4 x4'
        let rows: [&[u32]; 4] = [&[0, 3], &[0, 3, 6], &[0, 7, 9], &[2, 5, 8, 10]];
        let graph = graph_of(11, &rows);
        let a = [(0, 1), (1, 2), (3, 4), (4, 5), (6, 7), (7, 8), (9, 10)];
        let mut ones = [Constant(1.0); 12];
        ones[8] = Constant(2.0);
        let (states, dummies, dependent) = chosen(&graph, &a, &[], &ones);
        assert_eq!((states, dependent), (vec![3, 4], 0));
        assert_eq!(dummies, [1, 2, 7, 8, 10]);
        // The highest priorities for x1 and x3 can keep x1 only.
        let wanted = [5, 5, 5, 0, 0, 0, 9, 9, 9, 0, 0];
        assert_eq!(chosen(&graph, &a, &wanted, &ones).0, [0, 1]);
    }

    /// Two rotors on one gear, w1' = q, w2' = q + ..., w1 = n w2: priorities decide first, then
    /// constant coefficients, then the lower number.
    #[test]
    fn priorities_before_constants_before_numbers() {
        // w1 w2 w1' w2' q
        let graph = graph_of(5, &[&[2, 4], &[3, 4], &[0, 1]]);
        let a = [(0, 2), (1, 3)];
        let solvable_for = |first, second| [Varying, Varying, Varying, Varying, first, second];
        let states = |priority: &[i32], first, second| {
            chosen(&graph, &a, priority, &solvable_for(first, second)).0
        };
        assert_eq!(states(&[], Constant(1.0), Constant(-3.0)), [1]);
        assert_eq!(states(&[], Varying, Constant(-3.0)), [0]);
        assert_eq!(states(&[], Parameter, Constant(-3.0)), [0]);
        assert_eq!(states(&[], Parameter, Varying), [1]);
        assert_eq!(states(&[0, -1], Constant(1.0), Varying), [0]);
        assert_eq!(states(&[0, 0], Constant(0.0), Varying), [0]);
    }

    /// An energy balance u' = q with u = c T: u' is computed in a block of its own before T', so
    /// the paper's choice is u as a state; a priority for T is honoured if c does not vary.
    #[test]
    fn a_priority_across_blocks_is_honoured_if_the_coefficient_does_not_vary() {
        // u T u' T'; T' occurs because T is preferred as a state: z = T', z in column 4.
        let graph = graph_of(5, &[&[2], &[0, 1], &[3, 4]]);
        let a = [(0, 2), (1, 3)];
        let coefficients = |u| [Constant(1.0), u, Varying, Constant(1.0), Constant(1.0)];
        let states = |priority: &[i32], u| chosen(&graph, &a, priority, &coefficients(u)).0;
        assert_eq!(states(&[], Constant(1.0)), [0]);
        assert_eq!(states(&[0, 1], Constant(1.0)), [1]);
        assert_eq!(states(&[0, 1], Varying), [0]);
    }

    #[test]
    fn contradicting_constraints_are_counted() {
        // x + y = 1, 2 x + 2 y = f with x' = f, y' = g.
        let graph = graph_of(6, &[&[2, 4], &[3, 5], &[0, 1], &[0, 1]]);
        let a = [(0, 2), (1, 3)];
        let mut coefficients = [Constant(1.0); 8];
        coefficients[6] = Constant(2.0);
        coefficients[7] = Constant(2.0);
        let (states, dummies, dependent) = chosen(&graph, &a, &[], &coefficients);
        assert_eq!((states, dummies, dependent), (vec![], vec![2, 3], 1));
    }

    /// The remaining system, with states known, is square and structurally regular: n masses joined
    /// to one, all rows of all orders against all unknowns that are not states.
    #[test]
    fn the_system_with_dummies_determines_all_unknowns() {
        let n = 40;
        let (graph, a) = rigid_chain(n);
        let reduction = pantelides(&graph, &a, &[], &[]).unwrap();
        let mut priority = IndexVec::filled(0, 2 * n);
        priority[Col(7)] = 1;
        // Higher than the priority of x7, which its velocity inherits.
        priority[Col::from_usize(n + 9)] = 2;
        let choice = choose(&reduction, &priority, &IndexVec::new());
        assert_eq!(choice.states, [Col(7), Col::from_usize(n + 9)]);
        assert_eq!(choice.dependent, 0);
        let all = &reduction.incidence;
        let unknown = |_: Edge, col: Col| !choice.states.contains(&col);
        let matching = crate::graph::matching::maximum(all, unknown, Matching::empty(all));
        assert_eq!(matching.cardinality(), all.row_count());
        assert_eq!(matching.cardinality() + choice.states.len(), all.col_count());
    }
}
