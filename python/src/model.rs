//! A compiled model that runs with other parameters and inputs.
//!
//! Parameters that only enter equations are set for a run. For others, and for inputs that a run drives, the model is
//! compiled again, once for each combination.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use mocc::base::name::string_of_id;
use mocc::base::source::{SourceMap, Span};
use mocc::driver::compile::{Request, Session};
use mocc::driver::files;
use mocc::flatten::print::fragments;
use mocc::ir::dae::{Variable, VariableKind};
use mocc::ir::expr::{Type, VarId};
use mocc::ir::flat::Experiment;
use mocc::ir::program::Program;
use mocc::ir::trajectory::Column;
use mocc::numeric::time_series::{Interpolation, TimeSeries};
use mocc::runtime::jit::tiering::Execution;
use mocc::runtime::machine::Machine;
use mocc::simulate::columns::columns;
use mocc::simulate::settable::settable;
use mocc::simulate::settings::{Method, Settings};
use mocc::sweep::vary::Value;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::background;
use crate::derivative::Others;
use crate::error::{Kind, Trouble, warnings};
use crate::run::{self, kind_name, numbers};

/// Number of runs up to which compiling to machine code at once does not pay.
const FEW_RUNS: u64 = 4;
/// Programs to keep besides the first.
const MAX_VARIANTS: usize = 16;

/// A value of a parameter: a number in SI units, or a Modelica expression.
#[derive(FromPyObject, Clone)]
pub enum Setting {
    /// A number.
    Number(f64),
    /// An expression.
    Text(String),
}

impl Setting {
    /// As a value of a sweep.
    pub fn value(self) -> Value {
        match self {
            Setting::Number(x) => Value::Number(x),
            Setting::Text(text) => Value::Text(text),
        }
    }
}

/// A signal that drives an input: its name, instants in s, values, and interpolation.
pub type Drive<'py> = (String, Bound<'py, PyBytes>, Bound<'py, PyBytes>, String);

/// A program and the number of its runs.
pub struct Compiled {
    /// The program.
    pub program: Program,
    /// Its sources, for messages.
    pub sources: SourceMap,
    runs: AtomicU64,
    execution: OnceLock<Execution>,
    columns: OnceLock<Arc<Vec<Column>>>,
}

impl Compiled {
    /// A program that has not run.
    pub fn new(program: Program, sources: SourceMap) -> Compiled {
        Compiled {
            program,
            sources,
            runs: AtomicU64::new(0),
            execution: OnceLock::new(),
            columns: OnceLock::new(),
        }
    }

    /// The recorded variables, which all runs share.
    pub fn columns(&self) -> Arc<Vec<Column>> {
        Arc::clone(self.columns.get_or_init(|| Arc::new(columns(&self.program))))
    }

    /// How the next run is executed; results do not depend on it.
    fn execution(&self) -> Execution {
        if self.runs.fetch_add(1, Ordering::Relaxed) < FEW_RUNS {
            return Execution::default();
        }
        self.execution.get_or_init(|| Execution::translated(&self.program)).clone()
    }
}

/// The request for a model: its file and text, its name, settings, and folders of libraries.
pub fn request(
    file: Option<PathBuf>,
    text: Option<String>,
    model: Option<String>,
    settings: Vec<String>,
    folders: Vec<PathBuf>,
) -> Request {
    // Later compilations see the same text.
    let text = text.or_else(|| file.as_deref().and_then(|path| files::read(path).ok()));
    let modelica_path = std::env::var_os("MODELICAPATH");
    Request { text, settings, folders, modelica_path, ..Request::new(file, model) }
}

/// A compiled model.
#[pyclass(frozen)]
pub struct Model {
    request: Request,
    base: Arc<Compiled>,
    variants: Mutex<Vec<(Vec<String>, Arc<Compiled>)>>,
    /// Programs for linear systems, and for derivatives of runs.
    pub others: Others,
    /// Warnings of the compiler, rendered.
    #[pyo3(get)]
    warnings: Vec<String>,
    /// The text of the model's file.
    #[pyo3(get)]
    text: Option<String>,
}

#[pymethods]
impl Model {
    #[new]
    fn new(
        py: Python<'_>,
        file: Option<PathBuf>,
        text: Option<String>,
        model: Option<String>,
        settings: Vec<String>,
        folders: Vec<PathBuf>,
    ) -> PyResult<Model> {
        let request = request(file, text, model, settings, folders);
        let first = Request { check_units: true, ..request.clone() };
        let text = request.text.clone();
        let (base, warnings) = compiled(py, first)?;
        Ok(Model {
            request,
            base: Arc::new(base),
            variants: Mutex::default(),
            others: Others::default(),
            warnings,
            text,
        })
    }

    /// Full name of the model.
    #[getter]
    fn name(&self) -> &str {
        &self.base.program.blocks.dae.name
    }

    /// Start, stop, interval and tolerance of the model's annotation.
    fn experiment(&self) -> (Option<f64>, Option<f64>, Option<f64>, Option<f64>) {
        let e = &self.base.program.blocks.dae.experiment;
        (e.start, e.stop, e.interval, e.tolerance)
    }

