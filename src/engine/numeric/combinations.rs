//! Enumerates the subsets of a set by increasing size.

/// Number of subsets after which the enumeration stops: all subsets of ten elements, and the small
/// ones of larger sets.
const MAX_SUBSETS: u32 = 2000;

/// Enumerates the subsets of `0..n` by increasing size, each as its ascending members, up to
/// `MAX_SUBSETS` of them.
pub struct Combinations {
    chosen: Vec<usize>,
    n: usize,
    remaining: u32,
    started: bool,
}

impl Combinations {
    /// Starts before the first subset, which is empty.
    pub fn new(n: usize) -> Self {
        Combinations { chosen: Vec::with_capacity(n), n, remaining: MAX_SUBSETS, started: false }
    }

    /// The next subset; `None` after the last.
    pub fn next_subset(&mut self) -> Option<&[usize]> {
        if self.remaining == 0 || self.started && !self.advance() {
            return None;
        }
        self.started = true;
        self.remaining -= 1;
        Some(&self.chosen)
    }

    /// False after the last.
    fn advance(&mut self) -> bool {
        let m = self.chosen.len();
        for i in (0..m).rev() {
            if self.chosen[i] + m - i < self.n {
                self.chosen[i] += 1;
                for j in i + 1..m {
                    self.chosen[j] = self.chosen[j - 1] + 1;
                }
                return true;
            }
        }
        self.chosen.clear();
        self.chosen.extend(0..=m);
        m < self.n
    }
}

#[cfg(test)]
mod tests {
    use super::Combinations;

    fn all(n: usize) -> Vec<Vec<usize>> {
        let mut combinations = Combinations::new(n);
        std::iter::from_fn(|| combinations.next_subset().map(<[usize]>::to_vec)).collect()
    }

    #[test]
    fn every_subset_comes_once_by_increasing_size() {
        let of_three = all(3);
        let expected: [&[usize]; 8] =
            [&[], &[0], &[1], &[2], &[0, 1], &[0, 2], &[1, 2], &[0, 1, 2]];
        assert_eq!(of_three, expected);
        assert_eq!(all(10).len(), 1024);
        assert_eq!(all(0), [Vec::<usize>::new()]);
        assert_eq!(all(100).len(), 2000);
    }
}
