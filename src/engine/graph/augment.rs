//! Augments a matching by one pair: the step that Pantelides' algorithm and state selection take.
//!
//! Depth-first search for an augmenting path with lookahead: I. S. Duff, "On algorithms for
//! obtaining a maximum transversal", ACM TOMS 7(3), 1981. Iterative.

use super::bipartite::{Bipartite, Col, Edge, Row};
use super::matching::Matching;
use crate::base::index::{Id, IndexVec};

/// The search for one augmenting path, its work space, and the nodes it reached.
///
/// Nodes reached by a failed search remain dead ends while the graph and the filter are unchanged,
/// even after other searches have succeeded. They are skipped until
/// [`AugmentingSearch::discard_marks`].
pub struct AugmentingSearch<R: Id = Row, C: Id = Col> {
    row_seen: IndexVec<R, Option<Epoch>>,
    col_seen: IndexVec<C, Option<Epoch>>,
    epoch: Epoch,
    rows: Vec<R>,
    cols: Vec<C>,
    path: Vec<PathStep<R>>,
}

/// Counts calls of [`AugmentingSearch::discard_marks`]; marks of older epochs do not count.
type Epoch = std::num::NonZeroU32;

/// A row on the path and the position of the edge to try next; the path follows the previous edge.
struct PathStep<R> {
    row: R,
    next: usize,
}

impl<R: Id, C: Id> AugmentingSearch<R, C> {
    /// A search that has visited no node.
    pub fn new() -> Self {
        AugmentingSearch {
            row_seen: IndexVec::new(),
            col_seen: IndexVec::new(),
            epoch: Epoch::MIN,
            rows: Vec::new(),
            cols: Vec::new(),
            path: Vec::new(),
        }
    }

    /// Discards the marks of failed searches: necessary after the graph or the filter has changed.
    pub fn discard_marks(&mut self) {
        self.epoch = self.epoch.checked_add(1).unwrap_or_else(|| {
            self.row_seen = IndexVec::new();
            self.col_seen = IndexVec::new();
            Epoch::MIN
        });
    }

    /// Tries to match a free `start` over admissible edges; true if it succeeded. Rows and columns
    /// already matched stay matched, perhaps with other partners. Linear in the edges reached.
    pub fn augment(
        &mut self,
        graph: &Bipartite<R, C>,
        matching: &mut Matching<R, C>,
        start: R,
        admissible: impl Fn(Edge, C) -> bool,
    ) -> bool {
        self.row_seen.resize(graph.row_count(), None);
        self.col_seen.resize(graph.col_count(), None);
        self.rows.clear();
        self.cols.clear();
        self.path.clear();
        let mut entered = Some(start);
        loop {
            if let Some(row) = entered {
                self.row_seen[row] = Some(self.epoch);
                self.rows.push(row);
                let free = |edge: &Edge| {
                    let col = graph.col(*edge);
                    matching.col_to_row[col].is_none() && admissible(*edge, col)
                };
                if let Some(edge) = graph.edges(row).find(free) {
                    self.path.push(PathStep { row, next: edge.idx() + 1 });
                    self.flip(graph, matching);
                    return true;
                }
                self.path.push(PathStep { row, next: graph.range(row).start });
            }
            if self.path.is_empty() {
                return false;
            }
            entered = self.advance(graph, matching, &admissible);
        }
    }

    /// The rows the last search reached, its start first. If it failed, this is the minimal set of
    /// rows around the start with fewer columns than rows (the coloured E-nodes of Pantelides).
    pub fn rows(&self) -> &[R] {
        &self.rows
    }

    /// The matched columns the last search tried. If it failed, these are all admissible columns
    /// of [`AugmentingSearch::rows`], one fewer than the rows (the coloured V-nodes of Pantelides).
    pub fn cols(&self) -> &[C] {
        &self.cols
    }

