//! Diagnostics of components that cannot be instantiated.

use super::MAX_NESTING;
use super::cause::InstantiateCause;
use crate::base::activity;
use crate::base::diag::Diagnostic;
use crate::base::index::Id;
use crate::evaluate::Evaluator;
use crate::ir::ast;
use crate::ir::instance::{ClassDefinition, ClassId, InstanceId, InstanceKind};

pub(crate) fn report_component_cycle(cx: &mut Evaluator<'_>, id: InstanceId) {
    let span = cx.declared_at(id);
    let cause = InstantiateCause::StructureCycle { path: cx.path(id) };
    cx.problems
        .push(Diagnostic::new(cause, span).label("needed for its own size, condition or class"));
    cx.instances[id].kind = InstanceKind::Broken;
}

/// Number of components between two notes of the activity.
const NOTE_INTERVAL: usize = 1 << 14;

/// Reports a component tree that is too large or too deep; true if it is.
pub(crate) fn report_exhausted(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    let around = |id: &InstanceId| cx.instances[*id].parent;
    let levels = std::iter::successors(Some(id), around).take(MAX_NESTING + 2).count();
    let most = cx.budget.size;
    let cause = if levels > MAX_NESTING + 1 {
        InstantiateCause::NestedTooDeep { path: cx.path(id), most: MAX_NESTING }
    } else if cx.instances.len() > most {
        InstantiateCause::TooManyComponents { path: cx.path(id), most }
    } else {
        if id.idx().is_multiple_of(NOTE_INTERVAL) && id.idx() > 0 {
            let path = cx.path(id);
            activity::note(format!("instantiating component number {} (`{path}`)", id.idx()));
        }
        return false;
    };
    let span = cx.declared_at(id);
    cx.problems.push(Diagnostic::new(cause, span).label("the last component was of this"));
    true
}

/// Partial classes, packages and functions cannot be instantiated, nor a class inside itself.
pub(crate) fn check_instantiable(cx: &mut Evaluator<'_>, id: InstanceId, class: ClassId) {
    let Some(text) = cx.definition(class).cloned() else { return };
    let Some(declaration) = cx.instances[id].declaration.clone() else { return };
    let span = declaration.clause().type_name.span;
    let replaceable = declaration.element.replaceable.is_some();
    if let Some(partial) = cx.partial_definition(class) {
        let (class, path) = (text.name.name, cx.path(id));
        let cause = InstantiateCause::PartialClass { class, path, replaceable };
        cx.problems
            .push(Diagnostic::new(cause, span).also(partial.name.span, "declared `partial` here"));
    }
    if matches!(text.kind, ast::ClassKind::Package | ast::ClassKind::Function { .. }) {
        cx.report(InstantiateCause::NotAComponentClass { class: text.name.name }, span);
    }
    // A component whose class is around it would hold itself without end.
    let mut around = cx.instances[id].parent;
    let mut depth = 0;
    while let Some(holder) = around {
        if let Some(c) = cx.instances[holder].class
            && let ClassDefinition::Written(outer) = &cx.classes[c].body
            && std::sync::Arc::ptr_eq(outer, &text)
            && cx.instances[holder].subscripts.is_empty()
        {
            depth += 1;
        }
        around = cx.instances[holder].parent;
    }
    if depth > 0 {
        cx.problems.push(
            Diagnostic::new(InstantiateCause::ContainsItself { class: text.name.name }, span)
                .label("a component of the class being defined"),
        );
        cx.instances[id].kind = InstanceKind::Broken;
    }
}
