//! The tokens around an error: the preceding token, the start of the line, open brackets and
//! blocks.

use super::HORIZON;
use crate::parse::build::Builder;
use crate::parse::token::{Token, TokenKind};

impl Builder<'_> {
    pub(super) fn before(&self, at: usize) -> Option<&Token> {
        self.tokens.get(at.checked_sub(1)?)
    }
    /// The empty span right after the preceding token.
    pub(super) fn gap_before(&self, at: usize) -> crate::base::source::Span {
        let end = self.before(at).map_or(0, |t| t.end);
        self.span(end, end)
    }
    pub(super) fn lines_between(&self, left: &Token, right: &Token) -> bool {
        self.text(left.end, right.start).contains('\n')
    }
    /// Index of the first token of the line or statement this token belongs to.
    pub(super) fn line_start(&self, at: usize) -> usize {
        let at = at.min(self.tokens.len());
        (1..=at.min(self.tokens.len().saturating_sub(1)))
            .rev()
            .find(|&i| {
                let before = &self.tokens[i - 1];
                before.kind == TokenKind::Semicolon || self.lines_between(before, &self.tokens[i])
            })
            .unwrap_or(0)
    }
    /// True if the preceding tokens are `end A`.
    pub(super) fn ends_class(&self, at: usize) -> bool {
        at >= 2 && self.tokens[at - 2].kind == TokenKind::End
    }
    /// The innermost bracket that is open before this token.
    pub(super) fn open_bracket(&self, at: usize) -> Option<Token> {
        let mut depth = 0;
        let mut matrix = false;
        let from = at.saturating_sub(HORIZON);
        for token in self.tokens[from..at.min(self.tokens.len())].iter().rev() {
            if token.kind.closes() {
                depth += 1;
            } else if token.kind.opens() {
                if depth == 0 {
                    return (!matrix || token.kind == TokenKind::LeftBracket).then_some(*token);
                }
                depth -= 1;
            } else if token.kind.starts_section() {
                return None;
            } else if token.kind == TokenKind::Semicolon && depth == 0 {
                // Only matrices contain semicolons.
                matrix = true;
            }
        }
        None
    }
    /// Index of the keyword that opened the innermost unclosed block with this end.
    pub(super) fn open_block(&self, at: usize, end: TokenKind) -> Option<usize> {
        let opener = match end {
            TokenKind::EndIf => TokenKind::If,
            TokenKind::EndFor => TokenKind::For,
            TokenKind::EndWhen => TokenKind::When,
            _ => TokenKind::While,
        };
        let mut depth = 0;
        for i in (1..at.min(self.tokens.len())).rev().take(HORIZON) {
            let (kind, before) = (self.tokens[i].kind, self.tokens[i - 1].kind);
            let begins_line = before == TokenKind::Semicolon
                || before.starts_section()
                || matches!(before, TokenKind::Then | TokenKind::Else | TokenKind::Loop);
            if kind == end {
                depth += 1;
            } else if kind == opener && begins_line {
                if depth == 0 {
                    return Some(i);
                }
                depth -= 1;
            }
        }
        None
    }
}
