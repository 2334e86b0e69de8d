//! Model Exchange: mocc integrates the states, finds the changes of event indicators, and drives the event iteration.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::integrate::options::Options;
use crate::integrate::outcome::Step;
use crate::integrate::stepper::JacobianMemory;
use crate::integrate::system::{EvalError, System};
use crate::ir::foreign::{
    AfterEvent, At, ForeignFault, ForeignFaultKind, ForeignInstance, ForeignInterface,
};
use crate::ir::trajectory::Event;
use crate::simulate::cause::RunCause;
use crate::simulate::failure::{Failure, of_integration};
use crate::simulate::method::Integrator;
use crate::simulate::options::{MAX_STEP_INTERVALS, MIN_STEPS};
use crate::simulate::record::Sink;
use crate::simulate::run::Statistics;
use crate::simulate::settings::{Method, Settings};

use super::failure;
use super::rows::Rows;

/// Width of the bracket of an event, relative to the run: a few spacings of doubles at its end.
const EVENT_TOLERANCE: f64 = 1e-14;
/// Most bisections of an event.
const MOST_BISECTIONS: usize = 200;
/// Points within a step at which indicators are evaluated.
const PROBES: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// Events without noticeable progress after which a run is given up.
const MOST_EVENTS_AT_ONCE: usize = 1000;
/// Noticeable progress, relative to the run.
const PROGRESS: f64 = 1e-10;

/// The model as a system of differential equations.
struct Exchanged<'a, 'p> {
    instance: &'a mut dyn ForeignInstance,
    rows: &'a mut Rows<'p>,
    /// Number of states; a model without any gets a constant one, which is not passed on.
    states: usize,
    differential: Vec<bool>,
    inputs: Vec<(usize, f64)>,
    /// The indicators of the last evaluation.
    indicators: Vec<f64>,
    scratch: Vec<f64>,
    /// Derivatives that nobody reads.
    slopes: Vec<f64>,
    /// The last fault.
    fault: Option<ForeignFault>,
}

impl Exchanged<'_, '_> {
    fn inputs_at(&mut self, t: f64) {
        self.inputs.clear();
        self.rows.inputs_at(t, &mut self.inputs);
    }

    /// Evaluates derivatives and indicators.
    fn evaluate(&mut self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), ForeignFault> {
        self.inputs_at(t);
        let at = At { t, states: &y[..self.states], inputs: &self.inputs };
        self.instance.evaluate(&at, f, &mut self.indicators)
    }

    fn noted(&mut self, outcome: Result<(), ForeignFault>) -> Result<(), EvalError> {
        outcome.map_err(|fault| {
            let error = match fault.kind {
                ForeignFaultKind::Avoidable => EvalError::Recoverable(0),
                _ => EvalError::Fatal(0),
            };
            self.fault = Some(fault);
            error
        })
    }

    /// The model has failed for good: another method of integration does not help.
    fn has_failed(&self) -> bool {
        self.fault.as_ref().is_some_and(|fault| fault.kind != ForeignFaultKind::Avoidable)
    }
}

impl System for Exchanged<'_, '_> {
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

/// A run in progress.
struct Exchange<'a, 'p, 's> {
    system: Exchanged<'a, 'p>,
    stepper: Integrator,
    sink: &'s mut dyn Sink,
    needs_completed_steps: bool,
    t: f64,
    y: Vec<f64>,
    /// Whether each indicator is positive.
    positive: Vec<bool>,
    next: f64,
    start: f64,
    stop: f64,
    ended: bool,
    statistics: Statistics,
    /// Events since the last progress, and when that was.
    at_once: (usize, f64),
}

/// Runs the model.
pub(super) fn run(
    interface: &ForeignInterface,
    instance: &mut dyn ForeignInstance,
    rows: &mut Rows<'_>,
    settings: &Settings,
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    let (start, stop) = (settings.start, settings.stop);
    let values = rows.overridden(start);
    let started = instance.initialise([start, stop], settings.tolerance, &values);
    let after = started.map_err(|fault| failure(fault, start))?;
    rows.begin(sink);
    let n = interface.states.max(1);
    let options = options(interface, rows, settings, &after);
    let mut system = Exchanged {
        instance,
        rows,
        states: interface.states,
        differential: vec![true; n],
        inputs: Vec::new(),
        indicators: vec![0.0; interface.indicators],
        scratch: vec![0.0; n],
        slopes: vec![0.0; n],
        fault: None,
    };
    let counted = match interface.states {
        1 => "1 state".to_owned(),
        states => format!("{states} states"),
    };
    let (method, because) = match (settings.method, interface.indicators) {
        (Method::Auto, 0) if interface.states > 0 => (Method::Auto, Some(counted)),
        (Method::Auto, _) => (Method::Radau, Some(format!("{counted}, events"))),
        (method, _) => (method, None),
    };
    let made = Integrator::of(method, because, &system, options);
    let (stepper, choice) = made.map_err(|e| Failure::settings(e.to_string()))?;
    let mut y = after.states.clone();
    y.resize(n, 0.0);
    system.record(start, &y, sink)?;
    let mut run = Exchange {
        system,
        stepper,
        sink,
        needs_completed_steps: interface.needs_completed_steps,
        t: start,
        y,
        positive: Vec::new(),
        next: f64::INFINITY,
        start,
        stop,
        ended: false,
        statistics: Statistics { method: choice, ..Statistics::default() },
        at_once: (0, start),
    };
    run.adopt(&after);
    run.restart()?;
    while run.t < run.stop && !run.ended {
        if !run.sink.goes_on(run.t) {
            run.statistics.interrupted = true;
            break;
        }
        run.step()?;
    }
    let mut statistics = run.statistics;
    statistics.end = run.t;
    statistics.integration = *run.stepper.stats();
    statistics.method = run.stepper.describe(statistics.method);
    Ok(statistics)
}

