//! Solves torn blocks.
//!
//! Linear blocks are solved from zero, so that the result depends on the inputs only; nonlinear
//! ones start from their last solution and iterate to rounding error. If linear equations are
//! dependent but consistent, the undetermined unknowns keep their values.

use crate::ir::program::{BlockDerivative, TornBlock};
use crate::numeric::linear::DenseLu;
use crate::numeric::newton::{Newton, NewtonOutcome, NewtonSettings, NonlinearSystem, Region};
use crate::numeric::pseudo_inverse::PseudoInverse;

use super::block_matrix::SparseBlock;
use super::far_solution::FarSolution;
use super::machine::{Fault, Machine};

/// Working memory for a torn block.
pub struct TornBlockSolver {
    method: BlockMethod,
    z: Vec<f64>,
    start: Vec<f64>,
    nominal: Vec<f64>,
    bounds: Vec<(f64, f64)>,
}

enum BlockMethod {
    Linear(Linear),
    Newton(Newton),
}

/// The last matrix of a linear block and its factorization: most matrices change at events only.
struct Linear {
    /// Used instead of the dense matrix until a matrix is found to be singular.
    sparse: Option<Box<SparseBlock>>,
    lu: DenseLu,
    matrix: Vec<f64>,
    /// The entries of the matrix, and those that were factored.
    entries: Vec<f64>,
    factored: Vec<f64>,
    valid: bool,
    /// Pseudoinverse of a singular matrix, and the unknown it leaves undetermined, for the message.
    singular: Option<(PseudoInverse, usize)>,
    /// A factorization exists, possibly only because of rounding errors.
    has_factors: bool,
    /// The matrix was singular before: pivots of the size of rounding errors count as zero.
    was_singular: bool,
    last: Vec<f64>,
    right_side: Vec<f64>,
}

/// Largest pivot that counts as a rounding error, relative to its column.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl TornBlockSolver {
    /// Working memory for this block.
    pub fn new(torn_block: &TornBlock) -> Self {
        let n = torn_block.unknowns.len();
        let method = if torn_block.linear {
            let sparse = SparseBlock::new(n, &torn_block.jacobian).map(Box::new);
            BlockMethod::Linear(Linear {
                sparse,
                // The pages of a large dense matrix are taken when it is first written.
                lu: DenseLu::new(n),
                matrix: vec![0.0; n * n],
                entries: vec![0.0; torn_block.jacobian.len()],
                factored: vec![0.0; torn_block.jacobian.len()],
                valid: false,
                singular: None,
                has_factors: false,
                was_singular: false,
                last: vec![0.0; n],
                right_side: vec![0.0; n],
            })
        } else {
            BlockMethod::Newton(Newton::new(n))
        };
        TornBlockSolver {
            method,
            z: vec![0.0; n],
            start: vec![0.0; n],
            nominal: vec![1.0; n],
            bounds: vec![(0.0, 0.0); n],
        }
    }

    /// Solves block `k` and writes all its variables to the memory.
    pub fn solve(&mut self, machine: &mut Machine<'_>, k: usize) -> Result<(), Fault> {
        let torn_block = &machine.program.routines.torn_blocks[k];
        match &mut self.method {
            BlockMethod::Linear(linear) => linear.solve(machine, k, &mut self.z)?,
            BlockMethod::Newton(newton) => {
                for (j, slot) in torn_block.slots.iter().enumerate() {
                    self.z[j] = machine.get(*slot);
                    self.start[j] = self.z[j];
                    let size = machine.get(torn_block.nominals[j]).abs();
                    self.nominal[j] = if size > 0.0 && size.is_finite() { size } else { 1.0 };
                    let (min, max) = torn_block.bounds[j];
                    self.bounds[j] = (machine.get(min), machine.get(max));
                }
                let bounded = self.bounds.iter().any(|(a, b)| a.is_finite() || b.is_finite());
                let bounds = bounded.then_some(&self.bounds[..]);
                let region = Region { nominal: &self.nominal, bounds };
                let mut equations = BlockEquations { machine, torn_block: k, fault: None };
                let ending = iterate(newton, &mut equations, &mut self.z, region);
                if let NewtonOutcome::Converged { undetermined: Some(unknown), .. } = ending {
                    equations.machine.undetermined.get_or_insert((k, unknown));
                }
                let fault = equations.fault;
                match to_result(ending, k, fault) {
                    // Its equations may be those of other values of relations, which a later pass has.
                    Err(Fault::Singular { .. }) if machine.relaxed => {
                        machine.still_changing = true;
                        machine.is_unsolved = true;
                    }
                    outcome => outcome?,
                }
            }
        }
        // Evaluate the explicit part at the solution.
        for (slot, z) in torn_block.slots.iter().zip(&self.z) {
            machine.set(*slot, *z);
        }
        machine.run(&torn_block.residual_tape)
    }
}

