//! All choices of some of a number of things, the smallest first.

/// Choices after which a search is given up: all of ten, and more of which few are chosen.
const MOST: u32 = 2000;

/// Goes through the subsets of `0..n` by their size, each as its ascending members, and gives up after
/// many.
pub struct Choices {
    chosen: Vec<usize>,
    n: usize,
    left: u32,
    begun: bool,
}

impl Choices {
    /// Before the first, which is the empty one.
    pub fn new(n: usize) -> Self {
        Choices { chosen: Vec::with_capacity(n), n, left: MOST, begun: false }
    }

    /// The next choice.
    pub fn another(&mut self) -> Option<&[usize]> {
        if self.left == 0 || self.begun && !self.advance() {
            return None;
        }
        self.begun = true;
        self.left -= 1;
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
    use super::Choices;

    fn all(n: usize) -> Vec<Vec<usize>> {
        let mut choices = Choices::new(n);
        std::iter::from_fn(|| choices.another().map(<[usize]>::to_vec)).collect()
    }

    #[test]
    fn every_subset_comes_once_the_smallest_first() {
        let of_three = all(3);
        let expected: [&[usize]; 8] =
            [&[], &[0], &[1], &[2], &[0, 1], &[0, 2], &[1, 2], &[0, 1, 2]];
        assert_eq!(of_three, expected);
        assert_eq!(all(10).len(), 1024);
        assert_eq!(all(0), [Vec::<usize>::new()]);
        assert_eq!(all(100).len(), 2000);
    }
}
