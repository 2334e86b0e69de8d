//! Tearing: solve most of a block in sequence, iterate on the rest.
//!
//! Given values of the *tearing* columns of a block, its *explicit* rows yield the other columns
//! one after another, and the remaining *residual* rows measure the error of the given values.
//! Finding the fewest tearing columns is NP-complete, so heuristics are used: F. E. Cellier and E.
//! Kofman, "Continuous System Simulation", Springer 2006, chapter 7, in the variant MC3 of P.
//! Täuber, L. Ochel, W. Braun and B. Bachmann, "Practical realization and adaptation of Cellier's
//! tearing method", EOOLT 2014: tear the column with the most *points*, one for each row that
//! cannot be solved for it and one for each row that could be solved for another column once it is
//! known.

use super::bipartite::{Bipartite, Col, Edge, Row};
use crate::base::index::{Id, IndexVec};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// How willingly a column is chosen as a tearing column.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum TearingSelect {
    /// Only if nothing else completes the sequence.
    Never,
    /// Only if no other column is as good.
    Avoid,
    /// As the heuristic decides.
    #[default]
    Default,
    /// Before any column without a preference.
    Prefer,
    /// Unconditionally.
    Always,
}

/// A torn block. It has as many residual rows as tearing columns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TearingResult {
    /// Rows to be solved, in this order, each for its column.
    pub explicit: Vec<(Row, Col)>,
    /// Columns to be iterated on, ascending.
    pub tearing: Vec<Col>,
    /// Rows that must vanish, ascending.
    pub residual: Vec<Row>,
}

/// Tears a square block whose rows and columns are numbered from zero
/// ([`Bipartite::restricted`] extracts it).
///
/// - `solvable`: whether the row of each edge can be solved explicitly for its column.
/// - `select`: a preference for each column; columns beyond the end have none.
///
/// O(edges · log edges).
pub fn tear(
    graph: &Bipartite,
    solvable: &IndexVec<Edge, bool>,
    select: &IndexVec<Col, TearingSelect>,
) -> TearingResult {
    let mut block = TearingState::new(graph, solvable, select);
    for col in (0..graph.col_count()).map(Col::from_usize) {
        if select.get(col) == Some(&TearingSelect::Always) {
            block.tear_column(col);
        }
    }
    block.solve_ready_rows();
    while let Some(col) = block.best_candidate() {
        block.tear_column(col);
        block.solve_ready_rows();
    }
    block.into_result()
}

/// A block while its columns become known one by one.
struct TearingState<'a> {
    graph: &'a Bipartite,
    solvable: &'a IndexVec<Edge, bool>,
    select: &'a IndexVec<Col, TearingSelect>,
    rows_of: Bipartite<Col, Row>,
    known: IndexVec<Col, bool>,
    solved: IndexVec<Row, bool>,
    /// How many columns of each row are not known.
    unknowns: IndexVec<Row, usize>,
    /// For each column not known: the rows not solvable for it, and the rows with two unknowns
    /// that are solvable for the other one.
    points: IndexVec<Col, usize>,
    /// Rows with one unknown, in the order in which they reached this state.
    ready: VecDeque<Row>,
    /// Columns with their rank; entries whose rank has changed since are skipped.
    ranking: BinaryHeap<Rank>,
    torn: TearingResult,
}

/// The order of choice: preference, points, number of rows, and the lower number.
type Rank = (TearingSelect, usize, usize, Reverse<Col>);

impl<'a> TearingState<'a> {
    fn new(
        graph: &'a Bipartite,
        solvable: &'a IndexVec<Edge, bool>,
        select: &'a IndexVec<Col, TearingSelect>,
    ) -> Self {
        let mut block = TearingState {
            graph,
            solvable,
            select,
            rows_of: graph.transposed(),
            known: IndexVec::filled(false, graph.col_count()),
            solved: IndexVec::filled(false, graph.row_count()),
            unknowns: graph.rows().map(|row| graph.cols(row).len()).collect(),
            points: IndexVec::filled(0, graph.col_count()),
            ready: VecDeque::new(),
            ranking: BinaryHeap::new(),
            torn: TearingResult::default(),
        };
        for row in graph.rows() {
            for edge in graph.edges(row).filter(|&edge| !solvable[edge]) {
                block.points[graph.col(edge)] += 1;
            }
            block.count_unknowns(row);
        }
        block.ranking = block.known.ids().map(|col| block.rank(col)).collect();
        block
    }

    fn rank(&self, col: Col) -> Rank {
        let select = self.select.get(col).copied().unwrap_or_default();
        (select, self.points[col], self.rows_of.cols(col).len(), Reverse(col))
    }

    /// The column to tear next, if any is unknown.
    fn best_candidate(&mut self) -> Option<Col> {
        while let Some(rank) = self.ranking.pop() {
            let Reverse(col) = rank.3;
            if !self.known[col] && rank == self.rank(col) {
                return Some(col);
            }
        }
        None
    }