impl TornBlockSolver {
    /// Restores the start values after a failure, so that the next attempt starts from the last
    /// solution.
    pub fn restore(&self, torn_block: &TornBlock, memory: &mut [f64]) {
        if let BlockMethod::Newton(_) = self.method {
            for (slot, z) in torn_block.slots.iter().zip(&self.start) {
                memory[*slot as usize] = *z;
            }
        }
    }
}

/// Newton's method from `z`, first within the bounds of the unknowns; then a search if the branch of the solution need
/// not be kept.
fn iterate(
    newton: &mut Newton,
    equations: &mut BlockEquations<'_, '_>,
    z: &mut [f64],
    region: Region<'_>,
) -> NewtonOutcome {
    let starts = equations.machine.get(equations.machine.program.layout.initial) != 0.0;
    let settings = NewtonSettings { may_repeat: !starts, ..NewtonSettings::default() };
    let mut ending = newton.solve(equations, z, region, &settings);
    if region.bounds.is_some() && !is_solved(ending) {
        // Bounds only guide the iteration; enforcing them is up to assertions.
        ending = newton.solve(equations, z, Region { bounds: None, ..region }, &settings);
    }
    if equations.machine.branch_switch && !is_solved(ending) {
        ending = FarSolution { newton, equations, region, settings }.find(z, ending);
    }
    ending
}

/// Whether an iteration found a solution.
pub(super) fn is_solved(ending: NewtonOutcome) -> bool {
    matches!(ending, NewtonOutcome::Converged { .. })
}

fn to_result(ending: NewtonOutcome, torn_block: usize, inner: Option<Fault>) -> Result<(), Fault> {
    match ending {
        NewtonOutcome::Converged { .. } => Ok(()),
        NewtonOutcome::Singular { column } => Err(Fault::Singular { torn_block, unknown: column }),
        NewtonOutcome::Diverged { component } => {
            Err(Fault::Diverged { torn_block, unknown: component })
        }
        NewtonOutcome::NonFinite { residual } => {
            Err(inner.unwrap_or(Fault::NotFinite { torn_block, residual }))
        }
    }
}

impl Linear {
    /// `J z = -r(0)`
    fn solve(&mut self, machine: &mut Machine<'_>, k: usize, z: &mut [f64]) -> Result<(), Fault> {
        let torn_block = &machine.program.routines.torn_blocks[k];
        let n = torn_block.unknowns.len();
        for (slot, last) in torn_block.slots.iter().zip(&mut self.last) {
            *last = machine.get(*slot);
            if !last.is_finite() {
                *last = 0.0;
            }
            machine.set(*slot, 0.0);
        }
        let outcome = self.solve_from_zero(machine, k, n, z);
        if outcome.is_err() {
            for (slot, last) in torn_block.slots.iter().zip(&self.last) {
                machine.set(*slot, *last);
            }
        }
        outcome
    }

