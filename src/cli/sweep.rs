//! `mocc sweep`: runs a model many times, and writes a table with a row per run.

use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::args::model::is_standard;
use super::args::runs::Sweep as Options;
use super::args::{self, Command as Named};
use super::progress::Progress;
use super::running::{self, names_in};
use super::{Status, interrupt, print, print_file, project, say};
use crate::driver::compile::Session;
use crate::driver::packed::Packed;
use crate::io::atomic_file::{create_folder, scratch_path};
use crate::io::format::Format;
use crate::io::journal::{Found, Journal, exists, remove, shard, shards};
use crate::ir::flat::Experiment;
use crate::runtime::host::arithmetic;
use crate::simulate::settings::Settings;
use crate::sweep::design::{Design, sample};
use crate::sweep::error::SweepError;
use crate::sweep::pool::cores;
use crate::sweep::prepared::Prepared;
use crate::sweep::runs::{Sweep, Tally};
use crate::sweep::shard::Shard;
use crate::sweep::variant::{Keep, Model};
use crate::sweep::vary::Axis;

/// Runs the command.
pub(super) fn run(options: &Options) -> Status {
    if options.cluster.is_some() {
        eprintln!(
            "error: `--cluster` needs the Python package: install it with `pip install \"mocc[cluster]\"`, and run its command `mocc`"
        );
        return Status::Usage;
    }
    let ended = Command::prepare(options, None, &Packed::default()).and_then(|command| {
        let ended = match options.gather {
            true => command.gather(),
            false => command.run(),
        };
        ended.map_err(|why| refused(&why))
    });
    ended.unwrap_or_else(|status| status)
}

/// The file of the model and the folders of libraries that a command line for a sweep names, and the address of the
/// cluster. The first argument is the name of the program.
pub fn files_named(
    arguments: Vec<OsString>,
) -> Result<(Option<PathBuf>, Vec<PathBuf>, Option<String>), Status> {
    Ok(match args::read(arguments)? {
        Named::Sweep(options) => (options.model.file, options.model.folders, options.cluster),
        _ => (None, Vec::new(), None),
    })
}

fn refused(why: &SweepError) -> Status {
    eprintln!("error: {why}");
    Status::Usage
}

/// The command, ready to run: here, or anywhere else by parts.
pub struct Command {
    /// The sweep.
    pub prepared: Prepared,
    files: Files,
    shard: Shard,
    jobs: usize,
    restart: bool,
}

impl Command {
    /// The command of a command line, whose first argument is the name of the program. The file of its model and the
    /// folders of libraries may be in memory. What is wrong is on the standard error.
    pub fn named(
        arguments: Vec<OsString>,
        text: Option<String>,
        packed: &Packed,
    ) -> Result<Command, Status> {
        match args::read(arguments)? {
            Named::Sweep(options) => Command::prepare(&options, text, packed),
            _ => Err(Status::Usage),
        }
    }

    /// Reads the options and compiles the model, whose file may be in memory, and the folders of libraries too. What is
    /// wrong is on the standard error.
    fn prepare(
        options: &Options,
        text: Option<String>,
        packed: &Packed,
    ) -> Result<Command, Status> {
        let refuse = |why: SweepError| refused(&why);
        let design = design(options).map_err(refuse)?;
        let files = Files::of(options).map_err(refuse)?;
        let shard = options.shard.as_deref().map_or(Ok(Shard::WHOLE), Shard::read);
        let mut request = running::request(&options.model, &options.running);
        // A front end holds the text; without one it may be that of the standard input.
        request.text = text.or(request.text);
        request.packed = packed.clone();
        let keeps = files.traces.is_some();
        let model = Model {
            request,
            measures: options.measures.clone(),
            keep: keeps.then(|| keep(options)),
        };
        let mut session = Session { parameters_vary: true, ..Session::default() };
        let settings = |experiment: &Experiment| settings(options, experiment, keeps);
        let what = describe(options);
        let prepared = Prepared::new(model, design, settings, &what, say, &mut session);
        let prepared = prepared.map_err(|error| {
            say(&session);
            Status::from(error)
        })?;
        if keeps && prepared.shown == 0 {
            eprintln!("error: no variable has a name that `--show` or `--variables` selects");
            return Err(Status::Usage);
        }
        Ok(Command {
            prepared,
            files,
            shard: shard.map_err(refuse)?,
            jobs: options.jobs.unwrap_or_else(cores).max(1),
            restart: options.restart,
        })
    }

