//! Inventory of a model: its components, their connectors, and the nodes that connections form.
//!
//! For tools that attach components to a model: two connectors of the same class at the same node
//! are equivalent places to attach to.

use crate::evaluate::Evaluator;
use crate::ir::ast::{Causality, ClassKind};
use crate::ir::instance::{InstanceId, InstanceKind};

use super::connect::Connections;

/// The components of a model and its free inputs.
#[derive(Clone, Debug, Default)]
pub struct Inventory {
    /// Components in order of declaration; the first is the model itself, with an empty name.
    pub parts: Vec<InventoryPart>,
    /// Inputs of the model itself without a value.
    pub inputs: Vec<String>,
}

/// A component of a model.
#[derive(Clone, Debug)]
pub struct InventoryPart {
    /// Its name.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// Its connectors.
    pub connectors: Vec<InventoryConnector>,
}

/// A connector of a component.
#[derive(Clone, Debug)]
pub struct InventoryConnector {
    /// Its name within the component.
    pub name: String,
    /// Full name of its class.
    pub class: String,
    /// The node that it belongs to: connectors are connected if their nodes are equal.
    pub node: usize,
}

/// Takes the inventory of the model at `root`, whose connections have been collected.
pub(super) fn of(
    cx: &mut Evaluator<'_>,
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
            // An unconnected connector has a node of its own.
            let node = node.unwrap_or_else(|| {
                free -= 1;
                free
            });
            connectors.push(InventoryConnector {
                name: cx.instances[end].name.to_string(),
                class,
                node,
            });
        }
        let class = cx.instances[id].class;
        let class = class.map_or_else(String::new, |c| cx.classes[c].full_name.to_string());
        if name.is_empty() || connector_class(cx, id).is_none() {
            inventory.parts.push(InventoryPart { name, class, connectors });
        }
    }
    inventory
}

fn connector_class(cx: &mut Evaluator<'_>, id: InstanceId) -> Option<String> {
    cx.complete(id);
    if !matches!(cx.instances[id].kind, InstanceKind::Object(_)) {
        return None;
    }
    let class = cx.instances[id].class?;
    let is = matches!(cx.kind(class), ClassKind::Connector | ClassKind::ExpandableConnector);
    is.then(|| cx.classes[class].full_name.to_string())
}

fn first_variable(cx: &Evaluator<'_>, connector: InstanceId) -> Option<crate::ir::expr::VarId> {
    let InstanceKind::Object(children) = &cx.instances[connector].kind else { return None };
    children.iter().find_map(|c| match cx.instances[*c].kind {
        InstanceKind::Variable { first, .. } => first,
        _ => None,
    })
}
