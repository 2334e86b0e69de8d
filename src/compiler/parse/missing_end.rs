//! Finds a missing `end X;` before parsing, so that one omission is one error.
//!
//! In: the tokens of a file. Out: the same tokens, with an empty `end X;` where a class must have
//! ended: a class definition cannot begin between equations. Without it, every declaration of the
//! following classes would be an error of the equation section.

use crate::base::diag::Problems;
use crate::base::name::name;
use crate::base::source::{FileId, Span};
use crate::ir::ast::Ident;

use super::error::unclosed_class;
use super::token::{Token, TokenKind};

/// A class whose `end` has not been reached.
struct Open {
    /// Index of its name.
    name: usize,
    /// Equations or statements are being listed.
    in_section: bool,
    /// Open `if`, `for`, `when` and `while`.
    blocks: usize,
}

/// Inserts the missing ends and reports them.
pub fn insert_missing_ends(
    file: FileId,
    text: &str,
    tokens: &mut Vec<Token>,
    problems: &mut Problems,
) {
    let mut open: Vec<Open> = Vec::new();
    let mut brackets = 0_usize;
    let mut i = 0;
    while i < tokens.len() {
        let kind = tokens[i].kind;
        brackets = match kind {
            _ if kind.opens() => brackets + 1,
            _ if kind.closes() => brackets.saturating_sub(1),
            _ => brackets,
        };
        let begins = i == 0
            || matches!(tokens[i - 1].kind, TokenKind::Semicolon)
            || tokens[i - 1].kind.starts_section();
        if brackets > 0 {
            i += 1;
            continue;
        }
        if begins
            && let Some(innermost) = open.last()
            && innermost.in_section
            && innermost.blocks == 0
            && let Some(class) = class_name(tokens, i)
            && is_long(tokens, class)
            && !ends_after(text, tokens, i, innermost.name)
        {
            let (of_name, before) = (tokens[innermost.name], tokens[i - 1].end);
            let ident = |token: Token| Ident {
                name: name(spelling(text, token)),
                span: Span { file, start: token.start, end: token.end },
            };
            let found = Ident {
                span: Span { file, start: tokens[i].start, end: tokens[i].end },
                ..ident(of_name)
            };
            problems.push(unclosed_class(ident(of_name), Some(found)));
            let empty = |kind| Token { kind, start: before, end: before };
            let end = [TokenKind::End, TokenKind::Ident, TokenKind::Semicolon].map(empty);
            tokens.splice(i..i, end);
            open.pop();
            i += end.len();
            continue;
        }
        track(text, tokens, i, begins, &mut open);
        i += 1;
    }
}

/// Follows the classes, sections and blocks at a token.
fn track(text: &str, tokens: &[Token], i: usize, begins: bool, open: &mut Vec<Open>) {
    use TokenKind::*;
    match tokens[i].kind {
        End => {
            // The end of a class further out ends the ones inside it as well.
            if let Some(named) = tokens.get(i + 1)
                && let Some(k) = open
                    .iter()
                    .rposition(|o| spelling(text, tokens[o.name]) == spelling(text, *named))
            {
                open.truncate(k);
            } else {
                open.pop();
            }
        }
        kind @ (Public | Protected | Equation | InitialEquation | Algorithm | InitialAlgorithm) => {
            if let Some(innermost) = open.last_mut() {
                innermost.in_section = !matches!(kind, Public | Protected);
                innermost.blocks = 0;
            }
        }
        If | For | When | While if begins => {
            if let Some(innermost) = open.last_mut() {
                innermost.blocks += 1;
            }
        }
        EndIf | EndFor | EndWhen | EndWhile => {
            if let Some(innermost) = open.last_mut() {
                innermost.blocks = innermost.blocks.saturating_sub(1);
            }
        }
        kind if is_class_keyword(kind) => {
            if let Some(class) = class_name(tokens, i)
                && is_long(tokens, class)
                && open.last().is_none_or(|o| o.name != class)
            {
                open.push(Open { name: class, in_section: false, blocks: 0 });
            }
        }
        _ => {}
    }
}

/// Index of the name of the class whose definition begins at `i`, possibly with prefixes.
fn class_name(tokens: &[Token], mut i: usize) -> Option<usize> {
    use TokenKind::*;
    while matches!(
        tokens.get(i)?.kind,
        Partial | Encapsulated | Expandable | Operator | Pure | Impure
    ) {
        i += 1;
    }
    if !is_class_keyword(tokens.get(i)?.kind) {
        return None;
    }
    let extends = usize::from(tokens.get(i + 1)?.kind == Extends);
    let class = i + 1 + extends;
    (tokens.get(class)?.kind == Ident).then_some(class)
}

/// True if the class of this name has a body.
fn is_long(tokens: &[Token], class: usize) -> bool {
    tokens.get(class + 1).is_some_and(|next| next.kind != TokenKind::Equals)
}

/// True if the class `around` ends after the class that begins at `i`, which is only misplaced.
fn ends_after(text: &str, tokens: &[Token], i: usize, around: usize) -> bool {
    let mut names: Vec<&str> = Vec::new();
    let mut last = None;
    for k in i..tokens.len() {
        if is_class_keyword(tokens[k].kind)
            && let Some(class) = class_name(tokens, k)
            && is_long(tokens, class)
            && last != Some(class)
        {
            last = Some(class);
            names.push(spelling(text, tokens[class]));
        }
        if tokens[k].kind == TokenKind::End
            && let Some(named) = tokens.get(k + 1)
        {
            let named = spelling(text, *named);
            match names.iter().rposition(|open| *open == named) {
                Some(at) => names.truncate(at),
                None => return named == spelling(text, tokens[around]),
            }
        }
    }
    false
}

fn is_class_keyword(kind: TokenKind) -> bool {
    use TokenKind::*;
    matches!(kind, Class | Model | Block | Record | Connector | Type | Package | Function)
}

fn spelling(text: &str, token: Token) -> &str {
    text.get(token.start as usize..token.end as usize).unwrap_or_default()
}
