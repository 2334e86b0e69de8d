//! Sums of squared residuals, by recording and signal.

/// Sums over the recordings of one kind.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    /// Sum of squared residuals, in units of the noise, by recording and signal.
    pub squares: Vec<Vec<f64>>,
    /// Number of residuals, by recording and signal.
    pub counts: Vec<Vec<usize>>,
}

impl Sums {
    /// Sum of all squares.
    pub fn total(&self) -> f64 {
        self.squares.iter().flatten().sum()
    }

    /// Number of all residuals.
    pub fn count(&self) -> usize {
        self.counts.iter().flatten().sum()
    }

    /// Reduced sum of squares of each recording.
    pub fn by_recording(&self) -> Vec<f64> {
        let mean = |(s, c): (&Vec<f64>, &Vec<usize>)| {
            s.iter().sum::<f64>() / c.iter().sum::<usize>().max(1) as f64
        };
        self.squares.iter().zip(&self.counts).map(mean).collect()
    }

    /// Root of the mean square of a signal, in units of the noise.
    pub fn of_signal(&self, k: usize) -> f64 {
        self.of_part(k, |_| true)
    }

    /// The same over the recordings that `belongs` selects by position.
    pub fn of_part(&self, k: usize, belongs: impl Fn(usize) -> bool) -> f64 {
        let picked = || (0..self.squares.len()).filter(|i| belongs(*i));
        let sum: f64 = picked().map(|i| self.squares[i][k]).sum();
        let count: usize = picked().map(|i| self.counts[i][k]).sum();
        (sum / count.max(1) as f64).sqrt()
    }
}
