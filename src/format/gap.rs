//! Spaces between two tokens of a line.

use super::Item;
use crate::parse::token::Kind;

/// How many spaces stand before item `k` of a line, where `apart` stands in the text. `depth` is the number
/// of open brackets.
pub(super) fn width(line: &[Item<'_>], k: usize, apart: &str, depth: usize) -> usize {
    let written = if apart.contains('\t') { 1 } else { apart.chars().count() };
    let (left, right) = (line[k - 1], line[k]);
    match wanted(line, k, left, right, depth) {
        Gap::None => 0,
        Gap::One if written > 1 => written,
        Gap::One => 1,
        Gap::Kept => written,
        Gap::Operator(operator) => {
            // An operator has spaces on both sides or on neither; one is enough for both.
            let other = if operator == k { k + 1 } else { operator };
            let both = match line.get(other) {
                Some(item) => item.start > line[other - 1].end || written > 0,
                None => true,
            };
            if both { written.max(1) } else { 0 }
        }
    }
}

enum Gap {
    None,
    /// At least one.
    One,
    Kept,
    /// Beside the binary operator at this place.
    Operator(usize),
}

fn wanted(line: &[Item<'_>], k: usize, left: Item<'_>, right: Item<'_>, depth: usize) -> Gap {
    use Kind as K;
    let (Some(a), Some(b)) = (left.kind, right.kind) else {
        return if right.kind.is_none() || !opens(left.kind) { Gap::One } else { Gap::Kept };
    };
    match (a, b) {
        (_, K::Semicolon | K::Comma | K::RightParen) => Gap::None,
        (_, K::RightBracket | K::RightBrace) => Gap::Kept,
        (K::LeftParen, _) => Gap::None,
        (K::LeftBracket | K::LeftBrace, _) => Gap::Kept,
        (K::Comma | K::Semicolon, _) => Gap::One,
        (K::Dot, _) | (_, K::Dot) if !(b == K::Dot && starts(a)) => Gap::None,
        // A name and what it is called with; in declarations brackets may stand in columns.
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
        // A sign at the beginning of a line goes with what is above it, or stands alone.
        _ if is_operator(a) && k == 1 => Gap::Kept,
        _ if is_operator(a) => Gap::None,
        _ => Gap::One,
    }
}

fn opens(kind: Option<Kind>) -> bool {
    matches!(kind, Some(Kind::LeftParen | Kind::LeftBracket | Kind::LeftBrace))
}

fn is_operator(kind: Kind) -> bool {
    use Kind as K;
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

/// A value can end here, so that an operator after it is binary.
fn ends_value(kind: Kind) -> bool {
    use Kind as K;
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

/// A name with a dot in front may stand after these.
fn starts(kind: Kind) -> bool {
    !ends_value(kind)
}
