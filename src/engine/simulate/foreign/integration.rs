//! A foreign model between two of its events: an integrator on its derivatives, and the instants at which its event
//! indicators change sign.
//!
//! In: an instance for Model Exchange, and whatever gives its inputs. Out: steps, each of which ends at the first
//! change of a sign. Whoever drives it decides what is recorded and when an event is executed.

use crate::integrate::options::Options;
use crate::integrate::outcome::Failure;
use crate::integrate::outcome::Step;
use crate::integrate::stepper::JacobianMemory;
use crate::integrate::system::{EvalError, System};
use crate::ir::foreign::{
    AfterEvent, At, ForeignInstance, ForeignShape, InstanceFault, Obstacle, Stop,
};
use crate::simulate::method::Integrator;

/// Width of the bracket of an event, relative to the extent of time: a few spacings of doubles at its end.
const EVENT_TOLERANCE: f64 = 1e-14;
/// Most bisections of an event.
const MOST_BISECTIONS: usize = 200;
/// Points within a step at which indicators are evaluated.
const PROBES: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// Events without noticeable progress after which a run is given up.
const MOST_EVENTS_AT_ONCE: usize = 1000;
/// Noticeable progress, relative to the extent of time.
const PROGRESS: f64 = 1e-10;

/// Whatever gives the inputs of an instance.
pub(super) trait Surroundings {
    /// Adds the inputs at an instant: numbers of values, and the values.
    fn inputs_at(&mut self, t: f64, out: &mut Vec<(usize, f64)>);

    /// Adds what has changed since the last event and can be set only in one: parameters.
    fn changed_parameters(&mut self, out: &mut Vec<(usize, f64)>) {
        let _ = out;
    }
}

/// Integration options for a tolerance and the nominal values of the states.
pub(super) fn options_of(shape: &ForeignShape, tolerance: f64, after: &AfterEvent) -> Options {
    let size = |x: &f64| if x.is_finite() && x.abs() > 0.0 { x.abs() } else { 1.0 };
    let mut nominals: Vec<f64> = after.nominals.iter().map(size).collect();
    nominals.resize(shape.states.max(1), 1.0);
    Options::with_nominals(tolerance, &nominals)
}

/// What the failure of an integrator means.
pub(super) fn stop_of(why: Failure) -> Stop {
    match why {
        Failure::Options(error) => Stop::Options(error.to_string()),
        Failure::StepTooSmall { h, .. } | Failure::NewtonFailed { h, .. } => Stop::StepTooSmall(h),
        Failure::Singular { .. } => Stop::Singular,
        Failure::TooManySteps { steps, .. } => Stop::TooManySteps(steps),
        Failure::Start { .. } | Failure::NonFinite { .. } | Failure::Eval { .. } => Stop::NotFinite,
    }
}

/// The model as a system of differential equations.
pub(super) struct Exchanged<I: ForeignInstance, S> {
    pub instance: I,
    pub surroundings: S,
    /// Number of states; a model without any gets a constant one, which is not passed on.
    pub states: usize,
    differential: Vec<bool>,
    pub inputs: Vec<(usize, f64)>,
    /// The indicators of the last evaluation.
    indicators: Vec<f64>,
    scratch: Vec<f64>,
    /// Derivatives that nobody reads.
    slopes: Vec<f64>,
    /// The last fault.
    fault: Option<I::Fault>,
}

impl<I, S> Exchanged<I, S>
where
    I: ForeignInstance,
    S: Surroundings,
{
    pub fn new(instance: I, surroundings: S, shape: &ForeignShape) -> Self {
        let n = shape.states.max(1);
        Exchanged {
            instance,
            surroundings,
            states: shape.states,
            differential: vec![true; n],
            inputs: Vec::new(),
            indicators: vec![0.0; shape.indicators],
            scratch: vec![0.0; n],
            slopes: vec![0.0; n],
            fault: None,
        }
    }

    pub fn inputs_at(&mut self, t: f64) {
        self.inputs.clear();
        self.surroundings.inputs_at(t, &mut self.inputs);
    }

    /// Evaluates derivatives and indicators.
    fn evaluate(&mut self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), I::Fault> {
        self.inputs_at(t);
        let at = At { t, states: &y[..self.states], inputs: &self.inputs };
        self.instance.evaluate(&at, f, &mut self.indicators)
    }

    fn noted(&mut self, outcome: Result<(), I::Fault>) -> Result<(), EvalError> {
        outcome.map_err(|fault| {
            let error = match fault.is_avoidable() {
                true => EvalError::Recoverable(0),
                false => EvalError::Fatal(0),
            };
            self.fault = Some(fault);
            error
        })
    }

    /// The model has failed for good: another method of integration does not help.
    fn has_failed(&self) -> bool {
        self.fault.as_ref().is_some_and(|fault| !fault.is_avoidable())
    }
}

