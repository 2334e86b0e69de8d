//! Decompositions of the iteration matrices of small systems in a fixed order, without exchanges of rows.
//!
//! Most entries of a Jacobian of a dozen components are zero. A [`SymbolicLu`] never touches them, and the real and the
//! complex matrix, which have the same pattern, are decomposed and solved together: their chains of operations overlap.
//! Where a pivot is left by cancellation, the caller has another decomposition, with exchanges of rows.

use crate::integrate::matrix::Shift;
use crate::integrate::system::{EvalError, System};
use crate::numeric::pattern::Pattern;
use crate::numeric::symbolic_lu::{SymbolicLu, WEAKEST, Weak};

/// Smallest number of components for which this pays.
const LEAST: usize = 5;
/// Largest number of components.
const MOST: usize = 60;
/// Largest share of the entries that may be nonzero after elimination.
const MAX_DENSITY: f64 = 0.6;

/// An entry of the real matrix, and the parts of that of the complex one.
type Entry = [f64; 3];

/// The Jacobian of a system and the decompositions of its iteration matrices.
pub struct Elimination {
    /// The Jacobian in the order of its pattern.
    jacobian: Vec<f64>,
    /// Its rows and columns.
    coordinates: Vec<(usize, usize)>,
    /// The factor that each entry of the Jacobian belongs to.
    places: Vec<usize>,
    /// The component at each position.
    order: Vec<usize>,
    /// Reciprocals of the pivots, then for each position the entries below it and those after it.
    factors: Vec<Entry>,
    /// Their other positions.
    others: Vec<usize>,
    /// Ends of the entries below each position, and of those after it.
    ends: Vec<(usize, usize)>,
    /// The factors that change when a position is eliminated: for each entry below it, for each after it.
    changed: Vec<usize>,
    /// Largest terms of the pivots, real and complex.
    sizes: Vec<[f64; 2]>,
    /// A right-hand side by position, real and complex.
    right: Vec<Entry>,
}

impl Elimination {
    /// For a system of differential equations that provides a pattern; `None` if this does not pay.
    pub fn for_system(system: &dyn System) -> Option<Self> {
        let n = system.dim();
        let fits = (LEAST..=MOST).contains(&n) && system.differential().iter().all(|d| *d);
        let pattern = system.pattern().filter(|_| fits)?;
        let plan = SymbolicLu::new(pattern);
        let is_sparse = plan.entries as f64 <= MAX_DENSITY * (n * n) as f64;
        is_sparse.then(|| Elimination::new(pattern, &plan))
    }

    fn new(pattern: &Pattern, plan: &SymbolicLu) -> Self {
        let n = pattern.columns();
        // The entries that belong to a position are neighbours.
        let mut number = vec![0; plan.entries];
        (0..n).for_each(|k| number[k] = k);
        let (mut others, mut ends) = (vec![0; n], Vec::with_capacity(n));
        for (lower, upper) in plan.lower.iter().zip(&plan.upper) {
            for place in lower.iter().chain(upper) {
                number[place.entry] = others.len();
                others.push(place.other);
            }
            ends.push((others.len() - upper.len(), others.len()));
        }
        let coordinates = (0..n).flat_map(|j| pattern.column(j).iter().map(move |i| (*i, j)));
        Elimination {
            jacobian: vec![0.0; pattern.entries()],
            coordinates: coordinates.collect(),
            places: plan.places.iter().map(|e| number[*e]).collect(),
            order: plan.order.clone(),
            factors: vec![[0.0; 3]; plan.entries],
            others,
            ends,
            changed: plan.changed.iter().flatten().map(|e| number[*e]).collect(),
            sizes: vec![[0.0; 2]; n],
            right: vec![[0.0; 3]; n],
        }
    }

    /// Evaluates the Jacobian.
    pub fn evaluate(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
    ) -> Result<(), EvalError> {
        system.jacobian_entries(t, y, &mut self.jacobian)
    }

    /// Takes these entries as the Jacobian, in the order of the pattern; false, with nothing changed, if one is not
    /// finite.
    pub fn adopt(&mut self, entries: &[f64]) -> bool {
        let is_fine = entries.iter().all(|x| x.is_finite());
        if is_fine {
            self.jacobian.copy_from_slice(entries);
        }
        is_fine
    }

    /// The row of the first entry of the Jacobian that is not finite.
    pub fn first_non_finite(&self) -> Option<usize> {
        let at = self.jacobian.iter().position(|x| !x.is_finite())?;
        Some(self.coordinates[at].0)
    }

