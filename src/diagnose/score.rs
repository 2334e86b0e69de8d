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
    /// Their columns in the normal equations.
    pub columns: Vec<usize>,
}

/// Share of its own sum of squares that a direction must retain after projection off the parameters.
const INDEPENDENT: f64 = 1e-7;

/// Added to the diagonal of columns of unit length, so that dependent parameters do no harm.
const RIDGE: f64 = 1e-12;

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
        let ridge = |a: usize, b: usize| if a == b { RIDGE } else { 0.0 };
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
        return Some(Score { gain, amplitudes: out, columns: group.to_vec() });
    }
    None
}

/// The parameters of normal equations that may absorb other directions.
struct Parameters<'a> {
    normal: &'a NormalEquations,
    /// Those with an influence.
    columns: Vec<usize>,
    /// Their lengths.
    sizes: Vec<f64>,
    lu: DenseLu,
}

impl<'a> Parameters<'a> {
    /// The columns `0..free`; `None` if they are too dependent.
    fn new(normal: &'a NormalEquations, free: usize) -> Option<Self> {
        let entry = |i: usize, j: usize| normal.gram[i + normal.n * j];
        let columns: Vec<usize> = (0..free).filter(|i| entry(*i, *i) > 0.0).collect();
        let sizes: Vec<f64> = columns.iter().map(|i| entry(*i, *i).sqrt()).collect();
        let p = columns.len();
        let mut lu = DenseLu::new(p);
        lu.factor_with(|matrix| {
            for b in 0..p {
                for a in 0..p {
                    let ridge = if a == b { RIDGE } else { 0.0 };
                    let product = entry(columns[a], columns[b]) / (sizes[a] * sizes[b]);
                    matrix[a + p * b] = product + ridge;
                }
            }
        })
        .ok()?;
        Some(Parameters { normal, columns, sizes, lu })
    }

    /// The combination of the parameters whose products with them are `right`, by column.
    fn absorbing(&mut self, right: impl Fn(usize) -> f64) -> Vec<f64> {
        let scaled = self.columns.iter().zip(&self.sizes).map(|(k, size)| right(*k) / size);
        let mut solution: Vec<f64> = scaled.collect();
        self.lu.solve_in_place(&mut solution);
        solution.iter_mut().zip(&self.sizes).for_each(|(x, size)| *x /= size);
        solution
    }

    /// The product of a column with a combination of the parameters.
    fn product(&self, column: usize, combination: &[f64]) -> f64 {
        let entry = |k: &usize| self.normal.gram[column + self.normal.n * k];
        self.columns.iter().zip(combination).map(|(k, c)| entry(k) * c).sum()
    }
}

/// Normal equations of the columns from `free` on, projected off the parameters `0..free`: a score beside these
/// parameters is one beside none here. Columns that the parameters absorb vanish.
pub fn projected(normal: &NormalEquations, free: usize) -> NormalEquations {
    let (n, m) = (normal.n, normal.n - free);
    let entry = |i: usize, j: usize| normal.gram[i + n * j];
    let mut out = NormalEquations::new(m);
    out.cost = normal.cost;
    let Some(mut parameters) = Parameters::new(normal, free) else { return out };
    let of_gradient = parameters.absorbing(|k| normal.gradient[k]);
    for j in free..n {
        let absorbing = parameters.absorbing(|k| entry(k, j));
        let left = |i: usize| entry(i, j) - parameters.product(i, &absorbing);
        if left(j) < INDEPENDENT * entry(j, j) {
            continue;
        }
        for i in free..n {
            out.gram[i - free + m * (j - free)] = left(i);
        }
        out.gradient[j - free] = normal.gradient[j] - parameters.product(j, &of_gradient);
    }
    out
}

/// The step of all columns that a score proposes: its amplitudes, and the parameters that follow them.
pub fn full_step(normal: &NormalEquations, free: usize, score: &Score) -> Option<Vec<f64>> {
    let mut step = vec![0.0; normal.n];
    score.columns.iter().zip(&score.amplitudes).for_each(|(k, a)| step[*k] = *a);
    let mut parameters = Parameters::new(normal, free)?;
    let driven = |i: usize| -> f64 {
        score.columns.iter().map(|k| normal.gram[i + normal.n * k] * step[*k]).sum()
    };
    let following = parameters.absorbing(|k| -normal.gradient[k] - driven(k));
    for (k, x) in parameters.columns.iter().zip(following) {
        step[*k] = x;
    }
    Some(step)
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

    /// Two directions beside a constant: the projected equations give the score of each, and the whole step leaves
    /// what the score says.
    #[test]
    fn projected_equations_have_the_same_scores() {
        let mut normal = NormalEquations::new(4);
        for i in 0..11 {
            let t = 0.1 * i as f64;
            normal.add(1.0 - 3.0 * t + t.sin(), &[1.0, t, t * t, 5.0]);
        }
        let small = projected(&normal, 1);
        for group in [&[1][..], &[2], &[1, 2]] {
            let signs = vec![false; group.len()];
            let whole = score(&normal, 1, group, &signs).unwrap();
            let shifted: Vec<usize> = group.iter().map(|k| k - 1).collect();
            let own = score(&small, 0, &shifted, &signs).unwrap();
            assert!((whole.gain - own.gain).abs() < 1e-7 * whole.gain, "{whole:?} {own:?}");
            let calibrated = score(&normal, 0, &[0], &[false]).unwrap().gain;
            let left = normal.after(&full_step(&normal, 1, &whole).unwrap());
            assert!((normal.cost - left - calibrated - whole.gain).abs() < 1e-7, "{left}");
        }
        assert_eq!(score(&small, 0, &[2], &[false]), None);
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
