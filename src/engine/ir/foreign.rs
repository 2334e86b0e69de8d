//! Models whose numbers come from outside of this process.
//!
//! *Holds:* the interface between a run and a foreign model: its variables, and the operations of an instance.
//! *Never holds:* how the model is reached. *Made by:* `fmu`. *Read by:* `simulate`.
//!
//! Values are numbered by [`ForeignVariable::value`]; Booleans are 0 and 1. Times are in s.

use std::fmt::Debug;
use std::sync::Arc;

use super::expr::VarId;
use crate::base::diag::Diagnostic;
use crate::numeric::time_series::TimeSeries;

/// What a variable is to the surroundings of the model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ForeignRole {
    /// Set before a run.
    Parameter,
    /// Never changes.
    Constant,
    /// Set from outside while the model runs.
    Input,
    /// Computed by the model, for its surroundings.
    Output,
    /// Computed by the model.
    Computed,
}

/// The type of the values of a variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ForeignType {
    /// Real numbers.
    Real,
    /// Whole numbers, and the numbers of enumeration literals.
    Integer,
    /// 0 or 1.
    Boolean,
}

/// A scalar variable.
#[derive(Clone, PartialEq, Debug)]
pub struct ForeignVariable {
    /// Its name in the foreign model.
    pub name: String,
    /// What it is.
    pub role: ForeignRole,
    /// The type of its values.
    pub ty: ForeignType,
    /// Which value it is; aliases have the same.
    pub value: usize,
    /// Its start value, if it is declared.
    pub start: Option<f64>,
    /// The start value may be set before a run.
    pub may_be_set: bool,
    /// A parameter that may change while the model runs.
    pub is_tunable: bool,
    /// Its unit; empty if it has none.
    pub unit: String,
    /// The unit in which it should be shown; may be empty.
    pub display_unit: String,
    /// Its description; may be empty.
    pub description: String,
    /// Its bounds.
    pub range: (Option<f64>, Option<f64>),
}

/// Everything about a foreign model that does not change.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ForeignInterface {
    /// Its name.
    pub name: String,
    /// A description; may be empty.
    pub description: String,
    /// The model integrates itself, from one communication point to the next.
    pub steps_itself: bool,
    /// Number of continuous states, if it does not integrate itself.
    pub states: usize,
    /// Number of event indicators.
    pub indicators: usize,
    /// The scalar variables.
    pub variables: Vec<ForeignVariable>,
    /// Number of values.
    pub values: usize,
    /// The end of each step must be reported.
    pub needs_completed_steps: bool,
    /// Communication points may have any distance.
    pub steps_vary: bool,
    /// Start, stop, step and tolerance that the model asks for.
    pub experiment: [Option<f64>; 4],
}

/// The numbers of an interface that a run needs.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ForeignShape {
    /// See [`ForeignInterface`].
    pub steps_itself: bool,
    /// Number of continuous states.
    pub states: usize,
    /// Number of event indicators.
    pub indicators: usize,
    /// The end of each step must be reported.
    pub needs_completed_steps: bool,
    /// Communication points may have any distance.
    pub steps_vary: bool,
    /// The distance of communication points that the model asks for, s.
    pub step: Option<f64>,
}

impl ForeignInterface {
    /// Its numbers.
    pub fn shape(&self) -> ForeignShape {
        ForeignShape {
            steps_itself: self.steps_itself,
            states: self.states,
            indicators: self.indicators,
            needs_completed_steps: self.needs_completed_steps,
            steps_vary: self.steps_vary,
            step: self.experiment[2],
        }
    }
}

/// A foreign model, of which any number of runs are made.
pub trait ForeignModel: Debug + Send + Sync {
    /// The file that holds it, for messages.
    fn file(&self) -> &str;
    /// Its interface.
    fn interface(&self) -> &ForeignInterface;
    /// Carries out a run in an instance of its own.
    fn run(
        &self,
        task: &ForeignTask,
        observer: &mut dyn ForeignObserver,
    ) -> Result<ForeignOutcome, ForeignFailure>;
}

