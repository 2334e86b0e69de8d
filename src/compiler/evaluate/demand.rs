//! The evaluator's interface to the component tree.
//!
//! Sizes and conditions of components are expressions, and expressions read components: evaluation
//! and instantiation need each other. The evaluator states its need as a trait, and `instantiate`,
//! which stands above it, implements the trait.

use super::Evaluator;
use crate::base::name::Name;
use crate::ir::instance::{ClassId, InstanceId, InstanceKind};

/// Completes components when their values are asked for.
pub(crate) trait Demand {
    /// Determines class, sizes and components of an instance that is pending.
    fn complete_pending(&mut self, id: InstanceId);
    /// Reports an instance that is needed for its own completion.
    fn report_cycle(&mut self, id: InstanceId);
    /// The component that a name means where it is read: an `inner outer` component is the outer
    /// one to all but the components inside of its own (section 5.4).
    fn outer_of(&mut self, id: InstanceId) -> InstanceId;
}

impl Evaluator<'_> {
    /// Completes an instance, unless it is complete.
    pub fn complete(&mut self, id: InstanceId) {
        match self.instances[id].kind {
            InstanceKind::Pending => self.complete_pending(id),
            InstanceKind::InProgress => self.report_cycle(id),
            _ => {}
        }
    }

    /// The component `wanted` of an instance.
    pub fn child(&mut self, parent: InstanceId, wanted: Name) -> Option<InstanceId> {
        self.complete(parent);
        let parent = match self.instances[parent].kind {
            InstanceKind::Outer(inner) => inner,
            _ => parent,
        };
        self.complete(parent);
        self.child_of_complete(parent, wanted)
    }

    /// The component `wanted` of a package.
    pub(crate) fn package_component(&mut self, class: ClassId, wanted: Name) -> Option<InstanceId> {
        if !self.has_component(class, wanted) {
            return None;
        }
        let package = self.package_instance(class);
        self.child(package, wanted)
    }
}
