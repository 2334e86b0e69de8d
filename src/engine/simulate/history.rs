//! The histories of delayed expressions and transport lines: their points at events and within steps.

use super::failure::{Failure, of_fault};
use super::run::Simulation;

/// Points per step that are recorded in the histories of delayed variables, at least and at most: as many as cubic
/// polynomials through them need for the tolerance.
const HISTORY_POINTS: u32 = 5;
const MOST_HISTORY_POINTS: u32 = 5 << 10;
/// Error of a cubic polynomial through four points in the middle between them, as a part of a fourth difference: 3/128.
const MIDDLE_ERROR: f64 = 0.0235;

impl Simulation<'_, '_> {
    /// Records the histories of delayed variables and transport lines: the current values (`now`),
    /// or the last step up to `end`.
    pub(super) fn record_history(&mut self, end: f64, now: bool) -> Result<(), Failure> {
        if !self.system.machine.has_history() {
            return Ok(());
        }
        let begin = self.t.max(self.stepper.t_previous());
        if self.system.machine.records_history() && !now {
            return self.record_step(begin, end);
        }
        // Histories that are constant between events need only the end point.
        match now {
            true => {
                let evaluated = self.system.evaluate_all(end, &self.y);
                evaluated.map_err(|f| of_fault(&self.system.machine, f, end))?;
            }
            false => self.evaluate_at(end)?,
        }
        let machine = &mut self.system.machine;
        machine.delays.record(end, &machine.memory, now, begin);
        machine.transports.record(end, &machine.memory, now);
        Ok(())
    }

    /// Records the histories over a step. Delayed expressions may vary faster than the states, whose errors alone determine
    /// the step: they get as many points as cubic polynomials need to follow them to the tolerance.
    fn record_step(&mut self, begin: f64, end: f64) -> Result<(), Failure> {
        let lines = self.system.machine.delays.count();
        let mut samples = std::mem::take(&mut self.history_samples);
        let mut points = HISTORY_POINTS;
        let instant = |k: u32, points: u32| match k == points {
            true => end,
            false => begin + f64::from(k) / f64::from(points) * (end - begin),
        };
        loop {
            samples.clear();
            samples.extend(self.system.machine.delays.last_values());
            for k in 1..=points {
                let t = instant(k, points);
                self.evaluate_at(t)?;
                let machine = &mut self.system.machine;
                samples.extend(machine.delays.sources(&machine.memory));
                if points == HISTORY_POINTS {
                    machine.transports.record(t, &machine.memory, false);
                }
            }
            if points >= MOST_HISTORY_POINTS || are_followed(&samples, lines, self.tolerance) {
                break;
            }
            points *= 2;
        }
        let machine = &mut self.system.machine;
        for (k, values) in (1..=points).zip(samples.chunks(lines.max(1)).skip(1)) {
            machine.delays.record_values(instant(k, points), values, &machine.memory, begin);
        }
        self.history_samples = samples;
        Ok(())
    }
}

/// Whether cubic polynomials through equally spaced samples follow them to the tolerance. `samples`: rows of `lines` values.
fn are_followed(samples: &[f64], lines: usize, tolerance: f64) -> bool {
    (0..lines).all(|line| {
        let value = |row: usize| samples[row * lines + line];
        let rows = samples.len() / lines;
        let size = (0..rows).map(|row| value(row).abs()).fold(0.0, f64::max);
        let fourth_difference = |row: usize| {
            let outer = value(row) + value(row - 4);
            (outer - 4.0 * (value(row - 1) + value(row - 3)) + 6.0 * value(row - 2)).abs()
        };
        let largest = (4..rows).map(fourth_difference).fold(0.0, f64::max);
        MIDDLE_ERROR * largest <= tolerance * size
    })
}
