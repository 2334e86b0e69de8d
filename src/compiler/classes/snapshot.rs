//! Snapshots of a class graph: many models of one file share most of their classes, and each of
//! these is read once.

use std::rc::Rc;

use super::ClassGraph;
use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::base::name::Name;
use crate::base::source::{SourceMap, Span};
use crate::classes::inheritance;
use crate::ir::expr::{EnumId, Graph};
use crate::ir::instance::{ClassId, ClassInstance, Instance, InstanceId};
use crate::resolve::library::Library;

/// The classes of a context, without the model that it was made for.
#[derive(Clone, Default)]
pub struct ContextSnapshot {
    classes: IndexVec<ClassId, ClassInstance>,
    instances: IndexVec<InstanceId, Instance>,
    graph: Graph,
    tables: IndexVec<ClassId, inheritance::TableState>,
    class_cache: FastMap<(usize, ClassId, InstanceId), ClassId>,
    imports: FastMap<ClassId, Rc<[usize]>>,
    package_instances: FastMap<ClassId, InstanceId>,
    enumerations: FastMap<usize, EnumId>,
    predefined: FastMap<Name, ClassId>,
    checked: FastSet<usize>,
    checked_functions: FastSet<ClassId>,
    checked_constraints: FastSet<Span>,
    problems_of: FastMap<ClassId, Problems>,
}

impl<'a> ClassGraph<'a> {
    /// The classes known so far. No model may have been instantiated.
    pub fn into_snapshot(self) -> ContextSnapshot {
        ContextSnapshot {
            classes: self.classes,
            instances: self.instances,
            graph: self.graph,
            tables: self.tables,
            class_cache: self.class_cache,
            imports: self.imports,
            package_instances: self.package_instances,
            enumerations: self.enumerations,
            predefined: self.predefined,
            checked: self.checked,
            checked_functions: self.checked_functions,
            checked_constraints: self.checked_constraints,
            problems_of: self.problems_of,
        }
    }

    /// A class graph that starts from a snapshot.
    pub fn from_snapshot(
        sources: &'a mut SourceMap,
        problems: &'a mut Problems,
        library: &'a mut Library,
        snapshot: ContextSnapshot,
    ) -> Self {
        ClassGraph {
            sources,
            problems,
            library,
            classes: snapshot.classes,
            instances: snapshot.instances,
            graph: snapshot.graph,
            tables: snapshot.tables,
            open_definitions: FastMap::default(),
            class_cache: snapshot.class_cache,
            constrained: FastMap::default(),
            modified_types: FastMap::default(),
            declaration_cache: FastMap::default(),
            imports: snapshot.imports,
            package_instances: snapshot.package_instances,
            enumerations: snapshot.enumerations,
            predefined: snapshot.predefined,
            checked: snapshot.checked,
            checked_functions: snapshot.checked_functions,
            checked_constraints: snapshot.checked_constraints,
            added_inner: FastSet::default(),
            violation: None,
            problems_of: snapshot.problems_of,
            no_layers: Rc::from([]),
            no_sizes: Rc::from([]),
        }
    }
}
