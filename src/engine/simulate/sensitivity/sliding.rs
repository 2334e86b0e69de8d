//! Sensitivities of a solution that slides along the switching surface of a relation.
//!
//! On the surface `g(t, x, p) = 0` Filippov's solution obeys
//!
//! `x' = (1 - a) f0 + a f1,  0 = g(t, x, p)`
//!
//! with the weight `a` as an algebraic unknown, a system of index 2. Differentiated with respect to
//! the inputs, with `S = dx/dp` and `A = da/dp`, it is linear and needs first derivatives only:
//!
//! `S' = ((1 - a) J0 + a J1) S + (1 - a) df0/dp + a df1/dp + (f1 - f0) A,  0 = dg/dx S + dg/dp`.
//!
//! Radau IIA integrates linear systems of index 2 in this form directly (Hairer & Wanner II, sec.
//! VII.4). Where the solution enters the surface with rate `r` of the indicator, and derivatives
//! `f` before and `fs` after, `S` jumps by `(f - fs) dt/dp` with `dt/dp = -(dg/dx S + dg/dp) / r`,
//! which satisfies the constraint. Where it leaves, `f = fs`, and `S` is continuous (L. Dieci, L.
//! Lopez, *Fundamental matrix solutions of piecewise smooth differential systems*, Mathematics and
//! Computers in Simulation 81, 2011, sec. 3; M. di Bernardo et al., *Piecewise-smooth Dynamical
//! Systems*, 2008, sec. 2.5).

use crate::integrate::radau::variation::Variation;
use crate::integrate::system::EvalError;
use crate::integrate::variational::Variational;
use crate::ir::program::Slot;
use crate::runtime::machine::{Fault, Machine};
use crate::runtime::tangent::Tangents;

use crate::simulate::event::sliding::Sliding;
use crate::simulate::system::HybridSystem;

/// Number of states with respect to which everything is differentiated together.
const LANES: usize = 8;

/// The sensitivities during sliding.
pub struct Surface {
    /// Derivatives of the states, and of the weight as the last component.
    pub variation: Variation,
    /// Their equations.
    pub equations: Equations,
    values: Vec<f64>,
    derivatives: Vec<f64>,
}

/// The variational equations at the stages of a step.
pub struct Equations {
    count: usize,
    points: [Point; 3],
    /// Tangents with respect to a group of states.
    seeds: Tangents,
}

/// The variational equations at a point.
struct Point {
    /// Weighted Jacobian, column-major.
    jacobian: Vec<f64>,
    /// Weighted derivatives with respect to the inputs, state by state.
    forcing: Vec<f64>,
    /// `f1 - f0`
    jump: Vec<f64>,
    /// `dg/dx`
    indicator_by_state: Vec<f64>,
    /// `dg/dp`
    indicator_by_input: Vec<f64>,
    /// The weight of the side on which the relation is true.
    weight: f64,
}

impl Surface {
    /// For a program with `slots` slots and `n` states, differentiated with respect to `count`
    /// inputs, with `recorded` columns.
    pub fn new(slots: usize, n: usize, count: usize, recorded: usize) -> Surface {
        let point = || Point {
            jacobian: vec![0.0; n * n],
            forcing: vec![0.0; n * count],
            jump: vec![0.0; n],
            indicator_by_state: vec![0.0; n],
            indicator_by_input: vec![0.0; count],
            weight: 0.0,
        };
        Surface {
            variation: Variation::constrained(n, count),
            equations: Equations {
                count,
                points: std::array::from_fn(|_| point()),
                seeds: Tangents::new(slots, LANES.min(n.max(1))),
            },
            values: vec![0.0; recorded],
            derivatives: vec![0.0; recorded * count],
        }
    }

    /// Enters at `(t, y)` with the derivatives `s` on the side of `truth`, a panel with a column for each input.
    pub fn enter(
        &mut self,
        system: &mut HybridSystem<'_>,
        tangents: &mut Option<Box<Tangents>>,
        (t, y): (f64, &[f64]),
        truth: bool,
        s: &[f64],
    ) -> Result<(), EvalError> {
        let n = system.machine.program.order();
        let Some(mut sliding) = system.sliding.take() else { return Ok(()) };
        let rates = sliding.rates(&mut system.machine, t, &y[..n]);
        let equations = &mut self.equations;
        let linearised = equations.linearise(system, &mut sliding, tangents, 0, (t, y));
        system.sliding = Some(sliding);
        linearised?;
        let rates = rates.map_err(|_| EvalError::Recoverable(0))?;
        let point = &self.equations.points[0];
        // On the side of `truth`, f - fs is a multiple of the jump.
        let (rate, rest) = match truth {
            true => (rates.when_true, 1.0 - point.weight),
            false => (rates.when_false, -point.weight),
        };
        let width = self.variation.width();
        let shifts: Vec<f64> = (0..self.equations.count)
            .map(|d| {
                let gradient = point.indicator_by_state.iter().enumerate();
                let indicator: f64 = gradient.map(|(i, g)| s[i * width + d] * g).sum();
                -(indicator + point.indicator_by_input[d]) / rate
            })
            .collect();
        let mut initial = vec![0.0; (n + 1) * width];
        initial[..n * width].copy_from_slice(&s[..n * width]);
        for (row, jump) in initial.chunks_exact_mut(width).zip(&point.jump) {
            for (s, shift) in row.iter_mut().zip(&shifts) {
                *s += rest * jump * shift;
            }
        }
        self.variation.restart(t, &initial);
        Ok(())
    }

