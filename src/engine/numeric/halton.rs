//! The Halton sequence: quasi-random points that fill the unit cube evenly.
//!
//! J. H. Halton, *On the efficiency of certain quasi-random sequences of points*, Numerische
//! Mathematik 2 (1960): the digits of a counter mirrored at the radix point, in a different prime
//! base for each coordinate. The first points, which lie along the diagonal, are skipped.

/// Generator of the sequence.
pub struct Halton {
    bases: Vec<u64>,
    index: u64,
}

/// Number of initial points that are skipped.
const SKIPPED: u64 = 20;

impl Halton {
    /// Points in `[0, 1)^n`.
    pub fn new(n: usize) -> Self {
        let prime = |k: &u64| (2..*k).take_while(|d| d * d <= *k).all(|d| !k.is_multiple_of(d));
        Halton { bases: (2..).filter(prime).take(n).collect(), index: SKIPPED }
    }

    /// The next point.
    pub fn next_point(&mut self) -> Vec<f64> {
        self.index += 1;
        self.bases.iter().map(|b| mirrored(self.index, *b)).collect()
    }
}

fn mirrored(mut index: u64, base: u64) -> f64 {
    let (mut value, mut place) = (0.0, 1.0 / base as f64);
    while index > 0 {
        value += (index % base) as f64 * place;
        index /= base;
        place /= base as f64;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_mirrored() {
        assert_eq!(mirrored(6, 2), 0.375);
        assert!((mirrored(5, 3) - 7.0 / 9.0).abs() < 1e-15);
    }

    #[test]
    fn points_are_spread_evenly() {
        let mut halton = Halton::new(3);
        let points: Vec<_> = (0..1000).map(|_| halton.next_point()).collect();
        for k in 0..3 {
            let mean = points.iter().map(|p| p[k]).sum::<f64>() / 1000.0;
            assert!((mean - 0.5).abs() < 0.01, "{mean}");
        }
    }
}
