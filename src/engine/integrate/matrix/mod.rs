//! The iteration matrices of implicit methods: `s M - J` with a real `s`, and for Radau also
//! `(a + i b) M - J`.
//!
//! Rows with one unknown are solved first, by substitution, and only the rest is decomposed. This
//! is stable (a forward substitution along the block-triangular form) and not just faster: pivoting
//! never mixes a component whose equation is `y' = 0` with others, so its correction is exactly
//! zero, and a locked mass does not move by a bit.

pub mod elimination;
pub mod panel;
pub mod sparse;
pub mod split;

use crate::integrate::matrix::elimination::Elimination;
use crate::integrate::matrix::panel::PanelMemory;
use crate::integrate::matrix::sparse::SparseParts;
use crate::integrate::matrix::split::{Columns, Split};
use crate::integrate::system::{EvalError, System};
use crate::numeric::linear::complex::ComplexLu;
use crate::numeric::linear::{DenseLu, Singular};
use crate::numeric::pattern::Pattern;

/// The Jacobian, the split into substituted and decomposed rows, and the decompositions.
pub struct IterationMatrix {
    /// Diagonal of `M` as numbers.
    mass: Vec<f64>,
    split: Split,
    parts: Parts,
    /// Multiples of `M` in the two matrices.
    shift: Shift,
    /// Reciprocals of the substituted pivots, real and complex.
    pivots: Vec<f64>,
    pivots_re: Vec<f64>,
    pivots_im: Vec<f64>,
    /// Substituted unknowns while the core is solved: the right side is indexed by rows, the
    /// solution by columns, which differ if a pivot is off the diagonal.
    solved_re: Vec<f64>,
    solved_im: Vec<f64>,
    core_re: Vec<f64>,
    core_im: Vec<f64>,
    panel: PanelMemory,
    /// A decomposition for small systems that comes before the others.
    elimination: Option<Box<Elimination>>,
    /// The Jacobian is that of `elimination`.
    has_entries: bool,
    /// The decompositions are those of `elimination`.
    is_eliminated: bool,
}

/// The multiples of `M`: `real` in the real matrix, `re + i im` in the complex one.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct Shift {
    /// Multiple in the real matrix.
    pub real: f64,
    /// Real part of the multiple in the complex matrix.
    pub re: f64,
    /// Its imaginary part.
    pub im: f64,
}

/// The matrices that a method needs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Planes {
    /// The real one only.
    Real,
    /// The real and the complex one.
    Complex,
}

/// The Jacobian and the decompositions.
enum Parts {
    Dense(Box<DenseParts>),
    Sparse(Box<SparseParts>),
}

impl IterationMatrix {
    /// For systems of `n` components without a pattern.
    pub fn dense(n: usize, planes: Planes) -> Self {
        IterationMatrix::new(n, n * n, planes, Parts::Dense(Box::new(DenseParts::new(n, planes))))
    }

    /// For systems whose Jacobian has this pattern.
    pub fn sparse(pattern: &Pattern, planes: Planes) -> Self {
        let parts = SparseParts::new(pattern, planes);
        let count = parts.count();
        IterationMatrix::new(pattern.columns(), count, planes, Parts::Sparse(Box::new(parts)))
    }

    /// Sparse if the system is large and provides the pattern of its Jacobian, else dense; for Radau preceded by an
    /// [`Elimination`] if the system is small. The
    /// memory of sparse decompositions is allocated at the first one, and again if the zeros of the
    /// Jacobian change.
    pub fn for_system(system: &dyn System, planes: Planes) -> Self {
        match system.pattern().filter(|p| sparse::pays(p)) {
            Some(p) => IterationMatrix::sparse(p, planes),
            None => {
                let elimination = match planes {
                    Planes::Real => None,
                    Planes::Complex => Elimination::for_system(system).map(Box::new),
                };
                IterationMatrix { elimination, ..IterationMatrix::dense(system.dim(), planes) }
            }
        }
    }

    fn new(n: usize, entries: usize, planes: Planes, parts: Parts) -> Self {
        let complex = || vec![0.0; if planes == Planes::Complex { n } else { 0 }];
        IterationMatrix {
            mass: vec![1.0; n],
            split: Split::new(n, entries),
            parts,
            shift: Shift::default(),
            pivots: vec![0.0; n],
            pivots_re: complex(),
            pivots_im: complex(),
            solved_re: vec![0.0; n],
            solved_im: complex(),
            core_re: vec![0.0; n],
            core_im: complex(),
            panel: PanelMemory::default(),
            elimination: None,
            has_entries: false,
            is_eliminated: false,
        }
    }

