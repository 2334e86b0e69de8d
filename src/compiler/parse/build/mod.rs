//! Builds the syntax tree: the functions that grammar actions call.
//!
//! The builder also makes the checks that a context-free grammar cannot (names after `end`,
//! combinations of prefixes) and turns LALRPOP's recoveries into diagnostics.
//!
//! Nodes are passed in boxes, because every entry of the parser's stack is as large as the largest.
#![allow(clippy::boxed_local, clippy::vec_box)] // see above

pub mod class;
pub mod element;
pub mod equation;
pub mod expression;
pub mod modification;
pub mod prefix;

use std::sync::Arc;

use super::error::{NestingLimit, SyntaxContext};
use super::grammar::{ParseError, Recovery};
use super::token::{Token, TokenKind};
use crate::base::diag::{Diagnostic, Problems};
use crate::base::name::name;
use crate::base::source::{FileId, Span};
use crate::ir::ast::{Class, Ident, Path};

/// Classes and blocks of equations nested deeper than this are rejected.
pub const MAX_BLOCKS: usize = 250;

/// After this many errors in a file, further ones are not reported.
const MAX_REPORTS: usize = 200;

/// The state of one parse.
pub struct Builder<'t> {
    pub(super) file: FileId,
    pub(super) text: &'t str,
    pub(super) tokens: &'t [Token],
    pub(super) problems: &'t mut Problems,
    /// The `within` clause.
    pub within: Option<Path>,
    /// Finished top-level classes.
    pub classes: Vec<Arc<Class>>,
    /// Heads of classes not yet closed.
    open: Vec<OpenClass>,
    /// Number of open blocks of equations or statements.
    blocks: usize,
    /// Errors before this byte are consequences of an earlier one and are not reported.
    pub(super) quiet_until: u32,
    /// Number of errors found so far.
    reported: usize,
    /// An unclosed class was reported already; the end of the file is its consequence.
    pub(super) unclosed_reported: bool,
}

/// The head of a class whose `end` has not been read.
#[derive(Clone, Copy)]
struct OpenClass {
    start: u32,
    name: Ident,
}

impl<'t> Builder<'t> {
    /// A builder for the tree of `text`.
    pub fn new(
        file: FileId,
        text: &'t str,
        tokens: &'t [Token],
        problems: &'t mut Problems,
    ) -> Self {
        Builder {
            file,
            text,
            tokens,
            problems,
            within: None,
            classes: Vec::new(),
            open: Vec::new(),
            blocks: 0,
            quiet_until: 0,
            reported: 0,
            unclosed_reported: false,
        }
    }

    /// The span of the bytes `start..end`.
    pub fn span(&self, start: u32, end: u32) -> Span {
        Span { file: self.file, start, end: end.max(start) }
    }
    /// The text of `start..end`.
    pub fn text(&self, start: u32, end: u32) -> &'t str {
        self.text.get(start as usize..end as usize).unwrap_or_default()
    }
    /// An identifier.
    pub fn ident(&mut self, start: u32, end: u32) -> Ident {
        Ident { name: name(self.text(start, end)), span: self.span(start, end) }
    }
    /// `a.b.c`.
    pub fn path(&mut self, parts: Vec<Ident>) -> Path {
        let span = parts.first().map_or(Span::NONE, |p| p.span);
        let span = parts.last().map_or(span, |p| span.to(p.span));
        Path { global: false, parts, span }
    }
    /// `.a.b.c`.
    pub fn global_path(&mut self, parts: Vec<Ident>, start: u32) -> Path {
        let path = self.path(parts);
        Path { global: true, span: Span { start, ..path.span }, ..path }
    }
    /// Moves the nodes out of their boxes, which only keep the parser's stack small.
    pub fn unbox<T>(&mut self, nodes: Vec<Box<T>>) -> Vec<T> {
        nodes.into_iter().map(|node| *node).collect()
    }

    /// Counts an open block of equations or statements; returns its head unchanged.
    pub fn enter<T>(&mut self, start: u32, head: T) -> Result<T, ParseError> {
        self.blocks += 1;
        if self.blocks > MAX_BLOCKS { Err(too_deep(start)) } else { Ok(head) }
    }
    fn leave(&mut self) {
        self.blocks = self.blocks.saturating_sub(1);
    }

    /// Reports a recovered error unless it is a consequence of one already reported.
    pub fn recover(&mut self, recovery: Recovery, context: SyntaxContext) {
        self.syntax_error(recovery.error, context);
    }

    /// True if further errors will not be reported.
    pub(super) fn exhausted(&self) -> bool {
        self.reported >= MAX_REPORTS
    }
    /// Reports an error in a construct that has been parsed completely.
    pub(super) fn report(&mut self, problem: Diagnostic) {
        self.reported += 1;
        if self.reported <= MAX_REPORTS {
            self.problems.push(problem);
        }
    }

    /// The span of the first token of this kind at or after `start`.
    fn first_of(&self, kind: TokenKind, start: u32) -> Span {
        let from = self.tokens.partition_point(|t| t.start < start);
        self.tokens[from..]
            .iter()
            .find(|t| t.kind == kind)
            .map_or(self.span(start, start), |t| self.span(t.start, t.end))
    }
}

fn too_deep(start: u32) -> ParseError {
    ParseError::User { error: (start, NestingLimit::Blocks) }
}
