//! Model Exchange: mocc integrates the states, finds the changes of event indicators, and drives the event iteration.

use crate::integrate::options::{OptionError, Options};
use crate::integrate::outcome::Step;
use crate::ir::foreign::{
    AfterEvent, At, Counters, ForeignInstance, ForeignObserver, ForeignOutcome, ForeignShape,
    ForeignTask, Obstacle,
};
use crate::simulate::grid::Grid;
use crate::simulate::method::{Choice, Integrator};
use crate::simulate::options::{MAX_STEP_INTERVALS, MIN_STEPS};
use crate::simulate::settings::Method;

use super::Met;
use super::inputs::Inputs;
use super::integration::{Crossing, Exchanged, Integration, options_of, stop_of};

/// A run in progress.
struct Exchange<'i, 'o, I: ForeignInstance> {
    integration: Integration<&'i mut I, Inputs>,
    observer: &'o mut dyn ForeignObserver,
    grid: Grid,
    stop: f64,
    /// The instant of the last row, s.
    last: f64,
    /// The watched values.
    now: Vec<f64>,
    scratch: Vec<f64>,
    outcome: ForeignOutcome,
}

/// Runs the model.
pub(super) fn run<I: ForeignInstance>(
    shape: &ForeignShape,
    instance: &mut I,
    task: &ForeignTask,
    observer: &mut dyn ForeignObserver,
) -> Result<ForeignOutcome, Met<I::Fault>> {
    let [start, stop] = task.span;
    let started = instance.initialise(task.span, task.tolerance, &task.values);
    let after = started.map_err(|fault| (start, Obstacle::Fault(fault)))?;
    let inputs = Inputs::new(&task.signals, start);
    let options = options(shape, &inputs, task, &after);
    let system = Exchanged::new(instance, inputs, shape);
    let counted = match shape.states {
        1 => "1 state".to_owned(),
        states => format!("{states} states"),
    };
    let wanted = Method::named(&task.method).unwrap_or_default();
    let (method, because) = match (wanted, shape.indicators) {
        (Method::Auto, 0) if shape.states > 0 => (Method::Auto, Some(counted)),
        (Method::Auto, _) => (Method::Radau, Some(format!("{counted}, events"))),
        (method, _) => (method, None),
    };
    let made = Integrator::of(method, because, &system, options);
    let refused = |e: OptionError| (start, Obstacle::Stop(stop_of(e.into())));
    let (stepper, choice) = made.map_err(refused)?;
    let mut integration = Integration::begin(system, stepper, shape, start, &after);
    integration.extent = (stop - start).max(stop.abs());
    let mut run = Exchange {
        scratch: vec![0.0; integration.y.len()],
        integration,
        observer,
        grid: Grid::new(task.span, task.interval, task.instants.clone()),
        stop,
        last: f64::NAN,
        now: vec![0.0; task.watched.len()],
        outcome: ForeignOutcome::default(),
    };
    run.run()?;
    Ok(run.outcome(choice))
}

fn options(
    shape: &ForeignShape,
    inputs: &Inputs,
    task: &ForeignTask,
    after: &AfterEvent,
) -> Options {
    let mut options = options_of(shape, task.tolerance, after);
    options.max_steps = task.most_steps;
    options.max_step = MAX_STEP_INTERVALS * inputs.spacing();
    let span = task.span[1] - task.span[0];
    if span > 0.0 {
        options.max_step = options.max_step.min(task.max_step.unwrap_or(span / MIN_STEPS));
        if shape.states == 0 {
            options.max_step = options.max_step.min(task.spacing);
        }
    }
    options
}

impl<I: ForeignInstance> Exchange<'_, '_, I> {
    /// Goes to the end of the run. An error says when it was met, s.
    fn run(&mut self) -> Result<(), Met<I::Fault>> {
        self.record_now()?;
        self.restart()?;
        while self.integration.t < self.stop && !self.integration.ended {
            let counters = self.counters();
            if self.outcome.interrupted || !self.observer.goes_on(self.integration.t, &counters) {
                self.outcome.interrupted = true;
                break;
            }
            self.step()?;
        }
        Ok(())
    }

