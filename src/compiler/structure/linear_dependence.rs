//! Linear equations of which there is one too many.
//!
//! *In:* residuals that are linear in some unknowns, one more than unknowns. *Out:* whether one equation is a
//! combination of the others, so that it may be left out. The currents of lines in series that all start at rest are
//! such: each start follows from the others. Everything else that the equations read has the values of the parameters,
//! or any: a dependence there is one in general.

use super::parameter_values::ParameterValues;
use crate::base::index::FastMap;
use crate::ir::expr::{ExprId, Graph, VarId};
use crate::numeric::null_space::NullSpace;

/// Larger systems are reported instead.
const MAX_ORDER: usize = 400;
/// Tolerated contradiction of the equations, relative to the sizes of their terms.
const TOLERANCE: f64 = 1e-6;

/// Whether the residuals determine all unknowns and vanish together. The residual that is to be left out, if it is one
/// of them, has to depend on the others. `None` if they are not linear, or too many, so that this is not known.
pub fn is_consistent(
    graph: &mut Graph,
    residuals: &[ExprId],
    place: &FastMap<VarId, usize>,
    left_out: Option<usize>,
    values: &mut ParameterValues,
) -> Option<bool> {
    let order = residuals.len();
    if order != place.len() + 1 || order > MAX_ORDER {
        return None;
    }
    let mut matrix = Vec::with_capacity(order);
    let mut constants = Vec::with_capacity(order);
    for &residual in residuals {
        let mut row = values.coefficients(graph, residual, place, |values, graph, e| {
            let is_open = graph.variables(e).iter().any(|v| place.contains_key(v));
            (!is_open).then(|| values.sample(graph, e, |_| false))
        })?;
        // A column of zeros makes the matrix square.
        row.push(0.0);
        matrix.push(row);
        let constant = values.sample(graph, residual, |v| place.contains_key(&v));
        if !constant.is_finite() {
            return None;
        }
        constants.push(constant);
    }
    let null_space = NullSpace::of(&matrix);
    let [combination] = null_space.left.as_slice() else { return Some(false) };
    let terms = || combination.iter().zip(&constants).map(|(w, c)| w * c);
    let (sum, size): (f64, f64) = (terms().sum(), terms().map(f64::abs).sum());
    Some(left_out.is_none_or(|k| combination[k] != 0.0) && sum.abs() <= TOLERANCE * size)
}
