//! Component instances: class, redeclaration, condition, dimensions, children.

use std::rc::Rc;

use crate::base::index::FastSet;
use crate::base::name::Name;
use crate::classes::attribute::{is_attribute, is_within};
use crate::classes::inheritance::merge_prefix;
use crate::evaluate::Evaluator;
use crate::evaluate::value::advance;
use crate::ir::ast::{self, ElementKind, Subscript};
use crate::ir::instance::{
    ClassId, ClassTable, Declaration, Entry, EntryKind, Instance, InstanceId, InstanceKind,
    Redeclaration, Scope,
};
use crate::ir::modification::{Binding, Layer, LayerSource};

/// Completes an instance and everything below it.
pub fn complete_all(cx: &mut Evaluator<'_>, root: InstanceId) {
    let mut stack = vec![root];
    while let Some(id) = stack.pop() {
        cx.complete(id);
        match &cx.instances[id].kind {
            InstanceKind::Object(children) => stack.extend(children.iter().rev()),
            InstanceKind::Array { elements, .. } => stack.extend(elements.iter().rev()),
            _ => {}
        }
    }
}

/// The kind of an instance; `None` after an error.
pub(super) fn kind(cx: &mut Evaluator<'_>, id: InstanceId) -> Option<InstanceKind> {
    match cx.instances[id].declaration.clone() {
        Some(declaration) => match from_cache(cx, id, &declaration) {
            Some(kind) => Some(kind),
            None => declared(cx, id, &declaration),
        },
        None => object(cx, id),
    }
}

/// The kind of a component whose declaration is cached.
fn from_cache(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    declaration: &Declaration,
) -> Option<InstanceKind> {
    let cached = cx.cached_declaration(id, declaration)?;
    cx.instances[id].class = Some(cached.class);
    merge_prefix_around(cx, id, cached.prefix);
    match cached.scalar {
        Some(ty) => Some(InstanceKind::Variable { ty, dims: cx.no_sizes.clone(), first: None }),
        None => Some(object(cx, id).unwrap_or(InstanceKind::Broken)),
    }
}

/// The kind of a declared component; `None` after an error.
fn declared(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    declaration: &Declaration,
) -> Option<InstanceKind> {
    let said = cx.problems.iter().len();
    let scope = cx.instances[id].scope;
    let element = &declaration.element;
    let clause = declaration.clause();
    let component = declaration.component();
    if element.outer && !element.inner {
        super::inner_outer::check_outer_unmodified(cx, id, component.name);
        let inner = super::inner_outer::find_inner(cx, id, component.name.name);
        if let Some(inner) = inner.or_else(|| super::inner_outer::add_inner(cx, id, declaration)) {
            let class = cx.class_or_report(&clause.type_name, scope)?;
            cx.instances[id].class = Some(class);
            super::inner_outer::check_inner(cx, id, inner, class, component.name);
            return Some(InstanceKind::Outer(inner));
        }
        cx.report_no_inner(component.name);
        return None;
    }
    let condition = match &component.condition {
        Some(condition) => Some((condition.clone(), scope)),
        // Parts that the redeclaration omits stay as they were (section 7.3).
        None => replaced_declaration(cx, id, declaration)
            .and_then(|(before, own)| Some((before.component().condition.clone()?, own))),
    };
    if let Some((condition, scope)) = &condition {
        match cx.fold_boolean(condition, *scope) {
            Some(true) => {}
            Some(false) => return Some(InstanceKind::Absent),
            None => return None,
        }
    }
    let of_class = cx.check_type_name(&clause.type_name, scope)?;
    let class = cx.class_or_report(&clause.type_name, scope)?;
    if !of_class.is_empty() {
        let own = cx.instances[id].layers.iter().cloned();
        cx.instances[id].layers = own.chain(of_class).collect();
    }
    let redeclared = class_redeclarations(&cx.instances[id].layers.clone());
    let class = cx.with_redeclarations(class, redeclared);
    cx.instances[id].class = Some(class);
    let table = cx.table(class);
    if table.broken {
        return None;
    }

    crate::rules::prefix::check_component(cx, clause.prefix, class, table.scalar, component.name);
    let mut prefix = clause.prefix;
    merge_prefix(&mut prefix, table.prefix);
    if table.scalar.is_none() {
        crate::rules::prefix::check_prefix_conflict(cx, prefix, &table, component.name);
    }
    merge_prefix_around(cx, id, prefix);

    let sizes = sizes(cx, id, declaration, &table)?;
    if table.scalar.is_some() {
        check_attribute_names(cx, id, &sizes);
    } else {
        super::error::check_instantiable(cx, id, class);
    }
    if cx.problems.iter().len() == said {
        cx.cache_declaration(id, declaration, prefix);
    }
    match table.scalar {
        Some(ty) => {
            let dims = if sizes.is_empty() { cx.no_sizes.clone() } else { sizes.into() };
            Some(InstanceKind::Variable { ty, dims, first: None })
        }
        None if sizes.is_empty() => object(cx, id),
        None => Some(array_of_objects(cx, id, class, sizes)),
    }
}