    /// Derivatives of the recorded slots at `(t, y)`, after [`Sliding::evaluate_all`]: value by
    /// value, input by input. Combines the derivatives on both sides.
    pub fn evaluate(
        &mut self,
        machine: &mut Machine<'_>,
        sliding: &mut Sliding,
        tangents: &mut Option<Box<Tangents>>,
        t: f64,
        recorded: &[Slot],
        slopes: &mut [f64],
    ) -> Result<(), Fault> {
        let program = machine.program;
        let layout = &program.layout;
        let n = program.order();
        let count = self.equations.count;
        let blended = machine.memory.clone();
        let y = machine.states().to_vec();
        let part = sliding.rates(machine, t, &y)?.weight();
        let width = self.variation.width();
        let mut s = vec![0.0; (n + 1) * width];
        let mut parts = vec![0.0; count];
        if let Some(tangents) = tangents {
            tangents.of_mut(layout.time).fill(0.0);
            tangents.hold_signals(layout, &machine.input_signals, &machine.memory);
            self.variation.interpolate(t, &mut s);
            for (i, row) in s.chunks_exact(width).take(n).enumerate() {
                let slot = layout.states + i as Slot;
                tangents.of_mut(slot)[..count].copy_from_slice(&row[..count]);
            }
            parts.copy_from_slice(&s[n * width..n * width + count]);
        }
        for truth in [0, 1] {
            machine.tangents = tangents.take();
            let outcome = sliding.switch(machine, truth).and_then(|()| {
                machine.set_point(t, &y);
                machine.run(&program.tapes.rhs)?;
                machine.run(&program.tapes.roots)?;
                machine.run(&program.tapes.outputs)
            });
            *tangents = machine.tangents.take();
            outcome?;
            let Some(tangents) = tangents else { break };
            for (k, slot) in recorded.iter().enumerate() {
                let side = &tangents.of(*slot)[..count];
                let range = k * count..(k + 1) * count;
                if truth == 0 {
                    self.values[k] = machine.get(*slot);
                    self.derivatives[range].copy_from_slice(side);
                    continue;
                }
                let jump = machine.get(*slot) - self.values[k];
                let before = &self.derivatives[range.clone()];
                for (((slope, d0), d1), by) in
                    slopes[range].iter_mut().zip(before).zip(side).zip(&parts)
                {
                    *slope = d0 + part * (d1 - d0) + jump * by;
                }
            }
        }
        machine.memory.copy_from_slice(&blended);
        Ok(())
    }
}

impl Equations {
    fn linearise(
        &mut self,
        system: &mut HybridSystem<'_>,
        sliding: &mut Sliding,
        tangents: &mut Option<Box<Tangents>>,
        stage: usize,
        (t, y): (f64, &[f64]),
    ) -> Result<(), EvalError> {
        let machine = &mut system.machine;
        let n = machine.program.order();
        let y = &y[..n];
        let failed = |_| EvalError::Recoverable(0);
        let part = sliding.rates(machine, t, y).map_err(failed)?.weight();
        let point = &mut self.points[stage];
        point.weight = part;
        point.jacobian.fill(0.0);
        point.forcing.fill(0.0);
        let [when_false, when_true] = sliding.sides();
        for ((jump, f0), f1) in point.jump.iter_mut().zip(when_false).zip(when_true) {
            *jump = f1 - f0;
        }
        for (truth, weight) in [(0, 1.0 - part), (1, part)] {
            machine.tangents = tangents.take();
            let outcome = by_inputs(machine, sliding, truth, t, y);
            *tangents = machine.tangents.take();
            outcome.map_err(failed)?;
            if let Some(tangents) = tangents {
                point.add_inputs(machine, sliding.relation(), tangents, self.count, weight);
            }
            for first in (0..n).step_by(LANES) {
                point
                    .add_states(machine, sliding.relation(), &mut self.seeds, first, weight)
                    .map_err(failed)?;
            }
        }
        Ok(())
    }
}

