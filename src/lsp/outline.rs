//! The outline of a text, and what can be folded in it: from its syntax tree alone.

use crate::base::diag::Problems;
use crate::base::source::{SourceMap, Span};
use crate::driver::catalogue::kind;
use crate::io::json::Json;
use crate::ir::ast::{Class, ClassBody, ElementKind, File, Variability};
use crate::parse::grammar::parse;

use super::position::Lines;

/// Kinds of symbols in the protocol.
const MODULE: usize = 2;
const CLASS: usize = 5;
const FIELD: usize = 8;
const FUNCTION: usize = 12;
const VARIABLE: usize = 13;
const CONSTANT: usize = 14;
const INTERFACE: usize = 11;

/// The syntax tree of a text that may be unfinished.
pub(super) fn tree(text: &str) -> File {
    let (mut sources, mut problems) = (SourceMap::default(), Problems::new());
    let id = sources.add("text.mo", text);
    parse(id, text, &mut problems)
}

/// The classes and components of a text, nested.
pub fn symbols(text: &str) -> Json {
    let lines = Lines::of(text);
    Json::list(tree(text).classes.iter().map(|class| of_class(class, &lines)))
}

fn of_class(class: &Class, lines: &Lines<'_>) -> Json {
    let number = match kind(class) {
        "package" => MODULE,
        "function" => FUNCTION,
        "connector" => INTERFACE,
        _ => CLASS,
    };
    let mut children = Vec::new();
    if let ClassBody::Long(composition) = &class.body {
        for element in &composition.elements {
            match &element.kind {
                ElementKind::Class(inner) => children.push(of_class(inner, lines)),
                ElementKind::Components(clause) => {
                    let number = match clause.prefix.variability {
                        Some(Variability::Parameter | Variability::Constant) => CONSTANT,
                        _ if clause.type_name.parts.len() > 1 => FIELD,
                        _ => VARIABLE,
                    };
                    for component in &clause.components {
                        let name = component.name.name.to_string();
                        let detail = clause.type_name.to_string();
                        let place = (element.span, component.name.span);
                        children.push(symbol(&name, &detail, number, place, Vec::new(), lines));
                    }
                }
                _ => {}
            }
        }
    }
    let detail = class.description.as_deref().unwrap_or_default();
    let place = (class.span, class.name.span);
    symbol(&class.name.name, detail, number, place, children, lines)
}

fn symbol(
    name: &str,
    detail: &str,
    kind: usize,
    (whole, own): (Span, Span),
    children: Vec<Json>,
    lines: &Lines<'_>,
) -> Json {
    // The protocol asks for the name within the whole.
    let (start, end) = (whole.start.min(own.start), whole.end.max(own.end));
    Json::object([
        ("name", Json::text(name)),
        ("detail", Json::text(detail)),
        ("kind", Json::count(kind)),
        ("range", lines.place((start, end))),
        ("selectionRange", lines.place((own.start, own.end))),
        ("children", Json::list(children)),
    ])
}

/// Classes, and comments of several lines.
pub fn folds(text: &str) -> Json {
    let (tree, lines) = (tree(text), Lines::of(text));
    let mut out = Vec::new();
    let mut add = |start: u32, end: u32, kind: &str| {
        let line = |at: u32| lines.line_character(at as usize).0;
        let (first, last) = (line(start), line(end));
        if last > first {
            out.push(Json::object([
                ("startLine", Json::count(first)),
                ("endLine", Json::count(last)),
                ("kind", Json::text(kind)),
            ]));
        }
    };
    let mut waiting: Vec<&Class> = tree.classes.iter().map(|class| &**class).collect();
    while let Some(class) = waiting.pop() {
        add(class.span.start, class.span.end, "region");
        if let ClassBody::Long(composition) = &class.body {
            for element in &composition.elements {
                match &element.kind {
                    ElementKind::Class(inner) => waiting.push(inner),
                    _ => add(element.span.start, element.span.end, "region"),
                }
            }
        }
    }
    // Lines of comments that follow each other are one.
    let mut open: Option<(u32, u32)> = None;
    for comment in &tree.comments {
        let joins = |end: u32| {
            let between = text.get(end as usize..comment.span.start as usize).unwrap_or("x");
            between.trim().is_empty() && between.matches('\n').count() <= 1
        };
        open = match open {
            Some((start, end)) if joins(end) => Some((start, comment.span.end)),
            Some((start, end)) => {
                add(start, end, "comment");
                Some((comment.span.start, comment.span.end))
            }
            None => Some((comment.span.start, comment.span.end)),
        };
    }
    if let Some((start, end)) = open {
        add(start, end, "comment");
    }
    Json::list(out)
}
