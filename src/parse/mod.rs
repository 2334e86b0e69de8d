//! Text to syntax tree: a `logos` lexer, an LALRPOP grammar (`grammar/modelica.lalrpop`) and the
//! builder functions its actions call.
//!
//! *In:* the text of one file. *Out:* [`crate::ir::ast::File`] and what there is to say about the
//! text. Modelica 3.6, section 2 and appendix A. The one function is [`grammar::parse`].

pub mod build;
pub mod error;
mod explain;
pub mod fragment;
pub mod grammar;
pub mod lexer;
pub mod token;