/// A run of a foreign model, in terms of its values alone, so that it can be carried out in another process.
#[derive(Clone, PartialEq, Debug)]
pub struct ForeignTask {
    /// Start and stop, s.
    pub span: [f64; 2],
    /// Relative tolerance.
    pub tolerance: f64,
    /// The integration method as on the command line, if the model does not integrate itself.
    pub method: String,
    /// Most steps of the integrator.
    pub most_steps: u64,
    /// Longest step, s, if it is given.
    pub max_step: Option<f64>,
    /// Distance of the rows, s.
    pub interval: f64,
    /// Longest step of a model without states, s.
    pub spacing: f64,
    /// Instants of the rows, s, instead of equidistant ones.
    pub instants: Option<Arc<[f64]>>,
    /// Parameters, start values and inputs that differ from those of the model: numbers of values, and the values.
    pub values: Vec<(usize, f64)>,
    /// Inputs that signals drive.
    pub signals: Vec<ForeignSignal>,
    /// The values that the observer gets, and whether each is a Real.
    pub watched: Vec<(usize, bool)>,
}

/// A signal that drives an input of a foreign model.
#[derive(Clone, PartialEq, Debug)]
pub struct ForeignSignal {
    /// The number of the value.
    pub value: usize,
    /// Its course.
    pub series: Arc<TimeSeries>,
    /// The input changes at events alone.
    pub is_discrete: bool,
    /// Number of derivatives that are read, and the value.
    pub orders: usize,
}

/// Receives what comes of a run, in order of time. It answers whether the run should go on.
pub trait ForeignObserver {
    /// The watched values at an instant, s. An event has two rows.
    fn row(&mut self, t: f64, values: &[f64]) -> bool;
    /// An event, after the row before it.
    fn event(&mut self, t: f64, what: String);
    /// A step has ended at an instant, s.
    fn goes_on(&mut self, t: f64, counters: &Counters) -> bool;
}

/// The counters of the integrator, in the order of the fields of its statistics.
pub type Counters = [u64; 9];

/// What is known at the end of a run.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ForeignOutcome {
    /// Counters of the integrator.
    pub counters: Counters,
    /// The name of the integration method, and why it was chosen; no name if the model has integrated itself.
    pub method: Option<(String, Option<String>)>,
    /// Number of changes of event indicators.
    pub state_events: u64,
    /// Number of time events and jumps of inputs.
    pub time_events: u64,
    /// The end, s.
    pub end: f64,
    /// The model has ended the run.
    pub ended: bool,
    /// The observer has ended the run.
    pub interrupted: bool,
}

/// Why a run of a foreign model did not reach its end, and the instant, s.
#[derive(Clone, PartialEq, Debug)]
pub struct ForeignFailure {
    /// The instant, s.
    pub time: f64,
    /// The reason.
    pub why: Obstacle<ForeignFault>,
}

/// Why a run cannot go on. `F` is a fault of the model.
#[derive(Clone, PartialEq, Debug)]
pub enum Obstacle<F> {
    /// The model has failed.
    Fault(F),
    /// The integration has failed.
    Stop(Stop),
}

/// Why the integration of a foreign model cannot go on.
#[derive(Clone, PartialEq, Debug)]
pub enum Stop {
    /// An option is out of its range.
    Options(String),
    /// The step of this size, s, is too small.
    StepTooSmall(f64),
    /// The equations of a step have no unique solution.
    Singular,
    /// The limit of steps is exhausted.
    TooManySteps(u64),
    /// A derivative is not finite.
    NotFinite,
    /// Events follow each other without end: what the last one is, their number, the time that they took, s.
    Chattering(String, usize, f64),
    /// The model that integrates itself makes no step.
    NoStep,
}

/// A fault of an instance.
pub trait InstanceFault {
    /// The model has no value at this point: a shorter step may avoid it.
    fn is_avoidable(&self) -> bool;
}

