//! The annotations `__mocc` of a source as tables, with the places of their values.
//!
//! `key(...)` is a table, `key = 1` a number, `key = {1, 2}` a list. An expression other than a literal is its source, as a
//! string.

use std::path::Path;

use crate::base::diag::Problems;
use crate::base::document::{Entry, Table, Value, ValueKind};
use crate::base::source::{SourceMap, Span};
use crate::ir::ast::{
    Argument, ArgumentKind, Class, ClassBody, ElementKind, Expr, ExprKind, Modification, UnaryOp,
};
use crate::parse::grammar::parse;

/// The annotations of the classes of a source, in its order, each with the name of its class there; and the errors of
/// syntax.
pub fn of_file(
    path: &Path,
    text: &str,
    sources: &mut SourceMap,
) -> (Vec<(String, Table)>, Problems) {
    let mut problems = Problems::new();
    let id = sources.add(path, text);
    let file = parse(id, text, &mut problems);
    let mut out = Vec::new();
    for class in &file.classes {
        collect(class, "", text, &mut out);
    }
    (out, problems)
}

fn collect(class: &Class, around: &str, text: &str, out: &mut Vec<(String, Table)>) {
    let name = &class.name.name;
    let full = if around.is_empty() { name.to_string() } else { format!("{around}.{name}") };
    let arguments = class.annotation.iter().flat_map(|annotation| &annotation.args);
    for (key, modification) in arguments.filter_map(modified) {
        if key == "__mocc" {
            out.push((full.clone(), table(modification, text)));
        }
    }
    if let ClassBody::Long(composition) = &class.body {
        for element in &composition.elements {
            if let ElementKind::Class(inner) = &element.kind {
                collect(inner, &full, text, out);
            }
        }
    }
}

/// The name and modification of an argument.
fn modified(argument: &Argument) -> Option<(String, &Modification)> {
    match &argument.kind {
        ArgumentKind::Element { path, modification: Some(m), .. } => Some((path.to_string(), m)),
        _ => None,
    }
}

fn table(modification: &Modification, text: &str) -> Table {
    let entry = |argument: &Argument| {
        let ArgumentKind::Element { path, modification, .. } = &argument.kind else { return None };
        let value = match modification.as_deref() {
            Some(Modification { binding: Some(e), .. }) => value(e, text),
            Some(m) => Value { kind: ValueKind::Table(table(m, text)), span: m.span },
            None => Value { kind: ValueKind::Other, span: argument.span },
        };
        Some(Entry { key: key(&path.to_string()), key_span: path.span, value })
    };
    Table { entries: modification.args.iter().filter_map(entry).collect(), span: modification.span }
}

/// A name, without the quotes of a quoted identifier.
fn key(name: &str) -> String {
    let inside = name.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\''));
    inside.filter(|inside| !inside.contains('\'')).unwrap_or(name).to_owned()
}

fn value(expression: &Expr, text: &str) -> Value {
    let written = |span: Span| text.get(span.start as usize..span.end as usize).unwrap_or_default();
    let kind = match &expression.kind {
        ExprKind::String(string) => ValueKind::Text(string.to_string()),
        ExprKind::Boolean(flag) => ValueKind::Flag(*flag),
        ExprKind::Real(_) | ExprKind::Integer(_) => {
            ValueKind::Number(written(expression.span).to_owned())
        }
        ExprKind::Unary(UnaryOp::Minus, inner)
            if matches!(inner.kind, ExprKind::Real(_) | ExprKind::Integer(_)) =>
        {
            ValueKind::Number(format!("-{}", written(inner.span)))
        }
        ExprKind::Array(items) => {
            ValueKind::List(items.iter().map(|item| value(item, text)).collect())
        }
        _ => ValueKind::Text(written(expression.span).to_owned()),
    };
    Value { kind, span: expression.span }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn annotations_become_tables() {
        let text = "package P\n  model A\n    annotation(Icon(), __mocc(tests('a b'(set(s.m = -2, k = {1, 2.5}), \
                    flat = true, is = \"x\", other = Media.Air))));\n  end A;\nend P;\n";
        let (found, problems) = of_file(Path::new("p.mo"), text, &mut SourceMap::default());
        assert!(problems.is_empty());
        let [(class, table)] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!(class, "P.A");
        let tests = table.section().get("tests").and_then(|t| t.section()).expect("tests");
        let test = tests.get("a b").and_then(|t| t.section()).expect("a test");
        let set = test.get("set").and_then(|t| t.section()).expect("settings");
        assert_eq!(set.get("s.m").and_then(|m| m.number()), Some(-2.0));
        let list = set.get("k").and_then(|k| k.list()).expect("a list");
        let numbers: Vec<_> = list.iter().map(|item| item.number()).collect();
        assert_eq!(numbers, [Some(1.0), Some(2.5)]);
        assert_eq!(test.get("flat").and_then(|f| f.flag()), Some(true));
        assert_eq!(test.get("is").and_then(|f| f.text()).as_deref(), Some("x"));
        assert_eq!(test.get("other").and_then(|f| f.text()).as_deref(), Some("Media.Air"));
    }
}
