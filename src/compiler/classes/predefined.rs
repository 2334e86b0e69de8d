//! Names of functions and operators that the language itself defines.

use crate::ir::expr::{Binary, Unary};

/// Operators that refer to variables or to the run of a model, which functions do not have (section 12.2).
pub const OF_MODELS: [&str; 12] = [
    "der",
    "pre",
    "edge",
    "change",
    "initial",
    "terminal",
    "sample",
    "delay",
    "spatialDistribution",
    "cardinality",
    "inStream",
    "actualStream",
];

/// Everything else that is called by a simple name and has no row in a table.
const OTHERS: [&str; 32] = [
    "getInstanceName",
    "noEvent",
    "smooth",
    "homotopy",
    "semiLinear",
    "String",
    "min",
    "max",
    "sum",
    "product",
    "size",
    "ndims",
    "zeros",
    "ones",
    "fill",
    "identity",
    "diagonal",
    "linspace",
    "transpose",
    "cross",
    "skew",
    "outerProduct",
    "symmetric",
    "vector",
    "scalar",
    "matrix",
    "cat",
    "assert",
    "terminate",
    "reinit",
    "connect",
    "time",
];

/// The scope of the operators on overconstrained connections (section 9.4.1).
const CONNECTIONS: &str = "Connections";

/// What is called by a simple name and has no row in a table.
pub fn without_row() -> impl Iterator<Item = &'static str> {
    OF_MODELS.into_iter().chain(OTHERS)
}

/// True for the name of a function or an operator of the language: no file is opened to find it (section 5.3.1).
pub fn is_built_in(name: &str) -> bool {
    let has_row = Unary::called(name).is_some() || Binary::called(name).is_some();
    has_row || name == CONNECTIONS || without_row().any(|other| other == name)
}