    fn run(&self) -> Result<Status, SweepError> {
        let sweep = self.sweep();
        let mut journal = self.journal()?;
        let (runs, before) = (self.runs(), journal.lines);
        let count = runs.end - runs.start;
        interrupt::listen();
        let started_at = Instant::now();
        let progress = Progress::of_runs(before, count);
        let on_progress = |done| progress.iter().for_each(|p| p.reached(done as f64));
        let complete = sweep.run(runs, &mut journal, &interrupt::is_requested, on_progress)?;
        drop(progress);
        let seconds = started_at.elapsed().as_secs_f64();
        let name = &self.prepared.name;
        if !complete && self.files.is_piped {
            journal.remove()?;
            return Ok(Status::Interrupted);
        }
        if !complete {
            let text = format!(
                "{name}: interrupted after {} of {count} runs; the same command resumes from there\n",
                journal.lines
            );
            return Ok(match print(&text) {
                Status::Done => Status::Interrupted,
                status => status,
            });
        }
        let rate = rate(count - before, seconds, self.jobs);
        if self.shard != Shard::WHOLE {
            let Shard { number, of } = self.shard;
            let text = format!(
                "{name}: shard {number} of {of} is complete, {}\n  {rate}\n  `--gather` in place of `--shard` writes the table from all shards\n",
                runs_text(count)
            );
            return Ok(print(&text));
        }
        self.write(vec![journal], &rate)
    }

    /// Writes the table from the journals of shards.
    fn gather(&self) -> Result<Status, SweepError> {
        let found = shards(&self.files.journal);
        let Some(&(_, of, _)) = found.first() else {
            let pattern = shard(&self.files.journal, 1, 4).display().to_string();
            return Err(SweepError::NoShards { pattern });
        };
        if let Some(&(_, second, _)) = found.iter().find(|(_, n, _)| *n != of) {
            return Err(SweepError::TwoDesigns { first: of, second });
        }
        let (mut journals, mut missing) = (Vec::new(), Vec::new());
        for number in 1..=of {
            let runs = Shard { number, of }.runs(self.prepared.design.count);
            let count = runs.end - runs.start;
            let path = found.iter().find(|(k, ..)| *k == number).map(|(.., path)| path);
            let journal = path.map(|path| self.open(path)).transpose()?;
            let lines = journal.as_ref().map_or(0, |journal| journal.lines);
            match journal.filter(|_| lines == count) {
                Some(journal) => journals.push(journal),
                None => missing.push(format!("{number}/{of} has {lines} of {}", runs_text(count))),
            }
        }
        if !missing.is_empty() {
            return Err(SweepError::Incomplete { missing: missing.join(", ") });
        }
        self.write(journals, &format!("gathered from {of} shards"))
    }

    /// Writes the table, removes the journals, and says how it went.
    fn write(&self, mut journals: Vec<Journal>, how: &str) -> Result<Status, SweepError> {
        let tally = self.sweep().write(&mut journals, &self.files.table)?;
        for journal in journals {
            journal.remove()?;
        }
        if self.files.is_piped {
            return Ok(print_file(&self.files.table));
        }
        let status = print(&summary(&self.prepared.name, &tally, how, &self.files));
        Ok(if tally.failed == tally.runs { Status::Numerics } else { status })
    }

    /// Writes the table from the journal of the whole sweep, computed elsewhere in this time, s, and this way.
    pub fn finish(&self, journal: Journal, done: u64, seconds: f64, how: &str) -> Status {
        let rate = format!("{} in {seconds:.2} s {how}", runs_text(done));
        self.write(vec![journal], &rate).unwrap_or_else(|why| refused(&why))
    }

    /// The trajectories of runs are written to files.
    pub fn keeps_trajectories(&self) -> bool {
        self.files.traces.is_some()
    }

    /// The runs of this process.
    fn runs(&self) -> Range<u64> {
        self.shard.runs(self.prepared.design.count)
    }

