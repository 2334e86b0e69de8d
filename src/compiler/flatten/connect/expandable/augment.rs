//! Augments expandable connectors by new variables: copies of the variables they are connected to.

use std::rc::Rc;

use super::connection_ends::{EndTarget, MissingVariable, is_unfilled};
use super::{AugmentationSets, is_expandable};
use crate::base::name::Name;
use crate::classes::package_like;
use crate::evaluate::Evaluator;
use crate::ir::ast::TypePrefix;
use crate::ir::instance::{Instance, InstanceId, InstanceKind};

/// Maximum number of elements of an array that connections create; larger subscripts are errors.
const MAX_ELEMENTS: usize = 100_000;

/// Adds the variable that a connection refers to; true if the connector has changed.
pub(crate) fn add(
    cx: &mut Evaluator<'_>,
    missing: &MissingVariable,
    like: &EndTarget,
    buses: &mut AugmentationSets,
) -> bool {
    let MissingVariable { bus, name, index } = *missing;
    if !matches!(like, EndTarget::Instance(_) | EndTarget::Element(_)) {
        return false;
    }
    match index {
        None => {
            // An earlier part of the same connection may have added it.
            if cx.child(bus, name).is_some() {
                return false;
            }
            let Some(child) = copy(cx, like, bus, name, &[], buses) else { return false };
            append(cx, bus, child);
            true
        }
        Some(index) => element(cx, bus, name, index, like, buses),
    }
}

/// Gives each connector of a set the variables of all others; true if a connector has changed.
pub(crate) fn equalize(
    cx: &mut Evaluator<'_>,
    set: &[InstanceId],
    buses: &mut AugmentationSets,
) -> bool {
    let mut changed = false;
    let mut names: Vec<(Name, InstanceId)> = Vec::new();
    for &bus in set {
        for child in children(cx, bus) {
            let name = cx.instances[child].name;
            match names.iter().find(|(n, _)| *n == name) {
                None => names.push((name, child)),
                Some((_, first)) => {
                    let first = *first;
                    changed |= unify(cx, first, child, bus, buses);
                }
            }
        }
    }
    for &bus in set {
        for (name, like) in &names {
            if cx.child(bus, *name).is_none()
                && let Some(child) = copy(cx, &EndTarget::Instance(*like), bus, *name, &[], buses)
            {
                if buses.open.contains(like) {
                    buses.open.insert(child);
                }
                append(cx, bus, child);
                changed = true;
            }
        }
    }
    changed
}

/// Unifies two variables of the same name in one set: nested buses join the same set, and arrays
/// get the same elements.
fn unify(
    cx: &mut Evaluator<'_>,
    a: InstanceId,
    b: InstanceId,
    bus_of_b: InstanceId,
    buses: &mut AugmentationSets,
) -> bool {
    match (cx.instances[a].kind.clone(), cx.instances[b].kind.clone()) {
        (InstanceKind::Object(_), InstanceKind::Object(_)) => {
            is_expandable(cx, a) && is_expandable(cx, b) && buses.join(a, b)
        }
        (
            InstanceKind::Array { elements: mine, .. },
            InstanceKind::Array { elements: theirs, .. },
        ) => {
            let mut changed = false;
            let name = cx.instances[a].name;
            let Some(bus_of_a) = cx.instances[a].parent else { return false };
            for k in 0..mine.len().max(theirs.len()) {
                let of = |list: &[InstanceId], cx: &Evaluator<'_>| {
                    list.get(k).copied().filter(|e| !is_unfilled(cx, *e))
                };
                changed |= match (of(&mine, cx), of(&theirs, cx)) {
                    (Some(x), Some(y)) => {
                        is_expandable(cx, x) && is_expandable(cx, y) && buses.join(x, y)
                    }
                    (Some(x), None) if buses.open.contains(&b) => {
                        element(cx, bus_of_b, name, k + 1, &EndTarget::Instance(x), buses)
                    }
                    (None, Some(y)) if buses.open.contains(&a) => {
                        element(cx, bus_of_a, name, k + 1, &EndTarget::Instance(y), buses)
                    }
                    _ => false,
                };
            }
            changed
        }
        (InstanceKind::Variable { dims, .. }, _) if dims.contains(&0) => resize(cx, a, b, buses),
        (_, InstanceKind::Variable { dims, .. }) if dims.contains(&0) => resize(cx, b, a, buses),
        _ => false,
    }
}

/// Gives an array declared with `:` the sizes of the array it is connected to.
pub(crate) fn resize(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    like: InstanceId,
    buses: &mut AugmentationSets,
) -> bool {
    let open = cx.instances[id].parent.is_some_and(|p| is_expandable(cx, p));
    let InstanceKind::Variable { ty, dims, .. } = cx.instances[id].kind.clone() else {
        return false;
    };
    match cx.instances[like].kind.clone() {
        InstanceKind::Variable { ty: other, dims: wanted, .. }
            if open && ty == other && wanted.len() == dims.len() && !wanted.contains(&0) =>
        {
            cx.instances[id].kind = InstanceKind::Variable { ty, dims: wanted, first: None };
            true
        }
        InstanceKind::Array { dims: wanted, elements }
            if open && wanted.len() == dims.len() && !elements.is_empty() =>
        {
            let (name, parent) = (cx.instances[id].name, cx.instances[id].parent);
            let Some(bus) = parent else { return false };
            let Some(k) = elements.iter().position(|e| !is_unfilled(cx, *e)) else { return false };
            element(cx, bus, name, k + 1, &EndTarget::Instance(elements[k]), buses)
        }
        _ => false,
    }
}

