//! What commands that run a model have in common: options to settings, and which variables are of
//! most interest.

use std::path::Path;

use super::args::{Model, Running};
use super::{Status, style};
use crate::base::render::render;
use crate::base::source::SourceMap;
use crate::codegen::recording;
use crate::driver::compile::Request;
use crate::ir::flat::Experiment;
use crate::ir::program::Program;
use crate::ir::trajectory::{Kind, Trajectory};
use crate::measure::observe::Plan;
use crate::simulate::failure::{Failure, FailureKind};
use crate::simulate::settings::{DEFAULT_INTERVALS, Settings};

/// At most so many curves are drawn unless the user names them.
const MAX_CURVES: usize = 8;

/// What to compile for a run.
pub(super) fn request(model: &Model, options: &Running) -> Request {
    Request { form: options.mode.into(), ..model.request() }
}

/// Restricts the program to the variables that the user wants, and what measures need; an error if
/// there are none.
pub(super) fn restrict(
    options: &Running,
    program: &mut Program,
    measures: Option<&mut Plan>,
) -> Result<(), String> {
    let Some(wanted) = &options.variables else { return Ok(()) };
    let shown = match measures {
        Some(plan) => {
            plan.record(program, |name| wanted.is_match(name));
            plan.shown
        }
        None => {
            recording::only(program, |name| wanted.is_match(name));
            program.recorded.len()
        }
    };
    match shown {
        0 => Err(format!("no variable matches `{wanted}`")),
        _ => Ok(()),
    }
}

/// What the user asks for, and the annotation of the model where the user does not.
pub(super) fn settings(options: &Running, experiment: &Experiment) -> Settings {
    let mut settings = Settings::of(experiment);
    if let Some(stop) = options.stop {
        if options.interval.is_none() && experiment.interval.is_none() {
            settings.interval = (stop - settings.start) / DEFAULT_INTERVALS;
        }
        settings.stop = stop;
    }
    settings.interval = options.interval.unwrap_or(settings.interval);
    settings.tolerance = options.tolerance.unwrap_or(settings.tolerance);
    settings.method = options.method.into();
    settings
}

/// Says why a run failed.
pub(super) fn failed(failure: &Failure, sources: &SourceMap) -> Status {
    eprintln!("{}", render(&failure.diagnostic, sources, style()));
    match failure.kind {
        FailureKind::Numerics | FailureKind::Assertion => Status::Numerics,
        FailureKind::Settings => Status::Usage,
        FailureKind::Bug => Status::Bug,
    }
}

/// `valve52` for `examples/valve52.mol`, the last part of the model's name without a file.
pub(super) fn stem(model: &Model, program: &Program) -> String {
    match model.file.as_deref().and_then(Path::file_stem) {
        Some(stem) => stem.to_string_lossy().into_owned(),
        None => {
            let full = &program.blocks.dae.name;
            full.rsplit('.').next().unwrap_or(full).to_string()
        }
    }
}

/// Names between commas; those in brackets do not part.
pub(super) fn names_in(list: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut depth = 0;
    for c in list.chars() {
        match c {
            '[' | '{' | '(' => depth += 1,
            ']' | '}' | ')' => depth -= 1,
            ',' if depth == 0 => {
                out.push(String::new());
                continue;
            }
            _ => {}
        }
        out.last_mut().expect("never empty").push(c);
    }
    out.into_iter().map(|n| n.trim().to_string()).filter(|n| !n.is_empty()).collect()
}

/// What to draw by itself: variables of the model itself, before those of its components; positions
/// and pressures where there are both.
pub(super) fn interesting(trajectory: &Trajectory) -> Vec<String> {
    let real = |k: &Kind| *k == Kind::Continuous;
    let moving = |name: &str| trajectory.values(name).is_some_and(|v| v.iter().any(|x| *x != v[0]));
    let candidates = |top: bool| {
        trajectory
            .columns
            .iter()
            .filter(|c| real(&c.kind) && (!top || !c.name.contains('.')))
            .filter(|c| !c.name.starts_with("der(") && moving(&c.name))
            .collect::<Vec<_>>()
    };
    let mut chosen = candidates(true);
    if chosen.is_empty() {
        chosen = candidates(false);
    }
    let has = |unit: &str| chosen.iter().any(|c| c.unit == unit);
    if has("m") && has("Pa") {
        chosen.retain(|c| c.unit == "m" || c.unit == "Pa");
    }
    chosen.into_iter().take(MAX_CURVES).map(|c| c.name.clone()).collect()
}