fn options(
    interface: &ForeignInterface,
    rows: &Rows<'_>,
    settings: &Settings,
    after: &AfterEvent,
) -> Options {
    let size = |x: &f64| if x.is_finite() && x.abs() > 0.0 { x.abs() } else { 1.0 };
    let mut nominals: Vec<f64> = after.nominals.iter().map(size).collect();
    nominals.resize(interface.states.max(1), 1.0);
    let mut options = Options::with_nominals(settings.tolerance, &nominals);
    options.max_steps = settings.most_steps;
    options.max_step = MAX_STEP_INTERVALS * rows.machine.input_signals.spacing();
    let span = settings.stop - settings.start;
    if span > 0.0 {
        options.max_step = options.max_step.min(settings.max_step.unwrap_or(span / MIN_STEPS));
        if interface.states == 0 {
            let interval = settings.spacing.unwrap_or(settings.interval);
            options.max_step = options.max_step.min(interval);
        }
    }
    options
}

impl Exchanged<'_, '_> {
    /// Records the values at a point.
    fn record(&mut self, t: f64, y: &[f64], sink: &mut dyn Sink) -> Result<(), Failure> {
        self.inputs_at(t);
        let at = At { t, states: &y[..self.states], inputs: &self.inputs };
        self.rows.record(self.instance, t, Some(&at), sink)
    }
}

