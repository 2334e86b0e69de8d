//! `mocc report`: writes a page about a model and its runs, and the diagram of its components.

use std::path::{Path, PathBuf};

use super::args::model::is_standard;
use super::args::runs::Report;
use super::progress::Progress;
use super::{Status, interrupt, print, running, say, write_result};
use crate::base::index::{FastMap, FastSet};
use crate::base::source::{SourceMap, Span};
use crate::calibrate::unit::Unit;
use crate::codegen::recording;
use crate::driver::compile::{Request, Session};
use crate::io::atomic_file::write_file;
use crate::io::csv::read_text;
use crate::ir::assembly::Assembly;
use crate::ir::expr::Type;
use crate::ir::flat::Variability;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Constant, Event, Trajectory, position};
use crate::report::page::document::{Document, Measured, RunPart, html};
use crate::report::page::parameters::{Parameter, Value};
use crate::report::page::view::View;
use crate::report::plot::choice::interesting;
use crate::report::plot::figure::panels_for;
use crate::report::raster::png;
use crate::report::schematic::{draw, picture};
use crate::simulate::columns::column_storage;
use crate::simulate::record::Sink;
use crate::simulate::run::{Statistics, simulate_to};

/// Pixels of a PNG per px of the diagram.
const PNG_SCALE: u32 = 2;
/// Variables in a page; those of the model itself come first.
const MOST_VARIABLES: usize = 5000;

/// Parameters in a page, in order of declaration.
const MOST_PARAMETERS: usize = 10_000;

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

/// A requested run.
struct RunRequest {
    label: String,
    settings: Vec<String>,
}

/// A finished run.
struct FinishedRun {
    part: RunPart,
    values: Vec<(Column, Value, Span)>,
    interrupted: bool,
}

fn make(options: &Report) -> Result<Status, Status> {
    let requested = requested(options).map_err(wrong)?;
    let signals = signals(&options.signals).map_err(wrong)?;
    let whole = options.diagram.is_none() || options.output.is_some();
    let mut session = Session::default();
    let base = running::request(&options.model, &options.running);
    let request = Request { settings: requested[0].settings.clone(), ..base.clone() };
    let flattened = session.flatten_with_assembly(&request);
    let (flat, assembly) = match flattened {
        Ok(found) => found,
        Err(why) => {
            say(&session);
            return Err(why.into());
        }
    };
    let mut written: Vec<PathBuf> = Vec::new();
    if !whole {
        say(&session);
        draw_diagram(options, &assembly, &session.sources, &mut written)?;
        return Ok(if options.quiet { Status::Done } else { print(&list(&written)) });
    }
    let parameters: FastSet<String> = flat
        .variables
        .iter()
        .filter(|v| v.variability == Variability::Parameter)
        .map(|v| v.name.clone())
        .collect();
    let description = flat.description.as_deref().unwrap_or_default().to_owned();
    let first = session.compile_flat(flat, base.form);
    say(&session);
    let first = first.map_err(Status::from)?;
    let output = match &options.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{}_report.html", running::stem(&options.model, &first))),
    };
    interrupt::listen();
    let mut remarks = Vec::new();
    let model = first.blocks.dae.name.clone();
    let mut finished = vec![go(options, &requested[0], first, &session.sources, &mut remarks)?];
    for run_request in &requested[1..] {
        let mut own = Session::default();
        let request = Request { settings: run_request.settings.clone(), ..base.clone() };
        let program = own.compile(&request);
        say(&own);
        let program = program.map_err(Status::from)?;
        let run = go(options, run_request, program, &own.sources, &mut Vec::new())?;
        if run.part.trajectory.columns != finished[0].part.trajectory.columns {
            let label = &run_request.label;
            return Err(wrong(format!(
                "the variables of run `{label}` differ from those of the first run"
            )));
        }
        finished.push(run);
    }
    let interrupted = finished.iter().any(|w| w.interrupted);
    if interrupted {
        remarks.push("A run was interrupted: these are the results until then.".to_owned());
    }
    let columns = &finished[0].part.trajectory.columns;
    let show = match &options.show {
        Some(list) => {
            let names = running::names_in(list);
            let all: Vec<&str> = names.iter().map(String::as_str).collect();
            panels_for(&all, columns).map_err(wrong)?;
            names
        }
        None => interesting(&finished[0].part.trajectory),
    };
    let measured = measured(&options.data, &signals, columns).map_err(wrong)?;
    let view = view(&base, &assembly, &finished[0].values, &mut remarks);
    let place = |span: Span| session.sources.place(span).unwrap_or_default();
    let doc = Document {
        view,
        model,
        description,
        version: env!("CARGO_PKG_VERSION"),
        command: command(),
        assembly: &assembly,
        place: &place,
        texts: texts(&session.sources),
        parameters: parameters_of(&finished, &requested, &parameters, &place),
        runs: finished.into_iter().map(|w| w.part).collect(),
        measured,
        show,
        remarks,
    };
    draw_diagram(options, &assembly, &session.sources, &mut written)?;
    write_result(&output, html(&doc).as_bytes()).map_err(wrong)?;
    let is_piped = is_standard(&output);
    written.push(output);
    let summary = format!("{}: {}\n", doc.model, counted(doc.runs.len()));
    let status = match options.quiet || is_piped {
        true => Status::Done,
        false => print(&format!("{summary}{}", list(&written))),
    };
    Ok(if interrupted { Status::Interrupted } else { status })
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

