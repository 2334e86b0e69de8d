//! Values that a recording has for itself, fitted to it alone while everything else stays.
//!
//! A start value or an offset that differs from recording to recording is no property of the model. So a
//! recording that is not fitted with the others gets the values that suit it best before it is compared; for
//! the recordings of the training these values are free parameters among the others.

use crate::numeric::least_squares::{Minimum, NormalEquations, Residuals, Stopping, minimize};
use crate::simulate::failure::Failure;

use super::data::Recording;
use super::parameter::Parameter;
use super::problem::{By, Point, Problem};
use super::statistics::standard_errors;

/// When a fit of own values stops: they are few, and steps are cheap.
const STOPPING: Stopping =
    Stopping { decrease: 1e-7, step: 1e-7, iterations: 40, reach: 1.0, by_data: true };

/// A value that a recording has for itself.
#[derive(Clone, PartialEq, Debug)]
pub struct OwnValue {
    /// The parameter.
    pub name: String,
    /// Its unit, as the model declares it.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// Standard error of the value; infinite if the recording does not determine it.
    pub error: f64,
}

impl Problem<'_> {
    /// The values that a recording has for itself, in coordinates of the search; empty if it has none, or if
    /// they are among the free parameters.
    pub fn own_place(&self, recording: &Recording, x: &[f64]) -> Result<Vec<f64>, Failure> {
        Ok(self.own_minimum(recording, x)?.map(|m| m.x).unwrap_or_default())
    }

    /// The values that a recording has for itself, with the free parameters at `x`.
    pub fn own_values(&self, recording: &Recording, x: &[f64]) -> Result<Vec<OwnValue>, Failure> {
        let named = |p: &Parameter, name: &str, value: f64, error: f64| OwnValue {
            name: name.to_owned(),
            unit: p.unit.clone(),
            value,
            error,
        };
        let Some(found) = self.own_minimum(recording, x)? else { return Ok(Vec::new()) };
        let errors = standard_errors(&found.normal, &self.own, &found.x);
        let all = self.own.iter().zip(&found.x).zip(errors);
        Ok(all.map(|((p, x), error)| named(p, &p.name, p.scale.value(*x), error)).collect())
    }

    fn own_minimum(&self, recording: &Recording, x: &[f64]) -> Result<Option<Minimum>, Failure> {
        let is_fitted = |p: &Parameter| p.only.is_some() && p.acts_in(recording);
        if self.own.is_empty() || self.parameters.iter().any(is_fitted) {
            return Ok(None);
        }
        let mut residuals = OwnResiduals {
            problem: self,
            windows: self.windows(recording),
            free: x,
            failure: None,
        };
        let bounds: Vec<(f64, f64)> = self.own.iter().map(Parameter::range).collect();
        let start = self.own_start(&mut residuals);
        match minimize(&mut residuals, &start, &bounds, &STOPPING) {
            Some(minimum) => Ok(Some(minimum)),
            None => {
                let bug = || Failure::bug(0.0, "the fit of a recording has no result");
                Err(residuals.failure.take().unwrap_or_else(bug))
            }
        }
    }

    /// The best point to begin with: the start of the plan, or the values of a training recording.
    fn own_start(&self, residuals: &mut OwnResiduals<'_, '_>) -> Vec<f64> {
        let planned: Vec<f64> = self.own.iter().map(|p| p.scale.place(p.start)).collect();
        let mut recordings: Vec<&str> = Vec::new();
        for only in self.parameters.iter().filter_map(|p| p.only.as_deref()) {
            if !recordings.contains(&only) {
                recordings.push(only);
            }
        }
        let of_recording = |recording: &str| -> Vec<f64> {
            let own = self.parameters.iter().zip(residuals.free);
            let own = own.filter(|(p, _)| p.only.as_deref() == Some(recording));
            self.own.iter().zip(own).map(|(p, (of, x))| p.scale.place(of.scale.value(*x))).collect()
        };
        let others: Vec<Vec<f64>> = recordings.into_iter().map(of_recording).collect();
        let mut best = (residuals.cost(&planned).unwrap_or(f64::INFINITY), planned);
        for other in others {
            let cost = residuals.cost(&other).unwrap_or(f64::INFINITY);
            if cost < best.0 {
                best = (cost, other);
            }
        }
        best.1
    }
}

/// The residuals of one recording by its own values.
struct OwnResiduals<'a, 'p> {
    problem: &'a Problem<'p>,
    windows: Vec<&'a Recording>,
    free: &'a [f64],
    /// The last failure of a run.
    failure: Option<Failure>,
}

impl OwnResiduals<'_, '_> {
    fn kept<T>(&mut self, outcome: Result<T, Failure>) -> Option<T> {
        outcome.map_err(|failure| self.failure = Some(failure)).ok()
    }
}

impl Residuals for OwnResiduals<'_, '_> {
    fn normal(&mut self, x: &[f64]) -> Option<NormalEquations> {
        let mut normal = NormalEquations::new(x.len());
        let at = Point { free: self.free, own: x };
        for recording in self.windows.clone() {
            let add = |residual: f64, slopes: &[f64]| normal.add(residual, slopes);
            let done = self.problem.each_slope_at(recording, at, By::Own, add);
            self.kept(done)?;
        }
        Some(normal)
    }

    fn cost(&mut self, x: &[f64]) -> Option<f64> {
        let at = Point { free: self.free, own: x };
        let mut sum = 0.0;
        for recording in self.windows.clone() {
            let residuals = self.problem.residuals_at(recording, at);
            let residuals = self.kept(residuals)?;
            sum += residuals.iter().flatten().filter(|r| !r.is_nan()).map(|r| r * r).sum::<f64>();
        }
        Some(sum)
    }
}
