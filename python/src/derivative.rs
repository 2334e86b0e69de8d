//! Derivatives of a model: linear systems at operating points, and runs with their derivatives by parameters.

use std::sync::{Arc, Mutex, PoisonError};

use mocc::calibrate::cancellation::Cancellation;
use mocc::calibrate::rows::Rows;
use mocc::codegen::recording;
use mocc::driver::compile::Session;
use mocc::driver::ports::Ports;
use mocc::ir::expr::VarId;
use mocc::ir::program::Program;
use mocc::runtime::jit::tiering::Execution;
use mocc::simulate::failure::Failure;
use mocc::simulate::linearize::{Linearization, linearize};
use mocc::simulate::operating_point::OperatingPoint;
use mocc::simulate::ports::{discrete_value, hold, named};
use mocc::simulate::run::simulate_with_sensitivities;
use mocc::simulate::sensitivity::Input;
use mocc::simulate::settable::settable;
use mocc::simulate::settings::Settings;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::background;
use crate::error::{Kind, Trouble};
use crate::model::{Compiled, Drive, Model, Setting, drive, set_all};
use crate::run::numbers;
use crate::values::Values;

/// Programs to keep of each kind.
const MAX_KEPT: usize = 8;

/// Programs of a model besides those that simulate it.
#[derive(Default)]
pub struct Others {
    with_ports: Kept<(Compiled, Ports)>,
    recording: Kept<Narrow>,
}

type Kept<T> = Mutex<Vec<(Vec<String>, Arc<T>)>>;

/// A program that records some variables only.
struct Narrow {
    of: Arc<Compiled>,
    program: Program,
    execution: Execution,
}

/// What a key stands for, made once.
fn kept<T, E>(
    all: &Kept<T>,
    key: Vec<String>,
    make: impl FnOnce() -> Result<T, E>,
) -> Result<Arc<T>, E> {
    let known = || all.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, found)) = known().iter().find(|(k, _)| *k == key) {
        return Ok(Arc::clone(found));
    }
    let made = Arc::new(make()?);
    let mut all = known();
    if all.len() >= MAX_KEPT {
        all.remove(0);
    }
    all.push((key, Arc::clone(&made)));
    Ok(made)
}

