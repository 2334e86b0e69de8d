//! `mocc sweep`: runs a model many times, and writes a table with a row per run.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::args::Sweep as Options;
use super::progress::Progress;
use super::running::{self, names_in};
use super::{Status, interrupt, print, say};
use crate::driver::compile::Session;
use crate::io::atomic_file::create_folder;
use crate::io::format::Format;
use crate::io::journal::{Fingerprint, Found, Journal, exists, remove};
use crate::simulate::settings::Settings;
use crate::sweep::design::{Design, sample};
use crate::sweep::error::SweepError;
use crate::sweep::pool::cores;
use crate::sweep::runs::{Sweep, Tally};
use crate::sweep::variant::{Keep, Model, Variants};
use crate::sweep::vary::Axis;

/// Runs the command.
pub fn run(options: &Options) -> Status {
    match sweep(options) {
        Ok(status) => status,
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
    }
}

fn sweep(options: &Options) -> Result<Status, SweepError> {
    let design = design(options)?;
    let files = Files::of(options)?;
    let model = Model {
        request: running::request(&options.model, &options.running),
        measures: options.measures.clone(),
        keep: files.traces.is_some().then(|| keep(options)),
    };
    let mut session = Session { parameters_vary: true, ..Session::default() };
    let base = model.compile(&[], &mut session);
    say(&session);
    let mut base = match base {
        Ok(base) => base,
        Err(error) => return Ok(error.into()),
    };
    if files.traces.is_some() && base.plan.shown == 0 {
        eprintln!("error: no variable has a name that `--show` or `--variables` selects");
        return Ok(Status::Usage);
    }
    let settings = settings(options, &base.program.blocks.dae.experiment, files.traces.is_some());
    let fingerprint = fingerprint(options, &session);
    let measures = base.plan.columns.clone();
    let name = base.program.blocks.dae.name.clone();
    base.sources = std::mem::take(&mut session.sources);
    let variants = Variants::new(model, base, &design.axes, design.count);
    // An error in every run, such as an unknown parameter, is an error in the request.
    let mut session = Session { parameters_vary: true, ..Session::default() };
    if let Err(error) = variants.check(&design.values(0), &mut session) {
        say(&session);
        return Ok(error.into());
    }
    let jobs = options.jobs.unwrap_or_else(cores).max(1);
    let sweep = Sweep {
        design: &design,
        variants: &variants,
        settings,
        traces: files.traces.clone(),
        measures,
        jobs,
    };

    let mut journal = files.journal(options.restart, fingerprint)?;
    let before = journal.lines;
    interrupt::listen();
    let started_at = Instant::now();
    let progress = Progress::of_runs(before, design.count);
    let on_progress = |done| progress.iter().for_each(|p| p.reached(done as f64));
    let complete = sweep.run(&mut journal, &interrupt::is_requested, on_progress)?;
    drop(progress);
    let seconds = started_at.elapsed().as_secs_f64();
    if !complete {
        let text = format!(
            "{name}: interrupted after {} of {} runs; the same command resumes from there\n",
            journal.lines, design.count
        );
        return Ok(match print(&text) {
            Status::Done => Status::Interrupted,
            status => status,
        });
    }
    let tally = sweep.write(&mut journal, &files.table)?;
    journal.remove()?;
    let done = tally.runs - before;
    let text = summary(&name, &tally, done, seconds, jobs, &files);
    let status = print(&text);
    Ok(if tally.failed == tally.runs { Status::Numerics } else { status })
}

fn design(options: &Options) -> Result<Design, SweepError> {
    let axes = options.vary.iter().map(|t| Axis::read(t)).collect::<Result<Vec<_>, _>>()?;
    match &options.sample {
        None => Design::grid(axes),
        Some(text) => Design::latin_hypercube(axes, sample(text)?, options.seed),
    }
}

/// Settings of all runs. If no trajectory is kept, there are rows at events only.
fn settings(options: &Options, experiment: &crate::ir::flat::Experiment, traces: bool) -> Settings {
    let settings = running::settings(&options.running, experiment);
    if traces { settings } else { settings.without_grid() }
}

