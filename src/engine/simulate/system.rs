//! The hybrid system between events, in the form that the integrator expects.

use crate::integrate::system::{EvalError, System};
use crate::ir::program::{Entry, Program, RelationTrigger};
use crate::numeric::pattern::Pattern;
use crate::runtime::machine::{Fault, Machine};

use super::event::sliding::Sliding;

/// The derivatives of the states, and the residuals of the loops that are left to the integrator. A
/// model without states gets a constant one, so that the same loop locates events of its algebraic
/// variables.
pub struct HybridSystem<'p> {
    /// The machine that evaluates the program.
    pub machine: Machine<'p>,
    /// A function was evaluated outside of its domain since this flag was reset.
    pub left_domain: bool,
    /// Do not clamp arguments to the domain of functions.
    pub strict: bool,
    /// The surface along which the solution slides, if any.
    pub sliding: Option<Sliding>,
    differential: Vec<bool>,
    pattern: Pattern,
    /// State-dependent relations.
    state_relations: Vec<u32>,
    probes: ProbeHistory,
    /// Indicators of the last evaluations, one row for each of `probes`.
    probed_indicators: Vec<f64>,
    /// Position in the pattern of each Jacobian entry of the program.
    positions: Vec<usize>,
    displaced: Vec<f64>,
    base: Vec<f64>,
    slope: Vec<f64>,
}

/// Number of evaluations whose relations are remembered.
const PROBES: usize = 5;

/// The last evaluations of derivatives, each with a flag that a relation differed from its held
/// value.
#[derive(Default)]
struct ProbeHistory {
    /// As many as Radau IIA makes per step from its last iteration on: three stages, the error
    /// estimate, and the end.
    recent: [(f64, bool); PROBES],
    next: usize,
    /// The memory has not changed since the last one.
    is_current: bool,
}

impl ProbeHistory {
    /// Notes an evaluation and returns its position.
    fn note(&mut self, t: f64, switched: bool) -> usize {
        let position = self.next;
        self.recent[position] = (t, switched);
        self.next = (position + 1) % self.recent.len();
        self.is_current = true;
        position
    }
}

/// How the right side was differentiated.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Differentiated {
    Exactly,
    /// With arguments clamped to the domain of functions.
    Clamped,
    /// A torn block has no derivative.
    Not,
}

fn state_relations(program: &Program) -> Vec<u32> {
    let count = program.events.relation_triggers.len() as u32;
    (0..count)
        .filter(|k| program.events.relation_triggers[*k as usize] == RelationTrigger::State)
        .collect()
}

impl<'p> HybridSystem<'p> {
    /// A system in its initial state.
    pub fn new(program: &'p Program) -> Self {
        let (states, order) = (program.blocks.states.len(), program.order());
        let n = order.max(1);
        let zeros = || vec![0.0; n];
        let position = |e: &Entry| (e.row as usize, e.column as usize);
        let entries: Vec<_> = program.jacobian_entries.iter().map(position).collect();
        let pattern = Pattern::from_entries(n, n, &entries);
        let positions = entries.iter().filter_map(|&(i, j)| pattern.position(i, j)).collect();
        HybridSystem {
            machine: Machine::new(program),
            left_domain: false,
            strict: false,
            sliding: None,
            differential: (0..n).map(|i| !(states..order).contains(&i)).collect(),
            pattern,
            state_relations: state_relations(program),
            probes: ProbeHistory::default(),
            probed_indicators: vec![0.0; PROBES * program.events.relation_triggers.len()],
            positions,
            displaced: zeros(),
            base: zeros(),
            slope: zeros(),
        }
    }

    /// An instant in the second half of a step up to which the evaluations of the integrator found
    /// no relation changed, if there were evaluations in both halves: at the stages of a
    /// Runge-Kutta method relations cost next to nothing.
    pub fn quiet_until(&self, t0: f64, t1: f64) -> Option<f64> {
        let middle = 0.5 * (t0 + t1);
        let inside = || self.probes.recent.iter().filter(|probe| t0 < probe.0 && probe.0 < t1);
        let latest = inside().map(|probe| probe.0).fold(t0, f64::max);
        let quiet = inside().all(|probe| !probe.1) && inside().any(|probe| probe.0 <= middle);
        (quiet && latest > middle).then_some(latest)
    }

