//! Co-Simulation: the model integrates from one communication point to the next. Inputs are held between them.

use crate::ir::foreign::{
    ForeignInstance, ForeignObserver, ForeignOutcome, ForeignShape, ForeignTask, Obstacle, Stop,
};
use crate::simulate::grid::Grid;

use super::Met;
use super::inputs::Inputs;
use super::integration::Surroundings;

/// Instants closer than this part of a step are the same.
const SAME_INSTANT: f64 = 1e-9;

/// The rows of a run in progress.
struct Rows<'t, 'o> {
    task: &'t ForeignTask,
    observer: &'o mut dyn ForeignObserver,
    grid: Grid,
    /// The instant of the last row, s.
    last: f64,
    /// The watched values after the last step.
    now: Vec<f64>,
    /// The observer wants no more.
    interrupted: bool,
}

/// Runs the model.
pub(super) fn run<I: ForeignInstance>(
    shape: &ForeignShape,
    instance: &mut I,
    task: &ForeignTask,
    observer: &mut dyn ForeignObserver,
) -> Result<ForeignOutcome, Met<I::Fault>> {
    let [start, stop] = task.span;
    let fault_at = |t: f64| move |fault: I::Fault| (t, Obstacle::Fault(fault));
    instance.initialise(task.span, task.tolerance, &task.values).map_err(fault_at(start))?;
    let grid = Grid::new(task.span, task.interval, task.instants.clone());
    let now = vec![0.0; task.watched.len()];
    let mut rows = Rows { task, observer, grid, last: f64::NAN, now, interrupted: false };
    instance.values(None, &mut rows.now).map_err(fault_at(start))?;
    rows.put_now(start);
    let mut outcome = ForeignOutcome { end: start, ..ForeignOutcome::default() };
    let wanted = shape.step.filter(|step| *step > 0.0 && *step <= stop - start);
    let size = match (shape.steps_vary, task.instants.is_some()) {
        (true, false) => task.interval,
        _ => wanted.unwrap_or(task.interval),
    };
    let size = task.max_step.map_or(size, |most| size.min(most));
    let mut signals = Inputs::new(&task.signals, start);
    let (mut t, mut inputs, mut before) = (start, Vec::new(), Vec::new());
    let mut number = 0_u64;
    while t < stop - SAME_INSTANT * size {
        if rows.interrupted || !rows.observer.goes_on(t, &outcome.counters) {
            outcome.interrupted = true;
            break;
        }
        // The last instant of the grid is the end.
        let due = rows.grid.due(stop, true).unwrap_or(stop);
        number += 1;
        let mut end = start + number as f64 * size;
        if shape.steps_vary {
            end = end.min(due).min(stop);
            number = ((end - start) / size + SAME_INSTANT).floor() as u64;
        }
        signals.advance_past(t);
        inputs.clear();
        signals.inputs_at(t, &mut inputs);
        before.clone_from(&rows.now);
        let step = instance.step(t, end - t, &inputs).map_err(fault_at(t))?;
        outcome.counters[0] += 1;
        let reached = step.reached.min(end);
        if reached > t {
            instance.values(None, &mut rows.now).map_err(fault_at(reached))?;
            rows.between([t, reached], &before);
            rows.due_at(reached, [SAME_INSTANT * size, stop]);
        } else if !step.ends {
            return Err((t, Obstacle::Stop(Stop::NoStep)));
        }
        t = reached;
        outcome.end = t.min(stop);
        if step.ends {
            if rows.last < t {
                rows.put_now(t);
            }
            outcome.ended = true;
            break;
        }
    }
    Ok(outcome)
}

impl Rows<'_, '_> {
    fn put(&mut self, t: f64, values: &[f64]) {
        self.interrupted |= !self.observer.row(t, values);
        self.last = t;
    }

    /// A row with the values after the last step.
    fn put_now(&mut self, t: f64) {
        let now = std::mem::take(&mut self.now);
        self.put(t, &now);
        self.now = now;
    }

    /// Rows of the grid within a step: Reals on a line, other values as before it.
    fn between(&mut self, span: [f64; 2], before: &[f64]) {
        let [begin, end] = span;
        let near = SAME_INSTANT * (end - begin);
        while let Some(at) = self.grid.due(end - near, false) {
            let part = (at - begin) / (end - begin);
            let pairs = before.iter().zip(&self.now).zip(&self.task.watched);
            let value = |((a, b), (_, is_real)): ((&f64, &f64), &(usize, bool))| {
                if *is_real { a + part * (b - a) } else { *a }
            };
            let values: Vec<f64> = pairs.map(value).collect();
            self.put(at, &values);
            self.grid.advance();
        }
    }

    /// Rows of the grid at a communication point. One that is due within rounding of it keeps its own time, by which it
    /// is known to whoever asked for it.
    fn due_at(&mut self, reached: f64, [near, stop]: [f64; 2]) {
        // Rounding must not lose the last row.
        let until = if reached < stop - near { reached + near } else { stop };
        while let Some(at) = self.grid.due(until, true) {
            self.grid.advance();
            if self.last != at {
                self.put_now(at);
            }
        }
    }
}
