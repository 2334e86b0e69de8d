//! The runs of a page: which ones the options ask for, and what is kept of each.

use super::super::args::runs::Report;
use super::super::progress::Progress;
use super::super::{Status, interrupt, running};
use super::wrong;
use crate::base::index::FastSet;
use crate::base::source::{SourceMap, Span};
use crate::codegen::recording;
use crate::ir::expr::Type;
use crate::ir::program::Program;
use crate::ir::trajectory::{Column, Constant, Event, Trajectory};
use crate::report::page::document::RunPart;
use crate::report::page::parameters::Value;
use crate::simulate::columns::column_storage;
use crate::simulate::record::Sink;
use crate::simulate::run::{Statistics, simulate_to};

/// Variables in a page; those of the model itself come first.
const MOST_VARIABLES: usize = 5000;

/// A requested run.
pub struct RunRequest {
    /// How the page names it.
    pub label: String,
    /// Its overrides.
    pub settings: Vec<String>,
}

/// A finished run.
pub struct FinishedRun {
    /// What the page shows of it.
    pub part: RunPart,
    /// Values of parameters, and where these are declared.
    pub values: Vec<(Column, Value, Span)>,
    /// The user ended it.
    pub interrupted: bool,
}

/// The runs that the options ask for: those of `--run`, or the one with the settings of `--set`.
pub fn requested(options: &Report) -> Result<Vec<RunRequest>, String> {
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

/// Runs a program. Remarks are for the page; an error has been shown.
pub fn simulated(
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