    fn solve_from_zero(
        &mut self,
        machine: &mut Machine<'_>,
        k: usize,
        n: usize,
        z: &mut [f64],
    ) -> Result<(), Fault> {
        let torn_block = &machine.program.routines.torn_blocks[k];
        machine.run(&torn_block.residual_tape)?;
        machine.run(&torn_block.jacobian_tape)?;
        for (i, slot) in torn_block.residuals.iter().enumerate() {
            z[i] = -machine.get(*slot);
            if !z[i].is_finite() {
                return Err(Fault::NotFinite { torn_block: k, residual: i });
            }
        }
        if n == 1 {
            let pivot = torn_block.jacobian.first().map_or(0.0, |e| machine.get(e.slot));
            if pivot != 0.0 && pivot.is_finite() {
                z[0] /= pivot;
                return Ok(());
            }
        }
        for (entry, e) in self.entries.iter_mut().zip(&torn_block.jacobian) {
            *entry = machine.get(e.slot);
        }
        let same = self.valid
            && self.entries.iter().zip(&self.factored).all(|(a, b)| a.to_bits() == b.to_bits());
        if !same {
            self.valid = false;
            if self.sparse.as_mut().is_some_and(|sparse| sparse.factor(&self.entries).is_err()) {
                // The dense matrix knows what to do with a singular one.
                self.sparse = None;
            }
        }
        if let Some(sparse) = &mut self.sparse {
            self.factored.copy_from_slice(&self.entries);
            self.valid = true;
            sparse.solve_in_place(z);
            return Ok(());
        }
        if !same {
            self.singular = None;
            self.matrix.fill(0.0);
            for (e, entry) in torn_block.jacobian.iter().zip(&self.entries) {
                self.matrix[e.row as usize + n * e.column as usize] = *entry;
            }
            let factored = self.lu.factor(&self.matrix);
            self.was_singular |= factored.is_err();
            if self.was_singular
                && (factored.is_err() || self.lu.weakest_pivot(&self.matrix) <= ROUNDING)
            {
                let inverse = PseudoInverse::new(n, &self.matrix);
                self.singular = inverse
                    .filter(|i| factored.is_err() || i.rank() < n)
                    .map(|i| (i, factored.as_ref().map_or_else(|s| s.column, |()| n - 1)));
                if let (Err(s), None) = (&factored, &self.singular) {
                    return Err(Fault::Singular { torn_block: k, unknown: s.column });
                }
            }
            self.has_factors = factored.is_ok();
            self.factored.copy_from_slice(&self.entries);
            self.valid = true;
        }
        let Some((singular, unknown)) = &self.singular else {
            self.lu.solve_in_place(z);
            return Ok(());
        };
        self.right_side.copy_from_slice(z);
        if singular.solve_near(z, &self.last) {
            machine.undetermined.get_or_insert((k, *unknown));
        } else {
            if self.has_factors {
                z.copy_from_slice(&self.right_side);
                self.lu.solve_in_place(z);
                if z.iter().all(|x| x.is_finite()) {
                    return Ok(());
                }
            }
            // Intermediate steps of a relation search tolerate inconsistent equations.
            if !machine.relaxed {
                return Err(Fault::Singular { torn_block: k, unknown: *unknown });
            }
            machine.still_changing = true;
        }
        Ok(())
    }
}

/// The equations of a nonlinear block for Newton's method.
pub(super) struct BlockEquations<'a, 'p> {
    pub(super) machine: &'a mut Machine<'p>,
    pub(super) torn_block: usize,
    fault: Option<Fault>,
}

impl BlockEquations<'_, '_> {
    fn evaluate_at(&mut self, z: &[f64]) -> bool {
        let torn_block = &self.machine.program.routines.torn_blocks[self.torn_block];
        for (slot, z) in torn_block.slots.iter().zip(z) {
            self.machine.set(*slot, *z);
        }
        self.fault = self.machine.run(&torn_block.residual_tape).err();
        self.fault.is_none()
    }
}