    fn sweep(&self) -> Sweep<'_> {
        Sweep { traces: self.files.traces.clone(), ..self.prepared.sweep(self.jobs) }
    }

    /// The journal to go on with; makes the folders.
    pub fn journal(&self) -> Result<Journal, SweepError> {
        let files = &self.files;
        let path = match self.shard {
            Shard::WHOLE => files.journal.clone(),
            Shard { number, of } => shard(&files.journal, number, of),
        };
        if let Some(folder) = files.traces.as_deref().or(files.folder.as_deref()) {
            create_folder(folder)?;
        }
        if self.restart {
            remove(&path)?;
        } else if exists(&files.table) && !exists(&path) {
            return Err(SweepError::Finished { output: files.table.display().to_string() });
        }
        self.open(&path)
    }

    fn open(&self, path: &Path) -> Result<Journal, SweepError> {
        let journal = path.display().to_string();
        match Journal::open(path, self.prepared.fingerprint.0, arithmetic())? {
            Found::Ours(journal) => Ok(journal),
            Found::Other => Err(SweepError::Other { journal }),
            Found::Foreign => Err(SweepError::Foreign { journal }),
        }
    }
}

fn design(options: &Options) -> Result<Design, SweepError> {
    let axes = options.vary.iter().map(|t| Axis::read(t)).collect::<Result<Vec<_>, _>>()?;
    match &options.sample {
        None => Design::grid(axes),
        Some(text) => Design::latin_hypercube(axes, sample(text)?, options.seed),
    }
}

/// Settings of all runs. If no trajectory is kept, there are rows at events only.
fn settings(options: &Options, experiment: &Experiment, traces: bool) -> Settings {
    let settings = running::settings(&options.running, &options.model, experiment);
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

/// The options that the rows depend on.
fn describe(options: &Options) -> String {
    let pattern = options.running.variables.as_ref().map(|p| p.as_str().to_owned());
    format!(
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
                options.running.method.map(|named| named.0),
                options.running.mode
            ),
            (options.traces, &options.show, pattern),
            project(options.model.file.as_deref()),
        )
    )
}

/// Extensions of files that a sweep does not write; a folder may have any other.
const OTHER_FILES: [&str; 16] = [
    "mat", "svg", "png", "json", "html", "xlsx", "xls", "ods", "tsv", "txt", "xml", "pdf", "h5",
    "hdf5", "nc", "feather",
];

/// The files of a sweep.
struct Files {
    folder: Option<PathBuf>,
    table: PathBuf,
    journal: PathBuf,
    traces: Option<PathBuf>,
    /// The table is printed.
    is_piped: bool,
}

impl Files {
    fn of(options: &Options) -> Result<Files, SweepError> {
        let is_piped = is_standard(&options.output);
        let output = if is_piped { &scratch_path("csv") } else { &options.output };
        if is_piped && (options.shard.is_some() || options.gather) {
            return Err(SweepError::PipedShard);
        }
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
            let (folder, table, traces) = (None, output.clone(), None);
            return Ok(Files { folder, table, journal, traces, is_piped });
        }
        if extension.is_some_and(|e| OTHER_FILES.contains(&e.as_str())) {
            return Err(SweepError::Format(output.display().to_string()));
        }
        Ok(Files {
            folder: Some(output.clone()),
            table: output.join("sweep.csv"),
            journal: output.join("sweep.journal"),
            traces: wanted.then(|| output.join("runs")),
            is_piped,
        })
    }
}

fn runs_text(n: u64) -> String {
    if n == 1 { "1 run".to_owned() } else { format!("{n} runs") }
}

fn rate(done: u64, seconds: f64, jobs: usize) -> String {
    let threads = if jobs == 1 { "1 thread".to_owned() } else { format!("{jobs} threads") };
    let rate = done as f64 / seconds.max(1e-9);
    format!("{} in {seconds:.2} s on {threads}, {rate:.0} a second", runs_text(done))
}

fn summary(name: &str, tally: &Tally, how: &str, files: &Files) -> String {
    let mut out = format!("{name}: {}, {} failed\n", runs_text(tally.runs), tally.failed);
    if let Some((number, why)) = &tally.first {
        out.push_str(&format!("  first failure: run {number}: {why}\n"));
    }
    out.push_str(&format!("  {how}\n"));
    let shown = |p: &Path| p.display().to_string();
    let traces = files.traces.as_ref().map_or(String::new(), |t| format!(", {}", shown(t)));
    out.push_str(&format!("  wrote {}{traces}\n", shown(&files.table)));
    out
}
