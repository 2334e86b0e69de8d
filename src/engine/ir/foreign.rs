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

/// A foreign model, from which any number of instances are made.
pub trait ForeignModel: Debug + Send + Sync {
    /// The file that holds it, for messages.
    fn file(&self) -> &str;
    /// Its interface.
    fn interface(&self) -> &ForeignInterface;
    /// A new instance, on whose values `watched` the run will look, in this order.
    fn instantiate(&self, watched: &[usize]) -> Result<Box<dyn ForeignInstance>, ForeignFault>;
}

/// An instance during a run. Inputs are pairs of a value's number and the value.
pub trait ForeignInstance {
    /// Initialises it from `start`, s, on with these values.
    fn initialise(
        &mut self,
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<AfterEvent, ForeignFault>;
    /// Derivatives and event indicators.
    fn evaluate(
        &mut self,
        at: &At<'_>,
        derivatives: &mut [f64],
        indicators: &mut [f64],
    ) -> Result<(), ForeignFault>;
    /// Derivatives by states, column by column.
    fn jacobian(&mut self, at: &At<'_>, entries: &mut [f64]) -> Result<(), ForeignFault>;
    /// The watched values. Without a point those after the last step or event.
    fn values(&mut self, at: Option<&At<'_>>, values: &mut [f64]) -> Result<(), ForeignFault>;
    /// The integrator has accepted a step that ends here.
    fn complete(&mut self, at: &At<'_>) -> Result<AfterStep, ForeignFault>;
    /// Executes an event.
    fn event(&mut self, at: &At<'_>) -> Result<AfterEvent, ForeignFault>;
    /// Steps from `t` by `size`, s, with these inputs.
    fn step(
        &mut self,
        t: f64,
        size: f64,
        inputs: &[(usize, f64)],
    ) -> Result<AfterStep, ForeignFault>;
    /// Ends the instance in good order.
    fn end(&mut self);
    /// Takes it back to where it was before its initialization.
    fn renew(&mut self) -> Result<(), ForeignFault>;
}

/// An instance that goes from one communication point to the next, whoever integrates it.
pub trait SteppingInstance {
    /// Initialises it from `start`, s, on with these values.
    fn initialise(
        &mut self,
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<(), ForeignFault>;
    /// The watched values after the last step.
    fn values(&mut self, values: &mut [f64]) -> Result<(), ForeignFault>;
    /// Steps from `t` by `size`, s, with these inputs.
    fn step(
        &mut self,
        t: f64,
        size: f64,
        inputs: &[(usize, f64)],
    ) -> Result<AfterStep, ForeignFault>;
    /// Takes it back to where it was before its initialization.
    fn renew(&mut self) -> Result<(), ForeignFault>;
}

/// An instance of a model that integrates itself.
impl SteppingInstance for Box<dyn ForeignInstance + Send> {
    fn initialise(
        &mut self,
        span: [f64; 2],
        tolerance: f64,
        values: &[(usize, f64)],
    ) -> Result<(), ForeignFault> {
        (**self).initialise(span, tolerance, values).map(drop)
    }

    fn values(&mut self, values: &mut [f64]) -> Result<(), ForeignFault> {
        (**self).values(None, values)
    }

    fn step(
        &mut self,
        t: f64,
        size: f64,
        inputs: &[(usize, f64)],
    ) -> Result<AfterStep, ForeignFault> {
        (**self).step(t, size, inputs)
    }

    fn renew(&mut self) -> Result<(), ForeignFault> {
        (**self).renew()
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
    /// The model has no value at this point: a shorter step may avoid it.
    Avoidable,
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
