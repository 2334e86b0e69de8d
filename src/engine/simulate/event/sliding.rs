//! Sliding motion along the switching surface of a relation.
//!
//! A. F. Filippov, *Differential Equations with Discontinuous Righthand Sides*, 1988, sec. 4: where
//! the derivatives on both sides of the surface `g = 0` point towards it, the solution stays on it,
//! and its derivative is the convex combination of the two that keeps the indicator `g` constant.

use crate::ir::program::Slot;
use crate::runtime::machine::{Fault, Machine};

/// Displacement along the derivatives for the rate of an indicator, as a fraction of the run.
/// Central differences are exact for indicators that are linear in the states.
const PROBE: f64 = 1e-6;

/// The switching surface of a sliding motion, and memory for its two sides.
pub struct Sliding {
    relation: u32,
    probe: f64,
    displaced: Vec<f64>,
    /// Derivatives with the relation false, and with the relation true.
    sides: [Vec<f64>; 2],
    memory: Vec<f64>,
}

/// Rates of the indicator on both sides of the surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rates {
    /// Rate with the relation false.
    pub when_false: f64,
    /// Rate with the relation true.
    pub when_true: f64,
}

impl Rates {
    /// Weight of the side on which the relation is true; in `[0, 1]` while the solution slides.
    pub fn weight(self) -> f64 {
        self.when_false / (self.when_false - self.when_true)
    }

    /// True if both sides lead to the surface. `rising`: the relation is true for positive
    /// indicators.
    pub fn point_inward(self, rising: bool) -> bool {
        let sign = if rising { 1.0 } else { -1.0 };
        sign * self.when_true < 0.0 && sign * self.when_false > 0.0
    }
}

impl Sliding {
    /// Sliding along the surface of a relation, in a run of length `span`.
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

    /// The relation of the surface.
    pub fn relation(&self) -> u32 {
        self.relation
    }

    /// The last evaluated derivatives with the relation false, and with the relation true.
    pub fn sides(&self) -> [&[f64]; 2] {
        [&self.sides[0], &self.sides[1]]
    }

    /// The rates of the indicator on both sides. Leaves the relation true.
    pub fn rates(&mut self, machine: &mut Machine<'_>, t: f64, y: &[f64]) -> Result<Rates, Fault> {
        let when_false = self.rate(machine, t, y, 0)?;
        let when_true = self.rate(machine, t, y, 1)?;
        Ok(Rates { when_false, when_true })
    }

    /// The derivatives of the sliding motion.
    pub fn derivatives(
        &mut self,
        machine: &mut Machine<'_>,
        t: f64,
        y: &[f64],
        out: &mut [f64],
    ) -> Result<(), Fault> {
        let weight = self.rates(machine, t, y)?.weight();
        if !weight.is_finite() && self.sides[0] == self.sides[1] {
            out.copy_from_slice(&self.sides[0]);
            return Ok(());
        }
        if !weight.is_finite() {
            return Err(machine.fail(Fault::Sliding { relation: self.relation }));
        }
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.sides[0][i] + weight * (self.sides[1][i] - self.sides[0][i]);
            if !out.is_finite() {
                return Err(machine.fail(Fault::Derivative { state: i }));
            }
        }
        Ok(())
    }

    /// Evaluates all variables as combinations of their values on both sides.
    pub fn evaluate_all(
        &mut self,
        machine: &mut Machine<'_>,
        t: f64,
        y: &[f64],
    ) -> Result<(), Fault> {
        let weight = self.rates(machine, t, y)?.weight();
        let weight = if weight.is_finite() { weight } else { 1.0 };
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
        let slots = machine.memory.iter_mut().zip(&self.memory).enumerate();
        for (_, (now, before)) in slots.filter(|(slot, _)| !relations.contains(slot)) {
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

    /// Sets the relation and evaluates the discrete expressions that depend on it.
    pub fn switch(&self, machine: &mut Machine<'_>, truth: usize) -> Result<(), Fault> {
        let slot = machine.program.layout.relations + self.relation as Slot;
        machine.set(slot, truth as f64);
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
