//! The contract of [`Blocks`]: each sequence solves its unknowns once, and reads nothing before it is solved.

use crate::base::index::{FastMap, Id, IndexVec};
use crate::ir::blocks::{Block, Blocks};
use crate::ir::expr::{ExprId, Node, VarId};

/// Everything in which a sorted system breaks its contract, and its differential-algebraic system its own.
pub fn check(blocks: &Blocks) -> Vec<String> {
    let mut found = super::dae::check(&blocks.dae);
    let mut roots = Vec::new();
    blocks.for_each_expression(&mut |e| roots.push(e));
    if roots.iter().any(|e| e.idx() >= blocks.dae.graph.len()) {
        found.push("a block reads an expression that does not exist".to_owned());
    }
    if !found.is_empty() {
        // What follows reads the expressions.
        return found;
    }
    let substitutions: FastMap<VarId, ExprId> = blocks.dae.eliminated.iter().copied().collect();
    let sequences = [
        ("initial", &blocks.initial),
        ("initial by states", &blocks.initial_by_states),
        ("event", &blocks.event),
        ("continuous", &blocks.continuous),
    ];
    for (name, sequence) in sequences {
        let solved = IndexVec::filled(Value::Given, blocks.dae.variables.len());
        let mut order =
            Order { blocks, substitutions: &substitutions, name, solved, found: Vec::new() };
        order.sequence(sequence);
        found.append(&mut order.found);
    }
    let states = blocks.states.iter().map(|s| (s.variable, s.derivative));
    for (v, derivative) in states {
        let is_it =
            |d: VarId| blocks.dae.variables.get(d).is_some_and(|x| x.derivative_of == Some(v));
        if !is_it(derivative) {
            found.push(format!("the derivative of state {} is not its derivative", v.0));
        }
    }
    found
}

/// What is known about the value of a variable.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Value {
    /// The sequence begins with it.
    Given,
    /// A later block solves it.
    Pending,
    /// It has been solved.
    Solved,
}

struct Order<'b> {
    blocks: &'b Blocks,
    substitutions: &'b FastMap<VarId, ExprId>,
    name: &'static str,
    solved: IndexVec<VarId, Value>,
    found: Vec<String>,
}

impl Order<'_> {
    fn sequence(&mut self, sequence: &[Block]) {
        for v in sequence.iter().flat_map(Block::unknowns) {
            if v.idx() >= self.solved.len() {
                self.found.push(format!("a block solves variable {}, which does not exist", v.0));
                return;
            }
            if self.solved[v] == Value::Pending {
                self.report(v, "is solved twice");
            }
            self.solved[v] = Value::Pending;
        }
        sequence.iter().for_each(|block| self.block(block));
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Assign(a) => {
                self.reads(a.value, a.variable);
                self.solved[a.variable] = Value::Solved;
            }
            Block::Torn(torn) => {
                if torn.unknowns.is_empty() || torn.unknowns.len() != torn.residuals.len() {
                    let counts = (torn.unknowns.len(), torn.residuals.len());
                    let [name, n, m] = [self.name, &counts.0.to_string(), &counts.1.to_string()];
                    self.found.push(format!("{name}: {n} tearing variables, {m} residuals"));
                }
                for v in &torn.unknowns {
                    self.solved[*v] = Value::Solved;
                }
                for a in &torn.explicit {
                    self.reads(a.value, a.variable);
                    self.solved[a.variable] = Value::Solved;
                }
                for (r, v) in torn.residuals.iter().zip(&torn.unknowns) {
                    self.reads(r.value, *v);
                }
            }
            // The parts are repeated until they agree, so each may read what a later one solves.
            Block::Mixed(parts) => {
                for v in parts.iter().flat_map(Block::unknowns) {
                    self.solved[v] = Value::Solved;
                }
                parts.iter().for_each(|part| self.block(part));
            }
        }
    }

    /// Nothing below `value`, which `of` is solved from, is solved later.
    fn reads(&mut self, value: ExprId, of: VarId) {
        let graph = &self.blocks.dae.graph;
        let mut early = None;
        graph.descend([value], |e, pending| {
            if let Node::Var(v) = graph.node(e) {
                match self.substitutions.get(&v) {
                    Some(e) => pending.push(*e),
                    None if self.solved.get(v) == Some(&Value::Pending) => early = Some(v),
                    None => {}
                }
            }
            true
        });
        if let Some(v) = early {
            let of = self.blocks.dae.variables[of].name.clone();
            self.report(v, &format!("is read for `{of}` before it is solved"));
        }
    }

    fn report(&mut self, v: VarId, what: &str) {
        let variable = &self.blocks.dae.variables[v].name;
        self.found.push(format!("{}: `{variable}` {what}", self.name));
    }
}
