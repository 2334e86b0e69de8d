//! Declarations that mean the same for each component that they declare: each element of an array
//! of components has its own instance, but class and prefixes are determined once.

use std::rc::Rc;

use super::{ClassGraph, ROOT};
use crate::ir::ast::{Element, TypePrefix};
use crate::ir::expr::Type;
use crate::ir::instance::{ClassDefinition, ClassId, Declaration, InstanceId, Scope};

/// A declared component, by the address of its element, its position there and the class of its scope.
pub(crate) type Key = (usize, usize, ClassId);

/// The meaning of a declaration in every instance of its class.
#[derive(Clone)]
pub(crate) struct Cached {
    pub(crate) class: ClassId,
    /// Of the declaration and of the class.
    pub(crate) prefix: TypePrefix,
    pub(crate) scalar: Option<Type>,
    /// Holds the address that it is found by.
    _element: Rc<Element>,
}

impl ClassGraph<'_> {
    /// The cached meaning of the declaration of a component; `None` if it is not known or not
    /// shared.
    pub(crate) fn cached_declaration(
        &mut self,
        id: InstanceId,
        declaration: &Declaration,
    ) -> Option<Cached> {
        if !self.is_unmodified(id, declaration) {
            return None;
        }
        self.declaration_cache.get(&key(declaration, self.instances[id].scope)).cloned()
    }

    /// Caches the meaning of a declaration, if it holds for all of its components.
    pub(crate) fn cache_declaration(
        &mut self,
        id: InstanceId,
        declaration: &Declaration,
        prefix: TypePrefix,
    ) {
        let scope = self.instances[id].scope;
        let (Some(class), true) = (self.instances[id].class, self.is_unmodified(id, declaration))
        else {
            return;
        };
        let (element, clause) = (&declaration.element, declaration.clause());
        let component = declaration.component();
        let table = self.table(class);
        let changeable = element.replaceable.is_some() || element.redeclare;
        let depends = component.condition.is_some() || element.inner || element.outer;
        let sized =
            !component.dims.is_empty() || !clause.type_dims.is_empty() || !table.dims.is_empty();
        // With redeclarations in it, the class is one of its own.
        let as_named = self.find_class(&clause.type_name, scope) == Some(class);
        if changeable
            || depends
            || sized
            || !as_named
            || !self.is_fixed_name(&clause.type_name, scope)
        {
            return;
        }
        let scalar = table.scalar;
        let cached = Cached { class, prefix, scalar, _element: element.clone() };
        self.declaration_cache.insert(key(declaration, scope), cached);
    }

    /// Whether a component is modified by its own declaration at most.
    fn is_unmodified(&self, id: InstanceId, declaration: &Declaration) -> bool {
        let own = usize::from(declaration.component().modification.is_some());
        self.instances[id].layers.len() == own
    }

    /// Whether the name of a class denotes the same class in all instances of the enclosing class:
    /// it is found in a package, not among elements that an instance may redeclare.
    fn is_fixed_name(&mut self, path: &crate::ir::ast::Path, scope: Scope) -> bool {
        let Some(first) = path.parts.first() else { return false };
        let in_component = self.instances[scope.instance].parent.is_some();
        if !in_component || self.table(scope.class).index.contains_key(&first.name) {
            return false;
        }
        let head = crate::ir::ast::Path { parts: vec![*first], ..path.clone() };
        let Some(class) = self.find_class(&head, scope) else { return false };
        let of = &self.classes[class];
        let around = of.enclosing.unwrap_or(ROOT.class);
        matches!(of.body, ClassDefinition::Predefined(_))
            || self.package_instances.get(&around) == Some(&of.holder)
    }
}

fn key(declaration: &Declaration, scope: Scope) -> Key {
    (Rc::as_ptr(&declaration.element) as usize, declaration.component, scope.class)
}
