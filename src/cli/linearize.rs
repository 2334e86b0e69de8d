//! `mocc steady` and `mocc linearize`: where a model rests, and its linear system there or at another instant.

use std::path::PathBuf;

use super::args::linear::{At, Linearize, Point, Steady};
use super::args::model::is_standard;
use super::bode::bode;
use super::linear_text::{steady_text, system_text};
use super::{Status, print, print_bytes, running, say, standard, write_result};
use crate::driver::compile::Session;
use crate::driver::ports::Ports;
use crate::driver::quantity;
use crate::io::json::Json;
use crate::ir::expr::VarId;
use crate::ir::program::Program;
use crate::report::chart::{Chart, chart, svg};
use crate::simulate::failure::Failure;
use crate::simulate::linearize::{Linearization, linearize};
use crate::simulate::operating_point::OperatingPoint;
use crate::simulate::ports::{discrete_value, hold, named};
use crate::simulate::settings::Settings;

/// Prints a steady state.
pub fn steady(options: &Steady) -> Status {
    let wanted = match options.solve {
        true => Wanted::Solved,
        false => Wanted::Settled,
    };
    with_system(&options.point, wanted, &[], &None, |program, system| {
        let text = steady_text(program, system);
        let all = Json::object([
            ("model", Json::text(program.blocks.dae.name.clone())),
            ("time", Json::number(system.time)),
            ("states", pairs(program, &system.states, &system.x)),
            ("inputs", pairs(program, &system.inputs, &system.u)),
            ("outputs", pairs(program, &system.outputs, &system.y)),
            ("eigenvalues", eigenvalues(system)),
            ("participation", participation(system)),
        ]);
        (text, all)
    })
}

/// Prints a linear system.
pub fn run(options: &Linearize) -> Status {
    let wanted = match options.at {
        At::Steady => Wanted::Settled,
        At::Time(time) => Wanted::Time(time),
    };
    with_system(&options.point, wanted, &options.outputs, &options.bode, |program, system| {
        let (n, m, outputs) = (system.states.len(), system.inputs.len(), system.outputs.len());
        let names = |all: &[VarId]| Json::list(all.iter().map(|v| Json::text(program.name(*v))));
        let rows = |all: &[f64], count: usize, width: usize| {
            Json::list((0..count).map(|k| Json::numbers(&all[k * width..(k + 1) * width])))
        };
        let all = Json::object([
            ("model", Json::text(program.blocks.dae.name.clone())),
            ("time", Json::number(system.time)),
            ("states", names(&system.states)),
            ("inputs", names(&system.inputs)),
            ("outputs", names(&system.outputs)),
            ("A", rows(&system.a, n, n)),
            ("B", rows(&system.b, n, m)),
            ("C", rows(&system.c, outputs, n)),
            ("D", rows(&system.d, outputs, m)),
            ("x", Json::numbers(&system.x)),
            ("dx", Json::numbers(&system.rates)),
            ("u", Json::numbers(&system.u)),
            ("y", Json::numbers(&system.y)),
            ("eigenvalues", eigenvalues(system)),
            ("participation", participation(system)),
        ]);
        (system_text(program, system), all)
    })
}

/// The point that is wanted.
#[derive(Clone, Copy)]
enum Wanted {
    Settled,
    Solved,
    Time(f64),
}

/// Compiles the model and passes its linear system at the point to `show`, which returns text and JSON.
fn with_system(
    options: &Point,
    wanted: Wanted,
    outputs: &[String],
    picture: &Option<PathBuf>,
    show: impl FnOnce(&Program, &Linearization) -> (String, Json),
) -> Status {
    let mut session = Session { is_last: true, ..Session::default() };
    let compiled = session.compile_with_ports(&options.model.request());
    say(&session);
    let (program, ports) = match compiled {
        Ok(compiled) => compiled,
        Err(error) => return error.into(),
    };
    let (inputs, outputs, given) = match ports_of(&program, ports, options, outputs) {
        Ok(found) => found,
        Err(why) => {
            eprintln!("error: {why}");
            return Status::Usage;
        }
    };
    let mut settings = Settings::of(&program.blocks.dae.experiment);
    settings.tolerance = options.tolerance.unwrap_or(settings.tolerance);
    hold(&program, &inputs, &given, &mut settings);
    let found = point(&program, settings, &session, wanted);
    let found = found.and_then(|mut point| linearize(&mut point, &inputs, &outputs));
    let system = match found {
        Ok(system) => system,
        Err(failure) => return running::failed(&failure, &session.sources),
    };
    let (text, all) = show(&program, &system);
    let drawn = picture.as_ref().map(|_| bode(&program, &system)).transpose();
    let written = drawn.and_then(|drawn| write(options, picture, drawn.as_ref(), &all));
    match written {
        Err(why) => {
            eprintln!("error: {why}");
            Status::Usage
        }
        Ok(None) => Status::Done,
        Ok(Some(written)) => print(&(text + &written)),
    }
}

