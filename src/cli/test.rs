//! `mocc test`: runs tests of models, shows what changed, and writes snapshots if asked to.

use std::path::Path;

use super::args::model::is_standard;
use super::args::project::Test as Options;
use super::{Status, modelica_path, print, say_problems, standard, standard_input, write_result};
use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::driver::files::read;
use crate::regression::files::{discover, is_test};
use crate::regression::run::{Finding, Outcome, run as run_test};
use crate::regression::snapshot::{Snapshot, TRACES, unused};
use crate::regression::summary::{self, Done};
use crate::regression::test_file::{self, Test};
use crate::regression::{annotation, review};
use crate::report::page::diff::plain;
use crate::sweep::pool;

/// The page with the changes, unless the user names another.
const REVIEW: &str = "mocc-test.html";
/// The test file on the standard input; its paths are relative to the working directory.
const STANDARD: &str = "stdin.test.toml";
/// Lines of a difference that are printed; the page has all of them.
const MOST_LINES: usize = 40;

/// Runs the command: status 0 if all tests passed, 1 if some failed.
pub fn run(options: &Options) -> Status {
    match carry_out(options) {
        Ok(status) => status,
        Err(why) => {
            if !why.is_empty() {
                eprintln!("error: {why}");
            }
            Status::Usage
        }
    }
}

/// The error is a message; it is empty where diagnostics have been shown.
fn carry_out(options: &Options) -> Result<Status, String> {
    let all = tests(options)?;
    let chosen: Vec<&Test> = match &options.filter {
        None => all.iter().collect(),
        Some(text) => all.iter().filter(|test| title(test).contains(text.as_str())).collect(),
    };
    if chosen.is_empty() {
        let filter = options.filter.as_deref().unwrap_or_default();
        return Err(format!("no test matches `{filter}`; there are {}", all.len()));
    }
    let is_piped = is_piped(options)?;
    let review = options.review.as_deref().unwrap_or(Path::new(REVIEW));
    let jobs = options.jobs.map_or_else(pool::cores, |n| n.min(1 << 10) as usize);
    let mut outcomes: Vec<Outcome> = Vec::new();
    let mut printed = Status::Done;
    pool::in_order(
        jobs.min(chosen.len()),
        0..chosen.len() as u64,
        |k| Some(run_test(chosen[k as usize], modelica_path())),
        |k, outcome: Outcome| {
            // With `--update` a test may still pass.
            let is_provisional = options.update && needs_update(&outcome);
            if !options.json && !is_piped && !is_provisional {
                printed = print(&summary::line(chosen[k as usize], &outcome));
            }
            outcomes.push(outcome);
            printed == Status::Done
        },
    );
    let changed: Vec<(&Test, &Finding)> = chosen
        .iter()
        .zip(&outcomes)
        .flat_map(|(test, outcome)| outcome.findings.iter().map(move |f| (*test, f)))
        .filter(|(_, f)| {
            f.picture.is_some() || f.snapshot.as_ref().is_some_and(|s| s.before.is_some())
        })
        .collect();
    let is_reviewed = !changed.is_empty();
    if is_reviewed {
        write_result(review, review::page(&changed).as_bytes())?;
    }
    let mut updated = Vec::new();
    if options.update {
        for (test, outcome) in chosen.iter().zip(&mut outcomes) {
            if needs_update(outcome) {
                accept(options, test, outcome, &mut updated)?;
            }
        }
    }
    let done: Vec<Done<'_>> = chosen.iter().copied().zip(&outcomes).collect();
    if let Some(path) = &options.junit {
        write_result(path, summary::junit(&done).as_bytes())?;
    }
    let (passed, failed) = summary::counts(&done);
    let text = if is_piped {
        String::new()
    } else if options.json {
        summary::json(&done, &updated).pretty()
    } else {
        let mut text = format!("{passed} passed, {failed} failed");
        if !updated.is_empty() {
            text += &format!(", {} snapshots written", updated.len());
        }
        if is_reviewed {
            text += &format!("; the changes are in {}", review.display());
        }
        text + "\n"
    };
    if options.filter.is_none() {
        note_unused(&all);
    }
    match print(&text) {
        Status::Done if failed > 0 => Ok(Status::Model),
        status => Ok(status),
    }
}

