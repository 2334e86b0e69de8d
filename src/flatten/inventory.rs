//! What a model is made of: its components, their connectors, and what is connected with what.
//!
//! For tools that attach something to a model: two connectors of one class that stand at the same node
//! are the same place.

use crate::instantiate::Context;
use crate::ir::ast::{Causality, ClassKind};
use crate::ir::instance::{InstanceId, InstanceKind};

use super::connect::Connections;

/// The parts of a model.
#[derive(Clone, Debug, Default)]
pub struct Inventory {
    /// Components of the model in order; first the model itself, with an empty name.
    pub parts: Vec<Part>,
    /// Inputs of the model itself without a value.
    pub inputs: Vec<String>,
}

/// A component of a model.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// Its connectors.
    pub connectors: Vec<End>,
}

/// A connector of a component.
#[derive(Clone, Debug)]
pub struct End {
    /// Its name in the component.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// The same for all that are connected.
    pub node: usize,
}

/// Takes stock of the model at `root`, whose connections are known.
pub(super) fn of(
    cx: &mut Context<'_>,
    root: InstanceId,
    connections: &mut Connections,
) -> Inventory {
    let mut inventory = Inventory::default();
    let InstanceKind::Object(children) = cx.instances[root].kind.clone() else { return inventory };
    let mut parts = vec![(root, String::new(), children.clone())];
    for &child in children.iter() {
        cx.complete(child);
        let name = cx.instances[child].name.to_string();
        let instance = &cx.instances[child];
        if instance.prefix.causality == Some(Causality::Input) && cx.binding(child).is_none() {
            inventory.inputs.push(name.clone());
        }
        if let InstanceKind::Object(inner) = cx.instances[child].kind.clone() {
            parts.push((child, name, inner));
        }
    }
    let mut free = usize::MAX;
    for (id, name, inner) in parts {
        let mut connectors = Vec::new();
        for &end in inner.iter() {
            let Some(class) = connector_class(cx, end) else { continue };
            let node = first_variable(cx, end).and_then(|v| connections.node(v));
            // What is connected to nothing is a node of its own.
            let node = node.unwrap_or_else(|| {
                free -= 1;
                free
            });
            connectors.push(End { name: cx.instances[end].name.to_string(), class, node });
        }
        let class = cx.instances[id].class;
        let class = class.map_or_else(String::new, |c| cx.classes[c].full_name.to_string());
        if name.is_empty() || connector_class(cx, id).is_none() {
            inventory.parts.push(Part { name, class, connectors });
        }
    }
    inventory
}

fn connector_class(cx: &mut Context<'_>, id: InstanceId) -> Option<String> {
    cx.complete(id);
    if !matches!(cx.instances[id].kind, InstanceKind::Object(_)) {
        return None;
    }
    let class = cx.instances[id].class?;
    let is = matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector);
    is.then(|| cx.classes[class].full_name.to_string())
}

fn first_variable(cx: &Context<'_>, connector: InstanceId) -> Option<crate::ir::expr::VarId> {
    let InstanceKind::Object(children) = &cx.instances[connector].kind else { return None };
    children.iter().find_map(|c| match cx.instances[*c].kind {
        InstanceKind::Variable { first, .. } => first,
        _ => None,
    })
}
