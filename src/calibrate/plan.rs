//! The plan file: the model, the recordings and the free parameters.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

use crate::base::source::Span;
use crate::driver::compile::Request;
use crate::driver::surrounded::Surrounded;
use crate::numeric::time_series::Interpolation;

use super::cancellation::Cancellation;
use super::data::{Data, Split};
use super::memory::Memory;
use super::unit::Unit;

/// A plan.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The plan file.
    pub path: PathBuf,
    /// What takes the place of files.
    pub memory: Arc<Memory>,
    /// The model's file.
    pub model: PathBuf,
    /// The FMU that the model runs, if it was made of one.
    pub fmu: Option<WholeFmu>,
    /// The model's name, if it is not the last of its file.
    pub name: Option<String>,
    /// Folders of libraries.
    pub libraries: Vec<PathBuf>,
    /// Settings `NAME=VALUE` for all recordings, as with `--set`.
    pub fixed: Vec<String>,
    /// Folder of the recordings.
    pub folder: PathBuf,
    /// The recordings that the plan itself lists.
    pub listed: Vec<ListedRecording>,
    /// Recordings are cut into windows of this length, s, each a run of its own; whole if infinite.
    pub window: f64,
    /// Time at the start of each run that is not compared, s.
    pub skip: f64,
    /// Only every n-th row is compared.
    pub every: usize,
    /// The table of recordings in that folder; empty if the plan lists them.
    pub table: String,
    /// Its column with the names of the files.
    pub file_column: String,
    /// Its column with the names of the recordings; without it, the names of the files.
    pub name_column: Option<String>,
    /// Its column with `train`, `validation` or `test`; without it, all recordings are for training.
    pub split_column: Option<String>,
    /// Its columns that set parameters.
    pub conditions: Vec<Condition>,
    /// Columns of the recordings that drive inputs of the model.
    pub inputs: Vec<DrivenInput>,
    /// Columns of the recordings that determine the initial values of runs.
    pub starts: Vec<InitialValue>,
    /// The column of the time in each recording.
    pub time: String,
    /// Its unit.
    pub time_unit: Unit,
    /// The measured signals.
    pub signals: Vec<Signal>,
    /// The free parameters; those of single recordings stand at the end ([`Plan::free_each`]).
    pub free: Vec<Free>,
    /// Parameters that are free for each recording: it has a value of its own.
    pub each: Vec<Free>,
    /// Steps after which a run of a training recording is abandoned, if fewer than usual.
    pub most_steps: Option<u64>,
    /// How many times as many steps as usual a run of a training recording may take.
    pub allowance: u64,
    /// Ends runs in the middle of a search.
    pub cancellation: Cancellation,
}

/// An FMU whose surroundings are the model of a plan. Inside it nothing can be added.
#[derive(Clone, Debug)]
pub struct WholeFmu {
    /// Its file.
    pub file: PathBuf,
    /// Its parameters that keep their values during a run.
    pub fixed: Vec<String>,
    /// The open FMU.
    pub open: Arc<Surrounded>,
}

/// A column of the table that sets a parameter.
#[derive(Clone, Debug)]
pub struct Condition {
    /// The column.
    pub column: String,
    /// The parameter.
    pub parameter: String,
    /// The unit of the column.
    pub unit: Unit,
    /// Its name.
    pub unit_name: String,
    /// Its place in the plan.
    pub span: Span,
}

/// The condition that is the number of a recording, 1 for the first. Only a model that has a parameter of this name sees
/// it: one that was extended by an effect of wear or drift.
pub const RECORDING_NUMBER: &str = "recording_number";

/// A measured signal and the variable that it measures.
#[derive(Clone, Debug)]
pub struct Signal {
    /// The column.
    pub column: String,
    /// The variable.
    pub variable: String,
    /// The unit of the column.
    pub unit: Unit,
    /// Its name.
    pub unit_name: String,
    /// Standard deviation of the sensor's noise in that unit, if known.
    pub sigma: Option<f64>,
    /// Half-width of the smoothing window, s; 0 for none.
    pub smooth: f64,
    /// Its place in the plan.
    pub span: Span,
}