/// Writes the JSON and the picture that are wanted: the lines that say so, `None` if one of them is on the standard output
/// in place of the text.
fn write(
    options: &Point,
    picture: &Option<PathBuf>,
    drawn: Option<&Chart>,
    all: &Json,
) -> Result<Option<String>, String> {
    let piped = standard::single(&[("--json", &options.json), ("--bode", picture)])?;
    let mut lines = String::new();
    if let Some(path) = &options.json {
        lines += &write_result(path, all.pretty().as_bytes())?;
    }
    if let (Some(path), Some(drawn)) = (picture, drawn) {
        if is_standard(path) {
            print_bytes(svg(drawn).map_err(|e| e.to_string())?.as_bytes())?;
        } else {
            chart(drawn, path).map_err(|e| e.to_string())?;
            lines += &format!("wrote {}\n", path.display());
        }
    }
    Ok(piped.is_none().then_some(lines))
}

type Chosen = (Vec<VarId>, Vec<VarId>, Vec<(VarId, f64)>);

/// The inputs, the outputs, and the values of inputs that are given.
fn ports_of(
    program: &Program,
    ports: Ports,
    options: &Point,
    outputs: &[String],
) -> Result<Chosen, String> {
    let unknown = |name: String| format!("the model has no variable `{name}`");
    let inputs = named(program, &ports.inputs).map_err(unknown)?;
    let outputs = if outputs.is_empty() { &ports.outputs } else { outputs };
    let outputs = named(program, outputs).map_err(unknown)?;
    let mut given = Vec::new();
    for text in &options.inputs {
        let wrong =
            || format!("`--input {text}`: write NAME=VALUE, a number in SI units or with its unit");
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        if ports.discrete_inputs.iter().any(|n| n == name.trim()) {
            given.push(
                discrete(program, name.trim(), value.trim())
                    .map_err(|why| why.unwrap_or_else(wrong))?,
            );
            continue;
        }
        let value = quantity::read(value).filter(|x| x.value.is_finite()).ok_or_else(wrong)?;
        let at = ports.inputs.iter().position(|n| n == name.trim()).ok_or_else(|| {
            let all = ports.all_inputs();
            let known = if all.is_empty() { "none".into() } else { all.join(", ") };
            format!("the model has no input `{}`; its inputs are: {known}", name.trim())
        })?;
        let declared = &program.blocks.dae.variables[inputs[at]].unit;
        let own = quantity::scale_of(declared).filter(|_| !value.unit.is_empty());
        if own.is_some_and(|(_, dimension)| dimension != value.dimension) {
            let (name, unit) = (name.trim(), value.unit);
            return Err(format!("`--input {text}`: `{name}` is in `{declared}`, not in `{unit}`"));
        }
        let shown = own.map_or(value.value, |(unit, _)| (value.value - unit.offset) / unit.factor);
        given.push((inputs[at], shown));
    }
    Ok((inputs, outputs, given))
}

/// A discrete input and the value that is given. Errors: why, or that it is no value at all.
fn discrete(program: &Program, name: &str, text: &str) -> Result<(VarId, f64), Option<String>> {
    let found = named(program, &[name.to_owned()]).map_err(|_| None)?;
    let v = *found.first().ok_or(None)?;
    let value = match text {
        "true" => 1.0,
        "false" => 0.0,
        number => number.parse().map_err(|_| None)?,
    };
    Ok((v, discrete_value(program, v, value).map_err(Some)?))
}

fn point<'p>(
    program: &'p Program,
    mut settings: Settings,
    session: &Session,
    wanted: Wanted,
) -> Result<OperatingPoint<'p>, Failure> {
    match wanted {
        Wanted::Settled => OperatingPoint::settled(program, &settings, &session.sources),
        Wanted::Solved => OperatingPoint::solved(program, &settings),
        Wanted::Time(time) => {
            settings.stop = time;
            settings.interval = (time - settings.start).max(f64::MIN_POSITIVE);
            OperatingPoint::of_run(program, &settings, &session.sources)
        }
    }
}

fn pairs(program: &Program, names: &[VarId], values: &[f64]) -> Json {
    let one = |(v, x): (&VarId, &f64)| (program.name(*v).to_owned(), Json::number(*x));
    Json::object(names.iter().zip(values).map(one))
}

/// The part of each state in each eigenvalue, in their orders.
fn participation(system: &Linearization) -> Json {
    let all = system.eigenvalues().and_then(|values| system.participation(&values));
    all.map_or(Json::null(), |all| Json::list(all.iter().map(|parts| Json::numbers(parts))))
}

fn eigenvalues(system: &Linearization) -> Json {
    let all = system.eigenvalues();
    all.map_or(Json::null(), |all| Json::list(all.iter().map(|x| Json::numbers(&[x.re, x.im]))))
}
