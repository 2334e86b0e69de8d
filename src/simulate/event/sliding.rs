//! Motion along the surface on which a relation switches.
//!
//! A. F. Filippov, *Differential Equations with Discontinuous Righthand Sides*, 1988, sec. 4: where
//! the derivatives on both sides of the surface `gap = 0` point towards it, the solution stays on
//! it, and its derivative is that convex combination of the two that keeps the gap.

use crate::ir::program::Slot;
use crate::runtime::machine::{Fault, Instance};

/// A displacement along the derivatives by which the rate of a gap is found, as a part of the run:
/// central differences of a gap that is linear in the states are exact.
const PROBE: f64 = 1e-6;

/// The surface that the solution stays on, and memory for the two sides.
pub struct Sliding {
    relation: u32,
    probe: f64,
    moved: Vec<f64>,
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
    pub fn part(self) -> f64 {
        self.when_false / (self.when_false - self.when_true)
    }

    /// Both sides lead to the surface; `rising`: the relation is true for positive gaps.
    pub fn meet(self, rising: bool) -> bool {
        let sign = if rising { 1.0 } else { -1.0 };
        sign * self.when_true < 0.0 && sign * self.when_false > 0.0
    }
}

impl Sliding {
    /// Along the surface of a relation, in a run of length `span`.
    pub fn along(relation: u32, instance: &Instance<'_>, span: f64) -> Sliding {
        let n = instance.program.order();
        let zeros = || vec![0.0; n];
        Sliding {
            relation,
            probe: PROBE * span,
            moved: zeros(),
            sides: [zeros(), zeros()],
            memory: vec![0.0; instance.memory.len()],
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
    pub fn rates(
        &mut self,
        instance: &mut Instance<'_>,
        t: f64,
        y: &[f64],
    ) -> Result<Rates, Fault> {
        let when_false = self.rate(instance, t, y, 0)?;
        let when_true = self.rate(instance, t, y, 1)?;
        Ok(Rates { when_false, when_true })
    }

    /// The derivatives along the surface, from the rates there.
    pub fn derivatives(
        &mut self,
        instance: &mut Instance<'_>,
        t: f64,
        y: &[f64],
        out: &mut [f64],
    ) -> Result<(), Fault> {
        let part = self.rates(instance, t, y)?.part();
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.sides[0][i] + part * (self.sides[1][i] - self.sides[0][i]);
            if !out.is_finite() {
                return Err(instance.fail(Fault::Derivative { state: i }));
            }
        }
        Ok(())
    }

    /// Leaves in the memory, for each variable, the combination of its values on both sides.
    pub fn evaluate_all(
        &mut self,
        instance: &mut Instance<'_>,
        t: f64,
        y: &[f64],
    ) -> Result<(), Fault> {
        let part = self.rates(instance, t, y)?.part();
        for truth in [0, 1] {
            self.switch(instance, truth)?;
            let program = instance.program;
            instance.place(t, y);
            instance.run(&program.rhs)?;
            instance.run(&program.roots)?;
            instance.run(&program.rest)?;
            if truth == 0 {
                self.memory.copy_from_slice(&instance.memory);
            }
        }
        let relations = self.relation_cells(instance);
        let cells = instance.memory.iter_mut().zip(&self.memory).enumerate();
        for (_, (now, before)) in cells.filter(|(slot, _)| !relations.contains(slot)) {
            if *now != *before && now.is_finite() && before.is_finite() {
                *now = before + part * (*now - before);
            }
        }
        Ok(())
    }

    fn relation_cells(&self, instance: &Instance<'_>) -> std::ops::Range<usize> {
        let first = instance.program.layout.relations as usize;
        first..first + instance.program.watches.len()
    }

    /// Puts the relation to one of its values, with what depends on it.
    pub fn switch(&self, instance: &mut Instance<'_>, truth: usize) -> Result<(), Fault> {
        let cell = instance.program.layout.relations + self.relation as Slot;
        instance.set(cell, truth as f64);
        instance.run(&instance.program.held)
    }

    fn rate(
        &mut self,
        instance: &mut Instance<'_>,
        t: f64,
        y: &[f64],
        truth: usize,
    ) -> Result<f64, Fault> {
        self.switch(instance, truth)?;
        instance.derivatives(t, y, &mut self.sides[truth])?;
        let program = instance.program;
        let gap = program.layout.gaps + self.relation as Slot;
        let mut gaps = [0.0; 2];
        for (gap_there, h) in gaps.iter_mut().zip([-self.probe, self.probe]) {
            for ((moved, y), slope) in self.moved.iter_mut().zip(y).zip(&self.sides[truth]) {
                *moved = y + h * slope;
            }
            instance.place(t + h, &self.moved);
            instance.run(&program.rhs)?;
            instance.run(&program.roots)?;
            *gap_there = instance.get(gap);
        }
        Ok((gaps[1] - gaps[0]) / (2.0 * self.probe))
    }
}