    /// Sets the diagonal of `M`; true if it changed, in which case `analyze` is necessary.
    pub fn set_mass(&mut self, differential: &[bool]) -> bool {
        let mut changed = false;
        for (m, d) in self.mass.iter_mut().zip(differential) {
            let mass = if *d { 1.0 } else { 0.0 };
            changed |= *m != mass;
            *m = mass;
        }
        changed
    }

    /// The diagonal of `M` as zeros and ones.
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Evaluates the Jacobian of the system. Call `analyze` afterwards.
    pub fn evaluate(
        &mut self,
        system: &mut dyn System,
        t: f64,
        y: &[f64],
    ) -> Result<(), EvalError> {
        (self.has_entries, self.is_eliminated) = (false, false);
        if let Some(elimination) = self.elimination.as_mut().filter(|_| !system.leaves_pattern()) {
            elimination.evaluate(system, t, y)?;
            self.has_entries = true;
            return Ok(());
        }
        match &mut self.parts {
            Parts::Dense(parts) => parts.evaluate(system, t, y),
            Parts::Sparse(parts) => parts.evaluate(system, t, y),
        }
    }

    /// Takes these entries, which the system has given, as the Jacobian; false if it does not take any.
    pub fn adopt(&mut self, entries: &[f64]) -> bool {
        let adopted = self.elimination.as_mut().is_some_and(|e| e.adopt(entries));
        if adopted {
            (self.has_entries, self.is_eliminated) = (true, false);
        }
        adopted
    }

    /// Splits rows by the zeros of the new Jacobian. `Err` is the first row that is not finite.
    pub fn analyze(&mut self) -> Result<(), usize> {
        if let Some(elimination) = self.elimination.as_ref().filter(|_| self.has_entries) {
            return elimination.first_non_finite().map_or(Ok(()), Err);
        }
        match &mut self.parts {
            Parts::Dense(parts) => parts.analyze(&mut self.split, &self.mass),
            Parts::Sparse(parts) => parts.analyze(&mut self.split, &self.mass),
        }
    }

    /// Decomposes the matrices for this shift; without a complex matrix only `shift.real` is used.
    /// The error names a component.
    pub fn factor(&mut self, shift: Shift) -> Result<(), Singular> {
        self.shift = shift;
        if let Some(elimination) = self.elimination.as_mut().filter(|_| self.has_entries) {
            self.is_eliminated = elimination.factor(shift).is_ok();
            if self.is_eliminated {
                return Ok(());
            }
            if let Parts::Dense(parts) = &mut self.parts {
                parts.jacobian.set(elimination.entries());
                // Its entries are finite.
                let _ = parts.analyze(&mut self.split, &self.mass);
            }
        }
        let (mass, split) = (&self.mass, &self.split);
        for (k, s) in split.substituted.iter().enumerate() {
            let real = s.mass * shift.real - s.jacobian;
            if real == 0.0 {
                return Err(Singular { column: s.column });
            }
            self.pivots[k] = 1.0 / real;
        }
        let complex = self.pivots_re.iter_mut().zip(&mut self.pivots_im);
        for (s, (p, q)) in split.substituted.iter().zip(complex) {
            let (re, im) = (s.mass * shift.re - s.jacobian, s.mass * shift.im);
            if re == 0.0 && im == 0.0 {
                return Err(Singular { column: s.column });
            }
            let modulus = re * re + im * im;
            (*p, *q) = (re / modulus, -im / modulus);
        }
        let outcome = match &mut self.parts {
            Parts::Dense(parts) => parts.factor(split, mass, shift),
            Parts::Sparse(parts) => parts.factor(mass, shift),
        };
        outcome.map_err(|error| Singular { column: split.columns[error.column] })
    }

    /// Solves with both matrices, in place: `a` with the real one, `re + i im` with the complex one.
    pub fn solve(&mut self, a: &mut [f64], re: &mut [f64], im: &mut [f64]) {
        match self.elimination.as_mut().filter(|_| self.is_eliminated) {
            Some(elimination) => elimination.solve(a, re, im),
            None => {
                self.solve_real(a);
                self.solve_complex(re, im);
            }
        }
    }