impl<I, S> System for Exchanged<I, S>
where
    I: ForeignInstance,
    S: Surroundings,
{
    fn dim(&self) -> usize {
        self.states.max(1)
    }

    fn differential(&self) -> &[bool] {
        &self.differential
    }

    fn rhs(&mut self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        if self.states == 0 {
            f.fill(0.0);
            return Ok(());
        }
        if self.has_failed() {
            return Err(EvalError::Fatal(0));
        }
        let outcome = self.evaluate(t, y, f);
        self.noted(outcome)
    }

    fn jacobian(&mut self, t: f64, y: &[f64], j: &mut [f64]) -> Result<(), EvalError> {
        if self.states == 0 {
            return Ok(());
        }
        if self.has_failed() {
            return Err(EvalError::Fatal(0));
        }
        self.inputs_at(t);
        let at = At { t, states: &y[..self.states], inputs: &self.inputs };
        let outcome = self.instance.jacobian(&at, j);
        self.noted(outcome)
    }
}

/// The first change of an indicator's sign within a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// The instant, s.
    pub t: f64,
    /// The position of the indicator.
    pub indicator: usize,
}

/// An integration in progress.
pub(super) struct Integration<I: ForeignInstance, S> {
    pub system: Exchanged<I, S>,
    pub stepper: Integrator,
    needs_completed_steps: bool,
    /// The instant, s.
    pub t: f64,
    /// The states at it.
    pub y: Vec<f64>,
    /// Whether each indicator is positive.
    pub positive: Vec<bool>,
    /// The next time event, s.
    pub next: f64,
    /// The model has ended the run.
    pub ended: bool,
    /// The extent of time that tolerances refer to, s.
    pub extent: f64,
    /// Events since the last progress, and when that was.
    at_once: (usize, f64),
}

