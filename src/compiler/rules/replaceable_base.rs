//! A base class must not be replaceable (section 7.1.4 of the specification).

use super::cause::element::ElementCause;
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::classes::ClassGraph;
use crate::classes::visibility::Visibility;
use crate::ir::ast;
use crate::ir::instance::{ClassId, Scope};

/// A base class must be one that nothing can replace.
pub(crate) fn check(cx: &mut ClassGraph<'_>, path: &ast::Path, scope: Scope) {
    let Some((first, rest)) = path.parts.split_first() else { return };
    let mut at = None;
    if !path.global {
        let mut around = Some(scope.class);
        while let Some(class) = around {
            if let Some(found) = cx.visibility(class, first.name) {
                check_not_replaceable(cx, first, found, class);
                at = cx.member_class(class, first.name, scope.instance);
                break;
            }
            around = cx.classes[class].enclosing;
        }
    }
    for part in rest {
        let Some(class) = at else { return };
        if let Some(found) = cx.visibility(class, part.name) {
            check_not_replaceable(cx, part, found, class);
        }
        let holder = cx.classes[class].holder;
        at = cx.member_class(class, part.name, holder);
    }
}

fn check_not_replaceable(
    cx: &mut ClassGraph<'_>,
    part: &ast::Ident,
    found: Visibility,
    class: ClassId,
) {
    let redeclared = replacement(cx, class, part.name);
    // A class that was redeclared without `replaceable` cannot change any more.
    if !found.replaceable || redeclared {
        return;
    }
    cx.problems.push(
        Diagnostic::new(ElementCause::ReplaceableBase { name: part.name }, part.span)
            .label("may become another class")
            .also(found.span, "declared `replaceable`"),
    );
}

/// Whether a class has been given another class for one of its names.
fn replacement(cx: &mut ClassGraph<'_>, class: ClassId, wanted: Name) -> bool {
    if cx.classes[class].redeclared.iter().any(|r| r.name == wanted) {
        return true;
    }
    if cx.table_in_progress(class) {
        return false;
    }
    let table = cx.table(class);
    let Some(entry) = table.index.get(&wanted).map(|at| &table.entries[*at]) else {
        return false;
    };
    entry.class != class && cx.classes[entry.class].redeclared.iter().any(|r| r.name == wanted)
}
