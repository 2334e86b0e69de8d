//! Incidence of equations (rows) and variables (columns) in compressed sparse rows.
//!
//! One array of row ends and one of columns, whatever the number of rows: a system of ten million
//! incidences costs forty megabytes and no allocation per row.

use crate::base::index::{Id, IndexVec};

crate::define_id!(
    /// An equation: a left node of a [`Bipartite`] graph.
    pub struct Row
);
crate::define_id!(
    /// An unknown: a right node of a [`Bipartite`] graph.
    pub struct Col
);
crate::define_id!(
    /// An incidence of one row and one column: its position in the arrays of one graph.
    ///
    /// Edges count row by row and, within a row, by column, so a property of the incidences is an
    /// `IndexVec<Edge, _>`. Rows pushed later leave the numbers of the earlier edges alone.
    pub struct Edge
);

/// A bipartite graph, stored by rows with ascending columns and no duplicates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bipartite<R: Id = Row, C: Id = Col> {
    /// `ends[r]` is one past the last edge of row `r`.
    ends: IndexVec<R, Edge>,
    /// The column of every edge.
    cols: Vec<C>,
    col_count: usize,
}

impl<R: Id, C: Id> Bipartite<R, C> {
    /// A graph with `col_count` columns and no rows.
    pub fn new(col_count: usize) -> Self {
        Bipartite { ends: Default::default(), cols: Vec::new(), col_count }
    }

    /// A graph of the given rows; columns may come in any order and repeat.
    pub fn from_rows<I>(col_count: usize, rows: I) -> Self
    where
        I: IntoIterator<Item: IntoIterator<Item = C>>,
    {
        let mut graph = Self::new(col_count);
        for row in rows {
            graph.push_row(row);
        }
        graph
    }

    /// Appends a row; columns may come in any order and repeat. A column beyond the current count
    /// widens the graph.
    pub fn push_row(&mut self, cols: impl IntoIterator<Item = C>) -> R {
        let start = self.cols.len();
        self.cols.extend(cols);
        self.cols[start..].sort_unstable();
        let mut kept = start;
        for next in start..self.cols.len() {
            if kept == start || self.cols[kept - 1] != self.cols[next] {
                self.cols[kept] = self.cols[next];
                kept += 1;
            }
        }
        self.cols.truncate(kept);
        if let Some(last) = self.cols[start..].last() {
            self.col_count = self.col_count.max(last.idx() + 1);
        }
        self.ends.push(Edge::from_usize(kept))
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.ends.len()
    }

    /// Number of columns, with or without incidences.
    pub fn col_count(&self) -> usize {
        self.col_count
    }

    /// Number of incidences.
    pub fn edge_count(&self) -> usize {
        self.cols.len()
    }

