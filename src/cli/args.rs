//! Arguments, help and usage errors. Sole user of `clap` and `regex-lite`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use regex_lite::Regex;

use crate::base::diag::Severity;
use crate::driver::compile::Request;
use crate::ir::program::Form;
use crate::simulate::settings;

/// A compiler and simulator for models of machines written in Modelica.
#[derive(Parser, Debug)]
#[command(name = "mocc", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Compile a model, run it, write a table and a picture.
    Simulate(Simulate),
    /// Make a page with the diagram, the parameters and the runs of a model.
    Report(Report),
    /// Run a model many times with other parameters, write a table with a row for each run.
    Sweep(Sweep),
    /// Draw a chart of tables: runs, sweeps or recordings, overlaid and side by side.
    Plot(Plot),
    /// Say all that is wrong with a file or a model, without running it.
    Check(Check),
    /// Put indentation and spaces in order; comments and line breaks stay.
    #[command(name = "fmt")]
    Format(Format),
    /// Print the flat model: all variables and equations as one Modelica model.
    Flatten(Model),
    /// Fit the free parameters of a plan to recordings.
    Calibrate(Calibrate),
    /// Find which physical effect a model lacks, from recordings.
    Diagnose(Diagnose),
    /// Print how the model is solved: states, blocks in order, what was differentiated.
    Structure(Structure),
}

/// Which model, with which settings.
#[derive(Args, Debug)]
pub struct Model {
    /// File with the model.
    #[arg(value_name = "FILE", required_unless_present = "model")]
    pub file: Option<PathBuf>,
    /// Full name of the model [default: the last model of FILE that is not partial].
    #[arg(long, value_name = "NAME")]
    pub model: Option<String>,
    /// Set a parameter, by its dotted name, before the model is flattened.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub settings: Vec<String>,
    /// Folder with libraries, besides those of MODELICAPATH and the shipped ones.
    #[arg(long = "lib", value_name = "DIR")]
    pub folders: Vec<PathBuf>,
}

/// What to check.
#[derive(Args, Debug)]
pub struct Check {
    /// File with models [all of them are checked].
    #[arg(value_name = "FILE", required_unless_present = "model")]
    pub file: Option<PathBuf>,
    /// Full name of the only model to check.
    #[arg(long, value_name = "NAME")]
    pub model: Option<String>,
    /// Folder with libraries, besides those of MODELICAPATH and the shipped ones.
    #[arg(long = "lib", value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// How bad it is if the units of an equation do not match.
    #[arg(long, value_enum, value_name = "HOW", default_value = "warning")]
    pub units: Units,
    /// Print the problems as JSON, on the standard output.
    #[arg(long)]
    pub json: bool,
}

/// How bad mismatched units are.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Units {
    /// Worth a look.
    Warning,
    /// The model is refused.
    Error,
}

/// What to format.
#[derive(Args, Debug)]
pub struct Format {
    /// Files with models.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Write nothing; name the files that would change, and end with status 1 if there are any.
    #[arg(long)]
    pub check: bool,
}

/// What to make of the block structure.
#[derive(Args, Debug)]
pub struct Structure {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Draw the incidence matrix in block lower triangular order, .svg or .png, and print nothing.
    #[arg(long, value_name = "PATH")]
    pub svg: Option<PathBuf>,
    /// Write the blocks and their dependencies as a graph for Graphviz, and print nothing.
    #[arg(long, value_name = "PATH")]
    pub dot: Option<PathBuf>,
}

/// A run.
#[derive(Args, Debug)]
pub struct Simulate {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// How it is run.
    #[command(flatten)]
    pub running: Running,
    /// Results, .csv, .parquet or .mat [default: MODEL.csv; nothing if only --plot is given].
    #[arg(long, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// Picture, .svg or .png [default: MODEL.svg; nothing if only --output is given].
    #[arg(long, value_name = "PATH")]
    pub plot: Option<PathBuf>,
    /// Variables to draw, separated by commas.
    #[arg(long, value_name = "NAME,...")]
    pub show: Option<String>,
    /// List the events.
    #[arg(long)]
    pub events: bool,
    /// A number to be taken of the run and printed, such as "t = when(s > 0.95*s_max)"; repeatable.
    #[arg(long = "measure", value_name = "NAME=EXPRESSION")]
    pub measures: Vec<String>,
}

