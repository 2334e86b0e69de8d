//! Variability of expressions (Modelica 3.6, section 3.8).

use crate::base::index::{Id, IndexVec};
use crate::ir::dae::{Variable, VariableKind};
use crate::ir::expr::{ExprId, Graph, Node, VarId};
use crate::ir::flat::Variability;

/// The variability of the expressions of a graph, computed on demand. Operands always have lower
/// numbers than their users, so one pass in order suffices for any depth.
#[derive(Default)]
pub struct Variabilities {
    known: IndexVec<ExprId, Variability>,
}

impl Variabilities {
    /// The variability of `e`. Relations that are operators have the variability of their operands;
    /// numbered ones change only at events.
    pub fn of(
        &mut self,
        graph: &Graph,
        variables: &IndexVec<VarId, Variable>,
        e: ExprId,
    ) -> Variability {
        while self.known.len() <= e.idx() {
            let next = self.known.next_id();
            let variability = match graph.node(next) {
                // Placeholders for locals of loops are not variables of the model.
                Node::Var(v) => variables.get(v).map_or(Variability::Continuous, of_variable),
                Node::Time | Node::Der(_) | Node::Recorded(..) => Variability::Continuous,
                Node::Pre(_)
                | Node::Sample(..)
                | Node::Initial
                | Node::Terminal
                | Node::Relation(_) => Variability::Discrete,
                _ => {
                    let mut highest = Variability::Constant;
                    graph.for_each_operand(next, |a| highest = highest.max(self.known[a]));
                    highest
                }
            };
            self.known.push(variability);
        }
        self.known[e]
    }
}

/// The variability of a variable by its kind. An input keeps its start value.
pub fn of_variable(variable: &Variable) -> Variability {
    match variable.kind {
        VariableKind::Parameter | VariableKind::InitialParameter => Variability::Parameter,
        VariableKind::Discrete | VariableKind::Input => Variability::Discrete,
        VariableKind::Differentiated { .. }
        | VariableKind::Algebraic
        | VariableKind::Eliminated => Variability::Continuous,
    }
}