    /// Moves on from the last row of the path: to the partner of its next new column, or back.
    fn advance(
        &mut self,
        graph: &Bipartite<R, C>,
        matching: &Matching<R, C>,
        admissible: &impl Fn(Edge, C) -> bool,
    ) -> Option<R> {
        let step = self.path.last_mut()?;
        while step.next < graph.range(step.row).end {
            let edge = Edge::from_usize(step.next);
            let col = graph.col(edge);
            step.next += 1;
            if self.col_seen[col] != Some(self.epoch) && admissible(edge, col) {
                self.col_seen[col] = Some(self.epoch);
                self.cols.push(col);
                let partner = matching.col_to_row[col];
                let new = partner.filter(|&row| self.row_seen[row] != Some(self.epoch));
                if new.is_some() {
                    return new;
                }
            }
        }
        self.path.pop();
        None
    }

    /// Exchanges matched and unmatched edges along the path, and unmarks what this search saw:
    /// the nodes of a success may help the next one.
    fn flip(&mut self, graph: &Bipartite<R, C>, matching: &mut Matching<R, C>) {
        for step in &self.path {
            matching.join(step.row, graph.col(Edge::from_usize(step.next - 1)));
        }
        for &row in &self.rows {
            self.row_seen[row] = None;
        }
        for &col in &self.cols {
            self.col_seen[col] = None;
        }
    }
}

impl<R: Id, C: Id> Default for AugmentingSearch<R, C> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::test_graphs::{Xorshift, cardinality_by_brute_force, graph_of, random_graph};

    #[test]
    fn row_by_row_reaches_the_maximum_with_and_without_discarding_marks() {
        let mut random = Xorshift::new(1981);
        for round in 0..400 {
            let graph = random_graph(&mut random, 8, 7, round % 26);
            for discards in [true, false] {
                let mut search = AugmentingSearch::new();
                let mut matching = Matching::empty(&graph);
                let mut found = 0;
                for row in graph.rows() {
                    if discards {
                        search.discard_marks();
                    }
                    found += usize::from(search.augment(&graph, &mut matching, row, |_, _| true));
                }
                assert_eq!(found, matching.cardinality());
                assert_eq!(found, cardinality_by_brute_force(&graph), "{graph:?}");
            }
        }
    }

    #[test]
    fn a_failed_search_reaches_a_minimal_singular_set() {
        let mut random = Xorshift::new(3);
        let mut failures = 0;
        for _ in 0..300 {
            let graph = random_graph(&mut random, 7, 6, 12);
            let mut search = AugmentingSearch::new();
            let mut matching = Matching::empty(&graph);
            for row in graph.rows() {
                search.discard_marks();
                if search.augment(&graph, &mut matching, row, |_, _| true) {
                    continue;
                }
                failures += 1;
                let rows = search.rows();
                assert_eq!(rows.len(), search.cols().len() + 1);
                let without = |left_out: Option<Row>| {
                    let kept = rows.iter().filter(|&&row| Some(row) != left_out);
                    let kept = Bipartite::from_rows(6, kept.map(|&r| graph.cols(r).to_vec()));
                    (kept.row_count(), cardinality_by_brute_force(&kept))
                };
                assert_eq!(without(None), (rows.len(), rows.len() - 1));
                for &row in rows {
                    assert_eq!(without(Some(row)), (rows.len() - 1, rows.len() - 1));
                }
            }
        }
        assert!(failures > 100, "the sample must contain singular sets, found {failures}");
    }

    #[test]
    fn inadmissible_columns_are_not_entered() {
        let graph = graph_of(2, &[&[0], &[0, 1]]);
        let mut matching = Matching::empty(&graph);
        let mut search = AugmentingSearch::new();
        let admissible = |_: Edge, col: Col| col == Col(0);
        assert!(search.augment(&graph, &mut matching, Row(0), admissible));
        assert!(!search.augment(&graph, &mut matching, Row(1), admissible));
        assert_eq!(search.rows(), [Row(1), Row(0)]);
        assert_eq!(search.cols(), [Col(0)]);
    }
}
