//! Diagnostics of components that cannot be instantiated.

use crate::base::diag::Diagnostic;
use crate::evaluate::Evaluator;
use crate::ir::ast;
use crate::ir::instance::{ClassDefinition, ClassId, InstanceId, InstanceKind};

pub(crate) fn report_component_cycle(cx: &mut Evaluator<'_>, id: InstanceId) {
    let span = cx.declared_at(id);
    let path = cx.path(id);
    cx.problems.push(
        Diagnostic::error("MO0205", span, format!("the structure of `{path}` depends on itself"))
            .label("needed for its own size, condition or class")
            .help("break the circle: give one of the sizes or conditions a value of its own"),
    );
    cx.instances[id].kind = InstanceKind::Broken;
}

/// Partial classes, packages and functions cannot be instantiated, nor a class inside itself.
pub(crate) fn check_instantiable(cx: &mut Evaluator<'_>, id: InstanceId, class: ClassId) {
    let Some(text) = cx.definition(class).cloned() else { return };
    let Some(declaration) = cx.instances[id].declaration.clone() else { return };
    let span = declaration.clause().type_name.span;
    let replaceable = declaration.element.replaceable.is_some();
    if let Some(partial) = cx.partial_definition(class) {
        let d = Diagnostic::error(
            "MO0208",
            span,
            format!("`{}` is partial: `{}` cannot be of this class", text.name.name, cx.path(id)),
        )
        .also(partial.name.span, "declared `partial` here");
        cx.problems.push(if replaceable {
            d.help("redeclare the component with a class that is not partial")
        } else {
            d.help("use a class that extends it")
        });
    }
    if matches!(text.kind, ast::ClassKind::Package | ast::ClassKind::Function { .. }) {
        cx.error(
            "MO0208",
            span,
            format!(
                "`{}` is a package or a function, not the class of a component",
                text.name.name
            ),
        );
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
            Diagnostic::error("MO0205", span, format!("`{}` contains itself", text.name.name))
                .label("a component of the class being defined")
                .help("a model can not hold a component of its own class"),
        );
        cx.instances[id].kind = InstanceKind::Broken;
    }
}
