//! A matched system as a sequence of blocks.

use super::incidence::System;
use super::{solve, tear};
use crate::base::index::FastMap;
use crate::graph::bipartite::{Bipartite, Col, Row};
use crate::graph::matching::Matching;
use crate::graph::scc;
use crate::ir::blocks::{Assignment, Block, Residual, Source, Torn};
use crate::ir::dae::Dae;
use crate::symbolic::linear;

/// The blocks of a system in order of evaluation (block lower triangular form).
pub fn sequence(dae: &mut Dae, system: &System, matching: &Matching) -> Vec<Block> {
    scc::blocks(&system.graph, matching).iter().map(|pairs| block(dae, system, pairs)).collect()
}

fn block(dae: &mut Dae, system: &System, pairs: &[(Row, Col)]) -> Block {
    let (discrete, continuous): (Vec<_>, Vec<_>) =
        pairs.iter().partition(|(row, _)| matches!(system.sources[*row], Source::Discrete(_)));
    match (&discrete[..], &continuous[..]) {
        ([], [single]) => lone(dae, system, *single),
        ([], _) => Block::Torn(tear::tear(dae, system, pairs)),
        ([single], []) => match assignment(dae, system, *single) {
            Some(assignment) => Block::Assign(assignment),
            None => Block::Mixed(in_order(dae, system, &discrete)),
        },
        _ => {
            let mut parts = Vec::new();
            for inner in ordered(system, &continuous) {
                parts.push(block(dae, system, &inner));
            }
            parts.extend(in_order(dae, system, &discrete));
            Block::Mixed(parts)
        }
    }
}

/// One continuous equation with one unknown.
fn lone(dae: &mut Dae, system: &System, pair: (Row, Col)) -> Block {
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

fn assignment(dae: &mut Dae, system: &System, (row, col): (Row, Col)) -> Option<Assignment> {
    let (source, variable) = (system.sources[row], system.unknowns[col]);
    let value = solve::explicit(dae, source, variable)?;
    Some(Assignment { variable, value, source })
}

/// Discrete equations that depend on each other or on themselves, as far as possible in order.
fn in_order(dae: &Dae, system: &System, discrete: &[(Row, Col)]) -> Vec<Block> {
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

/// The blocks of a part of a system, everything else being known.
fn ordered(system: &System, pairs: &[(Row, Col)]) -> Vec<Vec<(Row, Col)>> {
    let (graph, _) = part(system, pairs);
    let mut matching = Matching::empty(&graph);
    for i in 0..pairs.len() as u32 {
        matching.join(Row(i), Col(i));
    }
    let blocks = scc::blocks(&graph, &matching);
    blocks.iter().map(|b| b.iter().map(|(row, _)| pairs[row.0 as usize]).collect()).collect()
}

/// The graph of a part of a system; row and column `i` are those of the pair `i`.
pub fn part(
    system: &System,
    pairs: &[(Row, Col)],
) -> (Bipartite, Vec<crate::graph::bipartite::Edge>) {
    let rows: Vec<Row> = pairs.iter().map(|(row, _)| *row).collect();
    let local: FastMap<Col, Col> =
        pairs.iter().enumerate().map(|(i, (_, col))| (*col, Col(i as u32))).collect();
    system.graph.restricted(&rows, |col| local.get(&col).copied())
}
