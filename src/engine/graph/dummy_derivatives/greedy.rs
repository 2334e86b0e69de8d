//! The greedy selection of independent columns (Edmonds 1971).

use super::DummyCandidate;
use super::jacobian::{ConstraintJacobian, EdgeClass};
use crate::base::index::IndexVec;
use crate::graph::augment::AugmentingSearch;
use crate::graph::bipartite::{Col, Edge, Row};
use crate::graph::matching::Matching;
use crate::graph::rank::Echelon;

/// The greedy algorithm of one round.
pub(super) struct GreedyRound<'a> {
    jacobian: &'a ConstraintJacobian,
    /// The rows of this round.
    in_round: IndexVec<Row, bool>,
    /// Number of rows that have no column yet.
    pub(super) missing: usize,
    pub(super) matching: Matching<Col, Row>,
    search: AugmentingSearch<Col, Row>,
    echelon: Echelon,
    /// Columns that depend on those selected.
    rejected: IndexVec<Col, bool>,
}

impl<'a> GreedyRound<'a> {
    pub(super) fn new(jacobian: &'a ConstraintJacobian, in_round: impl Fn(Row) -> bool) -> Self {
        let mut rows = IndexVec::filled(false, jacobian.graph.col_count());
        let mut missing = 0;
        for &row in jacobian.rows.iter().filter(|&&row| in_round(row)) {
            rows[row] = true;
            missing += 1;
        }
        GreedyRound {
            jacobian,
            in_round: rows,
            missing,
            matching: Matching::empty(&jacobian.graph),
            search: AugmentingSearch::new(),
            echelon: Echelon::new(jacobian.graph.col_count()),
            rejected: IndexVec::filled(false, jacobian.graph.row_count()),
        }
    }

    /// Takes independent columns, group by group and in each by class, until all rows are matched.
    pub(super) fn take_independent(&mut self, groups: &[&[DummyCandidate]]) {
        let classes = self.jacobian.classes.iter();
        let (last, usual): (Vec<EdgeClass>, Vec<EdgeClass>) =
            classes.partition(|&&class| class == EdgeClass::LastResort);
        for classes in [usual, last] {
            for group in groups {
                for &class in &classes {
                    self.search.discard_marks();
                    for candidate in *group {
                        let top = candidate.top;
                        if self.missing > 0 && !self.rejected[top] && self.take(top, class) {
                            self.keep_if_independent(top);
                        }
                    }
                }
            }
        }
    }

    /// Takes columns that can be matched, without regard to values.
    pub(super) fn take_dependent(&mut self, candidates: &[DummyCandidate]) {
        self.search.discard_marks();
        for candidate in candidates {
            if self.missing > 0 {
                self.take(candidate.top, EdgeClass::LastResort);
            }
        }
    }

    /// Matches a free column over the edges up to a class, if possible.
    fn take(&mut self, top: Col, class: EdgeClass) -> bool {
        let ConstraintJacobian { graph, entries, .. } = self.jacobian;
        let in_round = &self.in_round;
        let in_play =
            |edge: Edge, row: Row| in_round[row] && entries[edge.0 as usize].class <= class;
        let taken = self.matching.row_to_col[top].is_none()
            && self.search.augment(graph, &mut self.matching, top, in_play);
        self.missing -= usize::from(taken);
        taken
    }

    /// Rejects a column again that depends on those selected before.
    fn keep_if_independent(&mut self, top: Col) {
        let ConstraintJacobian { graph, entries, .. } = self.jacobian;
        let column = graph.edges(top).map(|edge| (graph.col(edge), entries[edge.0 as usize].value));
        let in_round = &self.in_round;
        if !self.echelon.insert(column.filter(|&(row, _)| in_round[row])) {
            self.matching.separate(top);
            self.rejected[top] = true;
            self.missing += 1;
        }
    }
}