/// The linear system at a point. `at` is `settled`, `solved`, `time` (with the instant) or `states` (with values of some
/// states).
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "all are named in the Python package")]
pub fn linear_system<'py>(
    py: Python<'py>,
    model: &Model,
    at: &str,
    time: f64,
    states: Vec<(String, f64)>,
    settings: Vec<(String, Setting)>,
    inputs: Vec<(String, f64)>,
    outputs: Option<Vec<String>>,
    tolerance: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let (of_run, of_program) = model.split(settings);
    let compiled = kept(&model.others.with_ports, of_program.clone(), || {
        let request = model.request(of_program);
        let made = background::run(py, move |_| {
            let mut session = Session::default();
            match session.compile_with_ports(&request) {
                Ok((program, ports)) => Ok((Compiled::new(program, session.sources), ports)),
                Err(error) => Err(Trouble::of_session(error, &session)),
            }
        })?;
        made.map_err(|trouble: Trouble| trouble.raise(py))
    })?;
    let at = at.to_owned();
    let found = background::run(py, move |_| {
        let (Compiled { program, sources, .. }, ports) = &*compiled;
        let of = |failure: Failure| Trouble::of_failure(&failure, sources);
        let mut settings = Settings::of(&program.blocks.dae.experiment);
        settings.tolerance = tolerance.unwrap_or(settings.tolerance);
        set_all(program, &of_run, &mut settings)?;
        let known = variables(program, &ports.inputs)?;
        let outputs = variables(program, outputs.as_ref().unwrap_or(&ports.outputs))?;
        let mut given = Vec::new();
        for (name, value) in &inputs {
            if ports.discrete_inputs.contains(name) {
                let found = variables(program, std::slice::from_ref(name))?;
                for v in found {
                    given.push((v, discrete_value(program, v, *value).map_err(wrong)?));
                }
                continue;
            }
            let k = ports.inputs.iter().position(|n| n == name).ok_or_else(|| {
                let all = ports.all_inputs().join(", ");
                let all = if all.is_empty() { "none" } else { &all };
                wrong(format!("the model has no input `{name}`; its inputs are: {all}"))
            })?;
            given.push((known[k], *value));
        }
        hold(program, &known, &given, &mut settings);
        let point = match at.as_str() {
            "settled" => OperatingPoint::settled(program, &settings, sources),
            "solved" => OperatingPoint::solved(program, &settings),
            "states" => OperatingPoint::at(program, &settings, &positions(program, &states)?),
            _ => {
                settings.stop = time;
                settings.interval = (time - settings.start).max(f64::MIN_POSITIVE);
                OperatingPoint::of_run(program, &settings, sources)
            }
        };
        let mut point = point.map_err(of)?;
        let system = linearize(&mut point, &known, &outputs).map_err(of)?;
        let machine = &point.system.machine;
        let recorded = program.recorded.iter();
        let all = recorded.map(|v| (program.name(*v).to_owned(), machine.value(*v))).collect();
        Ok(facts(program, system, all))
    })?;
    let Facts { names, units, numbers, values, eigenvalues, participation, time } =
        found.map_err(|trouble: Trouble| trouble.raise(py))?;
    let out = PyDict::new(py);
    for (key, all) in ["states", "inputs", "outputs"].into_iter().zip(names) {
        out.set_item(key, all)?;
    }
    for (key, all) in ["A", "B", "C", "D", "x", "dx", "u", "y"].into_iter().zip(numbers) {
        out.set_item(key, all)?;
    }
    out.set_item("units", units)?;
    out.set_item("values", values)?;
    out.set_item("eigenvalues", eigenvalues)?;
    out.set_item("participation", participation)?;
    out.set_item("time", time)?;
    Ok(out)
}

/// A linear system without its program.
struct Facts {
    names: [Vec<String>; 3],
    units: Vec<(String, String)>,
    numbers: [Vec<f64>; 8],
    values: Vec<(String, f64)>,
    eigenvalues: Option<Vec<(f64, f64)>>,
    /// For each eigenvalue the part of each state.
    participation: Option<Vec<Vec<f64>>>,
    time: f64,
}

fn facts(program: &Program, system: Linearization, values: Vec<(String, f64)>) -> Facts {
    let names = |all: &[VarId]| all.iter().map(|v| program.name(*v).to_owned()).collect();
    let all = system.states.iter().chain(&system.inputs).chain(&system.outputs);
    let unit = |v: &VarId| program.blocks.dae.variables[*v].unit.to_string();
    let eigenvalues = system.eigenvalues();
    let participation = eigenvalues.as_ref().and_then(|all| system.participation(all));
    Facts {
        participation,
        units: all.map(|v| (program.name(*v).to_owned(), unit(v))).collect(),
        names: [names(&system.states), names(&system.inputs), names(&system.outputs)],
        eigenvalues: eigenvalues.map(|all| all.into_iter().map(|x| (x.re, x.im)).collect()),
        time: system.time,
        numbers: [
            system.a,
            system.b,
            system.c,
            system.d,
            system.x,
            system.rates,
            system.u,
            system.y,
        ],
        values,
    }
}

fn variables(program: &Program, names: &[String]) -> Result<Vec<VarId>, Trouble> {
    named(program, names).map_err(|name| wrong(format!("the model has no variable `{name}`")))
}

/// The positions of states with their values.
fn positions(program: &Program, states: &[(String, f64)]) -> Result<Vec<(usize, f64)>, Trouble> {
    let all = &program.blocks.states;
    let one = |(name, value): &(String, f64)| {
        let found = all.iter().position(|s| program.name(s.variable) == name);
        let known = || all.iter().map(|s| program.name(s.variable)).collect::<Vec<_>>().join(", ");
        let message = || wrong(format!("`{name}` is not a state; the states are: {}", known()));
        Ok((found.ok_or_else(message)?, *value))
    };
    states.iter().map(one).collect()
}

