//! Runs of one recording: its conditions and inputs, its parameters, and what the signals should have been.

use super::data::{Recording, Split};
use super::parallel;
use super::parameter::Parameter;
use super::problem::{Channel, Point, Problem};
use super::rows::Rows;
use crate::simulate::failure::Failure;
use crate::simulate::run::{Statistics, simulate_to};
use crate::simulate::sensitivity::Input;
use crate::simulate::settings::Settings;

/// Steps after which a run is abandoned, besides those for each row of the recording.
const MAX_STEPS: u64 = 100_000;
/// Further steps for each row of the recording.
const MAX_STEPS_PER_ROW: u64 = 100;

/// A parameter that the runs of a recording take.
pub(super) struct Taken<'p> {
    pub parameter: &'p Parameter,
    pub value: f64,
    /// It is one that the recording has for itself.
    pub is_own: bool,
    /// Its position among those of its kind.
    pub index: usize,
}

impl Problem<'_> {
    /// The parameters that the runs of a recording take.
    pub(super) fn taken<'p>(&'p self, recording: &Recording, at: Point<'_>) -> Vec<Taken<'p>> {
        let taken = |is_own: bool| {
            move |(index, (parameter, x)): (usize, (&'p Parameter, &f64))| Taken {
                parameter,
                value: parameter.scale.value(*x),
                is_own,
                index,
            }
        };
        let free = self.parameters.iter().zip(at.free).enumerate();
        let free = free.filter(|(_, (p, _))| p.acts_in(recording));
        let own = self.own.iter().zip(at.own).enumerate();
        free.map(taken(false)).chain(own.map(taken(true))).collect()
    }

    /// Settings of a run under the conditions of a recording.
    pub(super) fn settings(&self, recording: &Recording, taken: &[Taken<'_>]) -> Settings {
        let mut settings = self.settings.clone();
        let conditions = self.conditions.iter().copied().zip(recording.conditions.iter().copied());
        let set = conditions.filter(|(_, value)| !value.is_nan());
        settings.parameters = set.filter_map(|(v, value)| Some((v?, value))).collect();
        for (target, value) in self.starts.iter().zip(&recording.starts) {
            match *target {
                Input::Parameter(v) => settings.parameters.push((v, *value)),
                Input::Start(v) => settings.starts.push((v, *value)),
            }
        }
        let courses = recording.courses.iter().cloned();
        settings.courses = self.driven.iter().copied().zip(courses).collect();
        for Taken { parameter, value, .. } in taken {
            for target in &parameter.targets {
                match *target {
                    Input::Parameter(v) => settings.parameters.push((v, *value)),
                    Input::Start(v) => settings.starts.push((v, *value)),
                }
            }
        }
        let first = recording.time.first().copied().unwrap_or(settings.start);
        settings.start = recording.start.unwrap_or(settings.start.min(first));
        settings.stop = recording.time.last().copied().unwrap_or(settings.stop);
        settings.instants = Some(recording.time.clone());
        // A model that states no interval is looked at as often as it was recorded.
        let rows = recording.time.len().saturating_sub(1).max(1) as f64;
        settings.spacing = settings.spacing.or(Some((settings.stop - settings.start) / rows));
        // A search passes through values at which a run would take hours; no minimum lies there.
        let most = MAX_STEPS + MAX_STEPS_PER_ROW * recording.time.len() as u64;
        settings.most_steps = match recording.split {
            Split::Train => self.allowance * most.min(self.settings.most_steps),
            // It may be much longer than those that are fitted.
            Split::Validation | Split::Test => most,
        };
        settings
    }

    /// The most steps that a run of a training recording takes at `x`.
    pub fn steps(&self, x: &[f64]) -> Result<u64, Failure> {
        let recordings = self.recordings(Split::Train);
        let of_run = |i: usize| {
            let recording = recordings[i];
            let taken = self.taken(recording, Point { free: x, own: &[] });
            let (_, statistics) = self.run_with(recording, &self.settings(recording, &taken))?;
            Ok(statistics.integration.steps)
        };
        let all = parallel::map(self.jobs, recordings.len(), of_run);
        all.into_iter().try_fold(0, |most, steps| Ok(most.max(steps?)))
    }

    /// The variables of the signals at the instants of a recording, signal by signal, in the units of
    /// the columns.
    pub fn predict(&self, recording: &Recording, x: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        let own = self.own_place(recording, x)?;
        self.predict_at(recording, Point { free: x, own: &own })
    }

    /// The recorded variables at the instants of a recording, in SI units.
    pub(super) fn rows_at(&self, recording: &Recording, at: Point<'_>) -> Result<Rows, Failure> {
        let settings = self.settings(recording, &self.taken(recording, at));
        self.rows_with(recording, &settings)
    }

    /// The same with given settings.
    fn rows_with(&self, recording: &Recording, settings: &Settings) -> Result<Rows, Failure> {
        Ok(self.run_with(recording, settings)?.0)
    }

    /// The rows and the statistics of a run.
    fn run_with(
        &self,
        recording: &Recording,
        settings: &Settings,
    ) -> Result<(Rows, Statistics), Failure> {
        let sizes = [self.program.recorded.len(), 0];
        let run = |rows: &mut Rows| simulate_to(self.program, settings, self.sources, rows);
        Rows::of(&self.cancellation, recording.time.clone(), sizes, run)
    }

    /// For each signal the recorded variable through which a parameter acts on it, if it does, and the factor from its
    /// unit to the noise of the sensor.
    pub(super) fn channels_of(&self, parameter: &Parameter) -> Vec<(Option<usize>, f64)> {
        let of = |(k, c): (usize, &Channel)| {
            let column = match parameter.acts_on {
                Some((only, _)) if only != k => None,
                Some((_, column)) => Some(column),
                None => Some(c.column),
            };
            (column, 1.0 / (c.unit.factor * c.sigma))
        };
        self.channels.iter().enumerate().map(of).collect()
    }

    /// The tolerance of the runs.
    pub(super) fn tolerance(&self) -> f64 {
        self.settings.tolerance
    }

    fn predict_at(&self, recording: &Recording, at: Point<'_>) -> Result<Vec<Vec<f64>>, Failure> {
        let rows = self.rows_at(recording, at)?;
        let of = |c: &Channel| {
            let values =
                rows.values.chunks_exact(rows.width).map(|row| c.unit.of_si(row[c.column]));
            values.collect()
        };
        Ok(self.channels.iter().map(of).collect())
    }

    /// Other recorded variables at the instants of a recording, variable by variable, in SI units; variables
    /// that are not recorded are skipped.
    pub fn others(
        &self,
        recording: &Recording,
        x: &[f64],
        names: &[String],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let own = self.own_place(recording, x)?;
        let taken = self.taken(recording, Point { free: x, own: &own });
        let settings = self.settings(recording, &taken);
        let rows = self.rows_with(recording, &settings)?;
        let column = |name: &String| {
            let k = self.program.recorded.iter().position(|v| self.program.name(*v) == name)?;
            Some(rows.values.chunks_exact(rows.width).map(|row| row[k]).collect())
        };
        Ok(names.iter().filter_map(column).collect())
    }

    /// Residuals of a recording, signal by signal, in units of the noise; NaN without a value.
    pub fn residuals(&self, recording: &Recording, x: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        let own = self.own_place(recording, x)?;
        self.residuals_at(recording, Point { free: x, own: &own })
    }

    /// As [`Problem::residuals`], with given values of the recording's own parameters.
    pub fn residuals_at(
        &self,
        recording: &Recording,
        at: Point<'_>,
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let mut predicted = self.predict_at(recording, at)?;
        for ((p, measured), c) in predicted.iter_mut().zip(&recording.signals).zip(&self.channels) {
            for (p, m) in p.iter_mut().zip(measured) {
                *p = (*p - m) / c.sigma;
            }
        }
        Ok(predicted)
    }

    /// The least and the greatest value of recorded variables over the training recordings.
    pub fn ranges(&self, x: &[f64], names: &[String]) -> Result<Vec<(f64, f64)>, Failure> {
        let recordings = self.recordings(Split::Train);
        let of_run = |i: usize| {
            let recording = recordings[i];
            let settings =
                self.settings(recording, &self.taken(recording, Point { free: x, own: &[] }));
            self.rows_with(recording, &settings).map(|rows| rows.values)
        };
        let runs = parallel::map(self.jobs, recordings.len(), of_run);
        let runs: Vec<Vec<f64>> = runs.into_iter().collect::<Result<_, _>>()?;
        let width = self.program.recorded.len();
        let of = |name: &String| {
            let column = self.program.recorded.iter().position(|v| self.program.name(*v) == name);
            let column = column?;
            let all = runs.iter().flat_map(|run| run.chunks_exact(width).map(move |r| r[column]));
            Some(all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v))))
        };
        Ok(names.iter().map(|n| of(n).unwrap_or((0.0, 0.0))).collect())
    }
}
