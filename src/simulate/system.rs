//! A running program as the integrator sees it.

use crate::codegen::interp::{Fault, Instance};
use crate::integrate::system::{EvalError, System};
use crate::ir::program::{Entry, Program};
use crate::math::numeric::pattern::Pattern;

/// The derivatives of the states. A model without states has one that rests, so that events of its
/// algebraic variables are found by the same loop.
pub struct Model<'p> {
    /// The run.
    pub instance: Instance<'p>,
    differential: Vec<bool>,
    pattern: Pattern,
    /// For each entry of the program its place in the pattern.
    places: Vec<usize>,
    moved: Vec<f64>,
    base: Vec<f64>,
    slope: Vec<f64>,
}

impl<'p> Model<'p> {
    /// A run that has not begun.
    pub fn new(program: &'p Program) -> Self {
        let n = program.order().max(1);
        let zeros = || vec![0.0; n];
        let position = |e: &Entry| (e.row as usize, e.column as usize);
        let entries: Vec<_> = program.jacobian_entries.iter().map(position).collect();
        let pattern = Pattern::from_entries(n, n, &entries);
        let places = entries.iter().filter_map(|&(i, j)| pattern.position(i, j)).collect();
        Model {
            instance: Instance::new(program),
            differential: vec![true; n],
            pattern,
            places,
            moved: zeros(),
            base: zeros(),
            slope: zeros(),
        }
    }

    /// Everything at `(t, y)`, relations held.
    pub fn evaluate_all(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        self.evaluate_roots(t, y)?;
        self.instance.run(&self.instance.program.rest)
    }

    /// Derivatives, searched relations and assertions at `(t, y)`.
    pub fn evaluate_roots(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        let program = self.instance.program;
        self.instance.place(t, &y[..program.order()]);
        self.instance.run(&program.rhs)?;
        self.instance.run(&program.roots)
    }

    /// Runs the tape of the Jacobian; false if a torn block has no derivative there. That is no reason
    /// to fail: differences do.
    fn differentiate(&mut self, t: f64, y: &[f64]) -> Result<bool, EvalError> {
        let program = self.instance.program;
        self.instance.place(t, &y[..program.order()]);
        self.instance.run(&program.rhs).map_err(recoverable)?;
        Ok(self.instance.run(&program.jacobian).is_ok())
    }

    /// Writes a column of the Jacobian as one-sided difference quotients to `slope`, for where the exact
    /// derivative is infinite, as that of a root at zero.
    fn difference(&mut self, t: f64, y: &[f64], column: usize) -> Result<(), Fault> {
        let n = self.instance.program.order();
        self.moved.copy_from_slice(y);
        let h = f64::EPSILON.sqrt() * y[column].abs().max(1e-3);
        self.instance.derivatives(t, &y[..n], &mut self.base[..n])?;
        for step in [h, -h] {
            self.moved[column] = y[column] + step;
            let moved = &self.moved[..n];
            if self.instance.derivatives(t, moved, &mut self.slope[..n]).is_ok() {
                for (slope, base) in self.slope.iter_mut().zip(&self.base).take(n) {
                    *slope = (*slope - base) / step;
                }
                return Ok(());
            }
        }
        self.slope.fill(0.0);
        Ok(())
    }
}

impl System for Model<'_> {
    fn dim(&self) -> usize {
        self.differential.len()
    }

    fn differential(&self) -> &[bool] {
        &self.differential
    }

    fn rhs(&mut self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        let n = self.instance.program.order();
        f[n..].fill(0.0);
        self.instance.derivatives(t, &y[..n], &mut f[..n]).map_err(recoverable)
    }

    fn jacobian(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        let program = self.instance.program;
        let (n, dim) = (program.order(), self.dim());
        let exact = self.differentiate(t, y)?;
        for e in &program.jacobian_entries {
            let value = if exact { self.instance.get(e.slot) } else { f64::NAN };
            j[e.row as usize + dim * e.column as usize] = value;
        }
        for column in 0..n {
            let range = column * dim..(column + 1) * dim;
            if j[range.clone()].iter().any(|d| !d.is_finite()) {
                self.difference(t, y, column).map_err(recoverable)?;
                j[range].copy_from_slice(&self.slope);
            }
        }
        Ok(())
    }

    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.pattern)
    }

    fn jacobian_entries(&mut self, t: f64, y: &[f64], values: &mut [f64]) -> Result<(), EvalError> {
        let program = self.instance.program;
        let exact = self.differentiate(t, y)?;
        for (e, &place) in program.jacobian_entries.iter().zip(&self.places) {
            values[place] = if exact { self.instance.get(e.slot) } else { f64::NAN };
        }
        for column in 0..program.order() {
            let starts = self.pattern.column_starts();
            let range = starts[column]..starts[column + 1];
            if values[range.clone()].iter().any(|d| !d.is_finite()) {
                self.difference(t, y, column).map_err(recoverable)?;
                let rows = self.pattern.column(column);
                for (value, &i) in values[range].iter_mut().zip(rows) {
                    *value = self.slope[i];
                }
            }
        }
        Ok(())
    }
}

/// The fault itself stays with the instance.
fn recoverable(_: Fault) -> EvalError {
    EvalError::Recoverable(0)
}
