//! The noise of a sensor, estimated from its signal.

/// Third differences, in which noise is amplified and a smooth signal vanishes.
pub fn third_differences(values: &[f64]) -> impl Iterator<Item = f64> {
    values.windows(4).map(|w| w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0])
}

/// Standard deviation of white noise from its third differences, whose variance is 20 times that of the
/// noise; from their median, which a few rapid changes of the signal do not affect.
pub fn estimate(differences: Vec<f64>) -> f64 {
    let mut sizes: Vec<f64> =
        differences.into_iter().map(f64::abs).filter(|d| d.is_finite()).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    sizes.sort_by(f64::total_cmp);
    /// Median of the absolute value of a standard normal variable.
    const QUARTILE: f64 = 0.674_489_750_196_081_7;
    sizes[sizes.len() / 2] / QUARTILE / 20.0f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform numbers from a linear congruential generator, twelve to a normal one.
    fn white(n: usize, sigma: f64) -> Vec<f64> {
        let mut state = 12345u64;
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..n).map(|_| sigma * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)).collect()
    }

    #[test]
    fn noise_is_separated_from_the_signal() {
        let noisy: Vec<f64> = white(4000, 0.02)
            .iter()
            .enumerate()
            .map(|(i, e)| (i as f64 * 1e-2).sin() + e)
            .collect();
        let sigma = estimate(third_differences(&noisy).collect());
        assert!((sigma / 0.02 - 1.0).abs() < 0.05, "{sigma}");
        assert_eq!(estimate(third_differences(&[1.0; 100]).collect()), 0.0);
    }
}
