//! Source text to syntax tree: a `logos` lexer, an LALRPOP grammar (`grammar/modelica.lalrpop`) and
//! the builder functions that its actions call.
//!
//! *In:* the content of one file. *Out:* [`crate::ir::ast::File`] and diagnostics. Modelica 3.6,
//! chapter 2 and appendix A. The entry point is [`grammar::parse`].

pub mod build;
pub mod error;
mod explain;
pub mod fragment;
pub mod grammar;
pub mod lexer;
mod missing_end;
pub mod token;
