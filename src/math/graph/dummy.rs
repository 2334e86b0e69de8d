//! The choice of states when constraints have been differentiated.
//!
//! S. E. Mattsson and G. Söderlind, "Index reduction in differential-algebraic equations using
//! dummy derivatives", SIAM J. Sci. Comput. 14(3), 1993. Each differentiation of a constraint adds
//! an equation; to balance it, one derivative becomes an ordinary unknown, a *dummy derivative*,
//! and what it is the derivative of is no state any more.
//!
//! The paper picks columns of the Jacobian of the differentiated equations by their values. Here
//! the pick is structural: the columns that can be matched form a transversal matroid, so taking
//! them greedily, the least wanted state first, yields the choice of least total priority
//! (J. Edmonds and D. R. Fulkerson, "Transversals and matroid partition", 1965). A choice that can
//! be matched may still be singular for the actual coefficients; [`choose`] therefore lets the
//! caller refuse a column given those already taken.

use super::augment::Search;
use super::bipartite::{Bipartite, Col, Edge, Row};
use super::matching::Matching;
use super::pantelides::Reduction;
use super::scc;
use crate::base::index::IndexVec;

/// What each derivative became.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateChoice {
    /// True for the columns that are derivatives but are computed as ordinary unknowns.
    pub is_dummy: IndexVec<Col, bool>,
    /// The columns whose derivative is not a dummy, ascending: what is integrated over time.
    pub states: Vec<Col>,
}

/// Chooses the dummy derivatives of a reduced system: as many as there are differentiated rows.
///
/// - `priority`: how much each column is wanted as a state, the highest most. Columns beyond the
///   end, those that the reduction added, are wanted like what they are the derivative of.
/// - `cost`: for each edge of the *original* rows (they are the first edges of
///   `reduction.incidence`), how well the row can be solved for the column: 0 for a coefficient
///   that is constant and not zero, more for worse, `None` if only as the last resort. The entry of
///   a differentiated row for a highest derivative is the same partial derivative as the entry of
///   the original row for the variable itself, so the original edges tell all.
///
/// Between columns of equal priority, cheap edges decide, then the lower number. A row takes a
/// column of its own block of the highest derivatives, as in the paper, or any other if the
/// coefficient is constant.
pub fn choose(
    reduction: &Reduction,
    priority: &IndexVec<Col, i32>,
    cost: &IndexVec<Edge, Option<u8>>,
) -> StateChoice {
    let chains = Chains::of(reduction);
    let constraints = Constraints::of(reduction, &chains, cost);
    let mut is_dummy = IndexVec::filled(false, reduction.derivative.len());

    let mut candidates: Vec<Candidate> = (constraints.graph.rows())
        .filter(|&top| !constraints.graph.cols(top).is_empty())
        .filter_map(|top| Candidate { top, dummy: top, state: top }.lowered(&chains))
        .collect();
    let mut greedy = Greedy {
        constraints: &constraints,
        matching: Matching::empty(&constraints.graph),
        search: Search::new(),
        rows: IndexVec::filled(false, reduction.incidence.row_count()),
    };
    // Round k deals with the rows differentiated k times or more, one derivative lower each time.
    for round in 1.. {
        let mut row_count = 0;
        for (row, &times) in chains.times.enumerate() {
            greedy.rows[row] = reduction.differentiated[row].is_none() && times >= round;
            row_count += usize::from(greedy.rows[row]);
        }
        if row_count == 0 {
            break;
        }
        let wanted = |candidate: &Candidate| chains.priority(priority, candidate.state);
        candidates.sort_by_key(|candidate| (wanted(candidate), candidate.state));
        let groups = candidates.chunk_by(|a, b| wanted(a) == wanted(b));
        greedy.take(groups.collect(), row_count);
        candidates.retain(|candidate| greedy.matching.row_to_col[candidate.top].is_some());
        for candidate in &candidates {
            is_dummy[candidate.dummy] = true;
            greedy.matching.separate(candidate.top);
        }
        candidates = candidates.iter().filter_map(|candidate| candidate.lowered(&chains)).collect();
    }
    let is_state = |(col, derivative): (Col, &Option<Col>)| {
        derivative.filter(|&derivative| !is_dummy[derivative]).map(|_| col)
    };
    let states = reduction.derivative.enumerate().filter_map(is_state).collect();
    StateChoice { is_dummy, states }
}

/// A derivative that may become a dummy in this round.
#[derive(Clone, Copy)]
struct Candidate {
    /// The highest derivative of the same variable, which stands for it in the Jacobian.
    top: Col,
    /// The derivative itself.
    dummy: Col,
    /// What it is the derivative of: no state any more if the candidate is taken.
    state: Col,
}

impl Candidate {
    /// The next lower derivative, if that is one.
    fn lowered(self, chains: &Chains) -> Option<Candidate> {
        let state = chains.integral[self.state]?;
        Some(Candidate { top: self.top, dummy: self.state, state })
    }
}

/// The lists A and B read backwards.
struct Chains {
    /// What each column is the derivative of.
    integral: IndexVec<Col, Option<Col>>,
    /// The original row of each row.
    origin: IndexVec<Row, Row>,
    /// How many times the original row was differentiated to give each row.
    times: IndexVec<Row, usize>,
}

