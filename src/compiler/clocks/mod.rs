//! Flat model with clocks to flat model without: Modelica 3.6, chapters 16 and 17.
//!
//! *In:* a [`FlatModel`] with operators of clocks and state machines. *Out:* the same model without them. Its
//! equations are split into base-clock and sub-clock partitions ([`partition`]), the clock of each partition is
//! inferred in exact fractions ([`rate`]), and each partition becomes a when-clause whose condition is its tick
//! ([`ticks`], [`solve`]): `previous(x)` is `pre(x)`, `hold(x)` is `x`, and `sample(u)` is `pre(u)`, the value from
//! before the event. Differential equations in a partition are replaced by the formulas of its solver method
//! ([`discretize`]), state machines by the equations of their semantics ([`states`]). Later stages know nothing of
//! clocks.
mod discretize;
pub mod error;
mod expression;
mod fraction;
mod lift;
mod partition;
mod rate;
mod solve;
mod states;
mod ticks;

use crate::base::diag::Diagnostic;
use crate::ir::expr::{ExprId, Node, Type, VarId};
use crate::ir::flat::{Equation, EquationKind, FlatModel, Origin, Variability, Variable};

/// An equation of the model, or the binding of a variable.
struct Item {
    equation: Equation,
    binding_of: Option<VarId>,
}

/// Removes clocks and state machines. Returns what is wrong with them.
pub fn elaborate(flat: &mut FlatModel) -> Vec<Diagnostic> {
    let clocked = |node| matches!(node, Node::Clocked(..));
    let any = flat.variables.iter().any(|v| v.ty == Type::Clock)
        || !flat.transitions.is_empty()
        || !flat.initial_states.is_empty()
        || flat.graph.ids().any(|e| clocked(flat.graph.node(e)));
    if !any {
        return Vec::new();
    }
    let mut problems = Vec::new();
    states::elaborate(flat, &mut problems);
    let items = lift::items(flat, &mut problems);
    let partitions = partition::of(flat, &items, &mut problems);
    if problems.is_empty() {
        let rates = rate::infer(flat, &partitions, &mut problems);
        let ticking = ticks::of(flat, &partitions, &rates, &mut problems);
        solve::replace(flat, items, &partitions, ticking, &mut problems);
    } else {
        solve::restore(flat, items);
    }
    for v in flat.variables.ids() {
        if flat.variables[v].ty == Type::Clock {
            let off = flat.graph.boolean(false);
            let variable = &mut flat.variables[v];
            (variable.ty, variable.variability) = (Type::Boolean, Variability::Constant);
            variable.binding = Some(off);
            flat.synthetic.push(v);
        }
    }
    problems
}

/// Adds a variable of this stage.
fn add_variable(flat: &mut FlatModel, name: String, ty: Type, origin: &Origin) -> VarId {
    let slowest = if ty == Type::Real { Variability::Continuous } else { Variability::Discrete };
    let bare = Variable::bare(name, ty, slowest, origin.span);
    let id = flat.variables.push(Variable { protected: true, ..bare });
    flat.synthetic.push(id);
    id
}

/// Adds a variable that when-clauses assign, with its value before the first event.
fn add_discrete(
    flat: &mut FlatModel,
    name: String,
    ty: Type,
    start: Option<ExprId>,
    origin: &Origin,
) -> VarId {
    let id = add_variable(flat, name, ty, origin);
    let variable = &mut flat.variables[id];
    variable.variability = Variability::Discrete;
    variable.start = start;
    variable.fixed = Some(true);
    id
}

/// `lhs = rhs`
fn equal(lhs: ExprId, rhs: ExprId, origin: &Origin) -> Equation {
    Equation { kind: EquationKind::Equal(lhs, rhs), origin: origin.clone() }
}
