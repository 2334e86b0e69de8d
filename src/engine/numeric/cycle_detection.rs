//! Detects cycles in an iteration over discrete states.
//!
//! R. P. Brent, "An improved Monte Carlo factorization algorithm", BIT 20, 1980, section 2: compare
//! each state with one saved state, which is replaced after 1, 2, 4, ... iterations.

/// Finds every cycle after at most three rounds, storing a single state.
#[derive(Default)]
pub struct CycleDetector {
    saved: Vec<f64>,
    iteration: u32,
    next_save: u32,
}

impl CycleDetector {
    /// Starts a new iteration; the memory of the last one is reused.
    pub fn restart(&mut self) {
        (self.iteration, self.next_save) = (0, 0);
        self.saved.clear();
    }

    /// True if the next state of the iteration equals an earlier one, bit for bit.
    pub fn repeats(&mut self, state: &[f64]) -> bool {
        self.iteration += 1;
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        if self.iteration > 1 && self.saved.iter().zip(state).all(same) {
            return true;
        }
        if self.iteration > self.next_save {
            self.saved.clear();
            self.saved.extend_from_slice(state);
            self.next_save = 2 * self.iteration;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::CycleDetector;

    /// Iterations until a cycle of this length is found, after a lead-in of `lead` iterations.
    fn found_after(lead: u32, length: u32) -> u32 {
        let mut detector = CycleDetector::default();
        detector.restart();
        let state = |k: u32| if k < lead { k } else { lead + (k - lead) % length };
        let found = (0..1000).find(|k| detector.repeats(&[f64::from(state(*k))]));
        found.unwrap_or(u32::MAX)
    }

    #[test]
    fn a_cycle_is_found_soon_wherever_it_starts() {
        for lead in 0..20 {
            for length in 1..20 {
                let iterations = found_after(lead, length);
                assert!(iterations >= lead + length, "{lead} {length}: too early");
                assert!(iterations <= 3 * (lead + length) + 2, "{lead} {length}: {iterations}");
            }
        }
    }
}
