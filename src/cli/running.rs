//! Shared by the commands that run a model: settings from options, and the default choice of variables.

use std::path::Path;

use super::args::model::{Model, is_standard};
use super::args::running::Running;
use super::{Status, explain, interrupt, project, style};
use crate::base::render::render;
use crate::base::source::SourceMap;
use crate::codegen::recording;
use crate::driver::compile::Request;
use crate::ir::flat::Experiment;
use crate::ir::program::Program;
use crate::measure::observe::Plan;
use crate::simulate::failure::Failure;
use crate::simulate::settings::{Method, Settings};

/// The request that compiles the model of a run.
pub(super) fn request(model: &Model, options: &Running) -> Request {
    Request {
        form: options.mode.into(),
        takes_fmu: true,
        integrating: options.fmi_type.map(Into::into).unwrap_or_default(),
        ..model.request()
    }
}

/// Restricts the recorded variables to those that the user asks for and those that measures need; an error if
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
        0 => Err(format!("no name of a variable matches `{wanted}`")),
        _ => Ok(()),
    }
}

/// The settings of a run: options override the experiment annotation of the model, which overrides those of the project.
pub(super) fn settings(options: &Running, model: &Model, experiment: &Experiment) -> Settings {
    let project = project(model.file.as_deref());
    let method = project.method.as_deref().and_then(Method::named);
    let experiment = Experiment {
        start: experiment.start,
        stop: options.stop.or(experiment.stop),
        interval: options.interval.or(experiment.interval),
        tolerance: options.tolerance.or(experiment.tolerance).or(project.tolerance),
    };
    let method = options.method.map(|named| named.0).or(method).unwrap_or_default();
    Settings { method, max_step: options.max_step, ..Settings::of(&experiment) }
}

/// Shows why a run failed.
pub(super) fn failed(failure: &Failure, sources: &SourceMap) -> Status {
    eprintln!("{}", render(&failure.diagnostic, sources, style()));
    explain::remember([&*failure.diagnostic]);
    if interrupt::is_requested() { Status::Interrupted } else { failure.kind.into() }
}

/// `valve52` for `examples/valve52.mol`, the last part of the model's name without a file.
pub(super) fn stem(model: &Model, program: &Program) -> String {
    match model.file.as_deref().filter(|file| !is_standard(file)).and_then(Path::file_stem) {
        Some(stem) => stem.to_string_lossy().into_owned(),
        None => {
            let full = &program.blocks.dae.name;
            full.rsplit('.').next().unwrap_or(full).to_string()
        }
    }
}

/// Names separated by commas; commas in brackets do not separate.
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
