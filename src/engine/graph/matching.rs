//! Maximum matching of equations and unknowns.
//!
//! Hopcroft and Karp, "An n^(5/2) algorithm for maximum matchings in bipartite graphs", SIAM J.
//! Comput. 2(4), 1973. Nothing here recurses, and ties go to the lowest number, so results are
//! reproducible.

use super::bipartite::{Bipartite, Col, Edge, Row};
use crate::base::index::{Id, IndexVec};

/// A set of edges no two of which share a row or a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Matching<R: Id = Row, C: Id = Col> {
    /// The column of each row, if it has one.
    pub row_to_col: IndexVec<R, Option<C>>,
    /// The row of each column, if it has one: the inverse of `row_to_col`.
    pub col_to_row: IndexVec<C, Option<R>>,
}

impl<R: Id, C: Id> Matching<R, C> {
    /// An empty matching of the size of a graph.
    pub fn empty(graph: &Bipartite<R, C>) -> Self {
        Matching {
            row_to_col: IndexVec::filled(None, graph.row_count()),
            col_to_row: IndexVec::filled(None, graph.col_count()),
        }
    }

    /// Number of pairs.
    pub fn cardinality(&self) -> usize {
        self.row_to_col.iter().flatten().count()
    }

    /// The pairs, ascending by row.
    pub fn pairs(&self) -> impl Iterator<Item = (R, C)> {
        self.row_to_col.enumerate().filter_map(|(row, col)| Some((row, (*col)?)))
    }

    /// The rows without a column, ascending.
    pub fn free_rows(&self) -> impl Iterator<Item = R> {
        self.row_to_col.enumerate().filter(|(_, col)| col.is_none()).map(|(row, _)| row)
    }

    /// The columns without a row, ascending.
    pub fn free_cols(&self) -> impl Iterator<Item = C> {
        self.col_to_row.enumerate().filter(|(_, row)| row.is_none()).map(|(col, _)| col)
    }

    /// Makes a row and a column partners. Former partners must be joined or separated as well.
    pub fn join(&mut self, row: R, col: C) {
        self.row_to_col[row] = Some(col);
        self.col_to_row[col] = Some(row);
    }

    /// Dissolves the pair of a row, if there is one.
    pub fn separate(&mut self, row: R) {
        if let Some(col) = self.row_to_col[row].take() {
            self.col_to_row[col] = None;
        }
    }

    /// Resizes the matching after rows or columns were added to the graph.
    pub fn grow(&mut self, graph: &Bipartite<R, C>) {
        self.row_to_col.resize(graph.row_count(), None);
        self.col_to_row.resize(graph.col_count(), None);
    }
}

/// A maximum matching over the admissible edges, starting from `initial` (whose pairs must be
/// admissible; rows and columns matched there stay matched, perhaps with other partners).
///
/// Hopcroft and Karp 1973: O(edges · √nodes).
pub fn maximum<R: Id, C: Id>(
    graph: &Bipartite<R, C>,
    admissible: impl Fn(Edge, C) -> bool,
    initial: Matching<R, C>,
) -> Matching<R, C> {
    let mut matching = initial;
    match_greedily(graph, &admissible, &mut matching);
    let mut phase = HopcroftKarpPhase {
        level: IndexVec::filled(None, graph.row_count()),
        cursor: IndexVec::filled(0, graph.row_count()),
        queue: Vec::new(),
        path: Vec::new(),
    };
    while phase.layer(graph, &admissible, &matching) {
        for root in graph.rows() {
            if matching.row_to_col[root].is_none() {
                phase.augment(graph, &admissible, &mut matching, root);
            }
        }
    }
    matching
}

/// A maximum matching that uses cheap edges where it can: `cost` is a class per edge (0 is best),
/// `None` forbids the edge.
///
/// A maximum matching of the cheapest class is extended with the next class, and so on. The
/// cardinality is the maximum; the number of expensive edges is small but not always minimal,
/// because an augmenting path may exchange a cheap edge for an expensive one.
pub fn maximum_preferring<R: Id, C: Id>(
    graph: &Bipartite<R, C>,
    cost: &IndexVec<Edge, Option<u8>>,
    initial: Matching<R, C>,
) -> Matching<R, C> {
    let mut classes: Vec<u8> = cost.iter().flatten().copied().collect();
    classes.sort_unstable();
    classes.dedup();
    classes.into_iter().fold(initial, |matching, limit| {
        maximum(graph, |edge, _| cost[edge].is_some_and(|class| class <= limit), matching)
    })
}

