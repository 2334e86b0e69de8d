//! Arguments, help and usage errors, completions and man pages: one file for each family of commands. Sole user of
//! `clap` and its companions, and of `regex-lite`.

pub mod export;
pub mod inspect;
pub mod linear;
pub mod model;
pub mod project;
pub mod results;
pub mod running;
pub mod runs;
pub mod study;
pub mod values;

use std::ffi::OsString;
use std::path::Path;

use clap::{CommandFactory, Parser, Subcommand};

use super::Status;
use export::{Export, Import};
use inspect::{Check, Explain, Flatten, Format, Structure};
use linear::{Linearize, Steady};
use project::{Completions, Doc, Library, Man, New, Test};
use results::{Compare, Plot};
use runs::{Report, Simulate, Sweep, Watch};
use study::{Calibrate, Diagnose, Evaluate, Optimize, PlanSkeleton};

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
    /// Make a report again whenever a file is saved, in a page that updates itself.
    Watch(Watch),
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
    /// Write pages of a library: diagrams, parameters, equations, where each class is used.
    Doc(Doc),
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
    Flatten(Flatten),
    /// Fit the free parameters of a plan to recordings.
    Calibrate(Calibrate),
    /// Find the physical effects that a model lacks, from recordings.
    Diagnose(Diagnose),
    /// Find the parameters that make a measure least or greatest, within limits.
    Optimize(Optimize),
    /// Judge a model on recordings, without fitting it.
    Evaluate(Evaluate),
    /// Find where a model comes to rest.
    Steady(Steady),
    /// Print the linear system of a model: A, B, C, D and eigenvalues.
    Linearize(Linearize),
    /// Write a model as a file for other tools.
    Export(Export),
    /// Write a block that uses an FMU as a component of models.
    Import(Import),
    /// Print how a model is solved: states, blocks, differentiated equations.
    Structure(Structure),
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

/// `--json` before the file of a model or a plan has no value: that file is what the command reads.
fn plain_json(arguments: Vec<OsString>) -> Vec<OsString> {
    let is_subject = |next: &OsString| {
        let extension = Path::new(next).extension().and_then(|e| e.to_str());
        extension.is_some_and(|e| ["mo", "mol", "toml", "fmu"].contains(&e))
    };
    let mut read = arguments.into_iter().peekable();
    let mut out = Vec::new();
    while let Some(argument) = read.next() {
        let takes_file = out.get(1).is_some_and(|command: &OsString| {
            ["steady", "linearize", "evaluate"].iter().any(|name| command == name)
        });
        let is_alone = takes_file && argument == "--json" && read.peek().is_some_and(is_subject);
        out.push(if is_alone { "--json=-".into() } else { argument });
    }
    out
}

/// Reads the arguments, the first of which is the name of the program. An error prints the help or the usage that the
/// arguments ask for, and is the status to exit with.
pub fn read(arguments: Vec<OsString>) -> Result<Command, Status> {
    Arguments::try_parse_from(plain_json(arguments)).map(|read| read.command).map_err(|error| {
        // Nobody reads a message that cannot be printed.
        let _ = error.print();
        if error.use_stderr() { Status::Usage } else { Status::Done }
    })
}
