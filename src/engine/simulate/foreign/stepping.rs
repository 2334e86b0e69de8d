//! Co-Simulation: the model integrates from one communication point to the next. Inputs are held between them.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::foreign::{ForeignInstance, ForeignInterface};
use crate::simulate::cause::RunCause;
use crate::simulate::failure::Failure;
use crate::simulate::method::Choice;
use crate::simulate::record::Sink;
use crate::simulate::run::Statistics;
use crate::simulate::settings::Settings;

use super::failure;
use super::rows::Rows;

/// Instants closer than this part of a step are the same.
const SAME_INSTANT: f64 = 1e-9;

/// Runs the model.
pub(super) fn run(
    interface: &ForeignInterface,
    instance: &mut dyn ForeignInstance,
    rows: &mut Rows<'_>,
    settings: &Settings,
    sink: &mut dyn Sink,
) -> Result<Statistics, Failure> {
    let Settings { start, stop, tolerance, .. } = *settings;
    let interval = rows.interval;
    let values = rows.overridden(start);
    let started = instance.initialise([start, stop], tolerance, &values);
    started.map_err(|fault| failure(fault, start))?;
    rows.begin(sink);
    rows.record(instance, start, None, sink)?;
    let method = Choice { method: "the FMU", because: None };
    let mut statistics = Statistics { method, end: start, ..Statistics::default() };
    let are_real = rows.are_real();
    let wanted = interface.experiment[2].filter(|step| *step > 0.0 && *step <= stop - start);
    let size = match (interface.steps_vary, settings.instants.is_some()) {
        (true, false) => interval,
        _ => wanted.unwrap_or(interval),
    };
    let size = settings.max_step.map_or(size, |most| size.min(most));
    let (mut t, mut inputs) = (start, Vec::new());
    let mut number = 0_u64;
    while t < stop - SAME_INSTANT * size {
        if !sink.goes_on(t) {
            statistics.interrupted = true;
            break;
        }
        // The last instant of the grid is the end.
        let due = rows.recorder.due(stop, true).unwrap_or(stop);
        number += 1;
        let mut end = start + number as f64 * size;
        if interface.steps_vary {
            end = end.min(due).min(stop);
            number = ((end - start) / size + SAME_INSTANT).floor() as u64;
        }
        rows.machine.input_signals.advance_past(t, &rows.machine.memory);
        inputs.clear();
        rows.inputs_at(t, &mut inputs);
        let before = rows.now.clone();
        let step = instance.step(t, end - t, &inputs).map_err(|fault| failure(fault, t))?;
        statistics.integration.steps += 1;
        let reached = step.reached.min(end);
        if reached > t {
            let mut after = before.clone();
            let taken = instance.values(None, &mut after);
            taken.map_err(|fault| failure(fault, reached))?;
            between(rows, [t, reached], [&before, &after], &are_real, sink)?;
            rows.now = after;
            due_at(rows, reached, [SAME_INSTANT * size, stop], sink)?;
        } else if !step.ends {
            let diagnostic = Diagnostic::new(RunCause::ForeignNoStep { time: t }, Span::NONE);
            return Err(Failure::numerics(t, diagnostic));
        }
        t = reached;
        statistics.end = t.min(stop);
        if step.ends {
            if !rows.recorder.has_row_since(t) {
                rows.put(t, sink)?;
            }
            statistics.terminated = Some("the FMU ends the run".to_owned());
            break;
        }
    }
    Ok(statistics)
}

/// Rows of the grid within a step: Reals on a line, other values as before it.
fn between(
    rows: &mut Rows<'_>,
    span: [f64; 2],
    values: [&[f64]; 2],
    are_real: &[bool],
    sink: &mut dyn Sink,
) -> Result<(), Failure> {
    let [begin, end] = span;
    let near = SAME_INSTANT * (end - begin);
    while let Some(at) = rows.recorder.due(end - near, false) {
        let part = (at - begin) / (end - begin);
        let pairs = values[0].iter().zip(values[1]).zip(are_real);
        let value = |((a, b), is_real): ((&f64, &f64), &bool)| {
            if *is_real { a + part * (b - a) } else { *a }
        };
        rows.now = pairs.map(value).collect();
        rows.put(at, sink)?;
        rows.recorder.advance();
    }
    Ok(())
}

/// Rows of the grid at a communication point. One that is due within rounding of it keeps its own time, by which it is
/// known to whoever asked for it.
fn due_at(
    rows: &mut Rows<'_>,
    reached: f64,
    [near, stop]: [f64; 2],
    sink: &mut dyn Sink,
) -> Result<(), Failure> {
    // Rounding must not lose the last row.
    let until = if reached < stop - near { reached + near } else { stop };
    while let Some(at) = rows.recorder.due(until, true) {
        rows.recorder.advance();
        if !rows.recorder.has_row_at(at) {
            rows.put(at, sink)?;
        }
    }
    Ok(())
}
