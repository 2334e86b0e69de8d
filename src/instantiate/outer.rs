//! `inner` and `outer`: what an outer component promises, the inner one must have, and only the inner one
//! is modified (section 5.4 of the specification).

use super::Context;
use crate::base::diag::Diagnostic;
use crate::ir::ast;
use crate::ir::instance::{ClassId, Declaration, InstanceId};
use crate::ir::modification::LayerSource;

impl Context<'_> {
    /// `outer` components are modified where the `inner` one is declared.
    pub(crate) fn check_outer_unmodified(&mut self, id: InstanceId, name: ast::Ident) {
        for layer in self.instances[id].layers.clone().iter() {
            let modified = match &layer.source {
                LayerSource::Setting(..) => None,
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
}
