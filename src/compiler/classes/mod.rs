//! Names to classes: lexical lookup, inheritance, redeclared classes.
//!
//! In: the [`Library`] and a name in a scope. Out: a [`ClassId`], and the table of everything that
//! the class has after inheritance. Modelica specification, chapters 5 and 7.
//!
//! A class may be redeclared in a component and an `outer` class belongs to the components around,
//! so [`ClassGraph`] holds the component tree as data. It reads the parents, classes and
//! modifications of instances, and never completes one.

pub(crate) mod attribute;
pub(crate) mod declaration_cache;
pub mod cause;
pub mod error;
pub mod inheritance;
pub mod lookup;
pub mod predefined;
pub mod snapshot;
pub(crate) mod type_lookup;
pub mod unsupported;
pub mod visibility;

use std::rc::Rc;
use std::sync::Arc;

use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::base::name::{Name, name};
use crate::base::source::{SourceMap, Span};
use crate::ir::ast::{self, Class};
use crate::ir::expr::{EnumId, Enumeration, Graph, Type};
use crate::ir::instance::{
    ClassDefinition, ClassId, ClassInstance, ClassTable, Entry, Instance, InstanceId, InstanceKind,
    Scope,
};
use crate::ir::modification::Layer;
use crate::resolve::library::Library;
use snapshot::ContextSnapshot;

/// The root package and its instance.
pub const ROOT: Scope = Scope { instance: InstanceId(0), class: ClassId(0) };

/// The rules that a class definition is checked against while its table is made; implemented by
/// `rules`.
pub(crate) trait DefinitionRules {
    /// A definition, before its bases are known.
    fn check_definition(&mut self, definition: &Class);
    /// The statements and modifications of a definition whose elements are known.
    fn check_body(&mut self, class: ClassId, definition: &Arc<Class>);
    /// The base of a short class definition.
    fn check_short_base(&mut self, definition: &Class, base: ClassId, span: Span);
    /// The base of an `extends` clause.
    fn check_extends(&mut self, class: ClassId, base: ClassId, path: &ast::Path, scope: Scope);
    /// A class that is a predefined type or an array.
    fn check_simple_type(&mut self, class: ClassId, table: &ClassTable, bases: &[ClassId]);
    /// An element that is redeclared in a class that inherits it.
    fn check_redeclared_prefixes(&mut self, before: &Entry, after: &Entry);
}

/// The classes that a model uses, with the component tree that redeclarations refer to.
pub struct ClassGraph<'a> {
    /// The source files.
    pub sources: &'a mut SourceMap,
    /// Diagnostics.
    pub problems: &'a mut Problems,
    /// Classes on demand.
    pub library: &'a mut Library,
    /// Classes in their lexical places.
    pub classes: IndexVec<ClassId, ClassInstance>,
    /// Component and package instances.
    pub instances: IndexVec<InstanceId, Instance>,
    /// All expressions, and the enumeration types.
    pub graph: Graph,
    tables: IndexVec<ClassId, inheritance::TableState>,
    /// Number of tables in progress for each definition, by address.
    open_definitions: FastMap<usize, u32>,
    class_cache: FastMap<(usize, ClassId, InstanceId), ClassId>,
    /// Classes that replace another one, with what its constraining clause says.
    constrained: FastMap<(ClassId, ClassId), ClassId>,
    /// Classes as packages that inherit them have them, by the class and the package.
    modified_types: FastMap<(ClassId, ClassId), ClassId>,
    /// Declarations that mean the same for all their components.
    declaration_cache: FastMap<declaration_cache::Key, declaration_cache::Cached>,
    /// The positions of import clauses in classes.
    imports: FastMap<ClassId, Rc<[usize]>>,
    pub(crate) package_instances: FastMap<ClassId, InstanceId>,
    enumerations: FastMap<usize, EnumId>,
    /// The types of the language by name: `Real` and others.
    pub predefined: FastMap<Name, ClassId>,
    /// Definitions that have been checked, by address.
    checked: FastSet<usize>,
    /// Functions whose components have been checked.
    pub(crate) checked_functions: FastSet<ClassId>,
    /// Places of elements whose constraining clauses have been checked.
    pub(crate) checked_constraints: FastSet<Span>,
    /// `inner` components that no class declares.
    pub(crate) added_inner: FastSet<InstanceId>,
    /// The access violation of the last name that was looked up, until the name is needed.
    violation: Option<visibility::AccessViolation>,
    /// The problems of classes that are wrong.
    problems_of: FastMap<ClassId, Problems>,
    /// No modifications and no sizes, which most components have: shared by all of them.
    pub(crate) no_layers: Rc<[Layer]>,
    pub(crate) no_sizes: Rc<[usize]>,
}

