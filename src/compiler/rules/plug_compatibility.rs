//! Redeclarations and plug-compatibility (sections 6.4, 7.3.2 and 7.3.3 of the specification).
//!
//! Only a `replaceable` element can get another type, which must be plug-compatible with the
//! constraining class: the class behind `constrainedby`, or else the one that is replaced. Names
//! and kinds of public elements and predefined types are compared; sizes and prefixes of elements
//! are checked where they are used.

use std::rc::Rc;

use super::cause::element::{Closed, ElementCause};
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::classes::cause::Incompatibility;
use crate::ir::ast::{self, ClassBody, ElementKind};
use crate::ir::instance::{ClassId, ClassTable, Entry, EntryKind, InstanceId, Scope};
use crate::ir::modification::{Layer, LayerSource};

/// A redeclaration of one element.
struct Replacement {
    element: Rc<ast::Element>,
    /// Where its type is looked up.
    scope: Scope,
    span: Span,
}

/// Checks all redeclarations in the modifications of an instance; false after an error.
pub(crate) fn check_redeclarations(
    cx: &mut ClassGraph<'_>,
    id: InstanceId,
    table: &ClassTable,
) -> bool {
    let mut fit = true;
    for entry in &table.entries {
        let found = replacements(cx, id, entry);
        if !found.is_empty() {
            fit &= is_compatible(cx, id, entry, &found);
        }
        if entry.element.replaceable.as_ref().is_some_and(|r| r.constraint.is_some()) {
            check_own_constraint(cx, id, entry);
        }
    }
    fit
}

/// The redeclarations of an element, outermost first: one per modification, since a second one is
/// an error of its definition.
fn replacements(cx: &ClassGraph<'_>, id: InstanceId, entry: &Entry) -> Vec<Replacement> {
    let inherited = entry.layers.iter().map(|(m, class)| Layer {
        source: LayerSource::Whole(m.clone()),
        scope: cx.modification_scope(*class, id),
        subscripts: Rc::from([]),
    });
    let mut found = Vec::new();
    for layer in cx.instances[id].layers.iter().cloned().chain(inherited) {
        let first = layer.redeclarations().find_map(|(element, _)| {
            let names = element.names();
            let (_, span) = names.iter().find(|(name, _)| *name == entry.name.name)?;
            Some((element, *span))
        });
        if let Some((element, span)) = first {
            let element = Rc::new((**element).clone());
            found.push(Replacement { element, scope: layer.scope, span });
        }
    }
    found
}

/// A replaceable element must be plug-compatible with its own constraining class; reported once per
/// definition.
fn check_own_constraint(cx: &mut ClassGraph<'_>, id: InstanceId, entry: &Entry) {
    let Some(path) = entry.element.replaceable.as_ref().and_then(|r| r.constraint.clone()) else {
        return;
    };
    if !cx.checked_constraints.insert(entry.name.span) {
        return;
    }
    let own = Scope { instance: id, class: entry.class };
    let Some(wanted) = cx.find_class(&path, own) else { return };
    let Some(given) = original(cx, id, entry) else { return };
    if let Some(why) = incompatibility_with(cx, wanted, given, own_rank(entry)) {
        let text = entry.name.name;
        let cause = ElementCause::IncompatibleDefault { name: text, why };
        cx.problems
            .push(Diagnostic::new(cause, entry.name.span).also(path.span, "the constraining type"));
    }
}

/// Names of a class that are followed.
const MOST_RENAMINGS: usize = 20;

/// Whether the outermost redeclaration names the same class as the next one, such as those of a
/// component and of its constraining clause, both of which hold (section 7.3.2).
fn repeats(cx: &mut ClassGraph<'_>, id: InstanceId, text: Name, found: &[Replacement]) -> bool {
    let [outer, inner, ..] = found else { return false };
    let both = [outer, inner].map(|r| match &r.element.kind {
        ElementKind::Class(class) => match &class.body {
            ClassBody::Short(short) if short.modification.is_none() => {
                cx.find_class(&short.base, r.scope)
            }
            _ => None,
        },
        _ => replaced(cx, id, text, r),
    });
    let [Some(a), Some(b)] = both else { return false };
    let (a, b) = (without_renaming(cx, a), without_renaming(cx, b));
    is_same(cx, a, b)
}

