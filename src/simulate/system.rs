//! A running program as the integrator sees it.

use crate::codegen::interp::{Fault, Instance};
use crate::integrate::system::{EvalError, System};
use crate::ir::program::Program;

/// The derivatives of the states. A model without states has one that rests, so that events of its
/// algebraic variables are found by the same loop.
pub struct Model<'p> {
    /// The run.
    pub instance: Instance<'p>,
    differential: Vec<bool>,
    moved: Vec<f64>,
    base: Vec<f64>,
    slope: Vec<f64>,
}

impl<'p> Model<'p> {
    /// A run that has not begun.
    pub fn new(program: &'p Program) -> Self {
        let n = program.order().max(1);
        let zeros = || vec![0.0; n];
        Model {
            instance: Instance::new(program),
            differential: vec![true; n],
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

    /// Replaces column `j` of the Jacobian by a one-sided difference: where the exact derivative is
    /// infinite, as that of a root at zero.
    fn difference(
        &mut self,
        t: f64,
        y: &[f64],
        column: usize,
        out: &mut [f64],
    ) -> Result<(), Fault> {
        let n = self.instance.program.order();
        self.moved.copy_from_slice(y);
        let h = f64::EPSILON.sqrt() * y[column].abs().max(1e-3);
        self.instance.derivatives(t, &y[..n], &mut self.base[..n])?;
        for step in [h, -h] {
            self.moved[column] = y[column] + step;
            let moved = &self.moved[..n];
            if self.instance.derivatives(t, moved, &mut self.slope[..n]).is_ok() {
                for (i, d) in out.iter_mut().enumerate().take(n) {
                    *d = (self.slope[i] - self.base[i]) / step;
                }
                return Ok(());
            }
        }
        out.fill(0.0);
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
        self.instance.place(t, &y[..n]);
        self.instance.run(&program.rhs).map_err(recoverable)?;
        // A torn block whose derivative does not exist is no reason to fail: differences do.
        let exact = self.instance.run(&program.jacobian).is_ok();
        for e in &program.jacobian_entries {
            let value = if exact { self.instance.get(e.slot) } else { f64::NAN };
            j[e.row as usize + dim * e.column as usize] = value;
        }
        for column in 0..n {
            let range = column * dim..(column + 1) * dim;
            if j[range.clone()].iter().any(|d| !d.is_finite()) {
                self.difference(t, y, column, &mut j[range]).map_err(recoverable)?;
            }
        }
        Ok(())
    }
}

/// The fault itself stays with the instance.
fn recoverable(_: Fault) -> EvalError {
    EvalError::Recoverable(0)
}