    /// True if the relations in the memory were evaluated at `(t, y)`.
    pub fn is_current_at(&self, t: f64, y: &[f64]) -> bool {
        let machine = &self.machine;
        self.probes.is_current
            && machine.get(machine.program.layout.time) == t
            && machine.states() == &y[..machine.program.order()]
    }

    /// Evaluates the relations at the point of the last evaluation of derivatives.
    fn probe(&mut self, t: f64) {
        let program = self.machine.program;
        if self.left_domain
            || self.sliding.is_some()
            || self.machine.run(&program.tapes.roots).is_err()
        {
            return self.probes = ProbeHistory::default();
        }
        let (candidates, held) = (program.layout.candidates, program.layout.relations);
        let switched = |k: &u32| self.machine.get(candidates + k) != self.machine.get(held + k);
        let switched = self.state_relations.iter().any(switched);
        let position = self.probes.note(t, switched);
        let count = program.events.relation_triggers.len();
        let first = program.layout.indicators as usize;
        let now = &self.machine.memory[first..first + count];
        self.probed_indicators[position * count..][..count].copy_from_slice(now);
    }

    /// The latest evaluations of the integrator strictly between two instants, in order of time,
    /// with the indicators of all relations there.
    pub fn probes_between(&self, t0: f64, t1: f64) -> impl Iterator<Item = (f64, &[f64])> {
        let count = self.machine.program.events.relation_triggers.len();
        let recent = &self.probes.recent;
        let mut order: [usize; PROBES] = std::array::from_fn(|k| (self.probes.next + k) % PROBES);
        // Stable: of evaluations at one instant the last remains last.
        order.sort_by(|a, b| recent[*a].0.total_cmp(&recent[*b].0));
        let is_last_there = move |k: usize| {
            let t = recent[order[k]].0;
            t0 < t && t < t1 && (k + 1 == PROBES || recent[order[k + 1]].0 > t)
        };
        (0..PROBES).filter(move |k| is_last_there(*k)).map(move |k| {
            (recent[order[k]].0, &self.probed_indicators[order[k] * count..][..count])
        })
    }

    /// Evaluates all variables at `(t, y)`, with relations held.
    pub fn evaluate_all(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        self.probes.is_current = false;
        if let Some(sliding) = &mut self.sliding {
            let n = self.machine.program.order();
            return sliding.evaluate_all(&mut self.machine, t, &y[..n]);
        }
        let program = self.machine.program;
        self.evaluate_roots(t, y)?;
        self.machine.run(&program.tapes.outputs)
    }

    /// Evaluates what a row between steps needs at `(t, y)`, with relations held; other variables
    /// keep earlier values. Only if the program has a tape for it, and the solution does not slide.
    pub fn evaluate_row(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        self.probes.is_current = false;
        let program = self.machine.program;
        self.machine.set_point(t, &y[..program.order()]);
        program.rows.as_ref().map_or(Ok(()), |tape| self.machine.run(tape))
    }

    /// Evaluates derivatives, zero-crossing indicators and assertions at `(t, y)`.
    pub fn evaluate_roots(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        self.probes.is_current = false;
        let program = self.machine.program;
        self.machine.set_point(t, &y[..program.order()]);
        self.machine.run(&program.tapes.rhs)?;
        self.machine.run(&program.tapes.roots)
    }

    /// As [`HybridSystem::evaluate_all`], with arguments clamped to the domain of functions.
    pub fn evaluate_all_clamped(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        self.machine.clamp_domain = true;
        let outcome = self.evaluate_all(t, y);
        self.machine.clamp_domain = false;
        outcome
    }

