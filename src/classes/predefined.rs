//! Names that the language itself defines.

use crate::ir::expr::{Binary, Unary};

/// What is called by a simple name and has no row in a table.
pub const OTHER_FUNCTIONS: [&str; 44] = [
    "getInstanceName",
    "der",
    "pre",
    "edge",
    "change",
    "initial",
    "terminal",
    "sample",
    "noEvent",
    "smooth",
    "homotopy",
    "delay",
    "spatialDistribution",
    "cardinality",
    "inStream",
    "actualStream",
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

/// Predefined types, and the scope of the operators on overconstrained connections.
const PREDEFINED: [&str; 9] = [
    "Real",
    "Integer",
    "Boolean",
    "String",
    "Clock",
    "ExternalObject",
    "StateSelect",
    "AssertionLevel",
    "Connections",
];

/// True for a name that the language defines: no file is opened to find it (section 5.3.1).
pub fn is_predefined(name: &str) -> bool {
    PREDEFINED.contains(&name)
        || OTHER_FUNCTIONS.contains(&name)
        || Unary::called(name).is_some()
        || Binary::called(name).is_some()
}