    /// For each parameter its name, value, unit, display unit, description and place.
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyTuple>>> {
        let program = &self.base.program;
        let dae = &program.blocks.dae;
        let mut machine = Machine::new(program);
        let is_known = machine.run(&program.tapes.parameters).is_ok();
        let is_parameter = |v: &Variable| {
            matches!(v.kind, VariableKind::Parameter | VariableKind::InitialParameter) && !v.hidden
        };
        let parameter = |(id, v): (VarId, &Variable)| {
            let number = machine.value(id);
            let value = match v.ty {
                _ if !is_known || v.kind == VariableKind::InitialParameter => py.None(),
                Type::Real => number.into_pyobject(py)?.into_any().unbind(),
                Type::Integer => (number as i64).into_pyobject(py)?.into_any().unbind(),
                // A program has no clocks: their partitions have become conditions.
                Type::Boolean | Type::Clock => {
                    (number != 0.0).into_pyobject(py)?.to_owned().into_any().unbind()
                }
                Type::String => {
                    string_of_id(number as u32).as_str().into_pyobject(py)?.into_any().unbind()
                }
                Type::Enumeration(_) => dae.graph.literal(v.ty, number).into_pyobject(py)?.unbind(),
            };
            let description = v.description.as_deref().unwrap_or_default();
            let (unit, shown) = (v.unit.as_str(), v.display_unit.as_str());
            let place = self.place(v.span);
            (v.name.as_str(), value, unit, shown, description, place).into_pyobject(py)
        };
        let all = dae.variables.enumerate().filter(|(_, v)| is_parameter(v));
        all.map(parameter).collect()
    }

    /// For each recorded variable its name, kind, unit, display unit, description and place.
    fn variables<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyTuple>>> {
        let program = &self.base.program;
        let all = columns(program).into_iter().zip(&program.recorded);
        all.map(|(c, v)| {
            let place = self.place(program.blocks.dae.variables[*v].span);
            let kind = kind_name(c.kind);
            (c.name, kind, c.unit, c.display_unit, c.description, place).into_pyobject(py)
        })
        .collect()
    }

    /// Names of the states.
    fn states(&self) -> Vec<&str> {
        let program = &self.base.program;
        program.blocks.states.iter().map(|s| program.name(s.variable)).collect()
    }

    /// Names of the inputs that a run may drive, with what they take: `number`, `Boolean` or `Integer`.
    fn inputs(&self) -> Vec<(&str, &str)> {
        let variables = self.base.program.blocks.dae.variables.iter();
        let inputs = variables.filter(|v| v.kind == VariableKind::Input && !v.hidden);
        let takes = |ty: Type| match ty {
            Type::Real => Some("number"),
            Type::Boolean => Some("Boolean"),
            Type::Integer | Type::Enumeration(_) => Some("Integer"),
            Type::String | Type::Clock => None,
        };
        inputs.filter_map(|v| Some((v.name.as_str(), takes(v.ty)?))).collect()
    }

    /// Names of the String parameters.
    fn strings(&self) -> Vec<&str> {
        let variables = self.base.program.blocks.dae.variables.iter();
        let strings =
            variables.filter(|v| v.ty == Type::String && v.kind == VariableKind::Parameter);
        strings.map(|v| v.name.as_str()).collect()
    }

    /// The flat model as Modelica.
    fn flat(&self, py: Python<'_>) -> PyResult<String> {
        let request = self.request.clone();
        let printed = background::run(py, move |_| {
            let mut session = Session::default();
            let flat = session.flatten(&request);
            let flat = flat.map_err(|error| Trouble::of_session(error, &session))?;
            let pieces = fragments(&flat);
            pieces.map(|p| p.concat()).map_err(|why| Trouble::plain(Kind::Model, why.to_string()))
        })?;
        printed.map_err(|trouble| trouble.raise(py))
    }

    /// How the model is solved: states, blocks, differentiated equations.
    fn structure(&self, py: Python<'_>) -> PyResult<String> {
        let base = Arc::clone(&self.base);
        let print = mocc::structure::print::print;
        background::run(py, move |_| print(&base.program.blocks, &base.sources))
    }

    /// Runs the model; returns the run, its statistics, warnings, and printed lines.
    #[expect(clippy::too_many_arguments, reason = "all are named in the Python package")]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        settings: Vec<(String, Setting)>,
        inputs: Vec<Drive<'py>>,
        stop: Option<f64>,
        interval: Option<f64>,
        tolerance: Option<f64>,
        method: &str,
        right_limits: bool,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let (of_run, of_program) = self.split(settings);
        let driven: Vec<String> = inputs.iter().map(|(name, ..)| name.clone()).collect();
        let compiled = self.variant(py, of_program, driven)?;
        let program = &compiled.program;
        let experiment = program.blocks.dae.experiment;
        let mut settings = Settings::of(&Experiment {
            start: experiment.start,
            stop: stop.or(experiment.stop),
            interval: interval.or(experiment.interval),
            tolerance: tolerance.or(experiment.tolerance),
        });
        settings.method = method_named(method).ok_or_else(|| {
            let message =
                format!("there is no method `{method}`; known are auto, radau, bdf, dopri");
            Trouble::plain(Kind::Request, message).raise(py)
        })?;
        set_all(program, &of_run, &mut settings).map_err(|trouble| trouble.raise(py))?;
        drive(program, &inputs, &mut settings);
        settings.execution = py.detach(|| compiled.execution());
        run::simulate(py, &compiled, &settings, right_limits)
    }
}