/// Matches each free row with its first free column: most of a matching in a single pass.
fn match_greedily<R: Id, C: Id>(
    graph: &Bipartite<R, C>,
    admissible: &impl Fn(Edge, C) -> bool,
    matching: &mut Matching<R, C>,
) {
    for row in graph.rows() {
        if matching.row_to_col[row].is_none() {
            let free = |col: C| matching.col_to_row[col].is_none();
            let mut ends = graph.edges(row).map(|edge| (edge, graph.col(edge)));
            if let Some((_, col)) = ends.find(|&(edge, col)| free(col) && admissible(edge, col)) {
                matching.join(row, col);
            }
        }
    }
}

/// Work space of the phases of Hopcroft and Karp, in each of which a set of disjoint shortest
/// augmenting paths is found.
struct HopcroftKarpPhase<R: Id> {
    /// Length of the shortest alternating path from a free row, in rows; `None` once spent.
    level: IndexVec<R, Option<u32>>,
    /// The edge each row tries next.
    cursor: IndexVec<R, usize>,
    queue: Vec<R>,
    path: Vec<R>,
}

impl<R: Id> HopcroftKarpPhase<R> {
    /// Layers the rows breadth first; true if a free column can be reached.
    fn layer<C: Id>(
        &mut self,
        graph: &Bipartite<R, C>,
        admissible: &impl Fn(Edge, C) -> bool,
        matching: &Matching<R, C>,
    ) -> bool {
        self.queue.clear();
        for row in graph.rows() {
            self.cursor[row] = graph.range(row).start;
            self.level[row] = None;
            if matching.row_to_col[row].is_none() {
                self.level[row] = Some(0);
                self.queue.push(row);
            }
        }
        // The level of the nearest free column; rows at this depth cannot lie on a shortest path.
        let mut deepest = None;
        let mut next = 0;
        while let Some(&row) = self.queue.get(next) {
            next += 1;
            let below = self.level[row].map(|level| level + 1);
            if deepest.is_some() && below > deepest {
                break;
            }
            for edge in graph.edges(row) {
                let col = graph.col(edge);
                if admissible(edge, col) {
                    match matching.col_to_row[col] {
                        None => deepest = below,
                        Some(partner) if self.level[partner].is_none() => {
                            self.level[partner] = below;
                            self.queue.push(partner);
                        }
                        Some(_) => {}
                    }
                }
            }
        }
        deepest.is_some()
    }

