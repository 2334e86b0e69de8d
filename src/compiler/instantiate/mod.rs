//! Classes to the component tree: modifications, redeclarations, sizes, conditions.
//!
//! In: a [`ClassId`]. Out: instances, ready for `flatten`. Modelica specification, chapters 4, 5 and
//! 7. The work is demand-driven: a component is completed when something asks for it, so that a
//! size may depend on a parameter declared later. The evaluator asks through
//! [`Demand`](crate::evaluate::demand::Demand), which this folder implements.

pub mod cause;
pub mod component;
mod error;
mod inner_outer;

use std::rc::Rc;

use crate::base::name::name;
use crate::classes::package_like;
use crate::evaluate::Evaluator;
use crate::evaluate::demand::Demand;
use crate::evaluate::frame::FrameKind;
use crate::ir::instance::{ClassId, Instance, InstanceId, InstanceKind, Scope};
use crate::ir::modification::{Layer, LayerSource, ParameterOverride};

/// Number of components that may be nested.
const MAX_NESTING: usize = 500;

impl Demand for Evaluator<'_> {
    #[inline(never)]
    fn complete_pending(&mut self, id: InstanceId) {
        if self.budget.exhausted || error::report_exhausted(self, id) {
            self.budget.exhausted = true;
            self.instances[id].kind = InstanceKind::Broken;
            return;
        }
        self.instances[id].kind = InstanceKind::InProgress;
        // Where a function reads a constant, its own variables are not those of the constant's package.
        let kind = self.with_frame(FrameKind::Class, |cx| component::kind(cx, id));
        // An error on the way may have settled it already.
        if matches!(self.instances[id].kind, InstanceKind::InProgress) {
            self.instances[id].kind = kind.unwrap_or(InstanceKind::Broken);
        }
    }

    fn report_cycle(&mut self, id: InstanceId) {
        error::report_component_cycle(self, id);
    }

    fn outer_of(&mut self, id: InstanceId) -> InstanceId {
        inner_outer::outer_of(self, id)
    }
}

/// Instantiates the model `class` with settings from outside, and everything in it.
pub fn model(
    cx: &mut Evaluator<'_>,
    class: ClassId,
    settings: &[Rc<ParameterOverride>],
) -> InstanceId {
    let scope = Scope { instance: cx.instances.next_id(), class };
    let layers: Vec<Layer> = settings
        .iter()
        .map(|s| Layer {
            source: LayerSource::ParameterOverride(s.clone(), 0),
            scope,
            subscripts: Rc::from([]),
        })
        .collect();
    let root = cx.instances.push(Instance {
        layers: layers.into(),
        class: Some(class),
        ..package_like(class, name(""))
    });
    component::complete_all(cx, root);
    root
}
