//! `inner` and `outer`: what an outer component promises, the inner one must have, and only the inner one
//! is modified (section 5.4 of the specification).

use std::rc::Rc;

use super::{Context, ROOT};
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::ir::ast::{self, ClassKind};
use crate::ir::instance::{ClassId, Declaration, Instance, InstanceId, InstanceKind};
use crate::ir::modification::LayerSource;

impl Context<'_> {
    /// The `inner` component of that name in the components around.
    pub(crate) fn find_inner(&mut self, id: InstanceId, wanted: Name) -> Option<InstanceId> {
        let mut at = self.around(id);
        while let Some(holder) = at {
            at = self.around(holder);
            if !matches!(self.instances[holder].kind, InstanceKind::Object(_)) {
                continue;
            }
            if let Some(found) = self.child(holder, wanted)
                && found != id
                && self.instances[found].declaration.as_ref().is_some_and(|d| d.element.inner)
            {
                return Some(found);
            }
        }
        None
    }

    /// The component around an instance; around a package in a component that component.
    fn around(&self, id: InstanceId) -> Option<InstanceId> {
        let instance = &self.instances[id];
        let package = instance.class.filter(|c| self.package_instances.get(c) == Some(&id));
        let holder = package.map(|c| self.classes[c].holder);
        instance.parent.or(holder).filter(|around| *around != ROOT.instance && *around != id)
    }

    /// What a name stands for where it is read: an `inner outer` component is the outer one to all but
    /// the components inside of its own (section 5.4).
    pub(crate) fn seen(&mut self, id: InstanceId) -> InstanceId {
        let both = self.instances[id]
            .declaration
            .as_ref()
            .filter(|d| d.element.inner && d.element.outer)
            .map(|d| d.component().name.name);
        match both {
            Some(name) => self.find_inner(id, name).unwrap_or(id),
            None => id,
        }
    }

    /// The `inner` component that is missing, at the top of the model and as its class makes it: what an
    /// `outer` model stands for is wanted once (section 5.4).
    pub(crate) fn add_inner(&mut self, id: InstanceId, outer: &Declaration) -> Option<InstanceId> {
        let scope = self.instances[id].scope;
        let class = self.find_class(&outer.clause().type_name, scope)?;
        if matches!(self.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector)
            || self.partial_text(class).is_some()
            || !outer.component().dims.is_empty()
        {
            return None;
        }
        let mut top = id;
        while let Some(around) = self.around(top) {
            top = around;
        }
        let InstanceKind::Object(children) = self.instances[top].kind.clone() else { return None };
        let mut declaration = outer.clone();
        let element = Rc::make_mut(&mut declaration.element);
        (element.inner, element.outer, element.protected) = (true, false, false);
        let name = outer.component().name;
        let added = self.instances.push(Instance {
            parent: Some(top),
            declaration: Some(declaration),
            scope,
            class: None,
            ..super::package_like(class, name.name)
        });
        self.instances[top].kind =
            InstanceKind::Object(children.iter().copied().chain([added]).collect());
        self.problems.push(
            Diagnostic::warning(
                "MO0206",
                name.span,
                format!("there is no `inner` component `{}`: one is added to the model", name.name),
            )
            .label("of this class, with its defaults")
            .help(format!(
                "declare it: `inner {}{} {};`",
                match outer.clause().prefix.variability {
                    Some(ast::Variability::Constant) => "constant ",
                    Some(ast::Variability::Parameter) => "parameter ",
                    _ => "",
                },
                outer.clause().type_name,
                name.name
            ))
            .note("section 5.4 of the specification"),
        );
        self.added_inner.insert(added);
        self.complete_all(added);
        Some(added)
    }

    /// `outer` components are modified where the `inner` one is declared.
    pub(crate) fn check_outer_unmodified(&mut self, id: InstanceId, name: ast::Ident) {
        for layer in self.instances[id].layers.clone().iter() {
            let modified = match &layer.source {
                LayerSource::ParameterOverride(..) => None,
                _ => layer.inner().filter(|m| m.binding.is_some() || !m.args.is_empty()),
            };
            let Some(modified) = modified else { continue };
            let message = format!("`{}` is `outer`, and is modified", name.name);
            self.problems.push(
                Diagnostic::error("MO0267", modified.span, message)
                    .also(name.span, "declared `outer`")
                    .help("modify the `inner` component that it stands for")
                    .note("section 5.4 of the specification"),
            );
        }
    }

    /// The `inner` component must have what the `outer` one promises.
    pub(crate) fn check_inner_fits(
        &mut self,
        id: InstanceId,
        inner: InstanceId,
        wanted: ClassId,
        name: ast::Ident,
    ) {
        let Some(found) = self.instances[inner].declaration.clone() else { return };
        let scope = self.instances[inner].scope;
        let given = match self.instances[inner].class {
            Some(class) => class,
            None => match self.find_class(&found.clause().type_name, scope) {
                Some(class) => class,
                None => return,
            },
        };
        let Some(declared) = self.instances[id].declaration.clone() else { return };
        let mut rank = |d: &Declaration, class: ClassId| {
            let of_type: usize = self.table(class).dims.iter().map(|(d, _)| d.len()).sum();
            d.component().dims.len() + d.clause().type_dims.len() + of_type
        };
        let (a, b) = (rank(&declared, wanted), rank(&found, given));
        let why = if a == b {
            self.misfit_without_sizes(wanted, given)
        } else {
            Some(format!("it has {a} dimensions, and the `inner` one has {b}"))
        };
        let why = why.or_else(|| self.size_misfit(id, inner, &declared, wanted));
        let why = why.or_else(|| self.added_for_another(inner, wanted, given));
        let Some(why) = why else { return };
        self.problems.push(
            Diagnostic::error(
                "MO0267",
                name.span,
                format!("`outer {}` does not fit its `inner` component: {why}", name.name),
            )
            .also(found.component().name.span, "the `inner` component")
            .help("give both the same class, or the `inner` one a class that extends that of the `outer` one")
            .note("section 5.4 of the specification"),
        );
    }

    /// One that was added stands for `outer` components of one class only.
    fn added_for_another(
        &mut self,
        inner: InstanceId,
        wanted: ClassId,
        given: ClassId,
    ) -> Option<String> {
        let same = match (self.text(wanted), self.text(given)) {
            (Some(a), Some(b)) => std::sync::Arc::ptr_eq(a, b),
            _ => wanted == given,
        };
        (!same && self.added_inner.contains(&inner)).then(|| {
            let full_name = self.classes[given].full_name;
            format!(
                "none is declared, and another `outer` component of that name is a `{full_name}`"
            )
        })
    }

    /// Sizes of an `outer` component that differ from those of the `inner` one, in words.
    fn size_misfit(
        &mut self,
        id: InstanceId,
        inner: InstanceId,
        declared: &Declaration,
        class: ClassId,
    ) -> Option<String> {
        if declared.component().dims.iter().any(|d| matches!(d, ast::Subscript::Colon(_))) {
            return None;
        }
        self.complete(inner);
        let found = match &self.instances[inner].kind {
            InstanceKind::Variable { dims, .. } | InstanceKind::Array { dims, .. } => dims.clone(),
            _ => return None,
        };
        let table = self.table(class);
        let wanted = self.sizes(id, declared, &table)?;
        (*wanted != *found)
            .then(|| format!("it has size {wanted:?}, and the `inner` one has {found:?}"))
    }
}