fn list(written: &[PathBuf]) -> String {
    let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
    format!("  wrote {}\n", names.join(", "))
}

/// The runs that the options run_request for: those of `--run`, or the one with the settings of `--set`.
fn requested(options: &Report) -> Result<Vec<RunRequest>, String> {
    let base = &options.model.settings;
    if options.runs.is_empty() {
        return Ok(vec![RunRequest { label: "run".to_owned(), settings: base.clone() }]);
    }
    let mut out: Vec<RunRequest> = Vec::new();
    for text in &options.runs {
        let (label, list) = match text.split_once(':') {
            Some((label, list)) if !label.contains('=') => (label.trim(), list),
            _ => (text.trim(), text.as_str()),
        };
        let own = running::names_in(list);
        if let Some(odd) = own.iter().find(|s| !s.contains('=')) {
            return Err(format!(
                "`{odd}` in the run `{text}` is not an override; write NAME=VALUE, ..."
            ));
        }
        let label = if label.is_empty() { text.trim() } else { label };
        if out.iter().any(|a| a.label == label) {
            return Err(format!("two runs have the label `{label}`"));
        }
        // Settings of a run override those of all runs.
        let name = |s: &str| s.split('=').next().unwrap_or_default().replace(' ', "");
        let others = base.iter().filter(|b| !own.iter().any(|o| name(o) == name(b)));
        let settings = others.chain(&own).cloned().collect();
        out.push(RunRequest { label: label.to_owned(), settings });
    }
    Ok(out)
}

/// Keeps a run.
#[derive(Default)]
struct Kept {
    trajectory: Trajectory,
    constants: Vec<Constant>,
    progress: Option<Progress>,
}

impl Sink for Kept {
    fn begin(&mut self, columns: Vec<Column>) {
        self.trajectory.begin(columns);
    }
    fn expect(&mut self, rows: usize) {
        self.trajectory.reserve(rows);
    }
    fn constants(&mut self, constants: Vec<Constant>) {
        self.constants = constants;
    }
    fn row(&mut self, time: f64, values: &[f64]) {
        self.trajectory.push(time, values);
    }
    fn event(&mut self, event: Event) {
        self.trajectory.events.push(event);
    }
    fn goes_on(&mut self, time: f64) -> bool {
        if let Some(progress) = &self.progress {
            progress.reached(time);
        }
        !interrupt::is_requested()
    }
}

