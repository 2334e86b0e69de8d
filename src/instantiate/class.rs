//! Classes in their lexical places and what they have after inheritance (sections 5.6.1 and 7.1 of
//! the specification).

use std::rc::Rc;
use std::sync::Arc;

use super::Context;
use crate::base::name::{Name, name};
use crate::ir::ast::{self, ClassBody, ClassKind, ElementKind};
use crate::ir::expr::{EnumId, Enumeration, Type};
use crate::ir::instance::{
    ClassId, ClassInstance, ClassTable, ClassText, Declaration, Entry, EntryKind, InstanceId,
    Redeclaration, Scope, Section, SectionKind,
};

/// How far the table of a class is.
pub(crate) enum TableState {
    Untouched,
    InProgress,
    Done(Rc<ClassTable>),
}

impl Context<'_> {
    pub(crate) fn add_class(
        &mut self,
        body: ClassText,
        full_name: Name,
        enclosing: Option<ClassId>,
        holder: InstanceId,
        redeclared: Rc<[Redeclaration]>,
    ) -> ClassId {
        self.tables.push(TableState::Untouched);
        self.classes.push(ClassInstance { body, full_name, enclosing, holder, redeclared })
    }

    /// The class of a text that stands in `enclosing`, found in `holder`; the same each time.
    pub(crate) fn class_in(
        &mut self,
        class: &Arc<ast::Class>,
        enclosing: ClassId,
        holder: InstanceId,
    ) -> ClassId {
        let key = (Arc::as_ptr(class) as usize, enclosing, holder);
        if let Some(id) = self.class_cache.get(&key) {
            return *id;
        }
        let outer = self.classes[enclosing].full_name;
        let full = if outer.is_empty() {
            class.name.name
        } else {
            name(&format!("{outer}.{}", class.name.name))
        };
        let body = ClassText::Written(class.clone());
        let id = self.add_class(body, full, Some(enclosing), holder, Rc::from([]));
        self.class_cache.insert(key, id);
        id
    }

    /// The class with local classes replaced; earlier redeclarations of the class win, since they
    /// come from further outside.
    pub(crate) fn with_redeclarations(
        &mut self,
        class: ClassId,
        more: Vec<Redeclaration>,
    ) -> ClassId {
        if more.is_empty() {
            return class;
        }
        let old = self.classes[class].clone();
        let all: Vec<_> = more.into_iter().chain(old.redeclared.iter().cloned()).collect();
        self.add_class(old.body, old.full_name, old.enclosing, old.holder, all.into())
    }

    /// The text of a class, if it has one.
    pub fn text(&self, class: ClassId) -> Option<&Arc<ast::Class>> {
        match &self.classes[class].body {
            ClassText::Written(c) => Some(c),
            _ => None,
        }
    }

    /// The specialised kind of a class; short classes of kind `type` or `class` take their base's.
    pub fn kind(&mut self, class: ClassId) -> ClassKind {
        let Some(text) = self.text(class).cloned() else { return ClassKind::Type };
        match (&text.body, text.kind) {
            (ClassBody::Short(short), ClassKind::Type | ClassKind::Class) => {
                let scope = self.outside(class);
                match self.find_class(&short.base, scope) {
                    Some(base) if base != class => self.kind(base),
                    _ => text.kind,
                }
            }
            (_, kind) => kind,
        }
    }

    /// Where a modification that stands in the text of `class` reads its names, for an instance of
    /// the class: inside a long class, around a short one.
    pub(crate) fn modification_scope(&self, class: ClassId, instance: InstanceId) -> Scope {
        match self.text(class).map(|t| &t.body) {
            Some(ClassBody::Short(_)) => self.outside(class),
            _ => Scope { instance, class },
        }
    }

    /// The scope around a class: where its base is looked up if it is a short class.
    pub(crate) fn outside(&self, class: ClassId) -> Scope {
        let c = &self.classes[class];
        Scope { instance: c.holder, class: c.enclosing.unwrap_or(super::ROOT.class) }
    }

    /// Everything that a class has after inheritance.
    pub fn table(&mut self, class: ClassId) -> Rc<ClassTable> {
        match &self.tables[class] {
            TableState::Done(table) => return table.clone(),
            TableState::InProgress => {
                self.report_inheritance_cycle(class);
                return Rc::default();
            }
            TableState::Untouched => {}
        }
        self.tables[class] = TableState::InProgress;
        let mut table = ClassTable::default();
        match self.classes[class].body.clone() {
            ClassText::Root => {}
            ClassText::Predefined(ty) => table.scalar = Some(ty),
            ClassText::Written(text) => {
                self.restrict(&text);
                self.fill(class, &text, &mut table);
            }
        }
        let table = Rc::new(table);
        self.tables[class] = TableState::Done(table.clone());
        table
    }

    /// True while the bases of a class are still being found.
    pub(crate) fn table_in_progress(&self, class: ClassId) -> bool {
        matches!(self.tables[class], TableState::InProgress)
    }

    fn fill(&mut self, class: ClassId, text: &Arc<ast::Class>, table: &mut ClassTable) {
        match &text.body {
            ClassBody::Enumeration(literals) => {
                let id = self.enumeration(text, class, literals.as_deref().unwrap_or(&[]));
                table.scalar = Some(Type::Enumeration(id));
            }
            ClassBody::Short(short) => {
                let scope = self.outside(class);
                let Some(base) = self.class_or_report(&short.base, scope) else { return };
                let layers: Rc<[_]> =
                    short.modification.iter().map(|m| (m.clone(), class)).collect();
                let inherited = self.base_with_redeclarations(class, base, &short.modification);
                self.inherit(table, inherited, &layers);
                if !short.dims.is_empty() {
                    table.dims.insert(0, (short.dims.clone(), class));
                }
                merge_prefix(&mut table.prefix, short.prefix);
            }
            ClassBody::Long(composition) => self.fill_long(class, composition, table),
            ClassBody::PartialDerivative { .. } => {
                self.unsupported(text.span, "functions defined as partial derivatives")
            }
        }
    }

    fn fill_long(
        &mut self,
        class: ClassId,
        composition: &ast::Composition,
        table: &mut ClassTable,
    ) {
        if composition.class_extends.is_some() {
            let span = self.text(class).map_or(crate::base::source::Span::NONE, |t| t.name.span);
            self.unsupported(span, "`extends` of an inherited class in its definition");
        }
        // Classes redeclared by elements of this class replace those of its bases.
        let own: Vec<Redeclaration> = composition
            .elements
            .iter()
            .filter(|e| e.redeclare)
            .filter_map(|e| match &e.kind {
                ElementKind::Class(c) => Some(Redeclaration {
                    name: c.name.name,
                    class: c.clone(),
                    written_in: class,
                    instance: None,
                }),
                _ => None,
            })
            .collect();
        for element in &composition.elements {
            match &element.kind {
                ElementKind::Import(_) => {}
                ElementKind::Extends(extends) => {
                    let scope = Scope { instance: self.classes[class].holder, class };
                    let Some(base) = self.class_or_report(&extends.base, scope) else { continue };
                    if let Some(text) = self.text(class).cloned() {
                        self.restrict_base(&text, base, extends.base.span);
                    }
                    let base = self.with_redeclarations(base, own.clone());
                    let base = self.base_with_redeclarations(class, base, &extends.modification);
                    let layers: Rc<[_]> =
                        extends.modification.iter().map(|m| (m.clone(), class)).collect();
                    self.inherit(table, base, &layers);
                }
                ElementKind::Components(clause) => {
                    let shared = Rc::new(element.clone());
                    for k in 0..clause.components.len() {
                        let declaration = Declaration { element: shared.clone(), component: k };
                        let entry = Entry {
                            name: clause.components[k].name,
                            kind: EntryKind::Component(declaration),
                            element: shared.clone(),
                            class,
                            layers: Rc::from([]),
                            protected: element.protected,
                            component: None,
                        };
                        self.add_entry(table, entry, element.redeclare, class);
                    }
                }
                ElementKind::Class(c) => {
                    let entry = Entry {
                        name: c.name,
                        kind: EntryKind::Class(c.clone()),
                        element: Rc::new(element.clone()),
                        class,
                        layers: Rc::from([]),
                        protected: element.protected,
                        component: None,
                    };
                    self.add_entry(table, entry, element.redeclare, class);
                }
            }
        }
        for s in &composition.equations {
            let kind = SectionKind::Equations(s.equations.clone());
            table.sections.push(Section { class, initial: s.initial, kind });
        }
        for s in &composition.algorithms {
            let kind = SectionKind::Algorithm(s.statements.clone(), s.span);
            table.sections.push(Section { class, initial: s.initial, kind });
        }
        if let Some(external) = &composition.external {
            table.external = Some((external.clone(), class));
        }
    }

    /// The base as an `extends` clause sees it: with the redeclarations of the clause, and with those
    /// of the deriving class.
    fn base_with_redeclarations(
        &mut self,
        class: ClassId,
        base: ClassId,
        modification: &Option<Arc<ast::Modification>>,
    ) -> ClassId {
        let mut all: Vec<Redeclaration> = self.classes[class].redeclared.to_vec();
        for arg in modification.iter().flat_map(|m| &m.args) {
            if let ast::ArgumentKind::Redeclare(element) = &arg.kind
                && let ElementKind::Class(c) = &element.kind
            {
                let short = matches!(self.text(class).map(|t| &t.body), Some(ClassBody::Short(_)));
                all.push(Redeclaration {
                    name: c.name.name,
                    class: c.clone(),
                    written_in: class,
                    instance: short.then_some(self.classes[class].holder),
                });
            }
        }
        self.with_redeclarations(base, all)
    }

    fn inherit(
        &mut self,
        table: &mut ClassTable,
        base: ClassId,
        layers: &Rc<[(Arc<ast::Modification>, ClassId)]>,
    ) {
        let inherited = self.table(base);
        if let Some(ty) = inherited.scalar {
            table.scalar = Some(ty);
            table.layers.extend(layers.iter().cloned());
            table.layers.extend(inherited.layers.iter().cloned());
        }
        if inherited.scalar.is_none() {
            for arg in layers.iter().flat_map(|(m, _)| &m.args) {
                let names = match &arg.kind {
                    ast::ArgumentKind::Element { path, .. } => {
                        path.parts.first().map(|p| (p.name, p.span)).into_iter().collect()
                    }
                    ast::ArgumentKind::Redeclare(element) => element.names(),
                    ast::ArgumentKind::Removal(_) => Vec::new(),
                };
                for (text, span) in names {
                    if !inherited.index.contains_key(&text) {
                        self.report_unknown_modifier(Some(base), text, span, &inherited);
                    }
                }
            }
        }
        table.dims.extend(inherited.dims.iter().cloned());
        merge_prefix(&mut table.prefix, inherited.prefix);
        for entry in &inherited.entries {
            let all: Rc<[_]> = if layers.is_empty() {
                entry.layers.clone()
            } else {
                layers.iter().chain(entry.layers.iter()).cloned().collect()
            };
            // The same element inherited twice is one element (section 7.1).
            if !table.index.contains_key(&entry.name.name) {
                insert(table, Entry { layers: all, ..entry.clone() });
            }
        }
        table.sections.extend(inherited.sections.iter().cloned());
        if table.external.is_none() {
            table.external.clone_from(&inherited.external);
        }
    }

    fn add_entry(&mut self, table: &mut ClassTable, entry: Entry, redeclare: bool, class: ClassId) {
        let Some(&at) = table.index.get(&entry.name.name) else {
            insert(table, entry);
            return;
        };
        if redeclare {
            // The type that it has already may always be written again.
            let same = match (&table.entries[at].kind, &entry.kind) {
                (EntryKind::Component(a), EntryKind::Component(b)) => {
                    a.clause().type_name.to_string() == b.clause().type_name.to_string()
                }
                _ => false,
            };
            if table.entries[at].element.replaceable.is_none() && !same {
                let old = table.entries[at].name.span;
                self.report_not_replaceable(entry.name.name, entry.name.span, old);
            }
            let old = &mut table.entries[at];
            *old = Entry { component: old.component, layers: old.layers.clone(), ..entry };
        } else if table.entries[at].class == class {
            self.report_duplicate(&entry, &table.entries[at].name);
        } else {
            // An inherited element declared again must be identical (section 7.3 of the
            // specification); the new one stands.
            if !self.identical(&table.entries[at], &entry) {
                self.report_inherited_duplicate(&entry, &table.entries[at].name);
            }
            let component = table.entries[at].component;
            table.entries[at] = Entry { component, ..entry };
        }
    }

    /// Whether two declarations of one name say the same: type, sizes and modification, as written.
    fn identical(&self, a: &Entry, b: &Entry) -> bool {
        let (EntryKind::Component(a), EntryKind::Component(b)) = (&a.kind, &b.kind) else {
            return matches!((&a.kind, &b.kind), (EntryKind::Class(_), EntryKind::Class(_)));
        };
        let written = |d: &Declaration| {
            let text = d.component().modification.as_ref().and_then(|m| self.sources.text(m.span));
            let words = text.unwrap_or_default().split_whitespace();
            words.collect::<String>()
        };
        let (of_a, of_b) = (a.clause(), b.clause());
        of_a.type_name.to_string() == of_b.type_name.to_string()
            && of_a.prefix == of_b.prefix
            && of_a.type_dims.len() + a.component().dims.len()
                == of_b.type_dims.len() + b.component().dims.len()
            && written(a) == written(b)
    }

    fn enumeration(
        &mut self,
        text: &Arc<ast::Class>,
        class: ClassId,
        literals: &[ast::EnumLiteral],
    ) -> EnumId {
        let key = Arc::as_ptr(text) as usize;
        if let Some(id) = self.enumerations.get(&key) {
            return *id;
        }
        let full_name = self.classes[class].full_name.to_string();
        let literals = literals.iter().map(|l| l.name.name).collect();
        let id = self.graph.enumerations.push(Enumeration { name: full_name, literals });
        self.enumerations.insert(key, id);
        id
    }
}

fn insert(table: &mut ClassTable, mut entry: Entry) {
    if matches!(entry.kind, EntryKind::Component(_)) {
        entry.component = Some(table.component_count);
        table.component_count += 1;
    }
    table.index.insert(entry.name.name, table.entries.len());
    table.entries.push(entry);
}

/// Prefixes written further outside win.
pub(crate) fn merge_prefix(outer: &mut ast::TypePrefix, inner: ast::TypePrefix) {
    outer.connection = outer.connection.or(inner.connection);
    outer.variability = outer.variability.or(inner.variability);
    outer.causality = outer.causality.or(inner.causality);
}
