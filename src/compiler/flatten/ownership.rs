//! Which component must determine which variable, if each is balanced (Modelica 3.6, section 4.7).
//!
//! A component determines its own variables, but for its inputs and the flows of its connectors:
//! those are for the component that contains it, which connects them. Messages about singular systems
//! find out with it in which component an equation is missing or too many.

use std::sync::Arc;

use super::connect::{is_connector, is_record};
use crate::base::index::FastMap;
use crate::evaluate::Evaluator;
use crate::ir::ast::{Causality, ConnectionPrefix};
use crate::ir::flat::{FlatModel, Ownership};
use crate::ir::instance::{InstanceId, InstanceKind};

/// The owner of each variable of a model.
pub(super) fn of(cx: &mut Evaluator<'_>, root: InstanceId, flat: &FlatModel) -> Ownership {
    let components = vec![Arc::from("")];
    let mut found = Ownership { components, ..Ownership::default() };
    found.owner.reserve(flat.variables.len());
    let mut holders: FastMap<InstanceId, InstanceId> = FastMap::default();
    let mut numbers: FastMap<InstanceId, u32> = FastMap::default();
    numbers.insert(root, 0);
    for v in 0..cx.instance_of.len() {
        let (instance, _) = cx.instance_of[v];
        let mut owner = holder(cx, instance, root, &mut holders);
        if is_from_outside(cx, instance) {
            owner = holder(cx, owner, root, &mut holders);
        }
        let number = match numbers.get(&owner) {
            Some(number) => *number,
            None => {
                let number = found.components.len() as u32;
                found.components.push(cx.path(owner).into());
                numbers.insert(owner, number);
                number
            }
        };
        found.owner.push(number);
        let prefix = &cx.instances[instance].prefix;
        found.is_flow.push(prefix.connection == Some(ConnectionPrefix::Flow));
        found.is_output.push(prefix.causality == Some(Causality::Output));
    }
    found
}

/// The component that an instance is part of: neither a connector nor a record nor an array.
fn holder(
    cx: &mut Evaluator<'_>,
    instance: InstanceId,
    root: InstanceId,
    known: &mut FastMap<InstanceId, InstanceId>,
) -> InstanceId {
    let Some(parent) = cx.instances[instance].parent.filter(|_| instance != root) else {
        return root;
    };
    if let Some(holder) = known.get(&parent) {
        return *holder;
    }
    let is_array = matches!(cx.instances[parent].kind, InstanceKind::Array { .. });
    let is_part = is_array || is_connector(cx, parent) || is_record(cx, parent);
    let found = if is_part && parent != root { holder(cx, parent, root, known) } else { parent };
    known.insert(parent, found);
    found
}

/// True for a flow, and for an input, also as a part of a connector that is one.
fn is_from_outside(cx: &mut Evaluator<'_>, instance: InstanceId) -> bool {
    let prefix = &cx.instances[instance].prefix;
    prefix.connection == Some(ConnectionPrefix::Flow)
        || prefix.causality == Some(Causality::Input) && !cx.instances[instance].protected
}
