//! Strongly connected components: evaluation orders, blocks and dependency cycles.
//!
//! R. Tarjan, "Depth-first search and linear graph algorithms", SIAM J. Comput. 1(2), 1972, for the
//! idea; I. S. Duff and J. K. Reid, "An implementation of Tarjan's algorithm for the block
//! triangularization of a matrix", ACM TOMS 4(2), 1978, for its use on a matched system.
//!
//! The components come from petgraph, and from its `kosaraju_scc` (two iterative depth-first
//! passes) because its `tarjan_scc` recurses and overflows the stack on a long chain.

use super::bipartite::{Bipartite, Col, Row};
use super::matching::Matching;
use crate::base::index::{Id, IndexVec};
use petgraph::graph::{DiGraph, NodeIndex};

/// A matched system in block lower triangular form.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockTriangularForm {
    pairs: Vec<(Row, Col)>,
    ends: Vec<usize>,
}

impl BlockTriangularForm {
    /// The blocks in the order of evaluation. A block is a minimal set of equations that must be
    /// solved together, each with the unknown it is matched to, ascending by row.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &[(Row, Col)]> + ExactSizeIterator {
        self.ends.iter().enumerate().map(|(i, &end)| {
            let start = if i == 0 { 0 } else { self.ends[i - 1] };
            &self.pairs[start..end]
        })
    }

    /// All pairs in the order of evaluation.
    pub fn pairs(&self) -> &[(Row, Col)] {
        &self.pairs
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// True for a system without matched rows.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }
}

/// Orders the matched rows so that the unknowns of each block occur only in that block and in later
/// ones. Unmatched columns count as known; unmatched rows are omitted. Linear.
pub fn blocks(graph: &Bipartite, matching: &Matching) -> BlockTriangularForm {
    let mut dependencies = DiGraph::<(), ()>::with_capacity(graph.row_count(), graph.edge_count());
    for _ in graph.rows() {
        dependencies.add_node(());
    }
    for (row, own) in matching.pairs() {
        for &col in graph.cols(row) {
            if let Some(other) = matching.col_to_row[col].filter(|_| col != own) {
                dependencies.add_edge(node(row.idx()), node(other.idx()), ());
            }
        }
    }
    let mut blocks = BlockTriangularForm::default();
    for component in petgraph::algo::kosaraju_scc(&dependencies) {
        let start = blocks.pairs.len();
        let rows = component.into_iter().map(|node| Row::from_usize(node.index()));
        blocks.pairs.extend(rows.filter_map(|row| Some((row, matching.row_to_col[row]?))));
        if blocks.pairs.len() > start {
            blocks.pairs[start..].sort_unstable();
            blocks.ends.push(blocks.pairs.len());
        }
    }
    blocks
}

/// Orders `count` items so that each follows its dependencies, given as pairs (item, dependency).
/// Fails with a cycle: each entry depends on the next one and the last on the first.
pub fn topological_order<I: Id>(
    count: usize,
    needs: impl IntoIterator<Item = (I, I)>,
) -> Result<Vec<I>, Vec<I>> {
    let graph = dependency_graph(count, needs);
    let mut ordered = Vec::with_capacity(count);
    for component in petgraph::algo::kosaraju_scc(&graph) {
        match component[..] {
            [single] if !graph.contains_edge(single, single) => ordered.push(single),
            _ => return Err(item_ids(cycle(&graph, &component))),
        }
    }
    Ok(item_ids(ordered))
}

/// The items that lie on a dependency cycle, given pairs (item, dependency).
pub fn nodes_on_cycles<I: Id>(count: usize, needs: impl IntoIterator<Item = (I, I)>) -> Vec<I> {
    let graph = dependency_graph(count, needs);
    let components = petgraph::algo::kosaraju_scc(&graph).into_iter();
    let cyclic = components
        .filter(|nodes| nodes.len() > 1 || nodes.iter().any(|n| graph.contains_edge(*n, *n)));
    item_ids(cyclic.flatten().collect())
}

fn dependency_graph<I: Id>(
    count: usize,
    needs: impl IntoIterator<Item = (I, I)>,
) -> DiGraph<(), ()> {
    let mut graph = DiGraph::with_capacity(count, 0);
    for _ in 0..count {
        graph.add_node(());
    }
    for (item, dependency) in needs {
        graph.add_edge(node(item.idx()), node(dependency.idx()), ());
    }
    graph
}

/// A cycle within a component, found by following edges until a node repeats.
fn cycle(graph: &DiGraph<(), ()>, component: &[NodeIndex]) -> Vec<NodeIndex> {
    let mut position: IndexVec<Row, Option<usize>> = IndexVec::filled(None, graph.node_count());
    let mut inside = vec![false; graph.node_count()];
    for node in component {
        inside[node.index()] = true;
    }
    let mut walk = Vec::new();
    let mut next = component.iter().min().copied();
    while let Some(current) = next {
        let place = &mut position[Row::from_usize(current.index())];
        if let Some(first) = *place {
            walk.drain(..first);
            break;
        }
        *place = Some(walk.len());
        walk.push(current);
        next = graph.neighbors(current).filter(|node| inside[node.index()]).min();
    }
    walk
}

fn node(index: usize) -> NodeIndex {
    NodeIndex::new(index)
}