impl<'a> ClassGraph<'a> {
    /// A graph with the predefined classes only.
    pub fn new(
        sources: &'a mut SourceMap,
        problems: &'a mut Problems,
        library: &'a mut Library,
    ) -> Self {
        let snapshot = ContextSnapshot::default();
        let mut graph = ClassGraph::from_snapshot(sources, problems, library, snapshot);
        let root =
            graph.add_class(ClassDefinition::Root, name(""), None, ROOT.instance, Rc::from([]));
        debug_assert_eq!(root, ROOT.class);
        graph.instances.push(Instance {
            kind: InstanceKind::Object(Rc::from([])),
            ..package_like(ROOT.class, name(""))
        });
        graph.package_instances.insert(ROOT.class, ROOT.instance);
        graph.add_predefined();
        graph
    }

    fn add_predefined(&mut self) {
        let types = [
            ("Real", Type::Real),
            ("Integer", Type::Integer),
            ("Boolean", Type::Boolean),
            ("String", Type::String),
            ("Clock", Type::Clock),
            // An external object is opaque: expressions see a string that identifies it.
            ("ExternalObject", Type::String),
        ];
        for (text, ty) in types {
            let id = self.add_predefined_class(text, ty);
            self.predefined.insert(name(text), id);
        }
        let enumerations: [(&str, &[&str]); 2] = [
            ("StateSelect", &["never", "avoid", "default", "prefer", "always"]),
            ("AssertionLevel", &["warning", "error"]),
        ];
        for (text, literals) in enumerations {
            let literals = literals.iter().map(|l| name(l)).collect();
            let id = self.graph.enumerations.push(Enumeration { name: text.into(), literals });
            let class = self.add_predefined_class(text, Type::Enumeration(id));
            self.predefined.insert(name(text), class);
        }
    }

    fn add_predefined_class(&mut self, text: &str, ty: Type) -> ClassId {
        let root = Some(ROOT.class);
        self.add_class(
            ClassDefinition::Predefined(ty),
            name(text),
            root,
            ROOT.instance,
            Rc::from([]),
        )
    }

    /// The dotted name of an instance as the user knows it; empty for the model.
    pub fn path(&self, id: InstanceId) -> String {
        let mut chain = Vec::new();
        let mut at = Some(id);
        while let Some(i) = at {
            chain.push(i);
            at = self.instances[i].parent;
        }
        let mut text = String::new();
        for i in chain.into_iter().rev() {
            let instance = &self.instances[i];
            // The array itself and its elements share a name: only one of them is written.
            if instance.name.is_empty() {
                continue;
            }
            if instance.subscripts.is_empty() {
                if !text.is_empty() {
                    text.push('.');
                }
                text.push_str(&instance.name);
            } else {
                text.push_str(&subscript_text(&instance.subscripts));
            }
        }
        text
    }

    /// The place where an instance is declared.
    pub fn declared_at(&self, id: InstanceId) -> Span {
        self.instances[id].declaration.as_ref().map_or(Span::NONE, |d| d.component().name.span)
    }

    /// The table of the class of a completed instance.
    pub fn table_of(&mut self, id: InstanceId) -> Rc<ClassTable> {
        match self.instances[id].class {
            Some(class) => self.table(class),
            None => Rc::default(),
        }
    }

    /// The component `wanted` of an instance that is complete.
    pub(crate) fn child_of_complete(
        &mut self,
        parent: InstanceId,
        wanted: Name,
    ) -> Option<InstanceId> {
        let table = self.table_of(parent);
        let InstanceKind::Object(children) = &self.instances[parent].kind else { return None };
        match table.index.get(&wanted) {
            Some(at) => children.get(table.entries[*at].component?).copied(),
            // Connections add components behind the declared ones.
            None => children
                .iter()
                .skip(table.component_count)
                .find(|c| self.instances[**c].name == wanted)
                .copied(),
        }
    }
}

/// `[1,2]`
pub fn subscript_text(subscripts: &[usize]) -> String {
    let mut text = String::from("[");
    for (k, subscript) in subscripts.iter().enumerate() {
        if k > 0 {
            text.push(',');
        }
        text.push_str(&subscript.to_string());
    }
    text.push(']');
    text
}

/// An instance without declaration: a package, or the model itself.
pub(crate) fn package_like(class: ClassId, text: Name) -> Instance {
    Instance {
        name: text,
        parent: None,
        subscripts: Box::new([]),
        declaration: None,
        scope: Scope { instance: ROOT.instance, class },
        layers: Rc::from([]),
        class: Some(class),
        kind: InstanceKind::Pending,
        prefix: ast::TypePrefix::default(),
        protected: false,
    }
}
