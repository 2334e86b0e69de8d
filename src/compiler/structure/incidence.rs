//! The interface between equations and graphs: the incidence of equations and unknowns.

use crate::base::index::{Id, IndexVec};
use crate::graph::bipartite::{Bipartite, Col, Row};
use crate::graph::matching::Matching;
use crate::ir::blocks::Source;
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, Node, VarId};

/// Equations and unknowns with their incidence.
pub struct EquationSystem {
    /// The equation of each row.
    pub sources: IndexVec<Row, Source>,
    /// The unknown of each column.
    pub unknowns: IndexVec<Col, VarId>,
    /// The column of each variable that is an unknown.
    pub column: IndexVec<VarId, Option<Col>>,
    /// The columns that occur in each row.
    pub graph: Bipartite,
}

impl EquationSystem {
    /// The system of some equations in some unknowns; everything else is known.
    pub fn new(dae: &Dae, sources: Vec<Source>, unknowns: Vec<VarId>) -> EquationSystem {
        let mut column = IndexVec::filled(None, dae.variables.len());
        for (i, &v) in unknowns.iter().enumerate() {
            column[v] = Some(Col::from_usize(i));
        }
        let mut graph = Bipartite::new(unknowns.len());
        for &source in &sources {
            graph.push_row(reads(dae, source).into_iter().filter_map(|v| column[v]));
        }
        EquationSystem {
            sources: sources.into_iter().collect(),
            unknowns: unknowns.into_iter().collect(),
            column,
            graph,
        }
    }

    /// Adds the discrete equations, each matched to its own variable.
    pub fn with_discrete(self, dae: &Dae, mut matching: Matching) -> (EquationSystem, Matching) {
        let mut sources: Vec<Source> = self.sources.iter().copied().collect();
        let mut unknowns: Vec<VarId> = self.unknowns.iter().copied().collect();
        let (first_row, first_col) = (sources.len(), unknowns.len());
        sources.extend((0..dae.discrete.len()).map(Source::Discrete));
        unknowns.extend(dae.discrete.iter().map(|d| d.variable));
        let system = EquationSystem::new(dae, sources, unknowns);
        matching.grow(&system.graph);
        for i in 0..dae.discrete.len() {
            matching.join(Row::from_usize(first_row + i), Col::from_usize(first_col + i));
        }
        (system, matching)
    }
}

/// The variables whose current values an equation relates. Relations are constant between events
/// and `pre` values are known, so neither counts.
pub fn reads(dae: &Dae, source: Source) -> Vec<VarId> {
    let (own, e): (Option<VarId>, Option<ExprId>) = match source {
        Source::Continuous(id) => (None, Some(dae.equations[id].residual)),
        Source::Initial(i) => (None, Some(dae.initial[i].residual)),
        Source::Discrete(i) => (Some(dae.discrete[i].variable), Some(dae.discrete[i].value)),
        Source::Start(v) => (Some(v), dae.variables[v].start),
    };
    let mut read: Vec<VarId> = own.into_iter().collect();
    match e.map(|e| (e, dae.graph.node(e))) {
        None | Some((_, Node::Const(_))) => {}
        Some((e, _)) => read.extend(dae.graph.variables(e)),
    }
    read
}
