//! `mocc report`: writes a page about a model and its runs, and the diagram of its components.

pub mod diagram;
pub mod parameters;
pub mod recordings;
pub mod runs;

use std::path::{Path, PathBuf};

use super::args::model::is_standard;
use super::args::runs::Report;
use super::{Status, interrupt, print, running, say, standard, write_result};
use crate::base::index::FastSet;
use crate::base::source::{SETTING, SourceMap, Span};
use crate::driver::compile::{Request, Session};
use crate::ir::assembly::Assembly;
use crate::ir::flat::{FlatModel, Variability};
use crate::ir::program::Program;
use crate::ir::trajectory::Column;
use crate::report::page::document::{Document, html};
use crate::report::page::parameters::Value;
use crate::report::page::view::View;
use crate::report::plot::choice::interesting;
use crate::report::plot::figure::panels_for;
use parameters::parameters;
use recordings::{Signal, measured, signals};
use runs::{FinishedRun, RunRequest, requested, simulated};

/// Runs the command.
pub fn run(options: &Report) -> Status {
    match make(options) {
        Ok(status) | Err(status) => status,
    }
}

/// Makes the page at `path`, and prints nothing but errors.
pub(super) fn make_page(options: &Report, path: PathBuf) -> Status {
    run(&Report { output: Some(path), quiet: true, ..options.clone() })
}

/// Reports an error in the command line or a file.
fn wrong(why: impl std::fmt::Display) -> Status {
    eprintln!("error: {why}");
    Status::Usage
}

/// What the user asks for.
struct Order<'o> {
    options: &'o Report,
    /// The request to the compiler without overrides.
    base: Request,
    runs: Vec<RunRequest>,
    signals: Vec<Signal>,
    /// A result goes to the standard output, in place of the text.
    is_piped: bool,
}

fn make(options: &Report) -> Result<Status, Status> {
    let outputs = [("--output", &options.output), ("--diagram", &options.diagram)];
    let order = Order {
        options,
        base: running::request(&options.model, &options.running),
        runs: requested(options).map_err(wrong)?,
        signals: signals(&options.signals).map_err(wrong)?,
        is_piped: standard::single(&outputs).map_err(wrong)?.is_some(),
    };
    let mut session = Session::default();
    let request = Request { settings: order.runs[0].settings.clone(), ..order.base.clone() };
    let (flat, assembly) = match session.flatten_with_assembly(&request) {
        Ok(found) => found,
        Err(why) => {
            say(&session);
            return Err(why.into());
        }
    };
    if options.diagram.is_some() && options.output.is_none() {
        say(&session);
        let written = diagram::write(options, &assembly, &session.sources)?;
        return Ok(summary(&order, String::new(), &written));
    }
    page(&order, session, flat, &assembly)
}

/// Makes the runs and writes the page, and the diagram if it is asked for.
fn page(
    order: &Order<'_>,
    mut session: Session,
    flat: FlatModel,
    assembly: &Assembly,
) -> Result<Status, Status> {
    let options = order.options;
    let names: FastSet<String> = flat
        .variables
        .iter()
        .filter(|v| v.variability == Variability::Parameter)
        .map(|v| v.name.clone())
        .collect();
    let description = flat.description.as_deref().unwrap_or_default().to_owned();
    let first = session.compile_flat(flat, order.base.form);
    say(&session);
    let first = first.map_err(Status::from)?;
    let output = options.output.clone().unwrap_or_else(|| {
        PathBuf::from(format!("{}_report.html", running::stem(&options.model, &first)))
    });
    interrupt::listen();
    let mut remarks = Vec::new();
    let model = first.blocks.dae.name.clone();
    let finished = all_runs(order, first, &session.sources, &mut remarks)?;
    let is_interrupted = finished.iter().any(|run| run.interrupted);
    let columns = &finished[0].part.trajectory.columns;
    let show = shown(options, &finished[0]).map_err(wrong)?;
    let measured = measured(&options.data, &order.signals, columns).map_err(wrong)?;
    let view = view(&order.base, assembly, &finished[0].values, &mut remarks);
    let place = |span: Span| session.sources.place(span).unwrap_or_default();
    let document = Document {
        view,
        model,
        description,
        version: env!("CARGO_PKG_VERSION"),
        command: command(),
        assembly,
        place: &place,
        texts: texts(&session.sources),
        parameters: parameters(&finished, &order.runs, &names, &place),
        runs: finished.into_iter().map(|run| run.part).collect(),
        measured,
        show,
        remarks,
    };
    let mut written = diagram::write(options, assembly, &session.sources)?;
    write_result(&output, html(&document).as_bytes()).map_err(wrong)?;
    written.push(output);
    let heading = format!("{}: {}\n", document.model, counted(document.runs.len()));
    let status = summary(order, heading, &written);
    Ok(if is_interrupted { Status::Interrupted } else { status })
}

