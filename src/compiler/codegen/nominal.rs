//! Nominal values of the components of the integrator: the sizes below which their errors are
//! absolute.
//!
//! A declared nominal value is used as it is. Otherwise the size is inferred from equations such as
//! `q = c * u` and the nominal values on the other side, or from the start value. Since neither is
//! certain, a small fraction of an inferred size is used.

use crate::base::index::FastMap;
use crate::ir::dae::{EqId, VariableKind};
use crate::ir::expr::{Binary, ExprId, Unary, VarId};
use crate::ir::program::Slot;
use crate::symbolic::gradient::{Leaf, gradient};
use crate::symbolic::linear;

use super::block::nominal;
use super::emit::{Emitter, PARAMETER};

/// Fraction of an inferred size below which errors are absolute.
const UNCERTAINTY: f64 = 1e-2;

/// Largest size that may be inferred from a coefficient alone.
const MAX_INFERRED: f64 = 1e6;

/// Emits the sizes of the components to the parameter tape; returns their slots.
pub fn of_components(e: &mut Emitter, components: &[VarId]) -> Vec<Slot> {
    let mut equations: FastMap<VarId, Vec<EqId>> = FastMap::default();
    let open = components.iter().copied().filter(|v| e.dae.variables[*v].nominal.is_none());
    equations.extend(open.map(|v| (v, Vec::new())));
    if !equations.is_empty() {
        for (id, equation) in e.dae.equations.enumerate() {
            if equation.derivative_of.is_none() {
                for v in e.dae.graph.variables(equation.residual) {
                    if let Some(list) = equations.get_mut(&v) {
                        list.push(id);
                    }
                }
            }
        }
    }
    let size = |v: &VarId| match equations.get(v) {
        None => nominal(e, *v),
        Some(list) => estimate(e, *v, list),
    };
    components.iter().map(size).collect()
}

fn estimate(e: &mut Emitter, v: VarId, equations: &[EqId]) -> Slot {
    let sizes: Vec<ExprId> = equations
        .iter()
        .filter_map(|id| from_equation(e, v, e.dae.equations[*id].residual))
        .collect();
    let inferred = sizes.into_iter().reduce(|a, b| e.dae.graph.binary(Binary::Max, a, b));
    let start = e.dae.variables[v].start.filter(|s| e.level_of(&[*s], |_| false) == PARAMETER);
    let start = start.map(|s| e.dae.graph.unary(Unary::Abs, s));
    let g = &mut e.dae.graph;
    let size = match (inferred, start) {
        (Some(a), Some(b)) => g.binary(Binary::Max, a, b),
        (Some(a), None) => a,
        (None, Some(b)) => {
            let (zero, one) = (g.real(0.0), g.real(1.0));
            let starts = g.binary(Binary::Greater, b, zero);
            g.if_then_else(starts, b, one)
        }
        (None, None) => g.real(1.0),
    };
    let uncertainty = g.real(UNCERTAINTY);
    let size = g.mul(uncertainty, size);
    e.emit(size).0
}

/// The size of `v`, if an equation is linear in it and contains information about sizes: a nominal
/// value, or a coefficient other than one.
fn from_equation(e: &mut Emitter, v: VarId, residual: ExprId) -> Option<ExprId> {
    let (coefficient, rest) = linear::split(&mut e.dae.graph, residual, Leaf::Var(v))?;
    let is_fixed = |e: &Emitter, x| e.level_of(&[x], |_| false) == PARAMETER;
    if !is_fixed(e, coefficient) {
        return None;
    }
    let moves = |e: &Emitter, v: VarId| {
        let kind = e.dae.variables.get(v).map(|x| x.kind);
        !matches!(kind, None | Some(VariableKind::Parameter | VariableKind::InitialParameter))
    };
    let partials = gradient(&mut e.dae.graph, rest, |_| true);
    let mut informative = is_informative(e, coefficient);
    let mut known = false;
    let mut terms = Vec::new();
    for (leaf, partial) in partials {
        let Leaf::Var(z) = leaf else { return None };
        if !moves(e, z) {
            continue;
        }
        if e.dae.variables[z].derivative_of.is_some() || !is_fixed(e, partial) {
            return None;
        }
        let given = e.dae.variables[z].nominal.filter(|n| is_fixed(e, *n));
        informative |= given.is_some() || is_informative(e, partial);
        known |= given.is_some();
        let term = e.dae.graph.unary(Unary::Abs, partial);
        terms.push(match given {
            Some(size) => {
                let size = e.dae.graph.unary(Unary::Abs, size);
                e.dae.graph.mul(term, size)
            }
            None => term,
        });
    }
    if terms.is_empty() || !informative {
        return None;
    }
    let g = &mut e.dae.graph;
    let sum = g.sum(terms);
    let coefficient = g.unary(Unary::Abs, coefficient);
    let size = g.div(sum, coefficient);
    if known {
        return Some(size);
    }
    // A coefficient such as 1e-12 means that the other side is small, not that this one is large.
    let (limit, one) = (g.real(MAX_INFERRED), g.real(1.0));
    let too_large = g.binary(Binary::Greater, size, limit);
    Some(g.if_then_else(too_large, one, size))
}

fn is_informative(e: &Emitter, coefficient: ExprId) -> bool {
    e.dae.graph.as_number(coefficient).is_none_or(|c| c.abs() != 1.0)
}
