//! Splits the iteration matrices: unknowns that are determined by substitution, and a core that is
//! decomposed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A Jacobian that can be read column by column.
pub trait Columns {
    /// Calls `visit` with the row and the value of every entry of column `j` that may be nonzero,
    /// rows ascending, the diagonal always among them.
    fn visit(&self, j: usize, visit: &mut impl FnMut(usize, f64));
}

/// The substituted rows in order, and the remaining core.
#[derive(Default)]
pub struct Split {
    /// Substituted unknowns in order.
    pub substituted: Vec<Substitution>,
    /// Entries below the substituted pivots, for each substitution in turn.
    pub couplings: Vec<Coupling>,
    /// Rows of the core that is decomposed.
    pub rows: Vec<usize>,
    /// Its columns.
    pub columns: Vec<usize>,
    /// Unknowns left in each row.
    unknowns: Vec<usize>,
    /// The exclusive-or of their columns.
    which: Vec<usize>,
    row_done: Vec<bool>,
    column_done: Vec<bool>,
    /// Rows that have had a single unknown left; the first comes first.
    single: BinaryHeap<Reverse<usize>>,
}

/// Row `row` determines unknown `column`.
#[derive(Clone, Copy)]
pub struct Substitution {
    /// The row.
    pub row: usize,
    /// The unknown.
    pub column: usize,
    /// Entry of the Jacobian there.
    pub jacobian: f64,
    /// Entry of `M` there.
    pub mass: f64,
    /// End of its couplings.
    pub end: usize,
}

/// The entry `mass * shift - jacobian` of a later row in a substituted column.
#[derive(Clone, Copy)]
pub struct Coupling {
    /// The later row.
    pub row: usize,
    /// Entry of the Jacobian.
    pub jacobian: f64,
    /// Entry of `M`.
    pub mass: f64,
}

impl Split {
    /// For systems of `n` components whose iteration matrices have so many entries.
    pub fn new(n: usize, entries: usize) -> Self {
        Split {
            substituted: Vec::with_capacity(n),
            couplings: Vec::with_capacity(entries),
            rows: Vec::with_capacity(n),
            columns: Vec::with_capacity(n),
            unknowns: vec![0; n],
            which: vec![0; n],
            row_done: vec![false; n],
            column_done: vec![false; n],
            single: BinaryHeap::with_capacity(n),
        }
    }

    /// Repeatedly takes the first row that has a single unknown left.
    pub fn find(&mut self, jacobian: &impl Columns, mass: &[f64]) {
        let n = mass.len();
        self.substituted.clear();
        self.couplings.clear();
        self.unknowns.fill(0);
        self.which.fill(0);
        self.row_done.fill(false);
        self.column_done.fill(false);
        self.single.clear();
        for j in 0..n {
            jacobian.visit(j, &mut |i, value| {
                if value != 0.0 || (i == j && mass[i] != 0.0) {
                    self.unknowns[i] += 1;
                    self.which[i] ^= j;
                }
            });
        }
        self.single.extend((0..n).filter(|&i| self.unknowns[i] == 1).map(Reverse));
        while let Some(Reverse(row)) = self.single.pop() {
            // Another row may have determined its last unknown.
            if self.unknowns[row] == 1 {
                self.substitute(row, jacobian, mass);
            }
        }
        self.rows.clear();
        self.rows.extend((0..n).filter(|&i| !self.row_done[i]));
        self.columns.clear();
        self.columns.extend((0..n).filter(|&j| !self.column_done[j]));
    }

    /// Determines the last unknown of `row` from it.
    fn substitute(&mut self, row: usize, jacobian: &impl Columns, mass: &[f64]) {
        let column = self.which[row];
        self.row_done[row] = true;
        self.column_done[column] = true;
        let mut pivot = (0.0, 0.0);
        jacobian.visit(column, &mut |i, value| {
            let m = if i == column { mass[i] } else { 0.0 };
            if value == 0.0 && m == 0.0 {
                return;
            }
            self.unknowns[i] -= 1;
            self.which[i] ^= column;
            if i == row {
                pivot = (value, m);
            }
            if !self.row_done[i] {
                self.couplings.push(Coupling { row: i, jacobian: value, mass: m });
                if self.unknowns[i] == 1 {
                    self.single.push(Reverse(i));
                }
            }
        });
        let (jacobian, mass) = pivot;
        let end = self.couplings.len();
        self.substituted.push(Substitution { row, column, jacobian, mass, end });
    }
}
