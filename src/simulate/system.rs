//! A running program as the integrator sees it.

use crate::integrate::system::{EvalError, System};
use crate::ir::program::{Entry, Program, Watch};
use crate::numeric::pattern::Pattern;
use crate::runtime::machine::{Fault, Instance};

use super::event::sliding::Sliding;

/// The derivatives of the states, and the residuals of the loops that are left to the integrator. A
/// model without states has one that rests, so that events of its algebraic variables are found by
/// the same loop.
pub struct Model<'p> {
    /// The run.
    pub instance: Instance<'p>,
    /// Since this was reset, a function was evaluated beyond its domain.
    pub beyond: bool,
    /// Nothing is evaluated beyond its domain.
    pub strict: bool,
    /// The surface that the solution stays on, if any.
    pub sliding: Option<Sliding>,
    differential: Vec<bool>,
    pattern: Pattern,
    /// Relations that are searched on the trajectory.
    watched: Vec<u32>,
    looks: Looks,
    /// For each entry of the program its place in the pattern.
    places: Vec<usize>,
    moved: Vec<f64>,
    base: Vec<f64>,
    slope: Vec<f64>,
}

/// The last evaluations of derivatives, with whether a searched relation differed from its held value.
#[derive(Default)]
struct Looks {
    /// As many as a step of Radau IIA makes after its last iteration began: three stages, the error
    /// estimate, and the end.
    recent: [(f64, bool); 5],
    next: usize,
    /// The memory is as the last one left it.
    standing: bool,
}

impl Looks {
    fn note(&mut self, t: f64, switched: bool) {
        self.recent[self.next] = (t, switched);
        self.next = (self.next + 1) % self.recent.len();
        self.standing = true;
    }
}

fn watched(program: &Program) -> Vec<u32> {
    let count = program.watches.len() as u32;
    (0..count).filter(|k| program.watches[*k as usize] == Watch::State).collect()
}

impl<'p> Model<'p> {
    /// A run that has not begun.
    pub fn new(program: &'p Program) -> Self {
        let (states, order) = (program.blocks.states.len(), program.order());
        let n = order.max(1);
        let zeros = || vec![0.0; n];
        let position = |e: &Entry| (e.row as usize, e.column as usize);
        let entries: Vec<_> = program.jacobian_entries.iter().map(position).collect();
        let pattern = Pattern::from_entries(n, n, &entries);
        let places = entries.iter().filter_map(|&(i, j)| pattern.position(i, j)).collect();
        Model {
            instance: Instance::new(program),
            beyond: false,
            strict: false,
            sliding: None,
            differential: (0..n).map(|i| !(states..order).contains(&i)).collect(),
            pattern,
            watched: watched(program),
            looks: Looks::default(),
            places,
            moved: zeros(),
            base: zeros(),
            slope: zeros(),
        }
    }

    /// An instant in the second half of a step before which the integrator looked at searched
    /// relations and found none switched, if it looked into both halves: at the stages of a Runge-Kutta
    /// method relations cost next to nothing.
    pub fn quiet_until(&self, t0: f64, t1: f64) -> Option<f64> {
        let middle = 0.5 * (t0 + t1);
        let inside = || self.looks.recent.iter().filter(|look| t0 < look.0 && look.0 < t1);
        let latest = inside().map(|look| look.0).fold(t0, f64::max);
        let quiet = inside().all(|look| !look.1) && inside().any(|look| look.0 <= middle);
        (quiet && latest > middle).then_some(latest)
    }

    /// True if searched relations in the memory are those at `(t, y)`.
    pub fn stands_at(&self, t: f64, y: &[f64]) -> bool {
        let instance = &self.instance;
        self.looks.standing
            && instance.get(instance.program.layout.time) == t
            && instance.states() == &y[..instance.program.order()]
    }

    /// Evaluates searched relations where the derivatives were evaluated last.
    fn look(&mut self, t: f64) {
        let program = self.instance.program;
        if self.beyond || self.sliding.is_some() || self.instance.run(&program.roots).is_err() {
            return self.looks = Looks::default();
        }
        let (fresh, held) = (program.layout.fresh, program.layout.relations);
        let switched = |k: &u32| self.instance.get(fresh + k) != self.instance.get(held + k);
        let switched = self.watched.iter().any(switched);
        self.looks.note(t, switched);
    }

    /// Everything at `(t, y)`, relations held.
    pub fn evaluate_all(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        self.looks.standing = false;
        if let Some(sliding) = &mut self.sliding {
            let n = self.instance.program.order();
            return sliding.evaluate_all(&mut self.instance, t, &y[..n]);
        }
        let program = self.instance.program;
        self.evaluate_roots(t, y)?;
        self.instance.run(&program.rest)
    }

    /// Derivatives, searched relations and assertions at `(t, y)`.
    pub fn evaluate_roots(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        self.looks.standing = false;
        let program = self.instance.program;
        self.instance.place(t, &y[..program.order()]);
        self.instance.run(&program.rhs)?;
        self.instance.run(&program.roots)
    }

