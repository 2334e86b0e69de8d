//! Nested places: branches of an `if`, or regions under a condition. The place of an expression is the
//! innermost one around all its uses, which dominates them.

/// Places by number. 0 is around all others.
pub struct Nesting {
    /// By place the one around it, and how many are.
    places: Vec<(usize, usize)>,
}

impl Default for Nesting {
    fn default() -> Nesting {
        Nesting { places: vec![(0, 0)] }
    }
}

impl Nesting {
    /// Adds a place directly inside another.
    pub fn inside(&mut self, around: usize) -> usize {
        self.places.push((around, self.depth(around) + 1));
        self.places.len() - 1
    }

    /// The place around another; 0 is inside itself.
    pub fn around(&self, place: usize) -> usize {
        self.places[place].0
    }

    /// How many places are around it.
    pub fn depth(&self, place: usize) -> usize {
        self.places[place].1
    }

    /// How many places there are.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// The innermost place around two.
    pub fn common(&self, mut a: usize, mut b: usize) -> usize {
        while a != b {
            if self.depth(a) >= self.depth(b) {
                a = self.around(a);
            } else {
                b = self.around(b);
            }
        }
        a
    }
}
