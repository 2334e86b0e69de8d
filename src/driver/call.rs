//! The parentheses around a place in a text that may be unfinished: calls and modifications, by the words before them.

use super::compile::{Request, Session};
use super::target::{class_of, named, path};

use crate::base::diag::Problems;
use crate::base::source::FileId;
use crate::evaluate::Evaluator;
use crate::ir::ast::{self, Causality};
use crate::ir::instance::{ClassId, EntryKind};
use crate::parse::lexer::{Lexed, lex};
use crate::parse::token::{Token, TokenKind};

/// A parenthesis that is open at a place.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Opened {
    /// The dotted name before it; empty without one.
    pub head: Vec<String>,
    /// The name is declared here: the dotted name of its type, or of a base class. Else it is called or modified.
    pub declared: Option<Vec<String>>,
    /// Arguments before the place.
    pub arguments: usize,
    /// The first word of the argument at the place, if `=` follows it.
    pub keyword: Option<String>,
    /// The place is where an argument begins.
    pub begins: bool,
}

/// The tokens of a text that may be unfinished.
pub(super) fn tokens(text: &str) -> Lexed {
    lex(FileId(0), text, &mut Problems::new())
}

/// Whether a place is inside of a string or a comment.
pub(super) fn is_prose(lexed: &Lexed, text: &str, offset: u32) -> bool {
    let inside = |start: u32, end: u32| start < offset && offset < end;
    let string = lexed.tokens.iter().any(|t| t.kind == TokenKind::String && inside(t.start, t.end));
    let comment = lexed.comments.iter().any(|c| {
        let end = if c.block { c.span.end } else { c.span.end + 1 };
        inside(c.span.start, end)
    });
    // The quotation mark of a string that is being written has no end yet.
    let line = text[..offset as usize].rsplit('\n').next().unwrap_or_default();
    let unfinished = lexed.swallowed_end && line.matches('"').count() % 2 == 1;
    string || comment || unfinished
}

/// The parentheses that are open at a place, the outermost first.
pub(super) fn opened(lexed: &Lexed, text: &str, offset: u32) -> Vec<Opened> {
    use TokenKind::{
        Comma, Equals, Ident, LeftBrace, LeftBracket, LeftParen, RightBrace, RightBracket,
        RightParen, Semicolon,
    };
    // Brackets and braces are open, too, but have no name.
    let mut open: Vec<Option<Opened>> = Vec::new();
    // A word that ends at the place is being written.
    let is_done = |t: &&Token| t.end < offset || t.end == offset && t.kind != Ident;
    let before: Vec<Token> = lexed.tokens.iter().filter(is_done).copied().collect();
    for (k, token) in before.iter().enumerate() {
        let is_last = k + 1 == before.len();
        if let Some(Some(own)) = open.last_mut() {
            own.begins = false;
            if token.kind == Equals && own.keyword.is_none() {
                let word = k.checked_sub(1).map(|k| before[k]).filter(|t| t.kind == Ident);
                own.keyword = word.map(|t| text[t.start as usize..t.end as usize].to_owned());
            }
        }
        match token.kind {
            LeftParen => {
                let (head, declared) = head(&before[..k], text);
                let (arguments, keyword) = (0, None);
                open.push(Some(Opened { head, declared, arguments, keyword, begins: is_last }));
            }
            LeftBrace | LeftBracket => open.push(None),
            RightParen | RightBrace | RightBracket => _ = open.pop(),
            Comma => {
                if let Some(Some(own)) = open.last_mut() {
                    own.arguments += 1;
                    own.keyword = None;
                    own.begins = is_last;
                }
            }
            Semicolon => open.clear(),
            _ => {}
        }
    }
    match open.last() {
        // The place is inside of a matrix or an array.
        Some(None) => Vec::new(),
        _ => open.into_iter().flatten().collect(),
    }
}

/// The dotted name at the end of some tokens, and that of the type before it.
fn head(tokens: &[Token], text: &str) -> (Vec<String>, Option<Vec<String>>) {
    let (head, rest) = dotted(tokens, text);
    if head.is_empty() {
        return (head, None);
    }
    let (base, _) = dotted(rest, text);
    if !base.is_empty() {
        return (head, Some(base));
    }
    let kind = |k: usize| rest.len().checked_sub(k).and_then(|k| rest.get(k)).map(|t| t.kind);
    // `extends Base(`, `type Mass = Real(`, `redeclare model M = N(`.
    let is_short = kind(1) == Some(TokenKind::Equals)
        && kind(2) == Some(TokenKind::Ident)
        && kind(3).is_some_and(is_class_keyword);
    let is_base = matches!(kind(1), Some(TokenKind::Extends | TokenKind::ConstrainedBy));
    let declared = (is_short || is_base).then(|| head.clone());
    (head, declared)
}

fn is_class_keyword(kind: TokenKind) -> bool {
    use TokenKind::{Block, Class, Connector, Function, Model, Package, Record, Type};
    matches!(kind, Block | Class | Connector | Function | Model | Package | Record | Type)
}

/// The dotted name at the end of some tokens, without subscripts, and the tokens before it.
fn dotted<'t>(tokens: &'t [Token], text: &str) -> (Vec<String>, &'t [Token]) {
    let mut end = tokens.len();
    let mut parts = Vec::new();
    loop {
        // Subscripts.
        if end > 0 && tokens[end - 1].kind == TokenKind::RightBracket {
            let mut depth = 0;
            let start = tokens[..end].iter().rposition(|t| {
                match t.kind {
                    TokenKind::RightBracket => depth += 1,
                    TokenKind::LeftBracket => depth -= 1,
                    _ => {}
                }
                depth == 0
            });
            end = start.unwrap_or(0);
        }
        let Some(last) = tokens[..end].last().filter(|t| t.kind == TokenKind::Ident) else { break };
        parts.insert(0, text[last.start as usize..last.end as usize].to_owned());
        end -= 1;
        match tokens[..end].last() {
            Some(dot) if dot.kind == TokenKind::Dot => end -= 1,
            _ => break,
        }
    }
    (parts, &tokens[..end])
}

