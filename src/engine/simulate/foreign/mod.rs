//! Runs of foreign models.
//!
//! In: a program whose variables are inputs, and the foreign model that computes them. Out: the same rows, events and
//! statistics as those of any other run.
//!
//! A run has two sides, which may be in different processes: thousands of calls lead to a few hundred rows. [`run_to`]
//! makes a task of the settings, and writes the rows of the model to the memory of the program ([`rows`]), in which
//! measures are evaluated. [`carry_out`] does the task with an instance: [`exchange`] integrates it ([`integration`]),
//! [`stepping`] lets it integrate itself.

pub mod coupled;
mod exchange;
mod inputs;
mod integration;
mod rows;
mod stepping;

use std::time::Instant;

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::integrate::stats::Stats;
use crate::ir::foreign::{
    Counters, Foreign, ForeignFailure, ForeignFault, ForeignFaultKind, ForeignInstance,
    ForeignObserver, ForeignOutcome, ForeignShape, ForeignTask, Obstacle, Stop,
};
use crate::ir::program::Program;
use crate::ir::trajectory::Event;

use self::rows::Rows;
use super::cause::{NonFinite, RunCause};
use super::failure::{Failure, FailureKind};
use super::method::Choice;
use super::record::Sink;
use super::run::Statistics;
use super::sensitivity::Input;
use super::settings::{Method, Settings};

/// Why a run cannot go on, and when that was met, s.
pub type Met<F> = (f64, Obstacle<F>);

/// Carries out a run with an instance.
pub fn carry_out<I: ForeignInstance>(
    shape: &ForeignShape,
    instance: &mut I,
    task: &ForeignTask,
    observer: &mut dyn ForeignObserver,
) -> Result<ForeignOutcome, Met<I::Fault>> {
    match shape.steps_itself {
        true => stepping::run(shape, instance, task, observer),
        false => exchange::run(shape, instance, task, observer),
    }
}

/// Runs a foreign model.
pub(super) fn run_to(
    foreign: &Foreign,
    program: &Program,
    settings: &Settings,
    inputs: &[Input],
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    if !inputs.is_empty() {
        // Calibrations then take differences.
        let cause =
            RunCause::NoSensitivities { time: settings.start, why: "an FMU does not provide them" };
        return Err(Failure::numerics(settings.start, Diagnostic::new(cause, Span::NONE)));
    }
    if program.order() > 0 {
        return Err(Failure::settings(
            "a measure of an FMU cannot hold an integral or a derivative".to_owned(),
        ));
    }
    let started = Instant::now();
    let mut rows = Rows::new(foreign, program, settings)?;
    let task = rows.task(settings);
    let mut recording = Recording { rows, sink, has_begun: false, failure: None };
    let outcome = foreign.model.run(&task, &mut recording);
    let Recording { mut rows, sink, failure, .. } = recording;
    rows.recorder.flush(sink);
    sink.end();
    if let Some(failure) = failure {
        return Err(failure);
    }
    let ForeignOutcome { counters, method, state_events, time_events, end, ended, interrupted } =
        outcome.map_err(explained)?;
    let method = method.map_or(Choice { method: "the FMU", because: None }, |(name, because)| {
        Choice { method: Method::named(&name).unwrap_or_default().name(), because }
    });
    Ok(Statistics {
        integration: Stats::from(counters),
        method,
        state_events,
        time_events,
        rows: rows.count,
        elapsed: started.elapsed(),
        end,
        terminated: ended.then(|| "the FMU ends the run".to_owned()),
        interrupted,
        extrema: rows.extrema(),
        ..Statistics::default()
    })
}

/// Writes rows and events to a sink.
struct Recording<'p, 's> {
    rows: Rows<'p>,
    sink: &'s mut dyn Sink,
    has_begun: bool,
    /// A row could not be recorded.
    failure: Option<Failure>,
}

impl ForeignObserver for Recording<'_, '_> {
    fn row(&mut self, t: f64, values: &[f64]) -> bool {
        if !self.has_begun {
            self.rows.begin(self.sink);
            self.has_begun = true;
        }
        self.rows.advance_inputs(t, false);
        match self.rows.put(t, values, self.sink) {
            Ok(()) => true,
            Err(failure) => {
                self.failure = Some(failure);
                false
            }
        }
    }

    fn event(&mut self, t: f64, what: String) {
        // Rows before an event come first.
        self.rows.recorder.flush(self.sink);
        self.rows.advance_inputs(t, true);
        self.sink.event(Event { time: t, what, place: String::new() });
    }

    fn goes_on(&mut self, t: f64, _: &Counters) -> bool {
        self.sink.goes_on(t)
    }
}

/// The failure of a run in the user's names.
fn explained(ForeignFailure { time, why }: ForeignFailure) -> Failure {
    match why {
        Obstacle::Fault(ForeignFault { kind, diagnostic }) => {
            let kind = match kind {
                ForeignFaultKind::Input => FailureKind::Settings,
                ForeignFaultKind::Final => FailureKind::Numerics,
            };
            Failure { kind, time, diagnostic }
        }
        Obstacle::Stop(Stop::Options(why)) => Failure::settings(why),
        Obstacle::Stop(stop) => {
            Failure::numerics(time, Diagnostic::new(cause_of(stop, time), Span::NONE))
        }
    }
}

/// Why integration cannot go on at an instant, s, as a diagnostic says it.
pub fn cause_of(stop: Stop, time: f64) -> RunCause {
    match stop {
        Stop::Options(what) => RunCause::Bug { what },
        Stop::StepTooSmall(step) => RunCause::StepTooSmall { time, step, state: None },
        Stop::Singular => RunCause::SingularIteration { time, state: None },
        Stop::TooManySteps(limit) => RunCause::TooManySteps { time, limit },
        Stop::NotFinite => RunCause::NotFinite { time, value: NonFinite::Unnamed("a derivative") },
        Stop::Chattering(relation, events, duration) => {
            RunCause::Chattering { time, relation, events, duration }
        }
        Stop::NoStep => RunCause::ForeignNoStep { time },
    }
}
