//! Derivatives of residuals by differences of runs, for parameters by which a run cannot be differentiated: those of an
//! FMU, and those that act on one.
//!
//! A run of an FMU has noise: its integrator stops at its tolerance, and takes other steps for other values. So the step
//! of a difference is chosen by what it changes: enough to stand out from the noise, and about as much as the sensors can
//! just see, where the residuals are still straight.

use crate::simulate::failure::Failure;

use super::data::Recording;
use super::parameter::{Parameter, Scale};
use super::problem::{By, Point, Problem};
use super::rows::Rows;

/// First displacement of a parameter, in coordinates of the search: the third root of the solver's tolerance balances its
/// noise against truncation.
const FIRST_STEP: f64 = 1e-2;
/// Change of a residual that a displacement should make, in units of the sensors' noise.
const WANTED_CHANGE: f64 = 0.3;
/// The same in units of the noise of runs.
const WANTED_OVER_NOISE: f64 = 100.0;
/// Changes, relative to the wanted one, that are as good.
const GOOD_CHANGES: [f64; 2] = [0.1, 100.0];
/// Displacements that are tried.
const MOST_TRIALS: usize = 4;
/// Largest factor from one displacement to the next.
const LARGEST_FACTOR: f64 = 1e4;
/// Largest displacement of a positive parameter: by half of itself.
const LARGEST_OF_POSITIVE: f64 = 0.5;

/// Derivatives of the residuals of a recording by some parameters.
pub(super) struct Differences {
    /// For each parameter its position, and its derivatives: row by row, signal by signal.
    slopes: Vec<(usize, Vec<f64>)>,
    signals: usize,
}

impl Differences {
    /// The derivative of a residual by the parameter at `index`, if it is among them.
    pub(super) fn slope(&self, index: usize, row: usize, signal: usize) -> Option<f64> {
        let (_, slopes) = self.slopes.iter().find(|(at, _)| *at == index)?;
        Some(slopes[row * self.signals + signal])
    }
}

/// How the residuals follow from the recorded variables: for each signal the variable, if the parameter acts on it, and the
/// factor from its unit to the noise of the sensor.
type Channels = [(Option<usize>, f64)];

impl Problem<'_> {
    /// Differences by the parameters at these positions, of the free ones or of the recording's own.
    pub(super) fn differences(
        &self,
        recording: &Recording,
        at: Point<'_>,
        by: By,
        indices: &[usize],
    ) -> Result<Differences, Failure> {
        let here = self.rows_at(recording, at)?;
        let mut slopes = Vec::with_capacity(indices.len());
        for index in indices {
            slopes.push((*index, self.difference(recording, at, (by, *index), &here)?));
        }
        Ok(Differences { slopes, signals: recording.signals.len() })
    }

    fn difference(
        &self,
        recording: &Recording,
        at: Point<'_>,
        (by, index): (By, usize),
        here: &Rows,
    ) -> Result<Vec<f64>, Failure> {
        let parameter = match by {
            By::Free => &self.parameters[index],
            By::Own => &self.own[index],
        };
        let channels = self.channels_of(parameter);
        if by == By::Free && !parameter.acts_in(recording) {
            return Ok(vec![0.0; recording.time.len() * channels.len()]);
        }
        let displaced = |distance: f64| {
            let (mut free, mut own) = (at.free.to_vec(), at.own.to_vec());
            let place = if by == By::Free { &mut free[index] } else { &mut own[index] };
            *place += distance;
            self.rows_at(recording, Point { free: &free, own: &own })
        };
        let noise = self.tolerance() * largest(here, &channels);
        let (step, above) = chosen_step(parameter, here, &channels, noise, &displaced);
        // Where one side cannot be simulated, the other serves.
        let (above, below, width) = match (above, displaced(-step)) {
            (Ok(above), Ok(below)) => (above, below, 2.0 * step),
            (Ok(above), Err(_)) => (above, here.clone(), step),
            (Err(_), Ok(below)) => (here.clone(), below, step),
            (Err(failure), Err(_)) => return Err(failure),
        };
        let rows = above.values.chunks_exact(here.width).zip(below.values.chunks_exact(here.width));
        let of_row = |(a, b): (&[f64], &[f64])| -> Vec<f64> {
            let of = |(column, factor): &(Option<usize>, f64)| {
                column.map_or(0.0, |k| (a[k] - b[k]) * factor / width)
            };
            channels.iter().map(of).collect()
        };
        Ok(rows.flat_map(of_row).collect())
    }
}

/// A displacement that changes the residuals noticeably but not much, and the run with it.
fn chosen_step(
    parameter: &Parameter,
    here: &Rows,
    channels: &Channels,
    noise: f64,
    displaced: &dyn Fn(f64) -> Result<Rows, Failure>,
) -> (f64, Result<Rows, Failure>) {
    let wanted = WANTED_CHANGE.max(WANTED_OVER_NOISE * noise);
    let largest_step = match parameter.scale {
        Scale::Positive { .. } => LARGEST_OF_POSITIVE,
        Scale::Linear { .. } => f64::INFINITY,
    };
    let mut step = FIRST_STEP;
    let mut above = displaced(step);
    for _ in 1..MOST_TRIALS {
        let factor = match &above {
            Ok(above) => {
                let change = change(here, above, channels);
                if change >= GOOD_CHANGES[0] * wanted && change <= GOOD_CHANGES[1] * wanted {
                    break;
                }
                (wanted / change).clamp(1.0 / LARGEST_FACTOR, LARGEST_FACTOR)
            }
            Err(_) => 0.1,
        };
        let next = (factor * step).min(largest_step);
        if next == step {
            break;
        }
        step = next;
        above = displaced(step);
    }
    (step, above)
}

/// The greatest change of a residual from one run to another.
fn change(here: &Rows, there: &Rows, channels: &Channels) -> f64 {
    let rows = here.values.chunks_exact(here.width).zip(there.values.chunks_exact(here.width));
    let of_row = |(a, b): (&[f64], &[f64])| {
        let of = |(column, factor): &(Option<usize>, f64)| {
            column.map_or(0.0, |k| ((a[k] - b[k]) * factor).abs())
        };
        channels.iter().map(of).fold(0.0, f64::max)
    };
    rows.map(of_row).fold(0.0, f64::max)
}

/// The greatest signal of a run, in units of the sensors' noise.
fn largest(rows: &Rows, channels: &Channels) -> f64 {
    let of_row = |row: &[f64]| {
        let of = |(column, factor): &(Option<usize>, f64)| {
            column.map_or(0.0, |k| (row[k] * factor).abs())
        };
        channels.iter().map(of).fold(0.0, f64::max)
    };
    rows.values.chunks_exact(rows.width).map(of_row).fold(0.0, f64::max)
}
