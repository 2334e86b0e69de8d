//! Groups of columns that share no row, so that one directional derivative yields a whole group.
//!
//! A. R. Curtis, M. J. D. Powell, J. K. Reid: *On the estimation of sparse Jacobian matrices*,
//! J. Inst. Maths Applics 13 (1974), 117-119.

use super::pattern::Pattern;

/// A partition of the columns of a pattern into groups of structurally orthogonal columns.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Coloring {
    color_of: Vec<usize>,
    groups: Vec<Vec<usize>>,
}

impl Coloring {
    /// The greedy coloring of Curtis, Powell & Reid, sec. 3: columns are taken in their order, and
    /// each joins the first group none of whose members it shares a row with.
    pub fn new(pattern: &Pattern) -> Self {
        let mut color_of = Vec::with_capacity(pattern.columns());
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut occupied: Vec<Vec<bool>> = Vec::new();
        for j in 0..pattern.columns() {
            let rows = pattern.column(j);
            let color = (0..groups.len())
                .find(|&c| rows.iter().all(|&i| !occupied[c][i]))
                .unwrap_or(groups.len());
            if color == groups.len() {
                groups.push(Vec::new());
                occupied.push(vec![false; pattern.rows()]);
            }
            for &i in rows {
                occupied[color][i] = true;
            }
            groups[color].push(j);
            color_of.push(color);
        }
        Coloring { color_of, groups }
    }

    /// The columns of each group, ascending.
    pub fn groups(&self) -> &[Vec<usize>] {
        &self.groups
    }

    /// The group of column `j`.
    pub fn color_of(&self, j: usize) -> usize {
        self.color_of[j]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A band of width three needs three groups, whatever the order (Curtis, Powell & Reid, sec.
    /// 2).
    #[test]
    fn tridiagonal_needs_three_groups() {
        let n = 20;
        let entries: Vec<_> = (0..n)
            .flat_map(|j: usize| (j.saturating_sub(1)..(j + 2).min(n)).map(move |i| (i, j)))
            .collect();
        let coloring = Coloring::new(&Pattern::from_entries(n, n, &entries));
        assert_eq!(coloring.groups().len(), 3);
        assert_eq!(coloring.groups()[0], [0, 3, 6, 9, 12, 15, 18]);
    }

    /// The arrow matrix has one dense row, so every column is in a group of its own.
    #[test]
    fn dense_row_separates_all_columns() {
        let entries: Vec<_> = (0..5).flat_map(|j| [(0, j), (j, j)]).collect();
        let coloring = Coloring::new(&Pattern::from_entries(5, 5, &entries));
        assert_eq!(coloring.groups().len(), 5);
    }

    #[test]
    fn members_of_a_group_share_no_row() {
        let n = 30;
        // A fixed scatter: column j has entries in the rows j, 7j + 3 and 11j + 5 modulo n.
        let entries: Vec<_> =
            (0..n).flat_map(|j| [(j, j), ((7 * j + 3) % n, j), ((11 * j + 5) % n, j)]).collect();
        let pattern = Pattern::from_entries(n, n, &entries);
        let coloring = Coloring::new(&pattern);
        let mut seen = vec![0; n];
        for (color, group) in coloring.groups().iter().enumerate() {
            let mut rows: Vec<usize> =
                group.iter().flat_map(|&j| pattern.column(j).iter().copied()).collect();
            let count = rows.len();
            rows.sort_unstable();
            rows.dedup();
            assert_eq!(rows.len(), count);
            for &j in group {
                seen[j] += 1;
                assert_eq!(coloring.color_of(j), color);
            }
        }
        assert!(seen.iter().all(|&count| count == 1));
    }
}
