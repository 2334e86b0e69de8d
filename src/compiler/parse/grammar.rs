//! The interface to the parser that LALRPOP generates from `grammar/modelica.lalrpop`.

use super::build::Builder;
use super::error::{NestingLimit, SyntaxCause, SyntaxContext};
use super::lexer;
use super::missing_end::insert_missing_ends;
use super::token::TokenKind;
use crate::base::diag::{Diagnostic, Problems};
use crate::base::source::{FileId, Span};
use crate::ir::ast;

#[allow(missing_docs, unused_qualifications, clippy::all)]
#[rustfmt::skip]
mod generated {
    include!(concat!(env!("OUT_DIR"), "/modelica.rs"));
}

/// An error as LALRPOP reports it.
pub type ParseError = lalrpop_util::ParseError<u32, TokenKind, (u32, NestingLimit)>;
/// An error from which LALRPOP recovered.
pub type Recovery = lalrpop_util::ErrorRecovery<u32, TokenKind, (u32, NestingLimit)>;

/// Parses a file. Never fails: syntax errors are reported, and the tree omits the construct or
/// contains a `Broken` node in its place.
pub fn parse(file: FileId, text: &str, problems: &mut Problems) -> ast::File {
    let mut tree = ast::File { id: file, within: None, classes: Vec::new(), comments: Vec::new() };
    if u32::try_from(text.len()).is_err() {
        problems.push(Diagnostic::new(SyntaxCause::FileTooLarge, Span::new(file, 0, 0)));
        return tree;
    }
    let mut lexed = lexer::lex(file, text, problems);
    tree.comments = lexed.comments;
    if lexed.cut_off {
        return tree;
    }
    insert_missing_ends(file, text, &mut lexed.tokens, problems);
    let mut builder = Builder::new(file, text, &lexed.tokens, problems);
    builder.unclosed_reported = lexed.swallowed_end;
    let tokens = lexed.tokens.iter().map(|t| Ok((t.start, t.kind, t.end)));
    if let Err(failure) = generated::StoredParser::new().parse(&mut builder, tokens) {
        builder.syntax_error(failure, SyntaxContext::Class);
    }
    tree.within = builder.within;
    tree.classes = builder.classes;
    tree
}
