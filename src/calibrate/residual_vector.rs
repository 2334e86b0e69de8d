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
        let all = self.each(&self.recordings(Split::Train), &x, Wanted::Slopes);
        let mut all = all.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
        for row in all.chunks_exact_mut(by_value.len().max(1)) {
            row.iter_mut().zip(&by_value).for_each(|(slope, factor)| *slope *= factor);
        }
        Ok(all)
    }

    /// Calls `take` with every residual of the training recordings that are not trimmed and its derivatives by the
    /// coordinates of the search. Errors: the first recording that cannot be simulated.
    pub fn each_row(&self, x: &[f64], mut take: impl FnMut(f64, &[f64])) -> Result<(), Failure> {
        let recordings = self.fitted();
        let of = |wanted| self.each(&recordings, x, wanted);
        for (residuals, slopes) in of(Wanted::Residuals).into_iter().zip(of(Wanted::Slopes)) {
            let rows = slopes?;
            let rows = rows.chunks_exact(self.parameters.len().max(1));
            residuals?.iter().zip(rows).for_each(|(residual, row)| take(*residual, row));
        }
        Ok(())
    }

    /// The coordinates of the search of these values.
    fn places(&self, values: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(values).map(|(p, v)| p.scale.place(*v)).collect()
    }
}
