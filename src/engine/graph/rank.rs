//! Linear independence of columns whose entries are known numbers or vary.
//!
//! Varying entries are replaced by arbitrary numbers modulo a large prime: a set of columns that is
//! dependent then is dependent for all values, save with a probability of about 1e-15 (L. Lovász,
//! "On determinants, matchings and random algorithms", 1979). Constants enter exactly, so x + y and
//! 2 x + 2 y are found to be dependent although they can be matched.

use super::bipartite::Row;
use crate::base::index::IndexVec;
use std::collections::BTreeMap;

/// A number modulo the Mersenne prime 2^61 - 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Residue(u64);

const PRIME: u64 = (1 << 61) - 1;

impl Residue {
    /// The residue of a float, which is an integer times a power of two, if it is finite. Sums and
    /// products of floats that are exact have the sums and products of the residues.
    pub fn of_float(value: f64) -> Option<Residue> {
        let bits = value.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as i64;
        let fraction = bits & ((1 << 52) - 1);
        let (integer, power) = match exponent {
            0x7ff => return None,
            0 => (fraction, -1074),
            _ => (fraction | 1 << 52, exponent - 1075),
        };
        // Modulo the prime, 2^61 is 1.
        let size = Residue(integer).times(Residue(1 << power.rem_euclid(61)));
        Some(if value < 0.0 { size.negated() } else { size })
    }

    /// An arbitrary number that is not zero: always the same for the same `key`.
    pub fn arbitrary(key: u64) -> Residue {
        // The finalizer of Steele, Lea and Flood's SplitMix64.
        let mut z = key.wrapping_add(0x9E37_79B9_7F4A_7C15);
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        Residue((z ^ z >> 31) % (PRIME - 1) + 1)
    }

    fn times(self, other: Residue) -> Residue {
        Residue((u128::from(self.0) * u128::from(other.0) % u128::from(PRIME)) as u64)
    }

    fn plus(self, other: Residue) -> Residue {
        Residue((self.0 + other.0) % PRIME)
    }

    fn negated(self) -> Residue {
        Residue((PRIME - self.0) % PRIME)
    }

    /// The inverse by Fermat's little theorem.
    fn inverse(self) -> Residue {
        let (mut result, mut square, mut exponent) = (Residue(1), self, PRIME - 2);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = result.times(square);
            }
            square = square.times(square);
            exponent >>= 1;
        }
        result
    }
}

/// A set of independent columns in echelon form.
pub struct Echelon {
    /// For each row the column whose first entry, scaled to one, is there: its entries below.
    pivots: IndexVec<Row, Option<Vec<(Row, Residue)>>>,
}

impl Echelon {
    /// No columns, of `row_count` entries each.
    pub fn new(row_count: usize) -> Self {
        Echelon { pivots: IndexVec::filled(None, row_count) }
    }

    /// Adds a column, given by entries in any order, if it is independent of those present, and
    /// returns whether it is. Costs the entries of the columns it is reduced by.
    pub fn insert(&mut self, entries: impl IntoIterator<Item = (Row, Residue)>) -> bool {
        let mut column: BTreeMap<Row, Residue> = entries.into_iter().collect();
        while let Some((row, value)) = column.pop_first() {
            if value == Residue(0) {
                continue;
            }
            let Some(pivot) = &self.pivots[row] else {
                let scale = value.inverse();
                let below = column.into_iter().filter(|entry| entry.1 != Residue(0));
                let scaled = below.map(|(row, value)| (row, value.times(scale))).collect();
                self.pivots[row] = Some(scaled);
                return true;
            };
            let factor = value.negated();
            for &(row, entry) in pivot {
                let sum = column.entry(row).or_insert(Residue(0));
                *sum = sum.plus(entry.times(factor));
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::index::Id;
    use crate::graph::test_graphs::Xorshift;

    fn column(entries: &[f64]) -> Vec<(Row, Residue)> {
        let residue =
            |(i, &value): (usize, &f64)| Some((Row::from_usize(i), Residue::of_float(value)?));
        entries.iter().enumerate().filter_map(residue).collect()
    }

    #[test]
    fn floats_are_dyadic_rationals() {
        let [half, three, tiny] = [0.5, 3.0, f64::MIN_POSITIVE / 8.0].map(Residue::of_float);
        assert_eq!(three, Some(Residue(3)));
        assert_eq!(half.map(|half| half.times(Residue(2))), Some(Residue(1)));
        assert_eq!(Residue::of_float(-3.0).map(|x| x.plus(Residue(3))), Some(Residue(0)));
        // 2^-1025 times 2^1025, where 1025 = 16 * 61 + 49.
        assert_eq!(tiny.map(|tiny| tiny.times(Residue(1 << 49))), Some(Residue(1)));
        assert_eq!(Residue::of_float(f64::NAN), None);
        assert_eq!(Residue(12345).times(Residue(12345).inverse()), Residue(1));
    }

    #[test]
    fn dependent_constants_are_rejected_and_varying_entries_accepted() {
        let mut echelon = Echelon::new(2);
        assert!(echelon.insert(column(&[0.1, 0.2])));
        assert!(!echelon.insert(column(&[0.25, 0.5])));
        let varying = [(Row(0), Residue::arbitrary(1)), (Row(1), Residue::arbitrary(2))];
        assert!(echelon.insert(varying));
        assert!(!echelon.insert(column(&[7.0, 11.0])));
    }

    /// Against the determinants of all minors of matrices of small integers.
    #[test]
    fn rank_agrees_with_the_largest_minor_that_does_not_vanish() {
        let mut random = Xorshift::new(1979);
        let mut ranks = [0; 4];
        for _ in 0..400 {
            let matrix: [[i64; 3]; 3] =
                std::array::from_fn(|_| std::array::from_fn(|_| random.below(4) as i64 - 1));
            let mut echelon = Echelon::new(3);
            let inserted = matrix
                .iter()
                .filter(|entries| echelon.insert(column(&entries.map(|entry| entry as f64))));
            let found = inserted.count();
            let minor = |i: usize, j: usize, k: usize, l: usize| {
                matrix[i][k] * matrix[j][l] - matrix[i][l] * matrix[j][k]
            };
            let pairs = [(0, 1), (0, 2), (1, 2)];
            let determinant = matrix[0][0] * minor(1, 2, 1, 2) - matrix[0][1] * minor(1, 2, 0, 2)
                + matrix[0][2] * minor(1, 2, 0, 1);
            let expected = if determinant != 0 {
                3
            } else if pairs.iter().any(|&(i, j)| pairs.iter().any(|&(k, l)| minor(i, j, k, l) != 0))
            {
                2
            } else {
                usize::from(matrix.iter().flatten().any(|&entry| entry != 0))
            };
            assert_eq!(found, expected, "{matrix:?}");
            ranks[found] += 1;
        }
        assert!(ranks[2] > 50 && ranks[3] > 100, "{ranks:?}");
    }
}
