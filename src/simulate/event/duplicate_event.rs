//! The echo of an event: a relation that an event turned and that turns back at once.
//!
//! A ball that meets the floor lies below it by rounding, and the `reinit` of its speed takes it out
//! again: `h <= 0` becomes true, and false in the same instant as far as anyone can see. The second
//! switching must be found, so that the next impact is one; but nothing happens at it, and it is
//! neither told nor counted.

use crate::ir::program::{Program, Slot};

/// An echo follows its event within this part of the run.
const SPAN: f64 = 1e-9;
/// Variables that differ by less, relative to their size, stay as they are.
const NOISE: f64 = 1e-9;

/// The last event.
pub struct DuplicateFilter {
    span: f64,
    time: f64,
    flipped: Vec<(u32, bool)>,
}

impl DuplicateFilter {
    /// In a run of this duration, s.
    pub fn new(duration: f64) -> Self {
        DuplicateFilter { span: SPAN * duration, time: f64::NEG_INFINITY, flipped: Vec::new() }
    }

    /// Takes an event with the relations that it turned.
    pub fn record(&mut self, t: f64, flipped: &[(u32, bool)]) {
        self.time = t;
        self.flipped.clear();
        self.flipped.extend_from_slice(flipped);
    }

    /// Whether these relations are among those of the event before, turn back, and follow at once.
    pub fn matches(&self, t: f64, flipped: &[(u32, bool)]) -> bool {
        let flipped_back = |(k, truth): &(u32, bool)| self.flipped.contains(&(*k, !truth));
        t - self.time <= self.span && !flipped.is_empty() && flipped.iter().all(flipped_back)
    }
}

/// Whether all variables that the user declared have the same values in both memories.
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
    fn an_echo_turns_back_what_its_event_turned() {
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
