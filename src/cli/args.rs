//! Arguments, help and usage errors, completions and man pages. Sole user of `clap` and its companions, and of
//! `regex-lite`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::builder::PossibleValue;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use regex_lite::Regex;

use super::{Status, modelica_path, project, standard_input};
use crate::base::diag::Severity;
use crate::driver::compile::Request;
use crate::fmu::import::model::Integrating;
use crate::io::format::extensions;
use crate::ir::program::SystemForm;
use crate::simulate::settings::Method;

/// Compile and simulate models of machines, fit them to recordings, and find the effects they lack.
#[derive(Parser, Debug)]
#[command(name = "mocc", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Simulate a model, and write a table and a picture.
    Simulate(Simulate),
    /// Write a page with the diagram, parameters and traces of a model.
    Report(Report),
    /// Simulate a model many times with different parameters.
    Sweep(Sweep),
    /// Run the tests of models: snapshots, traces, events, measures, diagnostics.
    Test(Test),
    /// Compare two results within tolerances.
    Compare(Compare),
    /// Start a project: a model, its tests, a plan with recordings.
    New(New),
    /// Write a plan for a model and a folder of recordings.
    Plan(PlanSkeleton),
    /// List, read or copy the classes of libraries.
    Lib(Library),
    /// Serve editors: the language server protocol on standard input and output.
    Lsp,
    /// Print the completions of a shell.
    Completions(Completions),
    /// Write man pages.
    Man(Man),
    /// Draw tables: results, sweeps and recordings, overlaid and side by side.
    Plot(Plot),
    /// Report all problems of the models in a file, without simulating them.
    Check(Check),
    /// Explain a diagnostic, with a model that causes it and its repair.
    Explain(Explain),
    /// Format Modelica files; comments and line breaks are kept.
    #[command(name = "fmt")]
    Format(Format),
    /// Print the flat model: all variables and equations as one Modelica model.
    Flatten(Model),
    /// Fit the free parameters of a plan to recordings.
    Calibrate(Calibrate),
    /// Find the physical effects that a model lacks, from recordings.
    Diagnose(Diagnose),
    /// Judge a model on recordings, without fitting it.
    Evaluate(Evaluate),
    /// Find where a model comes to rest.
    Steady(Steady),
    /// Print the linear system of a model: A, B, C, D and eigenvalues.
    Linearize(Linearize),
    /// Write a model as a file for other tools.
    Export(Export),
    /// Print how a model is solved: states, blocks, differentiated equations.
    Structure(Structure),
}

/// Tests of models.
#[derive(Args, Debug)]
pub struct Test {
    /// Test files, .test.toml, and folders that are searched for them [default: the working directory].
    #[arg(value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// Accept what the runs give: show what changes, then write the snapshots.
    #[arg(long)]
    pub update: bool,
    /// Run only tests whose `FILE: NAME` contains this text.
    #[arg(long, value_name = "TEXT")]
    pub filter: Option<String>,
    /// Number of threads [default: all cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub jobs: Option<u64>,
    /// Write the outcomes as JUnit XML.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Print the outcomes as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Page with the changes, .html, written if there are any.
    #[arg(long, value_name = "FILE", default_value = "mocc-test.html", value_parser = page)]
    pub review: PathBuf,
}

/// A project.
#[derive(Args, Debug)]
pub struct New {
    /// Folder of the project; its name becomes that of the model.
    #[arg(value_name = "NAME")]
    pub name: PathBuf,
    /// Kind of the model.
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Template::Valve)]
    pub template: Template,
}

/// A project to start from.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Template {
    /// A magnet, a spool with seals, and air.
    Valve,
    /// A DC motor with its load.
    Motor,
    /// A heated body in a room.
    Thermal,
}

impl Template {
    /// The name of its folder.
    pub fn name(self) -> &'static str {
        match self {
            Template::Valve => "valve",
            Template::Motor => "motor",
            Template::Thermal => "thermal",
        }
    }
}

/// A plan to be completed.
#[derive(Args, Debug)]
pub struct PlanSkeleton {
    /// File that contains the model.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Folder with recordings, .csv, and perhaps a table of them.
    #[arg(value_name = "DATA")]
    pub data: PathBuf,
    /// The plan, .toml [default: standard output].
    #[arg(long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Full name of the model [default: the last model of FILE that is not partial].
    #[arg(long, value_name = "NAME")]
    pub model: Option<String>,
    /// Folder with libraries, in addition to MODELICAPATH and the shipped library; repeatable.
    #[arg(long = "lib", value_name = "DIR")]
    pub folders: Vec<PathBuf>,
}

