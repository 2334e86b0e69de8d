//! Modifications and their arguments.

use std::sync::Arc;

use super::Builder;
use super::class::{ClassDraft, Description};
use super::element::Constraint;
use super::prefix::{ARGUMENT, CLASS, Prefix, Prefixes, TYPE};
use crate::base::diag::Diagnostic;
use crate::ir::ast::*;
use crate::parse::error::SyntaxCause;

impl Builder<'_> {
    /// `(...) = e`
    pub fn modification(
        &mut self,
        args: Vec<Box<Argument>>,
        binding: Option<Box<Expr>>,
        start: u32,
        end: u32,
    ) -> Arc<Modification> {
        let args = self.unbox(args);
        Arc::new(Modification {
            args,
            binding: binding.map(Arc::from),
            span: self.span(start, end),
        })
    }
    /// `each final a.b(...) = e "..."`
    pub fn modify(
        &mut self,
        prefixes: Prefixes,
        path: Path,
        modification: Option<Arc<Modification>>,
        (description, _): Description,
        end: u32,
    ) -> Box<Argument> {
        self.allow(prefixes, &[&[Prefix::Each, Prefix::Final]], "a modification");
        let kind = ArgumentKind::Element { path, modification, description };
        self.argument(prefixes, kind, end)
    }
    /// `redeclare model A = B`
    pub fn redeclare_class(
        &mut self,
        draft: Box<ClassDraft>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Argument> {
        let prefixes = draft.prefixes;
        self.allow(prefixes, &[ARGUMENT, CLASS], "the class of a modification");
        self.check_redeclares(prefixes, draft.class.name);
        if matches!(draft.class.body, ClassBody::Long(_)) {
            let place = draft.class.name.span;
            self.report(Diagnostic::new(SyntaxCause::LongRedeclaration, place));
        }
        let element = self.class_in(draft, constraint, end);
        self.argument(prefixes, ArgumentKind::Redeclare(Arc::from(element)), end)
    }
    /// `redeclare A a(...)`
    pub fn redeclare_component(
        &mut self,
        prefixes: Prefixes,
        type_name: Path,
        type_dims: Vec<Subscript>,
        component: Box<Component>,
        constraint: Constraint,
        end: u32,
    ) -> Box<Argument> {
        self.allow(prefixes, &[ARGUMENT, TYPE], "the component of a modification");
        self.check_redeclares(prefixes, component.name);
        let element =
            self.components_in(prefixes, type_name, type_dims, vec![component], constraint, end);
        self.argument(prefixes, ArgumentKind::Redeclare(Arc::from(element)), end)
    }
    /// `break a`
    pub fn removal(&mut self, removal: Removal, start: u32, end: u32) -> Box<Argument> {
        self.argument(Prefixes::at(start), ArgumentKind::Removal(removal), end)
    }
    fn check_redeclares(&mut self, prefixes: Prefixes, name: Ident) {
        if !prefixes.has(Prefix::Redeclare) && !prefixes.has(Prefix::Replaceable) {
            let at = self.span(prefixes.start, prefixes.start);
            let cause = SyntaxCause::MissingRedeclare { name: name.name.to_string() };
            self.report(
                Diagnostic::new(cause, at)
                    .label("`redeclare` or `replaceable` is missing here")
                    .also(name.span, "declared here"),
            );
        }
    }
    fn argument(&mut self, prefixes: Prefixes, kind: ArgumentKind, end: u32) -> Box<Argument> {
        Box::new(Argument {
            each: prefixes.has(Prefix::Each),
            is_final: prefixes.has(Prefix::Final),
            kind,
            span: self.span(prefixes.start, end),
        })
    }
}