/// A recording that the plan lists: a file, or a part of one.
#[derive(Clone, Debug)]
pub struct ListedRecording {
    /// The file.
    pub file: String,
    /// Its name.
    pub name: String,
    /// Its use.
    pub split: Split,
    /// The part of the file, s.
    pub part: (f64, f64),
    /// Overrides [`Plan::window`].
    pub window: Option<f64>,
    /// Overrides [`Plan::skip`].
    pub skip: Option<f64>,
}

/// A column of the recordings that drives an input.
#[derive(Clone, Debug)]
pub struct DrivenInput {
    /// The column.
    pub column: String,
    /// The input.
    pub input: String,
    /// The unit of the column.
    pub unit: Unit,
    /// Interpolation between two rows.
    pub interpolation: Interpolation,
    /// Half-width of the smoothing window, s; 0 for none.
    pub smooth: f64,
    /// Only every n-th row is used.
    pub every: usize,
    /// Value of the input, in the unit of the column, for a recording without this column.
    pub absent: Option<f64>,
    /// Its place in the plan.
    pub span: Span,
}

/// A column of the recordings that determines an initial value.
#[derive(Clone, Debug)]
pub struct InitialValue {
    /// The target: a parameter, or `start(x)` for the start value of `x`.
    pub target: String,
    /// The column.
    pub column: String,
    /// The unit of the column.
    pub unit: Unit,
    /// Use the derivative of the column by time instead of its value.
    pub rate: bool,
    /// Half-width of the smoothing window, s; 0 for none.
    pub smooth: f64,
    /// Its place in the plan.
    pub span: Span,
}

impl Plan {
    /// The request that compiles the model of the plan.
    pub fn request(&self, modelica_path: Option<OsString>) -> Request {
        Request {
            text: self.memory.model.clone(),
            settings: self.fixed.clone(),
            recorded: self.inputs.iter().map(|i| i.input.clone()).collect(),
            differentiated: self.targets(),
            folders: self.libraries.clone(),
            modelica_path,
            takes_fmu: true,
            fmus: self.memory.fmus.clone(),
            packed: self.memory.packed.clone(),
            ..Request::new(Some(self.model.clone()), self.name.clone())
        }
    }

    /// The parameters of the model by which its runs are differentiated.
    pub fn targets(&self) -> Vec<String> {
        self.free.iter().chain(&self.each).flat_map(|f| f.targets.iter().cloned()).collect()
    }

    /// Gives each training recording parameters of its own, which are fitted together with the others.
    pub fn free_each(&mut self, data: &Data) {
        for recording in data.wholes(Split::Train) {
            let of_recording = |free: &Free| Free {
                name: own_name(&free.name, recording),
                only: Some(recording.to_owned()),
                ..free.clone()
            };
            self.free.extend(self.each.iter().map(of_recording));
        }
    }
}

/// The name of a parameter that is free for each recording, in one of them.
pub fn own_name(parameter: &str, recording: &str) -> String {
    format!("{parameter} of {recording}")
}

/// A free parameter.
#[derive(Clone, Debug)]
pub struct Free {
    /// Its name.
    pub name: String,
    /// The parameters of the model that take its value; `start(x)` is the start value of `x`.
    pub targets: Vec<String>,
    /// Its start; without it, the value in the model.
    pub start: Option<f64>,
    /// Its least value.
    pub min: Option<f64>,
    /// Its greatest value.
    pub max: Option<f64>,
    /// The factor around a positive start within which it is searched where it has no bounds.
    pub around: Option<f64>,
    /// If it acts on one signal only: its position, and the variable through which it acts.
    pub acts_on: Option<(usize, String)>,
    /// The only recording that takes its value, if it is not the same for all.
    pub only: Option<String>,
    /// Its place in the plan.
    pub span: Span,
}
