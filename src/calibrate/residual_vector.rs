//! All residuals of the training recordings as one vector, and its derivatives, for other optimizers and samplers.
//!
//! Residuals are in units of the noise, recording by recording, instant by instant, signal by signal; values that were
//! not measured have none.

use super::data::Split;
use super::elsewhere::Wanted;
use super::problem::Problem;
use crate::simulate::failure::Failure;

impl Problem<'_> {
    /// The residuals at these values of the free parameters, in their units. Errors: the first recording that cannot be
    /// simulated.
    pub fn residual_vector(&self, values: &[f64]) -> Result<Vec<f64>, Failure> {
        let x = self.places(values);
        let all = self.each(&self.recordings(Split::Train), &x, Wanted::Residuals);
        Ok(all.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
    }

    /// The derivatives of these residuals by the values of the free parameters, residual by residual, in 1 by the unit of
    /// the parameter. Errors: the first recording that cannot be simulated.
    pub fn jacobian(&self, values: &[f64]) -> Result<Vec<f64>, Failure> {
        let x = self.places(values);
        let by_value: Vec<f64> =
            self.parameters.iter().zip(values).map(|(p, v)| 1.0 / p.scale.slope(*v)).collect();
        let mut all = Vec::new();
        for rows in self.each(&self.recordings(Split::Train), &x, Wanted::Rows) {
            for row in rows?.chunks_exact(1 + by_value.len()) {
                all.extend(row[1..].iter().zip(&by_value).map(|(slope, factor)| slope * factor));
            }
        }
        Ok(all)
    }

    /// The coordinates of the search of these values.
    fn places(&self, values: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(values).map(|(p, v)| p.scale.place(*v)).collect()
    }
}
