//! Motion along the surface on which a relation switches.
//!
//! A. F. Filippov, *Differential Equations with Discontinuous Righthand Sides*, 1988, sec. 4: where
//! the derivatives on both sides of the surface `indicator = 0` point towards it, the solution stays on
//! it, and its derivative is that convex combination of the two that keeps the gap.

use crate::ir::program::Slot;
use crate::runtime::machine::{Fault, Machine};

/// A displacement along the derivatives by which the rate of a gap is found, as a part of the run:
/// central differences of a gap that is linear in the states are exact.
const PROBE: f64 = 1e-6;

/// The surface that the solution stays on, and memory for the two sides.
pub struct Sliding {
    relation: u32,
    probe: f64,
    displaced: Vec<f64>,
    /// Derivatives where the relation is false, and where it is true.
    sides: [Vec<f64>; 2],
    memory: Vec<f64>,
}

/// How the two sides meet.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rates {
    /// Rate of the gap where the relation is false.
    pub when_false: f64,
    /// Rate of the gap where the relation is true.
    pub when_true: f64,
}

impl Rates {
    /// The part of the side on which the relation is true; in `[0, 1]` where the solution slides.
    pub fn weight(self) -> f64 {
        self.when_false / (self.when_false - self.when_true)
    }

    /// Both sides lead to the surface; `rising`: the relation is true for positive gaps.
    pub fn point_inward(self, rising: bool) -> bool {
        let sign = if rising { 1.0 } else { -1.0 };
        sign * self.when_true < 0.0 && sign * self.when_false > 0.0
    }
}

impl Sliding {
    /// Along the surface of a relation, in a run of length `span`.
    pub fn along(relation: u32, machine: &Machine<'_>, span: f64) -> Sliding {
        let n = machine.program.order();
        let zeros = || vec![0.0; n];
        Sliding {
            relation,
            probe: PROBE * span,
            displaced: zeros(),
            sides: [zeros(), zeros()],
            memory: vec![0.0; machine.memory.len()],
        }
    }

    /// The relation that switches.
    pub fn relation(&self) -> u32 {
        self.relation
    }

    /// The derivatives where the relation is false, and where it is true, as looked at last.
    pub fn sides(&self) -> [&[f64]; 2] {
        [&self.sides[0], &self.sides[1]]
    }

    /// The rates of the gap on both sides. The relation is left true.
    pub fn rates(&mut self, machine: &mut Machine<'_>, t: f64, y: &[f64]) -> Result<Rates, Fault> {
        let when_false = self.rate(machine, t, y, 0)?;
        let when_true = self.rate(machine, t, y, 1)?;
        Ok(Rates { when_false, when_true })
    }

    /// The derivatives along the surface, from the rates there.
    pub fn derivatives(
        &mut self,
        machine: &mut Machine<'_>,
        t: f64,
        y: &[f64],
        out: &mut [f64],
    ) -> Result<(), Fault> {
        let weight = self.rates(machine, t, y)?.weight();
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.sides[0][i] + weight * (self.sides[1][i] - self.sides[0][i]);
            if !out.is_finite() {
                return Err(machine.fail(Fault::Derivative { state: i }));
            }
        }
        Ok(())
    }

    /// Leaves in the memory, for each variable, the combination of its values on both sides.
    pub fn evaluate_all(
        &mut self,
        machine: &mut Machine<'_>,
        t: f64,
        y: &[f64],
    ) -> Result<(), Fault> {
        let weight = self.rates(machine, t, y)?.weight();
        for truth in [0, 1] {
            self.switch(machine, truth)?;
            let program = machine.program;
            machine.set_point(t, y);
            machine.run(&program.tapes.rhs)?;
            machine.run(&program.tapes.roots)?;
            machine.run(&program.tapes.outputs)?;
            if truth == 0 {
                self.memory.copy_from_slice(&machine.memory);
            }
        }
        let relations = self.relation_slots(machine);
        let cells = machine.memory.iter_mut().zip(&self.memory).enumerate();
        for (_, (now, before)) in cells.filter(|(slot, _)| !relations.contains(slot)) {
            if *now != *before && now.is_finite() && before.is_finite() {
                *now = before + weight * (*now - before);
            }
        }
        Ok(())
    }

    fn relation_slots(&self, machine: &Machine<'_>) -> std::ops::Range<usize> {
        let first = machine.program.layout.relations as usize;
        first..first + machine.program.events.relation_triggers.len()
    }

    /// Puts the relation to one of its values, with what depends on it.
    pub fn switch(&self, machine: &mut Machine<'_>, truth: usize) -> Result<(), Fault> {
        let cell = machine.program.layout.relations + self.relation as Slot;
        machine.set(cell, truth as f64);
        machine.run(&machine.program.tapes.discrete)
    }

    fn rate(
        &mut self,
        machine: &mut Machine<'_>,
        t: f64,
        y: &[f64],
        truth: usize,
    ) -> Result<f64, Fault> {
        self.switch(machine, truth)?;
        machine.derivatives(t, y, &mut self.sides[truth])?;
        let program = machine.program;
        let indicator = program.layout.indicators + self.relation as Slot;
        let mut indicators = [0.0; 2];
        for (indicator_there, h) in indicators.iter_mut().zip([-self.probe, self.probe]) {
            for ((displaced, y), slope) in self.displaced.iter_mut().zip(y).zip(&self.sides[truth])
            {
                *displaced = y + h * slope;
            }
            machine.set_point(t + h, &self.displaced);
            machine.run(&program.tapes.rhs)?;
            machine.run(&program.tapes.roots)?;
            *indicator_there = machine.get(indicator);
        }
        Ok((indicators[1] - indicators[0]) / (2.0 * self.probe))
    }
}
