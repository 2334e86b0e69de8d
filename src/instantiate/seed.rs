//! What a context knows of classes, for other contexts: many models of one file have most of their
//! classes in common, and each of these is read once.

use std::rc::Rc;

use super::{Context, class, evaluate};
use crate::base::diag::Problems;
use crate::base::index::{FastMap, FastSet, IndexVec};
use crate::base::name::Name;
use crate::base::source::{SourceMap, Span};
use crate::ir::expr::{EnumId, Graph};
use crate::ir::instance::{ClassId, ClassInstance, Instance, InstanceId};
use crate::resolve::library::Library;

/// The classes of a context, without the model that it was made for.
#[derive(Clone, Default)]
pub struct Seed {
    classes: IndexVec<ClassId, ClassInstance>,
    instances: IndexVec<InstanceId, Instance>,
    graph: Graph,
    tables: IndexVec<ClassId, class::TableState>,
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
    pub fn seed(self) -> Seed {
        Seed {
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
    pub fn grown(
        sources: &'a mut SourceMap,
        problems: &'a mut Problems,
        library: &'a mut Library,
        seed: Seed,
    ) -> Self {
        Context {
            sources,
            problems,
            library,
            classes: seed.classes,
            instances: seed.instances,
            graph: seed.graph,
            tables: seed.tables,
            class_cache: seed.class_cache,
            plain: FastMap::default(),
            imports: seed.imports,
            package_instances: seed.package_instances,
            enumerations: seed.enumerations,
            predefined: seed.predefined,
            checked: seed.checked,
            checked_functions: seed.checked_functions,
            checked_constraints: seed.checked_constraints,
            added_inner: FastSet::default(),
            trespass: None,
            said: seed.said,
            no_layers: Rc::from([]),
            no_sizes: Rc::from([]),
            evaluation: evaluate::State::default(),
            surrounded: false,
        }
    }

    /// Remembers the problems of a class, which come after those from `before`: classes that are made
    /// of it are wrong too, in a context that is grown from this one as well.
    pub(super) fn note_said(&mut self, class: ClassId, before: Problems) {
        let said = std::mem::replace(self.problems, before);
        if !said.is_empty() {
            self.say(&said);
            self.said.insert(class, said);
        }
    }

    /// Says again what was said of a class; what is known already is not said twice.
    pub(super) fn say_again(&mut self, class: ClassId) {
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
