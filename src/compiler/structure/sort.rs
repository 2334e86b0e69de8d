//! Sorts a matched system into a sequence of blocks.

use super::error_growth::ErrorGrowth;
use super::incidence::EquationSystem;
use super::tear::Tearing;
use super::{solve, tear};
use crate::base::index::FastMap;
use crate::graph::bipartite::{Bipartite, Col, Row};
use crate::graph::matching::Matching;
use crate::graph::scc;
use crate::ir::blocks::{Assignment, Block, Residual, Source, Torn};
use crate::ir::dae::Dae;
use crate::ir::expr::VarId;
use crate::symbolic::linear;

/// The blocks of a system in order of evaluation (block lower triangular form).
pub fn sequence(dae: &mut Dae, system: &EquationSystem, matching: &Matching) -> Vec<Block> {
    sequence_torn_at(dae, system, matching, &|_| false)
}

/// As [`sequence`], with loops torn at these variables first.
pub fn sequence_torn_at(
    dae: &mut Dae,
    system: &EquationSystem,
    matching: &Matching,
    is_preferred: &dyn Fn(VarId) -> bool,
) -> Vec<Block> {
    let mut tearing = Tearing { growth: ErrorGrowth::default(), is_preferred };
    scc::blocks(&system.graph, matching)
        .iter()
        .map(|pairs| block(dae, system, pairs, &mut tearing))
        .collect()
}

fn block(
    dae: &mut Dae,
    system: &EquationSystem,
    pairs: &[(Row, Col)],
    tearing: &mut Tearing<'_>,
) -> Block {
    let (discrete, continuous): (Vec<_>, Vec<_>) =
        pairs.iter().partition(|(row, _)| matches!(system.sources[*row], Source::Discrete(_)));
    match (&discrete[..], &continuous[..]) {
        ([], [single]) => single_equation(dae, system, *single),
        ([], _) => Block::Torn(tear::tear(dae, system, pairs, tearing)),
        ([single], []) => match assignment(dae, system, *single) {
            Some(assignment) => Block::Assign(assignment),
            None => Block::Mixed(discrete_assignments(dae, system, &discrete)),
        },
        _ => {
            let mut parts = Vec::new();
            for inner in ordered(system, &continuous) {
                parts.push(block(dae, system, &inner, tearing));
            }
            parts.extend(discrete_assignments(dae, system, &discrete));
            Block::Mixed(parts)
        }
    }
}

/// One continuous equation with one unknown.
fn single_equation(dae: &mut Dae, system: &EquationSystem, pair: (Row, Col)) -> Block {
    if let Some(assignment) = assignment(dae, system, pair) {
        return Block::Assign(assignment);
    }
    let source = system.sources[pair.0];
    let unknown = system.unknowns[pair.1];
    let value = solve::residual(dae, source);
    let linear = linear::is_linear(&dae.graph, [value], |v| v == unknown);
    Block::Torn(Torn {
        unknowns: vec![unknown],
        explicit: vec![],
        residuals: vec![Residual { value, source }],
        linear,
    })
}

fn assignment(
    dae: &mut Dae,
    system: &EquationSystem,
    (row, col): (Row, Col),
) -> Option<Assignment> {
    let (source, variable) = (system.sources[row], system.unknowns[col]);
    let value = solve::explicit(dae, source, variable)?;
    Some(Assignment { variable, value, source })
}

/// Discrete equations that depend on each other or on themselves, in order of dependency as far as
/// possible.
fn discrete_assignments(dae: &Dae, system: &EquationSystem, discrete: &[(Row, Col)]) -> Vec<Block> {
    let mut parts = Vec::new();
    for (row, col) in ordered(system, discrete).into_iter().flatten() {
        let source = system.sources[row];
        if let Source::Discrete(i) = source {
            let value = dae.discrete[i].value;
            let variable = system.unknowns[col];
            parts.push(Block::Assign(Assignment { variable, value, source }));
        }
    }
    parts
}

/// The blocks of a subsystem, with all other variables known.
fn ordered(system: &EquationSystem, pairs: &[(Row, Col)]) -> Vec<Vec<(Row, Col)>> {
    let (graph, _) = subgraph(system, pairs);
    let mut matching = Matching::empty(&graph);
    for i in 0..pairs.len() as u32 {
        matching.join(Row(i), Col(i));
    }
    let blocks = scc::blocks(&graph, &matching);
    blocks.iter().map(|b| b.iter().map(|(row, _)| pairs[row.0 as usize]).collect()).collect()
}

/// The graph of a subsystem; row and column `i` are those of the pair `i`.
pub fn subgraph(
    system: &EquationSystem,
    pairs: &[(Row, Col)],
) -> (Bipartite, Vec<crate::graph::bipartite::Edge>) {
    let rows: Vec<Row> = pairs.iter().map(|(row, _)| *row).collect();
    let local: FastMap<Col, Col> =
        pairs.iter().enumerate().map(|(i, (_, col))| (*col, Col(i as u32))).collect();
    system.graph.restricted(&rows, |col| local.get(&col).copied())
}