    /// Solves with the real matrix, in place.
    pub fn solve_real(&mut self, b: &mut [f64]) {
        if let Some(elimination) = self.elimination.as_mut().filter(|_| self.is_eliminated) {
            return elimination.solve_real(b);
        }
        let split = &self.split;
        if split.substituted.is_empty() {
            return self.parts.solve_real(b);
        }
        let mut start = 0;
        for (k, s) in split.substituted.iter().enumerate() {
            let x = b[s.row] * self.pivots[k];
            self.solved_re[k] = x;
            if x != 0.0 {
                for c in &split.couplings[start..s.end] {
                    b[c.row] -= (c.mass * self.shift.real - c.jacobian) * x;
                }
            }
            start = s.end;
        }
        let core = &mut self.core_re[..split.rows.len()];
        gather(&split.rows, b, core);
        self.parts.solve_real(core);
        scatter(&split.columns, core, b);
        for (s, x) in split.substituted.iter().zip(&self.solved_re) {
            b[s.column] = *x;
        }
    }

    /// Solves with the complex matrix, in place. Only with [`Planes::Complex`], and without an [`Elimination`].
    fn solve_complex(&mut self, b_re: &mut [f64], b_im: &mut [f64]) {
        let split = &self.split;
        if split.substituted.is_empty() {
            return self.parts.solve_complex(b_re, b_im);
        }
        let mut start = 0;
        for (k, s) in split.substituted.iter().enumerate() {
            let (p, q) = (self.pivots_re[k], self.pivots_im[k]);
            let (x, y) = (b_re[s.row] * p - b_im[s.row] * q, b_re[s.row] * q + b_im[s.row] * p);
            (self.solved_re[k], self.solved_im[k]) = (x, y);
            if x != 0.0 || y != 0.0 {
                for c in &split.couplings[start..s.end] {
                    let (re, im) = (c.mass * self.shift.re - c.jacobian, c.mass * self.shift.im);
                    b_re[c.row] -= re * x - im * y;
                    b_im[c.row] -= re * y + im * x;
                }
            }
            start = s.end;
        }
        let order = split.rows.len();
        let (core_re, core_im) = (&mut self.core_re[..order], &mut self.core_im[..order]);
        gather(&split.rows, b_re, core_re);
        gather(&split.rows, b_im, core_im);
        self.parts.solve_complex(core_re, core_im);
        scatter(&split.columns, core_re, b_re);
        scatter(&split.columns, core_im, b_im);
        for (k, s) in split.substituted.iter().enumerate() {
            b_re[s.column] = self.solved_re[k];
            b_im[s.column] = self.solved_im[k];
        }
    }
}

impl Parts {
    /// Solves with the core of the real matrix.
    fn solve_real(&mut self, b: &mut [f64]) {
        match self {
            Parts::Dense(parts) => parts.real.solve_in_place(b),
            Parts::Sparse(parts) => parts.solve_real(b),
        }
    }

    /// Solves with the core of the complex matrix.
    fn solve_complex(&mut self, b_re: &mut [f64], b_im: &mut [f64]) {
        match self {
            Parts::Dense(parts) => {
                if let Some(complex) = &mut parts.complex {
                    complex.solve_in_place(b_re, b_im);
                }
            }
            Parts::Sparse(parts) => parts.solve_complex(b_re, b_im),
        }
    }
}

/// A dense Jacobian, column-major, and the decompositions of the part that is not substituted.
struct DenseParts {
    jacobian: DenseJacobian,
    real: DenseLu,
    complex: Option<ComplexLu>,
}

struct DenseJacobian {
    n: usize,
    values: Vec<f64>,
}

impl Columns for DenseJacobian {
    fn visit(&self, j: usize, visit: &mut impl FnMut(usize, f64)) {
        for (i, value) in self.values[self.n * j..self.n * (j + 1)].iter().enumerate() {
            visit(i, *value);
        }
    }
}

impl DenseParts {
    fn new(n: usize, planes: Planes) -> Self {
        DenseParts {
            jacobian: DenseJacobian { n, values: vec![0.0; n * n] },
            real: DenseLu::new(n),
            complex: (planes == Planes::Complex).then(|| ComplexLu::new(n)),
        }
    }

    fn evaluate(&mut self, system: &mut dyn System, t: f64, y: &[f64]) -> Result<(), EvalError> {
        self.jacobian.values.fill(0.0);
        system.jacobian(t, y, &mut self.jacobian.values)
    }

