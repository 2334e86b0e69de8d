//! Judging a frozen model on recordings: nothing is fitted but the values that each recording has for itself.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::driver::compile::{CompileError, Session};
use crate::driver::foreign::is_fmu;
use crate::io::json::Json;

use super::data::{self, Split};
use super::memory::Memory;
use super::plan::Plan;
use super::problem::{Problem, record_signals};
use super::recording_number::number_where_declared;
use super::result::{
    Channel, Comparison, OwnValues, Quality, channels, comparison_json, comparisons, own_json,
    own_values, qualities_json,
};
use super::run::{CalibrationError, read_plan};
use super::table::{aligned, own_table, rmse_shown};

/// What to judge, and on what.
#[derive(Clone, Debug)]
pub struct Request {
    /// The plan file.
    pub plan: PathBuf,
    /// What takes the place of files.
    pub memory: Arc<Memory>,
    /// File of the model, whose last model is judged; the plan's own model if not given.
    pub model: Option<PathBuf>,
    /// Folder of the recordings; the plan's own if not given.
    pub data: Option<PathBuf>,
    /// The value of `MODELICAPATH`.
    pub modelica_path: Option<OsString>,
}

/// A judged model.
#[derive(Clone, PartialEq, Debug)]
pub struct Evaluation {
    /// Full name of the model.
    pub model: String,
    /// The plan file.
    pub plan: String,
    /// The signals.
    pub channels: Vec<Channel>,
    /// The recordings.
    pub comparisons: Vec<Comparison>,
    /// The values that the recordings have for themselves.
    pub own: Vec<OwnValues>,
    /// Repairs of the data, in words.
    pub repairs: Vec<String>,
}

/// Compares the model with every recording. Its parameters keep the values of its file.
pub fn run(request: &Request, session: &mut Session) -> Result<Evaluation, CalibrationError> {
    let mut plan = read_plan(&request.plan, request.data.as_deref(), &request.memory, session)?;
    let mut data = data::read(&plan, &mut session.problems).ok_or(CompileError::Request)?;
    plan.free.clear();
    if let Some(model) = &request.model {
        plan.name = None;
        plan.model.clone_from(model);
    }
    let compiled = plan.request(request.modelica_path.clone());
    let mut program = session.compile(&compiled)?;
    let measured = Session::default().own_annotation(&compiled);
    if let Some(entry) = measured.entry(MEASURED) {
        read_sensors(&entry.text, &mut plan);
    }
    number_where_declared(&program, &mut plan, &mut data);
    record_signals(&mut program, &plan);
    let problem = Problem::new(&program, &session.sources, &plan, &data, &mut session.problems);
    let problem = problem.ok_or(CompileError::Request)?;
    Ok(Evaluation {
        model: program.blocks.dae.name.clone(),
        plan: plan.path.display().to_string(),
        channels: channels(&problem, &plan),
        comparisons: comparisons(&problem, &[])?,
        own: own_values(&problem, &[], &[])?,
        repairs: data.repairs.clone(),
    })
}

/// The entry of the annotation `__mocc` of a model that names the outputs of its sensors.
pub const MEASURED: &str = "measured";

/// The text of that entry: `COLUMN=VARIABLE; ...`.
pub fn sensors_text(sensors: &[(&str, &str)]) -> String {
    let all: Vec<String> = sensors.iter().map(|(c, v)| format!("{c}={v}")).collect();
    all.join("; ")
}

/// Replaces the variables of the signals by the outputs of sensors that are part of the model.
fn read_sensors(text: &str, plan: &mut Plan) {
    for (column, variable) in text.split("; ").filter_map(|part| part.rsplit_once('=')) {
        for signal in plan.signals.iter_mut().filter(|s| s.column == column) {
            variable.clone_into(&mut signal.variable);
        }
    }
}

impl Evaluation {
    /// The recordings before they were cut into windows, with the quality of each signal.
    fn wholes(&self) -> Vec<(&str, Split, Vec<Quality>)> {
        let mut out: Vec<(&str, Split, Vec<Quality>)> = Vec::new();
        for c in &self.comparisons {
            match out.last_mut() {
                Some((of, split, sums)) if (*of, *split) == (c.of.as_str(), c.split) => {
                    sums.iter_mut().zip(&c.quality).for_each(|(sum, q)| *sum = sum.plus(*q));
                }
                _ => out.push((&c.of, c.split, c.quality.clone())),
            }
        }
        out
    }

    /// All recordings together, signal by signal.
    fn all(&self) -> Vec<Quality> {
        let of = |k: usize| {
            let each = self.comparisons.iter().map(|c| c.quality[k]);
            each.fold(Quality::default(), Quality::plus)
        };
        (0..self.channels.len()).map(of).collect()
    }

    /// As a table for the terminal.
    pub fn table(&self) -> String {
        let mut head = vec!["rmse (chi2 red.)".to_owned(), "split".to_owned()];
        head.extend(self.channels.iter().map(|c| format!("{}, {}", c.column, c.unit)));
        head.push("all".to_owned());
        let mut rows = vec![head];
        let row = |name: &str, split: &str, qualities: &[Quality]| {
            let mut row = vec![name.to_owned(), split.to_owned()];
            row.extend(qualities.iter().zip(&self.channels).map(|(q, c)| match q.count {
                0 => "-".to_owned(),
                _ => format!("{} ({:.3})", rmse_shown(q.rmse(c.sigma)), q.reduced()),
            }));
            let whole = qualities.iter().copied().fold(Quality::default(), Quality::plus);
            row.push(format!("({:.4})", whole.reduced()));
            row
        };
        let wholes = self.wholes();
        rows.extend(wholes.iter().map(|(of, split, sums)| row(of, split.name(), sums)));
        rows.push(row("all", "", &self.all()));
        format!("{}\n{}{}", self.model, aligned(&rows, 0), own_table(&self.own))
    }

    /// As JSON.
    pub fn json(&self) -> String {
        let all = self.all();
        let whole = all.iter().copied().fold(Quality::default(), Quality::plus);
        let recordings = self.comparisons.iter().map(|c| comparison_json(&self.channels, c));
        Json::object([
            ("model", Json::text(&self.model)),
            ("plan", Json::text(&self.plan)),
            ("reduced_chi_square", Json::number(whole.reduced())),
            ("signals", qualities_json(&self.channels, &|k| all[k])),
            ("recordings", Json::list(recordings)),
            ("each", Json::list(self.own.iter().map(own_json))),
            ("repairs", Json::list(self.repairs.iter().map(Json::text))),
        ])
        .pretty()
    }
}

/// True for the path of a model rather than of a plan.
pub fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "mo" || e == "mol") || is_fmu(path)
}
