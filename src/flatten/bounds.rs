//! Checks the values of parameters and constants against their `min` and `max` attributes without a
//! simulation, for `mocc check` (Modelica 3.6, section 4.8).

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
        let min = number(v.min).filter(|min| value < *min).map(|min| ("below", "min", min));
        let max = number(v.max).filter(|max| value > *max).map(|max| ("above", "max", max));
        if let Some((side, attribute, bound)) = min.or(max) {
            let message = format!("`{}` is {value}, {side} its `{attribute}` of {bound}", v.name);
            problems.push(
                Diagnostic::warning("MO0273", v.span, message)
                    .help("give it another value, or another bound"),
            );
        }
    }
}
