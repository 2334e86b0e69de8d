//! The visited set of a graph traversal. Nodes are numbered densely, so an array of marks is faster
//! than a hash set; each traversal uses a fresh mark instead of clearing the array.

use std::cell::Cell;

/// The nodes that a traversal has visited.
#[derive(Default)]
pub struct VisitedSet {
    /// By node, the last traversal that visited it.
    by_node: Vec<u32>,
    traversal: u32,
}

thread_local! {
    static REUSED: Cell<VisitedSet> =
        const { Cell::new(VisitedSet { by_node: Vec::new(), traversal: 0 }) };
}

impl VisitedSet {
    /// Calls `act` with an empty set for a graph of `count` nodes.
    pub fn traverse<T>(count: usize, act: impl FnOnce(&mut VisitedSet) -> T) -> T {
        // A nested traversal finds no set to reuse and allocates its own.
        let mut visited = REUSED.take();
        visited.traversal = visited.traversal.wrapping_add(1);
        if visited.traversal == 0 {
            visited.by_node.fill(0);
            visited.traversal = 1;
        }
        if visited.by_node.len() < count {
            visited.by_node.resize(count, 0);
        }
        let result = act(&mut visited);
        REUSED.set(visited);
        result
    }

    /// Whether a node was visited.
    #[inline]
    pub fn contains(&self, node: usize) -> bool {
        self.by_node[node] == self.traversal
    }

    /// Marks a node as visited; true if it was not visited before.
    #[inline]
    pub fn insert(&mut self, node: usize) -> bool {
        std::mem::replace(&mut self.by_node[node], self.traversal) != self.traversal
    }
}

#[cfg(test)]
mod tests {
    use super::VisitedSet;

    #[test]
    fn each_traversal_starts_empty_even_inside_another() {
        VisitedSet::traverse(3, |outer| {
            assert!(outer.insert(1) && !outer.insert(1));
            VisitedSet::traverse(5, |inner| assert!(inner.insert(1) && inner.insert(4)));
            assert!(!outer.insert(1) && outer.insert(2));
        });
        VisitedSet::traverse(3, |again| assert!(again.insert(1)));
    }
}
