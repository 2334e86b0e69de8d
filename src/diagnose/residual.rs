//! The residuals of each recording without effects and with them.

use std::sync::Arc;

use crate::base::diag::Problems;
use crate::calibrate::data::Split;
use crate::calibrate::problem::Problem;
use crate::calibrate::sums::Sums;
use crate::ir::trajectory::{Column, Trajectory};

use super::hypothesis::{Hypothesis, attached};
use super::result::Diagnosis;
use super::study::Study;

/// The residuals of a recording.
pub struct Residual {
    /// The recording.
    pub name: String,
    /// The recording that contains it as a window; itself if it is whole.
    pub of: String,
    /// Its use.
    pub split: Split,
    /// Instants, s.
    pub time: Arc<[f64]>,
    /// Without effects: signal by signal, in units of the noise; NaN where there is no measurement. Empty if
    /// the model cannot be simulated.
    pub before: Vec<Vec<f64>>,
    /// The same with the accepted effects.
    pub after: Vec<Vec<f64>>,
}

/// Simulates every recording without effects and with them.
pub fn residuals(study: &Study, diagnosis: &Diagnosis) -> Vec<Residual> {
    let before = of_hypothesis(study, &diagnosis.before);
    let after = of_hypothesis(study, &diagnosis.after);
    let recordings = Split::ALL.into_iter().flat_map(|split| study.data.of(split));
    let pairs = before.into_iter().zip(after);
    recordings
        .zip(pairs)
        .map(|(r, (before, after))| Residual {
            name: r.name.clone(),
            of: r.of.clone(),
            split: r.split,
            time: r.time.clone(),
            before,
            after,
        })
        .collect()
}

/// The sums of squares of the recordings that no decision has seen. A recording that cannot be simulated
/// counts as infinitely far off.
pub fn test_sums(study: &Study, hypothesis: &Hypothesis) -> Sums {
    let mut sums = Sums::default();
    if study.data.of(Split::Test).next().is_none() {
        return sums;
    }
    let recordings = Split::ALL.into_iter().flat_map(|split| study.data.of(split));
    let all = recordings.zip(of_hypothesis(study, hypothesis));
    for (recording, residuals) in all.filter(|(r, _)| r.split == Split::Test) {
        let is_simulated = !residuals.is_empty();
        let of_signal = |(k, measured): (usize, &Vec<f64>)| {
            let count = measured.iter().filter(|m| !m.is_nan()).count();
            let squares = residuals.get(k).into_iter().flatten().filter(|r| !r.is_nan());
            let square: f64 = squares.map(|r| r * r).sum();
            (if is_simulated { square } else { f64::INFINITY }, count)
        };
        let (squares, counts) = recording.signals.iter().enumerate().map(of_signal).unzip();
        sums.squares.push(squares);
        sums.counts.push(counts);
    }
    sums
}

/// Measurement and model, without effects and with them: a table for each recording, its windows one after
/// the other, with columns `NAME`, `NAME_before`, `NAME_after` for each signal in the unit of the plan. Rows
/// in which one of them has no value are skipped.
pub fn tables(study: &Study, diagnosis: &Diagnosis) -> Vec<Trajectory> {
    let mut out: Vec<(Split, String, Trajectory)> = Vec::new();
    let recordings = Split::ALL.into_iter().flat_map(|split| study.data.of(split));
    for (recording, r) in recordings.zip(residuals(study, diagnosis)) {
        if out.last().is_none_or(|(split, of, _)| (*split, of) != (r.split, &r.of)) {
            let columns = study.plan.signals.iter().flat_map(|signal| {
                let names = ["", "_before", "_after"].map(|end| format!("{}{end}", signal.column));
                names.map(|name| Column::new(name, &signal.unit_name))
            });
            out.push((r.split, r.of.clone(), Trajectory::new(columns.collect())));
        }
        let Some((.., table)) = out.last_mut() else { continue };
        for (i, t) in r.time.iter().enumerate() {
            let mut row = Vec::with_capacity(table.columns.len());
            for (k, sigma) in study.data.sigmas.iter().enumerate() {
                let measured = recording.signals[k][i];
                let modelled = |all: &[Vec<f64>]| {
                    all.get(k).and_then(|r| r.get(i)).map_or(f64::NAN, |r| measured + sigma * r)
                };
                row.extend([measured, modelled(&r.before), modelled(&r.after)]);
            }
            // The last row of a window is the first of the next.
            if row.iter().all(|x| x.is_finite()) && table.time.last().is_none_or(|last| last < t) {
                table.push(*t, &row);
            }
        }
    }
    out.into_iter().map(|(.., table)| table).collect()
}

/// The residuals of every recording, training first, signal by signal, in units of the noise; NaN without a
/// measurement. A recording that cannot be simulated has none.
pub fn of_hypothesis(study: &Study, hypothesis: &Hypothesis) -> Vec<Vec<Vec<f64>>> {
    let nothing = || vec![Vec::new(); study.data.recordings.len()];
    let (plan, attached) = (&hypothesis.plan, attached(study, &hypothesis.effects));
    let Ok((session, program)) = study.compile(plan, &attached, &[]) else { return nothing() };
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, plan, &study.data, &mut problems);
    let Some(problem) = problem else { return nothing() };
    // The starts of the plan are the fitted values.
    let x = problem.start();
    let recordings = Split::ALL.into_iter().flat_map(|split| problem.recordings(split));
    recordings.map(|r| problem.residuals(r, &x).unwrap_or_default()).collect()
}