/// The class whose elements are modified at a place.
pub(super) fn modified(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    offset: u32,
    opened: &[Opened],
) -> Option<ClassId> {
    let first = opened.iter().rposition(|one| one.declared.is_some())?;
    let base = opened[first].declared.clone()?;
    let mut class = match named(cx, file, offset, &base) {
        Some(target) => class_of(cx, &target),
        None => predefined(cx, &base),
    }?;
    for inner in &opened[first + 1..] {
        let target = path(cx, class, &inner.head, false)?;
        class = class_of(cx, &target)?;
    }
    Some(class)
}

/// `Real` and the other types of the language.
fn predefined(cx: &Evaluator<'_>, parts: &[String]) -> Option<ClassId> {
    let [only] = parts else { return None };
    cx.predefined.get(&crate::base::name::name(only)).copied()
}

/// The function or record that is called at a place.
pub(super) fn called(
    cx: &mut Evaluator<'_>,
    file: &ast::File,
    offset: u32,
    opened: &[Opened],
) -> Option<ClassId> {
    let own = opened.last().filter(|own| own.declared.is_none() && !own.head.is_empty())?;
    let target = named(cx, file, offset, &own.head)?;
    class_of(cx, &target)
}

/// An argument of a function, or a field of a record.
#[derive(Clone, PartialEq, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its type, and its value if it may be left out.
    pub text: String,
    /// Its description string; may be empty.
    pub description: String,
}

/// A function that is called at a place.
#[derive(Clone, PartialEq, Debug)]
pub struct Signature {
    /// Its name.
    pub name: String,
    /// Its description string; may be empty.
    pub description: String,
    /// Its arguments.
    pub parameters: Vec<Parameter>,
    /// The position of the argument at the place.
    pub active: usize,
}

/// The arguments of a function, or the fields of a record.
pub(super) fn parameters(cx: &mut Evaluator<'_>, class: ClassId) -> Vec<Parameter> {
    let is_function = matches!(cx.kind(class), ast::ClassKind::Function { .. });
    let table = cx.table(class);
    let mut out = Vec::new();
    for entry in table.entries.iter().filter(|entry| !entry.protected) {
        let EntryKind::Component(declaration) = &entry.kind else { continue };
        let (clause, component) = (declaration.clause(), declaration.component());
        if is_function && clause.prefix.causality != Some(Causality::Input) {
            continue;
        }
        let value = component.modification.as_ref().and_then(|m| m.binding.clone());
        let value = value.and_then(|e| cx.sources.text(e.span).map(str::to_owned));
        let name = component.name.name.to_string();
        let text = match value {
            Some(value) => format!("{} {name} = {value}", clause.type_name),
            None => format!("{} {name}", clause.type_name),
        };
        let description = component.description.as_deref().unwrap_or_default().to_owned();
        out.push(Parameter { name, text, description });
    }
    out
}

impl Session {
    /// The function that is called around `offset`.
    pub fn signature(&mut self, request: &Request, offset: u32) -> Option<Signature> {
        let found = self.with_text(request, |cx, file, text| {
            let lexed = tokens(text);
            let all = opened(&lexed, text, offset);
            // Parentheses in an argument have no name: `f((a + b|`.
            let named = all.iter().rposition(|one| !one.head.is_empty())?;
            let own = &all[named];
            let class = called(cx, file, offset, &all[..=named])?;
            if !matches!(cx.kind(class), ast::ClassKind::Function { .. } | ast::ClassKind::Record) {
                return None;
            }
            let parameters = parameters(cx, class);
            let by_name =
                own.keyword.as_ref().and_then(|k| parameters.iter().position(|p| p.name == *k));
            let text = cx.definition(class).cloned()?;
            Some(Signature {
                name: own.head.join("."),
                description: text.description.as_deref().unwrap_or_default().to_owned(),
                active: by_name.unwrap_or(own.arguments),
                parameters,
            })
        });
        found.flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Vec<Opened> {
        let offset = text.find('|').unwrap();
        let text = text.replacen('|', "", 1);
        opened(&tokens(&text), &text, offset as u32)
    }

    #[test]
    fn open_parentheses_are_named_by_the_words_before_them() {
        let all = at("model M\n A.Body b[3](mass = 1, x(|\nend M;");
        assert_eq!((all[0].head.join("."), all[0].arguments), ("b".to_owned(), 1));
        assert_eq!(all[0].declared.as_ref().unwrap().join("."), "A.Body");
        assert!(all[1].begins && all[1].declared.is_none());
        let all = at("equation y = f(a, u = 1 + |");
        assert_eq!(
            (all[0].keyword.as_deref(), all[0].arguments, all[0].begins),
            (Some("u"), 1, false)
        );
        assert_eq!(all[0].declared, None);
        assert!(at("y = f(1, ma|")[0].begins);
        assert_eq!(at("y = f(1); |"), []);
        assert!(at("extends Base(|")[0].declared.is_some());
        assert!(at("type T = Real(|")[0].declared.is_some());
    }

    #[test]
    fn strings_and_comments_are_prose() {
        let of = |text: &str| {
            let offset = text.find('|').unwrap() as u32;
            let text = text.replacen('|', "", 1);
            is_prose(&tokens(&text), &text, offset)
        };
        assert!(of("Real x(unit=\"|\");") && of("// a|") && of("/* a| */") && of("x = \"a|"));
        assert!(!of("Real x|; // a") && !of("x = \"a\"| + y"));
    }
}