    fn outcome(self, choice: Choice) -> ForeignOutcome {
        let counters = self.counters();
        let choice = self.integration.stepper.describe(choice);
        ForeignOutcome {
            counters,
            method: Some((choice.method.to_owned(), choice.because)),
            end: self.integration.t,
            ended: self.integration.ended,
            ..self.outcome
        }
    }

    fn counters(&self) -> Counters {
        self.integration.stepper.stats().to_array()
    }

    fn restart(&mut self) -> Result<(), Met<I::Fault>> {
        self.integration.restart().map_err(|why| (self.integration.t, why))
    }

    /// Records the values at a point.
    fn record(&mut self, t: f64, y: &[f64]) -> Result<(), Met<I::Fault>> {
        let system = &mut self.integration.system;
        system.inputs_at(t);
        let at = At { t, states: &y[..system.states], inputs: &system.inputs };
        let taken = system.instance.values(Some(&at), &mut self.now);
        taken.map_err(|fault| (t, Obstacle::Fault(fault)))?;
        self.put(t);
        Ok(())
    }

    fn put(&mut self, t: f64) {
        self.outcome.interrupted |= !self.observer.row(t, &self.now);
        self.last = t;
    }

    fn record_now(&mut self) -> Result<(), Met<I::Fault>> {
        let y = std::mem::take(&mut self.integration.y);
        let recorded = self.record(self.integration.t, &y);
        self.integration.y = y;
        recorded
    }

    /// One step of the integrator, and what is due at its end.
    fn step(&mut self) -> Result<(), Met<I::Fault>> {
        let breakpoint = self.integration.system.surroundings.next_breakpoint();
        let t_stop = self.integration.next.min(breakpoint).min(self.stop);
        if t_stop <= self.integration.t {
            return self.event("time event of the FMU");
        }
        let stepped = self.integration.step(t_stop);
        let (step, crossing) = stepped.map_err(|why| (self.integration.t, why))?;
        if let Some(Crossing { t, indicator: k }) = crossing {
            self.rows_up_to(t, false)?;
            self.integration.stop_at(t);
            self.outcome.state_events += 1;
            let sign = if self.integration.positive[k] { "negative" } else { "positive" };
            return self.event(&format!("event indicator {} of the FMU became {sign}", k + 1));
        }
        let t = self.integration.stepper.t();
        self.rows_up_to(t, true)?;
        let accepted = self.integration.accept();
        let asks = accepted.map_err(|fault| (t, Obstacle::Fault(fault)))?;
        let reached = matches!(step, Step::Reached { .. });
        if reached && t == breakpoint && self.integration.system.surroundings.advance_past(t) {
            self.outcome.time_events += 1;
            return self.event("an input jumped");
        }
        if reached && t == self.integration.next {
            self.outcome.time_events += 1;
            return self.event("time event of the FMU");
        }
        if asks {
            return self.event("step event of the FMU");
        }
        Ok(())
    }

    /// Rows of the grid in the last step.
    fn rows_up_to(&mut self, end: f64, inclusive: bool) -> Result<(), Met<I::Fault>> {
        while let Some(at) = self.grid.due(end, inclusive) {
            let mut y = std::mem::take(&mut self.scratch);
            self.integration.states_at(at, &mut y);
            let recorded = self.record(at, &y);
            self.scratch = y;
            recorded?;
            self.grid.advance();
        }
        Ok(())
    }

    /// Executes an event at the current point, with a row before and one after it.
    fn event(&mut self, what: &str) -> Result<(), Met<I::Fault>> {
        let t = self.integration.t;
        self.integration.count_event(what).map_err(|why| (t, why))?;
        if self.last != t {
            self.record_now()?;
        }
        self.integration.event().map_err(|fault| (t, Obstacle::Fault(fault)))?;
        self.observer.event(t, what.to_owned());
        if self.integration.ended {
            let taken = self.integration.system.instance.values(None, &mut self.now);
            taken.map_err(|fault| (t, Obstacle::Fault(fault)))?;
            self.put(t);
        } else {
            self.record_now()?;
        }
        while self.grid.due(t, true).is_some() {
            self.grid.advance();
        }
        self.restart()
    }
}