impl PlanSkeleton {
    /// The request to the compiler.
    pub fn request(&self) -> Request {
        request(&Some(self.file.clone()), &self.model, &self.folders, &[])
    }
}

/// Libraries.
#[derive(Args, Debug)]
pub struct Library {
    /// The look.
    #[command(subcommand)]
    pub command: LibraryCommand,
    /// Folder with libraries, in addition to MODELICAPATH and the shipped library; repeatable.
    #[arg(long = "lib", value_name = "DIR", global = true)]
    pub folders: Vec<PathBuf>,
}

/// A look at libraries.
#[derive(Subcommand, Debug)]
pub enum LibraryCommand {
    /// List the packages, or the classes of a package, with their descriptions.
    List {
        /// Full name of a package.
        #[arg(value_name = "PACKAGE")]
        package: Option<String>,
    },
    /// Print the source of a class.
    Show {
        /// Full name of the class, such as Seals.FlowSeal.
        #[arg(value_name = "CLASS")]
        class: String,
    },
    /// Write the sources of the shipped library to a folder.
    Copy {
        /// The folder.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
}

/// Completions of a shell.
#[derive(Args, Debug)]
pub struct Completions {
    /// The shell.
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: clap_complete::Shell,
}

/// Man pages.
#[derive(Args, Debug)]
pub struct Man {
    /// Folder for the pages: mocc.1 and one for each command.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

/// Two results.
#[derive(Args, Debug)]
pub struct Compare {
    /// Result of a run, in one of the formats of results.
    #[arg(value_name = "FILE")]
    pub found: PathBuf,
    /// Result that it is compared with.
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,
    /// Variables to compare, separated by commas; `*` means any characters [default: those that both have].
    #[arg(long, value_name = "NAME,...")]
    pub show: Option<String>,
    /// A variable that has another name in the reference; repeatable.
    #[arg(long = "name", value_name = "NAME=OTHER")]
    pub names: Vec<String>,
    /// Tolerance relative to the extent of each variable.
    #[arg(long, allow_negative_numbers = true, value_name = "R", default_value_t = 1e-3, value_parser = tolerance)]
    pub relative: f64,
    /// Tolerance that is added to it, in the unit of the variables.
    #[arg(long, allow_negative_numbers = true, value_name = "A", default_value_t = 0.0, value_parser = tolerance)]
    pub absolute: f64,
    /// Time by which changes may come earlier or later, s [default: a 10000th of the reference's].
    #[arg(long, allow_negative_numbers = true, value_name = "T", value_parser = tolerance)]
    pub time: Option<f64>,
    /// Draw the variables that differ most, .svg or .png.
    #[arg(long, value_name = "PATH", value_parser = picture)]
    pub plot: Option<PathBuf>,
    /// Print the differences as JSON on standard output.
    #[arg(long)]
    pub json: bool,
}

/// The model and its parameter overrides.
#[derive(Args, Debug)]
pub struct Model {
    /// File that contains the model.
    #[arg(value_name = "FILE", required_unless_present = "model")]
    pub file: Option<PathBuf>,
    /// Full name of the model [default: the last model of FILE that is not partial].
    #[arg(long, value_name = "NAME")]
    pub model: Option<String>,
    /// Override a parameter by its dotted name; repeatable.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub settings: Vec<String>,
    /// Folder with libraries, in addition to MODELICAPATH and the shipped library; repeatable.
    #[arg(long = "lib", value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Folder whose data files the model may read, in addition to its own and those of libraries; repeatable.
    #[arg(long, value_name = "DIR")]
    pub allow_read: Vec<PathBuf>,
}

/// Limits of a command.
#[derive(Args, Debug, Default)]
pub struct Limits {
    /// Memory that the command may use, GB [default: three quarters of the machine's].
    #[arg(long, value_name = "GB")]
    pub max_memory: Option<f64>,
    /// Time that the command may take, s [default: unlimited].
    #[arg(long, value_name = "S")]
    pub max_seconds: Option<f64>,
    /// Components, and scalar variables, that the model may have; its expressions are limited in
    /// proportion [default: 3000000].
    #[arg(long, value_name = "N")]
    pub max_size: Option<usize>,
}

/// The models to check.
#[derive(Args, Debug)]
pub struct Check {
    /// File whose models are checked.
    #[arg(value_name = "FILE", required_unless_present = "model")]
    pub file: Option<PathBuf>,
    /// Full name of the model to check [default: all models in FILE].
    #[arg(long, value_name = "NAME")]
    pub model: Option<String>,
    /// Folder with libraries, in addition to MODELICAPATH and the shipped library; repeatable.
    #[arg(long = "lib", value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Folder whose data files the model may read, in addition to its own and those of libraries; repeatable.
    #[arg(long, value_name = "DIR")]
    pub allow_read: Vec<PathBuf>,
    /// Severity of mismatched units.
    #[arg(long, value_enum, value_name = "HOW", default_value = "warning")]
    pub units: Units,
    /// Print the problems as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Limits.
    #[command(flatten)]
    pub limits: Limits,
}

/// Severity of mismatched units.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Units {
    /// Report a warning.
    Warning,
    /// Report an error.
    Error,
}

/// What to export.
#[derive(Args, Debug)]
pub struct Export {
    /// The kind of file.
    #[command(subcommand)]
    pub what: Exported,
}

/// The kinds of files.
#[derive(Subcommand, Debug)]
pub enum Exported {
    /// A Functional Mock-up Unit, which runs in Simulink, Dymola, Python and other tools.
    Fmu(ExportFmu),
}

/// The FMU to make.
#[derive(Args, Debug)]
pub struct ExportFmu {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Version of FMI: 2 for 2.0.5, 3 for 3.0.2.
    #[arg(long, value_name = "VERSION", default_value = "3", value_parser = ["2", "3"])]
    pub fmi: String,
    /// Who integrates: the importer (me), the FMU (cs), or either.
    #[arg(long = "type", value_enum, value_name = "TYPE", default_value = "both")]
    pub kind: FmuType,
    /// File to write [default: the name of the model, with `.fmu`].
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Shared library that runs the model [default: `libmocc_fmu.so` next to mocc].
    #[arg(long, value_name = "PATH")]
    pub runtime: Option<PathBuf>,
    /// Add the source files of the model to the archive.
    #[arg(long)]
    pub with_source: bool,
}

/// Who integrates.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum FmuType {
    /// The importer: Model Exchange.
    Me,
    /// The FMU: Co-Simulation.
    Cs,
    /// Either.
    Both,
}