impl<I, S> Integration<I, S>
where
    I: ForeignInstance,
    S: Surroundings,
{
    /// Starts at `t` with the state after the initialization.
    pub fn begin(
        system: Exchanged<I, S>,
        stepper: Integrator,
        shape: &ForeignShape,
        t: f64,
        after: &AfterEvent,
    ) -> Self {
        let mut new = Integration {
            y: vec![0.0; system.dim()],
            system,
            stepper,
            needs_completed_steps: shape.needs_completed_steps,
            t,
            positive: Vec::new(),
            next: f64::INFINITY,
            ended: false,
            extent: t.abs(),
            at_once: (0, t),
        };
        new.adopt(after);
        new
    }

    /// Takes over the state after an event.
    fn adopt(&mut self, after: &AfterEvent) {
        let n = self.system.states;
        self.y[..n].copy_from_slice(&after.states);
        self.positive = after.indicators.iter().map(|z| *z > 0.0).collect();
        self.next = after.next.unwrap_or(f64::INFINITY);
        self.ended |= after.ends;
    }

    /// Restarts the integrator at the current point.
    pub fn restart(&mut self) -> Result<(), Obstacle<I::Fault>> {
        if self.ended {
            return Ok(());
        }
        let jacobian = JacobianMemory::Forget;
        let outcome = self.stepper.restart(&mut self.system, self.t, &self.y, jacobian);
        outcome.map_err(|e| self.explained(e))
    }

    /// A failure of the integrator: that of the model, if it caused it.
    fn explained(&mut self, why: Failure) -> Obstacle<I::Fault> {
        let is_final = self.system.has_failed();
        match (self.system.fault.take(), &why) {
            (Some(fault), _) if is_final => Obstacle::Fault(fault),
            (Some(fault), Failure::Eval { .. }) => Obstacle::Fault(fault),
            _ => Obstacle::Stop(stop_of(why)),
        }
    }

    /// One step of the integrator, to `t_stop` at most, and the first change of a sign within it. The current point
    /// stays, until [`stop_at`](Self::stop_at) or [`accept`](Self::accept) moves it.
    pub fn step(&mut self, t_stop: f64) -> Result<(Step, Option<Crossing>), Obstacle<I::Fault>> {
        let outcome = self.stepper.step(&mut self.system, t_stop);
        let step = outcome.map_err(|e| self.explained(e))?;
        self.system.fault = None;
        Ok((step, self.crossing().map_err(Obstacle::Fault)?))
    }

    /// Whether the sign of an indicator has changed at an instant of the last step, and the first of which it has.
    fn changed_at(&mut self, t: f64) -> Result<Option<usize>, I::Fault> {
        if self.system.indicators.is_empty() {
            return Ok(None);
        }
        let mut y = std::mem::take(&mut self.system.scratch);
        let mut f = std::mem::take(&mut self.system.slopes);
        self.stepper.interpolate(t, &mut y);
        let outcome = self.system.evaluate(t, &y, &mut f);
        (self.system.scratch, self.system.slopes) = (y, f);
        outcome?;
        let mut signs = self.system.indicators.iter().map(|z| *z > 0.0).zip(&self.positive);
        Ok(signs.position(|(now, before)| now != *before))
    }

    /// The first instant of the last step, up to a tolerance, at which a sign has changed.
    fn crossing(&mut self) -> Result<Option<Crossing>, I::Fault> {
        let (begin, end) = (self.t, self.stepper.t());
        let mut low = begin;
        let mut high = None;
        for part in PROBES.into_iter().chain([1.0]) {
            let t = if part == 1.0 { end } else { begin + part * (end - begin) };
            if let Some(changed) = self.changed_at(t)? {
                high = Some((t, changed));
                break;
            }
            low = t;
        }
        let Some((mut high, mut indicator)) = high else { return Ok(None) };
        let tolerance = EVENT_TOLERANCE * self.extent;
        for _ in 0..MOST_BISECTIONS {
            let middle = low + 0.5 * (high - low);
            if high - low <= tolerance || middle <= low || middle >= high {
                break;
            }
            match self.changed_at(middle)? {
                None => low = middle,
                Some(earlier) => (high, indicator) = (middle, earlier),
            }
        }
        Ok(Some(Crossing { t: high, indicator }))
    }

    /// Goes to an instant of the last step and forgets the rest of the step.
    pub fn stop_at(&mut self, t: f64) {
        let shortened = self.stepper.shorten(&mut self.system, t);
        if shortened.is_ok() && self.stepper.t() == t {
            self.y.copy_from_slice(self.stepper.y());
        } else {
            self.stepper.interpolate(t, &mut self.y);
        }
        self.t = t;
    }

    /// Goes to the end of the last step, and reports it; whether the model asks for an event.
    pub fn accept(&mut self) -> Result<bool, I::Fault> {
        self.t = self.stepper.t();
        self.y.copy_from_slice(self.stepper.y());
        if !self.needs_completed_steps {
            return Ok(false);
        }
        self.system.inputs_at(self.t);
        let n = self.system.states;
        let at = At { t: self.t, states: &self.y[..n], inputs: &self.system.inputs };
        let after = self.system.instance.complete(&at)?;
        self.ended |= after.ends;
        Ok(after.asks_for_event && !self.ended)
    }

    /// Executes an event at the current point. The integrator must then be restarted.
    pub fn event(&mut self) -> Result<(), I::Fault> {
        let system = &mut self.system;
        system.inputs_at(self.t);
        system.surroundings.changed_parameters(&mut system.inputs);
        system.inputs.sort_by_key(|(value, _)| *value);
        let at = At { t: self.t, states: &self.y[..system.states], inputs: &system.inputs };
        let after = system.instance.event(&at)?;
        self.adopt(&after);
        Ok(())
    }

    /// Counts an event; fails if events follow each other without end.
    pub fn count_event(&mut self, what: &str) -> Result<(), Obstacle<I::Fault>> {
        let (count, since) = &mut self.at_once;
        if self.t - *since > PROGRESS * self.extent {
            (*count, *since) = (0, self.t);
        }
        *count += 1;
        if *count <= MOST_EVENTS_AT_ONCE {
            return Ok(());
        }
        Err(Obstacle::Stop(Stop::Chattering(what.to_owned(), *count, self.t - *since)))
    }

    /// The states at an instant of the last step.
    pub fn states_at(&mut self, t: f64, y: &mut [f64]) {
        if t == self.stepper.t() {
            y.copy_from_slice(self.stepper.y());
        } else {
            self.stepper.interpolate(t, y);
        }
    }
}
