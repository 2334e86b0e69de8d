//! Finding out that an iteration over discrete states goes round in a circle.

/// Compares each state of an iteration with one that is kept ever longer, so that every circle is
/// found once it was gone round at most three times, with one state kept (R. P. Brent, "An improved
/// Monte Carlo factorization algorithm", BIT 20, 1980, section 2).
#[derive(Default)]
pub struct Circle {
    kept: Vec<f64>,
    turn: u32,
    next: u32,
}

impl Circle {
    /// Before the first turn. The memory of the last iteration is used again.
    pub fn open(&mut self) {
        (self.turn, self.next) = (0, 0);
        self.kept.clear();
    }

    /// True if the state of the next turn is, to the bit, that of a turn before.
    pub fn is_closed_by(&mut self, state: &[f64]) -> bool {
        self.turn += 1;
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        if self.turn > 1 && self.kept.iter().zip(state).all(same) {
            return true;
        }
        if self.turn > self.next {
            self.kept.clear();
            self.kept.extend_from_slice(state);
            self.next = 2 * self.turn;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::Circle;

    /// Turns until a circle of this length is found, after as many turns that lead into it.
    fn found_after(lead: u32, length: u32) -> u32 {
        let mut circle = Circle::default();
        circle.open();
        let state = |k: u32| if k < lead { k } else { lead + (k - lead) % length };
        let closed = (0..1000).find(|k| circle.is_closed_by(&[f64::from(state(*k))]));
        closed.unwrap_or(u32::MAX)
    }

    #[test]
    fn a_circle_is_found_soon_wherever_it_begins() {
        for lead in 0..20 {
            for length in 1..20 {
                let turns = found_after(lead, length);
                assert!(turns >= lead + length, "{lead} {length}: too early");
                assert!(turns <= 3 * (lead + length) + 2, "{lead} {length}: {turns}");
            }
        }
    }
}
