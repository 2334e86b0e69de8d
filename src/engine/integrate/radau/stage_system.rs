//! The stage equations of a linear system `M s' = J(t) s + b(t)`, solved directly.
//!
//! The three stages of a component form blocks of order 3: the diagonal ones hold `M A^-1 / h`, and every block the
//! entries of the Jacobians at the three stages on its diagonal. Blocks are eliminated in the order of a
//! [`SymbolicLu`]. A pivot that is left by cancellation is an error, and the caller has another method.

use crate::numeric::panel::LANES;
use crate::numeric::pattern::Pattern;
use crate::numeric::symbolic_lu::{SymbolicLu, WEAKEST, Weak};

/// Number of stages.
const STAGES: usize = 3;
/// Largest number of components: the order is found by an algorithm whose time grows with their square.
const LARGEST: usize = 400;

/// A block, row by row.
type Block = [f64; STAGES * STAGES];

/// The equations, and their decomposition.
pub struct StageSystem {
    plan: SymbolicLu,
    blocks: Vec<Block>,
    /// Largest terms of the pivots.
    sizes: Vec<f64>,
    /// Right-hand sides, then solutions: a row for each position and stage.
    panel: Vec<f64>,
    width: usize,
}

impl StageSystem {
    /// For Jacobians of this pattern and `width` directions; `None` if the elimination would take longer than the
    /// iteration that it replaces.
    pub fn new(pattern: &Pattern, width: usize) -> Option<Self> {
        let n = pattern.columns();
        if n > LARGEST {
            return None;
        }
        let plan = SymbolicLu::new(pattern);
        let (blocks, panel) = (vec![[0.0; 9]; plan.entries], vec![0.0; STAGES * n * width]);
        let system = StageSystem { plan, blocks, sizes: vec![0.0; n], panel, width };
        system.pays(pattern).then_some(system)
    }

    /// True if this takes fewer operations than four rounds of the iteration.
    fn pays(&self, pattern: &Pattern) -> bool {
        let (n, entries) = (pattern.columns(), pattern.entries());
        let own = 54 * self.plan.updates() + 18 * self.width * self.blocks.len();
        let factors = (n * n).min(4 * (entries + n));
        own <= 4 * self.width * (30 * n + 6 * entries + 10 * factors)
    }

    /// Decomposes the equations of a step `h`, for the entries of the Jacobians at its stages in the order of the
    /// pattern, the diagonal of `M`, and `A^-1`.
    pub fn factor(
        &mut self,
        jacobians: [&[f64]; STAGES],
        mass: &[f64],
        inverse: &[[f64; STAGES]; STAGES],
        h: f64,
    ) -> Result<(), Weak> {
        let n = self.sizes.len();
        self.blocks[n..].fill([0.0; 9]);
        for (k, i) in self.plan.order.iter().enumerate() {
            self.blocks[k] =
                std::array::from_fn(|e| mass[*i] / h * inverse[e / STAGES][e % STAGES]);
        }
        for (stage, entries) in jacobians.into_iter().enumerate() {
            for (entry, block) in entries.iter().zip(&self.plan.places) {
                self.blocks[*block][stage * STAGES + stage] -= entry;
            }
        }
        for k in 0..n {
            self.sizes[k] = largest(&self.blocks[k]);
        }
        (0..n).try_for_each(|k| self.eliminate(k))
    }

    /// Replaces a diagonal block by its inverse and those below it by multipliers, and updates the others.
    fn eliminate(&mut self, k: usize) -> Result<(), Weak> {
        let StageSystem { plan, blocks, sizes, .. } = self;
        let pivot = inverse(&blocks[k]).ok_or(Weak)?;
        if !(largest(&pivot) * sizes[k] <= WEAKEST) {
            return Err(Weak);
        }
        blocks[k] = pivot;
        let mut changed = plan.changed[k].iter();
        for row in &plan.lower[k] {
            let multiplier = product(&blocks[row.entry], &pivot);
            blocks[row.entry] = multiplier;
            for (column, target) in plan.upper[k].iter().zip(&mut changed) {
                let term = product(&multiplier, &blocks[column.entry]);
                if row.other == column.other {
                    sizes[row.other] = sizes[row.other].max(largest(&term));
                }
                blocks[*target].iter_mut().zip(&term).for_each(|(b, t)| *b -= t);
            }
        }
        Ok(())
    }

