//! The Jacobian and the sparse decompositions of a large system.

use crate::integrate::matrix::split::{Columns, Split};
use crate::integrate::matrix::{Planes, Shift};
use crate::integrate::system::{EvalError, System};
use crate::numeric::linear::Singular;
use crate::numeric::linear::complex_sparse::{Complex, ComplexSparseLu};
use crate::numeric::linear::sparse::SparseLu;
use crate::numeric::pattern::Pattern;

/// Minimum order for sparse decompositions.
const MIN_ORDER: usize = 60;
/// Maximum density for sparse decompositions.
const MAX_DENSITY: f64 = 0.125;

/// True if sparse decompositions are expected to be faster than dense ones.
pub fn pays(pattern: &Pattern) -> bool {
    let n = pattern.columns();
    n > MIN_ORDER && pattern.entries() as f64 <= MAX_DENSITY * (n * n) as f64
}

/// A Jacobian by its pattern, and the decompositions of the part that is not substituted.
pub struct SparseParts {
    /// The values as the system writes them, and their positions in the Jacobian.
    entries: Vec<f64>,
    places: Vec<usize>,
    /// The Jacobian with the whole diagonal.
    jacobian: SparseJacobian,
    planes: Planes,
    core: Core,
}

struct SparseJacobian {
    pattern: Pattern,
    values: Vec<f64>,
}

/// The rows and columns that are decomposed.
#[derive(Default)]
struct Core {
    rows: Vec<usize>,
    columns: Vec<usize>,
    /// For each entry the one of the Jacobian that it comes from.
    sources: Vec<usize>,
    /// Entries to which `M` contributes, with their component.
    diagonal: Vec<(usize, usize)>,
    values: Vec<f64>,
    complex_values: Vec<Complex>,
    right_side: Vec<Complex>,
    /// These are `None` before the first decomposition with these rows and columns.
    real: Option<SparseLu>,
    complex: Option<ComplexSparseLu>,
}

impl Columns for SparseJacobian {
    fn visit(&self, j: usize, visit: &mut impl FnMut(usize, f64)) {
        let start = self.pattern.column_starts()[j];
        for (k, &i) in self.pattern.column(j).iter().enumerate() {
            visit(i, self.values[start + k]);
        }
    }
}

impl SparseParts {
    /// For Jacobians with this pattern, which is square.
    pub fn new(pattern: &Pattern, planes: Planes) -> Self {
        let n = pattern.columns();
        let mut all: Vec<(usize, usize)> = Vec::with_capacity(pattern.entries() + n);
        for j in 0..n {
            all.extend(pattern.column(j).iter().map(|&i| (i, j)));
            all.push((j, j));
        }
        let whole = Pattern::from_entries(n, n, &all);
        let mut places = Vec::with_capacity(pattern.entries());
        for j in 0..n {
            places.extend(pattern.column(j).iter().filter_map(|&i| whole.position(i, j)));
        }
        let values = vec![0.0; whole.entries()];
        SparseParts {
            entries: vec![0.0; pattern.entries()],
            places,
            jacobian: SparseJacobian { pattern: whole, values },
            planes,
            core: Core::default(),
        }
    }

    /// Number of entries of the iteration matrices.
    pub fn count(&self) -> usize {
        self.jacobian.values.len()
    }

    /// Evaluates the Jacobian.
    pub fn evaluate(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
    ) -> Result<(), EvalError> {
        system.jacobian_entries(t, y, &mut self.entries)?;
        for (&place, &value) in self.places.iter().zip(&self.entries) {
            self.jacobian.values[place] = value;
        }
        Ok(())
    }

    /// Splits rows by the zeros of the Jacobian. `Err` is the first row that is not finite.
    pub fn analyze(&mut self, split: &mut Split, mass: &[f64]) -> Result<(), usize> {
        let jacobian = &self.jacobian;
        if let Some(entry) = jacobian.values.iter().position(|x| !x.is_finite()) {
            return Err(jacobian.pattern.row_indices()[entry]);
        }
        split.find(jacobian, mass);
        // The fill-reducing ordering is valid while the rows and columns of the core are unchanged.
        if self.core.rows != split.rows || self.core.columns != split.columns {
            self.core = Core::of(&jacobian.pattern, split, self.planes);
        }
        Ok(())
    }