fn go(
    options: &Report,
    requested: &RunRequest,
    mut program: Program,
    sources: &SourceMap,
    remarks: &mut Vec<String>,
) -> Result<FinishedRun, Status> {
    // The restriction applies to recorded variables, not to parameters.
    let constants = program.constants.clone();
    running::restrict(&options.running, &mut program, None).map_err(wrong)?;
    let all = program.recorded.len();
    if all > MOST_VARIABLES {
        let names = program.recorded.iter().map(|v| program.name(*v));
        let (own, of_parts): (Vec<&str>, Vec<&str>) = names.partition(|n| !n.contains('.'));
        let kept: FastSet<String> =
            own.into_iter().chain(of_parts).take(MOST_VARIABLES).map(str::to_owned).collect();
        recording::only(&mut program, |name| kept.contains(name));
        remarks.push(format!(
            "This page holds {MOST_VARIABLES} of {all} variables; select them with `--variables REGEX`."
        ));
    }
    program.constants = constants;
    let settings =
        running::settings(&options.running, &options.model, &program.blocks.dae.experiment);
    let mut kept =
        Kept { progress: Progress::of(settings.start, settings.stop), ..Kept::default() };
    let outcome = simulate_to(&program, &settings, sources, &mut kept);
    kept.progress = None;
    let statistics = outcome.map_err(|failure| {
        if !options.runs.is_empty() {
            eprintln!("error: run `{}` failed", requested.label);
        }
        running::failed(&failure, sources)
    })?;
    let graph = &program.blocks.dae.graph;
    let value = |c: Constant, ty: Type| match graph.literal(ty, c.value) {
        Some(literal) => Value::Text(literal),
        None => Value::Number(c.value),
    };
    let values = program
        .constants
        .iter()
        .zip(kept.constants)
        .map(|(v, c)| {
            let variable = &program.blocks.dae.variables[*v];
            (c.column.clone(), value(c, variable.ty), variable.span)
        })
        .collect();
    let facts = facts(&program, &statistics, kept.trajectory.events.len());
    let column_storage = column_storage(&program);
    let part = RunPart {
        label: requested.label.clone(),
        trajectory: kept.trajectory,
        column_storage,
        facts,
    };
    Ok(FinishedRun { part, values, interrupted: statistics.interrupted })
}

/// Statistics of a run, without times, which differ from run to run.
fn facts(program: &Program, statistics: &Statistics, events: usize) -> Vec<(String, String)> {
    let dae = &program.blocks.dae;
    let i = &statistics.integration;
    let equations = dae.equations.len() + dae.discrete.len() + dae.eliminated.len();
    let mut out = vec![
        ("method".to_owned(), statistics.method.to_string()),
        ("states".to_owned(), program.state_count().to_string()),
        ("equations".to_owned(), format!("{equations} ({} trivial)", dae.eliminated.len())),
        ("end, s".to_owned(), format!("{}", statistics.end)),
    ];
    let counts = [
        ("steps", i.steps),
        ("rejected by the error test", i.rejected),
        ("failures to converge", i.convergence_failures),
        ("failures to evaluate", i.evaluation_failures),
        ("right-hand sides", i.rhs),
        ("Jacobians", i.jacobians),
        ("decompositions", i.decompositions),
        ("Newton iterations", i.newton_iterations),
        ("events", events as u64),
        ("changes of state selection", statistics.selections),
        ("rows", statistics.rows),
    ];
    out.extend(counts.map(|(name, n)| (name.to_owned(), n.to_string())));
    if let Some(message) = &statistics.terminated {
        out.push(("terminated by the model".to_owned(), message.clone()));
    }
    out
}

fn parameters_of(
    finished: &[FinishedRun],
    requested: &[RunRequest],
    names: &FastSet<String>,
    place: &dyn Fn(Span) -> String,
) -> Vec<Parameter> {
    let is_set = |run_request: &RunRequest, name: &str| {
        run_request.settings.iter().any(|s| {
            let target = s.split('=').next().unwrap_or_default().replace(' ', "");
            let rest = name.strip_prefix(target.as_str());
            rest.is_some_and(|r| r.is_empty() || r.starts_with(['[', '.']))
        })
    };
    let by_name: Vec<FastMap<&str, &Value>> = finished
        .iter()
        .map(|w| w.values.iter().map(|(c, v, _)| (c.name.as_str(), v)).collect())
        .collect();
    let mut out = Vec::new();
    let own = finished[0].values.iter().filter(|(c, ..)| names.contains(&c.name));
    for (column, _, span) in own.take(MOST_PARAMETERS) {
        let of = |values: &FastMap<&str, &Value>| match values.get(column.name.as_str()) {
            Some(value) => (*value).clone(),
            None => Value::Text(String::new()),
        };
        out.push(Parameter {
            name: column.name.clone(),
            values: by_name.iter().map(of).collect(),
            unit: column.unit.clone(),
            display_unit: column.display_unit.clone(),
            description: column.description.clone(),
            place: place(*span),
            set: requested.iter().map(|a| is_set(a, &column.name)).collect(),
        });
    }
    out
}

