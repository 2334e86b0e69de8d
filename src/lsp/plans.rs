//! Checks the TOML files of a project: plans of calibrations and designs, tests, and settings. Nothing is run.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::calibrate::memory::Memory;
use crate::calibrate::policy::FitPolicy;
use crate::calibrate::run::{CalibrationError, Request, prepare};
use crate::driver::compile::{CompileError, Session};
use crate::driver::files::read;
use crate::driver::project;
use crate::optimize::run::{OptimizeError, check as check_design};
use crate::regression::test_file;

/// Tables that plans alone have.
const TABLES: [&str; 3] = ["goal", "free", "signals"];

/// Endings of the files of models.
const MODELS: [&str; 3] = [".mo", ".mol", ".fmu"];

/// A TOML file to check.
pub struct Plan<'p> {
    /// The file.
    pub path: &'p Path,
    /// Its text, if a front end holds it.
    pub text: Option<String>,
    /// The value of `MODELICAPATH`.
    pub modelica_path: Option<OsString>,
}

/// Why a file is wrong.
pub enum Wrong {
    /// The diagnostics of the session say it.
    Said(CompileError),
    /// A message.
    Message(String),
}

/// Checks a file, and the model that it names. Diagnostics are added to the session.
pub fn check(plan: &Plan<'_>, session: &mut Session) -> Result<(), Wrong> {
    let text = plan.text.clone().map_or_else(|| read(plan.path), Ok);
    let text =
        text.map_err(|why| Wrong::Message(format!("cannot read {}: {why}", plan.path.display())))?;
    let name = plan.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let said = |is_right: bool| match is_right {
        true => Ok(()),
        false => Err(Wrong::Said(CompileError::Request)),
    };
    if name.ends_with(".test.toml") {
        let tests = test_file::read(plan.path, &text, &mut session.sources, &mut session.problems);
        return said(tests.is_some());
    }
    if name == "mocc.toml" {
        project::of(Some(plan.path), &mut session.sources, &mut session.problems);
        return said(!session.problems.has_errors());
    }
    session.parameters_vary = true;
    match is_design(&text) {
        true => design(plan, text, session),
        false => calibration(plan, text, session),
    }
}

/// Whether a TOML file is one of mocc's, by its name or its keys: other tools have files of this form, too.
pub fn is_plan(path: &Path, text: &str) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if name == project::NAME || name.ends_with(".test.toml") {
        return true;
    }
    let is_table = |line: &str| {
        let name = line.trim_start().strip_prefix('[').and_then(|rest| rest.split(']').next());
        name.is_some_and(|name| TABLES.contains(&name.trim().split('.').next().unwrap_or_default()))
    };
    let is_model = |line: &str| {
        let Some((key, value)) = line.split_once('=') else { return false };
        let value = value.trim_start().trim_start_matches(['"', '\'']);
        let value = value.split(['"', '\'']).next().unwrap_or_default();
        key.trim() == "model" && MODELS.iter().any(|ending| value.ends_with(ending))
    };
    text.lines().any(|line| is_table(line) || is_model(line))
}

/// Whether a plan has a goal, as those of designs do.
fn is_design(text: &str) -> bool {
    let is_goal = |line: &str| {
        let rest = line.trim_start().trim_start_matches('[').trim_start();
        rest.strip_prefix("goal").is_some_and(|rest| rest.trim_start().starts_with([']', '=', '.']))
    };
    text.lines().any(is_goal)
}

fn calibration(plan: &Plan<'_>, text: String, session: &mut Session) -> Result<(), Wrong> {
    let request = Request {
        plan: plan.path.to_owned(),
        // The code of an FMU is not loaded, so that any may be named.
        memory: Arc::new(Memory {
            plan: Some(text),
            fmus: vec![PathBuf::from("/")],
            ..Memory::default()
        }),
        data: None,
        modelica_path: plan.modelica_path.clone(),
        profiles: false,
        policy: FitPolicy::default(),
    };
    let checked = prepare(&request, session)
        .and_then(|prepared| prepared.problem(&session.sources, &mut session.problems).map(|_| ()));
    checked.map_err(|error| match error {
        CalibrationError::Invalid(error) => Wrong::Said(error),
        error => Wrong::Message(error.to_string()),
    })
}

fn design(plan: &Plan<'_>, text: String, session: &mut Session) -> Result<(), Wrong> {
    let request = crate::optimize::run::Request {
        plan: plan.path.to_owned(),
        text: Some(text),
        modelica_path: plan.modelica_path.clone(),
        jobs: 1,
        is_cancelled: &|| false,
    };
    check_design(&request, session).map_err(|error| match error {
        OptimizeError::Invalid(error) => Wrong::Said(error),
        error => Wrong::Message(error.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{is_design, is_plan};

    #[test]
    fn plans_have_the_keys_of_plans() {
        let is = |name: &str, text: &str| is_plan(Path::new(name), text);
        assert!(
            is("p.toml", "model = \"valve.mo\"\n") && is("p.toml", "data = 1\n[ free ]\nm = {}")
        );
        assert!(is("mocc.toml", "") && is("a.test.toml", ""));
        assert!(!is("Cargo.toml", "[package]\nname = \"x\"\n[signals_of]\n"));
        assert!(!is("pyproject.toml", "[tool.x]\nmodel = \"gpt\"\n"));
    }

    #[test]
    fn a_design_has_a_goal() {
        for text in
            ["[goal]\n", "model = 1\n[ goal ]", "goal = { minimize = \"x\" }", "goal.minimize = 1"]
        {
            assert!(is_design(text), "{text}");
        }
        assert!(!is_design("model = \"goal.mo\"\n[signals]\ngoal_mm = { variable = \"s\" }"));
    }
}