    fn tear_column(&mut self, col: Col) {
        self.torn.tearing.push(col);
        self.make_known(col);
    }

    /// Solves rows with one unknown until none is left.
    fn solve_ready_rows(&mut self) {
        while let Some(row) = self.ready.pop_front() {
            // Another row may have been solved for the unknown in the meantime.
            let [unknown, _] = self.first_unknowns(row);
            if let Some(edge) = unknown.filter(|&edge| self.solvable[edge]) {
                let col = self.graph.col(edge);
                self.solved[row] = true;
                self.torn.explicit.push((row, col));
                self.make_known(col);
            }
        }
    }

    fn make_known(&mut self, col: Col) {
        self.known[col] = true;
        for i in 0..self.rows_of.cols(col).len() {
            let row = self.rows_of.cols(col)[i];
            if self.solved[row] {
                continue;
            }
            self.unknowns[row] -= 1;
            // A row that had two unknowns no longer earns a point for the remaining one.
            let was_solvable = self.graph.edge(row, col).is_some_and(|edge| self.solvable[edge]);
            if self.unknowns[row] == 1
                && was_solvable
                && let [Some(edge), _] = self.first_unknowns(row)
            {
                self.add_point(self.graph.col(edge), false);
            }
            self.count_unknowns(row);
        }
    }

    /// Updates the ready queue and the points for a row with one or two unknowns left.
    fn count_unknowns(&mut self, row: Row) {
        if self.unknowns[row] == 1 {
            self.ready.push_back(row);
        } else if self.unknowns[row] == 2 {
            let [one, other] = self.first_unknowns(row);
            for (torn, solved) in [(one, other), (other, one)] {
                if let (Some(torn), true) = (torn, solved.is_some_and(|e| self.solvable[e])) {
                    self.add_point(self.graph.col(torn), true);
                }
            }
        }
    }

    /// The first two unknowns of a row.
    fn first_unknowns(&self, row: Row) -> [Option<Edge>; 2] {
        let is_unknown = |edge: &Edge| !self.known[self.graph.col(*edge)];
        let mut edges = self.graph.edges(row).filter(is_unknown);
        [edges.next(), edges.next()]
    }

    fn add_point(&mut self, col: Col, more: bool) {
        let points = &mut self.points[col];
        *points = if more { *points + 1 } else { *points - 1 };
        let rank = self.rank(col);
        self.ranking.push(rank);
    }