/// The class that another one is a mere name of: `package Medium = Water` is `Water`.
fn without_renaming(cx: &mut ClassGraph<'_>, mut class: ClassId) -> ClassId {
    for _ in 0..MOST_RENAMINGS {
        let is_renaming = cx.definition(class).is_some_and(|text| match &text.body {
            ClassBody::Short(short) => short.modification.is_none(),
            _ => false,
        });
        if !is_renaming || cx.table_in_progress(class) {
            break;
        }
        let table = cx.table(class);
        match table.bases.first().filter(|_| table.dims.is_empty()) {
            Some(base) => class = *base,
            None => break,
        }
    }
    class
}

fn is_compatible(
    cx: &mut ClassGraph<'_>,
    id: InstanceId,
    entry: &Entry,
    found: &[Replacement],
) -> bool {
    let text = entry.name.name;
    let own = Scope { instance: id, class: entry.class };
    let Some(outermost) = found.first() else { return true };
    let (Some(before), Some(after)) = (original(cx, id, entry), replaced(cx, id, text, outermost))
    else {
        return true;
    };
    // The type that it has already may always be written again.
    if !is_same(cx, before, after) {
        let inner = found.iter().skip(1).map(|r| (&r.element, r.span));
        let replacements: Vec<_> = inner.chain([(&entry.element, entry.name.span)]).collect();
        for (k, (replacement, (element, span))) in found.iter().zip(replacements).enumerate() {
            if element.replaceable.is_none() && !repeats(cx, id, text, &found[k..]) {
                cx.report_not_replaceable(text, replacement.span, span);
                return false;
            }
        }
    }
    let closed = match () {
        () if entry.element.is_final => Some(Closed::Final),
        () if super::prefix::is_constant(entry) => Some(Closed::Constant),
        () => None,
    };
    if let Some(why) = closed {
        let name = ast::Ident { name: text, span: outermost.span };
        super::prefix::report_closed(cx, name, entry.name.span, why);
        return false;
    }
    // The nearest constraining clause counts: a redeclaration may have narrowed it.
    let narrowed = found.iter().skip(1).find_map(|r| {
        let constraint = r.element.replaceable.as_ref()?.constraint.as_ref()?;
        Some((constraint.clone(), r.scope))
    });
    let declared = entry.element.replaceable.as_ref().and_then(|r| r.constraint.clone());
    let clause = narrowed.or(declared.map(|path| (path, own)));
    let (wanted, span) = match &clause {
        Some((path, scope)) => match cx.find_class(path, *scope) {
            Some(class) => (class, path.span),
            None => return true,
        },
        None => (before, entry.name.span),
    };
    // A constraint that a redeclaration brings must be within the one before it.
    let narrower = outermost.element.replaceable.as_ref().and_then(|r| r.constraint.clone());
    let narrower = narrower.and_then(|path| cx.find_class(&path, outermost.scope));
    let given = [Some(after), narrower].into_iter().flatten();
    for given in given {
        if let Some(why) = incompatibility(cx, wanted, given) {
            cx.report_incompatible(text, outermost.span, (span, why));
            return false;
        }
    }
    true
}

/// The class that an element has by its declaration.
fn original(cx: &mut ClassGraph<'_>, id: InstanceId, entry: &Entry) -> Option<ClassId> {
    match &entry.kind {
        EntryKind::Class(text) => Some(cx.class_in(text, entry.class, id)),
        EntryKind::Component(declaration) => {
            let own = Scope { instance: id, class: entry.class };
            cx.find_class(&declaration.clause().type_name, own)
        }
    }
}

/// The class that an element gets.
fn replaced(
    cx: &mut ClassGraph<'_>,
    id: InstanceId,
    text: Name,
    by: &Replacement,
) -> Option<ClassId> {
    match &by.element.kind {
        ElementKind::Components(clause) => cx.find_class(&clause.type_name, by.scope),
        ElementKind::Class(_) => {
            let class = cx.instances[id].class?;
            cx.member_class(class, text, id)
        }
        ElementKind::Import(_) | ElementKind::Extends(_) => None,
    }
}