    /// Decomposes both matrices; the error names a column of the core.
    pub fn factor(&mut self, mass: &[f64], shift: Shift) -> Result<(), Singular> {
        let core = &mut self.core;
        if core.rows.is_empty() {
            return Ok(());
        }
        for (value, &source) in core.values.iter_mut().zip(&core.sources) {
            *value = -self.jacobian.values[source];
        }
        for &(k, i) in &core.diagonal {
            core.values[k] += mass[i] * shift.real;
        }
        let real = match &mut core.real {
            Some(real) => real,
            None => {
                let pattern = core.pattern(&self.jacobian.pattern);
                core.real.insert(SparseLu::new(pattern)?)
            }
        };
        real.factor(&core.values)?;
        if self.planes == Planes::Complex { self.factor_complex(mass, shift) } else { Ok(()) }
    }

    fn factor_complex(&mut self, mass: &[f64], shift: Shift) -> Result<(), Singular> {
        let core = &mut self.core;
        for (value, &source) in core.complex_values.iter_mut().zip(&core.sources) {
            *value = Complex::new(-self.jacobian.values[source], 0.0);
        }
        for &(k, i) in &core.diagonal {
            core.complex_values[k].re += mass[i] * shift.re;
            core.complex_values[k].im += mass[i] * shift.im;
        }
        let complex = match &mut core.complex {
            Some(complex) => complex,
            None => {
                let pattern = core.pattern(&self.jacobian.pattern);
                core.complex.insert(ComplexSparseLu::new(pattern)?)
            }
        };
        complex.factor(&core.complex_values)
    }

    /// Solves with the core of the real matrix.
    pub fn solve_real(&mut self, b: &mut [f64]) {
        if let Some(real) = &mut self.core.real {
            real.solve_in_place(b);
        }
    }

    /// Solves with the core of the complex matrix.
    pub fn solve_complex(&mut self, b_re: &mut [f64], b_im: &mut [f64]) {
        let Some(complex) = &mut self.core.complex else { return };
        let b = &mut self.core.right_side;
        for (z, (x, y)) in b.iter_mut().zip(b_re.iter().zip(b_im.iter())) {
            *z = Complex::new(*x, *y);
        }
        complex.solve_in_place(b);
        for (z, (x, y)) in b.iter().zip(b_re.iter_mut().zip(b_im)) {
            (*x, *y) = (z.re, z.im);
        }
    }
}

impl Core {
    /// The part of the pattern that the split leaves.
    fn of(whole: &Pattern, split: &Split, planes: Planes) -> Core {
        let mut in_core = vec![false; whole.rows()];
        split.rows.iter().for_each(|&i| in_core[i] = true);
        let mut core =
            Core { rows: split.rows.clone(), columns: split.columns.clone(), ..Core::default() };
        for &j in &core.columns {
            let start = whole.column_starts()[j];
            for (k, &i) in whole.column(j).iter().enumerate() {
                if !in_core[i] {
                    continue;
                }
                if i == j {
                    core.diagonal.push((core.sources.len(), i));
                }
                core.sources.push(start + k);
            }
        }
        core.values = vec![0.0; core.sources.len()];
        if planes == Planes::Complex {
            core.complex_values = vec![Complex::new(0.0, 0.0); core.sources.len()];
            core.right_side = vec![Complex::new(0.0, 0.0); core.rows.len()];
        }
        core
    }

    /// The pattern of the core, its rows and columns counted from zero.
    fn pattern(&self, whole: &Pattern) -> Pattern {
        let mut row_number = vec![usize::MAX; whole.rows()];
        for (number, &i) in self.rows.iter().enumerate() {
            row_number[i] = number;
        }
        let mut entries = Vec::with_capacity(self.sources.len());
        for (number, &j) in self.columns.iter().enumerate() {
            let rows = whole.column(j).iter().map(|&i| row_number[i]);
            entries.extend(rows.filter(|&i| i != usize::MAX).map(|i| (i, number)));
        }
        Pattern::from_entries(self.rows.len(), self.columns.len(), &entries)
    }
}
