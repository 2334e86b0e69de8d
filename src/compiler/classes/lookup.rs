//! Names to classes: local, inherited, imported, enclosing, library (section 5.3 of the
//! specification).

use std::rc::Rc;

use super::cause::ClassCause;
use super::inheritance::is_class_extends;
use super::predefined::is_built_in;
use super::{ClassGraph, ROOT};
use crate::base::diag::Diagnostic;
use crate::base::name::Name;
use crate::base::source::Span;
use crate::ir::ast::{self, ClassBody, ClassKind, ElementKind, ImportForm};
use crate::ir::instance::{ClassDefinition, ClassId, EntryKind, InstanceId, Scope};

/// The meaning of a first identifier that is not a component of the instance itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Found {
    /// A class.
    Class(ClassId),
    /// A component of this enclosing or imported package.
    Component(ClassId, Name),
}

impl ClassGraph<'_> {
    /// The class of a dotted name, seen from `scope`.
    pub fn find_class(&mut self, path: &ast::Path, scope: Scope) -> Option<ClassId> {
        let mut violation = None;
        let (first, rest) = path.parts.split_first()?;
        let mut at = if path.global {
            self.member_class(ROOT.class, first.name, ROOT.instance)
        } else {
            match self.find_first(first.name, scope)? {
                Found::Class(c) => Some(c),
                Found::Component(..) => None,
            }
        }?;
        for part in rest {
            let holder = self.classes[at].holder;
            let inner = self.member_class(at, part.name, holder)?;
            violation = violation.or_else(|| self.access_violation(at, *part));
            at = inner;
        }
        self.violation = violation;
        Some(at)
    }

    /// The class of a dotted name; a missing class is reported.
    pub fn class_or_report(&mut self, path: &ast::Path, scope: Scope) -> Option<ClassId> {
        let found = self.find_class(path, scope);
        match found {
            Some(_) => self.report_access_violation(),
            None => self.report_unknown_class(path, scope),
        }
        found
    }

    /// The first identifier of a name, looked up outwards from `scope.class`: classes, and the
    /// components (constants) of enclosing packages. Components of `scope.instance` itself are
    /// the caller's business.
    pub fn find_first(&mut self, wanted: Name, scope: Scope) -> Option<Found> {
        let mut class = scope.class;
        let mut instance = scope.instance;
        let mut own = true;
        loop {
            // The value of a constant that a package inherits sees what the package redeclares.
            let seen_in = self.extending_package(class, instance, wanted).unwrap_or(class);
            if let Some(c) = self.member_class(seen_in, wanted, instance) {
                return Some(Found::Class(c));
            }
            if !own && let Some(package) = self.package_constant(class, instance, wanted) {
                return Some(Found::Component(package, wanted));
            }
            if let Some(found) = self.imported(class, wanted) {
                return Some(found);
            }
            own = false;
            let here = &self.classes[class];
            let encapsulated = matches!(&here.body, ClassDefinition::Written(c) if c.encapsulated);
            match here.enclosing {
                Some(_) if encapsulated => {
                    instance = ROOT.instance;
                    class = ROOT.class;
                }
                Some(outer) => {
                    instance = here.holder;
                    class = outer;
                }
                None => break,
            }
        }
        self.predefined.get(&wanted).map(|c| Found::Class(*c))
    }

    /// The class `wanted` among the elements of `class`, own or inherited or in a file of its own.
    /// `instance` is the instance of `class` in hand.
    pub fn member_class(
        &mut self,
        class: ClassId,
        wanted: Name,
        instance: InstanceId,
    ) -> Option<ClassId> {
        if class == ROOT.class {
            // No file is opened for a name that the language defines.
            let is_given = |name| self.library.file_classes().iter().any(|c| c.name.name == name);
            let is_defined = self.predefined.contains_key(&wanted) || is_built_in(&wanted);
            if is_defined && !is_given(wanted) {
                return None;
            }
            let text = self.library.top(wanted, self.sources, self.problems)?;
            return Some(self.class_in(&text, ROOT.class, ROOT.instance));
        }
        let redeclared = self.classes[class].redeclared.clone();
        if let Some(r) = redeclared.iter().find(|r| r.name == wanted) {
            let holder = r.instance.unwrap_or(instance);
            let replacing = self.class_in(&r.class, r.written_in, holder);
            return Some(self.under_constraint(replacing, class, wanted, instance));
        }
        let mut elsewhere = None;
        let (text, declared_in) = if self.table_in_progress(class) {
            (self.own_class(class, wanted)?, class)
        } else {
            let table = self.table(class);
            match table.index.get(&wanted).map(|at| &table.entries[*at]) {
                Some(entry) => match &entry.kind {
                    EntryKind::Class(c) => {
                        if entry.class != class {
                            // Inherited from a class in which it is redeclared.
                            let redeclared = &self.classes[entry.class].redeclared;
                            elsewhere = redeclared.iter().find(|r| r.name == wanted).cloned();
                        }
                        if entry.element.outer && !entry.element.inner {
                            return self.inner_class(wanted, instance);
                        }
                        (c.clone(), entry.class)
                    }
                    EntryKind::Component(_) => return None,
                },
                None => self.class_in_file(class, wanted)?,
            }
        };
        let holder = if self.is_package(class) { self.package_instance(class) } else { instance };
        if let Some(r) = elsewhere {
            let within = r.instance.unwrap_or(holder);
            let replacing = self.class_in(&r.class, r.written_in, within);
            return Some(self.under_constraint(replacing, class, wanted, instance));
        }
        let found = self.class_in(&text, declared_in, holder);
        let found = self.under_constraint(found, class, wanted, instance);
        Some(self.modified_in_package(found, class, wanted))
    }

    /// The class `wanted` in a file of its own in the folder of the package `class` or of one of its
    /// bases, and the package that has the folder. Tables do not list these classes, because files
    /// are read when one of their classes is needed.
    pub(crate) fn class_in_file(
        &mut self,
        class: ClassId,
        wanted: Name,
    ) -> Option<(std::sync::Arc<ast::Class>, ClassId)> {
        let full_name = self.classes[class].full_name;
        if let Some(own) = self.library.child(full_name, wanted, self.sources, self.problems) {
            return Some((own, class));
        }
        if !self.is_package(class) || self.table_in_progress(class) {
            return None;
        }
        let table = self.table(class);
        table.bases.iter().find_map(|base| self.class_in_file(*base, wanted))
    }

    /// The class that an `outer` class refers to: the `inner` one of that name in the enclosing
    /// components (section 5.4).
    fn inner_class(&mut self, wanted: Name, instance: InstanceId) -> Option<ClassId> {
        let mut at = self.instances[instance].parent;
        while let Some(holder) = at {
            at = self.instances[holder].parent;
            let Some(class) = self.instances[holder].class else { continue };
            let table = self.table(class);
            if let Some(entry) = table.index.get(&wanted).map(|at| &table.entries[*at])
                && entry.element.inner
                && matches!(entry.kind, EntryKind::Class(_))
            {
                return self.member_class(class, wanted, holder);
            }
        }
        None
    }

    /// A class defined in `class` itself, or in a file of the package's folder.
    fn own_class(&mut self, class: ClassId, wanted: Name) -> Option<std::sync::Arc<ast::Class>> {
        let text = self.definition(class)?.clone();
        if let ClassBody::Long(composition) = &text.body {
            for element in &composition.elements {
                if let ElementKind::Class(c) = &element.kind
                    && c.name.name == wanted
                {
                    return Some(c.clone());
                }
            }
        }
        let full_name = self.classes[class].full_name;
        self.library.child(full_name, wanted, self.sources, self.problems)
    }

    pub(crate) fn is_package(&self, class: ClassId) -> bool {
        self.definition(class).is_some_and(|c| c.kind == ClassKind::Package)
    }

    /// The instance that holds the constants of a package.
    pub(crate) fn package_instance(&mut self, class: ClassId) -> InstanceId {
        if let Some(id) = self.package_instances.get(&class) {
            return *id;
        }
        let full_name = self.classes[class].full_name;
        let id = self.instances.push(super::package_like(class, full_name));
        self.instances[id].scope = Scope { instance: id, class };
        self.package_instances.insert(class, id);
        id
    }

    /// The package whose constant `wanted` is seen from a class in `class`, which was found in
    /// `instance`: a package that extends the enclosing one may give it another value.
    fn package_constant(
        &mut self,
        class: ClassId,
        instance: InstanceId,
        wanted: Name,
    ) -> Option<ClassId> {
        if let Some(derived) = self.extending_package(class, instance, wanted)
            && self.has_component(derived, wanted)
        {
            return Some(derived);
        }
        self.has_component(class, wanted).then_some(class)
    }

    /// Whether a package has the component `wanted`.
    pub(crate) fn has_component(&mut self, class: ClassId, wanted: Name) -> bool {
        if class == ROOT.class || self.table_in_progress(class) {
            return false;
        }
        let table = self.table(class);
        let entry = table.index.get(&wanted).map(|at| &table.entries[*at]);
        entry.is_some_and(|e| e.component.is_some())
    }

    /// The package that extends the package `class` and in which a class of it was found, if it
    /// inherits `wanted` from there.
    fn extending_package(
        &mut self,
        class: ClassId,
        instance: InstanceId,
        wanted: Name,
    ) -> Option<ClassId> {
        let derived = self.instances[instance].class?;
        let other = derived != class
            && self.package_instances.get(&derived) == Some(&instance)
            && !self.table_in_progress(derived)
            && !self.table_in_progress(class);
        if !other {
            return None;
        }
        let (here, there) = (self.table(class), self.table(derived));
        let Some(own) = here.index.get(&wanted).map(|at| &here.entries[*at]) else {
            // A class in a file of its own is in no table.
            let (own, _) = self.class_in_file(class, wanted)?;
            let (inherited, _) = self.class_in_file(derived, wanted)?;
            return std::sync::Arc::ptr_eq(&own, &inherited).then_some(derived);
        };
        let entry = &there.entries[*there.index.get(&wanted)?];
        // An element that merely has the same name is not inherited. A base may have several
        // redeclared variants.
        let same = self.is_same_definition(own.class, entry.class);
        let extends = matches!(&entry.kind, EntryKind::Class(c) if is_class_extends(c));
        (same || entry.element.redeclare || extends).then_some(derived)
    }

    /// Import clauses of `class` (they are not inherited): clauses that name the element take
    /// precedence over `import P.*`.
    fn imported(&mut self, class: ClassId, wanted: Name) -> Option<Found> {
        let text = self.definition(class)?.clone();
        let ClassBody::Long(composition) = &text.body else { return None };
        let mut open = Vec::new();
        for at in self.imports_of(class, composition).iter() {
            let ElementKind::Import(import) = &composition.elements[*at].kind else { continue };
            let parts: Vec<Name> = import.path.parts.iter().map(|p| p.name).collect();
            let full: Option<Vec<Name>> = match &import.form {
                ImportForm::Qualified => (parts.last() == Some(&wanted)).then_some(parts),
                ImportForm::Renamed(alias) => (alias.name == wanted).then_some(parts),
                ImportForm::List(names) if names.iter().any(|n| n.name == wanted) => {
                    Some([parts, vec![wanted]].concat())
                }
                ImportForm::All => {
                    open.push((&import.path, [parts, vec![wanted]].concat()));
                    None
                }
                ImportForm::List(_) => None,
            };
            let Some(full) = full else { continue };
            if let Some(found) = self.absolute(&full, false) {
                self.check_import(&import.path, &full);
                self.check_imported_is_public(&import.path, &full);
                return Some(found);
            }
        }
        let mut first: Option<(&ast::Path, Found)> = None;
        for (path, full) in open {
            let Some(found) = self.absolute(&full, true) else { continue };
            self.check_import(path, &full);
            match first {
                None => first = Some((path, found)),
                Some((before, other)) if other != found => {
                    let (before, at) = (before.span, path.span);
                    self.report_ambiguous_import(wanted, before, at);
                    break;
                }
                Some(_) => {}
            }
        }
        first.map(|(_, found)| found)
    }

    /// Positions of the import clauses among the elements of a class.
    fn imports_of(&mut self, class: ClassId, composition: &ast::Composition) -> Rc<[usize]> {
        let found = self.imports.entry(class).or_insert_with(|| {
            let elements = composition.elements.iter().enumerate();
            elements
                .filter(|(_, e)| matches!(e.kind, ElementKind::Import(_)))
                .map(|(at, _)| at)
                .collect()
        });
        found.clone()
    }

    fn report_ambiguous_import(&mut self, wanted: Name, before: Span, at: Span) {
        self.problems.push(
            Diagnostic::new(ClassCause::AmbiguousImport { name: wanted }, at)
                .label("second package that has it")
                .also(before, "first package that has it"),
        );
    }

    /// An imported element must be public (section 13.2.1).
    fn check_imported_is_public(&mut self, path: &ast::Path, full: &[Name]) {
        let Some((last, packages)) = full.split_last() else { return };
        let mut class = ROOT.class;
        for part in packages {
            let Some(next) = self.member_class(class, *part, ROOT.instance) else { return };
            class = next;
        }
        if let Some(declared) = self.protected_in(class, *last) {
            self.report_protected(ast::Ident { name: *last, span: path.span }, declared);
        }
    }

    /// An imported element must be a package or an element of one (section 13.2.1).
    fn check_import(&mut self, path: &ast::Path, full: &[Name]) {
        let Some((last, packages)) = full.split_last() else { return };
        let mut class = ROOT.class;
        for part in packages {
            let Some(next) = self.member_class(class, *part, ROOT.instance) else { return };
            class = next;
        }
        let itself = self.member_class(class, *last, ROOT.instance);
        if class == ROOT.class
            || self.kind(class) == ClassKind::Package
            || itself.is_some_and(|c| self.kind(c) == ClassKind::Package)
        {
            return;
        }
        let holder = packages.last().map_or_else(String::new, Name::to_string);
        self.report(ClassCause::ImportFromOther { name: *last, holder }, path.span);
    }

    /// Reports imports of what does not exist, whether or not something uses them (section 13.2.1).
    pub(crate) fn check_imports(&mut self, composition: &ast::Composition) {
        for element in &composition.elements {
            let ElementKind::Import(import) = &element.kind else { continue };
            let element = |name: &ast::Ident| {
                let parts = import.path.parts.iter().chain([name]).copied().collect();
                ast::Path { parts, span: name.span, ..import.path }
            };
            let imported = match &import.form {
                ImportForm::List(names) => names.iter().map(element).collect(),
                _ => vec![import.path.clone()],
            };
            for path in imported {
                let parts: Vec<Name> = path.parts.iter().map(|p| p.name).collect();
                if self.absolute(&parts, false).is_none() {
                    self.report_unknown_class(&path, ROOT);
                }
            }
        }
    }

    /// A name from the top: a class, or a component of a package; only a public one if it is one of
    /// many that are imported.
    fn absolute(&mut self, parts: &[Name], public: bool) -> Option<Found> {
        let (last, packages) = parts.split_last()?;
        let mut class = ROOT.class;
        for part in packages {
            class = self.member_class(class, *part, ROOT.instance)?;
        }
        if public && self.protected_in(class, *last).is_some() {
            return None;
        }
        if let Some(c) = self.member_class(class, *last, ROOT.instance) {
            return Some(Found::Class(c));
        }
        self.has_component(class, *last).then_some(Found::Component(class, *last))
    }
}
