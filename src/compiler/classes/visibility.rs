//! Visibility of names: protected elements, and elements of classes that are not packages (sections
//! 4.1, 5.3.2 and 13.2.1 of the specification).

use super::cause::ClassCause;
use super::{ClassGraph, ROOT};
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{self, ClassBody, ClassKind, Element, ElementKind, Variability};
use crate::ir::instance::{ClassId, EntryKind};

/// Prefixes of an element that say who may name it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Visibility {
    protected: bool,
    encapsulated: bool,
    pub(crate) replaceable: bool,
    is_class: bool,
    /// Where the element is declared.
    pub(crate) span: Span,
}

/// A step of a dotted name that is not allowed, to be reported if the name is needed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AccessViolation {
    class: ClassId,
    part: ast::Ident,
}

impl ClassGraph<'_> {
    /// Reports `part` if it may not be named behind a dot as an element of `class`.
    pub(crate) fn check_step(&mut self, class: ClassId, part: ast::Ident) {
        let Some(found) = self.visibility(class, part.name) else { return };
        if self.from_outside(part.span) {
            return;
        }
        if found.protected {
            self.report_protected(part, found.span);
        } else if !found.encapsulated && !self.is_open(class, part.span) {
            self.report_no_package(class, part, found.is_class);
        }
    }

    /// As [`ClassGraph::check_step`], for a name that is only looked up: the violation is returned
    /// instead of reported.
    pub(crate) fn access_violation(
        &mut self,
        class: ClassId,
        part: ast::Ident,
    ) -> Option<AccessViolation> {
        if class == ROOT.class || self.table_in_progress(class) {
            return None;
        }
        let found = self.visibility(class, part.name)?;
        let wrong = found.protected || !found.encapsulated && !self.is_open(class, part.span);
        wrong.then_some(AccessViolation { class, part })
    }

    /// Reports the access violation of the name that was looked up last.
    pub(crate) fn report_access_violation(&mut self) {
        if let Some(AccessViolation { class, part }) = self.violation.take() {
            self.check_step(class, part);
        }
    }

    /// Whether `wanted` is a protected element of `class`, and where it is declared.
    pub(crate) fn protected_in(&mut self, class: ClassId, wanted: Name) -> Option<Span> {
        self.visibility(class, wanted).filter(|m| m.protected).map(|m| m.span)
    }

    pub(crate) fn report_protected(&mut self, part: ast::Ident, declared: Span) {
        self.problems.push(
            Diagnostic::new(ClassCause::Protected { name: part.name }, part.span)
                .label("named from outside")
                .also(declared, "declared after `protected`")
                .note("protected elements are known in their class and in those that extend it"),
        );
    }

    fn report_no_package(&mut self, class: ClassId, part: ast::Ident, is_class: bool) {
        let holder = self.classes[class].full_name;
        let what = if is_class { "class" } else { "constant" };
        let holder = last_part(&holder).to_string();
        self.problems.push(
            Diagnostic::new(ClassCause::NotInPackage { name: part.name, holder }, part.span)
                .label(format!("{what} of a class that is not a package"))
                .note("a package has classes and constants only"),
        );
    }

    /// Whether a place is not in a file: an expression of the command line may read everything.
    pub fn from_outside(&self, span: Span) -> bool {
        self.sources.get(span.file).is_some_and(|f| f.path.to_string_lossy().starts_with("--"))
    }

    /// The visibility of the element `wanted` of a class.
    pub(crate) fn visibility(&mut self, class: ClassId, wanted: Name) -> Option<Visibility> {
        if class == ROOT.class {
            return None;
        }
        if self.table_in_progress(class) {
            let text = self.definition(class)?.clone();
            let ClassBody::Long(composition) = &text.body else { return None };
            let own = |e: &&Element| e.names().iter().any(|(n, _)| *n == wanted);
            return composition.elements.iter().find(own).map(|e| of_element(e, e.protected));
        }
        let table = self.table(class);
        let entry = table.index.get(&wanted).map(|at| &table.entries[*at])?;
        let found = of_element(&entry.element, entry.protected);
        Some(Visibility { span: entry.name.span, ..found })
    }

    /// Whether a class may be looked into from a place: a package from everywhere, any other from its own text by its
    /// own name, as in `Cell.Substance` within `Cell`.
    fn is_open(&mut self, class: ClassId, place: Span) -> bool {
        self.is_named_within(class, place) || self.is_package_like(class)
    }

    fn is_named_within(&self, class: ClassId, place: Span) -> bool {
        let Some(text) = self.definition(class) else { return false };
        let is_inside =
            text.span.file == place.file && (text.span.start..text.span.end).contains(&place.start);
        let before = Span { start: text.span.start, end: place.start, ..place };
        let Some(before) = self.sources.text(before).filter(|_| is_inside) else { return false };
        let own = before.trim_end().strip_suffix('.').map(str::trim_end);
        let rest = own.and_then(|path| path.strip_suffix(text.name.name.as_str()));
        rest.is_some_and(|rest| rest.ends_with(|c: char| c.is_whitespace() || c == '('))
    }

    /// Whether a class could be a package: nothing in it but classes and constants.
    fn is_package_like(&mut self, class: ClassId) -> bool {
        let Some(text) = self.definition(class) else { return true };
        if matches!(text.kind, ClassKind::Package | ClassKind::Operator) {
            return true;
        }
        if self.table_in_progress(class) {
            return true;
        }
        let table = self.table(class);
        table.sections.is_empty()
            && table.entries.iter().all(|e| match &e.kind {
                EntryKind::Component(d) => {
                    d.clause().prefix.variability == Some(Variability::Constant)
                }
                EntryKind::Class(_) => true,
            })
    }
}

fn of_element(element: &Element, protected: bool) -> Visibility {
    let encapsulated = matches!(&element.kind, ElementKind::Class(c) if c.encapsulated);
    Visibility {
        protected,
        encapsulated,
        replaceable: element.replaceable.is_some(),
        is_class: matches!(element.kind, ElementKind::Class(_)),
        span: element.names().first().map_or(element.span, |(_, span)| *span),
    }
}

/// The part behind the last dot.
fn last_part(full_name: &str) -> &str {
    full_name.rsplit('.').next().unwrap_or(full_name)
}
