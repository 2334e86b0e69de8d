//! How often and with which shift the sub-clock partitions tick (Modelica 3.6, section 16.7.5).

use super::error::ClockCause;
use super::fraction::Fraction;
use super::partition::{Conversion, Partitions};
use crate::base::diag::Diagnostic;
use crate::base::index::FastMap;
use crate::ir::clock::ClockOperator;
use crate::ir::flat::FlatModel;

/// The clock of a sub-clock partition relative to the others of its group.
#[derive(Clone, Copy, Debug)]
pub struct Rate {
    /// The group: the partitions whose clocks follow from each other by known factors.
    pub group: usize,
    /// Period in periods of the group.
    pub period: Fraction,
    /// First tick, in periods of the group.
    pub shift: Fraction,
}

impl Rate {
    /// The rate of the target of a conversion.
    fn converted(self, by: &Conversion) -> Option<Rate> {
        let [a, b] = by.counters.map(i128::from);
        let whole = |n| Fraction::new(n, 1);
        let shifted = |by: Fraction| Rate { shift: self.shift.plus(by.times(self.period)), ..self };
        Some(match by.op {
            ClockOperator::SubSample if a > 0 => {
                Rate { period: self.period.times(whole(a)), ..self }
            }
            ClockOperator::SuperSample if a > 0 => {
                Rate { period: self.period.over(whole(a)), ..self }
            }
            ClockOperator::ShiftSample => shifted(Fraction::new(a, b)),
            ClockOperator::BackSample => shifted(Fraction::new(-a, b)),
            ClockOperator::Solver => self,
            _ => return None,
        })
    }

    /// The rate of the source of a conversion.
    fn inverse(self, by: &Conversion) -> Option<Rate> {
        let unit = Rate { period: Fraction::ONE, shift: Fraction::ZERO, ..self };
        let there = unit.converted(by)?;
        let period = self.period.over(there.period);
        Some(Rate { period, shift: self.shift.minus(there.shift.times(period)), ..self })
    }
}

/// The rates of all clocked sub-clock partitions.
pub fn infer(
    _flat: &FlatModel,
    parts: &Partitions,
    problems: &mut Vec<Diagnostic>,
) -> FastMap<usize, Rate> {
    let mut neighbours: FastMap<usize, Vec<usize>> = FastMap::default();
    for (k, c) in parts.conversions.iter().enumerate() {
        for node in [c.from, c.to] {
            neighbours.entry(parts.sub(node)).or_default().push(k);
        }
    }
    let mut rates: FastMap<usize, Rate> = FastMap::default();
    for root in parts.subs() {
        if rates.contains_key(&root) {
            continue;
        }
        rates.insert(root, Rate { group: root, period: Fraction::ONE, shift: Fraction::ZERO });
        let mut pending = vec![root];
        while let Some(sub) = pending.pop() {
            let rate = rates[&sub];
            for &k in neighbours.get(&sub).into_iter().flatten() {
                let c = &parts.conversions[k];
                let [from, to] = [c.from, c.to].map(|n| parts.sub(n));
                let forwards = (from == sub).then(|| (to, rate.converted(c)));
                let backwards = (to == sub).then(|| (from, rate.inverse(c)));
                for (other, next) in forwards.into_iter().chain(backwards) {
                    let Some(next) = next else { continue };
                    match rates.get(&other) {
                        None => {
                            rates.insert(other, next);
                            pending.push(other);
                        }
                        Some(known) if known.period != next.period || known.shift != next.shift => {
                            contradiction(*known, next, c, problems);
                        }
                        Some(_) => {}
                    }
                }
            }
        }
    }
    rates
}

fn contradiction(known: Rate, next: Rate, at: &Conversion, problems: &mut Vec<Diagnostic>) {
    let reported = |d: &Diagnostic| {
        d.primary.0 == at.origin.span
            && d.is(|c: &ClockCause| matches!(c, ClockCause::ContradictingClocks { .. }))
    };
    if problems.iter().any(reported) {
        return;
    }
    let text = |r: Rate| {
        let (period, shift) = (r.period.value(), r.shift.value());
        match r.shift.is_zero() {
            true => format!("one of {period} times the period"),
            false => format!("one of {period} times the period, shifted by {shift}"),
        }
    };
    let (first, second) = (text(known), text(next));
    let cause = ClockCause::ContradictingClocks { first, second };
    problems.push(Diagnostic::new(cause, at.origin.span));
}
