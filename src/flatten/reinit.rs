//! A variable is reinitialized in one when-equation only (Modelica 3.6, section 8.3.6).

use super::cause::FlattenCause;
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::ir::expr::VarId;
use crate::ir::flat::{Action, EquationKind, FlatModel};

/// Reports variables that several when-equations reinitialize. Branches of one may do so.
pub(super) fn check(cx: &mut Evaluator<'_>, flat: &FlatModel) {
    let mut first: FastMap<VarId, (usize, Span)> = FastMap::default();
    for (k, equation) in flat.equations.iter().enumerate() {
        let EquationKind::When(branches) = &equation.kind else { continue };
        let span = equation.origin.span;
        for action in branches.iter().flat_map(|branch| &branch.actions) {
            let Action::Reinit { state, .. } = action else { continue };
            let (number, place) = *first.entry(*state).or_insert((k, span));
            if number != k {
                let name = flat.variables[*state].name.to_string();
                cx.problems.push(
                    Diagnostic::new(FlattenCause::ReinitTwice { name }, span)
                        .also(place, "reinitialized here too"),
                );
            }
        }
    }
}
