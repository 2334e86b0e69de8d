//! All residuals of the training recordings as one vector, and its derivatives, for other optimizers and samplers.
//!
//! Residuals are in units of the noise, recording by recording, instant by instant, signal by signal; values that were
//! not measured have none.

use super::data::Split;
use super::parallel;
use super::problem::Problem;
use crate::simulate::failure::Failure;

impl Problem<'_> {
    /// The residuals at these values of the free parameters, in their units. Errors: the first recording that cannot be
    /// simulated.
    pub fn residual_vector(&self, values: &[f64]) -> Result<Vec<f64>, Failure> {
        let x = self.places(values);
        let recordings = self.recordings(Split::Train);
        let of_run = |i: usize| self.residuals(recordings[i], &x);
        let all = parallel::map(self.jobs, recordings.len(), of_run);
        let mut out = Vec::with_capacity(self.count(Split::Train));
        for (residuals, recording) in all.into_iter().zip(&recordings) {
            let residuals = residuals?;
            for k in 0..recording.time.len() {
                out.extend(residuals.iter().map(|signal| signal[k]).filter(|r| !r.is_nan()));
            }
        }
        Ok(out)
    }

    /// The derivatives of these residuals by the values of the free parameters, residual by residual, in 1 by the unit of
    /// the parameter. Errors: the first recording that cannot be simulated.
    pub fn jacobian(&self, values: &[f64]) -> Result<Vec<f64>, Failure> {
        let x = self.places(values);
        let by_value: Vec<f64> =
            self.parameters.iter().zip(values).map(|(p, v)| 1.0 / p.scale.slope(*v)).collect();
        let recordings = self.recordings(Split::Train);
        let of_run = |i: usize| {
            let mut rows = Vec::new();
            self.each_slope(recordings[i], &x, |_, slopes| {
                rows.extend(slopes.iter().zip(&by_value).map(|(slope, f)| slope * f));
            })?;
            Ok(rows)
        };
        let all: Vec<Result<Vec<f64>, Failure>> =
            parallel::map(self.jobs, recordings.len(), of_run);
        let all = all.into_iter().collect::<Result<Vec<_>, _>>()?;
        Ok(all.concat())
    }

    /// The coordinates of the search of these values.
    fn places(&self, values: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(values).map(|(p, v)| p.scale.place(*v)).collect()
    }
}
