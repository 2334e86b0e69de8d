//! `mocc optimize`: finds the best design of a plan, and writes what it finds.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::study::{Optimize, stem};
use super::progress::Working;
use super::{Status, interrupt, modelica_path, plan_of, print, running, say};
use crate::calibrate::parallel::cores;
use crate::driver::compile::Session;
use crate::io::atomic_file::{create_folder, write_files};
use crate::optimize::page;
use crate::optimize::result::Optimum;
use crate::optimize::run::{OptimizeError, Request, run as optimize};

/// Runs the command: status 0 if a design keeps all limits, 1 if none does.
pub fn run(options: &Optimize) -> Status {
    let started_at = Instant::now();
    let mut session = Session { parameters_vary: true, ..Session::default() };
    let folder = options.out.clone().unwrap_or_else(|| {
        let stem = stem(&options.plan);
        format!("{stem}-design").into()
    });
    interrupt::listen();
    let working = Working::new();
    let (plan, text) = plan_of(&options.plan);
    let request = Request {
        plan,
        text,
        modelica_path: modelica_path(),
        jobs: options.jobs.map_or_else(cores, |n| n as usize),
        is_cancelled: &interrupt::is_requested,
    };
    let outcome = optimize(&request, &mut session);
    drop(working);
    say(&session);
    let found = match outcome {
        Ok(found) => found,
        Err(OptimizeError::Invalid(error)) => return error.into(),
        Err(OptimizeError::Failed(failure)) => return running::failed(&failure, &session.sources),
        Err(error) => {
            eprintln!("error: {error}");
            return Status::Usage;
        }
    };
    let seconds = started_at.elapsed().as_secs_f64();
    let written = match write(&folder, &found, seconds) {
        Ok(written) => written,
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    for note in page::notes(&found) {
        eprintln!("warning: {note}");
    }
    let printed = match (options.json, options.quiet) {
        (true, _) => print(&found.json(seconds)),
        (false, true) => Status::Done,
        (false, false) => {
            let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
            let effort = found.effort();
            let text =
                format!("{}{effort}, {seconds:.1} s\nwrote {}\n", found.table(), names.join(", "));
            print(&text)
        }
    };
    match printed {
        Status::Done if !found.complete => Status::Interrupted,
        Status::Done if !found.is_feasible => Status::Model,
        status => status,
    }
}

/// Writes all files; returns their names.
fn write(folder: &Path, found: &Optimum, seconds: f64) -> Result<Vec<PathBuf>, String> {
    create_folder(folder).map_err(|e| e.to_string())?;
    let name = found.model.rsplit('.').next().unwrap_or(&found.model).trim_matches('\'');
    let files = [
        ("design.json".to_owned(), found.json(seconds)),
        ("design.html".to_owned(), page::html(found, seconds)),
        (format!("{name}_optimized.mol"), found.amended.clone()),
    ];
    write_files(folder, files).map_err(|e| e.to_string())
}