/// The diagnostic to explain.
#[derive(Args, Debug)]
pub struct Explain {
    /// Code of the diagnostic, such as MO0402 or 402; without it, all codes are listed.
    #[arg(value_name = "CODE")]
    pub code: Option<String>,
}

/// The files to format.
#[derive(Args, Debug)]
pub struct Format {
    /// Modelica files.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Write nothing; list the files that would change, and exit with status 1 if there are any.
    #[arg(long)]
    pub check: bool,
}

/// The output of the block structure.
#[derive(Args, Debug)]
pub struct Structure {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Draw the incidence matrix in block lower triangular order instead, .svg or .png.
    #[arg(long, value_name = "PATH", value_parser = picture)]
    pub svg: Option<PathBuf>,
    /// Write the blocks and their dependencies as a Graphviz graph instead.
    #[arg(long, value_name = "PATH")]
    pub dot: Option<PathBuf>,
}

/// A model with constant inputs.
#[derive(Args, Debug)]
pub struct Point {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Hold an input at a value, SI; repeatable [default: its start value].
    #[arg(long = "input", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub inputs: Vec<String>,
    /// Relative tolerance of the simulation up to the point [default: annotation, else 1e-6].
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// Write the result as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// A steady state.
#[derive(Args, Debug)]
pub struct Steady {
    /// The model and its inputs.
    #[command(flatten)]
    pub point: Point,
    /// Solve the equations from the initial values instead of simulating; also finds unstable states.
    #[arg(long)]
    pub solve: bool,
}

/// A linear system.
#[derive(Args, Debug)]
pub struct Linearize {
    /// The model and its inputs.
    #[command(flatten)]
    pub point: Point,
    /// Instant of a run, s, or `steady`.
    #[arg(long, value_name = "T|steady", default_value = "0", allow_negative_numbers = true, value_parser = at)]
    pub at: At,
    /// A variable that is an output; repeatable [default: the outputs of the model].
    #[arg(long = "output", value_name = "NAME")]
    pub outputs: Vec<String>,
}

/// Where a model is linearized.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum At {
    /// At an instant of a run, s.
    Time(f64),
    /// Where it comes to rest.
    Steady,
}

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
    #[arg(long, value_name = "PATH", help = output_help())]
    pub output: Option<PathBuf>,
    /// Format of the results, if --output is - for the standard output.
    #[arg(long, value_name = "FORMAT", default_value = "csv")]
    pub format: String,
    /// Write a variable in another unit, such as p2=bar; repeatable [default: SI units].
    #[arg(long = "unit", value_name = "NAME=UNIT", value_parser = unit_of)]
    pub units: Vec<(String, String)>,
    /// Picture, .svg or .png [default: FILE with .svg; none if only --output is given].
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
    #[arg(long, conflicts_with_all = ["quiet", "events"])]
    pub json: bool,
    /// Print measures and events only, no summary.
    #[arg(long, short)]
    pub quiet: bool,
    /// Print how long each stage of the compiler took, too.
    #[arg(long, short, conflicts_with = "quiet")]
    pub verbose: bool,
    /// Events that a `sample` may have in the run.
    #[arg(long, value_name = "N", default_value_t = 3e6)]
    pub max_events: f64,
    /// Limits.
    #[command(flatten)]
    pub limits: Limits,
}

