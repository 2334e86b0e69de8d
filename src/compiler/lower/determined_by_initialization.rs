//! Parameters with `fixed = false` that an initial equation determines: Boolean, Integer and
//! enumeration parameters that equal an expression of other parameters. Such an equation becomes a
//! binding, so the values of other parameters can use the parameter (Modelica 3.6, section 8.6).

use crate::base::index::FastSet;
use crate::ir::expr::{ExprId, Graph, Node, VarId};
use crate::ir::flat::{EquationKind, FlatModel, Variability};

/// Turns initial equations that determine parameters into their bindings.
pub fn parameters(flat: &mut FlatModel) {
    let mut open: FastSet<VarId> = FastSet::default();
    for (id, v) in flat.variables.enumerate() {
        if super::classify::is_determined_by_initialization(v) && v.binding.is_none() {
            open.insert(id);
        }
    }
    // A parameter may depend on one that is determined later.
    let mut resolved = vec![false; flat.initial_equations.len()];
    let mut found = !open.is_empty();
    while found {
        found = false;
        for (k, done) in resolved.iter_mut().enumerate() {
            let EquationKind::Equal(a, b) = flat.initial_equations[k].kind else { continue };
            let flat_now = &*flat;
            let resolves = |side: ExprId, value: ExprId| match flat_now.graph.node(side) {
                Node::Var(v) if open.contains(&v) => {
                    let known = |w: VarId| !open.contains(&w) && is_given(flat_now, w);
                    consists_of(&flat_now.graph, value, known).then_some((v, value))
                }
                _ => None,
            };
            let Some((v, value)) = resolves(a, b).or_else(|| resolves(b, a)) else { continue };
            flat.variables[v].binding = Some(value);
            flat.variables[v].fixed = None;
            open.remove(&v);
            *done = true;
            found = true;
        }
    }
    let mut resolved = resolved.into_iter();
    flat.initial_equations.retain(|_| !resolved.next().unwrap_or(false));
}

fn is_given(flat: &FlatModel, v: VarId) -> bool {
    let variable = &flat.variables[v];
    variable.variability <= Variability::Parameter && variable.fixed != Some(false)
}

/// True if an expression contains only literals and variables for which `known` is true.
fn consists_of(graph: &Graph, e: ExprId, known: impl Fn(VarId) -> bool) -> bool {
    graph.all([e], |_, node| match node {
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
