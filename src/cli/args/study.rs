//! Arguments of the commands with a plan: `plan`, `calibrate`, `diagnose`, `evaluate`, `optimize`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::model::{is_standard, request};
use super::values::{folder, json, plan, seconds};
use crate::driver::compile::Request;

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
    #[arg(short, long, value_name = "FILE", value_parser = plan)]
    pub output: Option<PathBuf>,
    /// Full name of the model [default: the last model of FILE that is not partial].
    #[arg(long, value_name = "NAME")]
    pub model: Option<String>,
    /// Folder with libraries, in addition to MODELICAPATH and the shipped library; repeatable.
    #[arg(long = "lib", value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Print the result and errors only.
    #[arg(long, short)]
    pub quiet: bool,
}

impl PlanSkeleton {
    /// The request to the compiler.
    pub fn request(&self) -> Request {
        request(&Some(self.file.clone()), &self.model, &self.folders, &[])
    }
}

/// A plan, and the folders of its recordings and results.
#[derive(Args, Debug)]
pub struct Study {
    /// Plan file, TOML: the model, the recordings, the free parameters; `-` is the standard input.
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// Folder of the recordings [default: the plan's].
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// FMU, or folder with FMUs, that the plan or its model may run: foreign code; repeatable.
    #[arg(long, value_name = "FILE")]
    pub allow_fmu: Vec<PathBuf>,
    /// Folder for the results [default: PLAN-calibration or PLAN-diagnosis].
    #[arg(long, value_name = "DIR", value_parser = folder)]
    pub out: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

impl Study {
    /// The folder for the results of a kind, `calibration` or `diagnosis`.
    pub fn folder(&self, kind: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            let stem = stem(&self.plan);
            format!("{stem}-{kind}").into()
        })
    }
}

/// The name of the results of a plan: that of its file, or `stdin`.
pub fn stem(plan: &Path) -> String {
    match is_standard(plan) {
        true => "stdin".to_owned(),
        false => plan.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
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
    /// Search among these effects alone, by name; `parameter` for parameters that vary; repeatable.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub only: Vec<String>,
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
    #[arg(long, short)]
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
    /// Plan file, TOML, `-` for the standard input; or the file of a model, .mol or .mo, with --plan.
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
    /// FMU, or folder with FMUs, that the plan or its model may run: foreign code; repeatable.
    #[arg(long, value_name = "FILE")]
    pub allow_fmu: Vec<PathBuf>,
    /// Write the result as JSON; `-`, or nothing, prints it in place of the text.
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-", value_parser = json)]
    pub json: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// A design.
#[derive(Args, Debug)]
pub struct Optimize {
    /// Plan file, TOML: the model, the goal, the limits, the free parameters; `-` is the standard input.
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// Folder for the results [default: PLAN-design].
    #[arg(long, value_name = "DIR", value_parser = folder)]
    pub out: Option<PathBuf>,
    /// Number of threads [default: all cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub jobs: Option<u64>,
    /// Print the result as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}
