//! States that a model prefers though it does not differentiate them: the pressure and the temperature of a volume whose
//! balances differentiate its mass and its energy.
//!
//! `StateSelect.prefer` and `StateSelect.always` apply to variables whose derivatives do not occur, too (Modelica 3.6,
//! section 4.8.7.1). Such a variable gets a derivative; the equation that relates it to a differentiated variable is then a
//! constraint, which the index reduction differentiates: mass and energy are computed from the states in place of an
//! iteration for pressure and temperature from mass and energy.
//!
//! That is only done where it is safe: what jumps at events cannot be a state, and a constraint whose pivot varies would
//! leave the choice to the simulation.

use super::reduce::Reduced;
use crate::ir::dae::{Dae, EqId, Variable, VariableKind};
use crate::ir::expr::{Node, Type, VarId};
use crate::ir::flat::StateSelect;

/// The variables that are preferred as states, but do not appear differentiated.
pub fn find(dae: &Dae) -> Vec<VarId> {
    let has_states = dae.variables.iter().any(|x| is_differentiated(&x.kind));
    let is_preferred = |x: &Variable| {
        x.ty == Type::Real
            && x.kind == VariableKind::Algebraic
            && x.derivative_of.is_none()
            && matches!(x.state_select, StateSelect::Prefer | StateSelect::Always)
    };
    let all = dae.variables.enumerate().filter(|(_, x)| has_states && is_preferred(x));
    all.map(|(v, _)| v).collect()
}

/// Gives them derivatives.
pub fn differentiate(dae: &mut Dae, preferred: &[VarId]) {
    for &v in preferred {
        let mut rate = Variable::derivative(v, &dae.variables[v], VariableKind::Algebraic);
        rate.hidden = true;
        let rate = dae.variables.push(rate);
        dae.variables[v].kind = VariableKind::Differentiated { derivative: rate };
    }
}

/// Whether the index reduction has made states of them and of nothing that may jump.
pub fn are_states(dae: &Dae, preferred: &[VarId], reduced: &Reduced) -> bool {
    let constraints = dae.equations.iter().filter_map(|e| e.derivative_of);
    preferred.iter().any(|v| reduced.is_state[*v])
        && !reduced.pivots.iter().any(|pivot| pivot.varying)
        && !any_jumps(dae, constraints)
}

/// True if something in equations changes at events only, is an input or is recorded: what they relate may jump. An Integer
/// may stand for the phase of a medium, whose properties are continuous where it changes.
pub fn any_jumps(dae: &Dae, equations: impl Iterator<Item = EqId>) -> bool {
    let residuals: Vec<_> = equations.map(|of| dae.equations[of].residual).collect();
    dae.graph.any(residuals, |_, node| match node {
        Node::Relation(_) | Node::Recorded(..) | Node::Pre(_) | Node::Initial => true,
        Node::Var(v) => match dae.variables[v].kind {
            VariableKind::Discrete => dae.variables[v].ty != Type::Integer,
            kind => kind == VariableKind::Input,
        },
        _ => false,
    })
}

fn is_differentiated(kind: &VariableKind) -> bool {
    matches!(kind, VariableKind::Differentiated { .. })
}