fn wrong(message: String) -> Trouble {
    Trouble::plain(Kind::Request, message)
}

/// A run and its derivatives by parameters or start values: the values of `variables` at `times`, instant by instant, and
/// their derivatives, value by value, parameter by parameter.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "all are named in the Python package")]
pub fn sensitivities<'py>(
    py: Python<'py>,
    model: &Model,
    parameters: Vec<String>,
    variables: Vec<String>,
    times: &Bound<'py, PyBytes>,
    settings: Vec<(String, Setting)>,
    inputs: Vec<Drive<'py>>,
    tolerance: Option<f64>,
) -> PyResult<Bound<'py, PyTuple>> {
    let (of_run, of_program) = model.split(settings);
    let driven: Vec<String> = inputs.iter().map(|(name, ..)| name.clone()).collect();
    let mut key = of_program.clone();
    key.extend(driven.iter().map(|name| format!("input {name}")));
    key.extend(variables.iter().map(|name| format!("variable {name}")));
    let narrow = kept(&model.others.recording, key, || {
        let of = model.variant(py, of_program, driven)?;
        let mut program = of.program.clone();
        recording::only(&mut program, |name| variables.iter().any(|v| v == name));
        let execution = py.detach(|| Execution::translated(&program));
        Ok::<_, PyErr>(Narrow { of, program, execution })
    })?;
    let mut run = Settings::of(&narrow.program.blocks.dae.experiment);
    drive(&narrow.program, &inputs, &mut run);
    let times = numbers(times.as_bytes());
    let found = background::run(py, move |_| {
        let Narrow { of, program, execution } = &*narrow;
        let mut settings = run;
        settings.execution = execution.clone();
        settings.tolerance = tolerance.unwrap_or(settings.tolerance);
        set_all(program, &of_run, &mut settings)?;
        let input = |name: &String| {
            let plain = mocc::base::name::without_spaces(name);
            settable(program, &plain).ok_or_else(|| {
                wrong(format!("`{name}` is not a Real parameter or start value that a run may set"))
            })
        };
        let wanted = parameters.iter().map(input).collect::<Result<Vec<Input>, _>>()?;
        let column = |name: &String| {
            let found = program.recorded.iter().position(|v| program.name(*v) == name);
            found.ok_or_else(|| wrong(format!("the model has no variable `{name}`")))
        };
        let columns = variables.iter().map(column).collect::<Result<Vec<usize>, _>>()?;
        if let Some(first) = times.first().filter(|first| **first < settings.start) {
            let start = settings.start;
            return Err(wrong(format!(
                "the run starts at {start} s, so it has no values at {first} s"
            )));
        }
        settings.stop = times.last().copied().unwrap_or(settings.stop);
        settings.instants = Some(times.clone().into());
        let (width, count) = (program.recorded.len(), wanted.len());
        let ran = Rows::of(&Cancellation::default(), times.into(), [width, count], |rows| {
            simulate_with_sensitivities(program, &settings, &wanted, &of.sources, rows)
        });
        let (rows, _) = ran.map_err(|failure| Trouble::of_failure(&failure, &of.sources))?;
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        let all = rows.values.chunks_exact(width).zip(rows.slopes.chunks_exact(width * count));
        for (row, slope) in all {
            for k in &columns {
                values.push(row[*k]);
                slopes.extend_from_slice(&slope[k * count..(k + 1) * count]);
            }
        }
        Ok((values, slopes))
    })?;
    let (values, slopes) = found.map_err(|trouble: Trouble| trouble.raise(py))?;
    (Values(Arc::new(values)), Values(Arc::new(slopes))).into_pyobject(py)
}
