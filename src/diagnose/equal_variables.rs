//! Variables that equations and bindings set equal: the ends of a connection, and other names of one quantity.

use crate::base::index::{FastMap, FastSet};
use crate::ir::expr::{ExprId, Node, VarId};
use crate::ir::flat::{EquationKind, FlatModel};

/// The variables of a model that are equal to others.
pub struct EqualVariables {
    /// Those that one equation or binding sets equal to each.
    neighbours: FastMap<VarId, Vec<VarId>>,
}

impl EqualVariables {
    /// Those of a flat model.
    pub fn new(flat: &FlatModel) -> EqualVariables {
        let variable = |e: ExprId| match flat.graph.node(e) {
            Node::Var(v) => Some(v),
            _ => None,
        };
        let of_equations = flat.equations.iter().filter_map(|e| match e.kind {
            EquationKind::Equal(a, b) => Some((variable(a)?, variable(b)?)),
            _ => None,
        });
        let of_bindings =
            flat.variables.enumerate().filter_map(|(v, x)| Some((v, variable(x.binding?)?)));
        let mut neighbours: FastMap<VarId, Vec<VarId>> = FastMap::default();
        for (a, b) in of_equations.chain(of_bindings) {
            neighbours.entry(a).or_default().push(b);
            neighbours.entry(b).or_default().push(a);
        }
        EqualVariables { neighbours }
    }

    /// The given variables and all that are equal to one of them.
    pub fn of(&self, given: impl IntoIterator<Item = VarId>) -> FastSet<VarId> {
        let mut open: Vec<VarId> = given.into_iter().collect();
        let mut known: FastSet<VarId> = open.iter().copied().collect();
        while let Some(v) = open.pop() {
            for other in self.neighbours.get(&v).into_iter().flatten() {
                if known.insert(*other) {
                    open.push(*other);
                }
            }
        }
        known
    }
}
