//! Library to instance tree: classes with inheritance, modifications, redeclarations, dimensions.
//!
//! In: the [`Library`] and the name of a model. Out: the instances in [`Context`], ready for
//! `flatten`. Modelica specification, chapters 4, 5 and 7. The work is demand-driven: a component
//! is looked into when something asks for it, so that a size may depend on a parameter declared
//! later.
pub mod component;
mod declaration_cache;
pub mod error;
mod inner_outer;
pub mod snapshot;

use std::rc::Rc;

use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::base::name::{Name, name};
use crate::base::source::{SourceMap, Span};
use crate::ir::ast;
use crate::ir::expr::{EnumId, Enumeration, Graph, Type};
use crate::ir::instance::{
    ClassId, ClassInstance, ClassTable, ClassText, Instance, InstanceId, InstanceKind, Scope,
};
use crate::ir::modification::{Layer, ParameterOverride};
use crate::resolve::library::Library;
use crate::rules::visibility::AccessViolation;
use snapshot::ContextSnapshot;

/// The root package and its instance.
pub const ROOT: Scope = Scope { instance: InstanceId(0), class: ClassId(0) };

/// Everything that instantiation and flattening of one model share.
pub struct Context<'a> {
    /// The texts.
    pub sources: &'a mut SourceMap,
    /// What there is to say.
    pub problems: &'a mut Problems,
    /// Classes on demand.
    pub library: &'a mut Library,
    /// Classes in their lexical places.
    pub classes: IndexVec<ClassId, ClassInstance>,
    /// Component and package instances.
    pub instances: IndexVec<InstanceId, Instance>,
    /// All expressions.
    pub graph: Graph,
    pub(crate) tables: IndexVec<ClassId, crate::classes::inheritance::TableState>,
    pub(crate) class_cache: FastMap<(usize, ClassId, InstanceId), ClassId>,
    /// Declarations that say the same of all their components.
    pub(crate) declaration_cache: FastMap<declaration_cache::Key, declaration_cache::Cached>,
    /// Where the import clauses of classes stand.
    pub(crate) imports: FastMap<ClassId, Rc<[usize]>>,
    pub(crate) package_instances: FastMap<ClassId, InstanceId>,
    pub(crate) enumerations: FastMap<usize, EnumId>,
    pub(crate) predefined: FastMap<Name, ClassId>,
    /// Texts whose bodies have been checked, by address.
    pub(crate) checked: FastSet<usize>,
    /// Functions whose components have been checked.
    pub(crate) checked_functions: FastSet<ClassId>,
    /// Places of elements whose constraining clauses have been checked.
    pub(crate) checked_constraints: FastSet<Span>,
    /// `inner` components that no text declares.
    pub(crate) added_inner: FastSet<InstanceId>,
    /// What was wrong with the last name that was looked up, until somebody needs it.
    pub(crate) violation: Option<AccessViolation>,
    /// The problems of classes that are wrong.
    pub(crate) problems_of: FastMap<ClassId, Problems>,
    /// No modifications and no sizes, which most components have: shared by all of them.
    pub(crate) no_layers: Rc<[Layer]>,
    pub(crate) no_sizes: Rc<[usize]>,
    pub(crate) evaluation: crate::evaluate::State,
    /// The model is a component by itself: what surrounds it is not there.
    pub surrounded: bool,
}

impl<'a> Context<'a> {
    /// A context in which nothing is instantiated yet.
    pub fn new(
        sources: &'a mut SourceMap,
        problems: &'a mut Problems,
        library: &'a mut Library,
    ) -> Self {
        let mut cx = Context::from_snapshot(sources, problems, library, ContextSnapshot::default());
        let root = cx.add_class(ClassText::Root, name(""), None, ROOT.instance, Rc::from([]));
        debug_assert_eq!(root, ROOT.class);
        cx.instances.push(Instance {
            kind: InstanceKind::Object(Rc::from([])),
            ..package_like(ROOT.class, name(""))
        });
        cx.package_instances.insert(ROOT.class, ROOT.instance);
        cx.add_predefined();
        cx
    }

    fn add_predefined(&mut self) {
        let types = [
            ("Real", Type::Real),
            ("Integer", Type::Integer),
            ("Boolean", Type::Boolean),
            ("String", Type::String),
            // What an external object is stays inside: from outside it is a text that names it.
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
        self.add_class(ClassText::Predefined(ty), name(text), root, ROOT.instance, Rc::from([]))
    }

    /// Instantiates the model `class` with settings from outside, and everything in it.
    pub fn instantiate_model(
        &mut self,
        class: ClassId,
        settings: &[Rc<ParameterOverride>],
    ) -> InstanceId {
        let scope = Scope { instance: self.instances.next_id(), class };
        let layers: Vec<Layer> = settings
            .iter()
            .map(|s| Layer {
                source: crate::ir::modification::LayerSource::ParameterOverride(s.clone(), 0),
                scope,
                subscripts: Rc::from([]),
            })
            .collect();
        let root = self.instances.push(Instance {
            layers: layers.into(),
            class: Some(class),
            ..package_like(class, name(""))
        });
        self.complete_all(root);
        root
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