/// Which variable a column of a recording is, and its unit.
struct Signal {
    column: String,
    variable: String,
    unit: Unit,
}

fn signals(list: &[String]) -> Result<Vec<Signal>, String> {
    let one = |text: &String| {
        let (column, rest) = text
            .split_once('=')
            .ok_or_else(|| format!("the signal `{text}` has no `=`; write COLUMN=VARIABLE:UNIT"))?;
        let (variable, unit) = rest.rsplit_once(':').unwrap_or((rest, "1"));
        let found = Unit::of(unit).ok_or_else(|| format!("unknown unit `{unit}`"))?;
        let (column, variable) = (column.trim().to_owned(), variable.trim().to_owned());
        Ok(Signal { column, variable, unit: found })
    };
    list.iter().map(one).collect()
}

/// Reads the recordings; values that are not numbers are skipped.
fn measured(
    paths: &[PathBuf],
    signals: &[Signal],
    columns: &[Column],
) -> Result<Vec<Measured>, String> {
    let mut out = Vec::new();
    for path in paths {
        let table = read_text(path).map_err(|e| e.to_string())?;
        let time = signals.iter().find(|s| s.variable == "time");
        let (at, time_unit) = match time {
            Some(s) => (table.column(&s.column), s.unit),
            None => (Some(0), Unit::SECOND),
        };
        let at = at.ok_or_else(|| format!("{}: no column for the time", path.display()))?;
        let mut wanted: Vec<(usize, String, Unit)> = Vec::new();
        for s in signals.iter().filter(|s| s.variable != "time") {
            let k = table.column(&s.column).ok_or_else(|| {
                let names = table.names.join(", ");
                format!("{} has no column `{}`, only {names}", path.display(), s.column)
            })?;
            let v = position(columns, &s.variable)
                .ok_or_else(|| format!("the model has no variable `{}`", s.variable))?;
            wanted.push((k, columns[v].name.clone(), s.unit));
        }
        if signals.iter().all(|s| s.variable == "time") {
            for (k, name) in table.names.iter().enumerate().filter(|(k, _)| *k != at) {
                if let Some(v) = position(columns, name) {
                    wanted.push((k, columns[v].name.clone(), Unit::SECOND));
                }
            }
        }
        if wanted.is_empty() {
            let path = path.display();
            return Err(format!(
                "{path}: no column is named like a variable; map them with `--signal COLUMN=VARIABLE:UNIT`"
            ));
        }
        for (k, variable, unit) in wanted {
            let pair = |row: &Vec<String>| {
                let number = |k: usize| row[k].parse::<f64>().ok().filter(|x| x.is_finite());
                Some((time_unit.to_si(number(at)?), unit.to_si(number(k)?)))
            };
            let mut pairs: Vec<(f64, f64)> =
                table.rows.iter().filter_map(|(_, row)| pair(row)).collect();
            pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
            let label = path.file_stem().map(|s| s.to_string_lossy().into_owned());
            let (time, values) = pairs.into_iter().unzip();
            out.push(Measured { label: label.unwrap_or_default(), variable, time, values });
        }
    }
    Ok(out)
}

/// The sources that were read, without those of settings.
fn texts(sources: &SourceMap) -> Vec<(String, String)> {
    let files = sources.files().filter(|f| f.path != Path::new("--set"));
    files.map(|f| (f.path.display().to_string(), f.text.to_string())).collect()
}

fn draw_diagram(
    options: &Report,
    assembly: &Assembly,
    sources: &SourceMap,
    written: &mut Vec<PathBuf>,
) -> Result<(), Status> {
    let Some(path) = &options.diagram else { return Ok(()) };
    let picture = picture(assembly, 0)
        .ok_or_else(|| wrong("the model has no components to draw, or too many"))?;
    let place = |link: usize| sources.place(assembly.links[link].place).unwrap_or_default();
    let svg = draw::svg(&picture, assembly, &|_| Vec::new(), &place);
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let bytes = match extension.as_deref() {
        Some("svg") => svg.into_bytes(),
        Some("png") => png(&svg, PNG_SCALE).map_err(wrong)?,
        _ => {
            return Err(wrong(format!(
                "{}: the name of a picture must end in .svg or .png",
                path.display()
            )));
        }
    };
    write_file(path, &bytes).map_err(wrong)?;
    written.push(path.clone());
    Ok(())
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