    /// Replaces the right-hand sides at the three stages by the increments that solve the equations. They are panels
    /// with a row for each component.
    pub fn solve(&mut self, r: &[Vec<f64>; STAGES], z: &mut [Vec<f64>; STAGES]) {
        let StageSystem { plan, blocks, panel, width, .. } = self;
        let SymbolicLu { order, lower, upper, .. } = plan;
        let width = *width;
        for (rows, i) in panel.chunks_exact_mut(STAGES * width).zip(order.iter()) {
            for (row, r) in rows.chunks_exact_mut(width).zip(r) {
                row.copy_from_slice(&r[i * width..(i + 1) * width]);
            }
        }
        for (k, places) in lower.iter().enumerate() {
            for place in places {
                let (head, tail) = panel.split_at_mut(place.other * STAGES * width);
                subtract(tail, &blocks[place.entry], &head[k * STAGES * width..], width);
            }
        }
        for (k, places) in upper.iter().enumerate().rev() {
            let (head, tail) = panel.split_at_mut((k + 1) * STAGES * width);
            let rows = &mut head[k * STAGES * width..];
            for place in places {
                let from = (place.other - k - 1) * STAGES * width;
                subtract(rows, &blocks[place.entry], &tail[from..], width);
            }
            multiply(rows, &blocks[k], width);
        }
        for (rows, i) in panel.chunks_exact(STAGES * width).zip(order.iter()) {
            for (row, z) in rows.chunks_exact(width).zip(z.iter_mut()) {
                z[i * width..(i + 1) * width].copy_from_slice(row);
            }
        }
    }
}

