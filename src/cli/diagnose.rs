//! `mocc diagnose`: finds the effects that a model lacks, and writes what it finds.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::args::study::Diagnose;
use super::terminal::Terminal;
use super::{Status, interrupt, modelica_path, plan_of, print};
use crate::calibrate::memory::Memory;
use crate::diagnose::policy::SearchPolicy;
use crate::diagnose::run::{Outcome, Request, RunError, run as diagnose};
use crate::diagnose::study::DiagnosisError;
use crate::diagnose::{json, page, residual, summary};
use crate::driver::compile::Session;
use crate::io::atomic_file::write_files;
use crate::io::csv::write_csv;

/// Runs the command.
pub fn run(options: &Diagnose) -> Status {
    let started_at = Instant::now();
    let mut session = Session { parameters_vary: true, ..Session::default() };
    let folder = options.study.folder("diagnosis");
    let mut terminal = Terminal::new(folder.clone());
    terminal.log_since = options.verbose.then_some(started_at);
    // A limit beyond what the clock can count is none.
    let limit = options.time_limit.and_then(|s| Duration::try_from_secs_f64(s).ok());
    terminal.deadline = limit.and_then(|limit| started_at.checked_add(limit));
    let (plan, text) = plan_of(&options.study.plan);
    let fmus = options.study.allow_fmu.clone();
    let request = Request {
        plan,
        memory: Arc::new(Memory { plan: text, fmus, ..Memory::default() }),
        data: options.study.data.clone(),
        effects: options.effects.clone(),
        modelica_path: modelica_path(),
        policy: SearchPolicy { only: options.only.clone(), ..SearchPolicy::default() },
        next: options.next,
    };
    let outcome = diagnose(&request, &mut session, &terminal);
    terminal.finish();
    let outcome = match outcome {
        Ok(outcome) => outcome,
        Err(RunError::Setup(error)) => return terminal.failed(&error, &session),
        Err(RunError::Search(DiagnosisError::Model(error))) => return error.into(),
        Err(RunError::Search(error @ DiagnosisError::Simulation)) => {
            eprintln!("error: {error}");
            return Status::Numerics;
        }
    };
    let seconds = started_at.elapsed().as_secs_f64();
    let written = match write(options, &folder, &outcome, seconds) {
        Ok(written) => written,
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    let mut text = summary::summary(&outcome, seconds);
    let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
    text.push_str(&format!("wrote {}\n", names.join(", ")));
    match print(&text) {
        Status::Done if interrupt::is_requested() && !outcome.complete => Status::Interrupted,
        status => status,
    }
}

/// Writes all files; returns their names.
fn write(
    options: &Diagnose,
    folder: &Path,
    outcome: &Outcome,
    seconds: f64,
) -> Result<Vec<PathBuf>, String> {
    let amended = outcome.amended.as_ref().map(|a| (format!("{}.mol", a.name), a.source.clone()));
    let name = amended.as_ref().map(|(name, _)| name.as_str());
    let mut files = vec![("diagnosis.json".to_owned(), json::json(outcome, name, seconds))];
    files.extend(amended.clone());
    files.push(("diagnosis.html".to_owned(), page::html(outcome)));
    let mut written = write_files(folder, files).map_err(|e| e.to_string())?;
    if options.tables && outcome.complete {
        let tables = residual::tables(&outcome.study, &outcome.diagnosis);
        for (k, table) in tables.iter().enumerate() {
            let path = folder.join(format!("recording-{}.csv", k + 1));
            write_csv(table, &path).map_err(|e| e.to_string())?;
            written.push(path);
        }
    }
    Ok(written)
}
