//! Types that are written as one name: not a component of the class that contains the name, and
//! perhaps a local class that is modified further outside (sections 5.3.1 and 7.2 of the
//! specification).

use std::rc::Rc;

use super::ClassGraph;
use super::cause::ClassCause;
use crate::base::diag::Diagnostic;
use crate::ir::ast;
use crate::ir::instance::Scope;
use crate::ir::modification::{Layer, LayerSource};

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
        for (modification, class) in entry.layers.iter() {
            let layer = Layer {
                source: LayerSource::Whole(modification.clone()),
                scope: self.modification_scope(*class, scope.instance),
                subscripts: Rc::from([]),
            };
            layer.child(entry.name.name, &mut found);
        }
        found
    }
}
