//! Graphs for the tests of this folder, explicit or random but reproducible, and brute-force
//! answers.

use super::bipartite::{Bipartite, Col, Row};
use crate::base::index::{Id, IndexVec};

/// Marsaglia's xorshift generator (J. Stat. Softw. 8(14), 2003): the same numbers on every machine.
pub struct Xorshift(u64);

impl Xorshift {
    /// A generator of the sequence number `seed`.
    pub fn new(seed: u64) -> Self {
        Xorshift(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// A number in `0..bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) % bound as u64) as usize
    }
}

/// A graph with `col_count` columns from lists of column numbers.
pub fn graph_of(col_count: usize, rows: &[&[u32]]) -> Bipartite {
    Bipartite::from_rows(col_count, rows.iter().map(|row| row.iter().copied().map(Col)))
}

/// A graph with up to `edges` random incidences.
pub fn random_graph(random: &mut Xorshift, rows: usize, cols: usize, edges: usize) -> Bipartite {
    let mut lists = vec![Vec::new(); rows];
    for _ in 0..edges {
        let row = random.below(rows);
        lists[row].push(Col(random.below(cols) as u32));
    }
    Bipartite::from_rows(cols, lists)
}

/// A square graph with the whole diagonal and up to `edges` further random incidences: it always
/// has a perfect matching.
pub fn random_square(random: &mut Xorshift, size: usize, edges: usize) -> Bipartite {
    let rest = random_graph(random, size, size, edges);
    let diagonal = |row: Row| rest.cols(row).iter().copied().chain([Col(row.0)]);
    Bipartite::from_rows(size, rest.rows().map(diagonal))
}

/// The size of the largest matching, by trying everything. Exponential.
pub fn cardinality_by_brute_force(graph: &Bipartite) -> usize {
    fn best(graph: &Bipartite, row: usize, used: &mut Vec<bool>) -> usize {
        if row == graph.row_count() {
            return 0;
        }
        let mut most = best(graph, row + 1, used);
        for col in graph.cols(Row(row as u32)) {
            let col = col.0 as usize;
            if !used[col] {
                used[col] = true;
                most = most.max(1 + best(graph, row + 1, used));
                used[col] = false;
            }
        }
        most
    }
    best(graph, 0, &mut vec![false; graph.col_count()])
}

/// The list A in which the first column of each pair has the second as its derivative.
pub fn list_a(cols: usize, pairs: &[(u32, u32)]) -> IndexVec<Col, Option<Col>> {
    let mut derivative = IndexVec::filled(None, cols);
    for &(col, higher) in pairs {
        derivative[Col(col)] = Some(Col(higher));
    }
    derivative
}

/// `n` masses on a line, x_i' = v_i, v_i' = F_i - F_(i+1), rigidly joined by x_i = x_(i+1); the outer forces F_0 and
/// F_n are given. The columns are x, v, x', v' (`n` each) and the inner forces; with them the list A.
pub fn rigid_chain(n: usize) -> (Bipartite, IndexVec<Col, Option<Col>>) {
    let (x, v, dx, dv, f) = (0, n, 2 * n, 3 * n, 4 * n);
    let velocity = (0..n).map(|i| vec![dx + i, v + i]);
    let force = (0..n).map(|i| {
        let inner = [i, i + 1].into_iter().filter(|&j| 0 < j && j < n);
        inner.map(|j| f + j - 1).chain([dv + i]).collect()
    });
    let joint = (0..n - 1).map(|i| vec![x + i, x + i + 1]);
    let rows = velocity.chain(force).chain(joint);
    let rows = rows.map(|row: Vec<usize>| row.into_iter().map(Col::from_usize));
    let pairs: Vec<(u32, u32)> = (0..2 * n as u32).map(|col| (col, col + 2 * n as u32)).collect();
    (Bipartite::from_rows(5 * n - 1, rows), list_a(5 * n - 1, &pairs))
}
