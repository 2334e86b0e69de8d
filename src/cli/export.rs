//! `mocc export fmu`: compiles a model and writes it as an FMU.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::args::export::{Export, ExportFmu, Exported, FmuType};
use super::args::model::is_standard;
use super::{Status, explain, print, running, say, style, write_result};
use crate::base::diag::Diagnostic;
use crate::base::render::render;
use crate::base::source::{SourceMap, Span};
use crate::codegen::recording;
use crate::driver::compile::Session;
use crate::driver::files::read_library;
use crate::driver::ports::Exportable;
use crate::fmu::cause::FmuCause;
use crate::fmu::description::Version;
use crate::fmu::export::{Order, export};
use crate::io::csv::text_of;
use crate::ir::assembly::Assembly;
use crate::ir::flat::Causality;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Event, Trajectory};
use crate::report::raster::png;
use crate::report::schematic::{draw, picture};
use crate::simulate::record::Sink;
use crate::simulate::run::simulate_to;
use crate::simulate::settings::Settings;

/// The default run in an archive.
const REFERENCE: &str = "extra/mocc/reference.csv";
/// Longest time for that run.
const LONGEST_REFERENCE: Duration = Duration::from_millis(300);
/// The name of the shared library that runs exported models.
const RUNTIME: &str = "libmocc_fmu.so";

/// Runs the command.
pub fn run(options: &Export) -> Status {
    match &options.what {
        Exported::Fmu(options) => fmu(options),
    }
}

fn fmu(options: &ExportFmu) -> Status {
    let started_at = Instant::now();
    let (runtime, from) = match runtime(options) {
        Ok(found) => found,
        Err(diagnostic) => return refused(&diagnostic),
    };
    let mut session = Session { is_last: true, ..Session::default() };
    let compiled = session.compile_for_export(&options.model.request());
    say(&session);
    let Exportable { program, causalities, connectors, assembly } = match compiled {
        Ok(compiled) => compiled,
        Err(error) => return error.into(),
    };
    let mut extra = if options.with_source { sources(&session.sources) } else { Vec::new() };
    extra.extend(reference(&program, &causalities, &session.sources));
    let order = Order {
        version: if options.fmi == "2" { Version::Two } else { Version::Three },
        exchange: options.kind != FmuType::Cs,
        stepping: options.kind != FmuType::Me,
        runtime: &runtime,
        connectors: &connectors,
        icon: icon(&program.blocks.dae.name, &assembly),
        extra,
        with_source: options.with_source,
    };
    let (archive, warning) = match export(&program, &causalities, &order) {
        Ok(made) => made,
        Err(diagnostic) => return refused(&diagnostic),
    };
    let only_stepping = warning.is_some();
    if let Some(warning) = warning {
        eprintln!("{}\n", render(&warning, &session.sources, style()));
    }
    let path = options.output.clone().unwrap_or_else(|| {
        PathBuf::from(format!("{}.fmu", running::stem(&options.model, &program)))
    });
    let written = match write_result(&path, &archive) {
        Ok(_) if is_standard(&path) => format!("  {:.2} MB", archive.len() as f64 / 1e6),
        Ok(_) => format!("  wrote {} ({:.2} MB)", path.display(), archive.len() as f64 / 1e6),
        Err(why) => return refused(&file_problem(&path, why)),
    };
    let offered = match (order.exchange && !only_stepping, order.stepping) {
        (true, true) => "Model Exchange and Co-Simulation",
        (true, false) => "Model Exchange",
        _ => "Co-Simulation",
    };
    let text = format!(
        "{}: FMI {}.0, {offered}, {} states\n{written} in {:.0} ms, with {}\n",
        program.blocks.dae.name,
        options.fmi,
        program.blocks.states.len(),
        1e3 * started_at.elapsed().as_secs_f64(),
        from.display(),
    );
    let status = match is_standard(&path) {
        true if options.quiet => Status::Done,
        true => {
            eprint!("{text}");
            Status::Done
        }
        false => print(&text),
    };
    std::mem::forget(program);
    status
}

/// The picture of the model, as PNG and as SVG: its diagram, or its name if it has no components.
fn icon(name: &str, assembly: &Assembly) -> Option<(Vec<u8>, String)> {
    let drawn = picture(assembly, 0)
        .map(|picture| draw::svg(&picture, assembly, &|_| Vec::new(), &|_| String::new()));
    let svg = drawn.unwrap_or_else(|| draw::named(name.rsplit('.').next().unwrap_or(name)));
    png(&svg, 1).ok().map(|png| (png, svg))
}

/// Rows of the default run, while it takes no longer than is worth it.
struct Reference {
    rows: Trajectory,
    begun: Instant,
    is_late: bool,
}