/// How a model is run.
#[derive(Args, Debug)]
pub struct Running {
    /// End of the run, s [default: from the experiment annotation, else 1].
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub stop: Option<f64>,
    /// Time between rows, s [default: from the annotation, else a 500th of the run].
    #[arg(long, value_name = "DT", allow_negative_numbers = true)]
    pub interval: Option<f64>,
    /// Relative tolerance [default: from the annotation, else 1e-6].
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// Integration method.
    #[arg(long, value_name = "METHOD", value_enum, default_value_t = Method::Auto)]
    pub method: Method,
    /// Who solves algebraic loops while the model runs.
    #[arg(long, value_name = "MODE", value_enum, default_value_t = Mode::Reduced)]
    pub mode: Mode,
    /// Record only variables in whose names this regular expression is found.
    #[arg(long, value_name = "REGEX", value_parser = Regex::new)]
    pub variables: Option<Regex>,
}

/// A page about a model and its runs.
#[derive(Args, Debug)]
pub struct Report {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// How it is run.
    #[command(flatten)]
    pub running: Running,
    /// The page, .html [default: MODEL_report.html; nothing if only --diagram is given].
    #[arg(long, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// Draw the components and their connections, .svg or .png.
    #[arg(long, value_name = "PATH")]
    pub diagram: Option<PathBuf>,
    /// A run with other parameters, as "LABEL: NAME=VALUE, ..."; several are laid over each other.
    #[arg(long = "run", value_name = "RUN")]
    pub runs: Vec<String>,
    /// A recording to lay over the runs, .csv: names in the first line, the time first.
    #[arg(long, value_name = "PATH")]
    pub data: Vec<PathBuf>,
    /// Which variable a column of the recordings is, and its unit: COLUMN=VARIABLE:UNIT [default: columns
    /// that are called like a variable, in SI units].
    #[arg(long = "signal", value_name = "SIGNAL")]
    pub signals: Vec<String>,
    /// Variables to show at first, separated by commas.
    #[arg(long, value_name = "NAME,...")]
    pub show: Option<String>,
}

/// A chart.
#[derive(Args, Debug)]
pub struct Plot {
    /// Tables, .csv, each perhaps with a label: FILE or FILE=LABEL.
    #[arg(value_name = "FILE[=LABEL]", required = true)]
    pub tables: Vec<String>,
    /// Tables that stand beside them, with the same axes.
    #[arg(long, value_name = "FILE[=LABEL]", num_args = 1..)]
    pub beside: Vec<String>,
    /// The horizontal axis: a text and a formula of columns; several for tables of different kinds.
    #[arg(long, value_name = "TEXT: FORMULA[|...]", allow_hyphen_values = true)]
    pub x: String,
    /// A panel: its text and formula; repeatable.
    #[arg(long, value_name = "TEXT: FORMULA[|...]", allow_hyphen_values = true, required = true)]
    pub y: Vec<String>,
    /// Draw only this part of the horizontal axis.
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true, value_parser = ends)]
    pub range: Option<(f64, f64)>,
    /// The horizontal axis is logarithmic.
    #[arg(long)]
    pub log_x: bool,
    /// Line at the top.
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Line above the tables, and then above those beside them.
    #[arg(long = "heading", value_name = "TEXT")]
    pub headings: Vec<String>,
    /// Picture, .svg or .png.
    #[arg(long, value_name = "PATH")]
    pub output: PathBuf,
}

