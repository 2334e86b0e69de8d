//! `mocc simulate`: compiles and runs a model, and writes its results.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::args::model::is_standard;
use super::args::runs::Simulate;
use super::progress::Progress;
use super::run_summary::summary_json;
use super::standard::real_path;
use super::start_text::Start;
use super::stream::{OtherUnit, Stream, drawable};
use super::wanted_unit::once_each;
use super::{
    Status, fmu_host, interrupt, other_means, print, print_file, running, say, standard, style,
};
use crate::base::diag::did_you_mean;
use crate::base::render::render;
use crate::base::source::SourceMap;
use crate::driver::compile::{Request, Session};
use crate::driver::quantity::{conversion, scale_of};
use crate::io::format::Format;
use crate::io::json::Json;
use crate::io::printout::Printout;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Trajectory, position};
use crate::measure::observe::{Observer, Plan};
use crate::report::plot;
use crate::report::plot::choice::default_figure;
use crate::report::plot::figure::panels_for;
use crate::runtime::machine::Machine;
use crate::simulate::columns::{column_storage, columns as columns_of};
use crate::simulate::initialization::initialise;
use crate::simulate::run::{Run, simulate_to};
use crate::simulate::settings::Settings;
use crate::structure::start_report::report;

/// Runs the command.
pub fn run(options: &Simulate) -> Status {
    let is_piped = match piped(options) {
        Ok(option) => option.is_some(),
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    let started_at = Instant::now();
    options.limits.max_seconds.into_iter().for_each(fmu_host::set_limit);
    let mut session = Session { is_last: true, ..Session::default() };
    let request = running::request(&options.model, &options.running);
    let max_size = options.limits.max_size;
    let request = Request { check_units: true, max_size, ..request };
    let program = match options.measures.as_slice() {
        [] => session.compile(&request).map(|program| (program, None)),
        texts => session.compile_measured(&request, texts).map(|(p, plan)| (p, Some(plan))),
    };
    say(&session);
    let (mut program, mut measures) = match program {
        Ok(program) => program,
        Err(error) => return error.into(),
    };
    if let Err(why) = running::restrict(&options.running, &mut program, measures.as_mut()) {
        eprintln!("error: {why}");
        return Status::Usage;
    }
    let compiled = started_at.elapsed();

    let mut settings =
        running::settings(&options.running, &options.model, &program.blocks.dae.experiment);
    settings.most_ticks = options.max_events;
    let files = Files::of(options, &program);
    let columns = &columns_of(&program)[..shown(&program, measures.as_ref())];
    let mut stream = match files.stream(options, &program, columns) {
        Ok(stream) => stream,
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    let mut start = None;
    if options.explain_start {
        match explain_start(options, &program, &settings, &session.sources, is_piped) {
            Ok(json) => start = Some(json),
            Err(status) => return status,
        }
    }
    interrupt::listen();
    if let Some(progress) = Progress::of(settings.start, settings.stop) {
        stream.show(progress);
    }
    let outcome = match &measures {
        None => {
            simulate_to(&program, &settings, &session.sources, &mut stream).map(|s| (s, Vec::new()))
        }
        Some(plan) => {
            plan.ask(&mut settings);
            let mut observer = Observer::new(plan, &program, &mut stream);
            let outcome = simulate_to(&program, &settings, &session.sources, &mut observer);
            outcome.map(|s| {
                let values = plan.evaluate(&program, &settings, &observer, &s);
                (s, values)
            })
        }
    };
    stream.hide();
    let (statistics, values) = match outcome {
        Ok(ended) => ended,
        Err(failure) => {
            let begin = |program: &Program| {
                let columns = &columns_of(program)[..shown(program, None)];
                files.stream(options, program, columns).ok()
            };
            let compiled = (&program, &session.sources);
            let other = measures
                .is_none()
                .then(|| other_means::run(options, compiled, &settings, &failure, &begin));
            let Some(other) = other.flatten() else {
                return running::failed(&failure, &session.sources);
            };
            stream = other.stream;
            if let Some(compiled) = other.compiled {
                (session, program) = compiled;
            }
            (other.statistics, Vec::new())
        }
    };
    for warning in &statistics.warnings {
        eprintln!("{}\n", render(warning, &session.sources, style()));
    }
    let started_at = Instant::now();
    let table = stream.finish(statistics.end).map_err(|e| e.to_string());
    let run = Run { trajectory: stream.trajectory, statistics };
    let picture = files.draw(options, &program, &run);
    let written: Vec<PathBuf> = match table.and_then(|t| Ok((t, picture?))) {
        Ok((table, picture)) => table.into_iter().chain(picture).collect(),
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    let printed = if options.json {
        let measures = measures.as_ref().map_or(&[][..], |plan| &plan.columns);
        print(&summary_json(&program, &run, compiled, measures, &values, &written, start).pretty())
    } else {
        let mut text = if options.events { events(&run.trajectory) } else { String::new() };
        if !options.quiet {
            let piped = files.piped(options);
            let kept = written.iter().filter(|path| Some(*path) != piped).cloned();
            let kept: Vec<PathBuf> = kept.collect();
            text.push_str(&summary(&program, &run, compiled, started_at.elapsed(), &kept));
        }
        if options.verbose {
            text.push_str(&stages(&session));
        }
        if let Some(plan) = &measures {
            text.push_str(&measured(&plan.columns, &values));
        }
        match files.piped(options).filter(|file| written.contains(file)) {
            Some(file) => {
                eprint!("{text}");
                print_file(file)
            }
            None if is_piped => {
                eprint!("{text}");
                Status::Done
            }
            None => print(&text),
        }
    };
    let status = match printed {
        Status::Done if run.statistics.interrupted => Status::Interrupted,
        status => status,
    };
    // The folders of FMUs are removed.
    session.foreign = None;
    program.foreign = None;
    program.blocks.dae.graph.release_externals();
    // The process ends: freeing gigabytes of a large model would only take time.
    std::mem::forget(program);
    status
}

/// The option whose result goes to the standard output, after a check of the format of results. The error is a
/// message.
fn piped(options: &Simulate) -> Result<Option<&'static str>, String> {
    match &options.output {
        Some(path) if is_standard(path) => {
            Format::of(Path::new(&format!("-.{}", piped_format(options)))).map(drop)
        }
        Some(path) => Format::of(path).map(drop),
        None => Ok(()),
    }
    .map_err(|e| e.to_string())?;
    if options.format.is_some() && !options.output.as_deref().is_some_and(is_standard) {
        return Err(
            "`--format` is for the standard output, `--output -`; a file has the format that \
                    its extension says"
                .to_owned(),
        );
    }
    let outputs = [("--output", &options.output), ("--plot", &options.plot)];
    standard::single_with_json(&outputs, options.json)
}

/// The format of results on the standard output.
fn piped_format(options: &Simulate) -> &str {
    options.format.as_deref().unwrap_or("csv")
}

/// Prints how the initial values come about, before the run, which may fail; for `--json` returns it.
fn explain_start(
    options: &Simulate,
    program: &Program,
    settings: &Settings,
    sources: &SourceMap,
    is_piped: bool,
) -> Result<Json, Status> {
    let mut machine = Machine::new(program);
    let machine = initialise(&mut machine, settings).is_ok().then_some(&machine);
    let start = Start { program, machine, sources, report: &report(&program.blocks) };
    if options.json {
        return Ok(start.json());
    }
    let text = start.text();
    if is_piped {
        eprint!("{text}");
        return Ok(Json::null());
    }
    match print(&text) {
        Status::Done => Ok(Json::null()),
        status => Err(status),
    }
}

/// Number of variables of the user that are recorded: the first.
fn shown(program: &Program, measures: Option<&Plan>) -> usize {
    measures.map_or(program.recorded.len(), |plan| plan.shown)
}

/// The measures, one a line.
fn measured(columns: &[Column], values: &[Option<f64>]) -> String {
    let mut out = String::new();
    for (column, value) in columns.iter().zip(values) {
        let (name, unit) = (&column.name, &column.unit);
        let unit = if unit == "1" { "" } else { unit };
        out.push_str(&match value {
            Some(value) => format!("  {name} = {value} {unit}").trim_end().to_owned(),
            None => format!("  {name}: did not happen"),
        });
        out.push('\n');
    }
    out
}

/// The files that a run makes.
struct Files {
    table: Option<PathBuf>,
    picture: Option<PathBuf>,
}

impl Files {
    /// Those that the user names, or else both, named after the model.
    fn of(options: &Simulate, program: &Program) -> Files {
        let neither = options.output.is_none() && options.plot.is_none();
        let stem = running::stem(&options.model, program);
        let default =
            |extension: &str| neither.then(|| PathBuf::from(format!("{stem}.{extension}")));
        let output = options.output.as_ref().map(|path| real_path(path, piped_format(options)));
        let picture = options.plot.as_ref().map(|path| real_path(path, "svg"));
        Files {
            table: output.or_else(|| default("csv")),
            picture: picture.or_else(|| default("svg")),
        }
    }

    /// The temporary file that goes to the standard output.
    fn piped(&self, options: &Simulate) -> Option<&PathBuf> {
        let pairs = [(&options.output, &self.table), (&options.plot, &self.picture)];
        let is_piped = |path: &Option<PathBuf>| path.as_deref().is_some_and(is_standard);
        pairs.into_iter().find_map(|(asked, real)| real.as_ref().filter(|_| is_piped(asked)))
    }

    /// The stream that takes the rows; reports variables that cannot be drawn before the run.
    fn stream(
        &self,
        options: &Simulate,
        program: &Program,
        columns: &[Column],
    ) -> Result<Stream, String> {
        let kept = match (&self.picture, &options.show) {
            (None, _) => Vec::new(),
            (Some(_), None) => drawable(columns),
            (Some(_), Some(list)) => {
                let names = running::names_in(list);
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                panels_for(&names, columns).map_err(|e| e.to_string())?;
                let mut kept: Vec<usize> =
                    names.iter().filter_map(|n| position(columns, n)).collect();
                kept.sort_unstable();
                kept.dedup();
                kept
            }
        };
        let output = match &self.table {
            Some(path) => Some((path.clone(), Format::of(path).map_err(|e| e.to_string())?)),
            None => None,
        };
        let folder = self.table.as_ref().or(self.picture.as_ref()).and_then(|path| path.parent());
        let printout = Printout::new(folder.unwrap_or(Path::new("")), &options.allow_write);
        let units = other_units(options, columns)?;
        Stream::new(columns, &column_storage(program)[..columns.len()], output, units, kept)
            .map(|stream| stream.with_printout(printout))
            .map(
                |stream| if options.show.is_none() { stream.for_default_picture() } else { stream },
            )
            .map_err(|e| e.to_string())
    }

    /// Draws the picture; the name of its file if there is anything to draw.
    fn draw(
        &self,
        options: &Simulate,
        program: &Program,
        run: &Run,
    ) -> Result<Option<PathBuf>, String> {
        let Some(path) = &self.picture else { return Ok(None) };
        let names = options.show.as_deref().map(running::names_in);
        let title = &program.blocks.dae.name;
        let figure = default_figure(title, names.as_deref(), &run.trajectory);
        let Some(spec) = figure.map_err(|e| e.to_string())? else { return Ok(None) };
        plot::plot(&run.trajectory, &spec, path).map_err(|e| e.to_string())?;
        Ok(Some(path.clone()))
    }
}

/// The columns that the user wants in other units. The error is a message.
fn other_units(options: &Simulate, columns: &[Column]) -> Result<Vec<OtherUnit>, String> {
    let mut out = Vec::new();
    for (name, unit) in once_each(&options.units)? {
        let column = position(columns, name).ok_or_else(|| {
            let near = did_you_mean(name, columns.iter().map(|c| c.name.as_str()));
            let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
            format!("--unit: the run records no variable `{name}`{near}")
        })?;
        scale_of(unit).ok_or_else(|| format!("--unit: `{unit}` is not a known unit"))?;
        let declared = &columns[column].unit;
        let Some(conversion) = conversion(declared, unit) else {
            let declared = if declared.is_empty() { "1" } else { declared };
            return Err(format!(
                "--unit: `{name}` is in `{declared}`, which `{unit}` does not measure"
            ));
        };
        out.push(OtherUnit { column, unit: unit.clone(), conversion });
    }
    Ok(out)
}

/// How long each stage of the compiler took.
fn stages(session: &Session) -> String {
    let line = |(stage, time): &(&str, Duration)| {
        format!("  {stage}: {:.1} ms\n", 1e3 * time.as_secs_f64())
    };
    session.times.iter().map(line).collect()
}

fn events(trajectory: &Trajectory) -> String {
    let mut out = String::new();
    for e in &trajectory.events {
        let place = if e.place.is_empty() { String::new() } else { format!("  ({})", e.place) };
        out.push_str(&format!("event at {:.9} s: {}{place}\n", e.time, e.what));
    }
    out
}

fn summary(
    program: &Program,
    run: &Run,
    compiled: Duration,
    writing: Duration,
    written: &[PathBuf],
) -> String {
    let dae = &program.blocks.dae;
    let s = &run.statistics;
    let i = &s.integration;
    let ms = |d: Duration| format!("{:.1} ms", 1e3 * d.as_secs_f64());
    let equations = dae.equations.len() + dae.discrete.len() + dae.eliminated.len();
    let algebraics = match program.algebraics.len() {
        0 => String::new(),
        n => format!(" and {n} algebraic unknowns"),
    };
    let mut out = format!(
        "{}: {} states{algebraics}, {equations} equations ({} trivial), to {} s\n",
        dae.name,
        program.state_count(),
        dae.eliminated.len(),
        s.end
    );
    // Without states nothing is integrated: the steps are those of the table.
    let steps = match program.order() {
        0 if program.foreign.is_none() => String::new(),
        _ => format!(" {} steps ({} rejected) by {},", i.steps, i.rejected, s.method),
    };
    out.push_str(&format!("  {} events,{steps} {} rows\n", run.trajectory.events.len(), s.rows));
    out.push_str(&format!(
        "  compiled in {}, simulated in {}, written in {}\n",
        ms(compiled),
        ms(s.elapsed),
        ms(writing)
    ));
    if s.selections > 0 {
        out.push_str(&format!("  state selection changed {} times\n", s.selections));
    }
    if s.interrupted {
        out.push_str(&format!("  interrupted at {} s\n", s.end));
    }
    if let Some(message) = &s.terminated {
        out.push_str(&format!("  terminated by the model: {message}\n"));
    }
    if !written.is_empty() {
        let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
        out.push_str(&format!("  wrote {}\n", names.join(", ")));
    }
    out
}
