//! Checks the values of parameters and constants against their `min` and `max` attributes without a
//! simulation, for `mocc check` (Modelica 3.6, section 4.8).

use super::cause::FlattenCause;
use crate::base::diag::{Diagnostic, Problems};
use crate::ir::ast::Variability;
use crate::ir::expr::ExprId;
use crate::ir::flat::FlatModel;

/// Warns of each value outside its bounds.
pub fn check(flat: &FlatModel, problems: &mut Problems) {
    let number = |e: Option<ExprId>| flat.graph.as_const(e?)?.number();
    for v in flat.variables.iter() {
        if v.variability > Variability::Parameter {
            continue;
        }
        let Some(value) = number(v.binding) else { continue };
        let min = number(v.min).filter(|min| value < *min).map(|min| (min, false));
        let max = number(v.max).filter(|max| value > *max).map(|max| (max, true));
        if let Some((bound, above)) = min.or(max) {
            let name = v.name.to_string();
            let cause = FlattenCause::OutsideBounds { name, value, bound, above };
            problems.push(Diagnostic::new(cause, v.span));
        }
    }
}