impl Sink for Reference {
    fn begin(&mut self, columns: Vec<Column>) {
        self.rows.begin(columns);
    }
    fn row(&mut self, time: f64, values: &[f64]) {
        self.rows.row(time, values);
    }
    fn event(&mut self, event: Event) {
        self.rows.event(event);
    }
    fn goes_on(&mut self, _: f64) -> bool {
        self.is_late |= self.begun.elapsed() > LONGEST_REFERENCE;
        !self.is_late
    }
}

/// The default run of the model: its inputs, outputs and states, for the comparison of another tool's run with it. Not
/// for a model that cannot run by itself, or that takes long.
fn reference(
    program: &Program,
    causalities: &[(String, Causality)],
    sources: &SourceMap,
) -> Option<(String, Vec<u8>)> {
    let states: Vec<&str> =
        program.blocks.states.iter().map(|s| program.name(s.variable)).collect();
    let mut program = program.clone();
    recording::only(&mut program, |name| {
        states.contains(&name) || causalities.iter().any(|(port, _)| port == name)
    });
    let settings = Settings::of(&program.blocks.dae.experiment);
    let rows = Trajectory::default();
    let mut sink = Reference { rows, begun: Instant::now(), is_late: false };
    simulate_to(&program, &settings, sources, &mut sink).ok()?;
    let text = text_of(&sink.rows).ok().filter(|_| !sink.is_late)?;
    Some((REFERENCE.to_owned(), text.into_bytes()))
}

fn refused(diagnostic: &Diagnostic) -> Status {
    eprintln!("{}", render(diagnostic, &SourceMap::default(), style()));
    explain::remember([diagnostic]);
    Status::Usage
}

fn file_problem(path: &std::path::Path, why: String) -> Box<Diagnostic> {
    let cause = FmuCause::FileOfFmu { path: path.display().to_string(), why };
    Box::new(Diagnostic::new(cause, Span::NONE))
}

/// The shared library and where it was found: where the user says, or next to this program.
fn runtime(options: &ExportFmu) -> Result<(Vec<u8>, PathBuf), Box<Diagnostic>> {
    if let Some(path) = &options.runtime {
        let bytes = read_library(path).map_err(|why| file_problem(path, why.to_string()))?;
        return match is_runtime(&bytes, &options.fmi) {
            true => Ok((bytes, path.clone())),
            false => {
                let (path, fmi) = (path.display().to_string(), options.fmi.clone());
                Err(Box::new(Diagnostic::new(FmuCause::NotARuntime { path, fmi }, Span::NONE)))
            }
        };
    }
    let mut places: Vec<PathBuf> = Vec::new();
    places.extend(std::env::var_os("MOCC_FMU_RUNTIME").map(PathBuf::from));
    if let Some(folder) =
        std::env::current_exe().ok().and_then(|exe| exe.parent().map(PathBuf::from))
    {
        places.push(folder.join(RUNTIME));
        places.push(folder.join("../lib/mocc").join(RUNTIME));
    }
    for place in &places {
        if let Ok(bytes) = read_library(place) {
            return Ok((bytes, place.clone()));
        }
    }
    let looked: Vec<String> = places.iter().map(|p| format!("`{}`", p.display())).collect();
    let cause = FmuCause::NoRuntime { looked: looked.join(", ") };
    Err(Box::new(Diagnostic::new(cause, Span::NONE)))
}

/// Whether a file is a shared library, of any system, that exports the functions of a version of FMI. Exported names end
/// in a zero byte in all formats.
fn is_runtime(bytes: &[u8], fmi: &str) -> bool {
    const BEGINNINGS: [&[u8]; 4] = [b"\x7fELF", b"MZ", b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe"];
    let names: &[&str] = match fmi {
        "2" => &["fmi2Instantiate\0", "fmi2DoStep\0", "fmi2GetDerivatives\0"],
        _ => &[
            "fmi3InstantiateCoSimulation\0",
            "fmi3DoStep\0",
            "fmi3GetContinuousStateDerivatives\0",
        ],
    };
    let holds = |name: &&str| bytes.windows(name.len()).any(|part| part == name.as_bytes());
    BEGINNINGS.iter().any(|magic| bytes.starts_with(magic)) && names.iter().all(holds)
}

/// The user's own sources: those of the shipped library are in every mocc.
fn sources(sources: &SourceMap) -> Vec<(String, Vec<u8>)> {
    let own = sources.files().filter(|file| {
        let path = file.path.to_string_lossy();
        !path.starts_with("lib:") && !path.starts_with("--")
    });
    let name = |file: &crate::base::source::SourceFile| {
        let path = file.path.to_string_lossy();
        let parts: Vec<&str> =
            path.split(['/', '\\']).filter(|part| !matches!(*part, "" | "." | "..")).collect();
        format!("extra/mocc/{}", parts.join("/"))
    };
    own.map(|file| (name(file), file.text.as_bytes().to_vec())).collect()
}
