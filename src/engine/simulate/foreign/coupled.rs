//! A foreign model for Model Exchange, driven from one communication point to the next as one for Co-Simulation.
//!
//! In: an instance that gives derivatives. Out: a [`SteppingInstance`]: the integrator and the event iteration run here.
//! Inputs are held within a step, so where they change they jump, which is an event.

use std::sync::Arc;

use crate::base::diag::Diagnostic;
use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::integrate::options::OptionError;
use crate::integrate::outcome::Step;
use crate::ir::foreign::{
    AfterStep, At, ForeignFault, ForeignFaultKind, ForeignInstance, ForeignInterface, ForeignRole,
    SteppingInstance,
};
use crate::simulate::cause::{NonFinite, RunCause};
use crate::simulate::method::Integrator;
use crate::simulate::settings::Method;

use super::integration::{Exchanged, Integration, Obstacle, Shape, Surroundings};

/// An instance of the model.
type Instance = Box<dyn ForeignInstance + Send>;

/// Inputs that keep their values, and parameters on their way to the model.
struct Held {
    /// Values that may be set between events; others are parameters.
    is_input: Arc<FastSet<usize>>,
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

/// Whether the instance runs.
enum Phase {
    /// Before its initialization.
    Made(Instance),
    /// After it.
    Runs(Box<Integration<Instance, Held>>),
    /// An operation has failed.
    Gone,
}

/// The instance that steps.
pub struct Coupled {
    shape: Shape,
    is_input: Arc<FastSet<usize>>,
    phase: Phase,
}

impl Coupled {
    /// Wraps an instance of a model with this interface.
    pub fn new(instance: Instance, interface: &ForeignInterface) -> Coupled {
        let inputs = interface.variables.iter().filter(|v| v.role == ForeignRole::Input);
        let is_input = Arc::new(inputs.map(|v| v.value).collect());
        Coupled { shape: Shape::of(interface), is_input, phase: Phase::Made(instance) }
    }

    fn running(&mut self) -> Result<&mut Integration<Instance, Held>, ForeignFault> {
        match &mut self.phase {
            Phase::Runs(run) => Ok(run),
            _ => Err(gone()),
        }
    }
}

/// The fault of an instance that is used before or after its run.
fn gone() -> ForeignFault {
    fault_of(RunCause::Bug { what: "an instance of an FMU is used outside of its run".to_owned() })
}

fn fault_of(cause: RunCause) -> ForeignFault {
    let diagnostic = Box::new(Diagnostic::new(cause, Span::NONE));
    ForeignFault { kind: ForeignFaultKind::Final, diagnostic }
}

/// A failure on the way at `time`, s.
fn explained(why: Obstacle, time: f64) -> ForeignFault {
    use crate::integrate::outcome::Failure;
    match why {
        Obstacle::Fault(fault) => fault,
        Obstacle::Integrator(why) => fault_of(match why {
            Failure::StepTooSmall { h, .. } | Failure::NewtonFailed { h, .. } => {
                RunCause::StepTooSmall { time, step: h, state: None }
            }
            Failure::Singular { .. } => RunCause::SingularIteration { time, state: None },
            Failure::TooManySteps { steps, .. } => RunCause::TooManySteps { time, limit: steps },
            _ => RunCause::NotFinite { time, value: NonFinite::Unnamed("a derivative") },
        }),
    }
}

impl Integration<Instance, Held> {
    /// Executes an event and restarts the integrator.
    fn pass_event(&mut self, what: &str) -> Result<(), ForeignFault> {
        let time = self.t;
        if let Some((events, since)) = self.stuck() {
            let (relation, duration) = (what.to_owned(), time - since);
            return Err(fault_of(RunCause::Chattering { time, relation, events, duration }));
        }
        self.event()?;
        self.restart().map_err(|why| explained(why, time))
    }

    /// Steps to `end`, s, or to where the model ends the run.
    fn advance(&mut self, end: f64) -> Result<(), ForeignFault> {
        while self.t < end && !self.ended {
            let t_stop = self.next.min(end);
            if t_stop <= self.t {
                self.pass_event("time event of the FMU")?;
                continue;
            }
            let time = self.t;
            let (step, crossing) = self.step(t_stop).map_err(|why| explained(why, time))?;
            if let Some(crossing) = crossing {
                self.stop_at(crossing.t);
                self.pass_event("event indicator of the FMU")?;
                continue;
            }
            let asks = self.accept()?;
            if matches!(step, Step::Reached { .. }) && self.t == self.next {
                self.pass_event("time event of the FMU")?;
            } else if asks {
                self.pass_event("step event of the FMU")?;
            }
        }
        Ok(())
    }
}

impl SteppingInstance for Coupled {
    fn initialise(
        &mut self,
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<(), ForeignFault> {
        let Phase::Made(mut instance) = std::mem::replace(&mut self.phase, Phase::Gone) else {
            return Err(gone());
        };
        let start = span[0];
        let after = ForeignInstance::initialise(&mut *instance, span, tolerance, values)?;
        let options = self.shape.options(tolerance, &after);
        let is_input = Arc::clone(&self.is_input);
        let held = Held { is_input, values: values.to_vec(), changed: Vec::new() };
        let system = Exchanged::new(instance, held, self.shape);
        let made = Integrator::of(Method::Radau, None, &system, options);
        let refused = |e: OptionError| explained(Obstacle::Integrator(e.into()), start);
        let (stepper, _) = made.map_err(refused)?;
        let mut run = Integration::begin(system, stepper, self.shape, start, &after);
        run.restart().map_err(|why| explained(why, start))?;
        self.phase = Phase::Runs(Box::new(run));
        Ok(())
    }

    fn values(&mut self, values: &mut [f64]) -> Result<(), ForeignFault> {
        let Integration { system, t, y, ended, .. } = self.running()?;
        system.inputs_at(*t);
        let at = At { t: *t, states: &y[..system.states], inputs: &system.inputs };
        ForeignInstance::values(&mut *system.instance, (!*ended).then_some(&at), values)
    }

    fn step(
        &mut self,
        t: f64,
        size: f64,
        inputs: &[(usize, f64)],
    ) -> Result<AfterStep, ForeignFault> {
        let run = self.running()?;
        let end = t + size;
        run.extent = run.extent.max(end.abs());
        if run.system.surroundings.set(inputs) && !run.ended {
            run.pass_event("an input jumped")?;
        }
        run.advance(end)?;
        Ok(AfterStep { reached: run.t, asks_for_event: false, ends: run.ended })
    }

    fn renew(&mut self) -> Result<(), ForeignFault> {
        let mut instance = match std::mem::replace(&mut self.phase, Phase::Gone) {
            Phase::Made(instance) => instance,
            Phase::Runs(run) => run.system.instance,
            Phase::Gone => return Err(gone()),
        };
        ForeignInstance::renew(&mut *instance)?;
        self.phase = Phase::Made(instance);
        Ok(())
    }
}
