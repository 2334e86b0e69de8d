//! Values of an instance: read, set, and tuned while the model runs.

use crate::base::index::Id;
use crate::base::name::string_of_id;
use crate::fmu::exchange::{count_indicators, near};
use crate::fmu::interface::{FIRST_DERIVATIVE, FIRST_INDICATOR};
use crate::fmu::tunable::tunable;
use crate::ir::expr::{Type, VarId};
use crate::ir::program::{RelationTrigger, Slot};

use super::{Instance, Outcome, Phase, Refusal, fatal, unknown_reference};

impl Instance<'_> {
    pub(super) fn variable(&self, reference: u32) -> Outcome<VarId> {
        let v = reference.checked_sub(1).map(VarId);
        let known = v.filter(|v| v.idx() < self.program.blocks.dae.variables.len());
        known.ok_or_else(|| unknown_reference(reference))
    }

    /// The number of a variable: of a Boolean 0 or 1, of a String its id.
    pub fn get(&mut self, reference: u32) -> Outcome<f64> {
        if reference == 0 {
            return Ok(self.time());
        }
        if let Some(k) = reference.checked_sub(FIRST_INDICATOR) {
            return self.indicator(k as usize);
        }
        if let Some(k) = reference.checked_sub(FIRST_DERIVATIVE) {
            let slot = self.program.layout.derivatives.get(k as usize).copied();
            let slot = slot.ok_or_else(|| unknown_reference(reference))?;
            return Ok(self.current()?.get(slot));
        }
        let v = self.variable(reference)?;
        Ok(self.current()?.value(v))
    }

    fn indicator(&mut self, k: usize) -> Outcome<f64> {
        let count = count_indicators(self.program);
        if k >= count {
            return Err(unknown_reference(FIRST_INDICATOR + k as u32));
        }
        if self.stepping.is_some() {
            let state = |trigger: &&RelationTrigger| **trigger == RelationTrigger::State;
            let triggers = self.program.events.relation_triggers.iter().enumerate();
            let at = triggers.filter(|(_, t)| state(t)).nth(k).map_or(0, |(at, _)| at);
            let slot = self.program.layout.indicators + at as Slot;
            return Ok(near(self.current()?.get(slot)));
        }
        let mut all = vec![0.0; count];
        self.initialized()?.indicators(&mut all)?;
        Ok(all[k])
    }

    /// The value of a String.
    pub fn get_string(&mut self, reference: u32) -> Outcome<String> {
        Ok(string_of_id(self.get(reference)? as u32).to_string())
    }

    /// Sets a parameter, a start value or an input, or a state between events of Model Exchange.
    pub fn set(&mut self, reference: u32, value: f64) -> Outcome<()> {
        let v = self.variable(reference)?;
        let name = self.program.name(v);
        if !value.is_finite() {
            return Err(Refusal::of(format!("`{name}` cannot be {value}")));
        }
        let dae = &self.program.blocks.dae;
        if let Type::Enumeration(of) = dae.variables[v].ty {
            let count = dae.graph.enumerations[of].literals.len();
            if !(1.0..=count as f64).contains(&value) {
                let text =
                    format!("`{name}` cannot be {value}: its type has the literals 1 to {count}");
                return Err(Refusal::of(text));
            }
        }
        if let Some(input) = self.inputs.iter_mut().find(|input| input.variable == v) {
            if input.value != Some(value) {
                input.value = Some(value);
                let slot = input.slot;
                self.inputs_changed = true;
                match (self.phase, &mut self.exchange) {
                    (Phase::Instantiated | Phase::Initializing, _) => self.exchange = None,
                    (_, Some(exchange)) => exchange.set_input(slot, value),
                    _ => {
                        self.is_evaluated = false;
                        if let Some(stepping) = &mut self.stepping {
                            stepping.set_input(slot, value);
                        }
                    }
                }
            }
            return Ok(());
        }
        // CasADi sets the states one by one.
        let state = self.program.blocks.states.iter().position(|s| s.variable == v);
        if let (Some(k), Phase::Continuous, Some(exchange)) =
            (state, self.phase, &mut self.exchange)
        {
            exchange.set_state(k, value);
            return Ok(());
        }
        if matches!(self.phase, Phase::Event | Phase::Step) && self.is_tunable(v) {
            return self.tune(v, value);
        }
        if !matches!(self.phase, Phase::Instantiated | Phase::Initializing) {
            return Err(Refusal::of(format!("`{name}` can be set before the run only")));
        }
        let layout = &self.program.layout;
        let list = if layout.parameter_inputs.iter().any(|(p, _)| *p == v) {
            &mut self.settings.parameters
        } else if layout.starts.iter().any(|(s, ..)| *s == v) {
            &mut self.settings.starts
        } else {
            return Err(Refusal::of(format!(
                "`{name}` is computed by the model and cannot be set"
            )));
        };
        list.retain(|(p, _)| *p != v);
        list.push((v, value));
        self.exchange = None;
        Ok(())
    }

    /// Whether a parameter may change while the model runs.
    fn is_tunable(&mut self, v: VarId) -> bool {
        self.tunable.get_or_insert_with(|| tunable(self.program)).contains(&v)
    }

    /// Changes a parameter from here on.
    fn tune(&mut self, v: VarId, value: f64) -> Outcome<()> {
        if self.current()?.value(v) == value {
            return Ok(());
        }
        self.settings.parameters.retain(|(p, _)| *p != v);
        self.settings.parameters.push((v, value));
        match (&mut self.stepping, &mut self.exchange) {
            (Some(stepping), _) => stepping.set_parameter(v, value).map_err(fatal)?,
            (None, Some(exchange)) => exchange.set_parameter(v, value).map_err(fatal)?,
            (None, None) => {}
        }
        self.is_evaluated = false;
        self.inputs_changed = true;
        Ok(())
    }

    /// The type of a variable; time is a Real.
    pub fn type_of(&self, reference: u32) -> Outcome<Type> {
        if reference == 0 || reference >= FIRST_DERIVATIVE {
            return Ok(Type::Real);
        }
        Ok(self.program.blocks.dae.variables[self.variable(reference)?].ty)
    }
}
