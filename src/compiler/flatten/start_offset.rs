//! States that start elsewhere than their declarations say: `annotation(__mocc(starts = "x = offset.d"))`.
//!
//! A model that extends another one can give a state a new start, but cannot add to the one that it has, which may be a
//! parameter that differs from run to run. The vendor-specific annotation (Modelica Language Specification 3.6, section
//! 18.1) names the state and a parameter that is added to its start.

use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::ir::ast::Variability;
use crate::ir::expr::{Type, VarId};
use crate::ir::flat::{FlatModel, Variable};

use super::annotation::Pair;
use super::cause::{FlattenCause, WrongStart};

/// Adds parameters to the starts of states, each pair a state and a parameter. Returns what cannot be done.
pub(super) fn apply(flat: &mut FlatModel, pairs: &[Pair]) -> Vec<Diagnostic> {
    if pairs.is_empty() {
        return Vec::new();
    }
    let by_name: FastMap<&str, VarId> =
        flat.variables.enumerate().map(|(v, x)| (x.name.as_str(), v)).collect();
    let (mut offsets, mut problems) = (Vec::new(), Vec::new());
    for pair in pairs {
        let named = |name: &str| by_name.get(name).copied();
        match offset(flat, named(&pair.left), named(&pair.right)) {
            Ok(offset) => offsets.push(offset),
            Err(why) => {
                let (state, offset) = (pair.left.clone(), pair.right.clone());
                let cause = FlattenCause::UnusableStart { state, offset, why };
                problems.push(Diagnostic::new(cause, pair.span));
            }
        }
    }
    for (state, offset) in offsets {
        let offset = flat.graph.var(offset, Type::Real);
        let start = match flat.variables[state].start {
            Some(start) => flat.graph.add(start, offset),
            None => offset,
        };
        flat.variables[state].start = Some(start);
    }
    problems
}

fn offset(
    flat: &FlatModel,
    state: Option<VarId>,
    offset: Option<VarId>,
) -> Result<(VarId, VarId), WrongStart> {
    let state = state.filter(|v| starts_by_declaration(&flat.variables[*v]));
    let state = state.ok_or(WrongStart::State)?;
    let offset = offset.ok_or(WrongStart::Offset)?;
    let x = &flat.variables[offset];
    match x.ty == Type::Real && x.variability <= Variability::Parameter {
        true => Ok((state, offset)),
        false => Err(WrongStart::Offset),
    }
}

/// True for a continuous Real variable whose declaration fixes its start.
pub fn starts_by_declaration(x: &Variable) -> bool {
    x.ty == Type::Real && x.variability == Variability::Continuous && x.fixed == Some(true)
}
