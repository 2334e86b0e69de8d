//! Pages of a library: for each class its diagram, parameters with units, equations typeset, and where it is used.
//!
//! *In:* the classes of a library as syntax trees ([`classes`]). *Out:* the content of each page ([`content`]), as pages
//! that open from disk ([`html`]), whose equations are MathML ([`mathml`]), or in Markdown ([`markdown`]).

pub mod classes;
pub mod content;
pub mod html;
pub mod markdown;
pub mod mathml;
pub mod pictures;
