//! What a walk over a graph has met. Nodes are numbered densely, so a mark for each is faster than a set; a
//! walk begins with a new mark instead of clearing those of the one before.

use std::cell::Cell;

/// The nodes that a walk has met.
#[derive(Default)]
pub struct Marks {
    /// By node the last walk that met it.
    by_node: Vec<u32>,
    walk: u32,
}

thread_local! {
    static KEPT: Cell<Marks> = const { Cell::new(Marks { by_node: Vec::new(), walk: 0 }) };
}

impl Marks {
    /// Walks a graph of `count` nodes, none of which is met yet.
    pub fn walk<T>(count: usize, act: impl FnOnce(&mut Marks) -> T) -> T {
        // A walk inside of another one finds none kept, and begins with its own.
        let mut marks = KEPT.take();
        marks.walk = marks.walk.wrapping_add(1);
        if marks.walk == 0 {
            marks.by_node.fill(0);
            marks.walk = 1;
        }
        if marks.by_node.len() < count {
            marks.by_node.resize(count, 0);
        }
        let result = act(&mut marks);
        KEPT.set(marks);
        result
    }

    /// True the first time that a node is met.
    #[inline]
    pub fn insert(&mut self, node: usize) -> bool {
        std::mem::replace(&mut self.by_node[node], self.walk) != self.walk
    }
}

#[cfg(test)]
mod tests {
    use super::Marks;

    #[test]
    fn each_walk_begins_anew_even_inside_of_another() {
        Marks::walk(3, |outer| {
            assert!(outer.insert(1) && !outer.insert(1));
            Marks::walk(5, |inner| assert!(inner.insert(1) && inner.insert(4)));
            assert!(!outer.insert(1) && outer.insert(2));
        });
        Marks::walk(3, |again| assert!(again.insert(1)));
    }
}
