//! Tests whether series of residuals are white noise: uncorrelated, with mean zero and one variance
//! everywhere.
//!
//! *In:* the residuals of one quantity in several runs; NaN where there is none. *Out:* for each test the
//! deviation from what noise would give, as the equivalent deviation of a standard normal variable, so that
//! tests of any number of degrees of freedom have the same threshold.
//! Autocorrelations: G. E. P. Box, D. A. Pierce, *Distribution of residual autocorrelations*, Journal of the
//! American Statistical Association 65, 1970. Runs: A. Wald, J. Wolfowitz, *On a test whether two samples are
//! from the same population*, Annals of Mathematical Statistics 11, 1940. Normal equivalent of chi-square:
//! E. B. Wilson, M. M. Hilferty, Proceedings of the National Academy of Sciences 17, 1931.

/// Numbers of lags of the autocorrelation tests: one test sees what lasts for a sample or two, another what
/// lasts for many.
const LAGS: [usize; 4] = [1, 3, 10, 30];
/// Numbers of equal parts of a run whose means and variances are compared.
const PARTS: [usize; 4] = [1, 4, 16, 64];
/// Widths of bins, in samples, whose means over all runs are compared.
const WIDTHS: [usize; 3] = [1, 8, 64];
/// Values of a part or bin from which its mean is taken.
const LEAST_MEAN: usize = 4;
/// Values of a part or bin from which its variance is taken: fewer have a variance that is far from normal.
const LEAST_VARIANCE: usize = 64;
/// Values from which anything is said.
const LEAST: usize = 30;

/// The residuals of one quantity.
#[derive(Clone, Debug)]
pub struct Residuals<'a> {
    /// Run by run, sample by sample.
    runs: Vec<&'a [f64]>,
    /// Mean square.
    square: f64,
    /// Variance of the squares.
    square_variance: f64,
    /// Number of values.
    count: usize,
}

