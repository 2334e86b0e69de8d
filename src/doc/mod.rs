//! Pages of a library: for each class its diagram, parameters with units, equations typeset, and where it is used.
//!
//! *In:* the classes of a library as syntax trees ([`classes`]). *Out:* pages that open from disk ([`page`]). Equations are
//! MathML ([`mathml`]), which browsers draw by themselves.

pub mod classes;
pub mod mathml;
pub mod page;
