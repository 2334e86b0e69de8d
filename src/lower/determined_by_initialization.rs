//! Parameters with `fixed = false` that an initial equation settles: truth values, whole numbers and
//! the like that are equal to something made of other parameters. Such an equation is a binding, and so
//! the parameter may stand in the values of others (section 8.6 of the specification).

use crate::base::index::FastSet;
use crate::ir::expr::{ExprId, Graph, Node, VarId};
use crate::ir::flat::{EquationKind, FlatModel, Variability};

/// Turns initial equations that settle parameters into their bindings.
pub fn parameters(flat: &mut FlatModel) {
    let mut open: FastSet<VarId> = FastSet::default();
    for (id, v) in flat.variables.enumerate() {
        if super::classify::is_found_at_start(v) && v.binding.is_none() {
            open.insert(id);
        }
    }
    // One may be settled by another that comes later.
    let mut settled = vec![false; flat.initial_equations.len()];
    let mut found = !open.is_empty();
    while found {
        found = false;
        for (k, done) in settled.iter_mut().enumerate() {
            let EquationKind::Equal(a, b) = flat.initial_equations[k].kind else { continue };
            let flat_now = &*flat;
            let settles = |side: ExprId, value: ExprId| match flat_now.graph.node(side) {
                Node::Var(v) if open.contains(&v) => {
                    let known = |w: VarId| !open.contains(&w) && is_given(flat_now, w);
                    is_made_of(&flat_now.graph, value, known).then_some((v, value))
                }
                _ => None,
            };
            let Some((v, value)) = settles(a, b).or_else(|| settles(b, a)) else { continue };
            flat.variables[v].binding = Some(value);
            flat.variables[v].fixed = None;
            open.remove(&v);
            *done = true;
            found = true;
        }
    }
    let mut settled = settled.into_iter();
    flat.initial_equations.retain(|_| !settled.next().unwrap_or(false));
}

fn is_given(flat: &FlatModel, v: VarId) -> bool {
    let variable = &flat.variables[v];
    variable.variability <= Variability::Parameter && variable.fixed != Some(false)
}

/// True if nothing but such variables and literals stand in an expression.
fn is_made_of(graph: &Graph, e: ExprId, known: impl Fn(VarId) -> bool) -> bool {
    graph.postorder([e]).into_iter().all(|n| match graph.node(n) {
        Node::Var(v) => known(v),
        Node::Const(_)
        | Node::Unary(..)
        | Node::Binary(..)
        | Node::If(..)
        | Node::NoEvent(_)
        | Node::Call { .. } => true,
        _ => false,
    })
}
