//! The door to the parser that LALRPOP generates from `grammar/modelica.lalrpop`, and the way from
//! its errors to diagnostics.

use super::build::Builder;
use super::error::{Bound, Context, SyntaxError};
use super::lexer;
use super::token::Kind;
use crate::base::diag::Problems;
use crate::base::source::{FileId, Span};
use crate::ir::ast;

#[allow(missing_docs, unused_qualifications, clippy::all)]
#[rustfmt::skip]
mod generated {
    include!(concat!(env!("OUT_DIR"), "/modelica.rs"));
}

/// An error as LALRPOP reports it.
pub type Failure = lalrpop_util::ParseError<u32, Kind, (u32, Bound)>;
/// An error after which LALRPOP found a place to go on.
pub type Recovery = lalrpop_util::ErrorRecovery<u32, Kind, (u32, Bound)>;

/// Parses the text of a file. Never fails: what does not parse is reported and left out, or stands
/// in the tree as `Broken`.
pub fn parse(file: FileId, text: &str, problems: &mut Problems) -> ast::File {
    let mut tree = ast::File { id: file, within: None, classes: Vec::new(), comments: Vec::new() };
    if u32::try_from(text.len()).is_err() {
        problems.push(SyntaxError::FileTooLarge { span: Span::new(file, 0, 0) }.into());
        return tree;
    }
    let lexed = lexer::lex(file, text, problems);
    tree.comments = lexed.comments;
    if lexed.cut_off {
        return tree;
    }
    let mut builder = Builder::new(file, text, &lexed.tokens, problems);
    let tokens = lexed.tokens.iter().map(|t| Ok((t.start, t.kind, t.end)));
    if let Err(failure) = generated::StoredParser::new().parse(&mut builder, tokens) {
        builder.syntax_error(failure, Context::Class);
    }
    tree.within = builder.within;
    tree.classes = builder.classes;
    tree
}

impl Builder<'_> {
    /// Reports an error of the parser, unless it follows from one already reported.
    pub(super) fn syntax_error(&mut self, failure: Failure, context: Context) {
        match failure {
            Failure::UnrecognizedToken { token: (l, kind, r), expected } => {
                let _ = context;
                let span = self.span(l, r);
                self.problems.push(
                    SyntaxError::Unexpected {
                        span,
                        expected: expected.join(" "),
                        found: kind.text().into(),
                        help: None,
                    }
                    .into(),
                );
            }
            Failure::UnrecognizedEof { location, expected } => {
                let span = self.span(location, location);
                self.problems
                    .push(SyntaxError::UnexpectedEnd { span, expected: expected.join(" ") }.into());
            }
            Failure::User { error: (at, bound) } => {
                let span = self.span(at, at);
                self.problems.push(SyntaxError::TooDeep { span, bound }.into());
            }
            Failure::InvalidToken { .. } | Failure::ExtraToken { .. } => {}
        }
    }
    /// Where reading resumes after an error at `offset`.
    pub(super) fn resume_after(&self, offset: u32) -> u32 {
        let from = self.tokens.partition_point(|t| t.start < offset);
        self.tokens[from..]
            .iter()
            .find(|t| t.kind == Kind::Semicolon || t.kind.starts_section())
            .map_or(u32::MAX, |t| t.start)
    }
}