    /// As [`HybridSystem::evaluate_roots`], with arguments clamped if the step left the domain.
    pub fn evaluate_roots_clamped(&mut self, t: f64, y: &[f64]) -> Result<(), Fault> {
        let outcome = self.evaluate_roots(t, y);
        let layout = &self.machine.program.layout;
        let count = self.machine.program.events.relation_triggers.len() as u32;
        let indicators = (0..count).map(|k| self.machine.get(layout.indicators + k));
        let fine = match outcome {
            Ok(()) => {
                !self.left_domain || indicators.into_iter().all(|indicator| !indicator.is_nan())
            }
            Err(fault) => self.strict || !is_domain_fault(fault),
        };
        if fine {
            return outcome;
        }
        self.left_domain = true;
        self.machine.clamp_domain = true;
        let outcome = self.evaluate_roots(t, y);
        self.machine.clamp_domain = false;
        outcome
    }

    /// True if the derivatives at `(t, y)` exist.
    pub fn is_in_domain(&mut self, t: f64, y: &[f64]) -> bool {
        self.probes.is_current = false;
        let n = self.machine.program.order();
        self.machine.derivatives(t, &y[..n], &mut self.slope[..n]).is_ok()
    }

    /// Executes the tape of the Jacobian. If a torn block has no derivative there, the caller uses difference quotients.
    fn differentiate(&mut self, t: f64, y: &[f64]) -> Result<Differentiated, EvalError> {
        self.probes.is_current = false;
        let program = self.machine.program;
        let n = program.order();
        self.machine.set_point(t, &y[..n]);
        let evaluated = self.machine.run(&program.tapes.rhs);
        if let Err(fault) = evaluated {
            let HybridSystem { machine, left_domain, strict, base, .. } = self;
            derivatives(
                machine,
                left_domain,
                *strict || !is_domain_fault(fault),
                t,
                &y[..n],
                &mut base[..n],
            )
            .map_err(|_| recoverable(&self.machine))?;
        }
        Ok(match (self.machine.run(&program.tapes.jacobian), evaluated) {
            (Err(_), _) => Differentiated::Not,
            (Ok(()), Err(_)) => Differentiated::Clamped,
            (Ok(()), Ok(())) => Differentiated::Exactly,
        })
    }