    /// As [`Model::evaluate_all`], beyond the domain of functions too.
    pub fn evaluate_all_beyond(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        self.instance.inside = true;
        let outcome = self.evaluate_all(t, y);
        self.instance.inside = false;
        outcome
    }

    /// As [`Model::evaluate_roots`], beyond the domain of functions if the step went there.
    pub fn evaluate_roots_beyond(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        let outcome = self.evaluate_roots(t, y);
        let layout = &self.instance.program.layout;
        let count = self.instance.program.watches.len() as u32;
        let gaps = (0..count).map(|k| self.instance.get(layout.gaps + k));
        let fine = match outcome {
            Ok(()) => !self.beyond || gaps.into_iter().all(|gap| !gap.is_nan()),
            Err(fault) => self.strict || !of_domain(fault),
        };
        if fine {
            return outcome;
        }
        self.beyond = true;
        self.instance.inside = true;
        let outcome = self.evaluate_roots(t, y);
        self.instance.inside = false;
        outcome
    }

    /// True if the derivatives at `(t, y)` exist.
    pub fn is_inside(&mut self, t: f64, y: &[f64]) -> bool {
        self.looks.standing = false;
        let n = self.instance.program.order();
        self.instance.derivatives(t, &y[..n], &mut self.slope[..n]).is_ok()
    }

    /// Runs the tape of the Jacobian; false if a torn block has no derivative there. That is no reason
    /// to fail: differences do.
    fn differentiate(&mut self, t: f64, y: &[f64]) -> Result<bool, EvalError> {
        self.looks.standing = false;
        let program = self.instance.program;
        let n = program.order();
        self.instance.place(t, &y[..n]);
        if let Err(fault) = self.instance.run(&program.rhs) {
            let Model { instance, beyond, strict, base, .. } = self;
            derivatives(instance, beyond, *strict || !of_domain(fault), t, &y[..n], &mut base[..n])
                .map_err(recoverable)?;
        }
        Ok(self.instance.run(&program.jacobian).is_ok())
    }

    /// Writes a column of the Jacobian as one-sided difference quotients to `slope`, for where the exact
    /// derivative is infinite, as that of a root at zero.
    fn difference(&mut self, t: f64, y: &[f64], column: usize) -> Result<(), Fault> {
        let n = self.instance.program.order();
        self.moved.copy_from_slice(y);
        let h = f64::EPSILON.sqrt() * y[column].abs().max(1e-3);
        let Model { instance, beyond, strict, base, slope, moved, .. } = self;
        derivatives(instance, beyond, *strict, t, &y[..n], &mut base[..n])?;
        for step in [h, -h] {
            moved[column] = y[column] + step;
            if instance.derivatives(t, &moved[..n], &mut slope[..n]).is_ok() {
                for (slope, base) in slope.iter_mut().zip(&*base).take(n) {
                    *slope = (*slope - base) / step;
                }
                return Ok(());
            }
        }
        slope.fill(0.0);
        Ok(())
    }
}

impl Model<'_> {
    /// The Jacobian by one-sided differences.
    fn differences(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        let (n, dim) = (self.instance.program.order(), self.dim());
        let (mut base, mut slope) = (vec![0.0; dim], vec![0.0; dim]);
        let mut moved = y.to_vec();
        self.rhs(t, y, &mut base)?;
        for column in 0..n {
            let h = f64::EPSILON.sqrt() * y[column].abs().max(1e-3);
            moved[column] = y[column] + h;
            self.rhs(t, &moved, &mut slope)?;
            moved[column] = y[column];
            for i in 0..n {
                j[i + dim * column] = (slope[i] - base[i]) / h;
            }
        }
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
        if let Some(sliding) = &mut self.sliding {
            let slid = sliding.derivatives(&mut self.instance, t, &y[..n], &mut f[..n]);
            return slid.map_err(recoverable);
        }
        self.looks.standing = false;
        derivatives(&mut self.instance, &mut self.beyond, self.strict, t, &y[..n], &mut f[..n])
            .map_err(recoverable)?;
        self.look(t);
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        let program = self.instance.program;
        let (n, dim) = (program.order(), self.dim());
        if self.sliding.is_some() {
            return self.differences(t, y, j);
        }
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
        // On a sliding surface this is the Jacobian beside it: near enough for Newton's method.
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

/// The derivatives, beyond the domain of functions where nothing else is possible: while a relation
/// is held its branch must go on a little beyond the point at which it switches.
fn derivatives(
    instance: &mut Instance<'_>,
    beyond: &mut bool,
    strict: bool,
    t: f64,
    states: &[f64],
    out: &mut [f64],
) -> Result<(), Fault> {
    match instance.derivatives(t, states, out) {
        Err(fault) if !strict && of_domain(fault) => {
            *beyond = true;
            instance.inside = true;
            let outcome = instance.derivatives(t, states, out);
            instance.inside = false;
            outcome
        }
        outcome => outcome,
    }
}

/// True for a fault that moving arguments into their domain may cure.
pub fn of_domain(fault: Fault) -> bool {
    matches!(fault, Fault::Derivative { .. } | Fault::NotFinite { .. })
}

/// The fault itself stays with the instance.
fn recoverable(_: Fault) -> EvalError {
    EvalError::Recoverable(0)
}
