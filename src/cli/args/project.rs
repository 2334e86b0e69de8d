//! Arguments of the commands of a project: `new`, `test`, `lib`, `doc`, `completions`, `man`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::values::{folder, junit, page};

/// Tests of models.
#[derive(Args, Debug)]
pub struct Test {
    /// Test files, .test.toml, models, and folders that are searched for them; `-` is a test file on the standard input [default: the working directory].
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
    /// Write the outcomes as JUnit XML; `-` prints it in place of the text.
    #[arg(long, value_name = "FILE", value_parser = junit)]
    pub junit: Option<PathBuf>,
    /// Print the outcomes as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Page with the changes, .html, written if there are any; `-` prints it in place of the text
    /// [default: mocc-test.html].
    #[arg(long, value_name = "FILE", value_parser = page)]
    pub review: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
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
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
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

/// Libraries.
#[derive(Args, Debug)]
pub struct Library {
    /// The look.
    #[command(subcommand)]
    pub command: LibraryCommand,
    /// Folder with libraries, in addition to MODELICAPATH and the shipped library; repeatable.
    #[arg(long = "lib", value_name = "DIR", global = true)]
    pub folders: Vec<PathBuf>,
    /// Print the result and errors only.
    #[arg(long, short, global = true)]
    pub quiet: bool,
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
        #[arg(value_name = "DIR", value_parser = folder)]
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
    #[arg(value_name = "DIR", value_parser = folder)]
    pub folder: PathBuf,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Pages of a library.
#[derive(Args, Debug)]
pub struct Doc {
    /// Package, folder of packages, or file [default: the shipped library].
    #[arg(value_name = "PATH")]
    pub path: Option<PathBuf>,
    /// HTML opens from disk; Markdown is for a book or a repository.
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "html")]
    pub format: PageFormat,
    /// Folder for the pages; index.html, or README.md, is the first.
    #[arg(short, long, value_name = "DIR", value_parser = folder)]
    pub output: PathBuf,
    /// Folder with libraries, in addition to MODELICAPATH and the shipped library; repeatable.
    #[arg(long = "lib", value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// The format of pages of a library.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum PageFormat {
    /// A page for each class.
    Html,
    /// A page for each package.
    Markdown,
}
