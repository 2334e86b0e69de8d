//! `inner` and `outer`: the `inner` component must be plug-compatible with the `outer` ones, and
//! only it may be modified (section 5.4 of the specification).

use std::rc::Rc;

use super::cause::{InnerMismatch, InstantiateCause};
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::classes::cause::ClassCause;
use crate::classes::{ROOT, package_like};
use crate::evaluate::Evaluator;
use crate::ir::ast::{self, ClassKind};
use crate::ir::instance::{ClassId, Declaration, Instance, InstanceId, InstanceKind};
use crate::ir::modification::LayerSource;

/// The `inner` component of that name in the components around.
pub(crate) fn find_inner(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    wanted: Name,
) -> Option<InstanceId> {
    let mut at = around(cx, id);
    while let Some(holder) = at {
        at = around(cx, holder);
        if !matches!(cx.instances[holder].kind, InstanceKind::Object(_)) {
            continue;
        }
        if let Some(found) = cx.child(holder, wanted)
            && found != id
            && cx.instances[found].declaration.as_ref().is_some_and(|d| d.element.inner)
        {
            return Some(found);
        }
    }
    None
}

/// The component around an instance; around a package in a component that component.
fn around(cx: &Evaluator<'_>, id: InstanceId) -> Option<InstanceId> {
    let instance = &cx.instances[id];
    let package = instance.class.filter(|c| cx.package_instances.get(c) == Some(&id));
    let holder = package.map(|c| cx.classes[c].holder);
    instance.parent.or(holder).filter(|around| *around != ROOT.instance && *around != id)
}

/// The component that a name refers to: to all but the components inside it, an `inner outer`
/// component is the outer one (section 5.4).
pub(crate) fn outer_of(cx: &mut Evaluator<'_>, id: InstanceId) -> InstanceId {
    let both = cx.instances[id]
        .declaration
        .as_ref()
        .filter(|d| d.element.inner && d.element.outer)
        .map(|d| d.component().name.name);
    match both {
        Some(name) => find_inner(cx, id, name).unwrap_or(id),
        None => id,
    }
}

/// Adds a missing `inner` component at the top of the model, with the defaults of its class: an
/// `outer` model needs it only once (section 5.4).
pub(crate) fn add_inner(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    outer: &Declaration,
) -> Option<InstanceId> {
    let scope = cx.instances[id].scope;
    let class = cx.find_class(&outer.clause().type_name, scope)?;
    if matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector)
        || cx.partial_definition(class).is_some()
        || !outer.component().dims.is_empty()
    {
        return None;
    }
    let mut top = id;
    while let Some(around) = around(cx, top) {
        top = around;
    }
    let InstanceKind::Object(children) = cx.instances[top].kind.clone() else { return None };
    let mut declaration = outer.clone();
    let element = Rc::make_mut(&mut declaration.element);
    (element.inner, element.outer, element.protected) = (true, false, false);
    let name = outer.component().name;
    let added = cx.instances.push(Instance {
        parent: Some(top),
        declaration: Some(declaration),
        scope,
        class: None,
        ..package_like(class, name.name)
    });
    cx.instances[top].kind =
        InstanceKind::Object(children.iter().copied().chain([added]).collect());
    let prefix = match outer.clause().prefix.variability {
        Some(ast::Variability::Constant) => "constant ",
        Some(ast::Variability::Parameter) => "parameter ",
        _ => "",
    };
    let class = outer.clause().type_name.to_string();
    let cause = ClassCause::InnerAdded { name: name.name, prefix, class };
    cx.problems.push(Diagnostic::new(cause, name.span).label("of this class, with its defaults"));
    cx.added_inner.insert(added);
    super::component::complete_all(cx, added);
    Some(added)
}

/// `outer` components are modified where the `inner` one is declared.
pub(crate) fn check_outer_unmodified(cx: &mut Evaluator<'_>, id: InstanceId, name: ast::Ident) {
    for layer in cx.instances[id].layers.clone().iter() {
        let modified = match &layer.source {
            LayerSource::ParameterOverride(..) => None,
            _ => layer.inner().filter(|m| m.binding.is_some() || !m.args.is_empty()),
        };
        let Some(modified) = modified else { continue };
        let cause = InstantiateCause::OuterModified { name: name.name };
        cx.problems.push(Diagnostic::new(cause, modified.span).also(name.span, "declared `outer`"));
    }
}

/// The `inner` component must have the elements of the `outer` one.
pub(crate) fn check_inner(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    inner: InstanceId,
    wanted: ClassId,
    name: ast::Ident,
) {
    let Some(found) = cx.instances[inner].declaration.clone() else { return };
    let scope = cx.instances[inner].scope;
    let given = match cx.instances[inner].class {
        Some(class) => class,
        None => match cx.find_class(&found.clause().type_name, scope) {
            Some(class) => class,
            None => return,
        },
    };
    let Some(declared) = cx.instances[id].declaration.clone() else { return };
    let mut rank = |d: &Declaration, class: ClassId| {
        let of_type: usize = cx.table(class).dims.iter().map(|(d, _)| d.len()).sum();
        d.component().dims.len() + d.clause().type_dims.len() + of_type
    };
    let (a, b) = (rank(&declared, wanted), rank(&found, given));
    let why = if a == b {
        crate::rules::plug_compatibility::incompatibility_without_sizes(cx, wanted, given)
            .map(InnerMismatch::Class)
    } else {
        Some(InnerMismatch::Rank { outer: a, inner: b })
    };
    let why = why.or_else(|| size_mismatch(cx, id, inner, &declared, wanted));
    let why = why.or_else(|| added_for_another(cx, inner, wanted, given));
    let Some(why) = why else { return };
    let cause = InstantiateCause::IncompatibleInner { name: name.name, why };
    cx.problems.push(
        Diagnostic::new(cause, name.span)
            .also(found.component().name.span, "the `inner` component"),
    );
}

/// An added `inner` component serves `outer` components of one class only.
fn added_for_another(
    cx: &mut Evaluator<'_>,
    inner: InstanceId,
    wanted: ClassId,
    given: ClassId,
) -> Option<InnerMismatch> {
    let same = match (cx.definition(wanted), cx.definition(given)) {
        (Some(a), Some(b)) => std::sync::Arc::ptr_eq(a, b),
        _ => wanted == given,
    };
    (!same && cx.added_inner.contains(&inner))
        .then(|| InnerMismatch::AddedForAnother(cx.classes[given].full_name))
}

/// Sizes of an `outer` component that differ from those of the `inner` one.
fn size_mismatch(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    inner: InstanceId,
    declared: &Declaration,
    class: ClassId,
) -> Option<InnerMismatch> {
    if declared.component().dims.iter().any(|d| matches!(d, ast::Subscript::Colon(_))) {
        return None;
    }
    cx.complete(inner);
    let found = match &cx.instances[inner].kind {
        InstanceKind::Variable { dims, .. } | InstanceKind::Array { dims, .. } => dims.clone(),
        _ => return None,
    };
    let table = cx.table(class);
    let wanted = super::component::sizes(cx, id, declared, &table)?;
    (*wanted != *found)
        .then(|| InnerMismatch::Size { outer: wanted.to_vec(), inner: found.to_vec() })
}
