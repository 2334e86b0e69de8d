//! Tests whether series of residuals are white noise: uncorrelated, with mean zero and one variance
//! everywhere.
//!
//! *In:* the residuals of one quantity in several runs; NaN where there is none. *Out:* the share of their power
//! that has structure. A test counts if its deviation from what noise would give exceeds a limit; deviations are
//! those of a standard normal variable of equal probability, so that tests of any number of degrees of freedom
//! have the same limit. Long recordings reveal structure of any size, so its share is what matters then.
//! Autocorrelations: G. E. P. Box, D. A. Pierce, *Distribution of residual autocorrelations*, Journal of the
//! American Statistical Association 65, 1970. Runs: A. Wald, J. Wolfowitz, *On a test whether two samples are
//! from the same population*, Annals of Mathematical Statistics 11, 1940. Normal equivalent of chi-square:
//! E. B. Wilson, M. M. Hilferty, Proceedings of the National Academy of Sciences 17, 1931.

use std::f64::consts::FRAC_PI_2;

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
/// Standard deviations by which the power of a bin may exceed the mean.
const USUAL: f64 = 3.0;
/// Longest lag of the correlation time.
const LONGEST_LAG: usize = 2000;
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

    /// The integrated correlation time, in samples: a mean over `n` residuals is as exact as one over `n` divided by it of
    /// independent ones; 1 for white noise. The sum of the autocorrelations ends with the first pair of neighbours whose
    /// sum is not positive (C. J. Geyer, *Practical Markov chain Monte Carlo*, Statistical Science 7, 1992, section 3.3).
    pub fn correlation_time(&self) -> f64 {
        let longest = self.runs.iter().map(|r| r.len()).max().unwrap_or(0);
        let mut time = 1.0;
        for pair in 0..longest.min(LONGEST_LAG) / 2 {
            let both =
                self.autocorrelation_at(2 * pair + 1) + self.autocorrelation_at(2 * pair + 2);
            if both <= 0.0 {
                break;
            }
            time += 2.0 * both;
        }
        time
    }

    /// The autocorrelation at a lag, over all runs.
    fn autocorrelation_at(&self, lag: usize) -> f64 {
        let products = self.runs.iter().flat_map(|run| run.iter().zip(run.iter().skip(lag)));
        let sum: f64 = products.map(|(a, b)| a * b).filter(|p| p.is_finite()).sum();
        sum / (self.square * self.count as f64)
    }

    /// The largest share of the power that a test finds to have structure, with a deviation above `limit`;
    /// zero for white noise.
    pub fn structure(&self, limit: f64) -> f64 {
        let tests = [
            self.autocorrelation(limit),
            self.sign_changes(limit),
            self.parts(limit),
            self.aligned_bins(limit),
        ];
        tests.into_iter().fold(0.0, f64::max)
    }

    /// Sums of squared autocorrelations, for several numbers of lags; the share is their root mean square.
    fn autocorrelation(&self, limit: f64) -> f64 {
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
            if lags > 0 && LAGS.contains(&lag) && normal_equivalent(sum, lags) > limit {
                let excess = sum - lags as f64;
                worst = worst.max((excess / (lags * self.count) as f64).sqrt());
            }
        }
        worst
    }

    /// The number of changes of sign between neighbours; the share is the correlation of normal neighbours that
    /// gives as many.
    fn sign_changes(&self, limit: f64) -> f64 {
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
        let excess = (changes as f64 - pairs as f64 * chance).abs();
        let is_structure = excess / variance.sqrt() > limit;
        if is_structure { FRAC_PI_2 * excess / pairs as f64 } else { 0.0 }
    }

    /// Means and variances of equal parts of each run.
    fn parts(&self, limit: f64) -> f64 {
        let of_parts = |parts: usize| {
            let mut sums = BinSums::default();
            for run in &self.runs {
                for k in 0..parts {
                    let (from, to) = (k * run.len() / parts, (k + 1) * run.len() / parts);
                    sums.add(self, run[from..to].iter().copied());
                }
            }
            sums.structure(self, limit)
        };
        PARTS.into_iter().map(of_parts).fold(0.0, f64::max)
    }

    /// Means and variances at equal times since the start of each run, over all runs.
    fn aligned_bins(&self, limit: f64) -> f64 {
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
            sums.structure(self, limit)
        };
        WIDTHS.into_iter().map(of_width).fold(0.0, f64::max)
    }

    /// The share of the power that is proportional to another quantity, known at the same samples run by run;
    /// zero if the deviation does not exceed `limit`.
    pub fn correlation(&self, others: &[Vec<f64>], limit: f64) -> f64 {
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
        let deviation = if varies { product.abs() / (self.square * square).sqrt() } else { 0.0 };
        if deviation > limit { deviation * deviation / self.count as f64 } else { 0.0 }
    }
}

