//! Spanning forest of a connection graph whose edges are partly breakable, with one root a tree.
//!
//! Modelica 3.6, section 9.4.2, by the method of J. B. Kruskal, "On the shortest spanning subtree
//! of a graph and the traveling salesman problem", Proc. AMS 7(1), 1956: all definite roots are
//! joined first, then the edges that cannot be broken, then the breakable ones in their order. An
//! edge that joins what is joined already closes a cycle. So equal inputs give equal forests, and
//! the edges that come last are broken.

/// A graph over the nodes `0..nodes`.
#[derive(Clone, Debug, Default)]
pub struct ConnectionGraph {
    /// Number of nodes.
    pub nodes: usize,
    /// Edges that stay.
    pub branches: Vec<[usize; 2]>,
    /// Edges that may be broken.
    pub breakable: Vec<[usize; 2]>,
    /// Nodes that are roots.
    pub roots: Vec<usize>,
    /// Nodes that may become roots, each with its priority; the lowest is chosen.
    pub potential_roots: Vec<(usize, i64)>,
}

/// The outcome for a breakable edge.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fate {
    /// It is part of the forest.
    Kept,
    /// It closes a cycle: the constraint takes its place.
    Broken,
    /// Breakable edges alone already join its ends, so it says nothing new.
    Implied,
}

/// The forest.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SpanningForest {
    /// The fate of each breakable edge.
    pub fates: Vec<Fate>,
    /// Whether a node is the root of its tree.
    pub is_root: Vec<bool>,
    /// Number of edges between a node and its root; `None` in a tree without a root.
    pub depth: Vec<Option<usize>>,
    /// Edges that stay, by number, that close a cycle of such edges or join two roots.
    pub redundant_branches: Vec<usize>,
    /// The nodes of each tree that has edges but no root, ascending.
    pub rootless: Vec<Vec<usize>>,
}

/// Selects roots and breaks edges; nearly linear.
pub fn spanning_forest(graph: &ConnectionGraph) -> SpanningForest {
    let n = graph.nodes;
    let mut forest = SpanningForest { is_root: vec![false; n], ..SpanningForest::default() };
    // The last node stands for all definite roots.
    let mut all = DisjointSets::new(n + 1);
    for &root in &graph.roots {
        forest.is_root[root] = true;
        all.join(root, n);
    }
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); n];
    let mut add = |[a, b]: [usize; 2]| {
        neighbours[a].push(b);
        neighbours[b].push(a);
    };
    for (k, &[a, b]) in graph.branches.iter().enumerate() {
        if all.join(a, b) {
            add([a, b]);
        } else {
            forest.redundant_branches.push(k);
        }
    }
    let mut connected = DisjointSets::new(n);
    for &[a, b] in &graph.breakable {
        let closes_cycle = !all.join(a, b);
        let is_new = connected.join(a, b);
        forest.fates.push(match (closes_cycle, is_new) {
            (false, _) => Fate::Kept,
            (true, true) => Fate::Broken,
            (true, false) => Fate::Implied,
        });
        if !closes_cycle {
            add([a, b]);
        }
    }
    choose_roots(graph, &mut all, &mut forest.is_root);
    forest.depth = depths(&forest.is_root, &neighbours);
    forest.rootless = rootless(&forest.depth, &neighbours, &mut all);
    forest
}

/// Makes one potential root of each tree without a root its root: the first of the lowest priority.
fn choose_roots(graph: &ConnectionGraph, all: &mut DisjointSets, is_root: &mut [bool]) {
    let n = graph.nodes;
    let mut chosen: Vec<Option<(i64, usize)>> = vec![None; n + 1];
    for &(node, priority) in &graph.potential_roots {
        let tree = all.find(node);
        if tree != all.find(n) && chosen[tree].is_none_or(|(best, _)| priority < best) {
            chosen[tree] = Some((priority, node));
        }
    }
    for (_, node) in chosen.into_iter().flatten() {
        is_root[node] = true;
    }
}

/// Distances from the roots, breadth first.
fn depths(is_root: &[bool], neighbours: &[Vec<usize>]) -> Vec<Option<usize>> {
    let mut depth: Vec<Option<usize>> = is_root.iter().map(|root| root.then_some(0)).collect();
    let mut queue: Vec<usize> = (0..is_root.len()).filter(|v| is_root[*v]).collect();
    let mut at = 0;
    while let Some(&node) = queue.get(at) {
        at += 1;
        for &next in &neighbours[node] {
            if depth[next].is_none() {
                depth[next] = depth[node].map(|d| d + 1);
                queue.push(next);
            }
        }
    }
    depth
}

