//! The workflow of a design, from a plan file to the best design.
//!
//! Any front end can call [`run`]: it prints nothing and never ends the process. Diagnostics accumulate in the
//! [`Session`]. The first search begins at the start of the plan, the others at points that fill the ranges evenly; the best
//! end that keeps all limits wins. The result does not depend on the number of cores.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::cause::DesignCause;
use super::plan::{self, Plan, Value};
use super::problem::{Coordinate, Search, Shared, bounds, size};
use super::result::{LimitFound, Optimum, ParameterFound, SearchFound, State};
use super::{amended, result};
use crate::base::diag::Diagnostic;
use crate::calibrate::parallel;
use crate::calibrate::parameter::{Parameter, parameter};
use crate::driver::compile::{CompileError, Request as Compilation, Session};
use crate::driver::files::read;
use crate::driver::project;
use crate::ir::flat::Experiment;
use crate::ir::program::Program;
use crate::ir::trajectory::Trajectory;
use crate::measure::observe::Plan as Measures;
use crate::numeric::halton::Halton;
use crate::numeric::sqp::{Minimum, Stopping, minimize};
use crate::runtime::machine::Machine;
use crate::simulate::failure::Failure;
use crate::simulate::settings::Settings;

/// Violation of a limit, relative to it, that is accepted.
const VIOLATION: f64 = 1e-6;

/// What to optimize.
pub struct Request<'a> {
    /// The plan file.
    pub plan: PathBuf,
    /// Its text, if a front end holds it.
    pub text: Option<String>,
    /// The value of `MODELICAPATH`.
    pub modelica_path: Option<OsString>,
    /// Threads.
    pub jobs: usize,
    /// True once the search is to end, with the best design so far.
    pub is_cancelled: &'a (dyn Fn() -> bool + Sync),
}