/// Evaluates derivatives and indicators, and their derivatives with respect to the inputs at
/// constant states.
fn by_inputs(
    machine: &mut Machine<'_>,
    sliding: &Sliding,
    truth: usize,
    t: f64,
    y: &[f64],
) -> Result<(), Fault> {
    let program = machine.program;
    let layout = &program.layout;
    sliding.switch(machine, truth)?;
    machine.set_point(t, y);
    if let Some(tangents) = &mut machine.tangents {
        tangents.of_mut(layout.time).fill(0.0);
        tangents.hold_signals(layout, &machine.input_signals, &machine.memory);
        for i in 0..y.len() {
            tangents.of_mut(layout.states + i as Slot).fill(0.0);
        }
    }
    machine.run(&program.tapes.rhs)?;
    machine.run(&program.tapes.roots)
}

impl Point {
    fn add_inputs(
        &mut self,
        machine: &Machine<'_>,
        relation: u32,
        tangents: &Tangents,
        count: usize,
        weight: f64,
    ) {
        let layout = &machine.program.layout;
        for (i, slot) in layout.derivatives.iter().enumerate() {
            let row = &mut self.forcing[i * count..(i + 1) * count];
            for (forcing, d) in row.iter_mut().zip(&tangents.of(*slot)[..count]) {
                *forcing += weight * d;
            }
        }
        self.indicator_by_input
            .copy_from_slice(&tangents.of(layout.indicators + relation)[..count]);
    }

    /// Adds the columns of a group of states, evaluated at the point in the memory.
    fn add_states(
        &mut self,
        machine: &mut Machine<'_>,
        relation: u32,
        seeds: &mut Tangents,
        first: usize,
        weight: f64,
    ) -> Result<(), Fault> {
        let program = machine.program;
        let layout = &program.layout;
        let n = program.order();
        let lanes = seeds.directions();
        for i in 0..n {
            let seed = seeds.of_mut(layout.states + i as Slot);
            seed.fill(0.0);
            if (first..first + lanes).contains(&i) {
                seed[i - first] = 1.0;
            }
        }
        seeds.propagate(machine, &program.tapes.rhs)?;
        seeds.propagate(machine, &program.tapes.roots)?;
        for j in first..(first + lanes).min(n) {
            for (i, slot) in layout.derivatives.iter().enumerate() {
                self.jacobian[i + n * j] += weight * seeds.of(*slot)[j - first];
            }
            self.indicator_by_state[j] = seeds.of(layout.indicators + relation)[j - first];
        }
        Ok(())
    }
}

/// The variational equations of a step on the surface.
pub struct SurfaceEquations<'a, 'p> {
    /// The system.
    pub system: &'a mut HybridSystem<'p>,
    /// Tangents with respect to the inputs.
    pub tangents: Option<Box<Tangents>>,
    /// The equations at the stages.
    pub equations: &'a mut Equations,
}

impl Variational for SurfaceEquations<'_, '_> {
    fn linearise(&mut self, stage: usize, t: f64, y: &[f64]) -> Result<(), EvalError> {
        let Some(mut sliding) = self.system.sliding.take() else {
            return Err(EvalError::Fatal(0));
        };
        let SurfaceEquations { system, tangents, equations } = self;
        let outcome = equations.linearise(system, &mut sliding, tangents, stage, (t, y));
        self.system.sliding = Some(sliding);
        outcome
    }

    fn slopes(&self, stage: usize, width: usize, s: &[f64], out: &mut [f64]) {
        let point = &self.equations.points[stage];
        let (n, count) = (point.jump.len(), self.equations.count);
        let rows = || s.chunks_exact(width);
        let Some(part) = rows().nth(n) else { return };
        out.fill(0.0);
        for (row, forcing) in
            out.chunks_exact_mut(width).zip(point.forcing.chunks_exact(count.max(1)))
        {
            row[..count].copy_from_slice(forcing);
        }
        let mut add = |i: usize, factor: f64, s: &[f64]| {
            if factor != 0.0 {
                let row = &mut out[i * width..(i + 1) * width];
                row.iter_mut().zip(s).for_each(|(out, s)| *out += factor * s);
            }
        };
        for (s, column) in rows().zip(point.jacobian.chunks_exact(n)) {
            column.iter().enumerate().for_each(|(i, entry)| add(i, *entry, s));
        }
        point.jump.iter().enumerate().for_each(|(i, jump)| add(i, *jump, part));
        for (s, gradient) in rows().zip(&point.indicator_by_state) {
            add(n, *gradient, s);
        }
        let constraint = &mut out[n * width..n * width + count];
        for (out, by_input) in constraint.iter_mut().zip(&point.indicator_by_input) {
            *out += by_input;
        }
    }
}
