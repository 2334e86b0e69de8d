//! Modifications without effect: allowed, but seldom meant. `mocc check` reports them for the
//! classes of a file. Overriding a modification from further outside is common and not reported.

use super::cause::element::ElementCause;
use crate::base::diag::Diagnostic;
use crate::base::source::Span;
use crate::classes::ClassGraph;
use crate::ir::ast::{
    ClassBody, ComponentClause, ElementKind, Expr, ExprKind, Modification, UnaryOp,
};
use crate::ir::instance::{ClassId, InstanceId, InstanceKind, Scope};
use crate::ir::modification::LayerSource;

/// Warns of `each` in the modifications of a component that is not an array (section 7.2.5).
pub fn report_each_of_one(cx: &mut ClassGraph<'_>, class: ClassId) {
    let Some(text) = cx.definition(class).cloned() else { return };
    let ClassBody::Long(composition) = &text.body else { return };
    for element in &composition.elements {
        let ElementKind::Components(clause) = &element.kind else { continue };
        for component in &clause.components {
            let Some(modification) = &component.modification else { continue };
            let Some(each) = first_each(modification) else { continue };
            if component.dims.is_empty() && !is_array_type(cx, class, clause) {
                let cause = ElementCause::EachOfScalar { name: component.name.name };
                cx.problems.push(
                    Diagnostic::new(cause, each)
                        .also(component.name.span, "declared without sizes"),
                );
            }
        }
    }
}

/// Whether a clause declares arrays by its type.
fn is_array_type(cx: &mut ClassGraph<'_>, class: ClassId, clause: &ComponentClause) -> bool {
    let scope = Scope { instance: cx.classes[class].holder, class };
    !clause.type_dims.is_empty()
        || cx.find_class(&clause.type_name, scope).is_none_or(|of| !cx.table(of).dims.is_empty())
}

/// Warns of modifications, in the definition of the instantiated model, of components that are
/// disabled by a Boolean literal.
pub fn report_modified_absent(cx: &mut ClassGraph<'_>, class: ClassId) {
    let Some(file) = cx.definition(class).map(|t| t.span.file) else { return };
    for id in cx.instances.ids().collect::<Vec<_>>() {
        if !matches!(cx.instances[id].kind, InstanceKind::Absent) {
            continue;
        }
        let at = cx.instances[id].layers.iter().find_map(|layer| match &layer.source {
            LayerSource::Argument(m, k, _) if layer.scope.class == class => Some(m.args[*k].span),
            _ => None,
        });
        if let Some(at) = at.filter(|at| at.file == file)
            && let Some(switch) = written_switch(cx, id)
        {
            report_absent_modified(cx, id, switch, at);
        }
    }
}

/// The sibling parameter that is the condition of a component, if its value is the literal `true`
/// or `false`, not an expression.
fn written_switch(cx: &mut ClassGraph<'_>, id: InstanceId) -> Option<InstanceId> {
    let condition = cx.instances[id].declaration.as_ref()?.component().condition.clone()?;
    let switch = match &condition.kind {
        ExprKind::Unary(UnaryOp::Not, inner) => simple(inner)?,
        _ => simple(&condition)?,
    };
    let parent = cx.instances[id].parent?;
    let switch = cx.child_of_complete(parent, switch)?;
    let value = cx.binding(switch)?.value;
    matches!(value.kind, ExprKind::Boolean(_)).then_some(switch)
}

fn report_absent_modified(cx: &mut ClassGraph<'_>, id: InstanceId, switch: InstanceId, at: Span) {
    let cause = ElementCause::AbsentModified { path: cx.path(id), switch: cx.path(switch) };
    let value = cx.binding(switch).map_or(at, |b| b.value.span);
    cx.problems.push(
        Diagnostic::new(cause, at)
            .also(value, "its value")
            .note("modifications of a conditional component are ignored if its condition is false"),
    );
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