fn rootless(
    depth: &[Option<usize>],
    neighbours: &[Vec<usize>],
    all: &mut DisjointSets,
) -> Vec<Vec<usize>> {
    let mut slot: Vec<Option<usize>> = vec![None; depth.len() + 1];
    let mut found: Vec<Vec<usize>> = Vec::new();
    for node in (0..depth.len()).filter(|v| depth[*v].is_none() && !neighbours[*v].is_empty()) {
        let k = *slot[all.find(node)].get_or_insert_with(|| {
            found.push(Vec::new());
            found.len() - 1
        });
        found[k].push(node);
    }
    found
}

/// Union-find with path halving.
struct DisjointSets(Vec<usize>);

impl DisjointSets {
    fn new(n: usize) -> Self {
        DisjointSets((0..n).collect())
    }

    fn find(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }

    /// Merges two sets; false if they are one already.
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b);
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of section 9.4.1: a loop through branches is broken at its last connection, and
    /// the tree hangs from its definite root although a potential root has a lower priority.
    #[test]
    fn loop_with_a_definite_root() {
        let graph = ConnectionGraph {
            nodes: 6,
            branches: vec![[0, 1], [2, 3], [4, 5]],
            breakable: vec![[1, 2], [3, 4], [5, 0]],
            roots: vec![2],
            potential_roots: vec![(0, -5)],
        };
        let forest = spanning_forest(&graph);
        assert_eq!(forest.fates, [Fate::Kept, Fate::Kept, Fate::Broken]);
        assert_eq!(forest.is_root, [false, false, true, false, false, false]);
        assert_eq!(forest.depth, [2, 1, 0, 1, 2, 3].map(Some));
        assert!(forest.rootless.is_empty() && forest.redundant_branches.is_empty());
    }

    /// Of potential roots the lowest priority is chosen, and the first of equal ones.
    #[test]
    fn potential_roots_by_priority() {
        let chosen = |potential_roots: &[(usize, i64)]| {
            let graph = ConnectionGraph {
                nodes: 4,
                breakable: vec![[0, 1], [1, 2]],
                potential_roots: potential_roots.to_vec(),
                ..ConnectionGraph::default()
            };
            let forest = spanning_forest(&graph);
            (0..4).filter(|v| forest.is_root[*v]).collect::<Vec<_>>()
        };
        assert_eq!(chosen(&[(0, 10), (2, 1), (1, 1)]), [2]);
        assert_eq!(chosen(&[(0, 0), (3, 7)]), [0, 3]);
    }

    /// Two definite roots: their trees are separated, as step 3 of section 9.4.2 demands.
    #[test]
    fn two_roots_separate_their_trees() {
        let graph = ConnectionGraph {
            nodes: 4,
            breakable: vec![[0, 1], [1, 2], [2, 3]],
            roots: vec![0, 3],
            ..ConnectionGraph::default()
        };
        let forest = spanning_forest(&graph);
        assert_eq!(forest.fates, [Fate::Kept, Fate::Kept, Fate::Broken]);
        assert_eq!(forest.depth, [0, 1, 2, 0].map(Some));
    }

    /// A third connection among three nodes says nothing new, whether or not the others are broken.
    #[test]
    fn connections_that_are_implied() {
        let graph = ConnectionGraph {
            nodes: 3,
            breakable: vec![[0, 1], [1, 2], [2, 0]],
            roots: vec![0],
            ..ConnectionGraph::default()
        };
        assert_eq!(spanning_forest(&graph).fates, [Fate::Kept, Fate::Kept, Fate::Implied]);
        let graph = ConnectionGraph { branches: vec![[0, 1], [1, 2]], ..graph };
        let fates = spanning_forest(&graph).fates;
        assert_eq!(fates, [Fate::Broken, Fate::Broken, Fate::Implied]);
    }

    /// Branches that close a cycle and trees without a root are reported.
    #[test]
    fn inconsistent_graphs() {
        let graph = ConnectionGraph {
            nodes: 5,
            branches: vec![[0, 1], [1, 2], [2, 0], [3, 4]],
            ..ConnectionGraph::default()
        };
        let forest = spanning_forest(&graph);
        assert_eq!(forest.redundant_branches, [2]);
        assert_eq!(forest.rootless, [vec![0, 1, 2], vec![3, 4]]);
    }
}
