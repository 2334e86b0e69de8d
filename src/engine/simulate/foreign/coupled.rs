//! A foreign model for Model Exchange, driven from one communication point to the next as one for Co-Simulation.
//!
//! In: an instance that gives derivatives. Out: steps; the integrator and the event iteration run here.
//! Inputs are held within a step, so where they change they jump, which is an event.

use crate::base::index::FastSet;
use crate::integrate::options::OptionError;
use crate::integrate::outcome::Step;
use crate::ir::foreign::{AfterStep, At, ForeignInstance, ForeignShape, Obstacle};
use crate::simulate::method::Integrator;
use crate::simulate::settings::Method;

use super::Met;
use super::integration::{Exchanged, Integration, Surroundings, options_of, stop_of};

/// Inputs that keep their values, and parameters on their way to the model.
struct Held {
    /// Values that may be set between events; others are parameters.
    is_input: FastSet<usize>,
    /// All values that were set, sorted by their numbers.
    values: Vec<(usize, f64)>,
    /// Parameters that have changed since the last event.
    changed: Vec<(usize, f64)>,
}

impl Surroundings for Held {
    fn inputs_at(&mut self, _: f64, out: &mut Vec<(usize, f64)>) {
        out.extend(self.values.iter().filter(|(value, _)| self.is_input.contains(value)));
    }

    fn changed_parameters(&mut self, out: &mut Vec<(usize, f64)>) {
        out.append(&mut self.changed);
    }
}

impl Held {
    /// Sets some values; whether one changes.
    fn set(&mut self, new: &[(usize, f64)]) -> bool {
        let mut changed = false;
        for &(value, to) in new {
            match self.values.binary_search_by_key(&value, |(v, _)| *v) {
                Ok(k) if self.values[k].1 == to => continue,
                Ok(k) => self.values[k].1 = to,
                Err(k) => self.values.insert(k, (value, to)),
            }
            if !self.is_input.contains(&value) {
                self.changed.retain(|(v, _)| *v != value);
                self.changed.push((value, to));
            }
            changed = true;
        }
        changed
    }
}

/// A model that steps.
pub struct Coupled<I: ForeignInstance> {
    run: Integration<I, Held>,
}

impl<I: ForeignInstance> Coupled<I> {
    /// Initialises an instance of a model with these numbers and the numbers of its inputs.
    pub fn begin(
        mut instance: I,
        shape: &ForeignShape,
        inputs: &[usize],
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<Coupled<I>, Met<I::Fault>> {
        let start = span[0];
        let started = instance.initialise(span, tolerance, values);
        let after = started.map_err(|fault| (start, Obstacle::Fault(fault)))?;
        let options = options_of(shape, tolerance, &after);
        let is_input = inputs.iter().copied().collect();
        let held = Held { is_input, values: values.to_vec(), changed: Vec::new() };
        let system = Exchanged::new(instance, held, shape);
        let made = Integrator::of(Method::Radau, None, &system, options);
        let refused = |e: OptionError| (start, Obstacle::Stop(stop_of(e.into())));
        let (stepper, _) = made.map_err(refused)?;
        let mut run = Integration::begin(system, stepper, shape, start, &after);
        run.restart().map_err(|why| (start, why))?;
        Ok(Coupled { run })
    }

    /// The instance.
    pub fn instance(&self) -> &I {
        &self.run.system.instance
    }

    /// The watched values after the last step.
    pub fn values(&mut self, values: &mut [f64]) -> Result<(), Met<I::Fault>> {
        let Integration { system, t, y, ended, .. } = &mut self.run;
        system.inputs_at(*t);
        let at = At { t: *t, states: &y[..system.states], inputs: &system.inputs };
        let taken = system.instance.values((!*ended).then_some(&at), values);
        taken.map_err(|fault| (*t, Obstacle::Fault(fault)))
    }

    /// Steps from `t` by `size`, s, with these inputs.
    pub fn step(
        &mut self,
        t: f64,
        size: f64,
        inputs: &[(usize, f64)],
    ) -> Result<AfterStep, Met<I::Fault>> {
        let run = &mut self.run;
        let end = t + size;
        run.extent = run.extent.max(end.abs());
        if run.system.surroundings.set(inputs) && !run.ended {
            self.pass_event("an input jumped")?;
        }
        self.advance(end)?;
        Ok(AfterStep { reached: self.run.t, asks_for_event: false, ends: self.run.ended })
    }

    /// Executes an event and restarts the integrator.
    fn pass_event(&mut self, what: &str) -> Result<(), Met<I::Fault>> {
        let time = self.run.t;
        self.run.count_event(what).map_err(|why| (time, why))?;
        self.run.event().map_err(|fault| (time, Obstacle::Fault(fault)))?;
        self.run.restart().map_err(|why| (time, why))
    }

    /// Steps to `end`, s, or to where the model ends the run.
    fn advance(&mut self, end: f64) -> Result<(), Met<I::Fault>> {
        while self.run.t < end && !self.run.ended {
            let t_stop = self.run.next.min(end);
            if t_stop <= self.run.t {
                self.pass_event("time event of the FMU")?;
                continue;
            }
            let time = self.run.t;
            let (step, crossing) = self.run.step(t_stop).map_err(|why| (time, why))?;
            if let Some(crossing) = crossing {
                self.run.stop_at(crossing.t);
                self.pass_event("event indicator of the FMU")?;
                continue;
            }
            let asks = self.run.accept().map_err(|fault| (time, Obstacle::Fault(fault)))?;
            if matches!(step, Step::Reached { .. }) && self.run.t == self.run.next {
                self.pass_event("time event of the FMU")?;
            } else if asks {
                self.pass_event("step event of the FMU")?;
            }
        }
        Ok(())
    }
}
