//! Types that are written as one name: not a component of the class that contains the name, and
//! perhaps a local class that is modified further outside (sections 5.3.1 and 7.2 of the
//! specification).

use super::ClassGraph;
use super::cause::ClassCause;
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::ir::ast;
use crate::ir::instance::{ClassId, Scope};
use crate::ir::modification::Layer;

impl ClassGraph<'_> {
    /// Checks that a type is not a component of the same class; returns the modifications that a
    /// local class has from further outside, outermost first.
    pub(crate) fn check_type_name(&mut self, path: &ast::Path, scope: Scope) -> Option<Vec<Layer>> {
        let none = Some(Vec::new());
        let Some(first) = path.parts.first().filter(|_| !path.global) else { return none };
        if self.table_in_progress(scope.class) {
            return none;
        }
        let table = self.table(scope.class);
        let Some(entry) = table.index.get(&first.name).map(|at| &table.entries[*at]) else {
            return none;
        };
        if entry.component.is_none() {
            return Some(self.class_modifications(path, scope));
        }
        self.problems.push(
            Diagnostic::new(ClassCause::ComponentAsClass { name: first.name }, first.span)
                .also(entry.name.span, "declared as a component")
                .note("names are looked up from the inside"),
        );
        None
    }

    /// Modifications of a local class: those of the component around, and of `extends` clauses.
    fn class_modifications(&mut self, path: &ast::Path, scope: Scope) -> Vec<Layer> {
        let mut found = Vec::new();
        let [name] = path.parts.as_slice() else { return found };
        // The type itself has the modifications of a package.
        if self.instances[scope.instance].class.is_some_and(|class| self.is_package(class)) {
            return found;
        }
        // As the instance has it: it may have inherited the class.
        let table = self.table_of(scope.instance);
        let Some(entry) = table.index.get(&name.name).map(|at| &table.entries[*at]) else {
            return found;
        };
        let outer = &self.instances[scope.instance].layers;
        if entry.component.is_some() || (entry.layers.is_empty() && outer.is_empty()) {
            return found;
        }
        for layer in outer.iter() {
            layer.child(entry.name.name, &mut found);
        }
        self.inherited_layers(&entry.layers, scope.instance, entry.name.name, &mut found);
        found
    }

    /// The element `wanted` of the package `class`, which is `found`: a type has the modifications of the `extends`
    /// clauses through which the package inherits it, as in `extends P(T(start = 1))` (section 7.2).
    pub(crate) fn modified_in_package(
        &mut self,
        found: ClassId,
        class: ClassId,
        wanted: Name,
    ) -> ClassId {
        if !self.is_package(class) || self.table_in_progress(class) {
            return found;
        }
        if let Some(known) = self.modified_types.get(&(found, class)) {
            return *known;
        }
        let layers = self.layers_of_package(class, wanted);
        if layers.is_empty() {
            self.modified_types.insert((found, class), found);
            return found;
        }
        if self.table_in_progress(found) || self.table(found).scalar.is_none() {
            return found;
        }
        let made = self.copy_of(found);
        self.classes[made].modified = layers.into();
        self.modified_types.insert((found, class), made);
        made
    }

    /// Modifications of an element of a package by the `extends` clauses through which it comes, outermost first.
    fn layers_of_package(&mut self, class: ClassId, wanted: Name) -> Vec<Layer> {
        let mut layers = Vec::new();
        let table = self.table(class);
        let Some(entry) = table.index.get(&wanted).map(|at| &table.entries[*at]) else {
            return layers;
        };
        if entry.layers.is_empty() {
            return layers;
        }
        let package = self.package_instance(class);
        self.inherited_layers(&entry.layers, package, wanted, &mut layers);
        layers
    }
}
