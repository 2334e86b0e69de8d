//! Torn blocks at run time.
//!
//! Linear blocks are solved from zero, so that the result depends on nothing but the inputs;
//! nonlinear ones start from their last solution and iterate down to rounding errors. Where linear
//! equations depend on each other and do not contradict, what they leave open stays as it was.

use crate::ir::program::{Implicit, Solver};
use crate::numeric::linear::DenseLu;
use crate::numeric::newton::{Newton, NewtonOutcome, NewtonSettings, NonlinearSystem, Region};
use crate::numeric::pseudo_inverse::PseudoInverse;

use super::machine::{Fault, Instance};

/// The memory of a torn block.
pub struct SolverWork {
    method: Method,
    z: Vec<f64>,
    start: Vec<f64>,
    nominal: Vec<f64>,
    bounds: Vec<(f64, f64)>,
}

enum Method {
    Linear(Linear),
    Newton(Newton),
}

/// The last matrix of a linear block with its factors: most matrices change at events only.
struct Linear {
    lu: DenseLu,
    matrix: Vec<f64>,
    factored: Vec<f64>,
    valid: bool,
    /// In place of factors where the matrix has not got them, and the unknown that it leaves open, for the message.
    singular: Option<(PseudoInverse, usize)>,
    /// There are factors, if only by rounding.
    has_factors: bool,
    /// The matrix was singular before: a pivot that rounding leaves over is none.
    deficient: bool,
    last: Vec<f64>,
    right: Vec<f64>,
}

/// A pivot that is left over by rounding is this part of its column at most.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl SolverWork {
    /// Memory for this block.
    pub fn new(solver: &Solver) -> Self {
        let n = solver.unknowns.len();
        let method = if solver.linear {
            let zeros = || vec![0.0; n * n];
            let lu = DenseLu::new(n);
            Method::Linear(Linear {
                lu,
                matrix: zeros(),
                factored: zeros(),
                valid: false,
                singular: None,
                has_factors: false,
                deficient: false,
                last: vec![0.0; n],
                right: vec![0.0; n],
            })
        } else {
            Method::Newton(Newton::new(n))
        };
        SolverWork {
            method,
            z: vec![0.0; n],
            start: vec![0.0; n],
            nominal: vec![1.0; n],
            bounds: vec![(0.0, 0.0); n],
        }
    }

    /// Solves block `k` and leaves all its variables in the memory.
    pub fn solve(&mut self, instance: &mut Instance<'_>, k: usize) -> Result<(), Fault> {
        let solver = &instance.program.solvers[k];
        match &mut self.method {
            Method::Linear(linear) => linear.solve(instance, k, &mut self.z)?,
            Method::Newton(newton) => {
                for (j, slot) in solver.slots.iter().enumerate() {
                    self.z[j] = instance.get(*slot);
                    self.start[j] = self.z[j];
                    let size = instance.get(solver.nominals[j]).abs();
                    self.nominal[j] = if size > 0.0 && size.is_finite() { size } else { 1.0 };
                    let (min, max) = solver.bounds[j];
                    self.bounds[j] = (instance.get(min), instance.get(max));
                }
                let bounded = self.bounds.iter().any(|(a, b)| a.is_finite() || b.is_finite());
                let bounds = bounded.then_some(&self.bounds[..]);
                let mut region = Region { nominal: &self.nominal, bounds };
                let mut equations = BlockEquations { instance, solver: k, fault: None };
                let settings = NewtonSettings::default();
                let mut ending = newton.solve(&mut equations, &mut self.z, region, &settings);
                if bounded && !matches!(ending, NewtonOutcome::Converged { .. }) {
                    // Bounds lead away from what makes no sense; that nothing lies beyond them is for
                    // assertions to say.
                    region.bounds = None;
                    ending = newton.solve(&mut equations, &mut self.z, region, &settings);
                }
                let leaps = equations.instance.leaps;
                if leaps && self.z.len() == 1 && !matches!(ending, NewtonOutcome::Converged { .. })
                {
                    // The branch that the solution was on may have come to its end.
                    let found = other_branch(&mut equations, self.start[0], self.nominal[0]);
                    // Without one the message is about where the iteration came to from the start.
                    self.z[0] = found.unwrap_or(self.start[0]);
                    region.bounds = None;
                    ending = newton.solve(&mut equations, &mut self.z, region, &settings);
                }
                if leaps && self.z.len() > 1 && !matches!(ending, NewtonOutcome::Converged { .. }) {
                    region.bounds = None;
                    ending =
                        elsewhere(newton, &mut equations, &mut self.z, &self.start, region, ending);
                }
                let fault = equations.fault;
                judge(ending, k, fault)?;
            }
        }
        // The explicit part at the solution.
        for (slot, z) in solver.slots.iter().zip(&self.z) {
            instance.set(*slot, *z);
        }
        instance.run(&solver.residual_tape)
    }
}

