//! Arguments of the commands that look at the text or the structure of a model: `check`, `explain`, `fmt`, `structure`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::model::{Limits, Model, request};
use super::values::{graph, picture};
use crate::base::diag::Severity;
use crate::driver::compile::Request;

/// The models to check.
#[derive(Args, Debug)]
pub struct Check {
    /// File whose models are checked, or a plan, .toml.
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
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Severity of mismatched units.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Units {
    /// Report a warning.
    Warning,
    /// Report an error.
    Error,
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
    /// Print the result and errors only.
    #[arg(long, short)]
    pub quiet: bool,
}

/// The model whose equations are printed.
#[derive(Args, Debug)]
pub struct Flatten {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Print the result and errors only.
    #[arg(long, short)]
    pub quiet: bool,
}

/// The output of the block structure.
#[derive(Args, Debug)]
pub struct Structure {
    /// The model.
    #[command(flatten)]
    pub model: Model,
    /// Draw the incidence matrix in block lower triangular order instead, .svg or .png; `-` prints it as SVG.
    #[arg(long, value_name = "PATH", value_parser = picture)]
    pub svg: Option<PathBuf>,
    /// Write the blocks and their dependencies as a Graphviz graph instead; `-` prints it.
    #[arg(long, value_name = "PATH", value_parser = graph)]
    pub dot: Option<PathBuf>,
    /// Print the result and errors only.
    #[arg(long, short)]
    pub quiet: bool,
}

impl Check {
    /// The plan, if it is one that is checked.
    pub fn plan(&self) -> Option<&Path> {
        self.file.as_deref().filter(|file| file.extension().is_some_and(|e| e == "toml"))
    }

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