/// Compiles and makes all runs; the first is compiled. All have the same variables.
fn all_runs(
    order: &Order<'_>,
    first: Program,
    sources: &SourceMap,
    remarks: &mut Vec<String>,
) -> Result<Vec<FinishedRun>, Status> {
    let options = order.options;
    let mut finished = vec![simulated(options, &order.runs[0], first, sources, remarks)?];
    for wanted in &order.runs[1..] {
        let mut own = Session::default();
        let request = Request { settings: wanted.settings.clone(), ..order.base.clone() };
        let program = own.compile(&request);
        say(&own);
        let program = program.map_err(Status::from)?;
        let run = simulated(options, wanted, program, &own.sources, &mut Vec::new())?;
        if run.part.trajectory.columns != finished[0].part.trajectory.columns {
            let label = &wanted.label;
            return Err(wrong(format!(
                "the variables of run `{label}` differ from those of the first run"
            )));
        }
        finished.push(run);
    }
    if finished.iter().any(|run| run.interrupted) {
        remarks.push("A run was interrupted: these are the results until then.".to_owned());
    }
    Ok(finished)
}

/// The variables that the page shows first: those of `--show`, or those that are likely to interest.
fn shown(options: &Report, first: &FinishedRun) -> Result<Vec<String>, String> {
    let Some(list) = &options.show else { return Ok(interesting(&first.part.trajectory)) };
    let names = running::names_in(list);
    let all: Vec<&str> = names.iter().map(String::as_str).collect();
    panels_for(&all, &first.part.trajectory.columns).map_err(|e| e.to_string())?;
    Ok(names)
}

/// Prints what was written, unless the user wants nothing printed or a result is on the standard output.
fn summary(order: &Order<'_>, heading: String, written: &[PathBuf]) -> Status {
    if order.options.quiet {
        return Status::Done;
    }
    let files = written.iter().filter(|path| !is_standard(path));
    let names: Vec<String> = files.map(|p| p.display().to_string()).collect();
    let text = match names.is_empty() {
        true => heading,
        false => format!("{heading}  wrote {}\n", names.join(", ")),
    };
    if order.is_piped {
        eprint!("{text}");
        return Status::Done;
    }
    print(&text)
}

/// The roles for the animation, as the packages declare them from which the model takes components,
/// connectors and types of parameters.
fn view(
    request: &Request,
    assembly: &Assembly,
    values: &[(Column, Value, Span)],
    remarks: &mut Vec<String>,
) -> View {
    let classes = assembly.parts.iter().flat_map(|part| {
        std::iter::once(&part.class).chain(part.ports.iter().map(|port| &port.class))
    });
    let literals = values.iter().filter_map(|(_, value, _)| match value {
        Value::Text(literal) => Some(literal),
        Value::Number(_) => None,
    });
    let package = |name: &String| name.split_once('.').map(|(package, _)| package.to_owned());
    let mut packages: Vec<String> = classes.chain(literals).filter_map(package).collect();
    packages.sort();
    packages.dedup();
    let mut view = View::default();
    for annotated in Session::default().annotated(request, &packages) {
        let Some(entry) = annotated.entry("view") else { continue };
        if let Err(why) = view.add(&entry.text) {
            remarks.push(format!("The view of package {} is wrong: {why}.", annotated.class));
        }
    }
    view
}

fn counted(runs: usize) -> String {
    if runs == 1 { "1 run".to_owned() } else { format!("{runs} runs") }
}

/// The sources that were read, without those of settings.
fn texts(sources: &SourceMap) -> Vec<(String, String)> {
    let files = sources.files().filter(|f| f.path != Path::new(SETTING));
    files.map(|f| (f.path.display().to_string(), f.text.to_string())).collect()
}

/// The command line, quoted for a shell.
fn command() -> String {
    let quoted = |word: String| {
        let plain = |c: char| c.is_alphanumeric() || "-_./=,:+%@".contains(c);
        if !word.is_empty() && word.chars().all(plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    let words = std::env::args().skip(1).map(quoted);
    std::iter::once("mocc".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
