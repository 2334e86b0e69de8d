//! Compares the units of columns with those of the variables that they determine or measure.
//!
//! *In:* a program and a plan whose columns are converted to SI units. *Out:* an error for each
//! variable that is declared in a unit of another dimension, in `Hz` where the column measures an angle
//! or the other way round, or not in an SI unit.

use crate::base::diag::{Diagnostic, Problems};
use crate::base::source::Span;
use crate::ir::program::Program;
use crate::units::unit;

use super::cause::PlanCause;
use super::plan::Plan;
use super::unit::{Mismatch, Unit};

/// A column and the variable that it belongs to.
struct Pair<'a> {
    variable: &'a str,
    unit: Unit,
    span: Span,
}

/// Reports columns whose units are not those of their variables. Variables that do not exist are
/// reported elsewhere.
pub fn check(program: &Program, plan: &Plan, problems: &mut Problems) {
    let of = |variable, unit, span| Pair { variable, unit, span };
    let signals = plan.signals.iter().map(|s| of(&s.variable, s.unit, s.span));
    let inputs = plan.inputs.iter().map(|i| of(&i.input, i.unit, i.span));
    let conditions = plan.conditions.iter().map(|c| of(&c.parameter, c.unit, c.span));
    let starts = plan.starts.iter().map(|s| {
        let name = s.target.strip_prefix("start(").and_then(|rest| rest.strip_suffix(')'));
        let rate = s.unit.dimension.over(Unit::SECOND.dimension);
        let unit = if s.rate { Unit { dimension: rate, ..s.unit } } else { s.unit };
        of(name.unwrap_or(&s.target).trim(), unit, s.span)
    });
    for pair in signals.chain(inputs).chain(conditions).chain(starts) {
        if let Some(cause) = mismatch(program, &pair) {
            problems.push(Diagnostic::new(cause, pair.span));
        }
    }
}

fn mismatch(program: &Program, pair: &Pair<'_>) -> Option<PlanCause> {
    let variable = program.blocks.dae.variables.iter().find(|v| v.name == pair.variable)?;
    let (name, declared) = (variable.name.clone(), variable.unit.to_string());
    let si = pair.unit.dimension.to_string();
    match pair.unit.mismatch(&declared) {
        Some(Mismatch::Dimension) => {
            return Some(PlanCause::UnitOfVariable { name, declared, given: si });
        }
        Some(Mismatch::Turn) => return Some(PlanCause::ATurnApart { name, declared }),
        None => {}
    }
    let unit = unit::Unit::of(&declared).filter(|_| !declared.is_empty())?;
    let (own, given) = unit.scale.zip(unit::Unit::si(pair.unit.dimension).scale)?;
    (!own.is_same(given)).then_some(PlanCause::NotInSi { name, declared, si })
}