/// Gives a component the prefixes of its declaration and class, with those of the components around it.
pub(crate) fn merge_prefix_around(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    mut prefix: ast::TypePrefix,
) {
    let around = cx.instances[id].prefix;
    prefix.variability = match (prefix.variability, around.variability) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    };
    prefix.connection = prefix.connection.or(around.connection);
    prefix.causality = prefix.causality.or(around.causality);
    cx.instances[id].prefix = prefix;
}

/// Dimensions of a component, of its type as written, and of its short classes.
pub(crate) fn sizes(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    declaration: &Declaration,
    table: &ClassTable,
) -> Option<Vec<usize>> {
    let scope = cx.instances[id].scope;
    let component = declaration.component();
    let mut written: Vec<(Subscript, Scope)> = Vec::new();
    for s in component.dims.iter().chain(&declaration.clause().type_dims) {
        written.push((s.clone(), scope));
    }
    if written.is_empty() {
        written = dims_before(cx, id, declaration);
    }
    for (list, holder) in &table.dims {
        let outside = cx.outside(*holder);
        written.extend(list.iter().map(|s| (s.clone(), outside)));
    }
    // One may be that of another dimension: `A[:, size(A, 1)]`.
    let sizes = cx.with_sizing(id, written.len(), |cx| {
        sizes_of_dimensions(cx, id, component.name, &written)
    })?;
    cx.check_count(&sizes, component.name.span)?;
    Some(sizes)
}

/// Sizes as written, each where it is written: those that are left open come from the binding.
fn sizes_of_dimensions(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    name: ast::Ident,
    written: &[(Subscript, Scope)],
) -> Option<Vec<usize>> {
    let mut sizes = vec![0; written.len()];
    let mut from_binding: Option<Vec<usize>> = None;
    for (k, (subscript, _)) in written.iter().enumerate() {
        let Subscript::Colon(span) = subscript else { continue };
        if from_binding.is_none() {
            let mode = cx.mode.sizing();
            let value = cx.with_mode(mode, |cx| match cx.binding_value(id) {
                None if !cx.bound(id) => start_value(cx, id),
                value => value,
            });
            // The reason why a binding has no value was reported.
            if value.is_none() && cx.bound(id) && cx.problems.has_errors() {
                return None;
            }
            from_binding = Some(value.map(|v| v.dims().to_vec()).unwrap_or_default());
        }
        sizes[k] = match from_binding.as_ref().and_then(|d| d.get(k)) {
            Some(n) => *n,
            // Connections will say (section 9.1.3).
            None if in_expandable(cx, id) => 0,
            None => {
                cx.report_unknown_size(name, *span);
                return None;
            }
        };
        cx.sizing.note(k, sizes[k]);
    }
    for (k, (subscript, scope)) in written.iter().enumerate() {
        if let Subscript::Expr(e) = subscript {
            sizes[k] = cx.fold_size(e, *scope)?;
            cx.sizing.note(k, sizes[k]);
        }
    }
    Some(sizes)
}

/// The start value of a variable, from which its open sizes are taken where it has no other.
fn start_value(cx: &mut Evaluator<'_>, id: InstanceId) -> Option<crate::evaluate::value::Value> {
    let start = cx.attribute(id, crate::base::name::name("start"))?;
    cx.evaluate(&start.value, start.scope)
}

/// The sizes of the declaration that a redeclared component replaces: they stay (section 7.3).
fn dims_before(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    now: &Declaration,
) -> Vec<(Subscript, Scope)> {
    let Some((before, scope)) = replaced_declaration(cx, id, now) else { return Vec::new() };
    let dims = before.component().dims.iter().chain(&before.clause().type_dims);
    dims.map(|s| (s.clone(), scope)).collect()
}

/// The declaration in the class that `now` replaces, if it does, with its scope.
fn replaced_declaration(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    now: &Declaration,
) -> Option<(Declaration, Scope)> {
    if !now.element.redeclare && now.element.replaceable.is_none() {
        return None;
    }
    let parent = cx.instances[id].parent?;
    let wanted = cx.instances[id].name;
    let table = cx.table_of(parent);
    let entry = table.index.get(&wanted).map(|at| &table.entries[*at])?;
    let EntryKind::Component(before) = &entry.kind else { return None };
    if Rc::ptr_eq(&before.element, &now.element) {
        return None;
    }
    Some((before.clone(), Scope { instance: parent, class: entry.class }))
}

