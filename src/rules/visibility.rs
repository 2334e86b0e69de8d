//! Members that may be named behind a dot: public, known through an `outer` component, present
//! (sections 4.1, 4.4.5 and 5.4 of the specification).

use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::ir::ast::{self, ClassKind};
use crate::ir::instance::InstanceId;

/// A component behind a dot must be public.
pub(crate) fn check_member(cx: &mut ClassGraph<'_>, holder: InstanceId, part: ast::Ident) {
    if cx.from_outside(part.span) {
        return;
    }
    let table = cx.table_of(holder);
    if let Some(entry) = table.index.get(&part.name).map(|at| &table.entries[*at])
        && entry.protected
    {
        cx.report_protected(part, entry.name.span);
    }
}

/// Through an `outer` component only the elements of its own class are visible.
pub(crate) fn check_outer_member(cx: &mut ClassGraph<'_>, outer: InstanceId, part: &ast::Ident) {
    let table = cx.table_of(outer);
    let expandable =
        cx.instances[outer].class.is_some_and(|c| cx.kind(c) == ClassKind::ExpandableConnector);
    if cx.instances[outer].class.is_some() && !expandable && !table.index.contains_key(&part.name) {
        cx.report_unknown_member(outer, part);
    }
}

/// Conditional components have no value (section 4.4.5).
pub(crate) fn check_conditional(cx: &mut ClassGraph<'_>, id: InstanceId, span: Span) {
    let conditional =
        cx.instances[id].declaration.as_ref().is_some_and(|d| d.component().condition.is_some());
    if conditional && !cx.from_outside(span) {
        cx.report_conditional(id, span);
    }
}