    /// All rows in order.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = R> + ExactSizeIterator + use<R, C> {
        self.ends.ids()
    }

    /// The columns of a row, ascending.
    pub fn cols(&self, row: R) -> &[C] {
        &self.cols[self.range(row)]
    }

    /// The edges of a row, ascending by column.
    pub fn edges(&self, row: R) -> impl DoubleEndedIterator<Item = Edge> + use<R, C> {
        self.range(row).map(Edge::from_usize)
    }

    /// The column of an edge.
    pub fn col(&self, edge: Edge) -> C {
        self.cols[edge.idx()]
    }

    /// The edge that joins a row and a column, if they are incident.
    pub fn edge(&self, row: R, col: C) -> Option<Edge> {
        let range = self.range(row);
        let found = self.cols[range.clone()].binary_search(&col).ok()?;
        Some(Edge::from_usize(range.start + found))
    }

    /// The same graph seen from the columns.
    pub fn transposed(&self) -> Bipartite<C, R> {
        self.transposed_tracking(|_, _| ())
    }

    /// The same graph seen from the columns, and for each of its edges the edge of `self`.
    pub fn transposed_with_edges(&self) -> (Bipartite<C, R>, Vec<Edge>) {
        let mut origin = vec![Edge(0); self.cols.len()];
        let graph = self.transposed_tracking(|place, edge| origin[place] = edge);
        (graph, origin)
    }

    /// The subgraph of some rows and the columns that have a local number, both renumbered from
    /// zero: rows in the order given, columns by the injective function `local`. Also returns the
    /// edge of `self` for each edge. Costs the size of the rows only, so partitioning a system into
    /// blocks is linear.
    pub fn restricted(&self, rows: &[R], local: impl Fn(C) -> Option<C>) -> (Self, Vec<Edge>) {
        let mut graph = Self::new(0);
        let mut origin = Vec::new();
        let mut row_edges = Vec::new();
        for &row in rows {
            row_edges.clear();
            row_edges.extend(self.edges(row).filter_map(|e| Some((local(self.col(e))?, e))));
            row_edges.sort_unstable();
            graph.push_row(row_edges.iter().map(|&(col, _)| col));
            origin.extend(row_edges.iter().map(|&(_, edge)| edge));
        }
        (graph, origin)
    }

    /// The positions of the edges of a row, for cursors.
    pub(super) fn range(&self, row: R) -> std::ops::Range<usize> {
        let start = match row.idx() {
            0 => 0,
            i => self.ends[R::from_usize(i - 1)].idx(),
        };
        start..self.ends[row].idx()
    }

    /// Transposition by counting: linear, and rows come out ascending within each column.
    fn transposed_tracking(&self, mut place_edge: impl FnMut(usize, Edge)) -> Bipartite<C, R> {
        let mut ends = IndexVec::<C, Edge>::filled(Edge(0), self.col_count);
        for &col in &self.cols {
            ends[col].0 += 1;
        }
        // Each entry first holds the start of its column and, once filled, the end.
        let mut next = 0;
        for end in ends.iter_mut() {
            next += std::mem::replace(&mut end.0, next);
        }
        let mut rows = vec![R::from_usize(0); self.cols.len()];
        for row in self.rows() {
            for edge in self.edges(row) {
                let end = &mut ends[self.col(edge)];
                rows[end.idx()] = row;
                place_edge(end.idx(), edge);
                end.0 += 1;
            }
        }
        Bipartite { ends, cols: rows, col_count: self.row_count() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::test_graphs::{Xorshift, graph_of, random_graph};

    #[test]
    fn rows_are_sorted_without_duplicates() {
        let graph = graph_of(4, &[&[3, 1, 3, 0, 1], &[], &[2]]);
        assert_eq!(graph.cols(Row(0)), [Col(0), Col(1), Col(3)]);
        assert!(graph.cols(Row(1)).is_empty());
        assert_eq!(graph.cols(Row(2)), [Col(2)]);
        assert_eq!((graph.row_count(), graph.col_count(), graph.edge_count()), (3, 4, 4));
        assert_eq!(graph.edge(Row(0), Col(3)), Some(Edge(2)));
        assert_eq!(graph.edge(Row(0), Col(2)), None);
    }

    #[test]
    fn a_new_column_widens_the_graph() {
        let mut graph = graph_of(1, &[&[0]]);
        assert_eq!(graph.push_row([Col(6)]), Row(1));
        assert_eq!(graph.col_count(), 7);
    }

    #[test]
    fn transposing_swaps_every_incidence_and_twice_is_the_identity() {
        let mut random = Xorshift::new(7);
        for _ in 0..50 {
            let graph = random_graph(&mut random, 9, 6, 20);
            let (transposed, origin) = graph.transposed_with_edges();
            assert_eq!(transposed.row_count(), graph.col_count());
            for row in graph.rows() {
                for col in (0..6).map(Col) {
                    let there = transposed.edge(col, row);
                    assert_eq!(graph.edge(row, col), there.map(|e| origin[e.idx()]));
                }
            }
            assert_eq!(transposed.transposed(), graph);
        }
    }

    #[test]
    fn restricting_renumbers_rows_and_columns() {
        let graph = graph_of(5, &[&[0, 1], &[1, 3, 4], &[0, 3]]);
        // Column 4 becomes 0 and column 3 becomes 1, which reverses the order within the row.
        let local = |col: Col| [None, None, None, Some(Col(1)), Some(Col(0))][col.idx()];
        let (block, origin) = graph.restricted(&[Row(2), Row(1)], local);
        assert_eq!(block, graph_of(2, &[&[1], &[0, 1]]));
        assert_eq!(origin, [Edge(6), Edge(4), Edge(3)]);
    }

    #[test]
    fn a_million_rows_take_one_array() {
        let n = 1_000_000;
        let graph: Bipartite =
            Bipartite::from_rows(n + 2, (0..n).map(|i| (i..i + 3).map(Col::from_usize)));
        assert_eq!(graph.edge_count(), 3 * n);
        let transposed = graph.transposed();
        assert_eq!(transposed.cols(Col(0)), [Row(0)]);
        assert_eq!(transposed.cols(Col(500_000)), [Row(499_998), Row(499_999), Row(500_000)]);
    }
}
