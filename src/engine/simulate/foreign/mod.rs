//! Runs of foreign models.
//!
//! In: a program whose variables are inputs, and the foreign model that computes them. Out: the same rows, events and
//! statistics as those of any other run. [`exchange`] integrates the model ([`integration`]), [`stepping`] lets it
//! integrate itself; both write its values to the memory of the program ([`rows`]), in which measures are evaluated.

pub mod coupled;
mod exchange;
mod integration;
mod rows;
mod stepping;

use std::time::Instant;

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::foreign::{Foreign, ForeignFault, ForeignFaultKind};
use crate::ir::program::Program;

use self::rows::Rows;
use super::cause::RunCause;
use super::failure::{Failure, FailureKind};
use super::record::Sink;
use super::run::Statistics;
use super::sensitivity::Input;
use super::settings::Settings;

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
    let interface = foreign.model.interface();
    let mut rows = Rows::new(foreign, program, settings)?;
    let made = foreign.model.instantiate(&rows.watched());
    let mut instance = made.map_err(|fault| failure(fault, settings.start))?;
    let outcome = match interface.steps_itself {
        true => stepping::run(interface, &mut *instance, &mut rows, settings, sink),
        false => exchange::run(interface, &mut *instance, &mut rows, settings, sink),
    };
    rows.recorder.flush(sink);
    sink.end();
    let mut statistics = outcome?;
    instance.end();
    drop(instance);
    statistics.rows = rows.count;
    statistics.extrema = rows.extrema();
    statistics.elapsed = started.elapsed();
    Ok(statistics)
}

/// A fault of the model as a failure of the run.
fn failure(fault: ForeignFault, time: f64) -> Failure {
    let kind = match fault.kind {
        ForeignFaultKind::Input => FailureKind::Settings,
        ForeignFaultKind::Avoidable | ForeignFaultKind::Final => FailureKind::Numerics,
    };
    Failure { kind, time, diagnostic: fault.diagnostic }
}