/// Why there is no design.
#[derive(Debug, thiserror::Error)]
pub enum OptimizeError {
    /// A file cannot be read.
    #[error("cannot read {}: {why}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// The plan or the model are wrong; the diagnostics of the session say how.
    #[error(transparent)]
    Invalid(#[from] CompileError),
    /// No search had a start that can be simulated.
    #[error("{}", .0.diagnostic.message)]
    Failed(Box<Failure>),
    /// A measure has no value at any start.
    #[error("{0}")]
    NoValue(String),
}

/// Reads the plan of a design and compiles its model; nothing is run.
pub fn check(request: &Request<'_>, session: &mut Session) -> Result<(), OptimizeError> {
    let text = request.text.clone().map_or_else(|| readable(&request.plan), Ok)?;
    let found = plan::read(&request.plan, &text, &mut session.sources, &mut session.problems);
    let mut plan = found.ok_or(CompileError::Request)?;
    let (program, measures) = compile(&plan, request, session)?;
    convert(&mut plan, &program, &measures, session)?;
    parameters(&plan, &program, session)?;
    Ok(())
}

/// Optimizes the design of a plan.
pub fn run(request: &Request<'_>, session: &mut Session) -> Result<Optimum, OptimizeError> {
    let text = request.text.clone().map_or_else(|| readable(&request.plan), Ok)?;
    let found = plan::read(&request.plan, &text, &mut session.sources, &mut session.problems);
    let mut plan = found.ok_or(CompileError::Request)?;
    let original = readable(&plan.model)?;
    let (program, measures) = compile(&plan, request, session)?;
    convert(&mut plan, &program, &measures, session)?;
    let parameters = parameters(&plan, &program, session)?;
    let coordinates: Vec<Coordinate> =
        parameters.iter().map(|p| Coordinate::of(p.bounds.0, p.bounds.1)).collect();
    let declared = program.blocks.dae.experiment;
    let settings = Settings::of(&Experiment {
        stop: plan.stop.or(declared.stop),
        tolerance: plan.tolerance.or(declared.tolerance),
        ..declared
    });
    let goal = plan.limits.len();
    let mut shared = Shared {
        program: &program,
        sources: &session.sources,
        measures: &measures,
        settings,
        parameters,
        coordinates,
        bounds: Vec::new(),
        goal,
        weight: if plan.maximize { -1.0 } else { 1.0 },
        is_cancelled: request.is_cancelled,
    };
    let start: Vec<f64> = shared
        .parameters
        .iter()
        .zip(&shared.coordinates)
        .map(|(p, c)| c.place(p.start.clamp(p.bounds.0, p.bounds.1)))
        .collect();
    // Before is the model as it is, with the starts of the plan, which may lie outside of the ranges.
    let begins: Vec<f64> = shared.parameters.iter().map(|p| p.start).collect();
    let mut trace_before = Trajectory::default();
    let before = shared.run(&begins, &mut trace_before).ok().map(|m| m.values);
    let at_start = before.clone().unwrap_or_else(|| vec![None; goal + 1]);
    shared.bounds = bounds(&plan, &at_start);
    shared.weight /= size(at_start[goal].unwrap_or(1.0));

    let mut halton = Halton::new(start.len());
    let mut starts = vec![start];
    starts.extend((1..plan.starts).map(|_| halton.next_point()));
    let ended = parallel::map(request.jobs, starts.len(), |k| searched(&shared, &starts[k]));
    let feasible = |m: &Minimum| m.values.violation() <= VIOLATION;
    // Those that keep the limits come first, then the least goal, or the least violation.
    let order = |m: &Minimum| match feasible(m) {
        true => (0, m.values.f),
        false => (1, m.values.violation()),
    };
    let better = |a: &&Minimum, b: &&Minimum| {
        let (a, b) = (order(a), order(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    };
    let Some(best) = ended.iter().filter_map(|(m, _)| m.as_ref()).min_by(better) else {
        return Err(nothing(
            &plan,
            &measures,
            &at_start,
            ended.into_iter().map(|(_, s)| s.failure),
        ));
    };
    let values = shared.values(&best.x);
    let mut trace_after = Trajectory::default();
    let after = shared.run(&values, &mut trace_after);
    let after = after.map_err(|failure| OptimizeError::Failed(Box::new(failure)))?.values;

    let columns = &measures.columns;
    let parameters_found = shared.parameters.iter().zip(&plan.free).zip(&values);
    let parameters_found: Vec<ParameterFound> = parameters_found
        .map(|((p, range), value)| ParameterFound {
            name: p.name.clone(),
            targets: range.targets.clone(),
            unit: p.unit.clone(),
            low: p.bounds.0,
            high: p.bounds.1,
            start: p.start,
            value: *value,
        })
        .collect();
    let price = |measure: usize| {
        let of = |(b, m): (&super::problem::Bound, &f64)| {
            (b.measure == measure && *m > 0.0)
                .then(|| -b.sign * m / (b.scale * shared.weight.abs()))
        };
        let sign = if plan.maximize { -1.0 } else { 1.0 };
        shared.bounds.iter().zip(&best.multipliers).find_map(of).map(|p| sign * p)
    };
    let limits = plan.limits.iter().enumerate().map(|(k, limit)| LimitFound {
        name: limit.name.clone(),
        text: columns[k].description.clone(),
        unit: columns[k].unit.clone(),
        min: limit.min.as_ref().map(|v| v.quantity.value),
        max: limit.max.as_ref().map(|v| v.quantity.value),
        before: at_start[k],
        after: after[k],
        price: price(k),
    });
    let searches = starts.iter().zip(&ended).map(|(x, (minimum, search))| SearchFound {
        start: shared.values(x),
        state: match minimum {
            None => State::Failed(search.failure.as_ref().map_or_else(
                || "a measure has no value at its start".to_owned(),
                |f| f.diagnostic.message.clone(),
            )),
            Some(m) if !feasible(m) => State::OutsideLimits,
            Some(m) if m.converged => State::Converged,
            Some(_) => State::Ended,
        },
        goal: minimum.as_ref().map(|m| m.values.f / shared.weight),
        values: minimum.as_ref().map_or_else(Vec::new, |m| shared.values(&m.x)),
        steps: minimum.as_ref().map_or(0, |m| m.steps),
    });
    let sum = |of: fn(&result::Counts) -> u32| ended.iter().map(|(_, s)| of(s)).sum();
    let mut optimum = Optimum {
        model: program.blocks.dae.name.clone(),
        plan: plan.path.display().to_string(),
        goal: columns[goal].name.clone(),
        goal_text: columns[goal].description.clone(),
        goal_unit: columns[goal].unit.clone(),
        maximize: plan.maximize,
        before: at_start[goal],
        after: after[goal],
        parameters: parameters_found,
        limits: limits.collect(),
        is_feasible: feasible(best),
        converged: best.converged,
        complete: !(request.is_cancelled)(),
        searches: searches.collect(),
        runs: sum(|s| s.runs),
        exact: sum(|s| s.exact),
        differences: sum(|s| s.differences),
        show: plan.show.clone(),
        trace_before: before.map(|_| trace_before),
        trace_after,
        amended: String::new(),
    };
    optimum.amended = amended::text(&original, &plan, &optimum, &declared);
    Ok(optimum)
}

/// One search, and what is known of it.
fn searched(shared: &Shared<'_>, start: &[f64]) -> (Option<Minimum>, result::Counts) {
    let mut search = Search::new(shared);
    let stopping = Stopping { violation: VIOLATION, ..Stopping::default() };
    let minimum = minimize(&mut search, start, &vec![(0.0, 1.0); start.len()], &stopping);
    let Search { runs, exact, differences, failure, .. } = search;
    (minimum, result::Counts { runs, exact, differences, failure })
}

fn readable(path: &Path) -> Result<String, OptimizeError> {
    read(path).map_err(|why| OptimizeError::Unreadable { path: path.to_owned(), why })
}

fn compile(
    plan: &Plan,
    request: &Request<'_>,
    session: &mut Session,
) -> Result<(Program, Measures), OptimizeError> {
    let project = project::of(Some(&plan.model), &mut session.sources, &mut session.problems);
    let compilation = Compilation {
        folders: plan.libraries.iter().chain(&project.libraries).cloned().collect(),
        readable: project.allow_read,
        settings: plan.fixed.clone(),
        differentiated: plan.free.iter().flat_map(|f| f.targets.iter().cloned()).collect(),
        modelica_path: request.modelica_path.clone(),
        ..Compilation::new(Some(plan.model.clone()), plan.name.clone())
    };
    let mut texts: Vec<String> =
        plan.limits.iter().map(|l| format!("{} = {}", l.name, l.expression)).collect();
    texts.push(plan.goal.clone());
    Ok(session.compile_differentiable(&compilation, &texts)?)
}

/// The free parameters; reports those that the model does not have.
fn parameters(
    plan: &Plan,
    program: &Program,
    session: &mut Session,
) -> Result<Vec<Parameter>, OptimizeError> {
    let mut machine = Machine::new(program);
    // A fault in a parameter is reported by the first run.
    let _ = machine.run(&program.tapes.parameters);
    let problems = &mut session.problems;
    let before = problems.error_count();
    let mut out = Vec::new();
    for range in &plan.free {
        let Some(p) = parameter(program, &machine, &range.free(), problems) else { continue };
        out.push(p);
    }
    if problems.error_count() > before {
        return Err(CompileError::Request.into());
    }
    Ok(out)
}

/// Converts the values of a plan to the units of their parameters and measures; reports those that measure something else.
fn convert(
    plan: &mut Plan,
    program: &Program,
    measures: &Measures,
    session: &mut Session,
) -> Result<(), CompileError> {
    let problems = &mut session.problems;
    let before = problems.error_count();
    let variables = &program.blocks.dae.variables;
    let unit_of = |name: &str| {
        let name = name.strip_prefix("start(").and_then(|n| n.strip_suffix(')')).unwrap_or(name);
        variables.iter().find(|v| v.name == name.trim()).map(|v| v.unit.to_string())
    };
    for range in &mut plan.free {
        let unit = range.targets.first().and_then(|name| unit_of(name)).unwrap_or_default();
        let values = [Some(&mut range.min), Some(&mut range.max), range.start.as_mut()];
        for value in values.into_iter().flatten() {
            in_unit(&range.name, &unit, value).into_iter().for_each(|d| problems.push(d));
        }
    }
    for (limit, column) in plan.limits.iter_mut().zip(&measures.columns) {
        for value in [&mut limit.min, &mut limit.max].into_iter().flatten() {
            in_unit(&limit.name, &column.unit, value).into_iter().for_each(|d| problems.push(d));
        }
    }
    if problems.error_count() > before { Err(CompileError::Request) } else { Ok(()) }
}

/// Converts a value; a diagnostic if its unit measures something else. The unit of a composed measure is not known.
fn in_unit(name: &str, declared: &str, value: &mut Value) -> Option<Diagnostic> {
    let quantity = &mut value.quantity;
    if quantity.unit.is_empty() || declared.is_empty() {
        return None;
    }
    if let Some(own) = quantity.in_unit(declared) {
        quantity.value = own;
        return None;
    }
    let (name, declared, unit) = (name.to_owned(), declared.to_owned(), quantity.unit.clone());
    Some(Diagnostic::new(DesignCause::OtherUnit { name, declared, unit }, value.span))
}

/// Why no search has a result.
fn nothing(
    plan: &Plan,
    measures: &Measures,
    before: &[Option<f64>],
    failures: impl Iterator<Item = Option<Failure>>,
) -> OptimizeError {
    if let Some(failure) = failures.flatten().next() {
        return OptimizeError::Failed(Box::new(failure));
    }
    let missing = measures.columns.iter().zip(before).filter(|(_, value)| value.is_none());
    let names: Vec<String> =
        missing.map(|(c, _)| format!("`{} = {}`", c.name, c.description)).collect();
    let what = if names.is_empty() { "a measure".to_owned() } else { names.join(", ") };
    OptimizeError::NoValue(format!(
        "{what} has no value at any of the {} starts: its condition never becomes true; \
         give `start` in [free], or simulate longer with `stop`",
        plan.starts
    ))
}