/// The largest entry.
fn largest(a: &Block) -> f64 {
    a.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

fn product(a: &Block, b: &Block) -> Block {
    let entry = |e: usize| {
        let (i, j) = (e / STAGES * STAGES, e % STAGES);
        a[i] * b[j] + a[i + 1] * b[j + 3] + a[i + 2] * b[j + 6]
    };
    std::array::from_fn(entry)
}

/// The inverse, by cofactors; `None` if the determinant is zero or not finite.
fn inverse(a: &Block) -> Option<Block> {
    let minor = |p: usize, q: usize, r: usize, s: usize| a[p] * a[s] - a[q] * a[r];
    let cofactors = [
        minor(4, 5, 7, 8),
        minor(2, 1, 8, 7),
        minor(1, 2, 4, 5),
        minor(5, 3, 8, 6),
        minor(0, 2, 6, 8),
        minor(2, 0, 5, 3),
        minor(3, 4, 6, 7),
        minor(1, 0, 7, 6),
        minor(0, 1, 3, 4),
    ];
    let determinant = a[0] * cofactors[0] + a[1] * cofactors[3] + a[2] * cofactors[6];
    let reciprocal = 1.0 / determinant;
    (determinant != 0.0 && reciprocal.is_finite()).then(|| cofactors.map(|c| c * reciprocal))
}

#[inline]
fn lanes(panel: &[f64], at: usize) -> [f64; LANES] {
    std::array::from_fn(|l| panel[at + l])
}

/// `a x` for the rows of `x` at a lane, row by row.
#[inline]
fn applied(a: &Block, x: &[f64], width: usize, lane: usize) -> [[f64; LANES]; STAGES] {
    let [p, q, r] = [lanes(x, lane), lanes(x, width + lane), lanes(x, 2 * width + lane)];
    std::array::from_fn(|row| {
        let [f, g, h] = [a[row * STAGES], a[row * STAGES + 1], a[row * STAGES + 2]];
        std::array::from_fn(|l| f * p[l] + g * q[l] + h * r[l])
    })
}

/// `target -= a x` for the first rows of two panels.
fn subtract(target: &mut [f64], a: &Block, x: &[f64], width: usize) {
    for lane in (0..width).step_by(LANES) {
        for (row, term) in applied(a, x, width, lane).iter().enumerate() {
            let at = row * width + lane;
            target[at..at + LANES].iter_mut().zip(term).for_each(|(t, x)| *t -= x);
        }
    }
}

/// `x = a x`
fn multiply(x: &mut [f64], a: &Block, width: usize) {
    for lane in (0..width).step_by(LANES) {
        for (row, value) in applied(a, x, width, lane).iter().enumerate() {
            x[row * width + lane..][..LANES].copy_from_slice(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::radau::variation::inverse_of_a;

    /// An arrow-shaped matrix with some further entries, as column, row, and value at the three stages.
    fn entries(n: usize) -> Vec<(usize, usize, [f64; 3])> {
        let mut all = Vec::new();
        for j in 0..n {
            for i in 0..n {
                let x = ((7 * i + 3 * j) % 11) as f64 - 5.0;
                if i == j || i == 0 || j == 0 || (i + 2 * j) % 7 == 1 {
                    all.push((j, i, [x, x + 0.5, 1.5 * x]));
                }
            }
        }
        all
    }

    /// The increments solve `M A^-1 / h Z - J Z = r`, computed entry by entry.
    #[test]
    fn increments_solve_the_stage_equations() {
        let (n, width, h) = (9, 2 * LANES, 0.02);
        let entries = entries(n);
        let places: Vec<_> = entries.iter().map(|(j, i, _)| (*i, *j)).collect();
        let pattern = Pattern::from_entries(n, n, &places);
        let mut system = StageSystem::new(&pattern, width).unwrap();
        let values: [Vec<f64>; 3] =
            std::array::from_fn(|k| entries.iter().map(|(_, _, v)| v[k]).collect());
        let mut mass = vec![1.0; n];
        mass[4] = 0.0;
        let a = inverse_of_a();
        let jacobians = [&values[0][..], &values[1], &values[2]];
        system.factor(jacobians, &mass, &a, h).unwrap();
        let r: [Vec<f64>; 3] = std::array::from_fn(|k| {
            (0..n * width).map(|e| ((e * 13 + k * 5) % 17) as f64 - 8.0).collect()
        });
        let mut z = std::array::from_fn(|_| vec![0.0; n * width]);
        system.solve(&r, &mut z);
        for k in 0..3 {
            for d in 0..width {
                let mut left: Vec<f64> = (0..n)
                    .map(|i| {
                        let sum: f64 = (0..3).map(|l| a[k][l] * z[l][i * width + d]).sum();
                        mass[i] / h * sum
                    })
                    .collect();
                for (j, i, v) in &entries {
                    left[*i] -= v[k] * z[k][j * width + d];
                }
                for (i, left) in left.iter().enumerate() {
                    let error = left - r[k][i * width + d];
                    assert!(error.abs() < 1e-9, "stage {k}, component {i}: {error}");
                }
            }
        }
    }

    /// An algebraic component without an entry of its own has no pivot in its block.
    #[test]
    fn a_pivot_of_zero_is_an_error() {
        let pattern = Pattern::from_entries(2, 2, &[(0, 1), (1, 0)]);
        let mut system = StageSystem::new(&pattern, LANES).unwrap();
        let ones = [1.0, 1.0];
        let jacobians = [&ones[..], &ones, &ones];
        let outcome = system.factor(jacobians, &[0.0, 0.0], &inverse_of_a(), 0.1);
        assert_eq!(outcome, Err(Weak));
    }

    #[test]
    fn blocks_are_inverted() {
        let a = [2.0, -1.0, 0.5, 3.0, 4.0, -2.0, 1.0, 0.0, 5.0];
        let identity = product(&a, &inverse(&a).unwrap());
        for (e, x) in identity.iter().enumerate() {
            let expected = if e % 4 == 0 { 1.0 } else { 0.0 };
            assert!((x - expected).abs() < 1e-14);
        }
        assert_eq!(inverse(&[1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 1.0, 1.0]), None);
    }
}
