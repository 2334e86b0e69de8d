//! The random number generator xorshift1024*, with access by index.

use crate::base::wire::{Damaged, Reader, Wire};
use std::sync::Mutex;

use super::{External, Signature, same_if_equal};

/// Words of the state of xorshift1024*.
const WORDS: usize = 16;

/// Maximum distance of a requested index from the numbers generated so far.
const AHEAD: usize = 1 << 20;

/// The sequence of xorshift1024* from a state on. *S. Vigna, An experimental exploration of
/// Marsaglia's xorshift generators, scrambled, ACM TOMS 42 (2016).* Generated numbers are cached,
/// so that a run may read each any number of times.
#[derive(Debug)]
pub struct Stream {
    seed: [u64; WORDS],
    first: usize,
    drawn: Mutex<Drawn>,
}

#[derive(Clone, Debug)]
struct Drawn {
    state: [u64; WORDS],
    at: usize,
    numbers: Vec<f64>,
}

impl Stream {
    /// From the words of a state and the index of the last generated word.
    pub fn new(seed: [u64; WORDS], last: usize) -> Self {
        let first = last % WORDS;
        let drawn = Drawn { state: seed, at: first, numbers: Vec::new() };
        Stream { seed, first, drawn: Mutex::new(drawn) }
    }

    /// Number `k`, counted from 1, between 0 and 1; NaN if `k` is far beyond the numbers generated
    /// so far.
    pub fn number(&self, k: f64) -> f64 {
        let mut drawn = self.drawn.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let k = k.max(1.0) as usize;
        if k > drawn.numbers.len() + AHEAD {
            return f64::NAN;
        }
        while drawn.numbers.len() < k {
            drawn.draw();
        }
        drawn.numbers[k - 1]
    }
}

impl Drawn {
    fn draw(&mut self) {
        let old = self.state[self.at];
        self.at = (self.at + 1) % WORDS;
        let mut x = self.state[self.at];
        x ^= x << 31;
        x ^= (x >> 11) ^ old ^ (old >> 30);
        self.state[self.at] = x;
        let scrambled = x.wrapping_mul(1_181_783_497_276_652_981);
        self.numbers.push(scrambled as i64 as f64 / 2.0_f64.powi(64) + 0.5);
    }
}

impl Clone for Stream {
    fn clone(&self) -> Self {
        Stream::new(self.seed, self.first)
    }
}

impl External for Stream {
    fn signature(&self) -> Signature {
        Signature { name: "randomNumber", arity: 1, is_integer: false, is_differentiable: false }
    }

    fn eval(&self, args: &[f64]) -> f64 {
        self.number(args[0])
    }

    same_if_equal!();
}

impl PartialEq for Stream {
    fn eq(&self, other: &Self) -> bool {
        (self.seed, self.first) == (other.seed, other.first)
    }
}

impl Wire for Stream {
    fn write(&self, out: &mut Vec<u8>) {
        self.seed.write(out);
        self.first.write(out);
    }
    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(Stream::new(Wire::read(from)?, Wire::read(from)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first words of the published algorithm, from a state of small numbers.
    #[test]
    fn numbers_are_reproducible() {
        let seed: [u64; WORDS] = std::array::from_fn(|k| k as u64 + 1);
        let stream = Stream::new(seed, 0);
        let third = stream.number(3.0);
        let (old, mut x) = (1_u64, 2_u64);
        x ^= x << 31;
        x ^= x >> 11 ^ old ^ old >> 30;
        let word = x.wrapping_mul(1_181_783_497_276_652_981) as i64;
        assert_eq!(stream.number(1.0), word as f64 / 2.0_f64.powi(64) + 0.5);
        assert_eq!((stream.number(3.0), stream.clone().number(3.0)), (third, third));
        assert!(stream.number(1e9).is_nan());
    }
}