    /// Row, column and value of each entry of the Jacobian.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.coordinates.iter().zip(&self.jacobian).map(|((i, j), value)| (*i, *j, *value))
    }

    /// Decomposes the matrices for this shift.
    pub fn factor(&mut self, shift: Shift) -> Result<(), Weak> {
        let n = self.order.len();
        self.factors[..n].fill([shift.real, shift.re, shift.im]);
        self.factors[n..].fill([0.0; 3]);
        for (entry, place) in self.jacobian.iter().zip(&self.places) {
            let factor = &mut self.factors[*place];
            factor[0] -= entry;
            factor[1] -= entry;
        }
        for (size, pivot) in self.sizes.iter_mut().zip(&self.factors) {
            *size = sizes(pivot);
        }
        let (mut start, mut changed) = (n, 0);
        for k in 0..n {
            let (lower, upper) = self.ends[k];
            let reciprocal = reciprocal(&self.factors[k], &self.sizes[k]).ok_or(Weak)?;
            self.factors[k] = reciprocal;
            for row in start..lower {
                let multiplier = product(&self.factors[row], &reciprocal);
                self.factors[row] = multiplier;
                let targets = &self.changed[changed..changed + upper - lower];
                changed += targets.len();
                for (column, &target) in (lower..upper).zip(targets) {
                    let term = product(&multiplier, &self.factors[column]);
                    subtract(&mut self.factors[target], &term);
                    if target < n {
                        let size = sizes(&term);
                        let so_far = &mut self.sizes[target];
                        *so_far = [so_far[0].max(size[0]), so_far[1].max(size[1])];
                    }
                }
            }
            start = upper;
        }
        Ok(())
    }

    /// Solves with the real matrix, in place.
    pub fn solve_real(&mut self, b: &mut [f64]) {
        let Elimination { order, factors, others, ends, right, .. } = self;
        for (x, &i) in right.iter_mut().zip(order.iter()) {
            x[0] = b[i];
        }
        let mut start = order.len();
        for (k, &(lower, upper)) in ends.iter().enumerate() {
            let x = right[k][0];
            for (factor, &i) in factors[start..lower].iter().zip(&others[start..lower]) {
                right[i][0] -= factor[0] * x;
            }
            start = upper;
        }
        for (k, &(lower, upper)) in ends.iter().enumerate().rev() {
            let mut x = right[k][0];
            for (factor, &j) in factors[lower..upper].iter().zip(&others[lower..upper]) {
                x -= factor[0] * right[j][0];
            }
            right[k][0] = x * factors[k][0];
        }
        for (x, &i) in right.iter().zip(order.iter()) {
            b[i] = x[0];
        }
    }

    /// Solves with both matrices, in place: `a` with the real one, `re + i im` with the complex one.
    pub fn solve(&mut self, a: &mut [f64], re: &mut [f64], im: &mut [f64]) {
        self.solve_column(a, re, im, (1, 0));
    }

    /// The same for a column of panels of this width.
    pub fn solve_column(
        &mut self,
        a: &mut [f64],
        re: &mut [f64],
        im: &mut [f64],
        (width, column): (usize, usize),
    ) {
        let Elimination { order, factors, others, ends, right, .. } = self;
        for (x, &i) in right.iter_mut().zip(order.iter()) {
            let at = i * width + column;
            *x = [a[at], re[at], im[at]];
        }
        let mut start = order.len();
        for (k, &(lower, upper)) in ends.iter().enumerate() {
            let x = right[k];
            for (factor, &i) in factors[start..lower].iter().zip(&others[start..lower]) {
                subtract(&mut right[i], &product(factor, &x));
            }
            start = upper;
        }
        for (k, &(lower, upper)) in ends.iter().enumerate().rev() {
            let mut x = right[k];
            for (factor, &j) in factors[lower..upper].iter().zip(&others[lower..upper]) {
                subtract(&mut x, &product(factor, &right[j]));
            }
            right[k] = product(&factors[k], &x);
        }
        for (x, &i) in right.iter().zip(order.iter()) {
            let at = i * width + column;
            [a[at], re[at], im[at]] = *x;
        }
    }
}

/// The sizes of both numbers.
#[inline]
fn sizes(x: &Entry) -> [f64; 2] {
    [x[0].abs(), x[1].abs() + x[2].abs()]
}

/// The products of the real numbers and of the complex ones.
#[inline]
fn product(x: &Entry, y: &Entry) -> Entry {
    [x[0] * y[0], x[1] * y[1] - x[2] * y[2], x[1] * y[2] + x[2] * y[1]]
}

#[inline]
fn subtract(x: &mut Entry, y: &Entry) {
    x[0] -= y[0];
    x[1] -= y[1];
    x[2] -= y[2];
}

/// The reciprocals of a pivot, unless it is small among terms of these sizes; `None` for a NaN.
#[inline]
fn reciprocal(pivot: &Entry, terms: &[f64; 2]) -> Option<Entry> {
    let own = sizes(pivot);
    let is_fine = |k: usize| own[k] > 0.0 && own[k] * WEAKEST >= terms[k];
    if !(is_fine(0) && is_fine(1)) {
        return None;
    }
    let modulus = 1.0 / (pivot[1] * pivot[1] + pivot[2] * pivot[2]);
    Some([1.0 / pivot[0], pivot[1] * modulus, -pivot[2] * modulus])
}
