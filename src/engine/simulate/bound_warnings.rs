//! Warnings about values outside of the `min` and `max` of their variables (Modelica specification
//! 3.6, section 4.8.1).
//!
//! The specification treats bounds as assertions. mocc checks them in every row and only warns,
//! because many published models exceed a bound slightly.

use crate::base::diag::Diagnostic;
use crate::base::index::Id;
use crate::ir::dae::{Dae, VariableKind};
use crate::ir::expr::{Const, ExprId, Node, Unary, VarId};
use crate::ir::program::{Bounds, Program};

use super::cause::RunCause;

/// Maximum number of variables that are reported.
const MAX_WARNINGS: usize = 8;

/// The monitored variables.
pub struct BoundWarnings {
    monitored: Vec<(Bounds, f64)>,
    reported: usize,
}

impl BoundWarnings {
    /// Monitors the recorded variables. Violations smaller than `tolerance`, relative to the bound
    /// and to the nominal value, are ignored.
    pub fn new(program: &Program, tolerance: f64) -> BoundWarnings {
        let mut recorded = vec![false; program.blocks.dae.variables.len()];
        for v in program.recorded.iter().chain(&program.constants) {
            recorded[v.idx()] = true;
        }
        let monitored = program.bounds.iter().filter(|b| recorded[b.variable.idx()]);
        let margin = |b: &Bounds| match program.blocks.dae.variables[b.variable].kind {
            VariableKind::Parameter => 0.0,
            _ => tolerance,
        };
        BoundWarnings { monitored: monitored.map(|b| (*b, margin(b))).collect(), reported: 0 }
    }

    /// Checks the values at an instant; reports each variable once.
    #[inline]
    pub fn check(
        &mut self,
        program: &Program,
        memory: &[f64],
        t: f64,
        warnings: &mut Vec<Diagnostic>,
    ) {
        let mut k = 0;
        while let Some((bounds, margin)) = self.monitored.get(k) {
            if is_within(bounds, *margin, memory) {
                k += 1;
                continue;
            }
            if self.reported < MAX_WARNINGS {
                warnings.push(beyond(program, memory, bounds, t));
            } else if self.reported == MAX_WARNINGS {
                let place = program.blocks.dae.variables[bounds.variable].span;
                warnings.push(Diagnostic::new(RunCause::MoreBeyondBounds { time: t }, place));
                self.monitored.clear();
                return;
            }
            self.reported += 1;
            self.monitored.swap_remove(k);
        }
    }

    /// Stops monitoring parameters.
    pub fn drop_parameters(&mut self, program: &Program) {
        let variables = &program.blocks.dae.variables;
        self.monitored.retain(|(b, _)| variables[b.variable].kind != VariableKind::Parameter);
    }
}

fn is_within(bounds: &Bounds, margin: f64, memory: &[f64]) -> bool {
    let at = |slot| memory[slot as usize];
    let (value, min, max) = (at(bounds.value), at(bounds.min), at(bounds.max));
    value >= min && value <= max || {
        let nominal = memory[bounds.nominal as usize].abs();
        let is_near = |bound: f64| {
            bound.is_finite() && (value - bound).abs() <= margin * bound.abs().max(nominal)
        };
        (value >= min || is_near(min)) && (value <= max || is_near(max))
    }
}

fn beyond(program: &Program, memory: &[f64], bounds: &Bounds, t: f64) -> Diagnostic {
    let dae = &program.blocks.dae;
    let [value, min, max] =
        [bounds.value, bounds.min, bounds.max].map(|slot| memory[slot as usize]);
    let is_low = value < min;
    let (reported, negative) =
        declaring(dae, bounds.variable, is_low).unwrap_or((bounds.variable, false));
    // Avoids negative zero.
    let signed = |x: f64| if negative { 0.0 - x } else { x };
    let (value, bound) = (signed(value), signed(if is_low { min } else { max }));
    let attribute = if is_low == negative { "max" } else { "min" };
    let v = &dae.variables[reported];
    let time = (v.kind != VariableKind::Parameter).then_some(t);
    let cause = RunCause::BeyondBound { time, name: v.name.clone(), value, attribute, bound };
    Diagnostic::new(cause, v.span)
}

/// The alias that declares the bound, and whether it has the opposite sign.
fn declaring(dae: &Dae, v: VarId, is_low: bool) -> Option<(VarId, bool)> {
    let bound = |v: VarId, low: bool| {
        let variable = &dae.variables[v];
        if low { variable.min } else { variable.max }
    };
    let wanted = bound(v, is_low)?;
    let same = |&(other, value): &(VarId, ExprId)| match dae.graph.node(value) {
        // The representative has the bounds of all its aliases.
        Node::Var(of) if of == v && bound(other, is_low) == Some(wanted) => Some((other, false)),
        Node::Unary(Unary::Neg, of) if dae.graph.node(of) == Node::Var(v) => {
            let number = |e: ExprId| dae.graph.as_const(e).and_then(Const::number);
            let own = bound(other, !is_low)?;
            let is_it = dae.graph.node(wanted) == Node::Unary(Unary::Neg, own)
                || number(wanted).is_some_and(|w| number(own).is_some_and(|n| n == -w));
            is_it.then_some((other, true))
        }
        _ => None,
    };
    dae.eliminated.iter().find_map(same)
}
