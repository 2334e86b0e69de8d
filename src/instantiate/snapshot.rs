//! What a context knows of classes, for other contexts: many models of one file have most of their
//! classes in common, and each of these is read once.

use std::rc::Rc;

use super::Context;
use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::base::name::Name;
use crate::base::source::{SourceMap, Span};
use crate::classes::inheritance;
use crate::evaluate;
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
    said: FastMap<ClassId, Problems>,
}

impl<'a> Context<'a> {
    /// What is known of classes. No model may have been instantiated.
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
            said: self.said,
        }
    }

    /// A context that knows what another one has found.
    pub fn from_snapshot(
        sources: &'a mut SourceMap,
        problems: &'a mut Problems,
        library: &'a mut Library,
        snapshot: ContextSnapshot,
    ) -> Self {
        Context {
            sources,
            problems,
            library,
            classes: snapshot.classes,
            instances: snapshot.instances,
            graph: snapshot.graph,
            tables: snapshot.tables,
            class_cache: snapshot.class_cache,
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
            said: snapshot.said,
            no_layers: Rc::from([]),
            no_sizes: Rc::from([]),
            evaluation: evaluate::State::default(),
            surrounded: false,
        }
    }

    /// Remembers the problems of a class, which come after those from `before`: classes that are made
    /// of it are wrong too, in a context that is grown from this one as well.
    pub(crate) fn note_said(&mut self, class: ClassId, before: Problems) {
        let said = std::mem::replace(self.problems, before);
        if !said.is_empty() {
            self.say(&said);
            self.said.insert(class, said);
        }
    }

    /// Says again what was said of a class; what is known already is not said twice.
    pub(crate) fn say_again(&mut self, class: ClassId) {
        if !self.said.is_empty()
            && let Some(said) = self.said.get(&class).cloned()
        {
            self.say(&said);
        }
    }

    fn say(&mut self, said: &Problems) {
        said.iter().for_each(|d| self.problems.push(d.clone()));
    }
}