/// Whether a result goes to the standard output in place of the text.
fn is_piped(options: &Options) -> Result<bool, String> {
    let outputs = [("--junit", &options.junit), ("--review", &options.review)];
    standard::single_with_json(&outputs, options.json).map(|option| option.is_some())
}

/// All tests of the paths.
fn tests(options: &Options) -> Result<Vec<Test>, String> {
    let here = [".".into()];
    let paths = if options.paths.is_empty() { &here[..] } else { &options.paths };
    let mut files = Vec::new();
    for path in paths.iter().filter(|path| !is_standard(path)) {
        files.extend(discover(path)?);
    }
    files.sort();
    files.dedup();
    let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
    let mut all = Vec::new();
    if paths.iter().any(|path| is_standard(path)) {
        let (file, text) = (Path::new(STANDARD), standard_input());
        let read = test_file::read(file, &text, &mut sources, &mut problems);
        all.extend(read.unwrap_or_default());
    }
    for file in files {
        let file = file.strip_prefix(".").map(Into::into).unwrap_or(file);
        let text = read(&file).map_err(|why| format!("cannot read {}: {why}", file.display()))?;
        let by = if is_test(&file) { test_file::read } else { annotation::read };
        all.extend(by(&file, &text, &mut sources, &mut problems).unwrap_or_default());
    }
    say_problems(&problems, &sources);
    if problems.has_errors() {
        return Err(String::new());
    }
    if all.is_empty() {
        let places: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
        return Err(format!(
            "there are no tests in {}: neither a file NAME.test.toml nor a model with `__mocc(tests(...))`",
            places.join(", ")
        ));
    }
    Ok(all)
}

fn title(test: &Test) -> String {
    format!("{}: {}", test.file.display(), test.name)
}

fn needs_update(outcome: &Outcome) -> bool {
    outcome.findings.iter().any(|f| f.snapshot.is_some())
}

/// Shows what changes, then writes the snapshots of a test.
fn accept(
    options: &Options,
    test: &Test,
    outcome: &mut Outcome,
    updated: &mut Vec<String>,
) -> Result<(), String> {
    let (changes, rest): (Vec<_>, Vec<_>) =
        outcome.findings.drain(..).partition(|f| f.snapshot.is_some());
    let mut text = String::new();
    for finding in &changes {
        let Some(snapshot) = &finding.snapshot else { continue };
        text += &shown(snapshot, finding);
        updated.push(snapshot.path.display().to_string());
    }
    outcome.findings = rest;
    if !options.json && !is_piped(options)? {
        text += &summary::line(test, outcome);
        print(&text);
    }
    changes.iter().filter_map(|f| f.snapshot.as_ref()).try_for_each(Snapshot::accept)
}

fn shown(snapshot: &Snapshot, finding: &Finding) -> String {
    let path = snapshot.path.display();
    let Some(before) = &snapshot.before else { return format!("new     {path}\n") };
    let mut text = format!("changed {path}\n");
    let is_trace = snapshot.path.to_string_lossy().ends_with(TRACES);
    let lines = if is_trace {
        finding.message.lines().map(str::to_owned).collect()
    } else {
        plain(before, &snapshot.after)
    };
    for line in lines.iter().take(MOST_LINES) {
        text += &format!("      {line}\n");
    }
    if lines.len() > MOST_LINES {
        text += &format!("      and {} more lines\n", lines.len() - MOST_LINES);
    }
    text
}

/// Mentions snapshots that no test has any more.
fn note_unused(all: &[Test]) {
    for path in unused(all) {
        eprintln!("note: no test uses {}; remove it", path.display());
    }
}
