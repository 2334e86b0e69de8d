//! Annotations of a class and of its base classes.

use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::evaluate::Evaluator;
use crate::ir::ast::{ArgumentKind, ClassBody, ElementKind, Expr, Path};
use crate::ir::expr::Const;
use crate::ir::instance::{ClassId, InstanceId, Scope};

/// One entry of an annotation, such as `StopTime = 1` in `annotation(experiment(StopTime = 1))`.
pub(super) struct Entry<'a> {
    /// Its key.
    pub key: String,
    /// Its value as written.
    pub value: &'a Expr,
    /// Where names in it are looked up.
    scope: Scope,
}

impl Entry<'_> {
    /// Its value, if it is a constant scalar.
    pub fn constant(&self, cx: &mut Evaluator<'_>) -> Option<Const> {
        let value = cx.fold(self.value, self.scope).and_then(|v| v.scalar())?;
        cx.graph.as_const(value)
    }
}

/// An item `left = right` of a text such as `"p = x, q = y"`.
pub(super) struct Pair {
    /// Before the sign.
    pub left: String,
    /// After it; empty if there is none.
    pub right: String,
    /// The text.
    pub span: Span,
}

/// The items of the entry `key` of the annotation `__mocc` of a class and of its base classes.
pub(super) fn pairs(
    cx: &mut Evaluator<'_>,
    (class, root): (ClassId, InstanceId),
    key: &str,
) -> Vec<Pair> {
    let mut found = Vec::new();
    inherited(cx, (class, root), "__mocc", &mut |cx, entries| {
        for entry in entries.iter().filter(|entry| entry.key == key) {
            let Some(Const::String(text)) = entry.constant(cx) else { continue };
            for item in items(&text) {
                let (left, right) = item.split_once('=').unwrap_or((item, ""));
                let (left, right) = (left.trim().into(), right.trim().into());
                found.push(Pair { left, right, span: entry.value.span });
            }
        }
        true
    });
    found
}

/// The parts of a text between commas that are not within the subscripts of a name.
fn items(text: &str) -> Vec<&str> {
    let mut depth = 0;
    let is_separator = |c: char| {
        depth += i32::from(c == '[') - i32::from(c == ']');
        c == ',' && depth <= 0
    };
    text.split(is_separator).map(str::trim).filter(|item| !item.is_empty()).collect()
}

/// Calls `each` with the entries of the annotation `name` of a class, then of its base classes, until it returns
/// false.
pub(super) fn inherited(
    cx: &mut Evaluator<'_>,
    (class, root): (ClassId, InstanceId),
    name: &str,
    each: &mut dyn FnMut(&mut Evaluator<'_>, Vec<Entry<'_>>) -> bool,
) {
    visit(cx, (class, root), name, 0, &mut FastSet::default(), each);
}

fn visit(
    cx: &mut Evaluator<'_>,
    (class, root): (ClassId, InstanceId),
    name: &str,
    depth: usize,
    seen: &mut FastSet<ClassId>,
    each: &mut dyn FnMut(&mut Evaluator<'_>, Vec<Entry<'_>>) -> bool,
) -> bool {
    // A base that is inherited on several paths is one.
    if !seen.insert(class) {
        return true;
    }
    let Some(text) = cx.definition(class).cloned() else { return true };
    let scope = Scope { instance: root, class };
    for arg in text.annotation.iter().flat_map(|a| &a.args) {
        let ArgumentKind::Element { path, modification: Some(inner), .. } = &arg.kind else {
            continue;
        };
        if path.to_string() != name {
            continue;
        }
        let entry = |kind| match kind {
            &ArgumentKind::Element { ref path, modification: Some(ref m), .. } => {
                let value = m.binding.as_ref()?;
                Some(Entry { key: path.to_string(), value, scope })
            }
            _ => None,
        };
        let entries = inner.args.iter().filter_map(|arg| entry(&arg.kind)).collect();
        if !each(cx, entries) {
            return false;
        }
    }
    // Cyclic inheritance is reported elsewhere.
    if depth > 50 {
        return true;
    }
    let bases: Vec<&Path> = match &text.body {
        ClassBody::Short(short) => vec![&short.base],
        ClassBody::Long(composition) => composition
            .elements
            .iter()
            .filter_map(|e| match &e.kind {
                ElementKind::Extends(extends) => Some(&extends.base),
                _ => None,
            })
            .collect(),
        _ => Vec::new(),
    };
    for base in bases {
        let scope = Scope { instance: cx.classes[class].holder, class };
        let Some(base) = cx.find_class(base, scope).filter(|b| *b != class) else { continue };
        if !visit(cx, (base, root), name, depth + 1, seen, each) {
            return false;
        }
    }
    true
}
