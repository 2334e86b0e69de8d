//! Members that may be named behind a dot: public, known through an `outer` component, present
//! (sections 4.1, 4.4.5 and 5.4 of the specification).

use crate::base::diag::Severity;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::ir::ast::{self, ClassKind};
use crate::ir::instance::{InstanceId, Scope};

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

/// Conditional components have no value (section 4.4.5). That of another component, or that of a base class, is only
/// warned of: libraries read it where its condition holds.
pub(crate) fn check_conditional(
    cx: &mut ClassGraph<'_>,
    id: InstanceId,
    reader: Scope,
    span: Span,
) {
    let conditional =
        cx.instances[id].declaration.as_ref().is_some_and(|d| d.component().condition.is_some());
    if conditional && !cx.from_outside(span) {
        let instance = &cx.instances[id];
        let is_own =
            instance.parent == Some(reader.instance) && instance.scope.class == reader.class;
        cx.report_conditional(id, span, if is_own { Severity::Error } else { Severity::Warning });
    }
}
