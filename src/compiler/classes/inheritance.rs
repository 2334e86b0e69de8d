//! Classes with their enclosing scopes, and their elements after inheritance (sections 5.6.1 and
//! 7.1 of the specification).

use std::rc::Rc;
use std::sync::Arc;

use super::attribute::is_attribute;
use super::{ClassGraph, DefinitionRules};
use crate::base::diag::Problems;
use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::ir::ast::{self, ClassBody, ClassKind, ElementKind};
use crate::ir::expr::{EnumId, Enumeration, Type};
use crate::ir::instance::{
    ClassDefinition, ClassId, ClassInstance, ClassTable, Declaration, Entry, EntryKind, InstanceId,
    Redeclaration, Scope, Section, SectionKind,
};
use crate::ir::modification::{Layer, LayerSource};

/// How far the table of a class is.
#[derive(Clone)]
pub(crate) enum TableState {
    Untouched,
    InProgress,
    Done(Rc<ClassTable>),
}

/// Number of classes of one definition whose bases may be looked for at the same time, each for the
/// sake of the previous one; more are a cycle of redeclarations.
const MAX_OPEN_TABLES: u32 = 30;

impl ClassGraph<'_> {
    pub(crate) fn add_class(
        &mut self,
        body: ClassDefinition,
        full_name: Name,
        enclosing: Option<ClassId>,
        holder: InstanceId,
        redeclared: Rc<[Redeclaration]>,
    ) -> ClassId {
        self.tables.push(TableState::Untouched);
        let constraint = None;
        self.classes.push(ClassInstance {
            body,
            full_name,
            enclosing,
            holder,
            redeclared,
            constraint,
            modified: self.no_layers.clone(),
        })
    }

    /// The class of a definition in `enclosing`, found in `holder`; the same each time.
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
        let body = ClassDefinition::Written(class.clone());
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
        let made = self.copy_of(class);
        let before = self.classes[class].redeclared.iter().cloned();
        self.classes[made].redeclared = more.into_iter().chain(before).collect();
        made
    }

    /// Another class of the same definition.
    pub(crate) fn copy_of(&mut self, class: ClassId) -> ClassId {
        let ClassInstance { body, full_name, enclosing, holder, redeclared, constraint, modified } =
            self.classes[class].clone();
        let made = self.add_class(body, full_name, enclosing, holder, redeclared);
        self.classes[made].constraint = constraint;
        self.classes[made].modified = modified;
        made
    }

    /// The class that an element `wanted` of `class` is, by its declaration or a redeclaration, with what the
    /// constraining clause of the element says (section 7.3.2). Both are short class definitions; the modifications
    /// of the class itself come from further outside.
    pub(crate) fn under_constraint(
        &mut self,
        replacing: ClassId,
        class: ClassId,
        wanted: Name,
        instance: InstanceId,
    ) -> ClassId {
        let Some((modification, before)) = self.constraint_of(class, wanted, instance) else {
            return replacing;
        };
        let is_short = |class: ClassId| {
            matches!(self.definition(class).map(|t| &t.body), Some(ClassBody::Short(_)))
        };
        if !is_short(before) || !is_short(replacing) {
            return replacing;
        }
        if let Some(known) = self.constrained.get(&(replacing, before)) {
            return *known;
        }
        let made = self.copy_of(replacing);
        self.classes[made].constraint = Some((modification, before));
        self.constrained.insert((replacing, before), made);
        made
    }

    /// The modification of the constraining clause of the class `wanted` in `class`, and this class as it is
    /// declared.
    fn constraint_of(
        &mut self,
        class: ClassId,
        wanted: Name,
        instance: InstanceId,
    ) -> Option<(Arc<ast::Modification>, ClassId)> {
        let (element, declared_in) = if self.table_in_progress(class) {
            let text = self.definition(class)?.clone();
            let ClassBody::Long(composition) = &text.body else { return None };
            let is_wanted = |e: &&ast::Element| matches!(&e.kind, ElementKind::Class(c) if c.name.name == wanted);
            (composition.elements.iter().find(is_wanted)?.clone(), class)
        } else {
            let table = self.table(class);
            let entry = &table.entries[*table.index.get(&wanted)?];
            ((*entry.element).clone(), entry.class)
        };
        let ElementKind::Class(text) = &element.kind else { return None };
        let replaceable = element.replaceable.as_ref().filter(|r| r.constraint.is_some())?;
        let modification = replaceable.modification.clone().filter(|m| !m.args.is_empty())?;
        let holder = if self.is_package(class) { self.package_instance(class) } else { instance };
        Some((modification, self.class_in(text, declared_in, holder)))
    }

    /// The definition of a class; `None` for a predefined one.
    pub fn definition(&self, class: ClassId) -> Option<&Arc<ast::Class>> {
        match &self.classes[class].body {
            ClassDefinition::Written(c) => Some(c),
            _ => None,
        }
    }

    /// The specialised kind of a class; short classes of kind `type` or `class` take their base's.
    pub fn kind(&mut self, class: ClassId) -> ClassKind {
        let Some(text) = self.definition(class) else { return ClassKind::Type };
        let kind = text.kind;
        let ClassBody::Short(short) = &text.body else { return kind };
        if !matches!(kind, ClassKind::Type | ClassKind::Class) {
            return kind;
        }
        let (base, scope) = (short.base.clone(), self.outside(class));
        match self.find_class(&base, scope) {
            Some(base) if base != class => self.kind(base),
            _ => kind,
        }
    }

    /// The partial definition behind a class: its own, or that of the class it is a short form of
    /// (section 4.6).
    pub fn partial_definition(&mut self, mut class: ClassId) -> Option<Arc<ast::Class>> {
        // A cycle of short class definitions was reported where it was read.
        for _ in 0..100 {
            let text = self.definition(class)?.clone();
            if text.partial {
                return Some(text);
            }
            let ClassBody::Short(short) = &text.body else { return None };
            let scope = self.outside(class);
            class = self.find_class(&short.base, scope).filter(|base| *base != class)?;
        }
        None
    }

    /// The scope of a modification in the definition of `class`, for an instance of the class:
    /// inside a long class, around a short one.
    pub(crate) fn modification_scope(&self, class: ClassId, instance: InstanceId) -> Scope {
        match self.definition(class).map(|t| &t.body) {
            Some(ClassBody::Short(_)) => self.outside(class),
            _ => Scope { instance, class },
        }
    }

    /// Adds what the `extends` clauses through which an element comes say of it in an instance, outermost first.
    pub(crate) fn inherited_layers(
        &self,
        clauses: &[(Arc<ast::Modification>, ClassId)],
        instance: InstanceId,
        element: Name,
        found: &mut Vec<Layer>,
    ) {
        self.clause_layers(clauses, instance).for_each(|layer| layer.child(element, found));
    }

    /// What extends clauses modify in an instance, outermost first.
    pub(crate) fn clause_layers(
        &self,
        clauses: &[(Arc<ast::Modification>, ClassId)],
        instance: InstanceId,
    ) -> impl Iterator<Item = Layer> {
        clauses.iter().map(move |(modification, written_in)| Layer {
            source: LayerSource::Whole(modification.clone()),
            scope: self.modification_scope(*written_in, instance),
            subscripts: self.no_sizes.clone(),
        })
    }

    /// The scope around a class: where its base is looked up if it is a short class.
    pub fn outside(&self, class: ClassId) -> Scope {
        let c = &self.classes[class];
        Scope { instance: c.holder, class: c.enclosing.unwrap_or(super::ROOT.class) }
    }

    /// Everything that a class has after inheritance.
    pub fn table(&mut self, class: ClassId) -> Rc<ClassTable> {
        match &self.tables[class] {
            TableState::Done(table) => {
                let table = table.clone();
                self.report_kept_problems(class);
                return table;
            }
            TableState::InProgress => {
                self.report_inheritance_cycle(class);
                return Rc::default();
            }
            TableState::Untouched => {}
        }
        let definition = self.definition(class).map(|text| Arc::as_ptr(text) as usize);
        if let Some(definition) = definition {
            // Redeclarations make another class of the same definition each time.
            let open = self.open_definitions.entry(definition).or_insert(0);
            if *open >= MAX_OPEN_TABLES {
                self.report_inheritance_cycle(class);
                return Rc::default();
            }
            *open += 1;
        }
        self.tables[class] = TableState::InProgress;
        let (table, problems) = self.collect_problems(|cx| cx.read_table(class));
        if let Some(open) = definition.and_then(|d| self.open_definitions.get_mut(&d)) {
            *open -= 1;
        }
        self.keep_problems(class, problems);
        table
    }

    /// Reports the problems of a class, and keeps them: a class that is derived from it has them
    /// too, also in a context that starts from a snapshot of this one.
    fn keep_problems(&mut self, class: ClassId, problems: Problems) {
        if !problems.is_empty() {
            self.report_all(&problems);
            self.problems_of.insert(class, problems);
        }
    }

    /// Reports the problems of a class again; those that are known already are not repeated.
    fn report_kept_problems(&mut self, class: ClassId) {
        if !self.problems_of.is_empty()
            && let Some(problems) = self.problems_of.get(&class)
            && !self.problems.includes(problems)
        {
            let problems = problems.clone();
            self.report_all(&problems);
        }
    }

    fn report_all(&mut self, problems: &Problems) {
        problems.iter().for_each(|d| self.problems.push(d.clone()));
    }

    /// Runs something; its problems are returned instead of reported.
    pub(crate) fn collect_problems<T>(
        &mut self,
        act: impl FnOnce(&mut Self) -> T,
    ) -> (T, Problems) {
        let before = std::mem::take(self.problems);
        let result = act(self);
        (result, std::mem::replace(self.problems, before))
    }

    fn read_table(&mut self, class: ClassId) -> Rc<ClassTable> {
        let mut table = ClassTable::default();
        match self.classes[class].body.clone() {
            ClassDefinition::Root => {}
            ClassDefinition::Predefined(ty) => table.scalar = Some(ty),
            ClassDefinition::Written(text) => {
                let first = !self.is_checked(&text);
                if first {
                    self.check_definition(&text);
                }
                self.fill(class, &text, &mut table);
                if table.scalar.is_some() {
                    table.layers.splice(0..0, self.classes[class].modified.iter().cloned());
                }
                let table = Rc::new(table);
                self.tables[class] = TableState::Done(table.clone());
                if first {
                    self.check_body(class, &text);
                }
                return table;
            }
        }
        let table = Rc::new(table);
        self.tables[class] = TableState::Done(table.clone());
        table
    }

    /// Whether a definition has been checked already; from now on it has.
    fn is_checked(&mut self, text: &Arc<ast::Class>) -> bool {
        !self.checked.insert(Arc::as_ptr(text) as usize)
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
                let Some(base) = self.class_or_report(&short.base, scope) else {
                    table.broken = true;
                    return;
                };
                self.check_short_base(text, base, short.base.span);
                let own = short.modification.iter().map(|m| (m.clone(), class));
                let constraint = self.classes[class].constraint.clone();
                let layers: Rc<[_]> = own.chain(constraint.clone()).collect();
                let base = match constraint {
                    Some((m, before)) => self.base_with_redeclarations(before, base, &Some(m)),
                    None => base,
                };
                let inherited = self.base_with_redeclarations(class, base, &short.modification);
                self.inherit(table, inherited, &layers, false);
                table.broken |= self.table(inherited).broken;
                if !short.dims.is_empty() {
                    table.dims.insert(0, (short.dims.clone(), class));
                }
                merge_prefix(&mut table.prefix, short.prefix);
            }
            ClassBody::Long(composition) => self.fill_long(class, composition, table),
            ClassBody::PartialDerivative { function, variables } => {
                let scope = self.outside(class);
                let Some(base) = self.class_or_report(function, scope) else { return };
                if !matches!(self.kind(base), ClassKind::Function { .. }) {
                    self.report_underived(text, base, function.span);
                    return;
                }
                self.inherit(table, base, &Rc::from([]), false);
                table.by = table.by.iter().chain(variables).copied().collect();
            }
        }
    }

    fn fill_long(
        &mut self,
        class: ClassId,
        composition: &ast::Composition,
        table: &mut ClassTable,
    ) {
        let mut bases = Vec::new();
        if let Some(modification) = &composition.class_extends
            && let Some(base) = self.inherited_class(class)
        {
            bases.push(base);
            let base = self.base_with_redeclarations(class, base, modification);
            let layers: Rc<[_]> = modification.iter().map(|m| (m.clone(), class)).collect();
            self.inherit(table, base, &layers, false);
        }
        // Classes redeclared by elements of this class replace those of its bases.
        let own = redeclared_elements(class, composition);
        for element in &composition.elements {
            match &element.kind {
                ElementKind::Import(_) => {}
                ElementKind::Extends(extends) => {
                    let scope = Scope { instance: self.classes[class].holder, class };
                    let Some(base) = self.class_or_report(&extends.base, scope) else {
                        table.lacks_base = true;
                        continue;
                    };
                    self.check_extends(class, base, &extends.base, scope);
                    bases.push(base);
                    let base = self.with_redeclarations(base, own.clone());
                    let base = self.base_with_redeclarations(class, base, &extends.modification);
                    let layers: Rc<[_]> =
                        extends.modification.iter().map(|m| (m.clone(), class)).collect();
                    self.inherit(table, base, &layers, element.protected);
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
        self.check_simple_type(class, table, &bases);
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
                let short =
                    matches!(self.definition(class).map(|t| &t.body), Some(ClassBody::Short(_)));
                // A short class opens no scope for its modifications.
                let around = self.classes[class].enclosing.filter(|_| short);
                all.push(Redeclaration {
                    name: c.name.name,
                    class: c.clone(),
                    written_in: around.unwrap_or(class),
                    instance: short.then_some(self.classes[class].holder),
                });
            }
        }
        self.with_redeclarations(base, all)
    }

    /// A class found in the package `base`, as a package that extends it sees it: its names denote
    /// the constants and classes of the derived package.
    fn seen_from(&mut self, found: ClassId, base: ClassId, holder: InstanceId) -> ClassId {
        let package = self.is_package(base).then(|| self.package_instance(base));
        if package != Some(self.classes[found].holder) {
            return found;
        }
        match (self.definition(found).cloned(), self.classes[found].enclosing) {
            (Some(text), Some(enclosing)) => self.class_in(&text, enclosing, holder),
            _ => found,
        }
    }

    /// The class that `model extends M` extends: M as the enclosing class inherits it, with the
    /// other redeclarations of that class (section 7.3.1).
    fn inherited_class(&mut self, class: ClassId) -> Option<ClassId> {
        let wanted = self.definition(class)?.name;
        let around = self.classes[class].enclosing?;
        let holder = self.classes[class].holder;
        if let Some(ClassBody::Long(composition)) =
            self.definition(around).cloned().map(|t| t.body.clone())
        {
            let mut redeclared = self.classes[around].redeclared.to_vec();
            redeclared.extend(redeclared_elements(around, &composition));
            redeclared.retain(|r| r.name != wanted.name);
            for element in &composition.elements {
                let ElementKind::Extends(extends) = &element.kind else { continue };
                let scope = Scope { instance: self.classes[around].holder, class: around };
                let Some(base) = self.find_class(&extends.base, scope) else { continue };
                let base = self.with_redeclarations(base, redeclared.clone());
                if let Some(found) = self.member_class(base, wanted.name, holder)
                    && !self.is_same_definition(found, class)
                {
                    return Some(self.seen_from(found, base, holder));
                }
            }
        }
        self.report(super::cause::ClassCause::NothingToExtend { name: wanted.name }, wanted.span);
        None
    }

    /// True for two classes with one definition.
    pub fn is_same_definition(&self, a: ClassId, b: ClassId) -> bool {
        matches!((self.definition(a), self.definition(b)), (Some(a), Some(b)) if Arc::ptr_eq(a, b))
    }

    fn inherit(
        &mut self,
        table: &mut ClassTable,
        base: ClassId,
        layers: &Rc<[(Arc<ast::Modification>, ClassId)]>,
        protected: bool,
    ) {
        let inherited = self.table(base);
        table.bases.push(base);
        table.lacks_base |= inherited.lacks_base;
        if let Some(ty) = inherited.scalar {
            table.scalar = Some(ty);
            let path = self.classes[base].full_name.to_string();
            for name in layers.iter().flat_map(|(modification, _)| modification.names()) {
                if !is_attribute(name.name) {
                    self.report_unknown_attribute(path.clone(), name.name, name.span);
                }
            }
            table.layers.extend(layers.iter().map(|(modification, class)| Layer {
                source: LayerSource::Whole(modification.clone()),
                scope: self.outside(*class),
                subscripts: self.no_sizes.clone(),
            }));
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
                    match inherited.index.get(&text).map(|at| &inherited.entries[*at]) {
                        Some(entry) if matches!(arg.kind, ast::ArgumentKind::Element { .. }) => {
                            self.refuse_modified_class(entry, span);
                        }
                        Some(_) => {}
                        None => self.report_unknown_modifier(Some(base), text, span, &inherited),
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
            if let Some(&at) = table.index.get(&entry.name.name) {
                let before = &table.entries[at];
                // Elements may differ in nothing but what a clause modifies.
                let is_modified = |layers: &[(Arc<ast::Modification>, ClassId)]| {
                    layers.iter().any(|(m, _)| m.names().any(|n| n.name == entry.name.name))
                };
                let modified = is_modified(&before.layers) || is_modified(&all);
                if modified && before.name.span == entry.name.span {
                    let before = before.clone();
                    self.check_modified_alike(&before, &all);
                    continue;
                }
                if before.name.span != entry.name.span
                    && !before.element.redeclare
                    && !matches!(&before.kind, EntryKind::Class(c) if is_class_extends(c))
                    && !self.identical(before, entry, modified)
                {
                    let (before, entry) = (before.clone(), entry.clone());
                    if self.differ_in_attributes(&before, &entry) {
                        continue;
                    }
                    match self.narrower(&before, &entry) {
                        Some(Narrower::Before) => {}
                        Some(Narrower::Later) => table.entries[at] = Entry { layers: all, ..entry },
                        None => self.report_inherited_duplicate(&before, &entry.name),
                    }
                }
            } else {
                let protected = protected || entry.protected;
                insert(table, Entry { layers: all, protected, ..entry.clone() });
            }
        }
        table.sections.extend(inherited.sections.iter().cloned());
        if !inherited.by.is_empty() {
            table.by = inherited.by.clone();
        }
        if table.external.is_none() {
            table.external.clone_from(&inherited.external);
        }
    }

    /// An element that is inherited twice is modified in the same way (section 7.1).
    fn check_modified_alike(
        &mut self,
        before: &Entry,
        later: &[(Arc<ast::Modification>, ClassId)],
    ) {
        let name = before.name.name;
        let of = |layers: &[(Arc<ast::Modification>, ClassId)]| -> Vec<Span> {
            let all = layers.iter().flat_map(|(m, _)| &m.args);
            let own = all.filter(|arg| match &arg.kind {
                ast::ArgumentKind::Element { path, .. } => {
                    path.parts.first().is_some_and(|part| part.name == name)
                }
                ast::ArgumentKind::Redeclare(element) => {
                    element.names().iter().any(|(own, _)| *own == name)
                }
                ast::ArgumentKind::Removal(_) => false,
            });
            own.map(|arg| arg.span).collect()
        };
        let (before, later) = (of(&before.layers), of(later));
        let words = |span: &Span| {
            let text = self.sources.text(*span).unwrap_or_default();
            text.split_whitespace().collect::<String>()
        };
        let written = |spans: &[Span]| spans.iter().map(words).collect::<Vec<_>>();
        if written(&before) != written(&later) {
            self.report_modified_differently(name, &before, &later);
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
            self.check_redeclared_prefixes(&table.entries[at], &entry);
            let old = &mut table.entries[at];
            *old = Entry { component: old.component, layers: old.layers.clone(), ..entry };
        } else if matches!(&entry.kind, EntryKind::Class(c) if is_class_extends(c)) {
            // `model extends M` takes the place of the inherited M.
            if table.entries[at].element.replaceable.is_none() {
                let old = table.entries[at].name.span;
                self.report_not_replaceable(entry.name.name, entry.name.span, old);
            }
            table.entries[at] = entry;
        } else if table.entries[at].class == class {
            self.report_duplicate(&entry, &table.entries[at].name);
        } else {
            // An inherited element that is declared again must be identical (section 7.3 of the
            // specification); the new declaration is kept.
            if !self.identical(&table.entries[at], &entry, false)
                && !self.differ_in_attributes(&table.entries[at], &entry)
            {
                self.report_inherited_duplicate(&entry, &table.entries[at].name);
            }
            let component = table.entries[at].component;
            table.entries[at] = Entry { component, ..entry };
        }
    }

    /// Whether two components of one name are variables of one predefined type with the same value, so
    /// that they differ in nothing but attributes, such as a unit, or components of one class by
    /// different names. The specification requires them to be identical (section 7.1), but libraries
    /// declare a variable again to give it a unit.
    fn differ_in_attributes(&mut self, a: &Entry, b: &Entry) -> bool {
        let (EntryKind::Component(of_a), EntryKind::Component(of_b)) = (&a.kind, &b.kind) else {
            return false;
        };
        let values = [of_a, of_b].map(|declaration| {
            let modification = declaration.component().modification.as_ref()?;
            let text = self.sources.text(modification.binding.as_ref()?.span)?;
            Some(text.split_whitespace().collect::<String>())
        });
        let rank = |d: &Declaration| d.clause().type_dims.len() + d.component().dims.len();
        if of_a.clause().prefix != of_b.clause().prefix
            || (a.element.inner, a.element.outer) != (b.element.inner, b.element.outer)
            || rank(of_a) + rank(of_b) > 0
            || values[0] != values[1]
        {
            return false;
        }
        let is_plain = [of_a, of_b].iter().all(|d| d.component().modification.is_none());
        let classes = [(a, of_a), (b, of_b)].map(|(entry, declaration)| {
            let scope = Scope { instance: self.classes[entry.class].holder, class: entry.class };
            self.find_class(&declaration.clause().type_name, scope)
        });
        let [Some(a), Some(b)] = classes else { return false };
        if is_plain && self.is_same_definition(a, b) {
            return true;
        }
        if self.table_in_progress(a) || self.table_in_progress(b) {
            return false;
        }
        let (a, b) = (self.table(a).scalar, self.table(b).scalar);
        a.is_some() && a == b
    }

    /// The narrower one of two replaceable short classes of one name, if one of them derives from
    /// the other: a class that fits both places fits the narrower one. The specification requires
    /// them to be identical (section 7.1), but libraries inherit a medium from two bases, one of
    /// which asks more of it.
    fn narrower(&mut self, before: &Entry, later: &Entry) -> Option<Narrower> {
        let [a, b] = [before, later].map(|entry| {
            entry.element.replaceable.as_ref()?;
            let EntryKind::Class(text) = &entry.kind else { return None };
            let ClassBody::Short(short) = &text.body else { return None };
            let scope = Scope { instance: self.classes[entry.class].holder, class: entry.class };
            self.find_class(&short.base, scope)
        });
        let (a, b) = (a?, b?);
        if self.derives(a, b) {
            return Some(Narrower::Before);
        }
        self.derives(b, a).then_some(Narrower::Later)
    }

    /// Whether a class is `base` or extends it, directly or indirectly.
    fn derives(&mut self, class: ClassId, base: ClassId) -> bool {
        if self.is_same_definition(class, base) {
            return true;
        }
        let table = self.table(class);
        table.bases.iter().any(|b| self.derives(*b, base))
    }

    /// Whether two declarations of one name say the same: type, sizes and modification, as written.
    /// The modification is left out if an `extends` clause has `modified` one of them.
    fn identical(&self, a: &Entry, b: &Entry, modified: bool) -> bool {
        let words = |span: Span| {
            let text = self.sources.text(span).unwrap_or_default();
            text.split_whitespace().collect::<String>()
        };
        let written = |m: Option<&ast::Modification>| m.map(|m| words(m.span)).unwrap_or_default();
        let (a, b) = match (&a.kind, &b.kind) {
            (EntryKind::Component(a), EntryKind::Component(b)) => (a, b),
            (EntryKind::Class(a), EntryKind::Class(b)) => {
                // Short class definitions are compared by base and modification; descriptions and
                // annotations may differ.
                if let (ClassBody::Short(of_a), ClassBody::Short(of_b)) = (&a.body, &b.body) {
                    return a.kind == b.kind
                        && of_a.base.to_string() == of_b.base.to_string()
                        && of_a.prefix == of_b.prefix
                        && of_a.dims.len() == of_b.dims.len()
                        && written(of_a.modification.as_deref())
                            == written(of_b.modification.as_deref());
                }
                return words(a.span) == words(b.span);
            }
            _ => return false,
        };
        let (of_a, of_b) = (a.clause(), b.clause());
        of_a.type_name.to_string() == of_b.type_name.to_string()
            && of_a.prefix == of_b.prefix
            && of_a.type_dims.len() + a.component().dims.len()
                == of_b.type_dims.len() + b.component().dims.len()
            && (modified
                || written(a.component().modification.as_deref())
                    == written(b.component().modification.as_deref()))
    }

    /// The type of an enumeration, which any other with the same literals has too.
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
        let literals: Vec<_> = literals.iter().map(|l| l.name.name).collect();
        // Two with the same literals are of one type (section 6.7 of the specification).
        let known = &self.graph.enumerations;
        let same = known.ids().find(|id| known[*id].literals == literals);
        let id = same.unwrap_or_else(|| {
            let name = self.classes[class].full_name.to_string();
            self.graph.enumerations.push(Enumeration { name, literals })
        });
        self.enumerations.insert(key, id);
        id
    }
}

/// Which of two declarations.
enum Narrower {
    Before,
    Later,
}

/// `model extends M ... end M`
pub(crate) fn is_class_extends(class: &ast::Class) -> bool {
    matches!(&class.body, ClassBody::Long(c) if c.class_extends.is_some())
}

/// Classes that elements of a class redeclare, for its bases.
fn redeclared_elements(class: ClassId, composition: &ast::Composition) -> Vec<Redeclaration> {
    let redeclared = composition.elements.iter().filter(|e| e.redeclare);
    redeclared
        .filter_map(|e| match &e.kind {
            ElementKind::Class(c) => Some(Redeclaration {
                name: c.name.name,
                class: c.clone(),
                written_in: class,
                instance: None,
            }),
            _ => None,
        })
        .collect()
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