/// Creates element `index` of the array `name` of a connector and, if necessary, the array.
fn element(
    cx: &mut Evaluator<'_>,
    bus: InstanceId,
    name: Name,
    index: usize,
    like: &EndTarget,
    buses: &mut AugmentationSets,
) -> bool {
    if index > MAX_ELEMENTS {
        return false;
    }
    let array = match cx.child(bus, name) {
        Some(id) => id,
        None => {
            let holder = new_instance(cx, bus, name, &[]);
            let array = cx.instances.push(Instance {
                kind: InstanceKind::Array { dims: Rc::from([0]), elements: Rc::from([]) },
                ..holder
            });
            append(cx, bus, array);
            buses.open.insert(array);
            array
        }
    };
    let mut elements = match cx.instances[array].kind.clone() {
        InstanceKind::Array { dims, elements } if dims.len() == 1 => elements.to_vec(),
        // Declared with `:` and not connected as a whole.
        InstanceKind::Variable { dims, .. } if *dims == [0] => {
            buses.open.insert(array);
            Vec::new()
        }
        _ => return false,
    };
    if !buses.open.contains(&array) {
        return false;
    }
    while elements.len() < index {
        let k = elements.len() + 1;
        let place = new_instance(cx, array, name, &[k]);
        elements.push(cx.instances.push(Instance { kind: InstanceKind::Absent, ..place }));
    }
    let mut changed = false;
    if is_unfilled(cx, elements[index - 1])
        && let Some(new) = copy(cx, like, array, name, &[index], buses)
    {
        elements[index - 1] = new;
        changed = true;
    }
    let dims = Rc::from([elements.len()]);
    cx.instances[array].kind = InstanceKind::Array { dims, elements: elements.into() };
    changed
}

/// An instance without declaration and class.
fn new_instance(
    cx: &Evaluator<'_>,
    parent: InstanceId,
    name: Name,
    subscripts: &[usize],
) -> Instance {
    let scope = cx.instances[parent].scope;
    Instance {
        parent: Some(parent),
        subscripts: subscripts.into(),
        class: None,
        scope,
        protected: cx.instances[parent].protected,
        ..package_like(scope.class, name)
    }
}

/// A new instance with the type of another one; `None` if that one is broken. Values and attributes
/// are not copied, because they belong to the declaration of the other one.
fn copy(
    cx: &mut Evaluator<'_>,
    like: &EndTarget,
    parent: InstanceId,
    name: Name,
    subscripts: &[usize],
    buses: &mut AugmentationSets,
) -> Option<InstanceId> {
    let (id, scalar) = match like {
        EndTarget::Instance(id) => (*id, false),
        EndTarget::Element(id) => (*id, true),
        EndTarget::Missing(_) | EndTarget::Absent => return None,
    };
    cx.complete(id);
    let original = cx.instances[id].clone();
    let prefix = TypePrefix { causality: None, ..original.prefix };
    let new = Instance {
        class: original.class,
        declaration: original.declaration.clone(),
        scope: original.scope,
        prefix,
        ..new_instance(cx, parent, name, subscripts)
    };
    match original.kind {
        InstanceKind::Outer(inner) => {
            copy(cx, &EndTarget::Instance(inner), parent, name, subscripts, buses)
        }
        InstanceKind::Variable { ty, dims, .. } => {
            let dims = if scalar { Rc::from([]) } else { dims };
            let kind = InstanceKind::Variable { ty, dims, first: None };
            Some(cx.instances.push(Instance { kind, ..new }))
        }
        InstanceKind::Object(_) => {
            // Without a declaration, it is completed from its class alone.
            let declaration = new.declaration.clone();
            let made = cx.instances.push(Instance {
                layers: original.layers.clone(),
                declaration: None,
                ..new
            });
            crate::instantiate::component::complete_all(cx, made);
            cx.instances[made].declaration = declaration;
            if is_expandable(cx, made) {
                buses.add(made);
                buses.join(id, made);
            }
            Some(made)
        }
        InstanceKind::Array { dims, elements } => {
            let made = cx.instances.push(new);
            let mut own = Vec::with_capacity(elements.len());
            for e in elements.iter() {
                let at = cx.instances[*e].subscripts.clone();
                let element = match copy(cx, &EndTarget::Instance(*e), made, name, &at, buses) {
                    Some(element) => element,
                    None => {
                        let place = new_instance(cx, made, name, &at);
                        cx.instances.push(Instance { kind: InstanceKind::Absent, ..place })
                    }
                };
                own.push(element);
            }
            cx.instances[made].kind = InstanceKind::Array { dims, elements: own.into() };
            Some(made)
        }
        _ => None,
    }
}

fn children(cx: &Evaluator<'_>, bus: InstanceId) -> Vec<InstanceId> {
    match &cx.instances[bus].kind {
        InstanceKind::Object(children) => children.to_vec(),
        _ => Vec::new(),
    }
}

fn append(cx: &mut Evaluator<'_>, bus: InstanceId, child: InstanceId) {
    let mut all = children(cx, bus);
    all.push(child);
    cx.instances[bus].kind = InstanceKind::Object(all.into());
}
