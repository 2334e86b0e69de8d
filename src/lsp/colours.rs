//! Semantic tokens: what each word of a text is, from its tokens.

use crate::base::diag::Problems;
use crate::base::source::SourceMap;
use crate::io::json::Json;
use crate::parse::lexer::lex;
use crate::parse::token::TokenKind;

use super::position::Lines;

/// The names of the kinds, in the order of their numbers.
pub const LEGEND: [&str; 8] =
    ["keyword", "type", "variable", "number", "string", "comment", "function", "operator"];
const KEYWORD: usize = 0;
const TYPE: usize = 1;
const VARIABLE: usize = 2;
const NUMBER: usize = 3;
const STRING: usize = 4;
const COMMENT: usize = 5;
const FUNCTION: usize = 6;
const OPERATOR: usize = 7;

/// The tokens of a text in the encoding of the protocol: five numbers for each, relative to the one before.
pub fn tokens(text: &str) -> Json {
    let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
    let id = sources.add("text.mo", text);
    let lexed = lex(id, text, &mut problems);
    let mut all: Vec<(usize, usize, usize)> = Vec::new();
    for (k, token) in lexed.tokens.iter().enumerate() {
        let next = lexed.tokens.get(k + 1).map(|t| t.kind);
        let before = k.checked_sub(1).and_then(|k| lexed.tokens.get(k)).map(|t| t.kind);
        let kind = match token.kind {
            TokenKind::Ident => word(before, next),
            TokenKind::Integer | TokenKind::Real => NUMBER,
            TokenKind::String => STRING,
            kind if kind.text().starts_with(|c: char| c.is_ascii_alphabetic()) => KEYWORD,
            kind if kind.is_operator() => OPERATOR,
            _ => continue,
        };
        all.push((token.start as usize, token.end as usize, kind));
    }
    let comments = lexed.comments.iter();
    all.extend(comments.map(|c| (c.span.start as usize, c.span.end as usize, COMMENT)));
    all.sort_unstable();
    let (mut line, mut character) = (0, 0);
    let mut data = Vec::new();
    let lines = Lines::of(text);
    for (start, end, kind) in all {
        let Some(content) = text.get(start..end) else { continue };
        let (mut at, mut column) = lines.line_character(start);
        // A token of the protocol ends with its line.
        for part in content.split('\n') {
            let length = part.trim_end_matches('\r').encode_utf16().count();
            if length > 0 {
                let shift = if at == line { column - character } else { column };
                data.extend([at - line, shift, length, kind, 0].map(Json::count));
                (line, character) = (at, column);
            }
            (at, column) = (at + 1, 0);
        }
    }
    Json::object([("data", Json::list(data))])
}

/// The kind of a name, by the tokens around it.
fn word(before: Option<TokenKind>, next: Option<TokenKind>) -> usize {
    use TokenKind::{
        Block, Class, Connector, Extends, Function, Ident, LeftParen, Model, Package, Record, Type,
    };
    match (before, next) {
        (Some(Block | Class | Connector | Model | Package | Record | Type | Extends), _) => TYPE,
        (Some(Function), _) => FUNCTION,
        // `Units.Mass m`: a name before another name is a type.
        (_, Some(Ident)) => TYPE,
        (Some(Ident), _) => VARIABLE,
        (_, Some(LeftParen)) if before != Some(TokenKind::Dot) => FUNCTION,
        _ => VARIABLE,
    }
}