/// The root of one equation in one unknown that is nearest to `start`, by a search outwards for a
/// change of sign and bisection. A jump or a pole changes sign too and is no root.
fn other_branch(equations: &mut BlockEquations<'_, '_>, start: f64, nominal: f64) -> Option<f64> {
    let mut value = |z: f64| {
        let mut g = [0.0];
        (equations.residual(&[z], &mut g) && g[0].is_finite()).then_some(g[0])
    };
    let centre = value(start)?;
    let mut sides = [(start, centre), (start, centre)];
    for k in 0..DOUBLINGS {
        let step = FIRST_STEP * nominal * f64::exp2(f64::from(k));
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            let z = start + sign * step;
            let Some(g) = value(z) else { continue };
            let before = std::mem::replace(side, (z, g));
            if before.1.signum() != g.signum() {
                let (mut a, mut b) = (before, (z, g));
                let size = a.1.abs().max(b.1.abs());
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (a.0 + b.0);
                    let Some(g) = value(middle) else { break };
                    let end = if g.signum() == a.1.signum() { &mut a } else { &mut b };
                    *end = (middle, g);
                }
                let (z, g) = if a.1.abs() < b.1.abs() { a } else { b };
                if g.abs() <= 1e-6 * size {
                    return Some(z);
                }
            }
        }
    }
    None
}

/// Newton's method from points around `start`, one unknown displaced at a time, the nearest first;
/// how it ended at last.
fn elsewhere(
    newton: &mut Newton,
    equations: &mut BlockEquations<'_, '_>,
    z: &mut [f64],
    start: &[f64],
    region: Region<'_>,
    failed: NewtonOutcome,
) -> NewtonOutcome {
    let settings = NewtonSettings::default();
    if z.len() > MOST_UNKNOWNS {
        return failed;
    }
    for k in 0..DISPLACEMENTS {
        let size = FIRST_DISPLACEMENT * DISPLACEMENT_GROWTH.powi(k);
        for j in 0..z.len() {
            for sign in [1.0, -1.0] {
                z.copy_from_slice(start);
                z[j] += sign * size * region.nominal[j];
                let ending = newton.solve(equations, z, region, &settings);
                if matches!(ending, NewtonOutcome::Converged { .. }) {
                    return ending;
                }
            }
        }
    }
    z.copy_from_slice(start);
    let _ = newton.solve(equations, z, region, &settings);
    failed
}

/// Larger blocks are not searched for other branches.
const MOST_UNKNOWNS: usize = 12;
/// How far unknowns are displaced at first, in their typical sizes.
const FIRST_DISPLACEMENT: f64 = 1e-3;
/// How often they are displaced further, and by which factor.
const DISPLACEMENTS: i32 = 8;
/// See [`DISPLACEMENTS`].
const DISPLACEMENT_GROWTH: f64 = 8.0;

