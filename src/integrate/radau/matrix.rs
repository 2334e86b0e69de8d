//! The two matrices of the transformed stage equations, `g/h M - J` and `(a + i b)/h M - J`.
//!
//! Rows with one unknown are solved first, by substitution, and only the rest is decomposed. That is
//! stable (a forward substitution along the block-triangular form) and has a purpose beyond speed:
//! a component whose equation is `y' = 0` is then never mixed with others by pivoting, so that its
//! correction is exactly zero, and a locked mass stays where it is to the bit.

use crate::math::numeric::linear::{ComplexLu, DenseLu, Singular};

/// The Jacobian, the split into substituted and decomposed rows, and the decompositions.
pub struct IterationMatrix {
    n: usize,
    /// Column-major Jacobian.
    jacobian: Vec<f64>,
    /// Diagonal of `M` as numbers.
    mass: Vec<f64>,
    split: Split,
    real: DenseLu,
    complex: ComplexLu,
    /// Multiples of `M` in the two matrices.
    shift: Shift,
    /// Reciprocals of the substituted pivots, real and complex.
    pivots: Vec<f64>,
    pivots_re: Vec<f64>,
    pivots_im: Vec<f64>,
    /// Substituted unknowns while the core is solved: the right side goes by rows, the solution by
    /// columns, and these differ where a pivot is off the diagonal.
    solved_re: Vec<f64>,
    solved_im: Vec<f64>,
    core_re: Vec<f64>,
    core_im: Vec<f64>,
}

/// The multiples of `M`: `real` in the real matrix, `re + i im` in the complex one.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct Shift {
    /// `gamma / h`.
    pub real: f64,
    /// `alpha / h`.
    pub re: f64,
    /// `beta / h`.
    pub im: f64,
}

/// Which rows are substituted, in which order, and what remains.
#[derive(Default)]
struct Split {
    /// Substituted unknowns in order.
    substituted: Vec<Substitution>,
    /// Entries below the substituted pivots, for each substitution in turn.
    couplings: Vec<Coupling>,
    /// Rows and columns of the core that is decomposed.
    rows: Vec<usize>,
    columns: Vec<usize>,
    /// Work: unknowns left in each row and the exclusive-or of their columns.
    unknowns: Vec<usize>,
    which: Vec<usize>,
    row_done: Vec<bool>,
    column_done: Vec<bool>,
}

/// Row `row` determines unknown `column`.
#[derive(Clone, Copy)]
struct Substitution {
    row: usize,
    column: usize,
    /// End of its couplings.
    end: usize,
}

/// The entry `mass * shift - jacobian` of a later row in a substituted column.
#[derive(Clone, Copy)]
struct Coupling {
    row: usize,
    jacobian: f64,
    mass: f64,
}

impl IterationMatrix {
    /// For systems of `n` components.
    pub fn new(n: usize) -> Self {
        IterationMatrix {
            n,
            jacobian: vec![0.0; n * n],
            mass: vec![1.0; n],
            split: Split::new(n),
            real: DenseLu::new(n),
            complex: ComplexLu::new(n),
            shift: Shift::default(),
            pivots: vec![0.0; n],
            pivots_re: vec![0.0; n],
            pivots_im: vec![0.0; n],
            solved_re: vec![0.0; n],
            solved_im: vec![0.0; n],
            core_re: vec![0.0; n],
            core_im: vec![0.0; n],
        }
    }

    /// Takes the diagonal of `M`; true if it changed, which makes `analyze` necessary.
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

    /// The Jacobian to be written by the system, all zeros. Call `analyze` afterwards.
    pub fn jacobian_mut(&mut self) -> &mut [f64] {
        self.jacobian.fill(0.0);
        &mut self.jacobian
    }

    /// Splits rows by the zeros of the new Jacobian. `Err` is the first row that is not finite.
    pub fn analyze(&mut self) -> Result<(), usize> {
        if let Some(entry) = self.jacobian.iter().position(|x| !x.is_finite()) {
            return Err(entry % self.n);
        }
        if self.n == 0 {
            return Ok(());
        }
        self.split.find(self.n, &self.jacobian, &self.mass);
        self.real.set_order(self.split.rows.len());
        self.complex.set_order(self.split.rows.len());
        Ok(())
    }

    /// Decomposes both matrices for this shift; the error names a component.
    pub fn factor(&mut self, shift: Shift) -> Result<(), Singular> {
        self.shift = shift;
        let (n, jacobian, mass, split) = (self.n, &self.jacobian, &self.mass, &self.split);
        for (k, s) in split.substituted.iter().enumerate() {
            let j = jacobian[s.row + n * s.column];
            let m = if s.row == s.column { mass[s.row] } else { 0.0 };
            let real = m * shift.real - j;
            let (re, im) = (m * shift.re - j, m * shift.im);
            if real == 0.0 || (re == 0.0 && im == 0.0) {
                return Err(Singular { column: s.column });
            }
            let modulus = re * re + im * im;
            self.pivots[k] = 1.0 / real;
            self.pivots_re[k] = re / modulus;
            self.pivots_im[k] = -im / modulus;
        }
        let name = |error: Singular| Singular { column: split.columns[error.column] };
        self.real
            .factor_with(|matrix| {
                split.core(n, jacobian, matrix);
                split.add_mass(mass, shift.real, matrix);
            })
            .map_err(name)?;
        self.complex
            .factor_with(|re, im| {
                split.core(n, jacobian, re);
                im.fill(0.0);
                split.add_mass(mass, shift.re, re);
                split.add_mass(mass, shift.im, im);
            })
            .map_err(name)
    }