fn is_same(cx: &ClassGraph<'_>, a: ClassId, b: ClassId) -> bool {
    match (cx.definition(a), cx.definition(b)) {
        (Some(a), Some(b)) => std::sync::Arc::ptr_eq(a, b),
        _ => a == b,
    }
}

/// The reason why `given` is not plug-compatible with `wanted`.
fn incompatibility(
    cx: &mut ClassGraph<'_>,
    wanted: ClassId,
    given: ClassId,
) -> Option<Incompatibility> {
    incompatibility_with(cx, wanted, given, 0)
}

/// As [`incompatibility`], not counting the last `added` dimensions of `given`.
fn incompatibility_with(
    cx: &mut ClassGraph<'_>,
    wanted: ClassId,
    given: ClassId,
    added: usize,
) -> Option<Incompatibility> {
    if is_same(cx, wanted, given) || cx.table_in_progress(wanted) || cx.table_in_progress(given) {
        return None;
    }
    let mut rank = |c: ClassId| cx.table(c).dims.iter().map(|(d, _)| d.len()).sum::<usize>();
    let (needs, has) = (rank(wanted), rank(given).saturating_sub(added));
    if needs != has {
        let (wanted, given) = (cx.classes[wanted].full_name, cx.classes[given].full_name);
        return Some(Incompatibility::Dimensions { given, has, wanted, needs });
    }
    incompatibility_without_sizes(cx, wanted, given)
}

/// `enumeration(:)`: any enumeration takes its place (section 4.8.5.4).
fn is_open_enumeration(cx: &ClassGraph<'_>, class: ClassId) -> bool {
    matches!(cx.definition(class).map(|t| &t.body), Some(ClassBody::Enumeration(None)))
}

/// As [`incompatibility`], whatever the dimensions.
pub(crate) fn incompatibility_without_sizes(
    cx: &mut ClassGraph<'_>,
    wanted: ClassId,
    given: ClassId,
) -> Option<Incompatibility> {
    let in_progress = cx.table_in_progress(wanted) || cx.table_in_progress(given);
    if is_same(cx, wanted, given) || in_progress {
        return None;
    }
    let (needs, has) = (cx.table(wanted), cx.table(given));
    let open = is_open_enumeration(cx, wanted)
        && matches!(has.scalar, Some(crate::ir::expr::Type::Enumeration(_)));
    let (replacing, given) = (given, cx.classes[given].full_name);
    let (wanted_class, wanted) = (wanted, cx.classes[wanted].full_name);
    if needs.scalar.is_some() && needs.scalar != has.scalar && !open {
        return Some(Incompatibility::Type { given, wanted });
    }
    let is_class = |e: &Entry| matches!(e.kind, EntryKind::Class(_));
    let needed = needs.entries.iter().filter(|e| !e.protected && !is_conditional(e));
    for entry in needed {
        let text = entry.name.name;
        let Some(at) = has.index.get(&text) else {
            if is_class(entry)
                && (is_function(cx, wanted_class, entry)
                    || cx.class_in_file(replacing, text).is_some())
            {
                continue;
            }
            return Some(Incompatibility::Missing { given, element: text, wanted });
        };
        if is_class(entry) != is_class(&has.entries[*at]) {
            return Some(Incompatibility::Element { element: text, wanted });
        }
    }
    None
}

/// Dimensions that a short class adds to its base: a constraint is about the base.
fn own_rank(entry: &Entry) -> usize {
    match &entry.kind {
        EntryKind::Class(text) => match &text.body {
            ClassBody::Short(short) => short.dims.len(),
            _ => 0,
        },
        EntryKind::Component(_) => 0,
    }
}

/// Whether an element is a function of a package. A medium of an older library may lack some of those that the
/// packages of the Standard Library have by now; one that is called is missed there.
fn is_function(cx: &ClassGraph<'_>, holder: ClassId, entry: &Entry) -> bool {
    let is_package = cx.definition(holder).is_some_and(|t| t.kind == ast::ClassKind::Package);
    let EntryKind::Class(text) = &entry.kind else { return false };
    is_package && matches!(text.kind, ast::ClassKind::Function { .. })
}

fn is_conditional(entry: &Entry) -> bool {
    match &entry.kind {
        EntryKind::Component(declaration) => declaration.component().condition.is_some(),
        EntryKind::Class(_) => false,
    }
}