impl Exchange<'_, '_, '_> {
    /// Takes over the state after an event.
    fn adopt(&mut self, after: &AfterEvent) {
        let n = self.system.states;
        self.y[..n].copy_from_slice(&after.states);
        self.positive = after.indicators.iter().map(|z| *z > 0.0).collect();
        self.next = after.next.unwrap_or(f64::INFINITY);
        if after.ends {
            self.ended = true;
            self.statistics.terminated = Some("the FMU ends the run".to_owned());
        }
    }

    fn restart(&mut self) -> Result<(), Failure> {
        if self.ended {
            return Ok(());
        }
        let jacobian = JacobianMemory::Forget;
        let outcome = self.stepper.restart(&mut self.system, self.t, &self.y, jacobian);
        outcome.map_err(|e| self.explained(e))
    }

    /// A failure of the integrator: that of the model, if it caused it.
    fn explained(&mut self, why: crate::integrate::outcome::Failure) -> Failure {
        use crate::integrate::outcome::Failure as Integration;
        let is_final = self.system.has_failed();
        match (self.system.fault.take(), &why) {
            (Some(fault), _) if is_final => failure(fault, self.t),
            (Some(fault), Integration::Eval { .. }) => failure(fault, self.t),
            _ => of_integration(&self.system.rows.machine, why, self.t),
        }
    }

    /// Whether the sign of an indicator has changed at an instant of the last step, and the first of which it has.
    fn changed_at(&mut self, t: f64) -> Result<Option<usize>, Failure> {
        if self.system.indicators.is_empty() {
            return Ok(None);
        }
        let mut y = std::mem::take(&mut self.system.scratch);
        let mut f = std::mem::take(&mut self.system.slopes);
        self.stepper.interpolate(t, &mut y);
        let outcome = self.system.evaluate(t, &y, &mut f);
        (self.system.scratch, self.system.slopes) = (y, f);
        outcome.map_err(|fault| failure(fault, t))?;
        let mut signs = self.system.indicators.iter().map(|z| *z > 0.0).zip(&self.positive);
        Ok(signs.position(|(now, before)| now != *before))
    }

    /// The first instant of the last step, up to a tolerance, at which a sign has changed, and which.
    fn crossing(&mut self) -> Result<Option<(f64, usize)>, Failure> {
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
        let Some((mut high, mut changed)) = high else { return Ok(None) };
        let tolerance = EVENT_TOLERANCE * (self.stop - self.start).max(self.stop.abs());
        for _ in 0..MOST_BISECTIONS {
            let middle = low + 0.5 * (high - low);
            if high - low <= tolerance || middle <= low || middle >= high {
                break;
            }
            match self.changed_at(middle)? {
                None => low = middle,
                Some(earlier) => (high, changed) = (middle, earlier),
            }
        }
        Ok(Some((high, changed)))
    }

    /// One step of the integrator, and what is due at its end.
    fn step(&mut self) -> Result<(), Failure> {
        let machine = &self.system.rows.machine;
        let breakpoint = machine.input_signals.next_breakpoint(&machine.memory);
        let t_stop = self.next.min(breakpoint).min(self.stop);
        if t_stop <= self.t {
            return self.event("time event of the FMU".to_owned());
        }
        let outcome = self.stepper.step(&mut self.system, t_stop);
        let step = outcome.map_err(|e| self.explained(e))?;
        self.system.fault = None;
        if let Some((at, k)) = self.crossing()? {
            self.rows_up_to(at, false)?;
            let shortened = self.stepper.shorten(&mut self.system, at);
            if shortened.is_ok() && self.stepper.t() == at {
                self.y.copy_from_slice(self.stepper.y());
            } else {
                self.stepper.interpolate(at, &mut self.y);
            }
            self.t = at;
            self.statistics.state_events += 1;
            let sign = if self.positive[k] { "negative" } else { "positive" };
            return self.event(format!("event indicator {} of the FMU became {sign}", k + 1));
        }
        let t = self.stepper.t();
        self.rows_up_to(t, true)?;
        self.t = t;
        self.y.copy_from_slice(self.stepper.y());
        let asks = self.complete()?;
        let reached = matches!(step, Step::Reached { .. });
        let machine = &mut self.system.rows.machine;
        if reached && t == breakpoint && machine.input_signals.advance_past(t, &machine.memory) {
            self.statistics.time_events += 1;
            return self.event("an input jumped".to_owned());
        }
        if reached && t == self.next {
            self.statistics.time_events += 1;
            return self.event("time event of the FMU".to_owned());
        }
        if asks && !self.ended {
            return self.event("step event of the FMU".to_owned());
        }
        Ok(())
    }

    /// Reports the step; whether the model asks for an event.
    fn complete(&mut self) -> Result<bool, Failure> {
        if !self.needs_completed_steps {
            return Ok(false);
        }
        self.system.inputs_at(self.t);
        let n = self.system.states;
        let at = At { t: self.t, states: &self.y[..n], inputs: &self.system.inputs };
        let after = self.system.instance.complete(&at).map_err(|fault| failure(fault, self.t))?;
        if after.ends {
            self.ended = true;
            self.statistics.terminated = Some("the FMU ends the run".to_owned());
        }
        Ok(after.asks_for_event)
    }

    /// Rows of the grid in the last step.
    fn rows_up_to(&mut self, end: f64, inclusive: bool) -> Result<(), Failure> {
        while let Some(at) = self.system.rows.recorder.due(end, inclusive) {
            let mut y = std::mem::take(&mut self.system.scratch);
            if at == self.stepper.t() {
                y.copy_from_slice(self.stepper.y());
            } else {
                self.stepper.interpolate(at, &mut y);
            }
            let outcome = self.system.record(at, &y, self.sink);
            self.system.scratch = y;
            outcome?;
            self.system.rows.recorder.advance();
        }
        Ok(())
    }

    /// Executes an event at the current point, with a row before and one after it.
    fn event(&mut self, what: String) -> Result<(), Failure> {
        self.check_progress(&what)?;
        let t = self.t;
        if !self.system.rows.recorder.has_row_at(t) {
            self.system.record(t, &self.y, self.sink)?;
        }
        self.system.inputs_at(t);
        let n = self.system.states;
        let at = At { t, states: &self.y[..n], inputs: &self.system.inputs };
        let after = self.system.instance.event(&at).map_err(|fault| failure(fault, t))?;
        self.adopt(&after);
        let place = String::new();
        // Rows before an event come first.
        self.system.rows.recorder.flush(self.sink);
        self.sink.event(Event { time: t, what, place });
        if self.ended {
            self.system.rows.record(self.system.instance, t, None, self.sink)?;
        } else {
            self.system.record(t, &self.y, self.sink)?;
        }
        while self.system.rows.recorder.due(t, true).is_some() {
            self.system.rows.recorder.advance();
        }
        self.restart()
    }

    /// Fails if events follow each other without end.
    fn check_progress(&mut self, what: &str) -> Result<(), Failure> {
        let (count, since) = &mut self.at_once;
        if self.t - *since > PROGRESS * (self.stop - self.start) {
            (*count, *since) = (0, self.t);
        }
        *count += 1;
        if *count <= MOST_EVENTS_AT_ONCE {
            return Ok(());
        }
        let cause = RunCause::Chattering {
            time: self.t,
            relation: what.to_owned(),
            events: *count,
            duration: self.t - *since,
        };
        Err(Failure::numerics(self.t, Diagnostic::new(cause, Span::NONE)))
    }
}