    /// Solves with the real matrix, in place.
    pub fn solve_real(&mut self, b: &mut [f64]) {
        let split = &self.split;
        if split.substituted.is_empty() {
            return self.real.solve_in_place(b);
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
        self.real.solve_in_place(core);
        scatter(&split.columns, core, b);
        for (s, x) in split.substituted.iter().zip(&self.solved_re) {
            b[s.column] = *x;
        }
    }

    /// Solves with the complex matrix, in place.
    pub fn solve_complex(&mut self, b_re: &mut [f64], b_im: &mut [f64]) {
        let split = &self.split;
        if split.substituted.is_empty() {
            return self.complex.solve_in_place(b_re, b_im);
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
        self.complex.solve_in_place(core_re, core_im);
        scatter(&split.columns, core_re, b_re);
        scatter(&split.columns, core_im, b_im);
        for (k, s) in split.substituted.iter().enumerate() {
            b_re[s.column] = self.solved_re[k];
            b_im[s.column] = self.solved_im[k];
        }
    }
}

impl Split {
    fn new(n: usize) -> Self {
        Split {
            substituted: Vec::with_capacity(n),
            couplings: Vec::with_capacity(n * n),
            rows: Vec::with_capacity(n),
            columns: Vec::with_capacity(n),
            unknowns: vec![0; n],
            which: vec![0; n],
            row_done: vec![false; n],
            column_done: vec![false; n],
        }
    }

    /// Repeatedly takes a row that has a single unknown left.
    fn find(&mut self, n: usize, jacobian: &[f64], mass: &[f64]) {
        self.substituted.clear();
        self.couplings.clear();
        self.unknowns.fill(0);
        self.which.fill(0);
        self.row_done.fill(false);
        self.column_done.fill(false);
        for (j, column) in jacobian.chunks_exact(n).enumerate() {
            for (i, value) in column.iter().enumerate() {
                if *value != 0.0 || (i == j && mass[i] != 0.0) {
                    self.unknowns[i] += 1;
                    self.which[i] ^= j;
                }
            }
        }
        while let Some(row) = (0..n).find(|&i| self.unknowns[i] == 1) {
            let column = self.which[row];
            self.row_done[row] = true;
            self.column_done[column] = true;
            for i in 0..n {
                let value = jacobian[i + n * column];
                let m = if i == column { mass[i] } else { 0.0 };
                if value != 0.0 || m != 0.0 {
                    self.unknowns[i] -= 1;
                    self.which[i] ^= column;
                    if !self.row_done[i] {
                        self.couplings.push(Coupling { row: i, jacobian: value, mass: m });
                    }
                }
            }
            self.substituted.push(Substitution { row, column, end: self.couplings.len() });
        }
        self.rows.clear();
        self.rows.extend((0..n).filter(|&i| !self.row_done[i]));
        self.columns.clear();
        self.columns.extend((0..n).filter(|&j| !self.column_done[j]));
    }

    /// Copies `-J` restricted to the core.
    fn core(&self, n: usize, jacobian: &[f64], matrix: &mut [f64]) {
        let order = self.rows.len();
        if order == n {
            for (to, from) in matrix.iter_mut().zip(jacobian) {
                *to = -from;
            }
            return;
        }
        if order == 0 {
            return;
        }
        for (to, &j) in matrix.chunks_exact_mut(order).zip(&self.columns) {
            let from = &jacobian[n * j..n * (j + 1)];
            for (to, &i) in to.iter_mut().zip(&self.rows) {
                *to = -from[i];
            }
        }
    }

    /// Adds `shift` where a row of the core meets its own column.
    fn add_mass(&self, mass: &[f64], shift: f64, matrix: &mut [f64]) {
        let order = self.rows.len();
        let mut a = 0;
        for (b, &j) in self.columns.iter().enumerate() {
            while a < order && self.rows[a] < j {
                a += 1;
            }
            if a < order && self.rows[a] == j {
                matrix[a + order * b] += mass[j] * shift;
            }
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

    /// Solves with `J` and `M` and checks the residual of both systems.
    fn check(n: usize, jacobian: &[f64], differential: &[bool], substituted: usize) {
        let mut matrix = IterationMatrix::new(n);
        matrix.set_mass(differential);
        matrix.jacobian_mut().copy_from_slice(jacobian);
        matrix.analyze().unwrap();
        assert_eq!(matrix.split.substituted.len(), substituted);
        let shift = Shift { real: 3.0, re: 2.0, im: 5.0 };
        matrix.factor(shift).unwrap();

        let b: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
        let c: Vec<f64> = (0..n).map(|i| 2.0 - 0.5 * i as f64).collect();
        let mut x = b.clone();
        matrix.solve_real(&mut x);
        let (mut p, mut q) = (b.clone(), c.clone());
        matrix.solve_complex(&mut p, &mut q);
        for i in 0..n {
            let m = if differential[i] { 1.0 } else { 0.0 };
            let row = |v: &[f64]| (0..n).map(|j| jacobian[i + n * j] * v[j]).sum::<f64>();
            let real = m * shift.real * x[i] - row(&x) - b[i];
            let re = m * (shift.re * p[i] - shift.im * q[i]) - row(&p) - b[i];
            let im = m * (shift.re * q[i] + shift.im * p[i]) - row(&q) - c[i];
            assert!(real.abs().max(re.abs()).max(im.abs()) < 1e-13, "{real} {re} {im}");
        }
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
