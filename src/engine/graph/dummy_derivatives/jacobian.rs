//! The Jacobian of the differentiated constraints, whose independent columns become dummies.

use super::{Chains, Coefficient, Pivot};
use crate::base::index::IndexVec;
use crate::graph::bipartite::{Bipartite, Col, Edge, Row};
use crate::graph::matching::Matching;
use crate::graph::pantelides::Reduction;
use crate::graph::rank::Residue;
use crate::graph::scc;

/// The Jacobian of the differentiated constraints with respect to the highest derivatives, seen
/// from the columns, in the numbers of the reduction.
pub(super) struct ConstraintJacobian {
    pub(super) graph: Bipartite<Col, Row>,
    pub(super) entries: Vec<JacobianEntry>,
    /// The classes that occur, in order.
    pub(super) classes: Vec<EdgeClass>,
    /// The differentiated rows that are not differentiated again.
    pub(super) rows: Vec<Row>,
}

/// An entry of the Jacobian.
#[derive(Clone, Copy)]
pub(super) struct JacobianEntry {
    pub(super) class: EdgeClass,
    pub(super) value: Residue,
    varying: bool,
}

/// The order in which edges are tried.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum EdgeClass {
    /// Within a block, with a constant coefficient.
    Constant,
    /// Within a block, with a parameter as coefficient.
    Parameter,
    /// Within a block.
    Varying,
    /// Across blocks, with a coefficient that does not vary.
    Across,
    /// Any other: only to complete the choice.
    LastResort,
}

impl ConstraintJacobian {
    pub(super) fn of(
        reduction: &Reduction,
        chains: &Chains,
        coefficient: &IndexVec<Edge, Coefficient>,
    ) -> ConstraintJacobian {
        let incidence = &reduction.incidence;
        let block = block_of_rows(reduction);
        let entry = |row: Row, col: Col| {
            let edge = chains.original_edge(incidence, row, col);
            let coefficient = edge.and_then(|edge| coefficient.get(edge).copied());
            let col_row = reduction.matching.col_to_row[col];
            JacobianEntry::new(
                coefficient.unwrap_or(Coefficient::Varying),
                col_row.is_some_and(|col_row| block[col_row] == block[row]),
                u64::from(row.0) << 32 | u64::from(col.0),
            )
        };
        let mut entries_by_row = Vec::new();
        let mut by_row = Bipartite::new(incidence.col_count());
        let mut rows = Vec::new();
        for row in incidence.rows() {
            let mut tops = Vec::new();
            if reduction.differentiated[row].is_none() && chains.times[row] > 0 {
                rows.push(row);
                tops.extend(incidence.cols(row));
                tops.retain(|&col| reduction.derivative[col].is_none());
                // A derivative that is given may read highest derivatives that its origin does not constrain.
                tops.retain(|&col| chains.original_edge(incidence, row, col).is_some());
            }
            entries_by_row.extend(tops.iter().map(|&col| entry(row, col)));
            by_row.push_row(tops);
        }
        let (graph, origin) = by_row.transposed_with_edges();
        let entries = origin.into_iter().map(|edge| entries_by_row[edge.0 as usize]).collect();
        let mut classes: Vec<EdgeClass> = entries_by_row.iter().map(|entry| entry.class).collect();
        classes.sort_unstable();
        classes.dedup();
        ConstraintJacobian { graph, entries, classes, rows }
    }

    /// The rows of a round with the columns they are matched to, in the numbers of that round.
    pub(super) fn pivots(
        &self,
        matching: &Matching<Col, Row>,
        round: usize,
        chains: &Chains,
    ) -> Vec<Pivot> {
        let rows: Vec<Row> =
            self.rows.iter().copied().filter(|r| chains.times[*r] >= round).collect();
        let mut local = IndexVec::filled(None, self.graph.col_count());
        let mut tops = Vec::new();
        for &row in &rows {
            if let Some(top) = matching.col_to_row[row] {
                local[row] = Some(Row(tops.len() as u32));
                tops.push((row, top));
            }
        }
        // The regular matrix of the round, row by row, and all entries of its rows.
        let mut chosen: Vec<Vec<Col>> = vec![Vec::new(); tops.len()];
        let mut all: Vec<Vec<(Col, bool)>> = vec![Vec::new(); tops.len()];
        let mut place = IndexVec::filled(None, self.graph.row_count());
        for (i, &(_, top)) in tops.iter().enumerate() {
            place[top] = Some(Col(i as u32));
        }
        for top in self.graph.rows() {
            for edge in self.graph.edges(top) {
                if let Some(row) = local[self.graph.col(edge)] {
                    all[row.0 as usize].push((top, self.entries[edge.0 as usize].varying));
                    chosen[row.0 as usize].extend(place[top]);
                }
            }
        }
        let square = Bipartite::from_rows(tops.len(), chosen);
        let mut diagonal = Matching::empty(&square);
        for i in 0..tops.len() as u32 {
            diagonal.join(Row(i), Col(i));
        }
        let mut varying = vec![false; tops.len()];
        let mut block_of = vec![usize::MAX; tops.len()];
        for (number, block) in scc::blocks(&square, &diagonal).iter().enumerate() {
            for (row, _) in block {
                block_of[row.0 as usize] = number;
            }
            let inside = |top: Col| place[top].is_some_and(|c| block_of[c.0 as usize] == number);
            let varies = block.iter().any(|(row, _)| {
                all[row.0 as usize].iter().any(|&(top, varying)| varying && inside(top))
            });
            for (row, _) in block {
                varying[row.0 as usize] = varies;
            }
        }
        let lowered = |top: Col| (0..round).try_fold(top, |col, _| chains.integral[col]);
        let pivots = tops.iter().enumerate().filter_map(|(i, &(row, top))| {
            Some(Pivot {
                round,
                constraint: (0..round).try_fold(row, |row, _| chains.constraint[row])?,
                determined: lowered(top)?,
                candidates: all[i].iter().filter_map(|&(top, _)| lowered(top)).collect(),
                varying: varying[i],
                nonlinear: all[i].iter().any(|&(_, varying)| varying),
            })
        });
        pivots.collect()
    }
}

impl JacobianEntry {
    /// `key` identifies the entry among those that are not constant.
    fn new(coefficient: Coefficient, in_block: bool, key: u64) -> JacobianEntry {
        let arbitrary = Residue::arbitrary(key);
        let (class, value) = match coefficient {
            Coefficient::Constant(value) => match Residue::of_float(value) {
                Some(residue) if value != 0.0 => (EdgeClass::Constant, residue),
                Some(zero) => (EdgeClass::LastResort, zero),
                None => (EdgeClass::LastResort, arbitrary),
            },
            Coefficient::Parameter => (EdgeClass::Parameter, arbitrary),
            Coefficient::Varying => (EdgeClass::Varying, arbitrary),
        };
        let class = match class {
            class if in_block => class,
            EdgeClass::Constant | EdgeClass::Parameter => EdgeClass::Across,
            _ => EdgeClass::LastResort,
        };
        JacobianEntry { class, value, varying: coefficient == Coefficient::Varying }
    }
}

/// The number of the block of each matched row.
fn block_of_rows(reduction: &Reduction) -> IndexVec<Row, Option<usize>> {
    let mut block_of = IndexVec::filled(None, reduction.incidence.row_count());
    let blocks = scc::blocks(&reduction.incidence, &reduction.matching);
    for (number, block) in blocks.iter().enumerate() {
        for &(row, _) in block {
            block_of[row] = Some(number);
        }
    }
    block_of
}
