//! Directional and adjoint derivatives of an instance in Model Exchange.

use crate::ir::program::Slot;

use super::{Instance, Outcome, Refusal, unknown_reference};
use crate::fmu::interface::FIRST_DERIVATIVE;

impl Instance<'_> {
    /// Derivatives of unknowns along a direction of knowns (states and inputs), with relations held.
    pub fn directional(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        out: &mut [f64],
    ) -> Outcome<()> {
        let known = self.known_slots(knowns)?;
        let unknown = self.unknown_slots(unknowns)?;
        if self.stepping.is_some() {
            return Err(Refusal::of("derivatives are provided in Model Exchange"));
        }
        Ok(self.initialized()?.directional(&unknown, &known, seed, out)?)
    }

    /// The product of the transposed derivative with `seed`: one value for each known.
    pub fn adjoint(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        out: &mut [f64],
    ) -> Outcome<()> {
        let mut column = vec![0.0; unknowns.len()];
        for (known, sum) in knowns.iter().zip(out) {
            self.directional(unknowns, &[*known], &[1.0], &mut column)?;
            *sum = column.iter().zip(seed).map(|(a, b)| a * b).sum();
        }
        Ok(())
    }

    fn known_slots(&self, references: &[u32]) -> Outcome<Vec<Slot>> {
        let states = &self.program.blocks.states;
        let one = |reference: &u32| {
            let v = self.variable(*reference)?;
            if let Some(input) = self.inputs.iter().find(|input| input.variable == v) {
                return Ok(input.slot);
            }
            match states.iter().any(|s| s.variable == v) {
                true => Ok(self.program.slot(v)),
                false => Err(Refusal::of(format!(
                    "`{}` is neither a state nor an input, so there is no derivative by it",
                    self.program.name(v)
                ))),
            }
        };
        references.iter().map(one).collect()
    }

    fn unknown_slots(&self, references: &[u32]) -> Outcome<Vec<Slot>> {
        let one = |reference: &u32| match reference.checked_sub(FIRST_DERIVATIVE) {
            Some(k) => {
                let slot = self.program.layout.derivatives.get(k as usize).copied();
                slot.ok_or_else(|| unknown_reference(*reference))
            }
            None => Ok(self.program.slot(self.variable(*reference)?)),
        };
        references.iter().map(one).collect()
    }
}
