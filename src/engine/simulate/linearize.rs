//! The linear system at an operating point: `dx = A x + B u`, `y = C x + D u` for small deviations.
//!
//! *In:* an [`OperatingPoint`], the driven inputs and the outputs. *Out:* the matrices, from exact derivatives: tangents
//! that are propagated along the instructions of the model (`runtime::tangent`), with relations held.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::expr::VarId;
use crate::ir::program::{Program, Slot};
use crate::numeric::eigenvalues::{Complex, eigenvalues};
use crate::numeric::participation::participation;
use crate::runtime::tangent::Tangents;

use super::cause::RunCause;
use super::failure::{Failure, of_fault};
use super::operating_point::OperatingPoint;

/// A linear system, and the point where it holds.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// The instant, s.
    pub time: f64,
    /// The states.
    pub states: Vec<VarId>,
    /// The inputs.
    pub inputs: Vec<VarId>,
    /// The outputs.
    pub outputs: Vec<VarId>,
    /// Values of the states, SI.
    pub x: Vec<f64>,
    /// Their derivatives: all zero at a steady state.
    pub rates: Vec<f64>,
    /// Values of the inputs.
    pub u: Vec<f64>,
    /// Values of the outputs.
    pub y: Vec<f64>,
    /// Derivatives of the rates by the states, row by row.
    pub a: Vec<f64>,
    /// Derivatives of the rates by the inputs, row by row.
    pub b: Vec<f64>,
    /// Derivatives of the outputs by the states, row by row.
    pub c: Vec<f64>,
    /// Derivatives of the outputs by the inputs, row by row.
    pub d: Vec<f64>,
}

impl Linearization {
    /// The eigenvalues of `A`, 1/s, by descending real part; `None` if an entry of `A` is not finite.
    pub fn eigenvalues(&self) -> Option<Vec<Complex>> {
        // The eigenvalues of the transposed matrix are the same.
        eigenvalues(self.states.len(), &self.a)
    }

    /// For each eigenvalue how much each state takes part in it: parts that sum to 1. `None` if they are not finite.
    pub fn participation(&self, eigenvalues: &[Complex]) -> Option<Vec<Vec<f64>>> {
        let n = self.states.len();
        let columns: Vec<f64> = (0..n * n).map(|at| self.a[at % n * n + at / n]).collect();
        participation(n, &columns, eigenvalues)
    }
}

/// Linearizes a model at a point.
pub fn linearize(
    point: &mut OperatingPoint<'_>,
    inputs: &[VarId],
    outputs: &[VarId],
) -> Result<Linearization, Failure> {
    let time = point.time;
    let program = point.system.machine.program;
    if let Some(why) = obstacle(point) {
        let cause = RunCause::NotLinear { time, why };
        return Err(Failure::numerics(time, Diagnostic::new(cause, Span::NONE)));
    }
    point.evaluate()?;
    let (n, m) = (program.blocks.states.len(), inputs.len());
    let mut tangents = Tangents::new(program.image.len(), n + m);
    for k in 0..n {
        tangents.of_mut(program.layout.states + k as Slot)[k] = 1.0;
    }
    for (k, input) in inputs.iter().enumerate() {
        tangents.of_mut(signal(program, *input))[n + k] = 1.0;
    }
    for tape in [&program.tapes.rhs, &program.tapes.roots, &program.tapes.outputs] {
        let propagated = tangents.propagate(&mut point.system.machine, tape);
        propagated.map_err(|f| of_fault(&point.system.machine, f, time))?;
    }
    let machine = &point.system.machine;
    let rows = |slots: &[Slot]| {
        let part = |from: usize, to: usize| {
            slots.iter().flat_map(|s| tangents.of(*s)[from..to].to_vec()).collect::<Vec<f64>>()
        };
        (part(0, n), part(n, n + m))
    };
    let values = |all: &[VarId]| all.iter().map(|v| machine.value(*v)).collect::<Vec<f64>>();
    let derivatives = &program.layout.derivatives[..n];
    let slots: Vec<Slot> = outputs.iter().map(|v| program.slot(*v)).collect();
    let (a, b) = rows(derivatives);
    let (c, d) = rows(&slots);
    Ok(Linearization {
        time,
        states: program.blocks.states.iter().map(|s| s.variable).collect(),
        inputs: inputs.to_vec(),
        outputs: outputs.to_vec(),
        x: point.y[..n].to_vec(),
        rates: derivatives.iter().map(|s| machine.get(*s)).collect(),
        u: inputs.iter().map(|v| machine.get(signal(program, *v))).collect(),
        y: values(outputs),
        a,
        b,
        c,
        d,
    })
}

/// Why there is no linear system at this point.
fn obstacle(point: &OperatingPoint<'_>) -> Option<&'static str> {
    let machine = &point.system.machine;
    if point.system.sliding.is_some() {
        return Some("the solution slides along a border between two branches");
    }
    if machine.program.differentiated_input().is_some() {
        return Some("it differentiates an input, so it has no state-space form");
    }
    if machine.has_history() {
        return Some("`delay` and `spatialDistribution` have infinitely many states");
    }
    None
}

/// The slot of the value of a driven input.
fn signal(program: &Program, input: VarId) -> Slot {
    let signals = &program.layout.signals;
    let own = signals.iter().find(|(v, order, _)| *v == input && *order == 0);
    own.map_or_else(|| program.slot(input), |(.., slot)| *slot)
}