impl<'a> Residuals<'a> {
    /// The residuals run by run; `None` if they are too few, or all zero.
    pub fn new(runs: Vec<&'a [f64]>) -> Option<Self> {
        let values = || runs.iter().flat_map(|r| r.iter()).filter(|x| x.is_finite());
        let count = values().count();
        let square = values().map(|x| x * x).sum::<f64>() / count.max(1) as f64;
        let fourth = values().map(|x| x.powi(4)).sum::<f64>() / count.max(1) as f64;
        let square_variance = fourth - square * square;
        let usable = count >= LEAST && square > 0.0 && square_variance > 0.0;
        usable.then_some(Residuals { runs, square, square_variance, count })
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Root of the mean square.
    pub fn root_mean_square(&self) -> f64 {
        self.square.sqrt()
    }

    /// Standard error of the root of the mean square, as a share of it.
    pub fn relative_error(&self) -> f64 {
        0.5 * (self.square_variance / self.count as f64).sqrt() / self.square
    }

    /// The largest deviation of all tests.
    pub fn structure(&self) -> f64 {
        let tests =
            [self.autocorrelation(), self.sign_changes(), self.parts(), self.aligned_bins()];
        tests.into_iter().fold(0.0, f64::max)
    }

    /// Sums of squared autocorrelations, for several numbers of lags.
    fn autocorrelation(&self) -> f64 {
        let (mut sum, mut lags, mut worst) = (0.0, 0usize, 0.0f64);
        for lag in 1..=LAGS[LAGS.len() - 1] {
            let (mut product, mut pairs) = (0.0, 0usize);
            for run in &self.runs {
                for (a, b) in run.iter().zip(run.iter().skip(lag)) {
                    if (a * b).is_finite() {
                        product += a * b;
                        pairs += 1;
                    }
                }
            }
            if pairs >= LEAST {
                let deviation = product / self.square;
                sum += deviation * deviation / pairs as f64;
                lags += 1;
            }
            if lags > 0 && LAGS.contains(&lag) {
                worst = worst.max(normal_equivalent(sum, lags));
            }
        }
        worst
    }

    /// The number of changes of sign between neighbours.
    fn sign_changes(&self) -> f64 {
        let (mut changes, mut pairs, mut positive) = (0usize, 0usize, 0usize);
        for run in &self.runs {
            let signs: Vec<bool> =
                run.iter().filter(|x| x.is_finite() && **x != 0.0).map(|x| *x > 0.0).collect();
            changes += signs.windows(2).filter(|w| w[0] != w[1]).count();
            pairs += signs.len().saturating_sub(1);
            positive += signs.iter().skip(1).filter(|s| **s).count();
        }
        let share = positive as f64 / pairs.max(1) as f64;
        let chance = 2.0 * share * (1.0 - share);
        let variance = pairs as f64 * chance * (1.0 - chance);
        if variance <= 0.0 {
            return 0.0;
        }
        (changes as f64 - pairs as f64 * chance).abs() / variance.sqrt()
    }

    /// Means and variances of equal parts of each run.
    fn parts(&self) -> f64 {
        let of_parts = |parts: usize| {
            let mut sums = BinSums::default();
            for run in &self.runs {
                for k in 0..parts {
                    let (from, to) = (k * run.len() / parts, (k + 1) * run.len() / parts);
                    sums.add(self, run[from..to].iter().copied());
                }
            }
            sums.deviation()
        };
        PARTS.into_iter().map(of_parts).fold(0.0, f64::max)
    }

    /// Means and variances at equal times since the start of each run, over all runs.
    fn aligned_bins(&self) -> f64 {
        let longest = self.runs.iter().map(|r| r.len()).max().unwrap_or(0);
        if self.runs.len() < 2 {
            return 0.0;
        }
        let of_width = |width: usize| {
            let mut sums = BinSums { least_mean: 2, ..BinSums::default() };
            for from in (0..longest).step_by(width) {
                let runs = self.runs.iter();
                let bin = runs.flat_map(|run| run.iter().skip(from).take(width).copied());
                sums.add(self, bin);
            }
            sums.deviation()
        };
        WIDTHS.into_iter().map(of_width).fold(0.0, f64::max)
    }

    /// The correlation with another quantity that is known at the same samples, run by run.
    pub fn correlation(&self, others: &[Vec<f64>]) -> f64 {
        let pairs = || {
            let both = self.runs.iter().zip(others);
            both.flat_map(|(run, other)| run.iter().zip(other))
                .filter(|(r, x)| r.is_finite() && x.is_finite())
        };
        let (count, sum) = pairs().fold((0usize, 0.0), |(n, sum), (_, x)| (n + 1, sum + x));
        let mean = sum / count.max(1) as f64;
        let (product, square) = pairs().fold((0.0, 0.0), |(product, square), (r, x)| {
            (product + r * (x - mean), square + (x - mean) * (x - mean))
        });
        // Rounding of a quantity that is constant.
        let varies = square > 1e-20 * count as f64 * mean * mean;
        if varies { product.abs() / (self.square * square).sqrt() } else { 0.0 }
    }
}

/// Deviations of the means and variances of bins.
struct BinSums {
    least_mean: usize,
    means: (f64, usize),
    /// The largest term of the sum of means.
    largest: f64,
    variances: (f64, usize),
}

impl Default for BinSums {
    fn default() -> Self {
        BinSums { least_mean: LEAST_MEAN, means: (0.0, 0), largest: 0.0, variances: (0.0, 0) }
    }
}

impl BinSums {
    fn add(&mut self, all: &Residuals<'_>, values: impl Iterator<Item = f64>) {
        let (mut n, mut sum, mut squares) = (0usize, 0.0, 0.0);
        for x in values.filter(|x| x.is_finite()) {
            (n, sum, squares) = (n + 1, sum + x, squares + x * x);
        }
        let size = n as f64;
        if n >= self.least_mean {
            let square = sum * sum / (size * all.square);
            self.largest = self.largest.max(square);
            self.means.0 += square;
            self.means.1 += 1;
        }
        if n >= LEAST_VARIANCE {
            let excess = squares - size * all.square;
            self.variances.0 += excess * excess / (size * all.square_variance);
            self.variances.1 += 1;
        }
    }

