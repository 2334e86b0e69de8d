//! The C functions that the Modelica Standard Library calls, implemented on plain values: strings,
//! files, tables, random numbers, `printf` formats.
//!
//! Nothing here knows a model. Functions of strings and files need arguments that are known before
//! simulation: [`Function::call`] takes [`Data`] and returns [`Data`]. Tables and random numbers are functions
//! of Reals that are evaluated while the model is simulated ([`table`], [`xorshift1024`]).

pub mod files;
pub mod printf;
pub mod split_u64;
pub mod strings;
pub mod table;
pub mod xorshift1024;

use files::Files;

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
