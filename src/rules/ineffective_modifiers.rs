//! Modifications without effect: allowed, and seldom meant. `mocc check` asks for them, of the classes
//! of a file. What is overridden further outside is the way of the language, and no such case.

use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::instantiate::Context;
use crate::ir::ast::{
    ClassBody, ComponentClause, ElementKind, Expr, ExprKind, Modification, UnaryOp,
};
use crate::ir::instance::{ClassId, InstanceId, InstanceKind, Scope};
use crate::ir::modification::LayerSource;

impl Context<'_> {
    /// Warns of `each` in the modifications of what is no array (section 7.2.5).
    pub fn report_each_of_one(&mut self, class: ClassId) {
        let Some(text) = self.text(class).cloned() else { return };
        let ClassBody::Long(composition) = &text.body else { return };
        for element in &composition.elements {
            let ElementKind::Components(clause) = &element.kind else { continue };
            for component in &clause.components {
                let Some(modification) = &component.modification else { continue };
                let Some(each) = first_each(modification) else { continue };
                if component.dims.is_empty() && !self.is_array_type(class, clause) {
                    let message =
                        format!("`each` has no effect: `{}` is no array", component.name.name);
                    self.problems.push(
                        Diagnostic::warning("MO0271", each, message)
                            .also(component.name.span, "declared without sizes")
                            .help("leave `each` out, or give the component its sizes")
                            .note("section 7.2.5 of the specification"),
                    );
                }
            }
        }
    }

    /// Whether a clause declares arrays by its type.
    fn is_array_type(&mut self, class: ClassId, clause: &ComponentClause) -> bool {
        let scope = Scope { instance: self.classes[class].holder, class };
        !clause.type_dims.is_empty()
            || self
                .find_class(&clause.type_name, scope)
                .is_none_or(|of| !self.table(of).dims.is_empty())
    }

    /// Warns of modifications, in the text of the model that was instantiated, of components that are
    /// switched off by a truth value that is written out.
    pub fn report_modified_absent(&mut self, class: ClassId) {
        let Some(file) = self.text(class).map(|t| t.span.file) else { return };
        for id in self.instances.ids().collect::<Vec<_>>() {
            if !matches!(self.instances[id].kind, InstanceKind::Absent) {
                continue;
            }
            let at = self.instances[id].layers.iter().find_map(|layer| match &layer.source {
                LayerSource::Argument(m, k, _) if layer.scope.class == class => {
                    Some(m.args[*k].span)
                }
                _ => None,
            });
            if let Some(at) = at.filter(|at| at.file == file)
                && let Some(switch) = self.written_switch(id)
            {
                self.report_absent_modified(id, switch, at);
            }
        }
    }

    /// The parameter beside a conditional component that is its condition, if its value is `true` or
    /// `false` as written: not one that something else decides.
    fn written_switch(&mut self, id: InstanceId) -> Option<InstanceId> {
        let condition = self.instances[id].declaration.as_ref()?.component().condition.clone()?;
        let switch = match &condition.kind {
            ExprKind::Unary(UnaryOp::Not, inner) => simple(inner)?,
            _ => simple(&condition)?,
        };
        let parent = self.instances[id].parent?;
        let switch = self.child(parent, switch)?;
        let value = self.binding(switch)?.value;
        matches!(value.kind, ExprKind::Boolean(_)).then_some(switch)
    }

    fn report_absent_modified(&mut self, id: InstanceId, switch: InstanceId, at: Span) {
        let (path, switch_path) = (self.path(id), self.path(switch));
        let message = format!("this has no effect: `{path}` is switched off by `{switch_path}`");
        let value = self.binding(switch).map_or(at, |b| b.value.span);
        self.problems.push(
            Diagnostic::warning("MO0272", at, message)
                .also(value, "its value")
                .help(format!("set `{switch_path}`, or leave the modification out"))
                .note("what is modified of a conditional component that is not there is not looked at (section 4.4.5)"),
        );
    }
}

/// The place of the first argument with `each`.
fn first_each(modification: &Modification) -> Option<Span> {
    modification.args.iter().find(|a| a.each).map(|a| a.span)
}

fn simple(e: &Expr) -> Option<crate::base::name::Name> {
    match &e.kind {
        ExprKind::Ref(r) => r.simple(),
        ExprKind::Parenthesised(inner) => simple(inner),
        _ => None,
    }
}
