//! Duplicate events: a relation that changes in an event and changes back immediately afterwards.
//!
//! A ball that hits the floor is below it by a rounding error, and the `reinit` of its speed lifts
//! it out again: `h <= 0` becomes true, and false at virtually the same instant. The second change
//! must be located, so that the next impact is an event; but it has no effect, and is neither
//! reported nor counted.

use crate::ir::program::{Program, Slot};

/// Maximum time between an event and its duplicate, as a fraction of the run.
const SPAN: f64 = 1e-9;
/// Relative difference below which variables count as unchanged.
const NOISE: f64 = 1e-9;

/// The last event.
pub struct DuplicateFilter {
    span: f64,
    time: f64,
    flipped: Vec<(u32, bool)>,
}

impl DuplicateFilter {
    /// For a run of this duration, s.
    pub fn new(duration: f64) -> Self {
        DuplicateFilter { span: SPAN * duration, time: f64::NEG_INFINITY, flipped: Vec::new() }
    }

    /// Records an event with the relations that it flipped.
    pub fn record(&mut self, t: f64, flipped: &[(u32, bool)]) {
        self.time = t;
        self.flipped.clear();
        self.flipped.extend_from_slice(flipped);
    }

    /// True if these relations flip back relations of the previous event immediately after it.
    pub fn matches(&self, t: f64, flipped: &[(u32, bool)]) -> bool {
        let flipped_back = |(k, truth): &(u32, bool)| self.flipped.contains(&(*k, !truth));
        t - self.time <= self.span && !flipped.is_empty() && flipped.iter().all(flipped_back)
    }
}

/// True if all declared variables have the same values in both memories.
pub fn is_unchanged(program: &Program, before: &[f64], after: &[f64]) -> bool {
    let variables = &program.blocks.dae.variables;
    let same = |cell: Slot| {
        let (a, b) = (before[cell as usize], after[cell as usize]);
        a == b || (a - b).abs() <= NOISE * a.abs().max(b.abs())
    };
    variables.enumerate().filter(|(_, v)| !v.hidden).all(|(v, _)| same(program.slot(v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duplicate_flips_back_relations_of_the_previous_event() {
        let mut filter = DuplicateFilter::new(10.0);
        assert!(!filter.matches(1.0, &[(3, true)]));
        filter.record(1.0, &[(3, true), (5, false)]);
        assert!(filter.matches(1.0 + 1e-12, &[(3, false)]));
        assert!(filter.matches(1.0, &[(5, true), (3, false)]));
        assert!(!filter.matches(1.0, &[(3, true)]));
        assert!(!filter.matches(1.0, &[(4, false)]));
        assert!(!filter.matches(1.0, &[]));
        assert!(!filter.matches(1.0 + 1e-6, &[(3, false)]));
    }
}
