//! The model of a command, its limits, and the request to the compiler that they make.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::{modelica_path, project, standard_input};
use crate::driver::compile::Request;

/// The model and its parameter overrides.
#[derive(Args, Clone, Debug)]
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
    /// FMU, or folder with FMUs, that components of the model may run: foreign code; repeatable.
    #[arg(long, value_name = "FILE")]
    pub allow_fmu: Vec<PathBuf>,
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

impl Model {
    /// The request to the compiler.
    pub fn request(&self) -> Request {
        let (settings, fmus) = (self.settings.clone(), self.allow_fmu.clone());
        let request = request(&self.file, &self.model, &self.folders, &self.allow_read);
        Request { settings, fmus, ..request }
    }
}

/// A request with the settings of the project. The file `-` is the standard input.
pub fn request(
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
