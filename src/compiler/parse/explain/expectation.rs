//! Describes the tokens that the parser expected and the token that it found.

use super::Obstacle;
use crate::parse::build::Builder;
use crate::parse::error::SyntaxContext;
use crate::parse::token::TokenKind;

impl Builder<'_> {
    /// Describes the expected tokens by at most three alternatives.
    pub(super) fn expectation(&self, o: &Obstacle<'_>) -> String {
        let line_start = o.expects(TokenKind::End)
            || o.expects(TokenKind::EndIf)
            || o.expects(TokenKind::EndFor);
        let line_start =
            line_start || o.expects(TokenKind::EndWhen) || o.expects(TokenKind::EndWhile);
        let mut words: Vec<String> = Vec::new();
        let quoted = |k: TokenKind| format!("`{}`", k.text());
        if line_start && o.expects(TokenKind::Ident) {
            words.push(match o.context {
                SyntaxContext::Class | SyntaxContext::Element | SyntaxContext::Condition => {
                    "a declaration".into()
                }
                SyntaxContext::Equation => "an equation".into(),
                SyntaxContext::Statement => "a statement".into(),
            });
            let ends = [
                TokenKind::EndIf,
                TokenKind::EndFor,
                TokenKind::EndWhen,
                TokenKind::EndWhile,
                TokenKind::End,
            ];
            words.extend(ends.into_iter().filter(|k| o.expects(*k)).take(1).map(quoted));
            return words.join(" or ");
        }
        if o.expects(TokenKind::Model)
            && o.expects(TokenKind::Package)
            && !o.expects(TokenKind::Ident)
        {
            return "a class, such as `model` or `package`".into();
        }
        if o.expects_expression() {
            words.push("an expression".into());
        } else if o.expects(TokenKind::Ident) {
            let name = match () {
                () if o.expects(TokenKind::Each) && self.open_bracket(o.at).is_some() => {
                    "a modification"
                }
                () if o.expects(TokenKind::Parameter) => "a declaration",
                () => "a name",
            };
            words.push(name.into());
        }
        let structural = [
            TokenKind::Then,
            TokenKind::Loop,
            TokenKind::Semicolon,
            TokenKind::Assign,
            TokenKind::Equals,
            TokenKind::RightParen,
            TokenKind::RightBracket,
            TokenKind::RightBrace,
            TokenKind::In,
            TokenKind::Comma,
        ];
        let incomplete = o.context == SyntaxContext::Equation && o.expects(TokenKind::Equals)
            || o.context == SyntaxContext::Statement && o.expects(TokenKind::Assign);
        let tokens = structural.into_iter().filter(|k| o.expects(*k));
        // In an incomplete equation `=` is more helpful than `;`; mention only one of them.
        let tokens = tokens
            .filter(|k| !incomplete || *k != TokenKind::Semicolon)
            .filter(|k| {
                *k != TokenKind::Equals
                    || !matches!(o.context, SyntaxContext::Statement | SyntaxContext::Element)
            })
            .filter(|k| *k != TokenKind::Assign || o.context == SyntaxContext::Statement);
        words.extend(tokens.take(3 - words.len()).map(quoted));
        let operators = o.expects(TokenKind::Plus) && !o.expects_expression();
        if operators && words.len() < 3 && o.kind.is_some_and(starts_operand) {
            words.push("an operator".into());
        }
        if words.is_empty() {
            words.extend(o.expected.iter().take(3).map(|k| phrase(*k)));
        }
        match words.as_slice() {
            [] => "something else".into(),
            [one] => one.clone(),
            [init @ .., last] => format!("{} or {last}", init.join(", ")),
        }
    }

    /// The token as the user wrote it.
    pub(super) fn found(&self, at: usize) -> String {
        match self.tokens.get(at) {
            None => "the end of the file".into(),
            Some(t) if t.kind == TokenKind::String => "a string".into(),
            Some(t) if t.kind == TokenKind::Ident && t.end - t.start > 40 => "a name".into(),
            Some(t) => {
                let text = self.text(t.start, t.end);
                format!("`{}`", text.split_whitespace().collect::<Vec<_>>().join(" "))
            }
        }
    }
}

/// Tokens that begin an operand: an operator may be missing before them.
fn starts_operand(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::Ident
            | TokenKind::Integer
            | TokenKind::Real
            | TokenKind::LeftParen
            | TokenKind::LeftBrace
    )
}

fn phrase(kind: TokenKind) -> String {
    match kind {
        TokenKind::Ident => "a name".into(),
        TokenKind::Integer | TokenKind::Real => "a number".into(),
        TokenKind::String => "a string".into(),
        TokenKind::EndValue => "`end`".into(),
        other => format!("`{}`", other.text()),
    }
}
