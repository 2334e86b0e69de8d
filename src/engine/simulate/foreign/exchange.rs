//! Model Exchange: mocc integrates the states, finds the changes of event indicators, and drives the event iteration.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::integrate::options::Options;
use crate::integrate::outcome::Step;
use crate::ir::foreign::{AfterEvent, At, ForeignInstance, ForeignInterface};
use crate::ir::trajectory::Event;
use crate::simulate::cause::RunCause;
use crate::simulate::failure::{Failure, of_integration};
use crate::simulate::method::Integrator;
use crate::simulate::options::{MAX_STEP_INTERVALS, MIN_STEPS};
use crate::simulate::record::Sink;
use crate::simulate::run::Statistics;
use crate::simulate::settings::{Method, Settings};

use super::failure;
use super::integration::{Crossing, Exchanged, Integration, Obstacle, Shape, Surroundings};
use super::rows::Rows;

impl Surroundings for &mut Rows<'_> {
    fn inputs_at(&mut self, t: f64, out: &mut Vec<(usize, f64)>) {
        Rows::inputs_at(self, t, out);
    }
}

/// A run in progress.
struct Exchange<'i, 'r, 'p, 's> {
    integration: Integration<&'i mut dyn ForeignInstance, &'r mut Rows<'p>>,
    sink: &'s mut dyn Sink,
    stop: f64,
    scratch: Vec<f64>,
    statistics: Statistics,
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
    let shape = Shape::of(interface);
    let options = options(shape, rows, settings, &after);
    let system = Exchanged::new(instance, rows, shape);
    let counted = match shape.states {
        1 => "1 state".to_owned(),
        states => format!("{states} states"),
    };
    let (method, because) = match (settings.method, shape.indicators) {
        (Method::Auto, 0) if shape.states > 0 => (Method::Auto, Some(counted)),
        (Method::Auto, _) => (Method::Radau, Some(format!("{counted}, events"))),
        (method, _) => (method, None),
    };
    let made = Integrator::of(method, because, &system, options);
    let (stepper, choice) = made.map_err(|e| Failure::settings(e.to_string()))?;
    let mut integration = Integration::begin(system, stepper, shape, start, &after);
    integration.extent = (stop - start).max(stop.abs());
    let mut run = Exchange {
        scratch: vec![0.0; integration.y.len()],
        integration,
        sink,
        stop,
        statistics: Statistics { method: choice, ..Statistics::default() },
    };
    run.record_now()?;
    run.note_end();
    run.restart()?;
    while run.integration.t < run.stop && !run.integration.ended {
        if !run.sink.goes_on(run.integration.t) {
            run.statistics.interrupted = true;
            break;
        }
        run.step()?;
    }
    let mut statistics = run.statistics;
    statistics.end = run.integration.t;
    statistics.integration = *run.integration.stepper.stats();
    statistics.method = run.integration.stepper.describe(statistics.method);
    Ok(statistics)
}

fn options(shape: Shape, rows: &Rows<'_>, settings: &Settings, after: &AfterEvent) -> Options {
    let mut options = shape.options(settings.tolerance, after);
    options.max_steps = settings.most_steps;
    options.max_step = MAX_STEP_INTERVALS * rows.machine.input_signals.spacing();
    let span = settings.stop - settings.start;
    if span > 0.0 {
        options.max_step = options.max_step.min(settings.max_step.unwrap_or(span / MIN_STEPS));
        if shape.states == 0 {
            let interval = settings.spacing.unwrap_or(settings.interval);
            options.max_step = options.max_step.min(interval);
        }
    }
    options
}

