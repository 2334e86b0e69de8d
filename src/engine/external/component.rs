//! Foreign models as components of a model: functions of the states of their instances.
//!
//! A state of an instance is an Integer, its *handle*; it stands for everything that the instance was told so far:
//! values, the begin of its run, steps. Handle 0 is an instance that was told nothing. The same message to the same
//! state gives the same state, so that calls are functions of their arguments, which a run may repeat or leave out.

use std::fmt::Debug;
use std::sync::Arc;

use super::{External, Signature};
use crate::base::diag::Diagnostic;

/// A foreign model. Times are in s.
pub trait Component: Debug + Send + Sync {
    /// The number of a value by the name of its variable.
    fn value(&self, name: &str) -> Option<usize>;
    /// The state after a value is set.
    fn set(&self, state: f64, value: usize, to: f64) -> f64;
    /// The state after initialization at this instant.
    fn begin(&self, state: f64, start: f64) -> f64;
    /// The state after a step of this size.
    fn step(&self, state: f64, size: f64) -> f64;
    /// A value in a state; not a number if the foreign model fails.
    fn get(&self, state: f64, value: usize) -> f64;
    /// The run on this thread has ended.
    fn release(&self);
    /// The last failure on this thread, once.
    fn take_failure(&self) -> Option<Box<Diagnostic>>;
}

/// What an instance is asked.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Asked {
    /// [`Component::set`] of this value: the state and the number.
    Set(usize),
    /// [`Component::begin`]: the state and the instant.
    Begin,
    /// [`Component::step`]: the state and the size.
    Step,
    /// [`Component::get`] of this value: the state.
    Get(usize),
}

/// A function of the states of a component.
#[derive(Clone, Debug)]
pub struct ComponentCall {
    /// The component.
    pub component: Arc<dyn Component>,
    /// What it is asked.
    pub asked: Asked,
}

impl External for ComponentCall {
    fn signature(&self) -> Signature {
        let (name, arity) = match self.asked {
            Asked::Set(_) => ("fmuSet", 2),
            Asked::Begin => ("fmuBegin", 2),
            Asked::Step => ("fmuStep", 2),
            Asked::Get(_) => ("fmuGet", 1),
        };
        let is_integer = !matches!(self.asked, Asked::Get(_));
        Signature { name, arity, is_integer, is_differentiable: false }
    }

    fn eval(&self, args: &[f64]) -> f64 {
        match self.asked {
            Asked::Set(value) => self.component.set(args[0], value, args[1]),
            Asked::Begin => self.component.begin(args[0], args[1]),
            Asked::Step => self.component.step(args[0], args[1]),
            Asked::Get(value) => self.component.get(args[0], value),
        }
    }

    fn take_failure(&self) -> Option<Box<Diagnostic>> {
        self.component.take_failure()
    }

    fn release(&self) {
        self.component.release();
    }

    fn hides_derivatives(&self) -> bool {
        true
    }

    fn is_same(&self, other: &dyn External) -> bool {
        let other = other.as_any().downcast_ref::<Self>();
        other.is_some_and(|o| self.asked == o.asked && Arc::ptr_eq(&self.component, &o.component))
    }

    fn as_any(&self) -> &dyn std::any::Any {
        self
    }
}
