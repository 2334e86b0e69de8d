//! Rules of the specification that only report: they read classes and components, and change neither.
//!
//! In: a class or a component. Out: diagnostics. One file per rule or group of rules of one section;
//! each rule takes the least that it needs: diagnostics and syntax, or the [`ClassGraph`]. The rules
//! of a class definition are called from here, for [`DefinitionRules`].

pub mod cause;
pub mod ineffective_modifiers;
mod iterators;
pub(crate) mod plug_compatibility;
pub(crate) mod prefix;
mod replaceable_base;
pub mod shadowing;
pub(crate) mod specialized_class;
pub(crate) mod statements;
pub(crate) mod visibility;

use std::sync::Arc;

use crate::base::source::Span;
use crate::classes::{ClassGraph, DefinitionRules};
use crate::ir::ast::{Class, Path};
use crate::ir::instance::{ClassId, ClassTable, Entry, Scope};

impl DefinitionRules for ClassGraph<'_> {
    fn check_definition(&mut self, definition: &Class) {
        specialized_class::check_definition(self.problems, definition);
    }

    fn check_body(&mut self, class: ClassId, definition: &Arc<Class>) {
        statements::check_body(self, class, definition);
    }

    fn check_short_base(&mut self, definition: &Class, base: ClassId, span: Span) {
        specialized_class::check_short_base(self, definition, base, span);
    }

    fn check_extends(&mut self, class: ClassId, base: ClassId, path: &Path, scope: Scope) {
        if let Some(definition) = self.definition(class).cloned() {
            specialized_class::check_base(self, &definition, base, path.span);
        }
        replaceable_base::check(self, path, scope);
        specialized_class::check_prefixed_base(self, class, base, path.span);
    }

    fn check_simple_type(&mut self, class: ClassId, table: &ClassTable, bases: &[ClassId]) {
        specialized_class::check_simple_type(self, class, table, bases);
    }

    fn check_redeclared_prefixes(&mut self, before: &Entry, after: &Entry) {
        prefix::check_redeclared(self, before, after);
    }
}