    /// Writes a column of the Jacobian to `slope` as one-sided difference quotients, for points
    /// where the exact derivative is infinite, such as that of a root at zero.
    fn difference(&mut self, t: f64, y: &[f64], column: usize) -> Result<(), Fault> {
        let n = self.machine.program.order();
        self.displaced.copy_from_slice(y);
        let h = f64::EPSILON.sqrt() * y[column].abs().max(1e-3);
        let HybridSystem { machine, left_domain, strict, base, slope, displaced, .. } = self;
        derivatives(machine, left_domain, *strict, t, &y[..n], &mut base[..n])?;
        for step in [h, -h] {
            displaced[column] = y[column] + step;
            if machine.derivatives(t, &displaced[..n], &mut slope[..n]).is_ok() {
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

impl HybridSystem<'_> {
    /// The Jacobian by one-sided differences.
    fn differences(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        let (n, dim) = (self.machine.program.order(), self.dim());
        let (mut base, mut slope) = (vec![0.0; dim], vec![0.0; dim]);
        let mut displaced = y.to_vec();
        self.rhs(t, y, &mut base)?;
        for column in 0..n {
            let h = f64::EPSILON.sqrt() * y[column].abs().max(1e-3);
            displaced[column] = y[column] + h;
            self.rhs(t, &displaced, &mut slope)?;
            displaced[column] = y[column];
            for i in 0..n {
                j[i + dim * column] = (slope[i] - base[i]) / h;
            }
        }
        Ok(())
    }
}

impl HybridSystem<'_> {
    /// Writes the entries of the Jacobian at `(t, y)` in the order of the pattern. True if the memory then holds the
    /// right side there, evaluated without clamped arguments.
    pub fn linearise(&mut self, t: f64, y: &[f64], values: &mut [f64]) -> Result<bool, EvalError> {
        // During sliding this is the Jacobian of one side: close enough for Newton's method.
        let program = self.machine.program;
        let outcome = self.differentiate(t, y)?;
        for (e, &place) in program.jacobian_entries.iter().zip(&self.positions) {
            let exact = outcome != Differentiated::Not;
            values[place] = if exact { self.machine.get(e.slot) } else { f64::NAN };
        }
        if values.iter().all(|d| d.is_finite()) {
            return Ok(outcome == Differentiated::Exactly);
        }
        for column in 0..program.order() {
            let starts = self.pattern.column_starts();
            let range = starts[column]..starts[column + 1];
            if values[range.clone()].iter().any(|d| !d.is_finite()) {
                self.difference(t, y, column).map_err(|_| recoverable(&self.machine))?;
                let rows = self.pattern.column(column);
                for (value, &i) in values[range].iter_mut().zip(rows) {
                    *value = self.slope[i];
                }
            }
        }
        Ok(false)
    }
}

impl System for HybridSystem<'_> {
    fn dim(&self) -> usize {
        self.differential.len()
    }

    fn differential(&self) -> &[bool] {
        &self.differential
    }

    fn rhs(&mut self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        let n = self.machine.program.order();
        f[n..].fill(0.0);
        if let Some(sliding) = &mut self.sliding {
            let slid = sliding.derivatives(&mut self.machine, t, &y[..n], &mut f[..n]);
            return slid.map_err(|_| recoverable(&self.machine));
        }
        self.probes.is_current = false;
        derivatives(&mut self.machine, &mut self.left_domain, self.strict, t, &y[..n], &mut f[..n])
            .map_err(|_| recoverable(&self.machine))?;
        self.probe(t);
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        let program = self.machine.program;
        let (n, dim) = (program.order(), self.dim());
        if self.sliding.is_some() {
            return self.differences(t, y, j);
        }
        let exact = self.differentiate(t, y)? != Differentiated::Not;
        for e in &program.jacobian_entries {
            let value = if exact { self.machine.get(e.slot) } else { f64::NAN };
            j[e.row as usize + dim * e.column as usize] = value;
        }
        for column in 0..n {
            let range = column * dim..(column + 1) * dim;
            if j[range.clone()].iter().any(|d| !d.is_finite()) {
                self.difference(t, y, column).map_err(|_| recoverable(&self.machine))?;
                j[range].copy_from_slice(&self.slope);
            }
        }
        Ok(())
    }

    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.pattern)
    }

    fn leaves_pattern(&self) -> bool {
        self.sliding.is_some()
    }

    fn jacobian_entries(&mut self, t: f64, y: &[f64], values: &mut [f64]) -> Result<(), EvalError> {
        self.linearise(t, y, values).map(|_| ())
    }
}

/// Evaluates the derivatives, with clamped arguments if they cannot be evaluated otherwise: while a
/// relation is held, its branch must extend slightly beyond the crossing.
fn derivatives(
    machine: &mut Machine<'_>,
    left_domain: &mut bool,
    strict: bool,
    t: f64,
    states: &[f64],
    out: &mut [f64],
) -> Result<(), Fault> {
    match machine.derivatives(t, states, out) {
        Err(fault) if !strict && is_domain_fault(fault) => {
            *left_domain = true;
            machine.clamp_domain = true;
            let outcome = machine.derivatives(t, states, out);
            machine.clamp_domain = false;
            outcome
        }
        outcome => outcome,
    }
}

/// True for faults that clamping of arguments may avoid.
pub fn is_domain_fault(fault: Fault) -> bool {
    matches!(fault, Fault::Derivative { .. } | Fault::NotFinite { .. })
}

/// Calls of functions that do not return after which no shorter step is tried: each takes a tenth of a second.
pub const MAX_ENDLESS_CALLS: u32 = 20;

/// Whether a shorter step may help. The machine records the fault itself.
fn recoverable(machine: &Machine<'_>) -> EvalError {
    match machine.endless_calls > MAX_ENDLESS_CALLS {
        true => EvalError::Fatal(0),
        false => EvalError::Recoverable(0),
    }
}