impl NonlinearSystem for BlockEquations<'_, '_> {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) -> bool {
        if !self.evaluate_at(z) {
            return false;
        }
        let torn_block = &self.machine.program.routines.torn_blocks[self.torn_block];
        for (g, slot) in g.iter_mut().zip(&torn_block.residuals) {
            *g = self.machine.get(*slot);
        }
        true
    }

    fn jacobian(&mut self, z: &[f64], j: &mut [f64]) -> bool {
        if !self.evaluate_at(z) {
            return false;
        }
        let torn_block = &self.machine.program.routines.torn_blocks[self.torn_block];
        self.fault = self.machine.run(&torn_block.jacobian_tape).err();
        for e in &torn_block.jacobian {
            j[e.row as usize + z.len() * e.column as usize] = self.machine.get(e.slot);
        }
        self.fault.is_none()
    }
}

/// Working memory for the derivatives of a torn block.
pub struct BlockDerivativeSolver {
    /// Used instead of the dense matrix until a matrix is found to be singular.
    sparse: Option<Box<SparseBlock>>,
    entries: Vec<f64>,
    lu: DenseLu,
    /// The matrix was singular before: pivots of the size of rounding errors count as zero.
    was_singular: bool,
    matrix: Vec<f64>,
    columns: Vec<f64>,
}

impl BlockDerivativeSolver {
    /// Memory for this block.
    pub fn new(derivative: &BlockDerivative) -> Self {
        let n = derivative.order;
        BlockDerivativeSolver {
            sparse: SparseBlock::new(n, &derivative.jacobian).map(Box::new),
            entries: vec![0.0; derivative.jacobian.len()],
            lu: DenseLu::new(n),
            was_singular: false,
            matrix: vec![0.0; n * n],
            columns: vec![0.0; derivative.results.len()],
        }
    }

    /// `J dz = -B`
    pub fn differentiate(
        &mut self,
        derivative: &BlockDerivative,
        memory: &mut [f64],
    ) -> Result<(), Fault> {
        let n = derivative.order;
        self.columns.fill(0.0);
        for e in &derivative.seeds {
            self.columns[e.row as usize + n * e.column as usize] = -memory[e.slot as usize];
        }
        for (entry, e) in self.entries.iter_mut().zip(&derivative.jacobian) {
            *entry = memory[e.slot as usize];
        }
        if self.sparse.as_mut().is_some_and(|sparse| sparse.factor(&self.entries).is_err()) {
            self.sparse = None;
        }
        if let Some(sparse) = &mut self.sparse {
            for column in self.columns.chunks_exact_mut(n) {
                sparse.solve_in_place(column);
            }
            self.write_results(derivative, memory);
            return Ok(());
        }
        self.matrix.fill(0.0);
        for (e, entry) in derivative.jacobian.iter().zip(&self.entries) {
            self.matrix[e.row as usize + n * e.column as usize] = *entry;
        }
        let factored = self.lu.factor(&self.matrix);
        self.was_singular |= factored.is_err();
        let regular = factored.is_ok()
            && (!self.was_singular || self.lu.weakest_pivot(&self.matrix) > ROUNDING);
        if regular {
            for column in self.columns.chunks_exact_mut(n) {
                self.lu.solve_in_place(column);
            }
        } else {
            // Unknowns that the equations do not determine are constant.
            let unknown = factored.map_or_else(|s| s.column, |()| n - 1);
            let fault = Fault::Singular { torn_block: derivative.torn_block as usize, unknown };
            let inverse = PseudoInverse::new(n, &self.matrix).ok_or(fault)?;
            for column in self.columns.chunks_exact_mut(n) {
                inverse.solve_in_place(column);
            }
        }
        self.write_results(derivative, memory);
        Ok(())
    }

    fn write_results(&self, derivative: &BlockDerivative, memory: &mut [f64]) {
        for (slot, value) in derivative.results.iter().zip(&self.columns) {
            memory[*slot as usize] = *value;
        }
    }
}