/// Simulation options.
#[derive(Args, Debug)]
pub struct Running {
    /// End of the simulation, s [default: experiment annotation, else 1].
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub stop: Option<f64>,
    /// Time between rows, s [default: annotation, else a 500th of the simulated time].
    #[arg(long, value_name = "DT", allow_negative_numbers = true)]
    pub interval: Option<f64>,
    /// Relative tolerance [default: annotation, else 1e-6].
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// Longest step, s: shorter pulses of the state may be stepped over [default: a 50th of the simulated time].
    #[arg(long, value_name = "DT", allow_negative_numbers = true)]
    pub max_step: Option<f64>,
    /// Integration method.
    #[arg(long, value_name = "METHOD", value_enum, default_value_t = Method::Auto)]
    pub method: Method,
    /// Solver of algebraic loops.
    #[arg(long, value_name = "MODE", value_enum, default_value_t = Mode::Reduced)]
    pub mode: Mode,
    /// Record only variables whose name matches this regular expression.
    #[arg(long, value_name = "REGEX", value_parser = Regex::new)]
    pub variables: Option<Regex>,
    /// Who integrates an FMU: mocc (Model Exchange) or the FMU (Co-Simulation) [default: me, if FILE offers it].
    #[arg(long, value_name = "TYPE", value_enum)]
    pub fmi_type: Option<ImportedType>,
}

/// Who integrates an imported FMU.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum ImportedType {
    /// Model Exchange.
    Me,
    /// Co-Simulation.
    Cs,
}

impl From<ImportedType> for Integrating {
    fn from(kind: ImportedType) -> Self {
        match kind {
            ImportedType::Me => Integrating::Here,
            ImportedType::Cs => Integrating::There,
        }
    }
}

/// A page about a model and its runs.
#[derive(Args, Debug)]
pub struct Report {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Simulation options.
    #[command(flatten)]
    pub running: Running,
    /// The page, .html [default: FILE with _report.html; none if only --diagram is given].
    #[arg(long, value_name = "PATH", value_parser = page)]
    pub output: Option<PathBuf>,
    /// Draw the components and their connections, .svg or .png.
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
}

/// A chart.
#[derive(Args, Debug)]
pub struct Plot {
    /// Tables, .csv, each with an optional label.
    #[arg(value_name = "FILE[=LABEL]", required = true)]
    pub tables: Vec<String>,
    /// Second group of tables, drawn next to the first on the same axes.
    #[arg(long, value_name = "FILE[=LABEL]", num_args = 1..)]
    pub beside: Vec<String>,
    /// Horizontal axis: a column, or a label and a formula over columns; mocc uses the first formula whose columns exist
    /// [default: the first column].
    #[arg(long, value_name = "LABEL: FORMULA[|...]", allow_hyphen_values = true)]
    pub x: Option<String>,
    /// Vertical axis of a panel: a column, or its label and formula; repeat for more panels [default: the first columns].
    #[arg(long, value_name = "LABEL: FORMULA[|...]", allow_hyphen_values = true)]
    pub y: Vec<String>,
    /// Draw only this part of the horizontal axis.
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true, value_parser = ends)]
    pub range: Option<(f64, f64)>,
    /// Use a logarithmic horizontal axis.
    #[arg(long)]
    pub log_x: bool,
    /// Title of the picture.
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Heading of the first group of tables; repeat for the second.
    #[arg(long = "heading", value_name = "TEXT")]
    pub headings: Vec<String>,
    /// Picture, .svg or .png [default: the first FILE with .svg].
    #[arg(long, value_name = "PATH", value_parser = picture)]
    pub output: Option<PathBuf>,
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
    /// Folder for the results, or a table as .csv or .parquet.
    #[arg(long, value_name = "PATH")]
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
}