/// Many runs.
#[derive(Args, Debug)]
pub struct Sweep {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// What varies: NAME=FROM:TO:COUNT, NAME=VALUE,VALUE,... or NAME=VALUE; repeatable, all combinations.
    #[arg(long, value_name = "NAME=VALUES")]
    pub vary: Vec<String>,
    /// Instead of all combinations a Latin hypercube of N runs over the ranges.
    #[arg(long, value_name = "lhs:N")]
    pub sample: Option<String>,
    /// Seed of the sample.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// A number to be taken of each run, such as "t = when(s > 0.95*s_max)"; repeatable.
    #[arg(long = "measure", value_name = "NAME=EXPRESSION")]
    pub measures: Vec<String>,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub jobs: Option<usize>,
    /// Folder, or table as .csv or .parquet.
    #[arg(long, value_name = "PATH")]
    pub output: PathBuf,
    /// Begin anew, and replace what is there.
    #[arg(long, visible_alias = "force")]
    pub restart: bool,
    /// How each is run.
    #[command(flatten)]
    pub running: Running,
    /// Keep the course of each run, in the folder `runs`.
    #[arg(long)]
    pub traces: bool,
    /// Keep the course of these variables only, separated by commas.
    #[arg(long, value_name = "NAME,...")]
    pub show: Option<String>,
}

/// An integration method.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Method {
    /// By what the model is made of.
    Auto,
    /// Radau IIA of order 5: stiff models, models with events.
    Radau,
    /// Backward differentiation of order 1 to 5: large stiff models without events.
    Bdf,
    /// Dormand-Prince of order 5, explicit: models that are not stiff.
    Dopri,
}

/// Who solves algebraic loops.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mode {
    /// The model itself, in each evaluation of its derivatives.
    Reduced,
    /// The integrator, together with the states: for large loops.
    Dae,
}

impl From<Mode> for Form {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Reduced => Form::Reduced,
            Mode::Dae => Form::Implicit,
        }
    }
}

impl From<Method> for settings::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::Auto => settings::Method::Auto,
            Method::Radau => settings::Method::Radau,
            Method::Bdf => settings::Method::Bdf,
            Method::Dopri => settings::Method::Dopri,
        }
    }
}

/// A diagnosis.
#[derive(Args, Debug)]
pub struct Diagnose {
    /// Plan file, TOML: the model, the recordings, what is free.
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// Folder of recordings, instead of the plan's.
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Folder for the results [default: PLAN's name and `-diagnosis`].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Folder with further effects, beside the shipped ones.
    #[arg(long, value_name = "DIR")]
    pub effects: Option<PathBuf>,
    /// Write what was measured and modelled, before and after: a table for each recording.
    #[arg(long)]
    pub tables: bool,
    /// Say on the standard error what is scored, fitted and found, with times.
    #[arg(long)]
    pub verbose: bool,
}

/// A fit.
#[derive(Args, Debug)]
pub struct Calibrate {
    /// Plan file, TOML: the model, the recordings, what is free.
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// Folder of recordings, instead of the plan's.
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Take the intervals from the standard errors, without following the profiles.
    #[arg(long)]
    pub no_profiles: bool,
    /// Folder for the results [default: PLAN-calibration].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl Model {
    /// The request to the compiler.
    pub fn request(&self) -> Request {
        Request {
            file: self.file.clone(),
            model: self.model.clone(),
            appended: None,
            form: Form::default(),
            recorded: Vec::new(),
            settings: self.settings.clone(),
            folders: self.folders.clone(),
            modelica_path: std::env::var_os("MODELICAPATH"),
        }
    }
}

impl Check {
    /// How bad mismatched units are.
    pub fn severity(&self) -> Severity {
        match self.units {
            Units::Warning => Severity::Warning,
            Units::Error => Severity::Error,
        }
    }

    /// The request to the compiler.
    pub fn request(&self) -> Request {
        Request {
            file: self.file.clone(),
            model: self.model.clone(),
            folders: self.folders.clone(),
            modelica_path: std::env::var_os("MODELICAPATH"),
            ..Request::default()
        }
    }
}

/// `FROM:TO`
fn ends(text: &str) -> Result<(f64, f64), String> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let ends = text.split_once(':').and_then(|(from, to)| Some((number(from)?, number(to)?)));
    ends.filter(|(from, to)| from < to).ok_or_else(|| "write FROM:TO, two numbers".to_owned())
}

/// Reads the arguments of the process; on a usage error says so and ends it with status 2.
pub fn read() -> Command {
    Arguments::parse().command
}
