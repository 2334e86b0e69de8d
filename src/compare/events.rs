//! The comparison of event lists: the same events as often, each within the time tolerance.

use std::collections::BTreeMap;

/// An event of a list: when, s, and its description.
pub type Listed = (f64, String);

/// A difference of two lists.
#[derive(Clone, PartialEq, Debug)]
pub enum Change {
    /// Both have it, at times that differ by more than the tolerance.
    Moved {
        /// Its description.
        what: String,
        /// Time in the run, s.
        found: f64,
        /// Time in the reference, s.
        expected: f64,
    },
    /// Only the run has it.
    Added {
        /// Its description.
        what: String,
        /// Its time, s.
        time: f64,
    },
    /// Only the reference has it.
    Missing {
        /// Its description.
        what: String,
        /// Its time, s.
        time: f64,
    },
}

impl std::fmt::Display for Change {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Change::Moved { what, found, expected } => {
                let by = found - expected;
                write!(f, "`{what}` happens at {found:.9} s, not at {expected:.9} s ({by:+.3e} s)")
            }
            Change::Added { what, time } => write!(f, "`{what}` at {time:.9} s is new"),
            Change::Missing { what, time } => write!(f, "`{what}` at {time:.9} s is missing"),
        }
    }
}

/// The differences of a run's events from those of a reference, which may move by `shift`, s. Events of one description
/// are compared in order; events that come within the tolerance of each other may change places.
pub fn changes(found: &[Listed], expected: &[Listed], shift: f64) -> Vec<(f64, Change)> {
    let mut all: BTreeMap<&str, (Vec<f64>, Vec<f64>)> = BTreeMap::new();
    for (time, what) in found {
        all.entry(what).or_default().0.push(*time);
    }
    for (time, what) in expected {
        all.entry(what).or_default().1.push(*time);
    }
    let mut out = Vec::new();
    for (what, (found, expected)) in all {
        compare(what, &found, &expected, shift, &mut out);
    }
    out.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    out
}

/// Pairs the occurrences of one event. Where their numbers are equal, by order; else those that are near each other.
fn compare(what: &str, found: &[f64], expected: &[f64], shift: f64, out: &mut Vec<(f64, Change)>) {
    let what = || what.to_owned();
    // Times that were printed have nine digits after the point.
    let shift = shift + 1e-9;
    if found.len() == expected.len() {
        for (&found, &expected) in found.iter().zip(expected) {
            if (found - expected).abs() > shift {
                out.push((expected, Change::Moved { what: what(), found, expected }));
            }
        }
        return;
    }
    let (mut i, mut j) = (0, 0);
    while i < found.len() || j < expected.len() {
        match (found.get(i), expected.get(j)) {
            (Some(a), Some(b)) if (a - b).abs() <= shift => (i, j) = (i + 1, j + 1),
            (Some(&time), b) if b.is_none_or(|b| time < *b) => {
                out.push((time, Change::Added { what: what(), time }));
                i += 1;
            }
            (_, Some(&time)) => {
                out.push((time, Change::Missing { what: what(), time }));
                j += 1;
            }
            _ => break,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(events: &[(f64, &str)]) -> Vec<Listed> {
        events.iter().map(|(t, what)| (*t, (*what).to_owned())).collect()
    }

    #[test]
    fn events_may_move_within_the_tolerance() {
        let before = list(&[(0.1, "a"), (0.2, "b"), (0.3, "a")]);
        let after = list(&[(0.1005, "a"), (0.1995, "b"), (0.3, "a")]);
        assert_eq!(changes(&after, &before, 1e-3), []);
        let found: Vec<String> =
            changes(&after, &before, 1e-4).into_iter().map(|(_, c)| c.to_string()).collect();
        assert_eq!(
            found,
            [
                "`a` happens at 0.100500000 s, not at 0.100000000 s (+5.000e-4 s)",
                "`b` happens at 0.199500000 s, not at 0.200000000 s (-5.000e-4 s)"
            ]
        );
    }

    #[test]
    fn events_that_come_and_go_are_named() {
        let before = list(&[(0.1, "a"), (0.2, "a"), (0.3, "a")]);
        let after = list(&[(0.1, "a"), (0.25, "b"), (0.3, "a")]);
        let found: Vec<String> =
            changes(&after, &before, 1e-4).into_iter().map(|(_, c)| c.to_string()).collect();
        assert_eq!(found, ["`a` at 0.200000000 s is missing", "`b` at 0.250000000 s is new"]);
    }
}
