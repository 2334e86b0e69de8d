//! Arguments of `export` and `import`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::model::Model;
use super::values::{fmu, modelica};

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
    /// File to write; `-` is the standard output [default: the name of the model, with `.fmu`].
    #[arg(short, long, value_name = "FILE", value_parser = fmu)]
    pub output: Option<PathBuf>,
    /// Shared library that runs the model [default: `libmocc_fmu.so` next to mocc].
    #[arg(long, value_name = "PATH")]
    pub runtime: Option<PathBuf>,
    /// Add the source files of the model to the archive.
    #[arg(long)]
    pub with_source: bool,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// The FMU to use in models.
#[derive(Args, Debug)]
pub struct Import {
    /// The FMU.
    #[arg(value_name = "FMU")]
    pub file: PathBuf,
    /// File to write; `-` prints it [default: the name of the block, with `.mo`].
    #[arg(short, long, value_name = "FILE", value_parser = modelica)]
    pub output: Option<PathBuf>,
    /// Name of the block [default: that of the FMU's file].
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
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