/// Whether the component around an instance is an expandable connector.
fn in_expandable(cx: &mut Evaluator<'_>, id: InstanceId) -> bool {
    let class = cx.instances[id].parent.and_then(|p| cx.instances[p].class);
    class.is_some_and(|c| cx.kind(c) == ast::ClassKind::ExpandableConnector)
}

/// An array of components with components: one instance for each element.
fn array_of_objects(
    cx: &mut Evaluator<'_>,
    id: InstanceId,
    class: ClassId,
    sizes: Vec<usize>,
) -> InstanceKind {
    let count: usize = sizes.iter().product();
    let template = cx.instances[id].clone();
    let mut elements = Vec::with_capacity(count);
    let mut subscripts = vec![1; sizes.len()];
    for _ in 0..count {
        let layers = template.layers.iter().filter_map(|l| l.element(&subscripts)).collect();
        let layers = listed(cx, layers);
        let element = cx.instances.push(Instance {
            parent: Some(id),
            subscripts: subscripts.clone().into(),
            declaration: None,
            layers,
            class: Some(class),
            kind: InstanceKind::Pending,
            ..template.clone()
        });
        elements.push(element);
        advance(&mut subscripts, &sizes);
    }
    InstanceKind::Array { dims: sizes.into(), elements: elements.into() }
}

/// The children of a component with components.
pub(crate) fn object(cx: &mut Evaluator<'_>, id: InstanceId) -> Option<InstanceKind> {
    let class = cx.instances[id].class?;
    let table = cx.table(class);
    check_modified_names(cx, id, &table);
    if !crate::rules::plug_compatibility::check_redeclarations(cx, id, &table) {
        return None;
    }
    let mut children = Vec::with_capacity(table.component_count);
    for entry in &table.entries {
        if let EntryKind::Component(declaration) = &entry.kind {
            children.push(child_instance(cx, id, entry, declaration));
        }
    }
    Some(InstanceKind::Object(children.into()))
}

fn child_instance(
    cx: &mut Evaluator<'_>,
    parent: InstanceId,
    entry: &Entry,
    declaration: &Declaration,
) -> InstanceId {
    let wanted = entry.name.name;
    let own = Scope { instance: parent, class: entry.class };
    let mut layers = Vec::new();
    let outer = cx.instances[parent].layers.clone();
    let inherited: Vec<Layer> = cx.clause_layers(&entry.layers, parent).collect();
    let mut scope = own;
    let mut declared = declaration.clone();
    // In a chain of redeclarations the outermost one counts; the others contribute their
    // constraining clauses.
    let mut replaced = false;
    for layer in outer.iter().chain(&inherited) {
        layer.child(wanted, &mut layers);
        for (element, component, subscripts) in layer.component_redeclarations(wanted) {
            let element = Rc::new((**element).clone());
            let replacement = Declaration { element, component };
            let constraint = constraint(&replacement.element).cloned();
            if !replaced || constraint.is_none() {
                let modification = replacement.component().modification.as_ref();
                push_whole(&mut layers, modification, layer.scope, &subscripts);
            }
            if let Some(constraint) = constraint {
                let modification = constraint.modification.as_ref();
                push_whole(&mut layers, modification, layer.scope, &subscripts);
            }
            if !replaced {
                replaced = true;
                scope = layer.scope;
                declared = replacement;
                let before = &declaration.element;
                if (before.inner, before.outer) != (declared.element.inner, declared.element.outer)
                {
                    // Parts that the redeclaration omits stay as they were (section 7.3).
                    let element = Rc::make_mut(&mut declared.element);
                    element.inner |= before.inner;
                    element.outer |= before.outer;
                }
            }
        }
    }
    // The modifications of the original declaration also hold for a replacement (section 7.3.2),
    // unless a constraining clause has its own.
    let constraint = constraint(&declaration.element);
    let no_subscripts = cx.no_sizes.clone();
    if !replaced || constraint.is_none() {
        let modification = declaration.component().modification.as_ref();
        push_whole(&mut layers, modification, own, &no_subscripts);
    }
    if let Some(r) = constraint {
        push_whole(&mut layers, r.modification.as_ref(), own, &no_subscripts);
    }
    let holder = &cx.instances[parent];
    let mut prefix = holder.prefix;
    if replaced {
        // Parts that the redeclaration omits stay as they were (section 7.3).
        merge_prefix(&mut prefix, declaration.clause().prefix);
    }
    let protected = holder.protected || entry.protected;
    let layers = listed(cx, layers);
    cx.instances.push(Instance {
        name: wanted,
        parent: Some(parent),
        subscripts: Box::new([]),
        declaration: Some(declared),
        scope,
        layers,
        class: None,
        kind: InstanceKind::Pending,
        prefix,
        protected,
    })
}