    fn into_result(mut self) -> TearingResult {
        self.torn.tearing.sort_unstable();
        self.torn.residual = self.graph.rows().filter(|&row| !self.solved[row]).collect();
        self.torn
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::test_graphs::{Xorshift, graph_of, random_square};

    fn all_solvable(graph: &Bipartite) -> IndexVec<Edge, bool> {
        IndexVec::filled(true, graph.edge_count())
    }

    fn tear_freely(graph: &Bipartite) -> TearingResult {
        tear(graph, &all_solvable(graph), &IndexVec::new())
    }

    /// Every explicit row has its own column solvable and all others known before; every row and
    /// every column is used exactly once.
    fn assert_causal(graph: &Bipartite, solvable: &IndexVec<Edge, bool>, torn: &TearingResult) {
        assert_eq!(torn.tearing.len(), torn.residual.len());
        let mut known = vec![false; graph.col_count()];
        let mut used = vec![false; graph.row_count()];
        for &col in &torn.tearing {
            assert!(!std::mem::replace(&mut known[col.idx()], true));
        }
        for &(row, col) in &torn.explicit {
            assert!(!std::mem::replace(&mut used[row.idx()], true));
            assert!(graph.edge(row, col).is_some_and(|edge| solvable[edge]));
            assert!(graph.cols(row).iter().all(|&other| other == col || known[other.idx()]));
            assert!(!std::mem::replace(&mut known[col.idx()], true));
        }
        for &row in &torn.residual {
            assert!(!std::mem::replace(&mut used[row.idx()], true));
        }
        assert!(known.into_iter().chain(used).all(|used| used));
    }

    /// Cellier and Kofman 2006, chapter 7: three resistors at a known voltage u0,
    /// u1 = R1 i1, u2 = R2 i2, u3 = R3 i3, u0 = u1 + u3, u3 = u2, i1 = i2 + i3: one tearing
    /// variable of six.
    #[test]
    fn resistor_network_of_cellier_takes_one_tearing_variable() {
        // u1 u2 u3 i1 i2 i3
        let graph = graph_of(6, &[&[0, 3], &[1, 4], &[2, 5], &[0, 2], &[1, 2], &[3, 4, 5]]);
        let torn = tear_freely(&graph);
        assert_eq!((torn.tearing.len(), torn.explicit.len()), (1, 5));
        // u3 occurs in three rows with two unknowns each and earns most points.
        assert_eq!(torn.tearing, [Col(2)]);
        assert_causal(&graph, &all_solvable(&graph), &torn);
    }

    /// The same network with a diode in place of R1: i1 = f(u1) cannot be solved for u1.
    #[test]
    fn a_nonlinear_element_is_respected() {
        let graph = graph_of(6, &[&[0, 3], &[1, 4], &[2, 5], &[0, 2], &[1, 2], &[3, 4, 5]]);
        let mut solvable = all_solvable(&graph);
        solvable[Edge(0)] = false;
        let torn = tear(&graph, &solvable, &IndexVec::new());
        assert_eq!(torn.tearing.len(), 1);
        assert_causal(&graph, &solvable, &torn);
    }

    #[test]
    fn preferences_come_before_points() {
        let graph = graph_of(6, &[&[0, 3], &[1, 4], &[2, 5], &[0, 2], &[1, 2], &[3, 4, 5]]);
        let mut select = IndexVec::filled(TearingSelect::Default, 6);
        select[Col(2)] = TearingSelect::Never;
        select[Col(3)] = TearingSelect::Prefer;
        let torn = tear(&graph, &all_solvable(&graph), &select);
        assert_eq!(torn.tearing, [Col(3)]);
        select[Col(4)] = TearingSelect::Always;
        select[Col(5)] = TearingSelect::Always;
        let torn = tear(&graph, &all_solvable(&graph), &select);
        assert_eq!(torn.tearing, [Col(4), Col(5)]);
        assert_causal(&graph, &all_solvable(&graph), &torn);
        // If all columns are `Never`, one of them is torn all the same.
        let torn = tear(&graph, &all_solvable(&graph), &IndexVec::filled(TearingSelect::Never, 6));
        assert_eq!(torn.tearing, [Col(2)]);
    }

    #[test]
    fn without_solvable_edges_every_column_is_torn() {
        let graph = graph_of(2, &[&[0, 1], &[0, 1]]);
        let torn = tear(&graph, &IndexVec::filled(false, 4), &IndexVec::new());
        assert_eq!((torn.tearing.len(), torn.residual.len(), torn.explicit.len()), (2, 2, 0));
    }

    #[test]
    fn random_blocks_are_causal_and_close_to_the_minimum() {
        let mut random = Xorshift::new(2014);
        let (mut torn_columns, mut fewest) = (0, 0);
        for round in 0..200 {
            let n = 7;
            let graph = random_square(&mut random, n, 4 + round % 16);
            let solvable = (0..graph.edge_count()).map(|_| random.below(4) > 0).collect();
            let torn = tear(&graph, &solvable, &IndexVec::new());
            assert_causal(&graph, &solvable, &torn);
            let best = minimal_tearing(&graph, &solvable);
            assert!(torn.tearing.len() >= best);
            torn_columns += torn.tearing.len();
            fewest += best;
        }
        assert!(torn_columns * 10 <= fewest * 12, "{torn_columns} torn, {fewest} needed");
    }

    /// The size of the smallest set of columns from which all others follow, by trying every set.
    fn minimal_tearing(graph: &Bipartite, solvable: &IndexVec<Edge, bool>) -> usize {
        let n = graph.col_count();
        let follows_all = |torn: u32| {
            let mut known = torn;
            let mut solved = vec![false; n];
            loop {
                let next = graph.rows().filter(|row| !solved[row.idx()]).find_map(|row| {
                    let mut unknown =
                        graph.edges(row).filter(|&e| known >> graph.col(e).0 & 1 == 0);
                    let edge = unknown.next().filter(|&edge| solvable[edge])?;
                    unknown.next().is_none().then_some((row, graph.col(edge)))
                });
                let Some((row, col)) = next else { return known == (1 << n) - 1 };
                solved[row.idx()] = true;
                known |= 1 << col.0;
            }
        };
        (0..1_u32 << n)
            .filter(|&torn| follows_all(torn))
            .map(|torn| torn.count_ones() as usize)
            .min()
            .unwrap_or(n)
    }

    #[test]
    fn a_large_ring_takes_one_tearing_variable_and_a_ladder_two() {
        let n = 200_000;
        let ring = |i: usize| [i, (i + 1) % n].map(Col::from_usize);
        let graph = Bipartite::from_rows(n, (0..n).map(ring));
        assert_eq!(tear_freely(&graph).tearing.len(), 1);
        let ladder = |i: usize| [i, (i + 1) % n, (i + 2) % n].map(Col::from_usize);
        let graph = Bipartite::from_rows(n, (0..n).map(ladder));
        let torn = tear_freely(&graph);
        assert_eq!(torn.tearing.len(), 2);
        assert_causal(&graph, &all_solvable(&graph), &torn);
    }
}