impl ValueEnum for Method {
    fn value_variants<'a>() -> &'a [Self] {
        &[Method::Auto, Method::Radau, Method::Bdf, Method::Dopri]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, help) = match self {
            Method::Auto => ("auto", "Chosen by the structure of the model"),
            Method::Radau => {
                ("radau", "Radau IIA of order 5, implicit: stiff models, models with events")
            }
            Method::Bdf => (
                "bdf",
                "Backward differentiation of order 1 to 5, implicit: large stiff models without events",
            ),
            Method::Dopri => (
                "dopri",
                "Dormand and Prince's method of order 5, explicit: models that are not stiff",
            ),
        };
        Some(PossibleValue::new(name).help(help))
    }
}

/// Solver of algebraic loops.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mode {
    /// Solved inside each evaluation of the model.
    Reduced,
    /// Solved by the integrator together with the states: for large loops.
    Dae,
}

impl From<Mode> for SystemForm {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Reduced => SystemForm::Ode,
            Mode::Dae => SystemForm::Dae,
        }
    }
}

/// A plan, and the folders of its recordings and results.
#[derive(Args, Debug)]
pub struct Study {
    /// Plan file, TOML: the model, the recordings, the free parameters.
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// Folder of the recordings [default: the plan's].
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Folder for the results [default: PLAN-calibration or PLAN-diagnosis].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl Study {
    /// The folder for the results of a kind, `calibration` or `diagnosis`.
    pub fn folder(&self, kind: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            let stem = self.plan.file_stem().unwrap_or_default().to_string_lossy();
            format!("{stem}-{kind}").into()
        })
    }
}

/// A diagnosis.
#[derive(Args, Debug)]
pub struct Diagnose {
    /// The study.
    #[command(flatten)]
    pub study: Study,
    /// Folder with further effects, in addition to the shipped ones.
    #[arg(long, value_name = "DIR")]
    pub effects: Option<PathBuf>,
    /// Write measured and simulated values, before and after, as a table for each recording.
    #[arg(long)]
    pub tables: bool,
    /// Find the recording that would tell most: its conditions, within the ranges of those at hand.
    #[arg(long)]
    pub next: bool,
    /// End the search after this time, s, with the best verdict so far.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub time_limit: Option<f64>,
    /// Report progress on standard error: candidates scored, fitted and kept, with times.
    #[arg(long)]
    pub verbose: bool,
}

/// A fit.
#[derive(Args, Debug)]
pub struct Calibrate {
    /// The study.
    #[command(flatten)]
    pub study: Study,
    /// Derive the intervals from the standard errors alone, which is faster.
    #[arg(long)]
    pub no_profiles: bool,
}

