//! The instance tree: every component of the model with its class, modifications and dimensions.
//!
//! *Holds:* component instances with resolved classes, modification layers (outermost first, each
//! with the scope in which its expressions are read), evaluated dimensions and conditions.
//! *Never holds:* evaluated bindings or equations: those stay syntax until `flatten` evaluates them.
//! *Made by:* `instantiate`. *Read by:* `flatten`.

use std::rc::Rc;
use std::sync::Arc;

use super::ast;
use super::expr::{Type, VarId};
use super::modification::Layer;
use crate::base::index::FastMap;
use crate::base::name::Name;
use crate::base::source::Span;

crate::define_id! {
    /// A class in its lexical scope, with its redeclarations.
    pub struct ClassId
}
crate::define_id! {
    /// A component instance.
    pub struct InstanceId
}

/// Where names are looked up: components in `instance`, classes from `class` outwards.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Scope {
    /// The instance whose components are visible.
    pub instance: InstanceId,
    /// The class whose definition contains the name: the instance's own or one of its bases.
    pub class: ClassId,
}

/// A class in its lexical place.
#[derive(Clone, Debug)]
pub struct ClassInstance {
    /// Its definition, or a predefined type.
    pub body: ClassDefinition,
    /// Full dotted name.
    pub full_name: Name,
    /// The class around it; `None` for the root.
    pub enclosing: Option<ClassId>,
    /// The instance in which it was found: its own modifications read names there.
    pub holder: InstanceId,
    /// Local classes that have been redeclared.
    pub redeclared: Rc<[Redeclaration]>,
    /// The modification of the constraining clause of the class that this one replaces, and that class: names in the
    /// modification are looked up around it.
    pub constraint: Option<(Arc<ast::Modification>, ClassId)>,
    /// Modifications of a type by the packages that inherit it, outermost first.
    pub modified: Rc<[Layer]>,
}

/// The definition of a class.
#[derive(Clone, Debug)]
pub enum ClassDefinition {
    /// The unnamed root package.
    Root,
    /// `Real`, `Integer`, `Boolean`, `String`.
    Predefined(Type),
    /// A class of the user or of a library.
    Written(Arc<ast::Class>),
}

/// A class redeclared by a modification.
#[derive(Clone, Debug)]
pub struct Redeclaration {
    /// The name of the class that is replaced.
    pub name: Name,
    /// The new class.
    pub class: Arc<ast::Class>,
    /// The class whose definition contains the redeclaration.
    pub written_in: ClassId,
    /// The instance whose names its modifications read; `None`: the instance of the class in which
    /// the replaced class is found (a redeclaration in an `extends` clause).
    pub instance: Option<InstanceId>,
}

/// Everything that a class has after inheritance.
#[derive(Debug, Default)]
pub struct ClassTable {
    /// The predefined type or enumeration that it specialises.
    pub scalar: Option<Type>,
    /// The class that a short class definition names does not exist, which was reported.
    pub broken: bool,
    /// A base class does not exist, which was reported: names may be those of its elements.
    pub lacks_base: bool,
    /// The classes that it extends or is a short form of, as it sees them.
    pub bases: Vec<ClassId>,
    /// Dimensions that short class definitions add, each with the class that contains it.
    pub dims: Vec<(Vec<ast::Subscript>, ClassId)>,
    /// Prefixes that short classes add.
    pub prefix: ast::TypePrefix,
    /// Modifications that packages, short classes and `extends` put on a predefined type, outermost first.
    pub layers: Vec<Layer>,
    /// Components and local classes in order, inherited ones at the position of their `extends`.
    pub entries: Vec<Entry>,
    /// Position of a name in `entries`.
    pub index: FastMap<Name, usize>,
    /// Number of components among the entries.
    pub component_count: usize,
    /// Equation and algorithm sections, inherited ones first.
    pub sections: Vec<Section>,
    /// The external clause, if it is an external function.
    pub external: Option<(ast::External, ClassId)>,
    /// The inputs by which a function is differentiated, one after the other.
    pub by: Rc<[ast::Ident]>,
}

/// A named element of a class.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Its name.
    pub name: ast::Ident,
    /// Component or class.
    pub kind: EntryKind,
    /// The element that declares it, with its prefixes.
    pub element: Rc<ast::Element>,
    /// The class whose definition declares it.
    pub class: ClassId,
    /// Modifications of the `extends` clauses through which it came, outermost first.
    pub layers: Rc<[(Arc<ast::Modification>, ClassId)]>,
    /// Declared after `protected`.
    pub protected: bool,
    /// Position among the components, for components.
    pub component: Option<usize>,
}

/// A component or a class.
#[derive(Clone, Debug)]
pub enum EntryKind {
    /// A component.
    Component(Declaration),
    /// A local class.
    Class(Arc<ast::Class>),
}

/// A declared component: which one of which element of which class.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// The element with its prefixes; holds `ElementKind::Components`.
    pub element: Rc<ast::Element>,
    /// Which of its components.
    pub component: usize,
}

impl Declaration {
    /// The clause that declares it.
    pub fn clause(&self) -> &ast::ComponentClause {
        match &self.element.kind {
            ast::ElementKind::Components(clause) => clause,
            _ => unreachable!("a declaration holds a component clause"),
        }
    }
    /// The declared component.
    pub fn component(&self) -> &ast::Component {
        &self.clause().components[self.component]
    }
}

/// A section of equations or statements, and the class that contains it.
#[derive(Clone, Debug)]
pub struct Section {
    /// Scope of its names.
    pub class: ClassId,
    /// `initial equation` or `initial algorithm`.
    pub initial: bool,
    /// Its contents.
    pub kind: SectionKind,
}

/// Equations or statements.
#[derive(Clone, Debug)]
pub enum SectionKind {
    /// `equation`
    Equations(Arc<[ast::Equation]>),
    /// `algorithm`
    Algorithm(Arc<[ast::Statement]>, Span),
}

/// A component instance.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its own name; elements of arrays repeat the name of the array.
    pub name: Name,
    /// The component that holds it; `None` for the model and for packages.
    pub parent: Option<InstanceId>,
    /// Subscripts, for elements of arrays.
    pub subscripts: Box<[usize]>,
    /// Its declaration; `None` for the model and for packages.
    pub declaration: Option<Declaration>,
    /// Where the names of its declaration are looked up.
    pub scope: Scope,
    /// Its modifications, outermost first.
    pub layers: Rc<[Layer]>,
    /// Its class, once known.
    pub class: Option<ClassId>,
    /// Its kind, once known.
    pub kind: InstanceKind,
    /// Prefixes, merged with those of the components around it.
    pub prefix: ast::TypePrefix,
    /// It or a component around it is protected.
    pub protected: bool,
}

/// The kinds of instances.
#[derive(Clone, Debug)]
pub enum InstanceKind {
    /// Not instantiated yet.
    Pending,
    /// Being instantiated: meeting it again is a cycle.
    InProgress,
    /// Its condition is false.
    Absent,
    /// An error was reported; no further ones follow from it.
    Broken,
    /// An `outer` component: the `inner` one it stands for.
    Outer(InstanceId),
    /// Scalar variables of a predefined type, row-major.
    Variable {
        /// Scalar type.
        ty: Type,
        /// Sizes; empty for a scalar.
        dims: Rc<[usize]>,
        /// The first of its flat variables, once numbered.
        first: Option<VarId>,
    },
    /// A component with components.
    Object(Rc<[InstanceId]>),
    /// An array of components with components, row-major.
    Array {
        /// Sizes.
        dims: Rc<[usize]>,
        /// Its elements.
        elements: Rc<[InstanceId]>,
    },
}
