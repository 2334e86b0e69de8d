//! Where a decomposition without exchanges of rows puts its entries, and in what order it computes them.
//!
//! Diagonal entries are eliminated in an order of least degree (Duff, Erisman and Reid, *Direct Methods for Sparse
//! Matrices*, 2nd ed. 2017, sec. 7.2), which is found once for a pattern, so that zeros are never touched. Entries may
//! be numbers or blocks.

use std::collections::BTreeSet;

use super::pattern::Pattern;

/// Largest amplification of rounding errors in a pivot: without exchanges of rows, one that is left by cancellation is not
/// divided by.
pub const WEAKEST: f64 = 1e6;

/// A pivot is too small to divide by.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Weak;

/// The plan of a decomposition.
pub struct SymbolicLu {
    /// The row and column that is eliminated at each position.
    pub order: Vec<usize>,
    /// The entry of the filled matrix for each entry of the pattern, in its order.
    pub places: Vec<usize>,
    /// Number of entries of the filled matrix; entry `k` is the diagonal one at position `k`.
    pub entries: usize,
    /// For each position, the entries below the diagonal in its column.
    pub lower: Vec<Vec<Place>>,
    /// For each position, the entries after the diagonal in its row.
    pub upper: Vec<Vec<Place>>,
    /// For each position, the entries that change when it is eliminated: for each of `lower`, for each of `upper`.
    pub changed: Vec<Vec<usize>>,
}

/// An entry beside the diagonal.
#[derive(Clone, Copy)]
pub struct Place {
    /// Its other position: that of the row, or of the column.
    pub other: usize,
    /// Its number.
    pub entry: usize,
}

impl SymbolicLu {
    /// For square matrices of this pattern; the diagonal always belongs to them.
    pub fn new(pattern: &Pattern) -> Self {
        let n = pattern.columns();
        let order = order_of_least_degree(pattern);
        let mut position = vec![0; n];
        order.iter().enumerate().for_each(|(k, i)| position[*i] = k);
        let rows = filled(pattern, &position);
        let nothing = || vec![Vec::new(); n];
        let (mut lower, mut upper, mut entries) = (nothing(), nothing(), n);
        for (i, row) in rows.iter().enumerate() {
            for &j in row {
                match i > j {
                    true => lower[j].push(Place { other: i, entry: entries }),
                    false => upper[i].push(Place { other: j, entry: entries }),
                }
                entries += 1;
            }
        }
        let mut plan =
            SymbolicLu { order, places: Vec::new(), entries, lower, upper, changed: Vec::new() };
        plan.changed = (0..n).map(|k| plan.changed_by(k)).collect();
        let coordinates = (0..n).flat_map(|j| pattern.column(j).iter().map(move |i| (*i, j)));
        plan.places =
            coordinates.filter_map(|(i, j)| plan.entry(position[i], position[j])).collect();
        plan
    }

    /// Number of updates of an entry.
    pub fn updates(&self) -> usize {
        self.changed.iter().map(Vec::len).sum()
    }

    fn changed_by(&self, k: usize) -> Vec<usize> {
        let pairs = self.lower[k].iter().flat_map(|l| self.upper[k].iter().map(move |u| (l, u)));
        pairs.filter_map(|(l, u)| self.entry(l.other, u.other)).collect()
    }

    /// The number of the entry at two positions.
    fn entry(&self, row: usize, column: usize) -> Option<usize> {
        let (list, other) = match row.cmp(&column) {
            std::cmp::Ordering::Equal => return Some(row),
            std::cmp::Ordering::Greater => (&self.lower[column], row),
            std::cmp::Ordering::Less => (&self.upper[row], column),
        };
        list.iter().find(|p| p.other == other).map(|p| p.entry)
    }
}

/// The columns beside the diagonal in each row of the filled matrix, by position.
fn filled(pattern: &Pattern, position: &[usize]) -> Vec<BTreeSet<usize>> {
    let n = pattern.columns();
    let (mut rows, mut columns) = (vec![BTreeSet::new(); n], vec![BTreeSet::new(); n]);
    for j in 0..n {
        for i in pattern.column(j).iter().filter(|i| **i != j) {
            rows[position[*i]].insert(position[j]);
            columns[position[j]].insert(position[*i]);
        }
    }
    for k in 0..n {
        let (below, after) = (beyond(&columns[k], k), beyond(&rows[k], k));
        for &i in &below {
            for &j in after.iter().filter(|j| **j != i) {
                rows[i].insert(j);
                columns[j].insert(i);
            }
        }
    }
    rows
}

/// The positions of a set after `k`.
fn beyond(set: &BTreeSet<usize>, k: usize) -> Vec<usize> {
    set.range(k + 1..).copied().collect()
}

/// Eliminates repeatedly a row and column with the fewest neighbours.
fn order_of_least_degree(pattern: &Pattern) -> Vec<usize> {
    let n = pattern.columns();
    let mut neighbours = vec![BTreeSet::new(); n];
    for j in 0..n {
        for &i in pattern.column(j).iter().filter(|i| **i != j) {
            neighbours[i].insert(j);
            neighbours[j].insert(i);
        }
    }
    let mut left: BTreeSet<usize> = (0..n).collect();
    let mut order = Vec::with_capacity(n);
    while let Some(&next) = left.iter().min_by_key(|i| neighbours[**i].len()) {
        left.remove(&next);
        order.push(next);
        let around: Vec<usize> = std::mem::take(&mut neighbours[next]).into_iter().collect();
        for &i in &around {
            neighbours[i].remove(&next);
            neighbours[i].extend(around.iter().filter(|j| **j != i));
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The centre of a star comes last but one, and nothing is filled in.
    #[test]
    fn a_star_has_no_fill() {
        let arms = (1..6).flat_map(|i| [(0, i), (i, 0), (i, i)]);
        let plan = SymbolicLu::new(&Pattern::from_entries(6, 6, &arms.collect::<Vec<_>>()));
        assert_eq!(plan.order[..4], [1, 2, 3, 4]);
        assert_eq!(plan.entries, 6 + 10);
        assert_eq!(plan.updates(), 5);
        assert_eq!(plan.places.len(), 15);
    }

    /// Each corner of a square joins its two neighbours.
    #[test]
    fn a_square_fills_its_diagonal() {
        let sides = [(0, 1), (1, 2), (2, 3), (3, 0)];
        let both: Vec<_> = sides.iter().flat_map(|&(i, j)| [(i, j), (j, i)]).collect();
        let plan = SymbolicLu::new(&Pattern::from_entries(4, 4, &both));
        assert_eq!(plan.order, [0, 1, 2, 3]);
        assert_eq!(plan.entries, 4 + 8 + 2);
    }
}
