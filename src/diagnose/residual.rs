//! What a model leaves of each recording, before and after an effect was added.

use std::sync::Arc;

use crate::base::diag::Problems;
use crate::calibrate::data::Split;
use crate::calibrate::problem::Problem;
use crate::ir::trajectory::{Column, Trajectory};

use super::case::{Case, compile};
use super::level::{Level, attached};
use super::search::Found;

/// The residuals of a recording.
pub struct Residual {
    /// The recording.
    pub name: String,
    /// The recording that it is a window of: itself, if it is whole.
    pub of: String,
    /// What it is for.
    pub split: Split,
    /// Instants, s.
    pub time: Arc<[f64]>,
    /// Signal by signal, in units of the noise; NaN where nothing was measured. Empty where the model can
    /// not be run.
    pub before: Vec<Vec<f64>>,
    /// The same with the effects that were kept.
    pub after: Vec<Vec<f64>>,
}

/// Runs every recording with the model as it was and as it is now.
pub fn residuals(case: &Case<'_>, found: &Found) -> Vec<Residual> {
    let before = of_level(case, &found.before);
    let after = of_level(case, &found.after);
    let recordings = Split::ALL.into_iter().flat_map(|split| case.data.of(split));
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

/// What was measured and what the model says, as it was and as it is now: a table for each recording, its
/// windows one after the other, with columns `NAME`, `NAME_before`, `NAME_after` for each signal in the unit
/// of the plan. Rows without a value in one of them are left out.
pub fn tables(case: &Case<'_>, found: &Found) -> Vec<Trajectory> {
    let mut out: Vec<(Split, String, Trajectory)> = Vec::new();
    let recordings = Split::ALL.into_iter().flat_map(|split| case.data.of(split));
    for (recording, r) in recordings.zip(residuals(case, found)) {
        if out.last().is_none_or(|(split, of, _)| (*split, of) != (r.split, &r.of)) {
            let columns = case.plan.signals.iter().flat_map(|signal| {
                let names = ["", "_before", "_after"].map(|end| format!("{}{end}", signal.column));
                names.map(|name| Column::new(name, &signal.unit_name))
            });
            out.push((r.split, r.of.clone(), Trajectory::new(columns.collect())));
        }
        let Some((.., table)) = out.last_mut() else { continue };
        for (i, t) in r.time.iter().enumerate() {
            let mut row = Vec::with_capacity(table.columns.len());
            for (k, sigma) in case.data.sigmas.iter().enumerate() {
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

/// The residuals of every recording, those for training first.
fn of_level(case: &Case<'_>, level: &Level) -> Vec<Vec<Vec<f64>>> {
    let nothing = || vec![Vec::new(); case.data.recordings.len()];
    let attached = attached(case, &level.chosen);
    let Ok((session, program)) = compile(case, &level.plan, &attached, &[]) else {
        return nothing();
    };
    let mut problems = Problems::new();
    let problem = Problem::new(&program, &session.sources, &level.plan, case.data, &mut problems);
    let Some(problem) = problem else { return nothing() };
    // The plan of a level starts where its fit ended.
    let x = problem.start();
    let recordings = Split::ALL.into_iter().flat_map(|split| problem.recordings(split));
    recordings.map(|r| problem.residuals(r, &x).unwrap_or_default()).collect()
}