fn item_ids<I: Id>(nodes: Vec<NodeIndex>) -> Vec<I> {
    nodes.into_iter().map(|node| I::from_usize(node.index())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_include_self_dependencies() {
        let needs = [(0, 1), (1, 2), (2, 1), (2, 3), (4, 4), (5, 4)];
        let mut found: Vec<Row> =
            nodes_on_cycles(6, needs.map(|(a, b)| (Row::from_usize(a), Row::from_usize(b))));
        found.sort_unstable();
        assert_eq!(found, [1, 2, 4].map(Row::from_usize));
    }
    use crate::graph::matching::maximum;
    use crate::graph::test_graphs::{Xorshift, graph_of, random_square};

    fn blocks_of(graph: &Bipartite) -> BlockTriangularForm {
        blocks(graph, &maximum(graph, |_, _| true, Matching::empty(graph)))
    }

    /// The rows of each block.
    fn rows(blocks: &BlockTriangularForm) -> Vec<Vec<u32>> {
        blocks.iter().map(|block| block.iter().map(|(row, _)| row.0).collect()).collect()
    }

    #[test]
    fn components_of_a_matched_system() {
        // Two loops 0-1-2 and 3-4, the second one feeding the first, and a row that feeds none.
        let rows_in: [&[u32]; 6] = [&[0, 1], &[1, 2], &[2, 0, 3], &[3, 4], &[4, 3], &[5, 0, 4]];
        let graph = graph_of(6, &rows_in);
        let mut diagonal = Matching::empty(&graph);
        for i in 0..6 {
            diagonal.join(Row(i), Col(i));
        }
        assert_eq!(rows(&blocks(&graph, &diagonal)), [vec![3, 4], vec![0, 1, 2], vec![5]]);
    }

    #[test]
    fn unmatched_columns_are_known_and_unmatched_rows_omitted() {
        let graph = graph_of(3, &[&[0, 1], &[0, 2], &[0]]);
        let mut matching = Matching::empty(&graph);
        matching.join(Row(0), Col(1));
        matching.join(Row(1), Col(2));
        let blocks = blocks(&graph, &matching);
        assert_eq!(blocks.len(), 2);
        assert_eq!(blocks.iter().map(<[_]>::len).max(), Some(1));
    }

    /// The blocks are a partition, no block uses an unknown of a later one, and within a block
    /// every row depends on every other, which makes the blocks the smallest possible.
    #[test]
    fn block_lower_triangular_form_is_valid_and_finest() {
        let mut random = Xorshift::new(1978);
        for round in 0..300 {
            let n = 12;
            let graph = random_square(&mut random, n, round % 30);
            let blocks = blocks_of(&graph);
            assert_eq!(blocks.pairs().len(), n);
            let mut known = vec![false; n];
            let row_of: Vec<Row> = {
                let mut row_of = vec![Row(0); n];
                blocks.pairs().iter().for_each(|&(row, col)| row_of[col.idx()] = row);
                row_of
            };
            for block in blocks.iter() {
                for &(_, col) in block {
                    assert!(!std::mem::replace(&mut known[col.idx()], true));
                }
                for &(row, _) in block {
                    assert!(graph.cols(row).iter().all(|col| known[col.idx()]), "{graph:?}");
                    let mut reached = vec![row];
                    let mut next = 0;
                    while let Some(&row) = reached.get(next) {
                        next += 1;
                        for needed in graph.cols(row).iter().map(|col| row_of[col.idx()]) {
                            if !reached.contains(&needed) {
                                reached.push(needed);
                            }
                        }
                    }
                    assert!(block.iter().all(|(other, _)| reached.contains(other)));
                }
            }
        }
    }

    #[test]
    fn a_chain_of_three_hundred_thousand_rows_does_not_exhaust_the_stack() {
        let n = 300_000;
        let row = |i: usize| [i, (i + 1).min(n - 1)].map(Col::from_usize);
        let blocks = blocks_of(&Bipartite::from_rows(n, (0..n).map(row)));
        assert_eq!(blocks.len(), n);
        assert_eq!(blocks.pairs()[0], (Row(n as u32 - 1), Col(n as u32 - 1)));
        // Closed to a ring it is one block.
        let row = |i: usize| [i, (i + 1) % n].map(Col::from_usize);
        let blocks = blocks_of(&Bipartite::from_rows(n, (0..n).map(row)));
        assert_eq!(blocks.iter().map(<[_]>::len).collect::<Vec<_>>(), [n]);
    }

    #[test]
    fn dependencies_come_first_and_a_cycle_is_returned_as_a_path() {
        let needs = [(0, 1), (1, 3), (2, 0), (2, 3)].map(|(a, b)| (Row(a), Row(b)));
        assert_eq!(topological_order(4, needs), Ok([3, 1, 0, 2].map(Row).to_vec()));
        // 0 needs the cycle 1 -> 4 -> 2 -> 1 but is not on it.
        let needs = [(0, 1), (1, 4), (4, 2), (2, 1), (2, 3)].map(|(a, b)| (Row(a), Row(b)));
        assert_eq!(topological_order(5, needs), Err([1, 4, 2].map(Row).to_vec()));
        assert_eq!(topological_order(2, [(Row(1), Row(1))]), Err(vec![Row(1)]));
        assert_eq!(topological_order::<Row>(0, []), Ok(vec![]));
    }
}