/// First step of the search for another branch, in typical sizes of the unknown.
const FIRST_STEP: f64 = 1e-6;
/// How often that step is doubled.
const DOUBLINGS: u32 = 60;
/// Bisections until nothing changes any more.
const BISECTIONS: u32 = 100;

impl SolverWork {
    /// After a failure: the next attempt starts from the last solution, not from where this one got
    /// lost.
    pub fn restore(&self, solver: &Solver, memory: &mut [f64]) {
        if let Method::Newton(_) = self.method {
            for (slot, z) in solver.slots.iter().zip(&self.start) {
                memory[*slot as usize] = *z;
            }
        }
    }
}

fn judge(ending: NewtonOutcome, solver: usize, inner: Option<Fault>) -> Result<(), Fault> {
    match ending {
        NewtonOutcome::Converged { .. } => Ok(()),
        NewtonOutcome::Singular { column } => Err(Fault::Singular { solver, unknown: column }),
        NewtonOutcome::Diverged { component } => {
            Err(Fault::Diverged { solver, unknown: component })
        }
        NewtonOutcome::NonFinite { residual } => {
            Err(inner.unwrap_or(Fault::NotFinite { solver, residual }))
        }
    }
}

impl Linear {
    /// `J z = -r(0)`
    fn solve(&mut self, instance: &mut Instance<'_>, k: usize, z: &mut [f64]) -> Result<(), Fault> {
        let solver = &instance.program.solvers[k];
        let n = solver.unknowns.len();
        for (slot, last) in solver.slots.iter().zip(&mut self.last) {
            *last = instance.get(*slot);
            if !last.is_finite() {
                *last = 0.0;
            }
            instance.set(*slot, 0.0);
        }
        let outcome = self.solve_from_zero(instance, k, n, z);
        if outcome.is_err() {
            for (slot, last) in solver.slots.iter().zip(&self.last) {
                instance.set(*slot, *last);
            }
        }
        outcome
    }

    fn solve_from_zero(
        &mut self,
        instance: &mut Instance<'_>,
        k: usize,
        n: usize,
        z: &mut [f64],
    ) -> Result<(), Fault> {
        let solver = &instance.program.solvers[k];
        instance.run(&solver.residual_tape)?;
        instance.run(&solver.jacobian_tape)?;
        for (i, slot) in solver.residuals.iter().enumerate() {
            z[i] = -instance.get(*slot);
            if !z[i].is_finite() {
                return Err(Fault::NotFinite { solver: k, residual: i });
            }
        }
        if n == 1 {
            let pivot = solver.jacobian.first().map_or(0.0, |e| instance.get(e.slot));
            if pivot != 0.0 && pivot.is_finite() {
                z[0] /= pivot;
                return Ok(());
            }
        }
        self.matrix.fill(0.0);
        for e in &solver.jacobian {
            self.matrix[e.row as usize + n * e.column as usize] = instance.get(e.slot);
        }
        let same = self.valid
            && self.matrix.iter().zip(&self.factored).all(|(a, b)| a.to_bits() == b.to_bits());
        if !same {
            self.valid = false;
            self.singular = None;
            let factored = self.lu.factor(&self.matrix);
            self.deficient |= factored.is_err();
            if self.deficient
                && (factored.is_err() || self.lu.weakest_pivot(&self.matrix) <= ROUNDING)
            {
                let inverse = PseudoInverse::new(n, &self.matrix);
                self.singular = inverse
                    .filter(|i| factored.is_err() || i.rank() < n)
                    .map(|i| (i, factored.as_ref().map_or_else(|s| s.column, |()| n - 1)));
                if let (Err(s), None) = (&factored, &self.singular) {
                    return Err(Fault::Singular { solver: k, unknown: s.column });
                }
            }
            self.has_factors = factored.is_ok();
            self.factored.copy_from_slice(&self.matrix);
            self.valid = true;
        }
        let Some((singular, unknown)) = &self.singular else {
            self.lu.solve_in_place(z);
            return Ok(());
        };
        self.right.copy_from_slice(z);
        if singular.solve_near(z, &self.last) {
            instance.undetermined.get_or_insert((k, *unknown));
        } else {
            if self.has_factors {
                z.copy_from_slice(&self.right);
                self.lu.solve_in_place(z);
                if z.iter().all(|x| x.is_finite()) {
                    return Ok(());
                }
            }
            // On the way to what relations will be it does as it can.
            if !instance.relaxed {
                return Err(Fault::Singular { solver: k, unknown: *unknown });
            }
            instance.moved = true;
        }
        Ok(())
    }
}

