//! Arguments of the commands that run a model: `simulate`, `report`, `watch`, `sweep`.

use std::path::PathBuf;

use clap::Args;

use super::model::{Limits, Model};
use super::running::Running;
use super::values::{page, picture, unit_of};
use crate::io::format::extensions;

/// A run.
#[derive(Args, Debug)]
pub struct Simulate {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Simulation options.
    #[command(flatten)]
    pub running: Running,
    /// Result file, in one of the formats of `io::format`.
    #[arg(short, long, value_name = "PATH", help = output_help())]
    pub output: Option<PathBuf>,
    /// Format of the results, if --output is - for the standard output [default: csv].
    #[arg(long, value_name = "FORMAT")]
    pub format: Option<String>,
    /// Write a variable in another unit, such as p2=bar; repeatable [default: SI units].
    #[arg(long = "unit", value_name = "NAME=UNIT", value_parser = unit_of)]
    pub units: Vec<(String, String)>,
    /// Picture, .svg or .png; `-` prints it as SVG [default: FILE with .svg; none if only --output is given].
    #[arg(long, value_name = "PATH", value_parser = picture)]
    pub plot: Option<PathBuf>,
    /// Variables to draw, separated by commas.
    #[arg(long, value_name = "NAME,...")]
    pub show: Option<String>,
    /// Folder in which the model may write files, in addition to that of the results; repeatable.
    #[arg(long, value_name = "DIR")]
    pub allow_write: Vec<PathBuf>,
    /// List all events with their cause and source location.
    #[arg(long)]
    pub events: bool,
    /// Print a number computed from the run, such as "t = when(s > 0.95*s_max)"; repeatable.
    #[arg(long = "measure", value_name = "NAME=EXPRESSION")]
    pub measures: Vec<String>,
    /// Print a summary with measures, events and statistics as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print measures and events only, no summary.
    #[arg(long, short)]
    pub quiet: bool,
    /// Print how long each stage of the compiler took, too.
    #[arg(long, short, conflicts_with = "quiet")]
    pub verbose: bool,
    /// Print how the initial values come about: fixed, assumed, from equations, redundant, guesses.
    #[arg(long)]
    pub explain_start: bool,
    /// Events that a `sample` may have in the run.
    #[arg(long, value_name = "N", default_value_t = 3e6)]
    pub max_events: f64,
    /// Limits.
    #[command(flatten)]
    pub limits: Limits,
}

/// A page about a model and its runs.
#[derive(Args, Clone, Debug)]
pub struct Report {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Simulation options.
    #[command(flatten)]
    pub running: Running,
    /// The page, .html; `-` prints it [default: FILE with _report.html; none if only --diagram is given].
    #[arg(short, long, value_name = "PATH", value_parser = page)]
    pub output: Option<PathBuf>,
    /// Draw the components and their connections, .svg or .png; `-` prints them as SVG.
    #[arg(long, value_name = "PATH", value_parser = picture)]
    pub diagram: Option<PathBuf>,
    /// Add a run with other parameters, "LABEL: NAME=VALUE, ..."; repeatable.
    #[arg(long = "run", value_name = "RUN")]
    pub runs: Vec<String>,
    /// Overlay a recording, .csv with column names in the first line and time first; repeatable.
    #[arg(long, value_name = "PATH")]
    pub data: Vec<PathBuf>,
    /// Variable and unit of a column of the recordings, COLUMN=VARIABLE:UNIT; repeatable [default: columns
    /// named like variables, in SI units].
    #[arg(long = "signal", value_name = "SIGNAL")]
    pub signals: Vec<String>,
    /// Variables to show first, separated by commas.
    #[arg(long, value_name = "NAME,...")]
    pub show: Option<String>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// A report that is made again whenever a file is saved.
#[derive(Args, Clone, Debug)]
pub struct Watch {
    /// The report.
    #[command(flatten)]
    pub report: Report,
    /// Port on 127.0.0.1 [default: one that is free].
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
}

/// Many runs.
#[derive(Args, Debug)]
pub struct Sweep {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Vary a parameter: NAME=FROM:TO:COUNT, NAME=VALUE,VALUE,... or NAME=VALUE; repeatable: all combinations.
    #[arg(long, value_name = "NAME=VALUES")]
    pub vary: Vec<String>,
    /// Take a Latin hypercube sample of N runs from the ranges instead of all combinations.
    #[arg(long, value_name = "lhs:N")]
    pub sample: Option<String>,
    /// Seed of the sample.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Number computed from each run, such as "t = when(s > 0.95*s_max)"; repeatable.
    #[arg(long = "measure", value_name = "NAME=EXPRESSION")]
    pub measures: Vec<String>,
    /// Number of threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub jobs: Option<usize>,
    /// Folder for the results, or a table as .csv or .parquet; `-` prints it as CSV.
    #[arg(short, long, value_name = "PATH")]
    pub output: PathBuf,
    /// Start again and replace existing results.
    #[arg(long, visible_alias = "force")]
    pub restart: bool,
    /// Do only part I of N, from 1: other processes do the others.
    #[arg(long, value_name = "I/N", conflicts_with_all = ["gather", "cluster"])]
    pub shard: Option<String>,
    /// Write the table from all shards.
    #[arg(long, conflicts_with = "cluster")]
    pub gather: bool,
    /// Let the workers of a Dask cluster do the runs; for the Python package.
    #[arg(long, value_name = "tcp://HOST:PORT")]
    pub cluster: Option<String>,
    /// Simulation options.
    #[command(flatten)]
    pub running: Running,
    /// Keep the trajectories of each run, in the folder `runs`.
    #[arg(long)]
    pub traces: bool,
    /// Keep the trajectories of these variables only, separated by commas.
    #[arg(long, value_name = "NAME,...")]
    pub show: Option<String>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Help of `simulate --output`, with all result formats.
fn output_help() -> String {
    let formats = extensions();
    format!("Result file, {formats} [default: FILE with .csv; none if only --plot is given]")
}