impl Chains {
    fn of(reduction: &Reduction) -> Chains {
        let mut integral = IndexVec::filled(None, reduction.derivative.len());
        for (col, &derivative) in reduction.derivative.enumerate() {
            if let Some(derivative) = derivative {
                integral[derivative] = Some(col);
            }
        }
        let mut origin: IndexVec<Row, Row> = reduction.incidence.rows().collect();
        let mut times = IndexVec::filled(0, origin.len());
        // A differentiated row has a higher number than the row it comes from.
        for (row, &differentiated) in reduction.differentiated.enumerate() {
            if let Some(differentiated) = differentiated {
                origin[differentiated] = origin[row];
                times[differentiated] = times[row] + 1;
            }
        }
        Chains { integral, origin, times }
    }

    /// How much a column is wanted as a state.
    fn priority(&self, given: &IndexVec<Col, i32>, col: Col) -> i32 {
        std::iter::successors(Some(col), |&col| self.integral[col])
            .find_map(|col| given.get(col).copied())
            .unwrap_or(0)
    }

    /// The edge of the original row that has the same partial derivative as (row, col).
    fn original_edge(&self, graph: &Bipartite, row: Row, col: Col) -> Option<Edge> {
        let integral = (0..self.times[row]).try_fold(col, |col, _| self.integral[col])?;
        graph.edge(self.origin[row], integral)
    }
}

/// The Jacobian of the differentiated constraints with respect to the highest derivatives.
struct Constraints {
    /// Seen from the columns, in the numbers of the reduction.
    graph: Bipartite<Col, Row>,
    /// When each edge comes into play.
    stage: Vec<Stage>,
    /// The stages that occur, in order.
    stages: Vec<Stage>,
}

/// The order in which edges are tried.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    /// Within a block, by cost.
    Inside(u8),
    /// Across blocks, with a constant coefficient.
    Across,
    /// Within a block, not solvable: only to complete the choice.
    LastResort,
}

impl Constraints {
    fn of(
        reduction: &Reduction,
        chains: &Chains,
        cost: &IndexVec<Edge, Option<u8>>,
    ) -> Constraints {
        let graph = &reduction.incidence;
        let mut row_block = IndexVec::filled(None, graph.row_count());
        for (number, block) in scc::blocks(graph, &reduction.matching).iter().enumerate() {
            for &(row, _) in block {
                row_block[row] = Some(number);
            }
        }
        let stage_of = |row: Row, col: Col| {
            let cost = chains.original_edge(graph, row, col).and_then(|edge| *cost.get(edge)?);
            let col_block = reduction.matching.col_to_row[col].and_then(|row| row_block[row]);
            match cost {
                Some(cost) if row_block[row] == col_block => Some(Stage::Inside(cost)),
                Some(0) => Some(Stage::Across),
                None if row_block[row] == col_block => Some(Stage::LastResort),
                _ => None,
            }
        };
        let mut stage_by_row = Vec::new();
        let mut by_row = Bipartite::new(graph.col_count());
        for row in graph.rows() {
            let is_constraint = reduction.differentiated[row].is_none() && chains.times[row] > 0;
            let mut cols = graph.cols(row).to_vec();
            cols.retain(|&col| is_constraint && reduction.derivative[col].is_none());
            cols.retain(|&col| {
                let stage = stage_of(row, col);
                stage_by_row.extend(stage);
                stage.is_some()
            });
            by_row.push_row(cols);
        }
        let (graph, origin) = by_row.transposed_with_edges();
        let stage = origin.into_iter().map(|edge: Edge| stage_by_row[edge.0 as usize]).collect();
        stage_by_row.sort_unstable();
        stage_by_row.dedup();
        Constraints { graph, stage, stages: stage_by_row }
    }
}

/// The greedy algorithm on the matroid of matchable columns.
struct Greedy<'a> {
    constraints: &'a Constraints,
    matching: Matching<Col, Row>,
    search: Search<Col, Row>,
    /// The rows of this round.
    rows: IndexVec<Row, bool>,
}

impl Greedy<'_> {
    /// Matches columns, group by group, until all `row_count` rows are matched. A column once
    /// matched stays so.
    fn take(&mut self, groups: Vec<&[Candidate]>, row_count: usize) {
        let mut missing = row_count;
        let stages = self.constraints.stages.iter();
        let (last, usual): (Vec<_>, Vec<_>) = stages.partition(|&&s| s == Stage::LastResort);
        for stages in [usual, last] {
            for group in &groups {
                for &&stage in &stages {
                    self.search.forget();
                    for candidate in *group {
                        if missing == 0 {
                            return;
                        }
                        missing -= usize::from(self.take_one(candidate.top, stage));
                    }
                }
            }
        }
    }

    fn take_one(&mut self, top: Col, stage: Stage) -> bool {
        let Constraints { graph, stage: stage_of, .. } = self.constraints;
        let rows = &self.rows;
        let in_play = |edge: Edge, row: Row| rows[row] && stage_of[edge.0 as usize] <= stage;
        self.matching.row_to_col[top].is_none()
            && self.search.augment(graph, &mut self.matching, top, in_play)
    }
}
