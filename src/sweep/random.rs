//! Random numbers that are the same everywhere: xoshiro256**.
//!
//! D. Blackman, S. Vigna: *Scrambled linear pseudorandom number generators*, ACM Trans. Math. Software 47
//! (2021), art. 36. Its state is filled by SplitMix64 (Steele, Lea, Flood 2014), as the authors advise.

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random([u64; 4]);

impl Random {
    /// The stream of this number under this seed. Streams have nothing to do with each other.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut x = seed ^ mixed(stream.wrapping_add(1));
        let mut next = || {
            x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
            mixed(x)
        };
        Random([next(), next(), next(), next()])
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        let s = &mut self.0;
        let result = s[1].wrapping_mul(5).rotate_left(7).wrapping_mul(9);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        result
    }

    /// Evenly distributed over `[0, 1)`, a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (0.5_f64).powi(53)
    }

    /// Evenly distributed over `0..n`; 0 if there is nothing else.
    pub fn below(&mut self, n: u64) -> u64 {
        if n < 2 {
            return 0;
        }
        // The last, incomplete part of the range would favour small numbers.
        let fair = u64::MAX - u64::MAX % n;
        loop {
            let bits = self.bits();
            if bits < fair {
                return bits % n;
            }
        }
    }

    /// `0..n` in random order (Fisher and Yates 1938, Durstenfeld 1964).
    pub fn permutation(&mut self, n: usize) -> Vec<usize> {
        let mut all: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            all.swap(i, self.below(i as u64 + 1) as usize);
        }
        all
    }
}

/// The output function of SplitMix64.
fn mixed(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the authors' C code, with the state 1, 2, 3, 4.
    #[test]
    fn the_first_numbers_are_those_of_the_authors() {
        let mut random = Random([1, 2, 3, 4]);
        let first: Vec<u64> = (0..5).map(|_| random.bits()).collect();
        let published =
            [11520, 0, 1_509_978_240, 1_215_971_899_390_074_240, 1_216_172_134_540_287_360];
        assert_eq!(first, published);
    }

    #[test]
    fn permutations_hold_everything_once() {
        let mut permuted = Random::new(1, 0).permutation(1000);
        assert_ne!(permuted, (0..1000).collect::<Vec<_>>());
        permuted.sort_unstable();
        assert_eq!(permuted, (0..1000).collect::<Vec<_>>());
    }

    #[test]
    fn numbers_are_spread_evenly() {
        let mut random = Random::new(7, 3);
        let n = 100_000;
        let mean = (0..n).map(|_| random.unit()).sum::<f64>() / f64::from(n);
        // Standard deviation 1/sqrt(12 n) = 0.0009.
        assert!((mean - 0.5).abs() < 0.004, "{mean}");
        assert!((0..1000).all(|_| random.below(7) < 7));
    }
}
