//! Conflicting prefixes: of components with components, of connectors, of redeclared elements
//! (sections 4.4.2, 7.3.3 and 9.3 of the specification).

use super::cause::element::{Closed, ElementCause, TwicePrefix};
use crate::base::diag::Diagnostic;
use crate::base::index::FastSet;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::ir::ast::{self, Causality, ClassKind, ConnectionPrefix, Variability};
use crate::ir::expr::Type;
use crate::ir::instance::{ClassId, ClassTable, Entry, EntryKind, Scope};

/// A component of a model or block has no prefix, and flows are real numbers.
pub(crate) fn check_component(
    cx: &mut ClassGraph<'_>,
    prefix: ast::TypePrefix,
    class: ClassId,
    ty: Option<Type>,
    name: ast::Ident,
) {
    let what = match prefix {
        ast::TypePrefix { connection: Some(ConnectionPrefix::Flow), .. } => "flow",
        ast::TypePrefix { connection: Some(ConnectionPrefix::Stream), .. } => "stream",
        ast::TypePrefix { causality: Some(Causality::Input), .. } => "input",
        ast::TypePrefix { causality: Some(Causality::Output), .. } => "output",
        ast::TypePrefix { variability: Some(Variability::Constant), .. } => "constant",
        ast::TypePrefix { variability: Some(Variability::Parameter), .. } => "parameter",
        ast::TypePrefix { variability: Some(Variability::Discrete), .. } => "discrete",
        _ => return,
    };
    let flow = prefix.connection.is_some();
    let wrong = match ty {
        Some(ty) => flow && ty != Type::Real,
        None => matches!(cx.kind(class), ClassKind::Model | ClassKind::Block),
    };
    let fixed = matches!(prefix.variability, Some(Variability::Constant | Variability::Parameter));
    if fixed && matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector) {
        let what = match prefix.variability {
            Some(Variability::Constant) => "constant",
            _ => "parameter",
        };
        let cause = ElementCause::FixedConnector { name: name.name, prefix: what };
        cx.report(cause, name.span);
        return;
    }
    if wrong {
        let class = cx.classes[class].full_name.to_string();
        let cause = ElementCause::ForbiddenPrefix { name: name.name, class, prefix: what };
        cx.problems.push(
            Diagnostic::new(cause, name.span)
                .note("flows are Real; models and blocks have no prefixes"),
        );
    }
}

/// A component with `flow`, `stream`, `input` or `output` has none of the same kind inside.
pub(crate) fn check_prefix_conflict(
    cx: &mut ClassGraph<'_>,
    prefix: ast::TypePrefix,
    table: &ClassTable,
    name: ast::Ident,
) {
    if prefix.connection.is_some() || prefix.causality.is_some() {
        check_prefixes_below(cx, prefix, table, name, &mut FastSet::default());
    }
}

/// As [`check_prefix_conflict`]; the classes in `seen` have been looked at: a class may contain
/// itself, which is reported elsewhere.
fn check_prefixes_below(
    cx: &mut ClassGraph<'_>,
    prefix: ast::TypePrefix,
    table: &ClassTable,
    name: ast::Ident,
    seen: &mut FastSet<ClassId>,
) {
    for entry in &table.entries {
        let EntryKind::Component(declaration) = &entry.kind else { continue };
        let clause = declaration.clause();
        let scope = Scope { instance: cx.classes[entry.class].holder, class: entry.class };
        let mut inner = clause.prefix;
        let mut below = None;
        if let Some(class) = cx.find_class(&clause.type_name, scope)
            && !cx.table_in_progress(class)
        {
            let of_type = cx.table(class);
            crate::classes::inheritance::merge_prefix(&mut inner, of_type.prefix);
            below = (of_type.scalar.is_none() && seen.insert(class)).then_some(of_type);
        }
        let twice = match () {
            () if prefix.connection.is_some() && inner.connection.is_some() => {
                TwicePrefix::Connection
            }
            () if prefix.causality.is_some() && inner.causality.is_some() => TwicePrefix::Causality,
            () => {
                if let Some(below) = below {
                    check_prefixes_below(cx, prefix, &below, name, seen);
                }
                continue;
            }
        };
        let element = entry.name;
        let cause =
            ElementCause::PrefixTwice { name: name.name, element: element.name, prefix: twice };
        cx.problems.push(
            Diagnostic::new(cause, name.span).also(element.span, "has such a prefix already"),
        );
        return;
    }
}

/// A redeclaration keeps an element final, constant, public or protected (section 7.3.3).
pub(crate) fn check_redeclared(cx: &mut ClassGraph<'_>, before: &Entry, after: &Entry) {
    let why = match () {
        () if before.element.is_final => Closed::Final,
        () if is_constant(before) => Closed::Constant,
        () if before.protected && !after.protected => Closed::BecomesPublic,
        () if !before.protected && after.protected => Closed::BecomesProtected,
        () => return,
    };
    report_closed(cx, after.name, before.name.span, why);
}

pub(crate) fn report_closed(cx: &mut ClassGraph<'_>, name: ast::Ident, before: Span, why: Closed) {
    let cause = ElementCause::ClosedElement { name: name.name, why };
    cx.problems.push(Diagnostic::new(cause, name.span).also(before, "declared here"));
}

/// Whether an element is a component that is declared `constant`.
pub(crate) fn is_constant(entry: &Entry) -> bool {
    match &entry.kind {
        EntryKind::Component(d) => d.clause().prefix.variability == Some(Variability::Constant),
        EntryKind::Class(_) => false,
    }
}
