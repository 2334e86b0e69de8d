//! Elements of classes: import and extends clauses, nested classes and components.

use std::sync::Arc;

use super::Builder;
use super::class::{ClassDraft, Description};
use super::prefix::{CLASS, ELEMENT, Prefix, Prefixes, TYPE};
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::ir::ast::*;
use crate::parse::error::SyntaxCause;

/// A node with the description that follows it.
#[derive(Debug)]
pub struct Described<T> {
    node: T,
    span: Span,
    description: Option<Arc<str>>,
    annotation: Option<Arc<Modification>>,
}

/// A `constrainedby` clause, if there is one.
pub(super) type Constraint = Option<Box<Described<Replaceable>>>;

impl Builder<'_> {
    /// The path and form of an import clause.
    pub fn import_of(&mut self, parts: Vec<Ident>, form: ImportForm) -> Box<Import> {
        Box::new(Import { path: self.path(parts), form })
    }
    /// An import clause.
    pub fn import(&mut self, import: Box<Import>, start: u32, end: u32) -> Box<Element> {
        let span = self.span(start, end);
        self.element(Prefixes::at(start), None, ElementKind::Import(*import), span)
    }
    /// An extends clause.
    pub fn extends(
        &mut self,
        base: Path,
        modification: Option<Arc<Modification>>,
        annotation: Option<Arc<Modification>>,
        start: u32,
        end: u32,
    ) -> Box<Element> {
        let span = self.span(start, end);
        let kind = ElementKind::Extends(Extends { base, modification, annotation });
        self.element(Prefixes::at(start), None, kind, span)
    }
    /// A nested class.
    pub fn class_element(
        &mut self,
        draft: Box<ClassDraft>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Element> {
        self.allow(draft.prefixes, &[ELEMENT, CLASS], "a class");
        self.class_in(draft, constraint, end)
    }
    /// Components of one type.
    pub fn components(
        &mut self,
        prefixes: Prefixes,
        type_name: Path,
        type_dims: Vec<Subscript>,
        components: Vec<Box<Component>>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Element> {
        self.allow(prefixes, &[ELEMENT, TYPE], "a component");
        self.components_in(prefixes, type_name, type_dims, components, constraint, end)
    }
    /// One declared name.
    pub fn component(
        &mut self,
        name: Ident,
        dims: Vec<Subscript>,
        modification: Option<Arc<Modification>>,
        condition: Option<Box<Expr>>,
        (description, annotation): Description,
    ) -> Box<Component> {
        let condition = condition.map(Arc::from);
        Box::new(Component { name, dims, modification, condition, description, annotation })
    }
    /// `constrainedby A(...) "..."`
    pub fn constraint(
        &mut self,
        start: u32,
        path: Path,
        modification: Option<Arc<Modification>>,
        (description, annotation): Description,
    ) -> Box<Described<Replaceable>> {
        let span = self.span(start, path.span.end);
        let node = Replaceable { constraint: Some(path), modification };
        Box::new(Described { node, span, description, annotation })
    }

    pub(super) fn class_in(
        &mut self,
        draft: Box<ClassDraft>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Element> {
        let ClassDraft { prefixes, mut class } = *draft;
        let constraint = constraint.map(|mut c| {
            class.description = class.description.take().or(c.description.take());
            class.annotation = class.annotation.take().or(c.annotation.take());
            c
        });
        let span = self.span(prefixes.start, end);
        self.element(prefixes, constraint, ElementKind::Class(Arc::new(class)), span)
    }
    pub(super) fn components_in(
        &mut self,
        prefixes: Prefixes,
        type_name: Path,
        type_dims: Vec<Subscript>,
        components: Vec<Box<Component>>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Element> {
        let mut components = self.unbox(components);
        let constraint = constraint.map(|mut c| {
            // A description after the constraint belongs to the declared component.
            if let Some(last) = components.last_mut() {
                last.description = last.description.take().or(c.description.take());
                last.annotation = last.annotation.take().or(c.annotation.take());
            }
            c
        });
        let span = self.span(prefixes.start, end);
        let prefix = prefixes.type_prefix();
        let clause = ComponentClause { prefix, type_name, type_dims, components };
        self.element(prefixes, constraint, ElementKind::Components(clause), span)
    }
    fn element(
        &mut self,
        prefixes: Prefixes,
        constraint: Constraint,
        kind: ElementKind,
        span: Span,
    ) -> Box<Element> {
        let replaceable = prefixes.has(Prefix::Replaceable);
        if let Some(constraint) = &constraint
            && !replaceable
            && !prefixes.has(Prefix::Redeclare)
        {
            self.report(Diagnostic::new(SyntaxCause::IneffectiveConstraint, constraint.span));
        }
        let constraint = constraint.map(|c| c.node);
        Box::new(Element {
            protected: false,
            redeclare: prefixes.has(Prefix::Redeclare),
            is_final: prefixes.has(Prefix::Final),
            inner: prefixes.has(Prefix::Inner),
            outer: prefixes.has(Prefix::Outer),
            replaceable: if replaceable {
                Some(constraint.unwrap_or_default())
            } else {
                constraint
            },
            kind,
            span,
        })
    }
}