    /// Follows the layers depth first from a free row and flips the path if it ends in a free
    /// column. No row is visited again after the search has left it, so a phase is linear.
    fn augment<C: Id>(
        &mut self,
        graph: &Bipartite<R, C>,
        admissible: &impl Fn(Edge, C) -> bool,
        matching: &mut Matching<R, C>,
        root: R,
    ) {
        self.path.clear();
        self.path.push(root);
        while let Some(&row) = self.path.last() {
            if self.cursor[row] == graph.range(row).end {
                self.level[row] = None;
                self.path.pop();
                if let Some(&above) = self.path.last() {
                    self.cursor[above] += 1;
                }
                continue;
            }
            let edge = Edge::from_usize(self.cursor[row]);
            let col = graph.col(edge);
            let partner = matching.col_to_row[col];
            if !admissible(edge, col) {
                self.cursor[row] += 1;
            } else if let Some(partner) = partner {
                let below = self.level[row].map(|level| level + 1);
                if self.level[partner].is_some() && self.level[partner] == below {
                    self.path.push(partner);
                } else {
                    self.cursor[row] += 1;
                }
            } else {
                for &row in &self.path {
                    self.level[row] = None;
                    matching.join(row, graph.col(Edge::from_usize(self.cursor[row])));
                }
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::test_graphs::{Xorshift, cardinality_by_brute_force, graph_of, random_graph};

    fn maximum_of(graph: &Bipartite) -> Matching {
        maximum(graph, |_, _| true, Matching::empty(graph))
    }

    fn assert_consistent(graph: &Bipartite, matching: &Matching) {
        for (row, col) in matching.pairs() {
            assert_eq!(matching.col_to_row[col], Some(row));
            assert!(graph.edge(row, col).is_some());
        }
        assert_eq!(matching.cardinality(), matching.col_to_row.iter().flatten().count());
    }

    #[test]
    fn a_blocked_row_moves_all_the_others() {
        let graph = graph_of(4, &[&[0, 1], &[1, 2], &[2, 3], &[0]]);
        let expected = [(0, 1), (1, 2), (2, 3), (3, 0)].map(|(row, col)| (Row(row), Col(col)));
        assert_eq!(maximum_of(&graph).pairs().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn cardinality_agrees_with_brute_force() {
        let mut random = Xorshift::new(1973);
        for round in 0..600 {
            let rows = 1 + random.below(8);
            let cols = 1 + random.below(8);
            let graph = random_graph(&mut random, rows, cols, round % 24);
            let matching = maximum_of(&graph);
            assert_consistent(&graph, &matching);
            assert_eq!(matching.cardinality(), cardinality_by_brute_force(&graph), "{graph:?}");
        }
    }

    #[test]
    fn forbidden_edges_are_never_used_and_initial_partners_stay_matched() {
        let mut random = Xorshift::new(5);
        for _ in 0..300 {
            let graph = random_graph(&mut random, 7, 7, 20);
            let allowed: Vec<bool> = (0..graph.edge_count()).map(|_| random.below(3) > 0).collect();
            let keep = |edge: Edge| allowed[edge.idx()];
            let thinned = Bipartite::from_rows(
                7,
                graph.rows().map(|r| graph.edges(r).filter(|e| keep(*e)).map(|e| graph.col(e))),
            );
            let mut initial = Matching::empty(&graph);
            let start = graph.rows().flat_map(|r| graph.edges(r).map(move |e| (r, e)));
            if let Some((row, edge)) = start.into_iter().find(|(_, edge)| keep(*edge)) {
                initial.join(row, graph.col(edge));
            }
            let matching = maximum(&graph, |edge, _| keep(edge), initial.clone());
            assert_consistent(&thinned, &matching);
            assert_eq!(matching.cardinality(), cardinality_by_brute_force(&thinned));
            for (row, col) in initial.pairs() {
                assert!(matching.row_to_col[row].is_some() && matching.col_to_row[col].is_some());
            }
        }
    }

    #[test]
    fn cheap_edges_are_preferred_but_never_at_the_expense_of_cardinality() {
        // Both rows prefer column 1; only row 1 has no other.
        let graph = graph_of(2, &[&[0, 1], &[1]]);
        let cost = [Some(1), Some(0), Some(1)].into_iter().collect();
        let matching = maximum_preferring(&graph, &cost, Matching::empty(&graph));
        assert_eq!(matching.row_to_col.as_slice(), [Some(Col(0)), Some(Col(1))]);
        // With a choice, the cheap diagonal is taken although the other edges come first.
        let graph = graph_of(3, &[&[0, 2], &[0, 1], &[1, 2]]);
        let cost = [Some(3), Some(0), Some(0), Some(3), Some(0), Some(3)].into_iter().collect();
        let matching = maximum_preferring(&graph, &cost, Matching::empty(&graph));
        assert_eq!(matching.row_to_col.as_slice(), [Some(Col(2)), Some(Col(0)), Some(Col(1))]);
        // A forbidden edge stays out.
        let cost = [None, Some(0), Some(0), Some(3), None, None].into_iter().collect();
        let matching = maximum_preferring(&graph, &cost, Matching::empty(&graph));
        assert_eq!(matching.row_to_col.as_slice(), [Some(Col(2)), Some(Col(0)), None]);
    }

    /// Row i sees columns i and i+1, the last row only the first column: one augmenting path as
    /// long as the system, which would overflow the stack of a recursive search.
    #[test]
    fn a_path_of_three_hundred_thousand_rows_is_flipped() {
        let n = 300_000;
        let row = |i: usize| if i + 1 < n { vec![i, i + 1] } else { vec![0] };
        let rows = (0..n).map(|i| row(i).into_iter().map(Col::from_usize));
        let matching = maximum_of(&Bipartite::from_rows(n, rows));
        assert_eq!(matching.cardinality(), n);
        assert_eq!(matching.row_to_col[Row(0)], Some(Col(1)));
    }
}
