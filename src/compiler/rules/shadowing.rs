//! Names that hide others (section 5.3 of the specification): allowed, and seldom meant. `mocc check`
//! asks for them, of the classes of a file.

use super::cause::element::{ElementCause, Shadow};
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::classes::{ClassGraph, ROOT};
use crate::ir::ast::{
    Class, ClassBody, ClassKind, Composition, ElementKind, Ident, ImportForm, Variability,
};
use crate::ir::instance::{ClassId, EntryKind};

/// Warns of names in a class definition, and in its local classes, that shadow others. The classes
/// of a package are checked separately.
pub fn report_shadowed(cx: &mut ClassGraph<'_>, class: ClassId) {
    let Some(text) = cx.definition(class).cloned() else { return };
    let ClassBody::Long(composition) = &text.body else { return };
    check_loops(cx, class, composition);
    check_imports(cx, class, composition);
    check_components(cx, class, composition);
    if text.kind == ClassKind::Package {
        return;
    }
    for element in &composition.elements {
        let ElementKind::Class(inner) = &element.kind else { continue };
        let holder = cx.classes[class].holder;
        if let Some(inner) = cx.member_class(class, inner.name.name, holder) {
            report_shadowed(cx, inner);
        }
    }
}

/// Iterators with the name of a component, or of an iterator around them.
fn check_loops(cx: &mut ClassGraph<'_>, class: ClassId, composition: &Composition) {
    let table = cx.table(class);
    for (iterator, around) in super::iterators::all(composition) {
        let component = table
            .index
            .get(&iterator.name)
            .map(|at| &table.entries[*at])
            .filter(|entry| entry.component.is_some());
        let (by, hidden) = match (around, component) {
            (Some(around), _) => (Shadow::IteratorOfIterator, around),
            (None, Some(entry)) => (Shadow::IteratorOfComponent, entry.name),
            (None, None) => continue,
        };
        warn(cx, by, iterator, hidden.span);
    }
}

/// Imports with the name of an element: they are never seen.
fn check_imports(cx: &mut ClassGraph<'_>, class: ClassId, composition: &Composition) {
    let table = cx.table(class);
    for element in &composition.elements {
        let ElementKind::Import(import) = &element.kind else { continue };
        let names: Vec<Ident> = match &import.form {
            ImportForm::Qualified => import.path.parts.last().copied().into_iter().collect(),
            ImportForm::Renamed(alias) => vec![*alias],
            ImportForm::List(names) => names.clone(),
            ImportForm::All => Vec::new(),
        };
        for name in names {
            let Some(at) = table.index.get(&name.name) else { continue };
            let entry = &table.entries[*at];
            warn(cx, Shadow::Element, entry.name, name.span);
        }
    }
}

/// Components with the name of a constant of a class around.
fn check_components(cx: &mut ClassGraph<'_>, class: ClassId, composition: &Composition) {
    for element in composition.elements.iter().filter(|e| !e.redeclare) {
        let ElementKind::Components(clause) = &element.kind else { continue };
        for name in clause.components.iter().map(|c| c.name) {
            if let Some(constant) = constant_around(cx, class, name.name) {
                warn(cx, Shadow::Component, name, constant);
            }
        }
    }
}

/// The constant of a name that is seen from a class, where it is declared.
fn constant_around(cx: &mut ClassGraph<'_>, class: ClassId, wanted: Name) -> Option<Span> {
    let mut inner = class;
    loop {
        if cx.definition(inner).is_some_and(|t: &std::sync::Arc<Class>| t.encapsulated) {
            return None;
        }
        inner = cx.classes[inner].enclosing.filter(|c| *c != ROOT.class)?;
        let table = cx.table(inner);
        let Some(at) = table.index.get(&wanted) else { continue };
        let entry = &table.entries[*at];
        let EntryKind::Component(declaration) = &entry.kind else { return None };
        let constant = declaration.clause().prefix.variability == Some(Variability::Constant);
        return constant.then_some(entry.name.span);
    }
}

fn warn(cx: &mut ClassGraph<'_>, by: Shadow, name: Ident, hidden: Span) {
    cx.problems.push(
        Diagnostic::new(ElementCause::Shadowing { name: name.name, by }, name.span)
            .also(hidden, "hidden here")
            .note("the innermost name counts"),
    );
}
