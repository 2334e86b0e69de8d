//! Which equations contradict each other and which unknowns are left free.
//!
//! The coarse decomposition of A. L. Dulmage and N. S. Mendelsohn, "Coverings of bipartite graphs",
//! Canad. J. Math. 10, 1958, by the search of A. Pothen and C.-J. Fan, "Computing the block
//! triangular form of a sparse matrix", ACM TOMS 16(4), 1990. It does not depend on which maximum
//! matching is given.

use super::bipartite::{Bipartite, Col, Row};
use super::matching::Matching;
use crate::base::index::{Id, IndexVec};

/// A subsystem: rows and columns, both ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Subsystem {
    /// The equations.
    pub rows: Vec<Row>,
    /// The unknowns.
    pub cols: Vec<Col>,
}

/// The three subsystems; every row and every column is in exactly one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Decomposition {
    /// More equations than unknowns: reached by alternating paths from unmatched rows. Contains
    /// all columns of its rows.
    pub over_determined: Subsystem,
    /// As many equations as unknowns, and a perfect matching.
    pub well_determined: Subsystem,
    /// More unknowns than equations: reached by alternating paths from unmatched columns. Contains
    /// all rows of its columns.
    pub under_determined: Subsystem,
}

/// Decomposes a graph, given a *maximum* matching. Linear.
pub fn decompose(graph: &Bipartite, matching: &Matching) -> Decomposition {
    let over = reached(graph, &matching.row_to_col, &matching.col_to_row);
    let under = reached(&graph.transposed(), &matching.col_to_row, &matching.row_to_col);
    let mut parts = Decomposition::default();
    for row in graph.rows() {
        let part = match (over.0[row], under.1[row]) {
            (true, _) => &mut parts.over_determined,
            (false, true) => &mut parts.under_determined,
            (false, false) => &mut parts.well_determined,
        };
        part.rows.push(row);
    }
    for (col, &is_over) in over.1.enumerate() {
        let part = match (is_over, under.0[col]) {
            (true, _) => &mut parts.over_determined,
            (false, true) => &mut parts.under_determined,
            (false, false) => &mut parts.well_determined,
        };
        part.cols.push(col);
    }
    parts
}

/// The nodes of both sides on alternating paths from the unmatched nodes of the left side.
fn reached<R: Id, C: Id>(
    graph: &Bipartite<R, C>,
    left_to_right: &IndexVec<R, Option<C>>,
    right_to_left: &IndexVec<C, Option<R>>,
) -> (IndexVec<R, bool>, IndexVec<C, bool>) {
    let mut left = IndexVec::filled(false, graph.row_count());
    let mut right = IndexVec::filled(false, graph.col_count());
    let mut waiting: Vec<R> = graph.rows().filter(|&row| left_to_right[row].is_none()).collect();
    for &row in &waiting {
        left[row] = true;
    }
    while let Some(row) = waiting.pop() {
        for &col in graph.cols(row) {
            right[col] = true;
            if let Some(partner) = right_to_left[col].filter(|&partner| !left[partner]) {
                left[partner] = true;
                waiting.push(partner);
            }
        }
    }
    (left, right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::matching::maximum;
    use crate::graph::test_graphs::{Xorshift, cardinality_by_brute_force, graph_of, random_graph};

    fn subsystem(rows: &[u32], cols: &[u32]) -> Subsystem {
        Subsystem {
            rows: rows.iter().copied().map(Row).collect(),
            cols: cols.iter().copied().map(Col).collect(),
        }
    }

    fn parts_of(graph: &Bipartite) -> Decomposition {
        decompose(graph, &maximum(graph, |_, _| true, Matching::empty(graph)))
    }

    #[test]
    fn separates_surplus_equations_from_surplus_unknowns() {
        // x0 + x1 = 1, x0 - x1 = 2, x0 x1 = 3; x2 = x0; x3 + x4 = x2.
        let graph = graph_of(5, &[&[0, 1], &[0, 1], &[0, 1], &[0, 2], &[2, 3, 4]]);
        let parts = parts_of(&graph);
        assert_eq!(parts.over_determined, subsystem(&[0, 1, 2], &[0, 1]));
        assert_eq!(parts.well_determined, subsystem(&[3], &[2]));
        assert_eq!(parts.under_determined, subsystem(&[4], &[3, 4]));
    }

    /// Membership by definition: a row is in the over-determined part exactly if some maximum
    /// matching leaves it out, that is if the graph without it has matchings as large.
    #[test]
    fn the_parts_satisfy_the_definition() {
        let mut random = Xorshift::new(1958);
        for round in 0..300 {
            let graph = random_graph(&mut random, 6, 6, 3 + round % 14);
            let parts = parts_of(&graph);
            let size = cardinality_by_brute_force(&graph);
            let transposed = graph.transposed();
            for row in graph.rows() {
                let rest = graph.rows().filter(|&r| r != row).map(|r| graph.cols(r).to_vec());
                let rest = Bipartite::from_rows(6, rest);
                let dispensable = cardinality_by_brute_force(&rest) == size;
                assert_eq!(parts.over_determined.rows.contains(&row), dispensable, "{graph:?}");
            }
            for col in transposed.rows() {
                let rest = |r| graph.cols(r).iter().copied().filter(|&c| c != col);
                let rest = Bipartite::from_rows(6, graph.rows().map(rest));
                let dispensable = cardinality_by_brute_force(&rest) == size;
                assert_eq!(parts.under_determined.cols.contains(&col), dispensable, "{graph:?}");
            }
            let well = &parts.well_determined;
            assert_eq!(well.rows.len(), well.cols.len());
            let all = [&parts.over_determined, well, &parts.under_determined];
            assert_eq!(all.iter().map(|part| part.rows.len()).sum::<usize>(), 6);
            assert_eq!(all.iter().map(|part| part.cols.len()).sum::<usize>(), 6);
        }
    }
}
