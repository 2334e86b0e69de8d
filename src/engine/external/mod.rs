//! The C functions that the Modelica Standard Library calls, implemented on plain values: strings,
//! files, tables, random numbers, `printf` formats.
//!
//! Nothing here knows a model. Functions of strings and files need arguments that are known before
//! simulation: [`Function::call`] takes [`Data`] and returns [`Data`]. Tables and random numbers are functions
//! of Reals that are evaluated while the model is simulated ([`table`], [`xorshift1024`]); they
//! implement [`External`].

pub mod array_access;
pub mod component;
pub mod files;
pub mod printf;
pub mod split_u64;
pub mod string_operator;
pub mod strings;
pub mod table;
pub mod transfer;
pub mod xorshift1024;

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

use files::Files;

use crate::base::diag::Diagnostic;

/// A function of Reals that carries data, evaluated while the model is simulated.
pub trait External: Debug + Send + Sync {
    /// Its name, number of arguments, and type of result.
    fn signature(&self) -> Signature;
    /// Its value; `args` has as many elements as the signature says.
    fn eval(&self, args: &[f64]) -> f64;
    /// The partial derivative by an argument (counted from 0); `None` if it is 0 everywhere.
    fn derivative(&self, _argument: usize) -> Option<Arc<dyn External>> {
        None
    }
    /// The value of the partial derivative by an argument; must agree with
    /// [`derivative`](Self::derivative).
    fn slope(&self, _argument: usize, _args: &[f64]) -> f64 {
        0.0
    }
    /// A run on this thread has ended: what the function keeps for it is not needed any more.
    fn release(&self) {}
    /// True if its value follows its arguments, but nothing here can differentiate it: what it computes lies outside of
    /// the program.
    fn hides_derivatives(&self) -> bool {
        false
    }
    /// The array that it indexes, and whether its elements are Integers, if it is an array access.
    fn elements(&self) -> Option<(&[f64], bool)> {
        None
    }
    /// The declaration of a Modelica function of this name that is the same, if there is one.
    fn modelica(&self, _name: &str) -> Option<String> {
        None
    }
    /// Why the last call on this thread gave no number, once, if the function knows.
    fn take_failure(&self) -> Option<Box<Diagnostic>> {
        None
    }
    /// True if `other` is the same function.
    fn is_same(&self, other: &dyn External) -> bool;
    /// Itself, for [`is_same`](Self::is_same).
    fn as_any(&self) -> &dyn Any;
}

/// Implements the methods of [`External`] that compare functions by `==`.
macro_rules! same_if_equal {
    () => {
        fn is_same(&self, other: &dyn $crate::external::External) -> bool {
            other.as_any().downcast_ref::<Self>().is_some_and(|other| other == self)
        }
        fn as_any(&self) -> &dyn std::any::Any {
            self
        }
    };
}
pub(crate) use same_if_equal;

/// How an [`External`] function is called.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Signature {
    /// Its name in printed models.
    pub name: &'static str,
    /// Number of arguments: 1 or 2.
    pub arity: usize,
    /// True if its value is an Integer.
    pub is_integer: bool,
    /// False for a function that is piecewise constant.
    pub is_differentiable: bool,
}

/// A known argument or result.
#[derive(Clone, PartialEq, Debug)]
pub enum Data {
    /// A Real.
    Real(f64),
    /// An Integer.
    Integer(i64),
    /// A Boolean.
    Boolean(bool),
    /// A String.
    String(String),
    /// A literal of the enumeration with these literals, counted from 1.
    Literal(&'static [&'static str], u32),
    /// An array: its sizes, and its elements in row-major order.
    Array(Vec<usize>, Vec<Data>),
}

/// Why a call has no result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Fault {
    /// Number or types of the arguments do not match the function.
    Signature,
    /// The arguments are invalid, as described.
    Message(String),
}

/// A function of known arguments.
#[derive(Clone, Copy, Debug)]
pub enum Function {
    /// Depends on its arguments only.
    Pure(fn(&[Data]) -> Result<Vec<Data>, Fault>),
    /// Also reads files.
    Reading(fn(&[Data], &mut dyn Files) -> Result<Vec<Data>, Fault>),
}

impl Function {
    /// Finds a function by its name in C.
    pub fn named(name: &str) -> Option<Function> {
        let pure = strings::FUNCTIONS.iter().find(|(n, _)| *n == name);
        let reading = || files::FUNCTIONS.iter().find(|(n, _)| *n == name);
        pure.map(|(_, f)| Function::Pure(*f))
            .or_else(|| reading().map(|(_, f)| Function::Reading(*f)))
    }

    /// Its results, one for each output.
    pub fn call(self, args: &[Data], files: &mut dyn Files) -> Result<Vec<Data>, Fault> {
        match self {
            Function::Pure(f) => f(args),
            Function::Reading(f) => f(args, files),
        }
    }
}

/// The argument at position `k`, a String.
fn string(args: &[Data], k: usize) -> Result<&str, Fault> {
    match args.get(k) {
        Some(Data::String(s)) => Ok(s),
        _ => Err(Fault::Signature),
    }
}

/// The argument at position `k`, an Integer; C passes Booleans as 0 and 1.
fn integer(args: &[Data], k: usize) -> Result<i64, Fault> {
    match args.get(k) {
        Some(Data::Integer(i)) => Ok(*i),
        Some(Data::Boolean(b)) => Ok(i64::from(*b)),
        _ => Err(Fault::Signature),
    }
}