/// Deviations of the means and variances of bins.
struct BinSums {
    least_mean: usize,
    means: (f64, usize),
    /// The largest term of the sum of means.
    largest: f64,
    variances: (f64, usize),
    /// Power in bins with much more than others.
    surplus: f64,
}

impl Default for BinSums {
    fn default() -> Self {
        BinSums {
            least_mean: LEAST_MEAN,
            means: (0.0, 0),
            largest: 0.0,
            variances: (0.0, 0),
            surplus: 0.0,
        }
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
            let chance = USUAL * (size * all.square_variance).sqrt();
            self.surplus += (excess - chance).max(0.0) / all.square;
        }
    }

    fn structure(&self, all: &Residuals<'_>, limit: f64) -> f64 {
        let exceeds = |(sum, bins): (f64, usize)| bins > 0 && normal_equivalent(sum, bins) > limit;
        // The largest of many squares grows with the logarithm of their number.
        let chance = 2.0 * (self.means.1.max(1) as f64).ln();
        let is_single = (self.largest - chance).max(0.0).sqrt() > limit;
        let powers = [
            if exceeds(self.means) { self.means.0 - self.means.1 as f64 } else { 0.0 },
            if is_single { self.largest } else { 0.0 },
            if exceeds(self.variances) { self.surplus } else { 0.0 },
        ];
        powers.into_iter().fold(0.0, f64::max) / all.count as f64
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

    /// `x_k = a x_(k-1) + e` has the autocorrelations a^k, and (1 + a)/(1 - a) as their sum over all lags.
    #[test]
    fn correlation_time_of_an_autoregression() {
        let mut state = 7u64;
        let mut noise = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        for (a, expected) in [(0.0, 1.0), (0.8, 9.0)] {
            let mut x = 0.0;
            let all: Vec<f64> = (0..200_000)
                .map(|_| {
                    x = a * x + noise();
                    x
                })
                .collect();
            let time = Residuals::new(vec![&all]).unwrap().correlation_time();
            assert!((time - expected).abs() < 0.05 * expected, "{time} instead of {expected}");
        }
    }

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
        Residuals::new(runs).expect("enough values").structure(LIMIT)
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
            assert_eq!(z, 0.0, "{seed}");
            let uniform = runs(count, length, |_, _| noise.uniform() - 0.5);
            assert_eq!(structure(&uniform), 0.0, "{seed}");
        }
    }

    /// Of everything that a model may lack, a twentieth of the noise's power, or a pulse of a few samples.
    #[test]
    fn structure_is_seen_within_noise() {
        let seen = |name: &str, made: &dyn Fn(usize, usize) -> f64| {
            let mut noise = Noise(99);
            let z = structure(&runs(4, 1000, |i, k| made(i, k) + noise.normal()));
            assert!(z > 0.0, "{name}");
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
        let mut noise = Noise(5);
        let mut last = 0.0;
        let red = runs(2, 1000, |_, _| {
            last = 0.2 * last + noise.normal();
            last
        });
        assert!((structure(&red) - 0.2).abs() < 0.1, "the correlation of neighbours");
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
                .correlation(&others, LIMIT)
        };
        assert_eq!(structure(&made), 0.0);
        assert!((of(&made) - 0.09 / 1.09).abs() < 0.05, "{}", of(&made));
        assert_eq!(of(&runs(3, 500, |_, _| noise.normal())), 0.0);
    }
}