/// Values that a run sets, and settings with which the program must be compiled.
pub type Split = (Vec<(String, f64)>, Vec<String>);

/// Sets parameters and start values of a run. Errors: with other settings of the program, one does not exist.
pub fn set_all(
    program: &Program,
    values: &[(String, f64)],
    settings: &mut Settings,
) -> Result<(), Trouble> {
    for (name, value) in values {
        let input = settable(program, name).ok_or_else(|| {
            let message = format!("with the other settings, there is no parameter `{name}`");
            Trouble::plain(Kind::Request, message)
        })?;
        settings.set(input, *value);
    }
    Ok(())
}

/// Drives inputs, whose existence the compiler has checked, by signals.
pub fn drive(program: &Program, inputs: &[Drive<'_>], settings: &mut Settings) {
    for (name, times, values, interpolation) in inputs {
        let variables = &program.blocks.dae.variables;
        let Some((v, _)) = variables.enumerate().find(|(_, v)| v.name == *name) else {
            continue;
        };
        let (times, values) = (numbers(times.as_bytes()), numbers(values.as_bytes()));
        let signal = TimeSeries::new(times.into(), values, interpolation_named(interpolation));
        settings.courses.push((v, Arc::new(signal)));
    }
}

impl Model {
    /// The request with further settings.
    pub fn request(&self, settings: Vec<String>) -> Request {
        let mut request = self.request.clone();
        request.set(&settings);
        request
    }

    /// What of these settings a run sets, and what the program depends on.
    pub fn split(&self, settings: Vec<(String, Setting)>) -> Split {
        let base = &self.base.program;
        let (mut of_run, mut of_program) = (Vec::new(), Vec::new());
        for (name, setting) in settings {
            let name = mocc::base::name::without_spaces(&name);
            match setting {
                Setting::Number(x) if settable(base, &name).is_some() => of_run.push((name, x)),
                Setting::Text(text) if self.strings().contains(&name.as_str()) => {
                    of_program.push(format!("{name}={}", quoted(&text)));
                }
                other => of_program.push(format!("{name}={}", other.value().expression())),
            }
        }
        (of_run, of_program)
    }

    fn place(&self, span: Span) -> Option<String> {
        self.base.sources.place(span)
    }

    /// The program with these settings, in which signals drive these inputs.
    pub fn variant(
        &self,
        py: Python<'_>,
        settings: Vec<String>,
        driven: Vec<String>,
    ) -> PyResult<Arc<Compiled>> {
        if settings.is_empty() && driven.is_empty() {
            return Ok(Arc::clone(&self.base));
        }
        let key: Vec<String> =
            settings.iter().cloned().chain(driven.iter().map(|d| format!("input {d}"))).collect();
        let known = || self.variants.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, found)) = known().iter().find(|(k, _)| *k == key) {
            return Ok(Arc::clone(found));
        }
        let mut request = self.request.clone();
        request.set(&settings);
        request.recorded = driven;
        let made = Arc::new(compiled(py, request)?.0);
        let mut all = known();
        if all.len() >= MAX_VARIANTS {
            all.remove(0);
        }
        all.push((key, Arc::clone(&made)));
        Ok(made)
    }
}

/// A string of Modelica; one that is written as such stays.
fn quoted(text: &str) -> String {
    if text.starts_with('"') {
        return text.to_owned();
    }
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
    format!("\"{escaped}\"")
}

/// The program of a request, and the warnings of the compiler.
fn compiled(py: Python<'_>, request: Request) -> PyResult<(Compiled, Vec<String>)> {
    let outcome = background::run(py, move |_| {
        let mut session = Session::default();
        match session.compile(&request) {
            Ok(program) => {
                let warnings = warnings(&session.problems, &session.sources);
                Ok((Compiled::new(program, session.sources), warnings))
            }
            Err(error) => Err(Trouble::of_session(error, &session)),
        }
    })?;
    outcome.map_err(|trouble| trouble.raise(py))
}

/// The method of this name.
pub fn method_named(name: &str) -> Option<Method> {
    match name {
        "auto" => Some(Method::Auto),
        "radau" => Some(Method::Radau),
        "bdf" => Some(Method::Bdf),
        "dopri" => Some(Method::Dopri),
        _ => None,
    }
}

/// The package only passes names that exist.
fn interpolation_named(name: &str) -> Interpolation {
    let found = Interpolation::ALL.into_iter().find(|(known, _)| *known == name);
    found.map_or(Interpolation::Linear, |(_, interpolation)| interpolation)
}