/// A frozen model and what it is judged by.
#[derive(Args, Debug)]
pub struct Evaluate {
    /// Plan file, TOML; or the file of a model, .mol or .mo, with --plan.
    #[arg(value_name = "PLAN|MODEL")]
    pub subject: PathBuf,
    /// Plan for the model that is named first.
    #[arg(long, value_name = "PLAN")]
    pub plan: Option<PathBuf>,
    /// File whose last model takes the place of the plan's model.
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Folder of the recordings [default: the plan's].
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Write the result as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

impl Model {
    /// The request to the compiler.
    pub fn request(&self) -> Request {
        let settings = self.settings.clone();
        let request = request(&self.file, &self.model, &self.folders, &self.allow_read);
        Request { settings, ..request }
    }
}

impl Check {
    /// Severity of mismatched units.
    pub fn severity(&self) -> Severity {
        match self.units {
            Units::Warning => Severity::Warning,
            Units::Error => Severity::Error,
        }
    }

    /// The request to the compiler.
    pub fn request(&self) -> Request {
        let max_size = self.limits.max_size;
        Request { max_size, ..request(&self.file, &self.model, &self.folders, &self.allow_read) }
    }
}

/// A request with the settings of the project. The file `-` is the standard input.
fn request(
    file: &Option<PathBuf>,
    model: &Option<String>,
    folders: &[PathBuf],
    readable: &[PathBuf],
) -> Request {
    let project = project(file.as_deref());
    let text = file.as_deref().filter(|file| is_standard(file)).map(|_| standard_input());
    Request {
        text,
        folders: folders.iter().chain(&project.libraries).cloned().collect(),
        readable: readable.iter().chain(&project.allow_read).cloned().collect(),
        modelica_path: modelica_path(),
        ..Request::new(file.clone(), model.clone())
    }
}

/// Whether a path means the standard input or output.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

/// A picture by its extension.
fn picture(text: &str) -> Result<PathBuf, String> {
    with_extension(text, &["svg", "png"])
}

/// A page by its extension.
fn page(text: &str) -> Result<PathBuf, String> {
    with_extension(text, &["html", "htm"])
}

fn with_extension(text: &str, known: &[&str]) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref().is_some_and(|e| known.contains(&e)) {
        true => Ok(path),
        false => {
            let names: Vec<String> = known.iter().map(|e| format!(".{e}")).collect();
            Err(format!("its name must end in {}", names.join(" or ")))
        }
    }
}

/// `NAME=UNIT`
fn unit_of(text: &str) -> Result<(String, String), String> {
    let pair = text.split_once('=').map(|(name, unit)| (name.trim(), unit.trim()));
    let pair = pair.filter(|(name, unit)| !name.is_empty() && !unit.is_empty());
    let (name, unit) = pair.ok_or_else(|| "write NAME=UNIT".to_owned())?;
    Ok((name.to_owned(), unit.to_owned()))
}

/// The whole command line, for completions and man pages.
pub fn whole() -> clap::Command {
    Arguments::command()
}

/// Prints the completions of a shell as a text.
pub fn completions(shell: clap_complete::Shell) -> Vec<u8> {
    let mut out = Vec::new();
    clap_complete::generate(shell, &mut whole(), "mocc", &mut out);
    out
}

/// The man pages: the name of each file, and its text.
pub fn man_pages() -> Vec<(String, Vec<u8>)> {
    let mut pages = Vec::new();
    let mut all = whole();
    all.build();
    let version = env!("CARGO_PKG_VERSION");
    let mut waiting = vec![("mocc".to_owned(), all)];
    while let Some((name, command)) = waiting.pop() {
        for inner in command.get_subcommands().filter(|c| c.get_name() != "help") {
            waiting.push((format!("{name}-{}", inner.get_name()), inner.clone()));
        }
        let mut text = Vec::new();
        let shown = command.version(version);
        // Writing to memory does not fail.
        let _ = clap_mangen::Man::new(shown).render(&mut text);
        pages.push((format!("{name}.1"), text));
    }
    pages.sort();
    pages
}

/// `FROM:TO`
fn ends(text: &str) -> Result<(f64, f64), String> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let ends = text.split_once(':').and_then(|(from, to)| Some((number(from)?, number(to)?)));
    ends.filter(|(from, to)| from < to).ok_or_else(|| "write FROM:TO, two numbers".to_owned())
}

/// `steady`, or an instant.
fn at(text: &str) -> Result<At, String> {
    if text.trim() == "steady" {
        return Ok(At::Steady);
    }
    let time = text.trim().parse::<f64>().ok().filter(|t| t.is_finite());
    time.map(At::Time).ok_or_else(|| "write a time in s, or `steady`".to_owned())
}

/// A number that is not negative.
fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|t| t.is_finite() && *t >= 0.0);
    number.ok_or_else(|| "write a number that is not negative".to_owned())
}

/// A time in s that is not negative.
fn seconds(text: &str) -> Result<f64, String> {
    let time = text.trim().parse::<f64>().ok().filter(|t| t.is_finite() && *t >= 0.0);
    time.ok_or_else(|| "write a time in s".to_owned())
}

/// Reads the arguments, the first of which is the name of the program. An error prints the help or the usage that the
/// arguments ask for, and is the status to exit with.
pub fn read(arguments: Vec<OsString>) -> Result<Command, Status> {
    Arguments::try_parse_from(arguments).map(|read| read.command).map_err(|error| {
        // Nobody reads a message that cannot be printed.
        let _ = error.print();
        if error.use_stderr() { Status::Usage } else { Status::Done }
    })
}

/// Help of `simulate --output`, with all result formats.
fn output_help() -> String {
    let formats = extensions();
    format!("Result file, {formats} [default: FILE with .csv; none if only --plot is given]")
}