/// An instance during a run. Inputs are pairs of a value's number and the value.
pub trait ForeignInstance {
    /// Why an operation fails.
    type Fault: InstanceFault;
    /// Initialises it from `start`, s, on with these values.
    fn initialise(
        &mut self,
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<AfterEvent, Self::Fault>;
    /// Derivatives and event indicators.
    fn evaluate(
        &mut self,
        at: &At<'_>,
        derivatives: &mut [f64],
        indicators: &mut [f64],
    ) -> Result<(), Self::Fault>;
    /// Derivatives by states, column by column.
    fn jacobian(&mut self, at: &At<'_>, entries: &mut [f64]) -> Result<(), Self::Fault>;
    /// The watched values. Without a point those after the last step or event.
    fn values(&mut self, at: Option<&At<'_>>, values: &mut [f64]) -> Result<(), Self::Fault>;
    /// The integrator has accepted a step that ends here.
    fn complete(&mut self, at: &At<'_>) -> Result<AfterStep, Self::Fault>;
    /// Executes an event.
    fn event(&mut self, at: &At<'_>) -> Result<AfterEvent, Self::Fault>;
    /// Steps from `t` by `size`, s, with these inputs.
    fn step(
        &mut self,
        t: f64,
        size: f64,
        inputs: &[(usize, f64)],
    ) -> Result<AfterStep, Self::Fault>;
}

impl<I: ForeignInstance> ForeignInstance for &mut I {
    type Fault = I::Fault;

    fn initialise(
        &mut self,
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<AfterEvent, I::Fault> {
        (**self).initialise(span, tolerance, values)
    }

    fn evaluate(
        &mut self,
        at: &At<'_>,
        derivatives: &mut [f64],
        indicators: &mut [f64],
    ) -> Result<(), I::Fault> {
        (**self).evaluate(at, derivatives, indicators)
    }

    fn jacobian(&mut self, at: &At<'_>, entries: &mut [f64]) -> Result<(), I::Fault> {
        (**self).jacobian(at, entries)
    }

    fn values(&mut self, at: Option<&At<'_>>, values: &mut [f64]) -> Result<(), I::Fault> {
        (**self).values(at, values)
    }

    fn complete(&mut self, at: &At<'_>) -> Result<AfterStep, I::Fault> {
        (**self).complete(at)
    }

    fn event(&mut self, at: &At<'_>) -> Result<AfterEvent, I::Fault> {
        (**self).event(at)
    }

    fn step(&mut self, t: f64, size: f64, inputs: &[(usize, f64)]) -> Result<AfterStep, I::Fault> {
        (**self).step(t, size, inputs)
    }
}

/// A point of evaluation.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// The instant, s.
    pub t: f64,
    /// The continuous states.
    pub states: &'a [f64],
    /// The inputs.
    pub inputs: &'a [(usize, f64)],
}

/// The state of an instance after an event.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct AfterEvent {
    /// The continuous states.
    pub states: Vec<f64>,
    /// Their nominal values.
    pub nominals: Vec<f64>,
    /// The event indicators.
    pub indicators: Vec<f64>,
    /// The next time event, s.
    pub next: Option<f64>,
    /// The model ends the run.
    pub ends: bool,
}

/// The outcome of a step.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct AfterStep {
    /// The instant that it has reached, s.
    pub reached: f64,
    /// The model asks for an event.
    pub asks_for_event: bool,
    /// The model ends the run.
    pub ends: bool,
}

/// What kind of fault it is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ForeignFaultKind {
    /// The run cannot go on.
    Final,
    /// The file of the model is of no use.
    Input,
}

/// Why an operation failed.
#[derive(Clone, PartialEq, Debug)]
pub struct ForeignFault {
    /// Its kind.
    pub kind: ForeignFaultKind,
    /// The message, which names the model.
    pub diagnostic: Box<Diagnostic>,
}

/// The foreign model behind a program.
#[derive(Clone, Debug)]
pub struct Foreign {
    /// The model.
    pub model: Arc<dyn ForeignModel>,
    /// Variables of the program, each with the position of its variable in the interface.
    pub variables: Vec<(VarId, usize)>,
}
