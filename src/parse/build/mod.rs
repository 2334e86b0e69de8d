//! Builds the syntax tree: the functions that grammar actions call.
//!
//! The builder also checks what a context-free grammar can not (names after `end`, which prefixes
//! stand together) and turns LALRPOP's recoveries into diagnostics.
//!
//! Nodes come and go in boxes: every entry of the parser's stack is as large as the largest of them.
#![allow(clippy::boxed_local, clippy::vec_box)] // see above

pub mod class;
pub mod equation;
pub mod expression;

use std::sync::Arc;

use super::error::{Bound, Context, SyntaxError};
use super::grammar::{Failure, Recovery};
use super::token::{Kind, Token};
use crate::base::diag::Problems;
use crate::base::name::name;
use crate::base::source::{FileId, Span};
use crate::ir::ast::{Class, Ident, Path};

/// Classes and blocks of equations nested deeper than this are refused.
pub const MAX_BLOCKS: usize = 250;

/// After this many errors in a file, the rest is not worth reading.
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
    /// Starts of blocks of equations or statements not yet closed.
    blocks: usize,
    /// Consequences of an error, up to this byte, are not reported.
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
    /// Ready to build the tree of `text`.
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

    /// The bytes `start..end`.
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
    /// Moves the nodes out of their boxes, which only keep the parser's stack narrow.
    pub fn unbox<T>(&mut self, nodes: Vec<Box<T>>) -> Vec<T> {
        nodes.into_iter().map(|node| *node).collect()
    }

    /// Counts a block of equations or statements; passes its head on.
    pub fn enter<T>(&mut self, start: u32, head: T) -> Result<T, Failure> {
        self.blocks += 1;
        if self.blocks > MAX_BLOCKS { Err(too_deep(start)) } else { Ok(head) }
    }
    fn leave(&mut self) {
        self.blocks = self.blocks.saturating_sub(1);
    }

    /// Reports a recovered error, unless it follows from one already reported.
    pub fn recover(&mut self, recovery: Recovery, context: Context) {
        self.syntax_error(recovery.error, context);
    }

    /// True if further errors will not be reported.
    pub(super) fn exhausted(&self) -> bool {
        self.reported >= MAX_REPORTS
    }
    /// Reports what is wrong with a construct that has been read completely.
    pub(super) fn report(&mut self, error: SyntaxError) {
        self.reported += 1;
        if self.reported <= MAX_REPORTS {
            self.problems.push(error.into());
        }
    }

    /// The span of the first token of this kind at or after `start`.
    fn first_of(&self, kind: Kind, start: u32) -> Span {
        let from = self.tokens.partition_point(|t| t.start < start);
        self.tokens[from..]
            .iter()
            .find(|t| t.kind == kind)
            .map_or(self.span(start, start), |t| self.span(t.start, t.end))
    }
}

fn too_deep(start: u32) -> Failure {
    Failure::User { error: (start, Bound::Blocks) }
}
