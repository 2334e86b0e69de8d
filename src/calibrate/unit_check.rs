//! Compares the units of columns with those of the variables that they determine or measure.
//!
//! *In:* a program and a plan whose columns are converted to SI units. *Out:* an error for each
//! variable that is declared in a unit of another dimension, or not in an SI unit.

use crate::base::diag::{Diagnostic, Problems};
use crate::base::source::Span;
use crate::ir::program::Program;
use crate::units::unit;

use super::cause::PlanCause;
use super::plan::Plan;
use super::unit::Unit;

/// A column and the variable that it belongs to.
struct Pair<'a> {
    variable: &'a str,
    unit: unit::Unit,
    span: Span,
}

/// Reports columns whose units are not those of their variables. Variables that do not exist are
/// reported elsewhere.
pub fn check(program: &Program, plan: &Plan, problems: &mut Problems) {
    let si = |unit: Unit| unit::Unit::si(unit.dimension);
    let of = |variable, unit, span| Pair { variable, unit: si(unit), span };
    let signals = plan.signals.iter().map(|s| of(&s.variable, s.unit, s.span));
    let inputs = plan.inputs.iter().map(|i| of(&i.input, i.unit, i.span));
    let conditions = plan.conditions.iter().map(|c| of(&c.parameter, c.unit, c.span));
    let starts = plan.starts.iter().map(|s| {
        let name = s.target.strip_prefix("start(").and_then(|rest| rest.strip_suffix(')'));
        let unit = if s.rate { si(s.unit).over(si(Unit::SECOND)) } else { si(s.unit) };
        Pair { variable: name.unwrap_or(&s.target).trim(), unit, span: s.span }
    });
    for pair in signals.chain(inputs).chain(conditions).chain(starts) {
        if let Some(cause) = mismatch(program, &pair) {
            problems.push(Diagnostic::new(cause, pair.span));
        }
    }
}

fn mismatch(program: &Program, pair: &Pair<'_>) -> Option<PlanCause> {
    let variable = program.blocks.dae.variables.iter().find(|v| v.name == pair.variable)?;
    let unit = unit::Unit::of(&variable.unit).filter(|_| !variable.unit.is_empty())?;
    let (name, declared) = (variable.name.clone(), variable.unit.to_string());
    let si = pair.unit.dimension.to_string();
    if unit.dimension != pair.unit.dimension {
        return Some(PlanCause::UnitOfVariable { name, declared, given: si });
    }
    let (own, given) = unit.scale.zip(pair.unit.scale)?;
    (!own.is_same(given)).then_some(PlanCause::NotInSi { name, declared, si })
}
