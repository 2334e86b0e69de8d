//! Parts of a sweep that other processes do: `--shard I/N`.

use std::ops::Range;

use super::error::SweepError;

/// A part of a sweep: consecutive runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Shard {
    /// Its number, from 1.
    pub number: u64,
    /// Number of parts.
    pub of: u64,
}

impl Shard {
    /// The whole sweep.
    pub const WHOLE: Shard = Shard { number: 1, of: 1 };

    /// Reads `I/N`.
    pub fn read(text: &str) -> Result<Shard, SweepError> {
        let wrong = || SweepError::Shard(text.to_owned());
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let read = |part: &str| part.trim().parse::<u64>().map_err(|_| wrong());
        let shard = Shard { number: read(number)?, of: read(of)? };
        let exists = shard.number >= 1 && shard.number <= shard.of;
        exists.then_some(shard).ok_or_else(wrong)
    }

    /// Its runs among `count`, counted from 0: parts differ by one run at most.
    pub fn runs(self, count: u64) -> Range<u64> {
        let border = |k: u64| (u128::from(count) * u128::from(k) / u128::from(self.of)) as u64;
        border(self.number - 1)..border(self.number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_a_partition() {
        for (count, of) in [(10, 3), (2, 5), (0, 2), (100_000_000, 7)] {
            let mut next = 0;
            for number in 1..=of {
                let runs = Shard { number, of }.runs(count);
                assert_eq!(runs.start, next);
                assert!(runs.end - runs.start <= count / of + 1);
                next = runs.end;
            }
            assert_eq!(next, count);
        }
    }

    #[test]
    fn a_part_is_a_number_among_others() {
        assert_eq!(Shard::read("2/8").unwrap(), Shard { number: 2, of: 8 });
        for wrong in ["0/8", "9/8", "2", "a/b", "1/0", "-1/2"] {
            assert!(Shard::read(wrong).is_err(), "{wrong}");
        }
    }
}
