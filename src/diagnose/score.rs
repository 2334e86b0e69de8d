//! The score test: how much effects could explain, before any is fitted.
//!
//! The derivative of the residuals by an amplitude at zero, projected off what the free parameters could
//! absorb, against the residuals (C. R. Rao 1948; the Lagrange multiplier test of S. D. Silvey, *The
//! Lagrangian multiplier test*, Annals of Mathematical Statistics 30, 1959).

use crate::numeric::least_squares::NormalEquations;
use crate::numeric::linear::DenseLu;

/// The score of a group of amplitudes.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Decrease of the sum of squares that the linearised residuals promise.
    pub gain: f64,
    /// The amplitudes that give it.
    pub amplitudes: Vec<f64>,
}

/// Share of its own sum of squares that a direction must retain after projection off the parameters.
const INDEPENDENT: f64 = 1e-7;

/// The score of the amplitudes `group` beside the parameters `0..free` of the normal equations; those of
/// `positive` cannot be negative.
pub fn score(
    normal: &NormalEquations,
    free: usize,
    group: &[usize],
    positive: &[bool],
) -> Option<Score> {
    let n = normal.n;
    let entry = |i: usize, j: usize| normal.gram[i + n * j];
    let size = |i: usize| entry(i, i).sqrt();
    let known: Vec<usize> = (0..free).filter(|i| size(*i) > 0.0).collect();
    let mut kept: Vec<usize> = (0..group.len()).filter(|k| size(group[*k]) > 0.0).collect();
    while !kept.is_empty() {
        // All directions at unit length.
        let all: Vec<usize> = known.iter().copied().chain(kept.iter().map(|k| group[*k])).collect();
        let (p, m) = (known.len(), all.len());
        let scaled = |a: usize, b: usize| entry(all[a], all[b]) / (size(all[a]) * size(all[b]));
        let mut lu = DenseLu::new(p);
        let ridge = |a: usize, b: usize| if a == b { 1e-12 } else { 0.0 };
        lu.factor_with(|matrix| {
            for b in 0..p {
                for a in 0..p {
                    matrix[a + p * b] = scaled(a, b) + ridge(a, b);
                }
            }
        })
        .ok()?;
        let g = m - p;
        let (mut matrix, mut right) = (vec![0.0; g * g], vec![0.0; g]);
        let mut absorbed: Vec<f64> =
            (0..p).map(|a| normal.gradient[all[a]] / size(all[a])).collect();
        lu.solve_in_place(&mut absorbed);
        let mut dependent = None;
        for b in 0..g {
            let mut column: Vec<f64> = (0..p).map(|a| scaled(a, p + b)).collect();
            lu.solve_in_place(&mut column);
            for a in 0..g {
                let off: f64 = (0..p).map(|k| scaled(k, p + a) * column[k]).sum();
                matrix[a + g * b] = scaled(p + a, p + b) - off;
            }
            if matrix[b + g * b] < INDEPENDENT {
                dependent = Some(b);
            }
            let off: f64 = (0..p).map(|k| scaled(k, p + b) * absorbed[k]).sum();
            right[b] = -(normal.gradient[all[p + b]] / size(all[p + b]) - off);
        }
        if let Some(b) = dependent {
            kept.remove(b);
            continue;
        }
        let forces = right.clone();
        let mut lu = DenseLu::new(g);
        for k in 0..g {
            matrix[k + g * k] += 1e-10;
        }
        lu.factor(&matrix).ok()?;
        lu.solve_in_place(&mut right);
        let amplitudes: Vec<f64> = (0..g).map(|k| right[k] / size(all[p + k])).collect();
        let worst = (0..g).filter(|k| positive[kept[*k]] && amplitudes[*k] <= 0.0);
        if let Some(k) = worst.min_by(|a, b| right[*a].total_cmp(&right[*b])) {
            kept.remove(k);
            continue;
        }
        let gain = forces.iter().zip(&right).map(|(f, r)| f * r).sum();
        let mut out = vec![0.0; group.len()];
        for (k, a) in kept.iter().zip(&amplitudes) {
            out[*k] = *a;
        }
        return Some(Score { gain, amplitudes: out });
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y = 2 + 3 t` with a free constant: the slope explains the rest, and another constant direction
    /// explains nothing.
    #[test]
    fn only_what_is_not_absorbed_counts() {
        let mut normal = NormalEquations::new(3);
        let mean = 3.0 * 0.5;
        for i in 0..11 {
            let t = 0.1 * i as f64;
            // At the best constant; the residual is model minus data.
            normal.add(2.0 + mean - (2.0 + 3.0 * t), &[1.0, t, 5.0]);
        }
        let slope = score(&normal, 1, &[1], &[false]).unwrap();
        assert!((slope.amplitudes[0] - 3.0).abs() < 1e-8);
        assert!((slope.gain - normal.cost).abs() < 1e-8);
        assert_eq!(score(&normal, 1, &[2], &[false]), None);
    }

    #[test]
    fn a_positive_amplitude_can_not_explain_a_negative_one() {
        let mut normal = NormalEquations::new(1);
        normal.add(1.0, &[1.0]);
        assert_eq!(score(&normal, 0, &[0], &[true]), None);
        let amplitude = score(&normal, 0, &[0], &[false]).unwrap().amplitudes[0];
        assert!((amplitude + 1.0).abs() < 1e-8);
    }
}