    fn analyze(&mut self, split: &mut Split, mass: &[f64]) -> Result<(), usize> {
        if let Some(entry) = self.jacobian.values.iter().position(|x| !x.is_finite()) {
            return Err(entry % self.jacobian.n);
        }
        if self.jacobian.n == 0 {
            return Ok(());
        }
        split.find(&self.jacobian, mass);
        self.real.set_order(split.rows.len());
        if let Some(complex) = &mut self.complex {
            complex.set_order(split.rows.len());
        }
        Ok(())
    }

    fn factor(&mut self, split: &Split, mass: &[f64], shift: Shift) -> Result<(), Singular> {
        let jacobian = &self.jacobian;
        self.real.factor_with(|matrix| {
            jacobian.core(split, matrix);
            add_mass(split, mass, shift.real, matrix);
        })?;
        let Some(complex) = &mut self.complex else { return Ok(()) };
        complex.factor_with(|re, im| {
            jacobian.core(split, re);
            im.fill(0.0);
            add_mass(split, mass, shift.re, re);
            add_mass(split, mass, shift.im, im);
        })
    }
}

impl DenseJacobian {
    /// Sets the entries at these rows and columns; the others are zero.
    fn set(&mut self, entries: impl Iterator<Item = (usize, usize, f64)>) {
        self.values.fill(0.0);
        entries.for_each(|(i, j, value)| self.values[i + self.n * j] = value);
    }

    /// Copies `-J` restricted to the core.
    fn core(&self, split: &Split, matrix: &mut [f64]) {
        let order = split.rows.len();
        if order == self.n {
            for (to, from) in matrix.iter_mut().zip(&self.values) {
                *to = -from;
            }
            return;
        }
        if order == 0 {
            return;
        }
        for (to, &j) in matrix.chunks_exact_mut(order).zip(&split.columns) {
            let from = &self.values[self.n * j..self.n * (j + 1)];
            for (to, &i) in to.iter_mut().zip(&split.rows) {
                *to = -from[i];
            }
        }
    }
}

/// Adds `shift` to the diagonal entries in the core.
fn add_mass(split: &Split, mass: &[f64], shift: f64, matrix: &mut [f64]) {
    let order = split.rows.len();
    let mut a = 0;
    for (b, &j) in split.columns.iter().enumerate() {
        while a < order && split.rows[a] < j {
            a += 1;
        }
        if a < order && split.rows[a] == j {
            matrix[a + order * b] += mass[j] * shift;
        }
    }
}

fn gather(indices: &[usize], from: &[f64], to: &mut [f64]) {
    for (to, &i) in to.iter_mut().zip(indices) {
        *to = from[i];
    }
}

