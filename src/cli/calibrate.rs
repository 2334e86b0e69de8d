//! `mocc calibrate`: fits the free parameters of a plan, and writes what it finds.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::args::study::Calibrate;
use super::terminal::Terminal;
use super::{Status, modelica_path, plan_of, print};
use crate::calibrate::memory::Memory;
use crate::calibrate::page;
use crate::calibrate::policy::FitPolicy;
use crate::calibrate::result::Calibration;
use crate::calibrate::run::{Outcome, Request, run as calibrate};
use crate::driver::compile::Session;
use crate::driver::foreign::is_fmu;
use crate::io::atomic_file::write_files;

/// Runs the command.
pub fn run(options: &Calibrate) -> Status {
    let started_at = Instant::now();
    let mut session = Session { parameters_vary: true, ..Session::default() };
    let folder = options.study.folder("calibration");
    let terminal = Terminal::new(folder.clone());
    let (plan, text) = plan_of(&options.study.plan);
    let fmus = options.study.allow_fmu.clone();
    let request = Request {
        plan,
        memory: Arc::new(Memory { plan: text, fmus, ..Memory::default() }),
        data: options.study.data.clone(),
        modelica_path: modelica_path(),
        profiles: !options.no_profiles,
        policy: FitPolicy::default(),
    };
    let outcome = calibrate(&request, &mut session, &terminal);
    let outcome = match outcome {
        Ok(outcome) => outcome,
        Err(error) => return terminal.failed(&error, &session),
    };
    terminal.finish();
    let seconds = started_at.elapsed().as_secs_f64();
    let written = match write(&folder, &outcome, seconds) {
        Ok(written) => written,
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    let fit = outcome.calibration.fit;
    if fit.complete && !fit.converged {
        eprintln!("warning: the fit ended before it converged");
    }
    match print(&summary(&outcome.calibration, &written, seconds)) {
        Status::Done if !fit.complete => Status::Interrupted,
        status => status,
    }
}

/// Writes all files; returns their names.
fn write(folder: &Path, outcome: &Outcome, seconds: f64) -> Result<Vec<PathBuf>, String> {
    let stem = outcome.model_path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = if is_fmu(&outcome.model_path) { "sh" } else { "mol" };
    let calibration = &outcome.calibration;
    let files = [
        ("calibration.json".to_owned(), calibration.json(seconds)),
        ("calibration.html".to_owned(), page::html(calibration, seconds)),
        (format!("{stem}_calibrated.{extension}"), outcome.model.clone()),
    ];
    write_files(folder, files).map_err(|e| e.to_string())
}

fn summary(found: &Calibration, written: &[PathBuf], seconds: f64) -> String {
    let fit = &found.fit;
    let ended = match (fit.complete, fit.converged) {
        (false, _) => "interrupted",
        (_, true) => "converged",
        (_, false) => "not converged",
    };
    let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
    let mut out = found.table();
    for repair in &found.repairs {
        out.push_str(&format!("repaired: {repair}\n"));
    }
    let steps = if fit.iterations == 1 { "step" } else { "steps" };
    out.push_str(&format!("{ended} after {} {steps}, {seconds:.1} s\n", fit.iterations));
    out.push_str(&format!("wrote {}\n", names.join(", ")));
    out
}