/// A nonlinear block as Newton's method sees it.
struct BlockEquations<'a, 'p> {
    instance: &'a mut Instance<'p>,
    solver: usize,
    fault: Option<Fault>,
}

impl BlockEquations<'_, '_> {
    fn put(&mut self, z: &[f64]) -> bool {
        let solver = &self.instance.program.solvers[self.solver];
        for (slot, z) in solver.slots.iter().zip(z) {
            self.instance.set(*slot, *z);
        }
        self.fault = self.instance.run(&solver.residual_tape).err();
        self.fault.is_none()
    }
}

impl NonlinearSystem for BlockEquations<'_, '_> {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) -> bool {
        if !self.put(z) {
            return false;
        }
        let solver = &self.instance.program.solvers[self.solver];
        for (g, slot) in g.iter_mut().zip(&solver.residuals) {
            *g = self.instance.get(*slot);
        }
        true
    }

    fn jacobian(&mut self, z: &[f64], j: &mut [f64]) -> bool {
        if !self.put(z) {
            return false;
        }
        let solver = &self.instance.program.solvers[self.solver];
        self.fault = self.instance.run(&solver.jacobian_tape).err();
        for e in &solver.jacobian {
            j[e.row as usize + z.len() * e.column as usize] = self.instance.get(e.slot);
        }
        self.fault.is_none()
    }
}

/// The memory of the derivative of a torn block.
pub struct ImplicitWork {
    lu: DenseLu,
    /// The matrix was singular before: a pivot that rounding leaves over is none.
    deficient: bool,
    matrix: Vec<f64>,
    columns: Vec<f64>,
}

impl ImplicitWork {
    /// Memory for this block.
    pub fn new(implicit: &Implicit) -> Self {
        let n = implicit.order;
        ImplicitWork {
            lu: DenseLu::new(n),
            deficient: false,
            matrix: vec![0.0; n * n],
            columns: vec![0.0; implicit.results.len()],
        }
    }

    /// `J dz = -B`
    pub fn differentiate(&mut self, implicit: &Implicit, memory: &mut [f64]) -> Result<(), Fault> {
        let n = implicit.order;
        self.matrix.fill(0.0);
        self.columns.fill(0.0);
        for e in &implicit.jacobian {
            self.matrix[e.row as usize + n * e.column as usize] = memory[e.slot as usize];
        }
        for e in &implicit.seeds {
            self.columns[e.row as usize + n * e.column as usize] = -memory[e.slot as usize];
        }
        let factored = self.lu.factor(&self.matrix);
        self.deficient |= factored.is_err();
        let regular =
            factored.is_ok() && (!self.deficient || self.lu.weakest_pivot(&self.matrix) > ROUNDING);
        if regular {
            for column in self.columns.chunks_exact_mut(n) {
                self.lu.solve_in_place(column);
            }
        } else {
            // What the equations leave open does not move.
            let unknown = factored.map_or_else(|s| s.column, |()| n - 1);
            let fault = Fault::Singular { solver: implicit.solver as usize, unknown };
            let inverse = PseudoInverse::new(n, &self.matrix).ok_or(fault)?;
            for column in self.columns.chunks_exact_mut(n) {
                inverse.solve_in_place(column);
            }
        }
        for (slot, value) in implicit.results.iter().zip(&self.columns) {
            memory[*slot as usize] = *value;
        }
        Ok(())
    }
}
