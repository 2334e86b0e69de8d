//! Prefixes of classes, components and modification arguments: their order and combinations.

use super::Builder;
use crate::base::diag::Diagnostic;
use crate::ir::ast::{Causality, ConnectionPrefix, TypePrefix, Variability};
use crate::parse::error::SyntaxCause;
use crate::parse::token::TokenKind;

/// The prefix keywords, in the order in which they must be written.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[allow(missing_docs)]
pub enum Prefix {
    Redeclare,
    Each,
    Final,
    Inner,
    Outer,
    Replaceable,
    Encapsulated,
    Partial,
    Flow,
    Stream,
    Discrete,
    Parameter,
    Constant,
    Input,
    Output,
}

impl Prefix {
    const ALL: [(Prefix, TokenKind); 15] = [
        (Prefix::Redeclare, TokenKind::Redeclare),
        (Prefix::Each, TokenKind::Each),
        (Prefix::Final, TokenKind::Final),
        (Prefix::Inner, TokenKind::Inner),
        (Prefix::Outer, TokenKind::Outer),
        (Prefix::Replaceable, TokenKind::Replaceable),
        (Prefix::Encapsulated, TokenKind::Encapsulated),
        (Prefix::Partial, TokenKind::Partial),
        (Prefix::Flow, TokenKind::Flow),
        (Prefix::Stream, TokenKind::Stream),
        (Prefix::Discrete, TokenKind::Discrete),
        (Prefix::Parameter, TokenKind::Parameter),
        (Prefix::Constant, TokenKind::Constant),
        (Prefix::Input, TokenKind::Input),
        (Prefix::Output, TokenKind::Output),
    ];
    /// The position of a prefix in the required order; prefixes of equal rank exclude each other.
    fn rank(self) -> u8 {
        match self {
            Prefix::Flow | Prefix::Stream => 8,
            Prefix::Discrete | Prefix::Parameter | Prefix::Constant => 9,
            Prefix::Input | Prefix::Output => 10,
            other => other as u8,
        }
    }
}

/// Prefixes of an element or modification argument.
#[derive(Clone, Copy, Debug)]
pub struct Prefixes {
    pub(super) start: u32,
    set: u32,
    last: Option<Prefix>,
}

pub(super) const ELEMENT: &[Prefix] =
    &[Prefix::Redeclare, Prefix::Final, Prefix::Inner, Prefix::Outer, Prefix::Replaceable];
pub(super) const ARGUMENT: &[Prefix] =
    &[Prefix::Redeclare, Prefix::Each, Prefix::Final, Prefix::Replaceable];
pub(super) const CLASS: &[Prefix] = &[Prefix::Encapsulated, Prefix::Partial];
pub(super) const TYPE: &[Prefix] = &[
    Prefix::Flow,
    Prefix::Stream,
    Prefix::Discrete,
    Prefix::Parameter,
    Prefix::Constant,
    Prefix::Input,
    Prefix::Output,
];

impl Prefixes {
    /// An empty list at the position where prefixes would start.
    pub fn at(start: u32) -> Self {
        Prefixes { start, set: 0, last: None }
    }
    /// The start of the first prefix or, without prefixes, of the next token.
    pub fn start(self) -> u32 {
        self.start
    }
    pub(super) fn has(self, prefix: Prefix) -> bool {
        self.set & (1 << prefix as u32) != 0
    }
    pub(super) fn type_prefix(self) -> TypePrefix {
        let first = |list: &[Prefix]| list.iter().copied().find(|p| self.has(*p));
        TypePrefix {
            connection: first(&[Prefix::Flow, Prefix::Stream]).map(|p| match p {
                Prefix::Flow => ConnectionPrefix::Flow,
                _ => ConnectionPrefix::Stream,
            }),
            variability: first(&[Prefix::Discrete, Prefix::Parameter, Prefix::Constant]).map(|p| {
                match p {
                    Prefix::Discrete => Variability::Discrete,
                    Prefix::Parameter => Variability::Parameter,
                    _ => Variability::Constant,
                }
            }),
            causality: first(&[Prefix::Input, Prefix::Output]).map(|p| match p {
                Prefix::Input => Causality::Input,
                _ => Causality::Output,
            }),
        }
    }
}

impl Prefix {
    fn text(prefix: Prefix) -> &'static str {
        Prefix::ALL[prefix as usize].1.text()
    }
}

impl Builder<'_> {
    /// Adds a prefix; reports it if it is duplicated or out of order.
    pub fn prefix(&mut self, mut list: Prefixes, prefix: Prefix, start: u32, end: u32) -> Prefixes {
        let span = self.span(start, end);
        if let Some(last) = list.last {
            let cause = if list.has(prefix) {
                Some(SyntaxCause::DuplicatePrefix { prefix: Prefix::text(prefix) })
            } else if prefix.rank() == last.rank() {
                let (prefix, other) = (Prefix::text(prefix), Prefix::text(last));
                Some(SyntaxCause::ExclusivePrefixes { prefix, other })
            } else if prefix.rank() < last.rank() {
                let (prefix, later) = (Prefix::text(prefix), Prefix::text(last));
                Some(SyntaxCause::PrefixOrder { prefix, later })
            } else {
                None
            };
            cause.into_iter().for_each(|cause| self.report(Diagnostic::new(cause, span)));
        }
        list.set |= 1 << prefix as u32;
        list.last = Some(prefix);
        list
    }
    /// Reports prefixes that do not belong to an element of this kind.
    pub(super) fn allow(
        &mut self,
        prefixes: Prefixes,
        allowed: &[&[Prefix]],
        element: &'static str,
    ) {
        for (prefix, kind) in Prefix::ALL {
            if prefixes.has(prefix) && !allowed.iter().any(|list| list.contains(&prefix)) {
                let span = self.first_of(kind, prefixes.start);
                let cause = SyntaxCause::MisplacedPrefix { prefix: kind.text(), element };
                self.report(Diagnostic::new(cause, span));
            }
        }
    }
}
