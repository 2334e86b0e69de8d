//! Spacing between two tokens of a line.

use super::Item;
use crate::parse::token::TokenKind;

/// Number of spaces before item `k` of a line, given the whitespace `original` in the source.
/// `depth` is the number of open brackets.
pub(super) fn width(line: &[Item<'_>], k: usize, original: &str, depth: usize) -> usize {
    let written = if original.contains('\t') { 1 } else { original.chars().count() };
    let (left, right) = (line[k - 1], line[k]);
    match rule(line, k, left, right, depth) {
        Gap::None => 0,
        Gap::One if written > 1 => written,
        Gap::One => 1,
        Gap::Kept => written,
        Gap::Operator(operator) => {
            // An operator has spaces on both sides or on neither; a space on one side implies both.
            let other = if operator == k { k + 1 } else { operator };
            let both = match line.get(other) {
                Some(item) => item.start > line[other - 1].end || written > 0,
                None => true,
            };
            if both { written.max(1) } else { 0 }
        }
    }
}

/// The spacing rule between two tokens.
enum Gap {
    None,
    /// At least one space.
    One,
    /// The spaces of the source.
    Kept,
    /// Adjacent to the binary operator at this index.
    Operator(usize),
}

fn rule(line: &[Item<'_>], k: usize, left: Item<'_>, right: Item<'_>, depth: usize) -> Gap {
    use TokenKind as K;
    let (Some(a), Some(b)) = (left.kind, right.kind) else {
        return if right.kind.is_none() || !opens(left.kind) { Gap::One } else { Gap::Kept };
    };
    match (a, b) {
        (_, K::Semicolon | K::Comma | K::RightParen) => Gap::None,
        (_, K::RightBracket | K::RightBrace) => Gap::Kept,
        (K::LeftParen, _) => Gap::None,
        (K::LeftBracket | K::LeftBrace, _) => Gap::Kept,
        (K::Comma | K::Semicolon, _) => Gap::One,
        (K::Dot, _) | (_, K::Dot) if !(b == K::Dot && precedes_global_name(a)) => Gap::None,
        // A name and its arguments; in declarations brackets may be aligned in columns.
        (K::Ident | K::RightBracket | K::RightParen, K::LeftParen | K::LeftBracket)
            if depth == 0 =>
        {
            Gap::Kept
        }
        (K::Ident | K::RightBracket | K::RightParen, K::LeftParen | K::LeftBracket) => Gap::None,
        (
            K::Der
            | K::Connect
            | K::Annotation
            | K::Initial
            | K::Pure
            | K::Enumeration
            | K::Operator,
            K::LeftParen,
        ) => Gap::None,
        (K::Colon, _) | (_, K::Colon) => Gap::Kept,
        _ if is_operator(b) && ends_value(a) => Gap::Operator(k),
        _ if is_operator(a) && k >= 2 && line[k - 2].kind.is_some_and(ends_value) => {
            Gap::Operator(k - 1)
        }
        // A sign at the beginning of a line may be aligned with the line above it.
        _ if is_operator(a) && k == 1 => Gap::Kept,
        _ if is_operator(a) => Gap::None,
        _ => Gap::One,
    }
}

fn opens(kind: Option<TokenKind>) -> bool {
    matches!(kind, Some(TokenKind::LeftParen | TokenKind::LeftBracket | TokenKind::LeftBrace))
}

fn is_operator(kind: TokenKind) -> bool {
    use TokenKind as K;
    matches!(
        kind,
        K::Plus
            | K::Minus
            | K::Star
            | K::Slash
            | K::Caret
            | K::DotPlus
            | K::DotMinus
            | K::DotStar
            | K::DotSlash
            | K::DotCaret
    )
}

/// True if a value can end with this token, so that an operator after it is binary.
fn ends_value(kind: TokenKind) -> bool {
    use TokenKind as K;
    matches!(
        kind,
        K::Ident
            | K::Integer
            | K::Real
            | K::String
            | K::RightParen
            | K::RightBracket
            | K::RightBrace
            | K::EndValue
            | K::True
            | K::False
    )
}

/// True if a global name, with a leading dot, can follow this token.
fn precedes_global_name(kind: TokenKind) -> bool {
    !ends_value(kind)
}
