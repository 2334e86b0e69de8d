//! Derivatives of the residuals of a recording.
//!
//! They are propagated with the run (`simulate::sensitivity`): they are exact, even across events. Where they do not
//! exist, central differences take their place.

use super::data::Recording;
use super::problem::{By, Point, Problem};
use super::recording_run::Taken;
use super::rows::Rows;
use crate::numeric::least_squares::NormalEquations;
use crate::simulate::failure::Failure;
use crate::simulate::run::simulate_with_known_sensitivities;
use crate::simulate::sensitivity::Input;

impl Problem<'_> {
    /// The normal equations of one recording.
    pub fn normal_of(&self, recording: &Recording, x: &[f64]) -> Result<NormalEquations, Failure> {
        let mut normal = NormalEquations::new(self.parameters.len());
        self.each_slope(recording, x, |residual, slopes| normal.add(residual, slopes))?;
        Ok(normal)
    }

    /// Every residual of a recording with its derivatives by the search parameters.
    pub fn each_slope(
        &self,
        recording: &Recording,
        x: &[f64],
        take: impl FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let own = self.own_place(recording, x)?;
        self.each_slope_at(recording, Point { free: x, own: &own }, By::Free, take)
    }

    /// The same by the free parameters, or by the recording's own.
    pub fn each_slope_at(
        &self,
        recording: &Recording,
        at: Point<'_>,
        by: By,
        mut take: impl FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let taken = self.taken(recording, at);
        let settings = self.settings(recording, &taken);
        // Only parameters that the recording takes have derivatives; those of the others are zero.
        let moved: Vec<&Taken<'_>> = taken.iter().filter(|t| t.is_own == (by == By::Own)).collect();
        let inputs: Vec<Input> =
            moved.iter().flat_map(|t| t.parameter.targets.iter().copied()).collect();
        let width = self.program.recorded.len();
        let (program, sources) = (self.program, self.sources);
        let run = |rows: &mut Rows| {
            simulate_with_known_sensitivities(program, &settings, &inputs, sources, rows)
        };
        let ran = Rows::of(&self.cancellation, recording.time.clone(), [width, inputs.len()], run);
        let (rows, unknown) = match ran {
            Ok((rows, statistics)) => {
                let hidden = hidden_parameters(&moved, &statistics.hidden);
                (rows, self.differences(recording, at, by, &hidden)?)
            }
            Err(failure) if failure.is_without_derivatives() => {
                return self.each_difference(recording, at, by, take);
            }
            Err(failure) => return Err(failure),
        };
        let channels: Vec<Vec<(Option<usize>, f64)>> =
            moved.iter().map(|t| self.channels_of(t.parameter)).collect();
        let mut slopes = vec![0.0; self.count_of(by)];
        for k in 0..recording.time.len() {
            let row = &rows.values[k * width..(k + 1) * width];
            let all = &rows.slopes[k * width * inputs.len()..(k + 1) * width * inputs.len()];
            for (channel, (c, signal)) in self.channels.iter().zip(&recording.signals).enumerate() {
                if signal[k].is_nan() {
                    continue;
                }
                let residual = (c.unit.of_si(row[c.column]) - signal[k]) / c.sigma;
                let mut first = 0;
                for (Taken { parameter: p, value, index, .. }, channels) in
                    moved.iter().zip(&channels)
                {
                    let (column, factor) = channels[channel];
                    let sum: f64 = column.map_or(0.0, |column| {
                        let at = column * inputs.len() + first;
                        all[at..at + p.targets.len()].iter().sum()
                    });
                    first += p.targets.len();
                    let known = sum * p.scale.slope(*value) * factor;
                    slopes[*index] = unknown.slope(*index, k, channel).unwrap_or(known);
                }
                take(residual, &slopes);
            }
        }
        Ok(())
    }

    /// As `each_slope_at`, by differences alone.
    fn each_difference(
        &self,
        recording: &Recording,
        at: Point<'_>,
        by: By,
        mut take: impl FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        let here = self.residuals_at(recording, at)?;
        let all: Vec<usize> = (0..self.count_of(by)).collect();
        let differences = self.differences(recording, at, by, &all)?;
        let mut slopes = vec![0.0; all.len()];
        for k in 0..recording.time.len() {
            for (c, signal) in here.iter().enumerate().filter(|(_, signal)| !signal[k].is_nan()) {
                for (index, slope) in slopes.iter_mut().enumerate() {
                    *slope = differences.slope(index, k, c).unwrap_or(0.0);
                }
                take(signal[k], &slopes);
            }
        }
        Ok(())
    }

    /// Number of parameters of one kind.
    fn count_of(&self, by: By) -> usize {
        match by {
            By::Free => self.parameters.len(),
            By::Own => self.own.len(),
        }
    }
}

/// The positions of the parameters with an input, of those of all `moved` in order, by which there are no derivatives.
fn hidden_parameters(moved: &[&Taken<'_>], hidden: &[usize]) -> Vec<usize> {
    let mut first = 0;
    let is_hidden = |t: &&&Taken<'_>| {
        let own = first..first + t.parameter.targets.len();
        first = own.end;
        hidden.iter().any(|k| own.contains(k))
    };
    moved.iter().filter(is_hidden).map(|t| t.index).collect()
}