    fn deviation(&self) -> f64 {
        let one = |(sum, bins): (f64, usize)| {
            if bins == 0 { 0.0 } else { normal_equivalent(sum, bins) }
        };
        // The largest of many squares grows with the logarithm of their number.
        let chance = 2.0 * (self.means.1.max(1) as f64).ln();
        let single = (self.largest - chance).max(0.0).sqrt();
        one(self.means).max(one(self.variances)).max(single)
    }
}

/// The standard normal variable that exceeds its value with the same probability as chi-square with these
/// degrees of freedom exceeds `sum`.
pub fn normal_equivalent(sum: f64, freedom: usize) -> f64 {
    let spread = 2.0 / (9.0 * freedom as f64);
    ((sum / freedom as f64).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deviation that no series of pure noise here exceeds.
    const LIMIT: f64 = 4.5;

    struct Noise(u64);

    impl Noise {
        fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
        fn normal(&mut self) -> f64 {
            (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
        }
    }

    fn runs(
        count: usize,
        length: usize,
        mut value: impl FnMut(usize, usize) -> f64,
    ) -> Vec<Vec<f64>> {
        (0..count).map(|i| (0..length).map(|k| value(i, k)).collect()).collect()
    }

    fn structure(runs: &[Vec<f64>]) -> f64 {
        let runs = runs.iter().map(Vec::as_slice).collect();
        Residuals::new(runs).expect("enough values").structure()
    }

    /// Quantiles of chi-square: M. Abramowitz, I. A. Stegun, table 26.8.
    #[test]
    fn chi_square_has_the_published_quantiles() {
        // 0.001, beyond which a standard normal variable lies at 3.0902.
        for (freedom, quantile) in [(1, 10.828), (5, 20.515), (30, 59.703)] {
            let z = normal_equivalent(quantile, freedom);
            assert!((z - 3.0902).abs() < 0.05, "{freedom}: {z}");
        }
    }

    #[test]
    fn noise_of_any_size_is_white() {
        for seed in 0..60 {
            let mut noise = Noise(seed * 977 + 1);
            let (count, length) = [(1, 200), (3, 401), (8, 1500)][seed as usize % 3];
            let made = runs(count, length, |_, _| 2.0 * noise.normal());
            let z = structure(&made);
            assert!(z < LIMIT, "{seed}: {z}");
            let uniform = runs(count, length, |_, _| noise.uniform() - 0.5);
            assert!(structure(&uniform) < LIMIT, "{seed}");
        }
    }

    /// Of everything that a model may lack, a twentieth of the noise's power, or a pulse of a few samples.
    #[test]
    fn structure_is_seen_within_noise() {
        let seen = |name: &str, made: &dyn Fn(usize, usize) -> f64| {
            let mut noise = Noise(99);
            let z = structure(&runs(4, 1000, |i, k| made(i, k) + noise.normal()));
            assert!(z > LIMIT, "{name}: {z}");
        };
        let power = 0.05_f64.sqrt();
        seen("slow wave", &|_, k| power * 1.4 * (0.01 * k as f64).sin());
        seen("fast wave", &|_, k| power * 1.4 * (1.3 * k as f64).sin());
        seen("offset", &|_, _| power);
        seen("offsets of both signs", &|i, _| if i % 2 == 0 { power } else { -power });
        seen("a pulse at equal times", &|_, k| if k == 371 { 4.0 } else { 0.0 });
        seen("jumps of any sign", &|i, k| {
            if (300..312).contains(&(k + 7 * i)) { [4.0, -4.0][k % 2] } else { 0.0 }
        });
        seen("growing noise", &|i, k| {
            0.5 * (k as f64 / 1000.0) * Noise((1000 * i + k) as u64 * 7919 + 3).normal()
        });
        let mut noise = Noise(5);
        let mut last = 0.0;
        let red = runs(2, 1000, |_, _| {
            last = 0.2 * last + noise.normal();
            last
        });
        assert!(structure(&red) > LIMIT);
    }

    #[test]
    fn what_depends_on_another_quantity_is_seen() {
        let mut noise = Noise(3);
        let others = runs(3, 500, |_, _| noise.normal());
        let made: Vec<Vec<f64>> = others
            .iter()
            .map(|run| run.iter().map(|x| 0.3 * x + noise.normal()).collect())
            .collect();
        let of = |runs: &[Vec<f64>]| {
            Residuals::new(runs.iter().map(Vec::as_slice).collect())
                .expect("enough values")
                .correlation(&others)
        };
        assert!(structure(&made) < LIMIT && of(&made) > LIMIT);
        assert!(of(&runs(3, 500, |_, _| noise.normal())) < LIMIT);
    }
}