impl<'p> Exchange<'_, '_, 'p, '_> {
    fn rows(&mut self) -> &mut Rows<'p> {
        self.integration.system.surroundings
    }

    /// Notes that the model has ended the run.
    fn note_end(&mut self) {
        if self.integration.ended {
            self.statistics.terminated = Some("the FMU ends the run".to_owned());
        }
    }

    /// A failure of the run.
    fn explained(&mut self, why: Obstacle) -> Failure {
        let t = self.integration.t;
        match why {
            Obstacle::Fault(fault) => failure(fault, t),
            Obstacle::Integrator(why) => of_integration(&self.rows().machine, why, t),
        }
    }

    fn restart(&mut self) -> Result<(), Failure> {
        self.integration.restart().map_err(|why| self.explained(why))
    }

    /// Records the values at a point.
    fn record(&mut self, t: f64, y: &[f64]) -> Result<(), Failure> {
        let system = &mut self.integration.system;
        system.inputs_at(t);
        let at = At { t, states: &y[..system.states], inputs: &system.inputs };
        system.surroundings.record(system.instance, t, Some(&at), self.sink)
    }

    fn record_now(&mut self) -> Result<(), Failure> {
        let y = std::mem::take(&mut self.integration.y);
        let outcome = self.record(self.integration.t, &y);
        self.integration.y = y;
        outcome
    }

    /// One step of the integrator, and what is due at its end.
    fn step(&mut self) -> Result<(), Failure> {
        let machine = &self.rows().machine;
        let breakpoint = machine.input_signals.next_breakpoint(&machine.memory);
        let t_stop = self.integration.next.min(breakpoint).min(self.stop);
        if t_stop <= self.integration.t {
            return self.event("time event of the FMU".to_owned());
        }
        let (step, crossing) = self.integration.step(t_stop).map_err(|why| self.explained(why))?;
        if let Some(Crossing { t, indicator: k }) = crossing {
            self.rows_up_to(t, false)?;
            self.integration.stop_at(t);
            self.statistics.state_events += 1;
            let sign = if self.integration.positive[k] { "negative" } else { "positive" };
            return self.event(format!("event indicator {} of the FMU became {sign}", k + 1));
        }
        let t = self.integration.stepper.t();
        self.rows_up_to(t, true)?;
        let asks = self.integration.accept().map_err(|fault| failure(fault, t))?;
        self.note_end();
        let reached = matches!(step, Step::Reached { .. });
        let machine = &mut self.rows().machine;
        if reached && t == breakpoint && machine.input_signals.advance_past(t, &machine.memory) {
            self.statistics.time_events += 1;
            return self.event("an input jumped".to_owned());
        }
        if reached && t == self.integration.next {
            self.statistics.time_events += 1;
            return self.event("time event of the FMU".to_owned());
        }
        if asks {
            return self.event("step event of the FMU".to_owned());
        }
        Ok(())
    }

    /// Rows of the grid in the last step.
    fn rows_up_to(&mut self, end: f64, inclusive: bool) -> Result<(), Failure> {
        while let Some(at) = self.rows().recorder.due(end, inclusive) {
            let mut y = std::mem::take(&mut self.scratch);
            self.integration.states_at(at, &mut y);
            let outcome = self.record(at, &y);
            self.scratch = y;
            outcome?;
            self.rows().recorder.advance();
        }
        Ok(())
    }

    /// Executes an event at the current point, with a row before and one after it.
    fn event(&mut self, what: String) -> Result<(), Failure> {
        self.check_progress(&what)?;
        let t = self.integration.t;
        if !self.rows().recorder.has_row_at(t) {
            self.record_now()?;
        }
        self.integration.event().map_err(|fault| failure(fault, t))?;
        self.note_end();
        // Rows before an event come first.
        let system = &mut self.integration.system;
        system.surroundings.recorder.flush(self.sink);
        self.sink.event(Event { time: t, what, place: String::new() });
        if self.integration.ended {
            system.surroundings.record(system.instance, t, None, self.sink)?;
        } else {
            self.record_now()?;
        }
        while self.rows().recorder.due(t, true).is_some() {
            self.rows().recorder.advance();
        }
        self.restart()
    }

    /// Fails if events follow each other without end.
    fn check_progress(&mut self, what: &str) -> Result<(), Failure> {
        let Some((events, since)) = self.integration.stuck() else { return Ok(()) };
        let time = self.integration.t;
        let relation = what.to_owned();
        let cause = RunCause::Chattering { time, relation, events, duration: time - since };
        Err(Failure::numerics(time, Diagnostic::new(cause, Span::NONE)))
    }
}
