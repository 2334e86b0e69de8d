//! The order of blocks at the start, where relations have no value yet.
//!
//! Between events a relation is constant, so that the block that reads it does not depend on those that determine its
//! operands. At the start it has no value, and the first pass through the blocks guesses one: with the phase of a medium
//! guessed wrong, its equations of state may have no solution. So a block that reads a relation follows, where nothing else
//! forbids it, those that determine its operands.

use crate::base::index::FastMap;
use crate::graph::bipartite::{Bipartite, Col, Row};
use crate::graph::matching::Matching;
use crate::graph::scc;
use crate::ir::blocks::Block;
use crate::ir::dae::Dae;
use crate::ir::expr::{ExprId, Node, VarId};

use super::determined;

/// The same blocks, each after those that determine the operands of the relations that it reads. Blocks that wait for each
/// other in this way keep their order.
pub fn after_operands(dae: &Dae, blocks: Vec<Block>) -> Vec<Block> {
    let mut of: FastMap<VarId, usize> = FastMap::default();
    for (k, block) in blocks.iter().enumerate() {
        of.extend(determined(std::slice::from_ref(block)).into_iter().map(|v| (v, k)));
    }
    let mut operands = Operands { dae, of_relations: FastMap::default() };
    let needs: Vec<Vec<usize>> = blocks
        .iter()
        .map(|block| {
            let read = operands.read_by(&block.expressions());
            read.into_iter().filter_map(|v| of.get(&v).copied()).collect()
        })
        .collect();
    let waits = |(k, needed): (usize, &Vec<usize>)| needed.iter().any(|other| *other > k);
    if !needs.iter().enumerate().any(waits) {
        return blocks;
    }
    let mut graph: Bipartite = Bipartite::new(blocks.len());
    for (k, needed) in needs.iter().enumerate() {
        graph.push_row(needed.iter().chain([&k]).map(|other| Col(*other as u32)));
    }
    let mut own = Matching::empty(&graph);
    for k in 0..blocks.len() as u32 {
        own.join(Row(k), Col(k));
    }
    // Each group is in ascending order of its rows, which is the order of the blocks.
    let order: Vec<usize> =
        scc::blocks(&graph, &own).pairs().iter().map(|(row, _)| row.0 as usize).collect();
    let mut blocks: Vec<Option<Block>> = blocks.into_iter().map(Some).collect();
    order.into_iter().filter_map(|k| blocks[k].take()).collect()
}

/// The variables that expressions read, in relations too.
struct Operands<'a> {
    dae: &'a Dae,
    of_relations: FastMap<u32, Vec<VarId>>,
}

impl Operands<'_> {
    fn read_by(&mut self, expressions: &[ExprId]) -> Vec<VarId> {
        let mut read = Vec::new();
        let graph = &self.dae.graph;
        let nodes = graph.postorder(expressions.iter().copied());
        for node in nodes.into_iter().map(|e| graph.node(e)) {
            match node {
                Node::Var(v) => read.push(v),
                Node::Relation(k) => {
                    if !self.of_relations.contains_key(&k) {
                        // A relation within a relation may lead back to it.
                        self.of_relations.insert(k, Vec::new());
                        let relation = &self.dae.relations[k as usize];
                        let found = self.read_by(&[relation.lhs, relation.rhs]);
                        self.of_relations.insert(k, found);
                    }
                    read.extend(&self.of_relations[&k]);
                }
                _ => {}
            }
        }
        read.sort_unstable();
        read.dedup();
        read
    }
}