fn push_whole(
    layers: &mut Vec<Layer>,
    modification: Option<&std::sync::Arc<ast::Modification>>,
    scope: Scope,
    subscripts: &Rc<[usize]>,
) {
    if let Some(m) = modification {
        let source = LayerSource::Whole(m.clone());
        layers.push(Layer { source, scope, subscripts: subscripts.clone() });
    }
}

/// The list of an instance, which is empty for most.
fn listed(cx: &Evaluator<'_>, layers: Vec<Layer>) -> Rc<[Layer]> {
    if layers.is_empty() { cx.no_layers.clone() } else { layers.into() }
}

/// Classes redeclared by the modifications of a component, outermost first.
fn class_redeclarations(layers: &[Layer]) -> Vec<Redeclaration> {
    let mut seen = FastSet::default();
    let mut found = Vec::new();
    for layer in layers {
        for (element, _) in layer.redeclarations() {
            if let ElementKind::Class(class) = &element.kind
                && seen.insert(class.name.name)
            {
                found.push(Redeclaration {
                    name: class.name.name,
                    class: class.clone(),
                    written_in: layer.scope.class,
                    instance: Some(layer.scope.instance),
                });
            }
        }
    }
    found
}

/// An attribute that is `final` in the type or in the declaration is not given again further outside.
fn check_final_attribute(cx: &mut Evaluator<'_>, id: InstanceId, attribute: Name) {
    let mut found = cx.attribute_layers(id, attribute);
    found.extend(cx.attribute_layers_of_type(id, attribute));
    let bindings: Vec<Binding> = found.iter().filter_map(Layer::binding).collect();
    let Some((outer, inner)) = bindings.split_first() else { return };
    if let Some(closed) = inner.iter().find(|b| b.is_final) {
        cx.report_final(id, Some(attribute), outer.value.span, closed.value.span);
    }
}

/// A `final` binding is not overridden further outside (section 7.2.6 of the specification).
fn check_final(cx: &mut Evaluator<'_>, id: InstanceId) {
    let bindings: Vec<Binding> =
        cx.instances[id].layers.iter().filter_map(Layer::binding).collect();
    let Some((outer, inner)) = bindings.split_first() else { return };
    let declared_final = cx.instances[id].declaration.as_ref().is_some_and(|d| d.element.is_final);
    let last = inner.last().filter(|_| declared_final);
    if let Some(closed) = inner.iter().find(|b| b.is_final).or(last) {
        cx.report_final(id, None, outer.value.span, closed.value.span);
    }
}

fn check_attribute_names(cx: &mut Evaluator<'_>, id: InstanceId, sizes: &[usize]) {
    check_final(cx, id);
    for layer in cx.instances[id].layers.clone().iter() {
        if let LayerSource::ParameterOverride(s, depth) = &layer.source {
            let is_there = layer
                .part()
                .is_none_or(|part| is_within(part, sizes) || *cx.instances[id].subscripts == *part);
            let holder = depth.checked_sub(1).and_then(|d| s.parts.get(d)).map(|(_, list)| list);
            let has_holder = holder.is_none_or(|list| {
                is_within(list, sizes) || *cx.instances[id].subscripts == **list
            });
            if (s.parts.len() == *depth && is_there)
                || (s.parts.len() == depth + 1 && is_attribute(s.parts[*depth].0) && has_holder)
            {
                s.used.set(true);
            }
            continue;
        }
        for (text, span) in layer.modified_names() {
            if is_attribute(text) {
                check_final_attribute(cx, id, text);
            } else {
                let path = cx.path(id);
                cx.report_unknown_attribute(path, text, span);
            }
        }
    }
}

fn check_modified_names(cx: &mut Evaluator<'_>, id: InstanceId, table: &ClassTable) {
    for layer in cx.instances[id].layers.clone().iter() {
        if let LayerSource::ParameterOverride(s, depth) = &layer.source
            && s.parts.len() == *depth
        {
            s.used.set(true);
        }
        let modified = layer.modified_names().map(|(text, span)| (text, span, true));
        let redeclared = layer.redeclarations().flat_map(|(e, _)| e.names());
        let redeclared = redeclared.map(|(text, span)| (text, span, false));
        for (text, span, is_modified) in modified.chain(redeclared) {
            match table.index.get(&text).map(|at| &table.entries[*at]) {
                Some(entry) if entry.protected => {
                    let part = ast::Ident { name: text, span };
                    cx.report_protected(part, entry.name.span);
                }
                Some(entry) if is_modified => cx.refuse_modified_class(entry, span),
                Some(_) => {}
                None => {
                    let class = cx.instances[id].class;
                    cx.report_unknown_modifier(class, text, span, table);
                }
            }
        }
    }
}

/// The constraining clause of an element.
fn constraint(element: &ast::Element) -> Option<&ast::Replaceable> {
    element.replaceable.as_ref().filter(|r| r.constraint.is_some())
}