/// The variables whose trajectories are kept.
fn keep(options: &Options) -> Keep {
    let pattern = options.running.variables.clone();
    let names: Option<Vec<String>> = options.show.as_deref().map(names_in);
    let plain = |name: &str| name.chars().filter(|c| !c.is_whitespace()).collect::<String>();
    Arc::new(move |name| match (&pattern, &names) {
        (None, None) => true,
        (pattern, names) => {
            pattern.as_ref().is_some_and(|p| p.is_match(name))
                || names.as_ref().is_some_and(|n| n.iter().any(|n| plain(n) == plain(name)))
        }
    })
}

/// Everything that the rows depend on.
fn fingerprint(options: &Options, session: &Session) -> Fingerprint {
    let mut all = Fingerprint::default();
    all.add(env!("CARGO_PKG_VERSION"));
    for text in session.sources.contents() {
        all.add(text);
    }
    let pattern = options.running.variables.as_ref().map(|p| p.as_str().to_owned());
    let text = format!(
        "{:?}",
        (
            (
                &options.model.file,
                &options.model.model,
                &options.model.settings,
                &options.model.folders
            ),
            (&options.vary, &options.sample, options.seed, &options.measures),
            (
                options.running.stop,
                options.running.interval,
                options.running.tolerance,
                options.running.max_step,
                options.running.method,
                options.running.mode
            ),
            (options.traces, &options.show, pattern),
        )
    );
    all.add(&text);
    all
}

/// The files of a sweep.
struct Files {
    folder: Option<PathBuf>,
    table: PathBuf,
    journal: PathBuf,
    traces: Option<PathBuf>,
}

impl Files {
    fn of(options: &Options) -> Result<Files, SweepError> {
        let output = &options.output;
        let wanted =
            options.traces || options.show.is_some() || options.running.variables.is_some();
        let extension = output.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let is_file = Format::of(output).is_ok_and(|format| format.records.is_some());
        if is_file {
            if wanted {
                return Err(SweepError::NoFolder);
            }
            let mut journal = output.clone().into_os_string();
            journal.push(".journal");
            let journal = PathBuf::from(journal);
            return Ok(Files { folder: None, table: output.clone(), journal, traces: None });
        }
        if extension.is_some_and(|e| matches!(e.as_str(), "mat" | "svg" | "png" | "json" | "html"))
        {
            return Err(SweepError::Format(output.display().to_string()));
        }
        Ok(Files {
            folder: Some(output.clone()),
            table: output.join("sweep.csv"),
            journal: output.join("sweep.journal"),
            traces: wanted.then(|| output.join("runs")),
        })
    }

    /// The journal to go on with; makes the folders.
    fn journal(&self, restart: bool, fingerprint: Fingerprint) -> Result<Journal, SweepError> {
        if let Some(folder) = self.traces.as_deref().or(self.folder.as_deref()) {
            create_folder(folder)?;
        }
        if restart {
            remove(&self.journal)?;
        } else if exists(&self.table) && !exists(&self.journal) {
            return Err(SweepError::Finished { output: self.table.display().to_string() });
        }
        match Journal::open(&self.journal, fingerprint.0)? {
            Found::Ours(journal) => Ok(journal),
            Found::Other => Err(SweepError::Other { journal: self.journal.display().to_string() }),
        }
    }
}

fn summary(
    name: &str,
    tally: &Tally,
    done: u64,
    seconds: f64,
    jobs: usize,
    files: &Files,
) -> String {
    let runs = |n: u64| if n == 1 { "1 run".to_owned() } else { format!("{n} runs") };
    let mut out = format!("{name}: {}, {} failed\n", runs(tally.runs), tally.failed);
    if let Some((number, why)) = &tally.first {
        out.push_str(&format!("  first failure: run {number}: {why}\n"));
    }
    let threads = if jobs == 1 { "1 thread".to_owned() } else { format!("{jobs} threads") };
    let rate = done as f64 / seconds.max(1e-9);
    out.push_str(&format!("  {} in {seconds:.2} s on {threads}, {rate:.0} a second\n", runs(done)));
    let shown = |p: &Path| p.display().to_string();
    let traces = files.traces.as_ref().map_or(String::new(), |t| format!(", {}", shown(t)));
    out.push_str(&format!("  wrote {}{traces}\n", shown(&files.table)));
    out
}