fn scatter(indices: &[usize], from: &[f64], to: &mut [f64]) {
    for (from, &i) in from.iter().zip(indices) {
        to[i] = *from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y' = J y`; every entry is in the pattern, or only the nonzero ones.
    struct Linear {
        jacobian: Vec<f64>,
        differential: Vec<bool>,
        pattern: Pattern,
    }

    impl Linear {
        fn new(jacobian: &[f64], differential: &[bool]) -> Self {
            let n = differential.len();
            let places = (0..n * n).filter(|k| jacobian[*k] != 0.0).map(|k| (k % n, k / n));
            let pattern = Pattern::from_entries(n, n, &places.collect::<Vec<_>>());
            let (jacobian, differential) = (jacobian.to_vec(), differential.to_vec());
            Linear { jacobian, differential, pattern }
        }
    }

    impl System for Linear {
        fn dim(&self) -> usize {
            self.differential.len()
        }
        fn differential(&self) -> &[bool] {
            &self.differential
        }
        fn rhs(&mut self, _: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
            let n = y.len();
            for (i, f) in f.iter_mut().enumerate() {
                *f = (0..n).map(|j| self.jacobian[i + n * j] * y[j]).sum();
            }
            Ok(())
        }
        fn jacobian(&mut self, _: f64, _: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
            j.copy_from_slice(&self.jacobian);
            Ok(())
        }
        fn pattern(&self) -> Option<&Pattern> {
            Some(&self.pattern)
        }
        fn jacobian_entries(&mut self, _: f64, _: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
            let nonzero = self.jacobian.iter().filter(|x| **x != 0.0);
            j.iter_mut().zip(nonzero).for_each(|(to, from)| *to = *from);
            Ok(())
        }
    }

    /// Solves with `J` and `M` and checks the residual of both systems, dense and sparse.
    fn check(n: usize, jacobian: &[f64], differential: &[bool], substituted: usize) {
        let mut system = Linear::new(jacobian, differential);
        let matrices: Vec<_> = [Planes::Complex, Planes::Real]
            .into_iter()
            .flat_map(|planes| {
                [
                    IterationMatrix::dense(n, planes),
                    IterationMatrix::sparse(&system.pattern, planes),
                ]
                .map(|matrix| (matrix, planes))
            })
            .collect();
        for (mut matrix, planes) in matrices {
            matrix.set_mass(differential);
            matrix.evaluate(&mut system, 0.0, &vec![0.0; n]).unwrap();
            matrix.analyze().unwrap();
            assert_eq!(matrix.split.substituted.len(), substituted);
            residuals(&mut matrix, planes, jacobian, differential);
        }
    }

    fn residuals(
        matrix: &mut IterationMatrix,
        planes: Planes,
        jacobian: &[f64],
        differential: &[bool],
    ) {
        let n = differential.len();
        let shift = Shift { real: 3.0, re: 2.0, im: 5.0 };
        matrix.factor(shift).unwrap();

        let b: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
        let c: Vec<f64> = (0..n).map(|i| 2.0 - 0.5 * i as f64).collect();
        let mut x = b.clone();
        matrix.solve_real(&mut x);
        let (mut p, mut q) = (b.clone(), c.clone());
        if planes == Planes::Complex {
            let mut again = b.clone();
            matrix.solve(&mut again, &mut p, &mut q);
            assert_eq!(again, x);
        }
        for i in 0..n {
            let m = if differential[i] { 1.0 } else { 0.0 };
            let row = |v: &[f64]| (0..n).map(|j| jacobian[i + n * j] * v[j]).sum::<f64>();
            let real = m * shift.real * x[i] - row(&x) - b[i];
            let re = m * (shift.re * p[i] - shift.im * q[i]) - row(&p) - b[i];
            let im = m * (shift.re * q[i] + shift.im * p[i]) - row(&q) - c[i];
            assert!(real.abs() < 1e-13, "{real}");
            if planes == Planes::Complex {
                assert!(re.abs().max(im.abs()) < 1e-13, "{re} {im}");
            }
        }
    }

    /// Solves with a matrix that is eliminated first, and says whether it was.
    fn eliminates(jacobian: &[f64]) -> bool {
        let n = jacobian.len().isqrt();
        let mut system = Linear::new(jacobian, &vec![true; n]);
        let mut matrix = IterationMatrix::for_system(&system, Planes::Complex);
        matrix.set_mass(&vec![true; n]);
        matrix.evaluate(&mut system, 0.0, &vec![0.0; n]).unwrap();
        matrix.analyze().unwrap();
        residuals(&mut matrix, Planes::Complex, jacobian, &vec![true; n]);
        matrix.is_eliminated
    }

    /// A chain of seven components whose ends are joined.
    fn ring() -> Vec<f64> {
        let mut jacobian = vec![0.0; 49];
        for i in 0..7 {
            let next = (i + 1) % 7;
            jacobian[i + 7 * i] = -1.5 - i as f64;
            jacobian[next + 7 * i] = 2.0 + 0.25 * i as f64;
            jacobian[i + 7 * next] = 1.0 - 0.5 * i as f64;
        }
        jacobian
    }

    #[test]
    fn a_small_sparse_matrix_is_eliminated_in_a_fixed_order() {
        assert!(eliminates(&ring()));
    }

    /// The first pivot of the real matrix is zero; with exchanges of rows it has a solution.
    #[test]
    fn a_weak_pivot_needs_exchanges() {
        let mut jacobian = ring();
        jacobian[0] = 3.0;
        assert!(!eliminates(&jacobian));
    }

    #[test]
    fn full_matrix_is_only_decomposed() {
        check(2, &[1.0, 2.0, 3.0, -4.0], &[true, true], 0);
    }

    #[test]
    fn triangular_matrix_is_only_substituted() {
        check(3, &[0.0, 1.0, 4.0, 0.0, -2.0, 5.0, 0.0, 0.0, 7.0], &[true; 3], 3);
    }

    /// Row 0 is algebraic and determines unknown 1; rows 1 to 3 keep a core off the diagonal.
    #[test]
    fn substitution_off_the_diagonal() {
        #[rustfmt::skip]
        let jacobian = [
            0.0, 1.0, 2.0, -1.0,
            2.0, 1.5, 1.0, 0.0,
            0.0, 1.0, -3.0, 1.0,
            0.0, 4.0, 1.0, -2.0,
        ];
        check(4, &jacobian, &[false, true, true, true], 1);
    }
}
