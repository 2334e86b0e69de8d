//! `mocc calibrate`: plan in; parameters, their errors, and how well the model then fits, out.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::Calibrate;
use super::progress::Working;
use super::{Status, interrupt, print, say};
use crate::base::render::render;
use crate::calibrate::calibration::{Calibration, Search};
use crate::calibrate::data::{Data, Split};
use crate::calibrate::fit::{self, Fit};
use crate::calibrate::plan::Plan;
use crate::calibrate::problem::{Problem, record_signals};
use crate::calibrate::profile::{self, Interval, Profiles};
use crate::calibrate::statistics::{Statistics, reduced};
use crate::calibrate::{data, model, page, plan};
use crate::driver::compile::{Request, Session};
use crate::driver::files;
use crate::io::atomic_file::{create_folder, write_file};
use crate::ir::program::SystemForm;
use crate::simulate::failure::{Failure, FailureKind};

/// Better minima that the profiles may lead to before they are taken as they are.
const RETURNS: usize = 3;

/// Runs the command.
pub fn run(options: &Calibrate) -> Status {
    let begun = Instant::now();
    let mut session = Session::default();
    let Some((plan, data)) = inputs(&options.plan, options.data.as_deref(), &mut session) else {
        say(&session);
        return Status::Usage;
    };
    let request = Request {
        file: Some(plan.model.clone()),
        model: plan.name.clone(),
        appended: None,
        form: SystemForm::Ode,
        settings: plan.fixed.clone(),
        recorded: plan.recorded(),
        folders: plan.libraries.clone(),
        modelica_path: std::env::var_os("MODELICAPATH"),
    };
    let mut program = match session.compile(&request) {
        Ok(program) => program,
        Err(wrong) => {
            say(&session);
            return wrong.into();
        }
    };
    record_signals(&mut program, &plan);
    let problem = Problem::new(&program, &session.sources, &plan, &data, &mut session.problems);
    say(&session);
    let Some(mut problem) = problem else { return Status::Usage };
    // From here on an end is asked for, not forced: what was found is to be written.
    interrupt::listen();
    // Half a minute later it would be late to say this.
    let folder = folder(options);
    if let Err(why) = create_folder(&folder) {
        eprintln!("error: {why}");
        return Status::Usage;
    }
    if let Some(failure) = failing(&problem) {
        eprintln!("{}", render(&failure.diagnostic, &session.sources, super::style()));
        return status_of(&failure);
    }
    let working = Working::new();
    let found = search(&mut problem, &working, options.no_profiles);
    let found = found.and_then(|(fit, statistics, intervals, complete)| {
        let seconds = begun.elapsed().as_secs_f64();
        let Fit { iterations, converged, .. } = fit;
        let search = Search { iterations, converged, complete, seconds };
        let of = (&statistics, intervals.as_slice());
        Calibration::new(&problem, &plan, &data.repairs, &fit, of, search)
    });
    drop(working);
    let found = match found {
        Ok(found) => found,
        Err(failure) => {
            eprintln!("{}", render(&failure.diagnostic, &session.sources, super::style()));
            return status_of(&failure);
        }
    };
    let original = match files::read(&plan.model) {
        Ok(text) => model::text(&text, &program, &plan, &found),
        Err(why) => {
            eprintln!("error: cannot read {}: {why}", plan.model.display());
            return Status::Usage;
        }
    };
    let written = match write(&folder, &stem(&plan.model), &original, &found) {
        Ok(written) => written,
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    if found.search.complete && !found.search.converged {
        eprintln!("warning: the search ended before it had converged");
    }
    match print(&summary(&found, &written)) {
        Status::Done if !found.search.complete => Status::Interrupted,
        status => status,
    }
}

/// The plan and its recordings, perhaps from another folder.
pub(super) fn inputs(
    path: &Path,
    folder: Option<&Path>,
    session: &mut Session,
) -> Option<(Plan, Data)> {
    let text = match files::read(path) {
        Ok(text) => text,
        Err(why) => {
            eprintln!("error: cannot read {}: {why}", path.display());
            return None;
        }
    };
    let mut plan = plan::read(path, &text, &mut session.sources, &mut session.problems)?;
    if let Some(folder) = folder {
        plan.folder = folder.to_owned();
    }
    let data = data::read(&plan, &mut session.problems)?;
    Some((plan, data))
}

/// Why the first recording for training that can not be simulated at the start can not.
pub(super) fn failing(problem: &Problem<'_>) -> Option<Failure> {
    let start = problem.start();
    problem.sums(Split::Train, &start).err()?;
    let recordings = problem.recordings(Split::Train);
    recordings.iter().find_map(|r| {
        let mut failure = problem.predict(r, &start).err()?;
        let note = format!("so recording `{}` cannot be simulated at the start values", r.name);
        *failure.diagnostic = failure.diagnostic.note(note);
        Some(failure)
    })
}

type Found = (Fit, Statistics, Vec<Interval>, bool);

/// Fits, then follows the profiles; a better minimum that these meet is where it begins anew.
fn search(
    problem: &mut Problem<'_>,
    working: &Working,
    no_profiles: bool,
) -> Result<Found, Failure> {
    let count = problem.count(Split::Train);
    let free = problem.parameters.len();
    let mut steps = 0;
    let mut heed = |_: u32, cost: f64| {
        steps += 1;
        working.say(format!("step {steps}: reduced chi-square {:.4}", reduced(cost, count, free)));
        !interrupt::asked()
    };
    let mut fit = match fit::fit(problem, &mut heed) {
        Some(fit) => fit,
        // Its start has run, so only derivatives can be missing.
        None => {
            let start = problem.start();
            let why = problem.normal(&start).err();
            return Err(why.unwrap_or_else(|| Failure::bug(0.0, "the search found nothing")));
        }
    };
    let names: Vec<String> = problem.parameters.iter().map(|p| p.name.clone()).collect();
    for _ in 0..=RETURNS {
        let statistics = Statistics::new(&fit.normal, &problem.parameters, &fit.x);
        if no_profiles || interrupt::asked() {
            let intervals = profile::quadratic(problem, &fit, &statistics);
            fit.iterations = steps;
            return Ok((fit, statistics, intervals, !interrupt::asked()));
        }
        let mut goes_on = |i: usize| {
            let name = &names[i];
            working.say(format!("interval of {name} ({} of {free})", i + 1));
            !interrupt::asked()
        };
        match profile::profile(problem, &fit, &statistics, &mut goes_on) {
            Profiles::Intervals(intervals) => {
                fit.iterations = steps;
                return Ok((fit, statistics, intervals, !interrupt::asked()));
            }
            Profiles::Better(x) => {
                let Some(better) = fit::search(problem, &x, &fit::STOPPING, &mut heed) else {
                    break;
                };
                fit = better;
            }
        }
    }
    let statistics = Statistics::new(&fit.normal, &problem.parameters, &fit.x);
    let intervals = profile::quadratic(problem, &fit, &statistics);
    fit.iterations = steps;
    Ok((fit, statistics, intervals, !interrupt::asked()))
}

/// Writes all files; their names.
fn write(
    folder: &Path,
    stem: &str,
    model: &str,
    found: &Calibration,
) -> Result<Vec<PathBuf>, String> {
    let page = page::html(found);
    let files = [
        ("calibration.json".to_owned(), found.json()),
        ("calibration.html".to_owned(), page),
        (format!("{stem}_calibrated.mol"), model.to_owned()),
    ];
    let mut written = Vec::new();
    for (name, text) in files {
        let path = folder.join(name);
        write_file(&path, text.as_bytes()).map_err(|e| e.to_string())?;
        written.push(path);
    }
    Ok(written)
}

fn summary(found: &Calibration, written: &[PathBuf]) -> String {
    let s = &found.search;
    let ended = match (s.complete, s.converged) {
        (false, _) => "interrupted",
        (_, true) => "converged",
        (_, false) => "not converged",
    };
    let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
    let mut out = found.table();
    for repair in &found.repairs {
        out.push_str(&format!("repaired: {repair}\n"));
    }
    let steps = if s.iterations == 1 { "step" } else { "steps" };
    out.push_str(&format!("{ended} after {} {steps}, {:.1} s\n", s.iterations, s.seconds));
    out.push_str(&format!("wrote {}\n", names.join(", ")));
    out
}

pub(super) fn status_of(failure: &Failure) -> Status {
    match failure.kind {
        FailureKind::Numerics | FailureKind::Assertion => Status::Numerics,
        FailureKind::Settings => Status::Usage,
        FailureKind::Bug => Status::Bug,
    }
}

/// The folder of the results.
fn folder(options: &Calibrate) -> PathBuf {
    let default = || PathBuf::from(format!("{}-calibration", stem(&options.plan)));
    options.out.clone().unwrap_or_else(default)
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "model".to_owned(), |s| s.to_string_lossy().into_owned())
}
