//! Component instances: class, redeclaration, condition, dimensions, children.

use std::rc::Rc;

use super::Context;
use crate::base::index::FastSet;
use crate::base::name::Name;
use crate::classes::inheritance::merge_prefix;
use crate::evaluate::frame::FrameKind;
use crate::ir::ast::{self, ElementKind, Subscript};
use crate::ir::instance::{
    ClassId, ClassTable, Declaration, Entry, EntryKind, Instance, InstanceId, InstanceKind,
    Redeclaration, Scope,
};
use crate::ir::modification::{Binding, Layer, LayerSource};

/// Attributes of the predefined types (section 4.9 of the specification).
pub const ATTRIBUTES: [&str; 11] = [
    "quantity",
    "unit",
    "displayUnit",
    "min",
    "max",
    "start",
    "fixed",
    "nominal",
    "unbounded",
    "stateSelect",
    "value",
];

impl Context<'_> {
    /// Completes an instance and everything below it.
    pub fn complete_all(&mut self, root: InstanceId) {
        let mut stack = vec![root];
        while let Some(id) = stack.pop() {
            self.complete(id);
            match &self.instances[id].kind {
                InstanceKind::Object(children) => stack.extend(children.iter().rev()),
                InstanceKind::Array { elements, .. } => stack.extend(elements.iter().rev()),
                _ => {}
            }
        }
    }

    /// Finds out what an instance is, unless that is known.
    pub fn complete(&mut self, id: InstanceId) {
        match self.instances[id].kind {
            InstanceKind::Pending => self.complete_pending(id),
            InstanceKind::InProgress => self.report_component_cycle(id),
            _ => {}
        }
    }

    #[inline(never)]
    fn complete_pending(&mut self, id: InstanceId) {
        self.instances[id].kind = InstanceKind::InProgress;
        // Where a function reads a constant, its own variables are not those of the constant's package.
        let declaration = self.instances[id].declaration.clone();
        let kind = self.with_frame(FrameKind::Class, |cx| match declaration {
            Some(declaration) => match cx.cached_declaration(id, &declaration) {
                Some(kind) => Some(kind),
                None => cx.declared(id, &declaration),
            },
            None => cx.object(id),
        });
        // An error on the way may have settled it already.
        if matches!(self.instances[id].kind, InstanceKind::InProgress) {
            self.instances[id].kind = kind.unwrap_or(InstanceKind::Broken);
        }
    }

    /// What a declared component is; `None` after an error.
    fn declared(&mut self, id: InstanceId, declaration: &Declaration) -> Option<InstanceKind> {
        let said = self.problems.iter().len();
        let scope = self.instances[id].scope;
        let element = &declaration.element;
        let clause = declaration.clause();
        let component = declaration.component();
        if element.outer && !element.inner {
            self.check_outer_unmodified(id, component.name);
            let inner = self.find_inner(id, component.name.name);
            if let Some(inner) = inner.or_else(|| self.add_inner(id, declaration)) {
                let class = self.class_or_report(&clause.type_name, scope)?;
                self.instances[id].class = Some(class);
                self.check_inner_fits(id, inner, class, component.name);
                return Some(InstanceKind::Outer(inner));
            }
            self.report_no_inner(component.name);
            return None;
        }
        let condition = match &component.condition {
            Some(condition) => Some((condition.clone(), scope)),
            // What the redeclaration does not say stays as it was (section 7.3).
            None => self
                .replaced_declaration(id, declaration)
                .and_then(|(before, own)| Some((before.component().condition.clone()?, own))),
        };
        if let Some((condition, scope)) = &condition {
            match self.fold_boolean(condition, *scope) {
                Some(true) => {}
                Some(false) => return Some(InstanceKind::Absent),
                None => return None,
            }
        }
        let of_class = self.check_type_name(&clause.type_name, scope)?;
        let class = self.class_or_report(&clause.type_name, scope)?;
        if !of_class.is_empty() {
            let own = self.instances[id].layers.iter().cloned();
            self.instances[id].layers = own.chain(of_class).collect();
        }
        let redeclared = self.class_redeclarations(&self.instances[id].layers.clone());
        let class = self.with_redeclarations(class, redeclared);
        self.instances[id].class = Some(class);
        let table = self.table(class);
        if table.broken {
            return None;
        }

        self.restrict_prefix(clause.prefix, class, table.scalar, component.name);
        let mut prefix = clause.prefix;
        merge_prefix(&mut prefix, table.prefix);
        if table.scalar.is_none() {
            self.check_prefix_conflict(prefix, &table, component.name);
        }
        self.merge_prefix_around(id, prefix);

        let sizes = self.sizes(id, declaration, &table)?;
        if table.scalar.is_some() {
            self.check_attribute_names(id);
        } else {
            self.check_instantiable(id, class);
        }
        if self.problems.iter().len() == said {
            self.cache_declaration(id, declaration, prefix);
        }
        match table.scalar {
            Some(ty) => {
                let dims = if sizes.is_empty() { self.no_sizes.clone() } else { sizes.into() };
                Some(InstanceKind::Variable { ty, dims, first: None })
            }
            None if sizes.is_empty() => self.object(id),
            None => Some(self.array_of_objects(id, class, sizes)),
        }
    }

    /// Gives a component the prefixes of its declaration and class, with those of the components around it.
    pub(crate) fn merge_prefix_around(&mut self, id: InstanceId, mut prefix: ast::TypePrefix) {
        let around = self.instances[id].prefix;
        prefix.variability = match (prefix.variability, around.variability) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        prefix.connection = prefix.connection.or(around.connection);
        prefix.causality = prefix.causality.or(around.causality);
        self.instances[id].prefix = prefix;
    }

    /// Dimensions of a component, of its type as written, and of its short classes.
    pub(crate) fn sizes(
        &mut self,
        id: InstanceId,
        declaration: &Declaration,
        table: &ClassTable,
    ) -> Option<Vec<usize>> {
        let scope = self.instances[id].scope;
        let component = declaration.component();
        let mut written: Vec<(Subscript, Scope)> = Vec::new();
        for s in component.dims.iter().chain(&declaration.clause().type_dims) {
            written.push((s.clone(), scope));
        }
        if written.is_empty() {
            written = self.dims_before(id, declaration);
        }
        for (list, holder) in &table.dims {
            let outside = self.outside(*holder);
            written.extend(list.iter().map(|s| (s.clone(), outside)));
        }
        // One may be that of another dimension: `A[:, size(A, 1)]`.
        let sizes = self.with_sizing(id, written.len(), |cx| {
            cx.sizes_of_dimensions(id, component.name, &written)
        })?;
        self.check_count(&sizes, component.name.span)?;
        Some(sizes)
    }

    /// Sizes as written, each where it is written: those that are left open come from the binding.
    fn sizes_of_dimensions(
        &mut self,
        id: InstanceId,
        name: ast::Ident,
        written: &[(Subscript, Scope)],
    ) -> Option<Vec<usize>> {
        let mut sizes = vec![0; written.len()];
        let mut from_binding: Option<Vec<usize>> = None;
        for (k, (subscript, _)) in written.iter().enumerate() {
            let Subscript::Colon(span) = subscript else { continue };
            if from_binding.is_none() {
                let mode = self.evaluation.mode.sizing();
                let value = self.with_mode(mode, |cx| match cx.binding_value(id) {
                    None if !cx.bound(id) => cx.start_value(id),
                    value => value,
                });
                // Why a binding has no value was said.
                if value.is_none() && self.bound(id) && self.problems.has_errors() {
                    return None;
                }
                from_binding = Some(value.map(|v| v.dims().to_vec()).unwrap_or_default());
            }
            sizes[k] = match from_binding.as_ref().and_then(|d| d.get(k)) {
                Some(n) => *n,
                // Connections will say (section 9.1.3).
                None if self.in_expandable(id) => 0,
                None => {
                    self.report_unknown_size(name, *span);
                    return None;
                }
            };
            self.evaluation.sizing.note(k, sizes[k]);
        }
        for (k, (subscript, scope)) in written.iter().enumerate() {
            if let Subscript::Expr(e) = subscript {
                sizes[k] = self.fold_size(e, *scope)?;
                self.evaluation.sizing.note(k, sizes[k]);
            }
        }
        Some(sizes)
    }

    /// The start value of a variable, from which its open sizes are taken where it has no other.
    fn start_value(&mut self, id: InstanceId) -> Option<crate::evaluate::value::Value> {
        let start = self.attribute(id, crate::base::name::name("start"))?;
        self.evaluate(&start.value, start.scope)
    }

    /// The sizes of the declaration that a redeclared component replaces: they stay (section 7.3).
    fn dims_before(&mut self, id: InstanceId, now: &Declaration) -> Vec<(Subscript, Scope)> {
        let Some((before, scope)) = self.replaced_declaration(id, now) else { return Vec::new() };
        let dims = before.component().dims.iter().chain(&before.clause().type_dims);
        dims.map(|s| (s.clone(), scope)).collect()
    }

    /// The declaration in the class that `now` replaces, if it does, with its scope.
    fn replaced_declaration(
        &mut self,
        id: InstanceId,
        now: &Declaration,
    ) -> Option<(Declaration, Scope)> {
        if !now.element.redeclare && now.element.replaceable.is_none() {
            return None;
        }
        let parent = self.instances[id].parent?;
        let wanted = self.instances[id].name;
        let table = self.table_of(parent);
        let entry = table.index.get(&wanted).map(|at| &table.entries[*at])?;
        let EntryKind::Component(before) = &entry.kind else { return None };
        if Rc::ptr_eq(&before.element, &now.element) {
            return None;
        }
        Some((before.clone(), Scope { instance: parent, class: entry.class }))
    }

    /// Whether the component around an instance is an expandable connector.
    fn in_expandable(&mut self, id: InstanceId) -> bool {
        let class = self.instances[id].parent.and_then(|p| self.instances[p].class);
        class.is_some_and(|c| self.kind(c) == ast::ClassKind::ExpandableConnector)
    }

    /// An array of components with components: one instance for each element.
    fn array_of_objects(
        &mut self,
        id: InstanceId,
        class: ClassId,
        sizes: Vec<usize>,
    ) -> InstanceKind {
        let count: usize = sizes.iter().product();
        let template = self.instances[id].clone();
        let mut elements = Vec::with_capacity(count);
        let mut subscripts = vec![1; sizes.len()];
        for _ in 0..count {
            let layers = template.layers.iter().filter_map(|l| l.element(&subscripts)).collect();
            let layers = self.listed(layers);
            let element = self.instances.push(Instance {
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
    pub(crate) fn object(&mut self, id: InstanceId) -> Option<InstanceKind> {
        let class = self.instances[id].class?;
        let table = self.table(class);
        self.check_modified_names(id, &table);
        if !self.redeclarations_fit(id, &table) {
            return None;
        }
        let mut children = Vec::with_capacity(table.component_count);
        for entry in &table.entries {
            if let EntryKind::Component(declaration) = &entry.kind {
                children.push(self.child_instance(id, entry, declaration));
            }
        }
        Some(InstanceKind::Object(children.into()))
    }

    fn child_instance(
        &mut self,
        parent: InstanceId,
        entry: &Entry,
        declaration: &Declaration,
    ) -> InstanceId {
        let wanted = entry.name.name;
        let own = Scope { instance: parent, class: entry.class };
        let mut layers = Vec::new();
        let outer = self.instances[parent].layers.clone();
        for layer in outer.iter() {
            layer.child(wanted, &mut layers);
        }
        let mut scope = own;
        let mut declared = declaration.clone();
        // Of a chain of redeclarations the outermost counts; of the others what constrains it.
        let mut replaced = false;
        for (replacement, at) in self.component_redeclarations(&outer, entry, parent, wanted) {
            let constraint = constraint(&replacement.element).cloned();
            if !replaced || constraint.is_none() {
                let modification = replacement.component().modification.as_ref();
                self.push_whole(&mut layers, modification, at);
            }
            if let Some(constraint) = constraint {
                self.push_whole(&mut layers, constraint.modification.as_ref(), at);
            }
            if !replaced {
                replaced = true;
                scope = at;
                declared = replacement;
                let before = &declaration.element;
                if (before.inner, before.outer) != (declared.element.inner, declared.element.outer)
                {
                    // What the redeclaration does not say stays as it was (section 7.3).
                    let element = Rc::make_mut(&mut declared.element);
                    element.inner |= before.inner;
                    element.outer |= before.outer;
                }
            }
        }
        for (modification, class) in entry.layers.iter() {
            let layer = Layer {
                source: LayerSource::Whole(modification.clone()),
                scope: self.modification_scope(*class, parent),
                subscripts: self.no_sizes.clone(),
            };
            layer.child(wanted, &mut layers);
        }
        // What the original declaration says also holds for a replacement (section 7.3.2), unless
        // a constraining clause says what does.
        let constraint = constraint(&declaration.element);
        if !replaced || constraint.is_none() {
            self.push_whole(&mut layers, declaration.component().modification.as_ref(), own);
        }
        if let Some(r) = constraint {
            self.push_whole(&mut layers, r.modification.as_ref(), own);
        }
        let holder = &self.instances[parent];
        let mut prefix = holder.prefix;
        if replaced {
            // What the redeclaration does not say stays as it was (section 7.3).
            merge_prefix(&mut prefix, declaration.clause().prefix);
        }
        let protected = holder.protected || entry.protected;
        self.instances.push(Instance {
            name: wanted,
            parent: Some(parent),
            subscripts: Box::new([]),
            declaration: Some(declared),
            scope,
            layers: self.listed(layers),
            class: None,
            kind: InstanceKind::Pending,
            prefix,
            protected,
        })
    }

    fn push_whole(
        &self,
        layers: &mut Vec<Layer>,
        modification: Option<&std::sync::Arc<ast::Modification>>,
        scope: Scope,
    ) {
        if let Some(m) = modification {
            let source = LayerSource::Whole(m.clone());
            layers.push(Layer { source, scope, subscripts: self.no_sizes.clone() });
        }
    }

    /// The list of an instance, which is empty for most.
    fn listed(&self, layers: Vec<Layer>) -> Rc<[Layer]> {
        if layers.is_empty() { self.no_layers.clone() } else { layers.into() }
    }

    /// `redeclare T name(...)` in the modifications of the parent, outermost first.
    fn component_redeclarations(
        &self,
        outer: &[Layer],
        entry: &Entry,
        parent: InstanceId,
        wanted: Name,
    ) -> Vec<(Declaration, Scope)> {
        let inherited = entry.layers.iter().map(|(m, class)| Layer {
            source: LayerSource::Whole(m.clone()),
            scope: self.modification_scope(*class, parent),
            subscripts: Rc::from([]),
        });
        let mut found = Vec::new();
        for layer in outer.iter().cloned().chain(inherited) {
            for (element, _) in layer.redeclarations() {
                if let ElementKind::Components(clause) = &element.kind
                    && let Some(k) = clause.components.iter().position(|c| c.name.name == wanted)
                {
                    let element = Rc::new((**element).clone());
                    found.push((Declaration { element, component: k }, layer.scope));
                }
            }
        }
        found
    }

    /// Classes redeclared by the modifications of a component, outermost first.
    fn class_redeclarations(&self, layers: &[Layer]) -> Vec<Redeclaration> {
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

    /// The outermost binding of an instance.
    pub fn binding(&self, id: InstanceId) -> Option<Binding> {
        self.instances[id].layers.iter().find_map(Layer::binding)
    }

    /// The outermost binding of an attribute of an instance of predefined type: from modifications of
    /// the component, then from its type.
    pub fn attribute(&mut self, id: InstanceId, attribute: Name) -> Option<Binding> {
        let of_component = self.attribute_layers(id, attribute);
        if let Some(binding) = of_component.iter().find_map(Layer::binding) {
            return Some(binding);
        }
        self.attribute_layers_of_type(id, attribute).iter().find_map(Layer::binding)
    }

    /// The attributes that an instance of predefined type is given, some of them more than once.
    pub fn attributes_given(&mut self, id: InstanceId) -> Vec<Name> {
        let mut found = Vec::new();
        for layer in self.instances[id].layers.iter() {
            match &layer.source {
                LayerSource::ParameterOverride(s, depth) => {
                    found.extend(s.parts.get(*depth).map(|(part, _)| *part));
                }
                _ => found.extend(layer.modified_names().map(|(part, _)| part)),
            }
        }
        let table = self.table_of(id);
        for (modification, _) in &table.layers {
            found.extend(modification.names().map(|part| part.name));
        }
        found
    }

    /// What modifications of the component say about an attribute, from the outermost inwards.
    fn attribute_layers(&self, id: InstanceId, attribute: Name) -> Vec<Layer> {
        let mut found = Vec::new();
        for layer in self.instances[id].layers.iter() {
            layer.child(attribute, &mut found);
        }
        found
    }

    /// What the type of an instance says about an attribute, from the outermost inwards.
    fn attribute_layers_of_type(&mut self, id: InstanceId, attribute: Name) -> Vec<Layer> {
        let mut found = Vec::new();
        let table = self.table_of(id);
        for (modification, class) in &table.layers {
            let layer = Layer {
                source: LayerSource::Whole(modification.clone()),
                scope: self.outside(*class),
                subscripts: Rc::from([]),
            };
            layer.child(attribute, &mut found);
        }
        found
    }

    /// An attribute that is `final` in the type or in the declaration is not given again further outside.
    fn check_final_attribute(&mut self, id: InstanceId, attribute: Name) {
        let mut found = self.attribute_layers(id, attribute);
        found.extend(self.attribute_layers_of_type(id, attribute));
        let bindings: Vec<Binding> = found.iter().filter_map(Layer::binding).collect();
        let Some((outer, inner)) = bindings.split_first() else { return };
        if let Some(closed) = inner.iter().find(|b| b.is_final) {
            self.report_final_attribute(id, attribute, outer.value.span, closed.value.span);
        }
    }

    /// What is `final` inside is not bound again further outside (section 7.2.6 of the specification).
    fn check_final(&mut self, id: InstanceId) {
        let bindings: Vec<Binding> =
            self.instances[id].layers.iter().filter_map(Layer::binding).collect();
        let Some((outer, inner)) = bindings.split_first() else { return };
        let declared_final =
            self.instances[id].declaration.as_ref().is_some_and(|d| d.element.is_final);
        let last = inner.last().filter(|_| declared_final);
        if let Some(closed) = inner.iter().find(|b| b.is_final).or(last) {
            self.report_final(id, outer.value.span, closed.value.span);
        }
    }

    fn check_attribute_names(&mut self, id: InstanceId) {
        self.check_final(id);
        for layer in self.instances[id].layers.clone().iter() {
            if let LayerSource::ParameterOverride(s, depth) = &layer.source {
                if s.parts.len() == *depth
                    || (s.parts.len() == depth + 1 && is_attribute(s.parts[*depth].0))
                {
                    s.used.set(true);
                }
                continue;
            }
            for (text, span) in layer.modified_names() {
                if is_attribute(text) {
                    self.check_final_attribute(id, text);
                } else {
                    self.report_unknown_attribute(id, text, span);
                }
            }
        }
    }

    fn check_modified_names(&mut self, id: InstanceId, table: &ClassTable) {
        for layer in self.instances[id].layers.clone().iter() {
            if let LayerSource::ParameterOverride(s, depth) = &layer.source
                && s.parts.len() == *depth
            {
                s.used.set(true);
            }
            let redeclared = layer.redeclarations().flat_map(|(e, _)| e.names());
            for (text, span) in layer.modified_names().chain(redeclared) {
                match table.index.get(&text).map(|at| &table.entries[*at]) {
                    Some(entry) if entry.protected => {
                        let part = ast::Ident { name: text, span };
                        self.report_protected(part, entry.name.span);
                    }
                    Some(_) => {}
                    None => {
                        let class = self.instances[id].class;
                        self.report_unknown_modifier(class, text, span, table);
                    }
                }
            }
        }
    }
}

/// The constraining clause of an element.
fn constraint(element: &ast::Element) -> Option<&ast::Replaceable> {
    element.replaceable.as_ref().filter(|r| r.constraint.is_some())
}

fn is_attribute(text: Name) -> bool {
    ATTRIBUTES.contains(&text.as_str())
}

/// The next subscripts in row-major order, counted from 1.
pub fn advance(subscripts: &mut [usize], sizes: &[usize]) {
    for k in (0..sizes.len()).rev() {
        subscripts[k] += 1;
        if subscripts[k] <= sizes[k] {
            return;
        }
        subscripts[k] = 1;
    }
}
