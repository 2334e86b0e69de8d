//! New variables of expandable connectors: copies of what they are connected to.

use std::rc::Rc;

use super::connection_ends::{At, Missing, unfilled};
use super::{Buses, is_expandable};
use crate::base::name::Name;
use crate::instantiate::{Context, package_like};
use crate::ir::ast::TypePrefix;
use crate::ir::instance::{Instance, InstanceId, InstanceKind};

/// Elements that one array may be given: a subscript beyond it is a slip, not a model.
const MOST: usize = 100_000;

/// Gives a connector the variable that a connection names; true if there is something new.
pub(crate) fn add(cx: &mut Context<'_>, missing: &Missing, like: &At, buses: &mut Buses) -> bool {
    let Missing { bus, name, index } = *missing;
    if !matches!(like, At::Instance(_) | At::Element(_)) {
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

/// Gives each connector of a set what the others have; true if there is something new.
pub(crate) fn even_out(cx: &mut Context<'_>, set: &[InstanceId], buses: &mut Buses) -> bool {
    let mut changed = false;
    let mut names: Vec<(Name, InstanceId)> = Vec::new();
    for &bus in set {
        for child in children(cx, bus) {
            let name = cx.instances[child].name;
            match names.iter().find(|(n, _)| *n == name) {
                None => names.push((name, child)),
                Some((_, first)) => {
                    let first = *first;
                    changed |= same(cx, first, child, bus, buses);
                }
            }
        }
    }
    for &bus in set {
        for (name, like) in &names {
            if cx.child(bus, *name).is_none()
                && let Some(child) = copy(cx, &At::Instance(*like), bus, *name, &[], buses)
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

/// Two variables of one name in one set: buses in buses belong together too, and arrays get the same
/// elements.
fn same(
    cx: &mut Context<'_>,
    a: InstanceId,
    b: InstanceId,
    bus_of_b: InstanceId,
    buses: &mut Buses,
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
                let of = |list: &[InstanceId], cx: &Context<'_>| {
                    list.get(k).copied().filter(|e| !unfilled(cx, *e))
                };
                changed |= match (of(&mine, cx), of(&theirs, cx)) {
                    (Some(x), Some(y)) => {
                        is_expandable(cx, x) && is_expandable(cx, y) && buses.join(x, y)
                    }
                    (Some(x), None) if buses.open.contains(&b) => {
                        element(cx, bus_of_b, name, k + 1, &At::Instance(x), buses)
                    }
                    (None, Some(y)) if buses.open.contains(&a) => {
                        element(cx, bus_of_a, name, k + 1, &At::Instance(y), buses)
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

/// An array declared with `:` takes the sizes of what it is connected to.
pub(crate) fn resize(
    cx: &mut Context<'_>,
    id: InstanceId,
    like: InstanceId,
    buses: &mut Buses,
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
            let Some(k) = elements.iter().position(|e| !unfilled(cx, *e)) else { return false };
            element(cx, bus, name, k + 1, &At::Instance(elements[k]), buses)
        }
        _ => false,
    }
}

/// Makes element `index` of the array `name` of a connector, and the array, if need be.
fn element(
    cx: &mut Context<'_>,
    bus: InstanceId,
    name: Name,
    index: usize,
    like: &At,
    buses: &mut Buses,
) -> bool {
    if index > MOST {
        return false;
    }
    let array = match cx.child(bus, name) {
        Some(id) => id,
        None => {
            let holder = blank(cx, bus, name, &[]);
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
        // Declared with `:`, and not connected as a whole.
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
        let place = blank(cx, array, name, &[k]);
        elements.push(cx.instances.push(Instance { kind: InstanceKind::Absent, ..place }));
    }
    let mut changed = false;
    if unfilled(cx, elements[index - 1])
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
fn blank(cx: &Context<'_>, parent: InstanceId, name: Name, subscripts: &[usize]) -> Instance {
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

/// A new instance of the type of another one; `None` where that is broken. Values and attributes stay
/// behind: they belong to the other one's declaration.
fn copy(
    cx: &mut Context<'_>,
    like: &At,
    parent: InstanceId,
    name: Name,
    subscripts: &[usize],
    buses: &mut Buses,
) -> Option<InstanceId> {
    let (id, scalar) = match like {
        At::Instance(id) => (*id, false),
        At::Element(id) => (*id, true),
        At::Missing(_) | At::Absent => return None,
    };
    cx.complete(id);
    let original = cx.instances[id].clone();
    let prefix = TypePrefix { causality: None, ..original.prefix };
    let new = Instance {
        class: original.class,
        declaration: original.declaration.clone(),
        scope: original.scope,
        prefix,
        ..blank(cx, parent, name, subscripts)
    };
    match original.kind {
        InstanceKind::Outer(inner) => {
            copy(cx, &At::Instance(inner), parent, name, subscripts, buses)
        }
        InstanceKind::Variable { ty, dims, .. } => {
            let dims = if scalar { Rc::from([]) } else { dims };
            let kind = InstanceKind::Variable { ty, dims, first: None };
            Some(cx.instances.push(Instance { kind, ..new }))
        }
        InstanceKind::Object(_) => {
            // Without its declaration it is completed from its class alone.
            let declaration = new.declaration.clone();
            let made = cx.instances.push(Instance {
                layers: original.layers.clone(),
                declaration: None,
                ..new
            });
            cx.complete_all(made);
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
                let element = match copy(cx, &At::Instance(*e), made, name, &at, buses) {
                    Some(element) => element,
                    None => {
                        let place = blank(cx, made, name, &at);
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

fn children(cx: &Context<'_>, bus: InstanceId) -> Vec<InstanceId> {
    match &cx.instances[bus].kind {
        InstanceKind::Object(children) => children.to_vec(),
        _ => Vec::new(),
    }
}

fn append(cx: &mut Context<'_>, bus: InstanceId, child: InstanceId) {
    let mut all = children(cx, bus);
    all.push(child);
    cx.instances[bus].kind = InstanceKind::Object(all.into());
}
