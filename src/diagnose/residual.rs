//! What a model leaves of each recording, before and after an effect was added.

use std::sync::Arc;

use crate::base::diag::Problems;
use crate::calibrate::data::Split;
use crate::calibrate::problem::Problem;

use super::search::{Case, Found, Level, attached, compile};

/// The residuals of a recording.
pub struct Residual {
    /// The recording.
    pub name: String,
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
            split: r.split,
            time: r.time.clone(),
            before,
            after,
        })
        .collect()
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
